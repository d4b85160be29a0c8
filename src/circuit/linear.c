/* From a flattened listing to modified nodal equations. */
#include "circuit/linear.h"

#include "circuit/netlist_internal.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

enum { MAX_WORDS = 4096, GROUND = -1 };

/* A voltage-defined branch and the element it belongs to. */
struct branch {
    char *name; /* owned: "l1", "v.xa.v2" */
    double inductance;
    bool imposed;
};

struct reader {
    struct dea_network *network;
    struct branch *branches; /* owned */
    int branch_count;
    char *words[MAX_WORDS]; /* of the present line */
    int word_count;
    char *line; /* owned copy, cut into words */
    double step, stop;
    bool linear;
    struct dea_error *error;
};

/* ---- words ---- */

/* Cuts at blanks; brackets, commas and = count as blanks but stay visible to the parser as separators only. */
static bool cut_words(struct reader *reader, const char *text) {
    free(reader->line);
    reader->word_count = 0;
    reader->line = strdup(text);
    if (reader->line == NULL)
        return false;
    for (char *c = reader->line; *c != '\0'; c++) {
        if (strchr("(),=", *c) != NULL)
            *c = ' ';
        *c = (char)tolower((unsigned char)*c);
    }
    char *rest = reader->line;
    for (char *word = strtok_r(rest, " \t", &rest); word != NULL && reader->word_count < MAX_WORDS;
         word = strtok_r(NULL, " \t", &rest))
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
    reader->branches[reader->branch_count++] = (struct branch){copy, inductance, imposed};
    return DEA_OK;
}

/* ---- stamps: branch rows are numbered from BRANCH on until the number of nodes is known ---- */

enum { BRANCH = 1 << 24 };

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

/* Admittance between two nodes. */
static enum dea_status stamp_pair(struct reader *reader, bool capacitive, int p, int n, double value) {
    DEA_TRY(stamp(reader, capacitive, p, p, value));
    DEA_TRY(stamp(reader, capacitive, n, n, value));
    DEA_TRY(stamp(reader, capacitive, p, n, -value));
    return stamp(reader, capacitive, n, p, -value);
}

/* A branch current between two nodes, and their difference in the branch's row. */
static enum dea_status stamp_branch(struct reader *reader, int p, int n, int branch) {
    DEA_TRY(stamp(reader, false, p, branch, 1.0));
    DEA_TRY(stamp(reader, false, n, branch, -1.0));
    DEA_TRY(stamp(reader, false, branch, p, 1.0));
    return stamp(reader, false, branch, n, -1.0);
}

/* ---- sources ---- */

static bool numbers(const struct reader *reader, int from, double *values, int most, int *count) {
    for (*count = 0; from + *count < reader->word_count; (*count)++)
        if (*count == most || !dea_spice_number(reader->words[from + *count], &values[*count]))
            return false;
    return true;
}

/* PULSE(v1 v2 td tr tf pw per) with ngspice's defaults. */
static bool read_pulse(const struct reader *reader, int from, struct dea_waveform *w) {
    double v[7] = {0};
    int count;
    if (!numbers(reader, from, v, 7, &count) || count < 2)
        return false;
    *w = (struct dea_waveform){.kind = DEA_WAVE_PULSE, .low = v[0], .high = v[1], .delay = fmax(v[2], 0.0)};
    w->rise = v[3] > 0.0 ? v[3] : reader->step;
    w->fall = v[4] > 0.0 ? v[4] : reader->step;
    w->width = v[5] > 0.0 ? v[5] : reader->stop;
    w->period = v[6] > 0.0 ? v[6] : reader->stop;
    return w->period >= w->rise + w->width + w->fall || v[6] <= 0.0;
}

/* SIN(vo va freq td theta phase) */
static bool read_sine(const struct reader *reader, int from, struct dea_waveform *w) {
    double v[6] = {0};
    int count;
    if (!numbers(reader, from, v, 6, &count) || count < 2)
        return false;
    *w = (struct dea_waveform){.kind = DEA_WAVE_SINE,
                               .offset = v[0],
                               .amplitude = v[1],
                               .delay = v[3],
                               .decay = v[4],
                               .phase = v[5] * M_PI / 180.0};
    w->frequency = v[2] > 0.0 ? v[2] : 1.0 / reader->stop;
    return true;
}

static bool read_points(const struct reader *reader, int from, struct dea_waveform *w) {
    int count = reader->word_count - from;
    if (count < 2 || count % 2 != 0)
        return false;
    *w = (struct dea_waveform){.kind = DEA_WAVE_PWL, .point_count = (size_t)count / 2};
    w->times = calloc(w->point_count, sizeof *w->times);
    w->values = calloc(w->point_count, sizeof *w->values);
    bool good = w->times != NULL && w->values != NULL;
    for (size_t i = 0; good && i < w->point_count; i++)
        good = dea_spice_number(reader->words[from + 2 * (int)i], &w->times[i]) &&
               dea_spice_number(reader->words[from + 2 * (int)i + 1], &w->values[i]);
    if (!good)
        dea_waveform_clear(w);
    return good;
}

/* "[dc] value", then pulse, sin or pwl: what follows the nodes of a source. */
static bool read_waveform(const struct reader *reader, int from, struct dea_waveform *w) {
    double level = 0.0;
    if (from < reader->word_count && strcmp(reader->words[from], "dc") == 0)
        from++;
    if (from < reader->word_count && dea_spice_number(reader->words[from], &level))
        from++;
    *w = (struct dea_waveform){.kind = DEA_WAVE_DC, .level = level};
    if (from >= reader->word_count)
        return true;
    const char *function = reader->words[from++];
    if (strcmp(function, "pulse") == 0)
        return read_pulse(reader, from, w);
    if (strcmp(function, "sin") == 0)
        return read_sine(reader, from, w);
    return strcmp(function, "pwl") == 0 && read_points(reader, from, w);
}

