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

/* ---- unknowns ---- */

static enum dea_status find_node(struct reader *reader, const char *name, int *node) {
    struct dea_network *network = reader->network;
    *node = GROUND;
    if (strcmp(name, "0") == 0 || strcmp(name, "gnd") == 0)
        return DEA_OK;
    for (*node = 0; *node < network->node_count; (*node)++)
        if (strcmp(network->names[*node], name) == 0)
            return DEA_OK;
    char **names = dea_grow(network->names, network->node_count, sizeof *names);
    if (names != NULL)
        network->names = names;
    char *copy = names != NULL ? strdup(name) : NULL;
    if (copy == NULL)
        return dea_fail(reader->error, DEA_ERR_MEMORY, "out of memory for the circuit's nodes");
    network->names[network->node_count++] = copy;
    return DEA_OK;
}

static int find_branch(const struct reader *reader, const char *name) {
    for (int i = 0; i < reader->branch_count; i++)
        if (strcmp(reader->branches[i].name, name) == 0)
            return i;
    return -1;
}

static enum dea_status add_branch(struct reader *reader, const char *name, double inductance, bool imposed) {
    struct branch *branches = dea_grow(reader->branches, reader->branch_count, sizeof *branches);
    if (branches != NULL)
        reader->branches = branches;
    char *copy = branches != NULL ? strdup(name) : NULL;
    if (copy == NULL)
        return dea_fail(reader->error, DEA_ERR_MEMORY, "out of memory for the circuit's branches");
    reader->branches[reader->branch_count++] = (struct branch){copy, inductance, false, imposed};
    return DEA_OK;
}

/* ---- stamps ---- */

static enum dea_status stamp(struct reader *reader, bool capacitive, int row, int column, double value) {
    struct dea_network *network = reader->network;
    if (row == GROUND || column == GROUND || value == 0.0)
        return DEA_OK;
    struct dea_stamp **list = capacitive ? &network->capacitances : &network->conductances;
    size_t *count = capacitive ? &network->capacitance_count : &network->conductance_count;
    struct dea_stamp *grown = dea_grow(*list, (int)*count, sizeof *grown);
    if (grown == NULL)
        return dea_fail(reader->error, DEA_ERR_MEMORY, "out of memory for the circuit's equations");
    *list = grown;
    grown[(*count)++] = (struct dea_stamp){row, column, value};
    return DEA_OK;
}

/* Current can flow at rest between the two nodes. */
static enum dea_status join(struct reader *reader, int p, int n) {
    if (!dea_islands_join(&reader->islands, p, n))
        return dea_fail(reader->error, DEA_ERR_MEMORY, "out of memory for the circuit's nodes");
    return DEA_OK;
}

/* Admittance between two nodes. */
static enum dea_status stamp_pair(struct reader *reader, bool capacitive, int p, int n, double value) {
    if (!capacitive)
        DEA_TRY(join(reader, p, n));
    DEA_TRY(stamp(reader, capacitive, p, p, value));
    DEA_TRY(stamp(reader, capacitive, n, n, value));
    DEA_TRY(stamp(reader, capacitive, p, n, -value));
    return stamp(reader, capacitive, n, p, -value);
}

/* A branch current between two nodes, and their difference in the branch's row. */
static enum dea_status stamp_branch(struct reader *reader, int p, int n, int branch) {
    DEA_TRY(join(reader, p, n));
    DEA_TRY(stamp(reader, false, p, branch, 1.0));
    DEA_TRY(stamp(reader, false, n, branch, -1.0));
    DEA_TRY(stamp(reader, false, branch, p, 1.0));
    return stamp(reader, false, branch, n, -1.0);
}

/* ---- elements ---- */

/* What may follow the nodes of R, C and L: a number, then names and numbers. */
struct two_pole {
    double value;      /* Ohm, F or H */
    double multiplier; /* so many in parallel */
    double scale, tc1, tc2, dtemp, temp;
    double initial; /* V or A; only used with uic, which is not linear here */
    double ac;      /* Ohm, for small signals only */
};

/* The number behind a name, NULL for a name that is not understood. */
static double *find_parameter(struct two_pole *pole, char kind, const char *name) {
    const struct {
        const char *name, *kinds;
        double *number;
    } known[] = {{"m", "rcl", &pole->multiplier}, {"scale", "rcl", &pole->scale},    {"tc", "rcl", &pole->tc1},
                 {"tc1", "rcl", &pole->tc1},      {"tc2", "rcl", &pole->tc2},        {"dtemp", "rcl", &pole->dtemp},
                 {"temp", "rcl", &pole->temp},    {"ic", "cl", &pole->initial},      {"ac", "r", &pole->ac},
                 {"r", "r", &pole->value},        {"resistance", "r", &pole->value}, {"c", "c", &pole->value},
                 {"l", "l", &pole->value}};
    for (size_t i = 0; i < sizeof known / sizeof known[0]; i++)
        if (strchr(known[i].kinds, kind) != NULL && strcmp(name, known[i].name) == 0)
            return known[i].number;
    return NULL;
}

