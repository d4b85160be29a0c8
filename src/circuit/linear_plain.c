/* Netlists that are read as they stand, without ngspice: no subcircuits, nothing but arithmetic of parameters. Whatever
 * is in doubt is left to ngspice. */
#include "circuit/linear.h"

#include "circuit/netlist_internal.h"
#include "circuit/parameters.h"

#include <ctype.h>
#include <stdlib.h>
#include <string.h>

/* Whatever else may stand in a line, with its parameters put in, is an expression, a quote or a comment. */
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
        if (node && (is_among(word, keywords, sizeof keywords / sizeof keywords[0]) || strchr("{'", word[0]) != NULL))
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

/* What is built up from the lines. */
struct lister {
    struct dea_parameters parameters;
    struct dea_listing *listing;
    char **names; /* owned; of the elements */
    int name_count;
};

/* One line, whose first word is given; false at a doubt, or out of memory, which ngspice will find out as well. */
static bool list_line(struct lister *lister, const char *text, const char *word) {
    bool card = word[0] == '.', measure = strncmp(word, ".meas", 5) == 0;
    if (strcmp(word, ".param") == 0)
        return true;
    if (card ? !is_plain_card(word)
             : strchr("rclkviegfh", word[0]) == NULL || strchr(word, '.') != NULL || !is_plain_element(text))
        return false;
    if (measure)
        return true;
    char *line = dea_parameters_put_in(&lister->parameters, text);
    if (line == NULL)
        return false;
    lister->listing->lines[lister->listing->count++] = line;
    if (!card && (lister->names[lister->name_count++] = strdup(word)) == NULL)
        return false;
    return line[strspn(line, PLAIN)] == '\0';
}

static bool list_all(struct lister *lister, const struct dea_netlist *netlist) {
    const struct dea_netlist_instance *instance = &netlist->instances[0];
    char *title = strdup(netlist->lines[0].text);
    if (title == NULL)
        return false;
    lister->listing->lines[lister->listing->count++] = title;
    for (int i = 1; i < netlist->line_count; i++) {
        const char *rest = netlist->lines[i].text;
        char word[DEA_TOKEN_MAX];
        if (i != instance->line && netlist->lines[i].passed && dea_netlist_token(&rest, word) &&
            !list_line(lister, netlist->lines[i].text, word))
            return false;
    }
    return all_differ(lister->names, lister->name_count);
}

enum dea_status dea_linear_list(const struct dea_netlist *netlist, struct dea_listing *listing, bool *plain,
                                struct dea_error *error) {
    struct lister lister = {.listing = listing};
    *listing = (struct dea_listing){0};
    *plain = false;
    listing->lines = calloc((size_t)netlist->line_count, sizeof *listing->lines);
    lister.names = calloc((size_t)netlist->line_count, sizeof *lister.names);
    enum dea_status status = DEA_OK;
    if (listing->lines == NULL || lister.names == NULL)
        status = dea_fail(error, DEA_ERR_MEMORY, "out of memory for the circuit");
    else
        *plain = strchr(netlist->instances[0].path, '.') == NULL && dea_parameters_read(&lister.parameters, netlist) &&
                 list_all(&lister, netlist);
    for (int i = 0; i < lister.name_count; i++)
        free(lister.names[i]);
    free(lister.names);
    dea_parameters_clear(&lister.parameters);
    return status;
}