static enum dea_status add_source(struct reader *reader, int row, int other_row, int from) {
    struct dea_network *network = reader->network;
    struct dea_waveform waveform;
    struct dea_error ignored;
    if (!read_waveform(reader, from, &waveform)) {
        reader->linear = false;
        return DEA_OK;
    }
    if (dea_waveform_check(&waveform, &ignored) != DEA_OK) { /* ngspice has its own ideas of it */
        dea_waveform_clear(&waveform);
        reader->linear = false;
        return DEA_OK;
    }
    struct dea_network_source *sources = dea_grow(network->sources, (int)network->source_count, sizeof *sources);
    if (sources == NULL) {
        dea_waveform_clear(&waveform);
        return dea_fail(reader->error, DEA_ERR_MEMORY, "out of memory for the circuit's sources");
    }
    network->sources = sources;
    sources[network->source_count++] = (struct dea_network_source){row, other_row, waveform};
    if (row >= BRANCH)
        network->peak = fmax(network->peak, dea_waveform_peak(&waveform));
    return DEA_OK;
}

/* ---- elements ---- */

/* name p n value, nothing else; a capacitor's or inductor's ic is only used with uic, which is not linear here. */
static bool two_pole_value(const struct reader *reader, double *value) {
    bool plain = reader->word_count == 4 || (reader->word_count == 6 && strcmp(reader->words[4], "ic") == 0);
    return plain && dea_spice_number(reader->words[3], value) && isfinite(*value);
}

static enum dea_status read_two_pole(struct reader *reader, char kind, int p, int n) {
    double value;
    if (!two_pole_value(reader, &value) || (kind != 'c' && value == 0.0) || (kind == 'c' && value < 0.0) ||
        (kind == 'l' && value < 0.0)) {
        reader->linear = false;
        return DEA_OK;
    }
    if (kind == 'r')
        return stamp_pair(reader, false, p, n, 1.0 / value);
    if (kind == 'c')
        return stamp_pair(reader, true, p, n, value);
    int branch = BRANCH + reader->branch_count;
    DEA_TRY(add_branch(reader, reader->words[0], value, false));
    DEA_TRY(stamp_branch(reader, p, n, branch));
    return stamp(reader, true, branch, branch, -value);
}

/* E and G: name p n cp cn gain. */
static enum dea_status read_voltage_controlled(struct reader *reader, char kind, int p, int n) {
    double gain;
    int cp, cn;
    if (reader->word_count != 6 || !dea_spice_number(reader->words[5], &gain)) {
        reader->linear = false;
        return DEA_OK;
    }
    DEA_TRY(find_node(reader, reader->words[3], &cp));
    DEA_TRY(find_node(reader, reader->words[4], &cn));
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
    double gain;
    int control = reader->word_count == 5 ? find_branch(reader, reader->words[3]) : -1;
    if (control < 0 || !dea_spice_number(reader->words[4], &gain)) {
        reader->linear = false;
        return DEA_OK;
    }
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
    if (first < 0 || second < 0 || !dea_spice_number(reader->words[3], &coupling)) {
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
        return add_source(reader, n, p, 3); /* flows from p through the source to n */
    default: {
        int branch = BRANCH + reader->branch_count;
        DEA_TRY(add_branch(reader, reader->words[0], 0.0, true));
        DEA_TRY(stamp_branch(reader, p, n, branch));
        return add_source(reader, branch, GROUND, 3);
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

static bool is_harmless_command(const char *word) {
    static const char *const harmless[] = {".tran", ".end",   ".options", ".option",
                                           ".save", ".param", ".global",  ".ends"};
    for (size_t i = 0; i < sizeof harmless / sizeof harmless[0]; i++)
        if (strcmp(word, harmless[i]) == 0)
            return true;
    return false;
}

static enum dea_status read_pass(struct reader *reader, const struct dea_listing *listing,
                                 const struct dea_netlist_instance *instance, int pos, bool second, char *why,
                                 size_t why_size) {
    for (int i = 1; i < listing->count && reader->linear; i++) { /* line 0 is the title */
        if (!cut_words(reader, listing->lines[i]))
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

bool dea_linear_possible(const struct dea_netlist *netlist) {
    if (netlist->instance_count != 1 || !dea_measures_movable(netlist) || netlist->tran.uic || netlist->has_event_parts)
        return false;
    for (int i = 1; i < netlist->line_count; i++) {
        const char *text = netlist->lines[i].text + strspn(netlist->lines[i].text, " \t");
        char first = (char)tolower((unsigned char)text[0]);
        bool starts_elsewhere = strncasecmp(text, ".ic", 3) == 0 || strncasecmp(text, ".nodeset", 8) == 0;
        if (netlist->lines[i].passed &&
            (starts_elsewhere || (first != '\0' && strchr("rclkviegfhx.*$;+", first) == NULL)))
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
        status = read_pass(&reader, listing, instance, 2 * port_count, pass == 1, why, why_size);
    if (status == DEA_OK)
        status = number_branches(&reader);
    *linear = reader.linear;
    for (int i = 0; i < reader.branch_count; i++)
        free(reader.branches[i].name);
    free(reader.branches);
    free(reader.line);
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