/* Element value with its temperature and its multiples, as ngspice works them out. */
static bool two_pole_value(const struct reader *reader, char kind, double *value, bool *multiplied) {
    struct two_pole pole = {.value = NAN,
                            .multiplier = NAN,
                            .scale = NAN,
                            .tc1 = NAN,
                            .tc2 = NAN,
                            .dtemp = NAN,
                            .temp = NAN,
                            .initial = NAN,
                            .ac = NAN};
    int word = 3;
    if (dea_spice_number(reader->words[word], &pole.value))
        word++;
    for (; word + 1 < reader->word_count; word += 2) {
        double *number = find_parameter(&pole, kind, reader->words[word]);
        if (number == NULL || !isnan(*number) || !dea_spice_number(reader->words[word + 1], number))
            return false;
    }
    bool two_temperatures = !isnan(pole.temp) && !isnan(pole.dtemp);
    if (word != reader->word_count || !isfinite(pole.value) || two_temperatures)
        return false;
    double multiplier = isnan(pole.multiplier) ? 1.0 : pole.multiplier;
    *multiplied = multiplier != 1.0;
    double warmer = !isnan(pole.temp) ? pole.temp - NOMINAL_TEMPERATURE : isnan(pole.dtemp) ? 0.0 : pole.dtemp;
    double factor = 1.0 + warmer * ((isnan(pole.tc1) ? 0.0 : pole.tc1) + warmer * (isnan(pole.tc2) ? 0.0 : pole.tc2));
    *value = pole.value * factor * (isnan(pole.scale) ? 1.0 : pole.scale);
    *value = kind == 'c' ? *value * multiplier : *value / multiplier;
    return multiplier > 0.0 && isfinite(*value);
}

static enum dea_status read_two_pole(struct reader *reader, char kind, int p, int n) {
    double value;
    bool multiplied;
    if (!two_pole_value(reader, kind, &value, &multiplied) || (kind != 'c' && value == 0.0) ||
        (kind != 'r' && value < 0.0)) {
        reader->linear = false;
        return DEA_OK;
    }
    if (kind == 'r')
        return stamp_pair(reader, false, p, n, 1.0 / value);
    if (kind == 'c')
        return stamp_pair(reader, true, p, n, value);
    int branch = BRANCH + reader->branch_count;
    DEA_TRY(add_branch(reader, reader->words[0], value, false));
    reader->branches[branch - BRANCH].multiplied = multiplied;
    DEA_TRY(stamp_branch(reader, p, n, branch));
    return stamp(reader, true, branch, branch, -value);
}

/* "m number" at the end of a controlled or current source: so many in parallel. */
static double take_multiplier(struct reader *reader) {
    double multiplier = 1.0;
    if (reader->word_count > 5 && strcmp(reader->words[reader->word_count - 2], "m") == 0) {
        if (dea_spice_number(reader->words[reader->word_count - 1], &multiplier))
            reader->word_count -= 2;
    }
    return multiplier;
}

/* E and G: name p n cp cn gain. */
static enum dea_status read_voltage_controlled(struct reader *reader, char kind, int p, int n) {
    double gain, multiplier = kind == 'g' ? take_multiplier(reader) : 1.0;
    int cp, cn;
    if (reader->word_count != 6 || !dea_spice_number(reader->words[5], &gain)) {
        reader->linear = false;
        return DEA_OK;
    }
    DEA_TRY(find_node(reader, reader->words[3], &cp));
    DEA_TRY(find_node(reader, reader->words[4], &cn));
    gain *= multiplier;
    if (kind == 'g') {
        DEA_TRY(stamp(reader, false, p, cp, gain));
        DEA_TRY(stamp(reader, false, p, cn, -gain));
        DEA_TRY(stamp(reader, false, n, cp, -gain));
        return stamp(reader, false, n, cn, gain);
    }
    int branch = BRANCH + reader->branch_count;
    DEA_TRY(add_branch(reader, reader->words[0], 0.0, true));
    DEA_TRY(stamp_branch(reader, p, n, branch));
    DEA_TRY(stamp(reader, false, branch, cp, -gain));
    return stamp(reader, false, branch, cn, gain);
}

