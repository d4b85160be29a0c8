/* Elements of a linear circuit as entries of the modified nodal equations. */
#include "circuit/linear_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- unknowns ---- */

enum dea_status dea_linear_find_node(struct reader *reader, const char *name, int *node) {
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
    DEA_TRY(dea_linear_find_node(reader, reader->words[3], &cp));
    DEA_TRY(dea_linear_find_node(reader, reader->words[4], &cn));
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

enum dea_status dea_linear_read_element(struct reader *reader, bool second) {
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
    DEA_TRY(dea_linear_find_node(reader, reader->words[1], &p));
    DEA_TRY(dea_linear_find_node(reader, reader->words[2], &n));
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

enum dea_status dea_linear_read_initials(struct reader *reader) {
    struct dea_network *network = reader->network;
    for (int word = 1; word < reader->word_count; word += 3) {
        struct dea_network_initial initial;
        int known = network->node_count;
        if (word + 2 >= reader->word_count || strcmp(reader->words[word], "v") != 0 ||
            !dea_spice_number(reader->words[word + 2], &initial.voltage)) {
            reader->linear = false;
            return DEA_OK;
        }
        DEA_TRY(dea_linear_find_node(reader, reader->words[word + 1], &initial.node));
        if (network->node_count > known) { /* ngspice warns of it */
            reader->linear = false;
            return DEA_OK;
        }
        struct dea_network_initial *grown = dea_grow(network->initials, (int)network->initial_count, sizeof *grown);
        if (grown == NULL)
            return dea_fail(reader->error, DEA_ERR_MEMORY, "out of memory for the circuit's initial voltages");
        network->initials = grown;
        if (initial.node != GROUND)
            grown[network->initial_count++] = initial;
    }
    return DEA_OK;
}
