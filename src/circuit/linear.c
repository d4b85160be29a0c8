/* From a flattened listing to modified nodal equations. */
#include "circuit/linear_internal.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#define LISTING_CUT 4000     /* shorter lines of a listing are whole */
#define SEPARATORS " \t(),=" /* between words */

/* ---- words ---- */

/* Cuts at blanks, brackets, commas and =, all of which only separate. */
static bool cut_words(struct reader *reader, const char *text) {
    free(reader->line);
    free(reader->words);
    reader->word_count = 0;
    reader->line = strdup(text);
    reader->words = malloc((strlen(text) / 2 + 1) * sizeof *reader->words);
    if (reader->line == NULL || reader->words == NULL)
        return false;
    for (char *c = reader->line; *c != '\0'; c++)
        *c = (char)tolower((unsigned char)*c);
    char *rest = reader->line;
    for (char *word = strtok_r(rest, SEPARATORS, &rest); word != NULL; word = strtok_r(NULL, SEPARATORS, &rest))
        reader->words[reader->word_count++] = word;
    return true;
}

/* ---- the whole ---- */

/* Elements of the device's own subcircuit are the plant's business: "b.xdea.bq0". */
static bool belongs_to_device(const char *name, const char *path) {
    size_t length = strlen(path);
    return name[0] != '\0' && name[1] == '.' && strncasecmp(name + 2, path, length) == 0 && name[2 + length] == '.';
}

/* ngspice turns the n-th par('..') of a .measure line into "bpa_0n pa_0n 0 v=..": nothing else hangs on it. */
static bool belongs_to_measure(const struct reader *reader) {
    const char *name = reader->words[0];
    return reader->word_count > 2 && strncmp(name, "bpa_", 4) == 0 && strcmp(reader->words[1], name + 1) == 0 &&
           isdigit((unsigned char)name[4]);
}

/* ngspice cuts the lines of its listing off at 4096 characters. Such a line of the top level is read from the netlist
 * itself, where both agree in every word up to the cut; NULL: they do not. */
static const char *find_whole_line(struct reader *reader, const char *listed, const struct dea_netlist *netlist) {
    if (strlen(listed) < LISTING_CUT)
        return listed;
    for (int i = 1; i < netlist->line_count; i++) {
        const char *text = netlist->lines[i].text, *a = listed, *b = text;
        if (!netlist->lines[i].passed || strlen(text) < LISTING_CUT)
            continue;
        for (;; a++, b++) {
            a += strspn(a, SEPARATORS);
            b += strspn(b, SEPARATORS);
            if (*a == '\0' || tolower((unsigned char)*a) != tolower((unsigned char)*b))
                break;
        }
        if (*a == '\0')
            return text;
    }
    reader->linear = false;
    return NULL;
}

static bool is_harmless_command(const char *word) {
    static const char *const harmless[] = {".tran",  ".end",    ".options", ".option", ".save",
                                           ".param", ".global", ".ends",    ".ic",     ".nodeset"};
    for (size_t i = 0; i < sizeof harmless / sizeof harmless[0]; i++)
        if (strcmp(word, harmless[i]) == 0)
            return true;
    return false;
}

static enum dea_status read_pass(struct reader *reader, const struct dea_listing *listing,
                                 const struct dea_netlist *netlist, int pos, bool second, char *why, size_t why_size) {
    const struct dea_netlist_instance *instance = &netlist->instances[0];
    for (int i = 1; i < listing->count && reader->linear; i++) { /* line 0 is the title */
        const char *line = find_whole_line(reader, listing->lines[i], netlist);
        if (line == NULL)
            snprintf(why, why_size, "%s", listing->lines[i]);
        if (line == NULL)
            break;
        if (!cut_words(reader, line))
            return dea_fail(reader->error, DEA_ERR_MEMORY, "out of memory for the circuit");
        if (reader->word_count == 0 || reader->words[0][0] == '*' ||
            belongs_to_device(reader->words[0], instance->path) || belongs_to_measure(reader))
            continue;
        if (strcmp(reader->words[0], ".ic") == 0 && second) /* all nodes are known by then */
            DEA_TRY(dea_linear_read_initials(reader));
        else if (reader->words[0][0] == '.')
            reader->linear = is_harmless_command(reader->words[0]);
        else
            DEA_TRY(dea_linear_read_element(reader, second));
        /* what listens to the position is not part of a linear circuit */
        for (int w = 1; w < reader->word_count && reader->linear && reader->words[0][0] != '.'; w++)
            reader->linear =
                strcmp(reader->words[w], instance->nodes[pos]) != 0 || strcmp(instance->nodes[pos], "0") == 0;
        if (!reader->linear)
            snprintf(why, why_size, "%s", listing->lines[i]);
    }
    return DEA_OK;
}

/* Without a DC path to ground there may be no operating point, which ngspice explains better. A path that only
 * controlled current sources make does not count here: such a circuit is merely solved the slower way. */
static void check_ground(struct reader *reader, char *why, size_t why_size) {
    int floating = dea_islands_find_floating(&reader->islands, reader->network->node_count);
    if (!reader->linear || floating < 0)
        return;
    reader->linear = false;
    snprintf(why, why_size, "node %s has no DC path to ground", reader->network->names[floating]);
}

