/* Netlists given as text: whether they pass. */
#ifndef NETLIST_SUPPORT_H
#define NETLIST_SUPPORT_H

#include "circuit/netlist.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

/* Reads a netlist of a title and this text; the caller clears it. */
static inline enum dea_status read_netlist(const char *text, struct dea_netlist *netlist, struct dea_error *error) {
    static const struct dea_netlist_options options;
    char path[] = "netlist-test-XXXXXX";
    int descriptor = mkstemp(path);
    FILE *file = descriptor >= 0 ? fdopen(descriptor, "w") : NULL;
    assert_non_null(file);
    fprintf(file, "title\n%s", text);
    fclose(file);
    error->text[0] = '\0';
    enum dea_status status = dea_netlist_read(path, &options, netlist, error);
    unlink(path);
    return status;
}

/* Reads title and text; `says` NULL: it passes. */
static inline void expect(const char *text, const char *says) {
    struct dea_netlist netlist;
    struct dea_error error;
    enum dea_status status = read_netlist(text, &netlist, &error);
    dea_netlist_clear(&netlist);
    if (says == NULL ? status != DEA_OK : status != DEA_ERR_INPUT || strstr(error.text, says) == NULL)
        fail_msg("netlist:\n%s\nexpected \"%s\", got %d \"%s\"", text, says != NULL ? says : "", status, error.text);
}

#endif
