/* Netlists of the engine's tests: into a file of their own, read, loaded. */
#include "loaded_text.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

const struct dea_port still_port = {.rest_capacitance = STILL_CAPACITANCE, .conductivity_field = INFINITY};

double give_still(void *context, int instance, int port, enum dea_external which, double t) {
    (void)context, (void)instance, (void)port, (void)t;
    return which == DEA_EXTERNAL_CAPACITANCE ? STILL_CAPACITANCE : 0.0;
}

/* The tests cannot go on without their own file. */
static void write_own_file(char *path, const char *text) {
    int descriptor = mkstemp(path);
    FILE *file = descriptor >= 0 ? fdopen(descriptor, "w") : NULL;
    if (file == NULL || fputs(text, file) < 0 || fclose(file) != 0) {
        perror(path);
        abort();
    }
}

enum dea_status load_text(struct dea_engine *engine, const char *text, const struct dea_port *port,
                          const struct dea_deck_options *options, const struct dea_engine_callbacks *callbacks,
                          struct loaded_text *loaded, struct dea_error *error) {
    char path[] = "netlist-XXXXXX";
    const struct dea_netlist_device names = {"DEA", 1, {"left", NULL}};
    const struct dea_netlist_options netlist_options = {.devices = &names, .device_count = 1};
    *loaded = (struct loaded_text){.device = {.name = "DEA", .port_count = 1, .ports = {*port}}};
    write_own_file(path, text);
    enum dea_status status = dea_netlist_read(path, &netlist_options, &loaded->netlist, error);
    unlink(path);
    DEA_TRY(status);
    DEA_TRY(dea_deck_build(&loaded->netlist, &loaded->device, options, &loaded->deck, error));
    return dea_engine_load(engine, &loaded->netlist, &loaded->deck, &loaded->device, options, callbacks, error);
}

void clear_text(struct loaded_text *loaded) {
    dea_deck_clear(&loaded->deck);
    dea_netlist_clear(&loaded->netlist);
}