/* F and H, in a second pass, when every source has its branch: name p n vname gain. K: name l1 l2 coupling. */
static enum dea_status read_current_controlled(struct reader *reader, char kind, int p, int n) {
    double gain, multiplier = kind == 'f' ? take_multiplier(reader) : 1.0;
    int control = reader->word_count == 5 ? find_branch(reader, reader->words[3]) : -1;
    if (control < 0 || !dea_spice_number(reader->words[4], &gain)) {
        reader->linear = false;
        return DEA_OK;
    }
    gain *= multiplier;
    if (kind == 'f') {
        DEA_TRY(stamp(reader, false, p, BRANCH + control, gain));
        return stamp(reader, false, n, BRANCH + control, -gain);
    }
    int branch = BRANCH + reader->branch_count;
    DEA_TRY(add_branch(reader, reader->words[0], 0.0, true));
    DEA_TRY(stamp_branch(reader, p, n, branch));
    return stamp(reader, false, branch, BRANCH + control, -gain);
}

static enum dea_status read_coupling(struct reader *reader) {
    double coupling;
    int first = reader->word_count == 4 ? find_branch(reader, reader->words[1]) : -1;
    int second = reader->word_count == 4 ? find_branch(reader, reader->words[2]) : -1;
    if (first < 0 || second < 0 || !dea_spice_number(reader->words[3], &coupling) ||
        reader->branches[first].multiplied || reader->branches[second].multiplied) {
        reader->linear = false;
        return DEA_OK;
    }
    double mutual = coupling * sqrt(reader->branches[first].inductance * reader->branches[second].inductance);
    DEA_TRY(stamp(reader, true, BRANCH + first, BRANCH + second, -mutual));
    return stamp(reader, true, BRANCH + second, BRANCH + first, -mutual);
}

/* One element line; `second` is the pass for elements that refer to others. */
static enum dea_status read_element(struct reader *reader, bool second) {
    char kind = reader->words[0][0];
    bool refers = kind == 'f' || kind == 'h' || kind == 'k';
    if (refers != second)
        return DEA_OK;
    if (kind == 'k')
        return read_coupling(reader);
    if (strchr("rclvieghf", kind) == NULL || reader->word_count < 4) {
        reader->linear = false;
        return DEA_OK;
    }
    int p, n;
    DEA_TRY(find_node(reader, reader->words[1], &p));
    DEA_TRY(find_node(reader, reader->words[2], &n));
    switch (kind) {
    case 'r':
    case 'c':
    case 'l':
        return read_two_pole(reader, kind, p, n);
    case 'e':
    case 'g':
        return read_voltage_controlled(reader, kind, p, n);
    case 'f':
    case 'h':
        return read_current_controlled(reader, kind, p, n);
    case 'i':
        return dea_linear_add_source(reader, n, p, take_multiplier(reader)); /* from p through the source to n */
    default: {
        int branch = BRANCH + reader->branch_count;
        DEA_TRY(add_branch(reader, reader->words[0], 0.0, true));
        DEA_TRY(stamp_branch(reader, p, n, branch));
        return dea_linear_add_source(reader, branch, GROUND, 1.0);
    }
    }
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
        for (; *a != '\0' && *b != '\0'; a++, b++) {
            a += strspn(a, SEPARATORS);
            b += strspn(b, SEPARATORS);
            if (tolower((unsigned char)*a) != tolower((unsigned char)*b))
                break;
        }
        if (*a == '\0')
            return text;
    }
    reader->linear = false;
    return NULL;
}

static bool is_harmless_command(const char *word) {
    static const char *const harmless[] = {".tran", ".end",   ".options", ".option",
                                           ".save", ".param", ".global",  ".ends"};
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
        if (reader->words[0][0] == '.')
            reader->linear = is_harmless_command(reader->words[0]);
        else
            DEA_TRY(read_element(reader, second));
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
        bool starts_elsewhere = strncasecmp(text, ".ic", 3) == 0 || strncasecmp(text, ".nodeset", 8) == 0 ||
                                strncasecmp(text, ".temp", 5) == 0;
        if (netlist->lines[i].passed &&
            (starts_elsewhere || changes_circuit(text) || (first != '\0' && strchr("rclkviegfhx.*$;+", first) == NULL)))
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
        status = find_node(&reader, instance->nodes[2 * p], &network->ports[zones[p]].p);
        if (status == DEA_OK)
            status = find_node(&reader, instance->nodes[2 * p + 1], &network->ports[zones[p]].n);
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
    *network = (struct dea_network){0};
}
