/* Netlists that are read as they stand, without ngspice: no subcircuits, no parameters, no expressions. Whatever is in
 * doubt is left to ngspice. */
#include "circuit/linear.h"

#include "circuit/netlist_internal.h"

#include <ctype.h>
#include <stdlib.h>
#include <string.h>

/* Whatever else may stand in a line is an expression, a quote or a comment. */
#define PLAIN "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_.,=()+-/:#[] \t"

static bool is_among(const char *word, const char *const *words, size_t count) {
    for (size_t i = 0; i < count; i++)
        if (strcmp(word, words[i]) == 0)
            return true;
    return false;
}

/* Cards that change nothing a plain line says; .measure is looked at elsewhere. */
static bool is_plain_card(const char *word) {
    static const char *const plain[] = {".tran",    ".end",  ".options", ".option", ".ic",
                                        ".nodeset", ".save", ".measure", ".meas"};
    return is_among(word, plain, sizeof plain / sizeof plain[0]);
}

/* What ngspice's reader takes for something else than it looks like: a node with a source's keyword for a name, a "="
 * that does not follow the name of a parameter. */
static bool is_plain_element(const char *text) {
    static const char *const keywords[] = {"dc", "ac", "pulse", "sin", "exp", "pwl", "sffm", "am", "external"};
    static const char *const parameters[] = {"m",  "tc", "tc1", "tc2", "temp", "dtemp",      "scale",
                                             "ic", "ac", "r",   "c",   "l",    "resistance", "td"};
    char word[DEA_TOKEN_MAX], before[DEA_TOKEN_MAX] = "";
    for (int place = 0; dea_netlist_token(&text, word); place++) {
        bool node = place == 1 || place == 2;
        if (node && is_among(word, keywords, sizeof keywords / sizeof keywords[0]))
            return false;
        if (strcmp(word, "=") == 0 &&
            (place < 4 || !is_among(before, parameters, sizeof parameters / sizeof parameters[0])))
            return false;
        memcpy(before, word, sizeof before);
    }
    return true;
}

static int compare_names(const void *a, const void *b) {
    return strcmp(*(const char *const *)a, *(const char *const *)b);
}

/* ngspice refuses two elements of one name, and says so. */
static bool all_differ(char **names, int count) {
    qsort(names, (size_t)count, sizeof *names, compare_names);
    for (int i = 1; i < count; i++)
        if (strcmp(names[i - 1], names[i]) == 0)
            return false;
    return true;
}

/* Goes through the lines: the listing of those that count, the elements' names. *plain is false at the first doubt. */
static enum dea_status list_lines(const struct dea_netlist *netlist, struct dea_listing *listing, char **names,
                                  int *name_count, bool *plain, struct dea_error *error) {
    const struct dea_netlist_instance *instance = &netlist->instances[0];
    for (int i = 0; i < netlist->line_count && *plain; i++) {
        const char *text = netlist->lines[i].text, *rest = text;
        char word[DEA_TOKEN_MAX];
        bool title = i == 0;
        if (i == instance->line || (!title && (!netlist->lines[i].passed || !dea_netlist_token(&rest, word))))
            continue;
        bool card = !title && word[0] == '.', measure = card && strncmp(word, ".meas", 5) == 0;
        if (card)
            *plain = is_plain_card(word);
        else if (!title)
            *plain = strchr("rclkviegfh", word[0]) != NULL && strchr(word, '.') == NULL && is_plain_element(text);
        *plain = *plain && (title || measure || text[strspn(text, PLAIN)] == '\0');
        if (!*plain || measure)
            continue;
        listing->lines[listing->count] = strdup(text);
        char *name = strdup(word);
        if (!title && !card)
            names[(*name_count)++] = name;
        else
            free(name);
        if (listing->lines[listing->count++] == NULL || name == NULL)
            return dea_fail(error, DEA_ERR_MEMORY, "out of memory for the circuit");
    }
    return DEA_OK;
}

enum dea_status dea_linear_list(const struct dea_netlist *netlist, struct dea_listing *listing, bool *plain,
                                struct dea_error *error) {
    *listing = (struct dea_listing){0};
    *plain = strchr(netlist->instances[0].path, '.') == NULL;
    listing->lines = calloc((size_t)netlist->line_count, sizeof *listing->lines);
    char **names = calloc((size_t)netlist->line_count, sizeof *names);
    int name_count = 0;
    enum dea_status status = DEA_OK;
    if (listing->lines == NULL || names == NULL)
        status = dea_fail(error, DEA_ERR_MEMORY, "out of memory for the circuit");
    if (status == DEA_OK)
        status = list_lines(netlist, listing, names, &name_count, plain, error);
    *plain = *plain && status == DEA_OK && all_differ(names, name_count);
    for (int i = 0; i < name_count; i++)
        free(names[i]);
    free(names);
    return status;
}