/* Branch rows go behind the nodes, now that their number is known. */
static enum dea_status number_branches(struct reader *reader) {
    struct dea_network *network = reader->network;
    int nodes = network->node_count, count = nodes + reader->branch_count;
    network->branch_count = reader->branch_count;
    for (size_t s = 0; s < network->conductance_count + network->capacitance_count; s++) {
        struct dea_stamp *entry = s < network->conductance_count
                                      ? &network->conductances[s]
                                      : &network->capacitances[s - network->conductance_count];
        entry->row = entry->row >= BRANCH ? entry->row - BRANCH + nodes : entry->row;
        entry->column = entry->column >= BRANCH ? entry->column - BRANCH + nodes : entry->column;
    }
    for (size_t s = 0; s < network->source_count; s++)
        if (network->sources[s].row >= BRANCH)
            network->sources[s].row += nodes - BRANCH;
    char **names = realloc(network->names, (size_t)(count + 1) * sizeof *names);
    network->imposed = calloc((size_t)count + 1, sizeof *network->imposed);
    if (names != NULL)
        network->names = names;
    if (names == NULL || network->imposed == NULL)
        return dea_fail(reader->error, DEA_ERR_MEMORY, "out of memory for the circuit's unknowns");
    for (int i = 0; i < reader->branch_count; i++) {
        network->names[nodes + i] = NULL;
        if (asprintf(&network->names[nodes + i], "%s#branch", reader->branches[i].name) < 0)
            return dea_fail(reader->error, DEA_ERR_MEMORY, "out of memory for the circuit's unknowns");
        network->imposed[nodes + i] = reader->branches[i].imposed;
    }
    return DEA_OK;
}

/* Options that change the circuit itself and not only how it is solved. */
static bool changes_circuit(const char *line) {
    static const char *const harmless[] = {
        "abstol",    "reltol",   "vntol",       "chgtol", "trtol", "gmin",        "gminsteps",
        "srcsteps",  "itl1",     "itl2",        "itl3",   "itl4",  "itl5",        "itl6",
        "pivtol",    "pivrel",   "method",      "maxord", "xmu",   "minbreak",    "noopiter",
        "convlimit", "convstep", "convabsstep", "bypass", "trap",  "trapezoidal", "gear"};
    const char *cursor = line;
    char token[DEA_TOKEN_MAX];
    double ignored;
    if (strncasecmp(line, ".opt", 4) != 0 || !dea_netlist_token(&cursor, token))
        return false;
    while (dea_netlist_token(&cursor, token)) {
        bool known = strcmp(token, "=") == 0 || dea_spice_number(token, &ignored);
        for (size_t i = 0; i < sizeof harmless / sizeof harmless[0] && !known; i++)
            known = strcasecmp(token, harmless[i]) == 0;
        if (!known)
            return true;
    }
    return false;
}

bool dea_linear_possible(const struct dea_netlist *netlist) {
    if (netlist->instance_count != 1 || !dea_measures_movable(netlist) || netlist->tran.uic || netlist->has_event_parts)
        return false;
    for (int i = 1; i < netlist->line_count; i++) {
        const char *text = netlist->lines[i].text + strspn(netlist->lines[i].text, " \t");
        char first = (char)tolower((unsigned char)text[0]);
        if (netlist->lines[i].passed && (strncasecmp(text, ".temp", 5) == 0 || changes_circuit(text) ||
                                         (first != '\0' && strchr("rclkviegfhx.*$;+", first) == NULL)))
            return false;
    }
    return true;
}

enum dea_status dea_linear_read(const struct dea_listing *listing, const struct dea_netlist *netlist,
                                const int zones[DEA_ZONES], int port_count, double step, double stop,
                                struct dea_network *network, bool *linear, char *why, size_t why_size,
                                struct dea_error *error) {
    *network = (struct dea_network){.ports = {{GROUND, GROUND}, {GROUND, GROUND}}};
    struct reader reader = {.network = network, .step = step, .stop = stop, .linear = true, .error = error};
    const struct dea_netlist_instance *instance = &netlist->instances[0];
    enum dea_status status = DEA_OK;
    for (int p = 0; p < port_count && status == DEA_OK; p++) {
        status = dea_linear_find_node(&reader, instance->nodes[2 * p], &network->ports[zones[p]].p);
        if (status == DEA_OK)
            status = dea_linear_find_node(&reader, instance->nodes[2 * p + 1], &network->ports[zones[p]].n);
    }
    for (int pass = 0; pass < 2 && status == DEA_OK; pass++)
        status = read_pass(&reader, listing, netlist, 2 * port_count, pass == 1, why, why_size);
    if (status == DEA_OK)
        check_ground(&reader, why, why_size);
    if (status == DEA_OK)
        status = number_branches(&reader);
    *linear = reader.linear;
    dea_islands_clear(&reader.islands);
    for (int i = 0; i < reader.branch_count; i++)
        free(reader.branches[i].name);
    free(reader.branches);
    free(reader.line);
    free(reader.words);
    return status;
}

void dea_network_clear(struct dea_network *network) {
    for (int i = 0; network->names != NULL && i < network->node_count + network->branch_count; i++)
        free(network->names[i]);
    for (size_t i = 0; i < network->source_count; i++)
        dea_waveform_clear(&network->sources[i].waveform);
    free(network->names);
    free(network->imposed);
    free(network->conductances);
    free(network->capacitances);
    free(network->sources);
    free(network->initials);
    *network = (struct dea_network){0};
}
