/* Which signals a picture shows, and which share a panel. */
#include "plot_internal.h"

#include <math.h>
#include <string.h>

#define LONGEST_OWNER 24 /* characters of a name in a key; four such stand side by side */

/* Kinds of panels in the order of their importance: the first DEA_PANELS with signals are drawn. An entry without
 * quantities takes what no other has taken, one unit at a time. */
static const struct kind {
    const char *axis;
    const char *quantities[6]; /* last word of a signal's name, or its last two */
    const char *unit;          /* SI; NULL: any */
} kinds[] = {
    {"Voltage", {"voltage", "port_voltage"}, "V"},
    {"Displacement", {"x"}, "m"},
    {"True field", {"true_field", "breakdown_field"}, "V/m"},
    {"Energy", {"energy.in", "energy.stored", "energy.dissipated", "energy.imbalance"}, "J"},
    {"Current", {"current"}, "A"},
    {"Velocity", {"v"}, "m/s"},
    {"Charge", {"charge"}, "C"},
    {"Capacitance", {"capacitance"}, "F"},
    {"Stretch", {"stretch"}, "1"},
    {"Tension", {"tension"}, NULL},
    {"Stress across", {"stress2"}, "Pa"},
    {"Signals", {NULL}, NULL},
};
enum { KINDS = sizeof kinds / sizeof kinds[0] };

/* Length of what stands before `quantity` in the name ("DEB.left." -> 9), or -1 when the name does not end with it. */
static int prefix_length(const char *name, const char *quantity) {
    size_t whole = strlen(name), tail = strlen(quantity);
    if (tail > whole || strcmp(name + whole - tail, quantity) != 0)
        return -1;
    return tail == whole || name[whole - tail - 1] == '.' ? (int)(whole - tail) : -1;
}

/* Which quantity of the kind a signal is, -1 when none; *prefix is the length of the words before it. */
static int match(const struct kind *kind, const struct dea_signal *signal, int *prefix) {
    if (kind->unit != NULL && strcmp(kind->unit, signal->unit) != 0)
        return -1;
    for (int i = 0; i < 6 && kind->quantities[i] != NULL; i++) {
        *prefix = prefix_length(signal->name, kind->quantities[i]);
        if (*prefix >= 0)
            return i;
    }
    return -1;
}

static int kind_of(const struct dea_signal *signal, int *quantity, int *prefix) {
    for (int k = 0; k < KINDS - 1; k++) {
        *quantity = match(&kinds[k], signal, prefix);
        if (*quantity >= 0)
            return k;
    }
    *quantity = 0;
    *prefix = (int)strlen(signal->name);
    return KINDS - 1;
}

/* ---- curves ---- */

/* Places in the palette belong to names ("left", "DEB.right"), so a zone has one colour in all panels. */
struct owners {
    char names[DEA_PANEL_CURVES][96];
    int count;
};

static int place_of(struct owners *owners, const char *name) {
    for (int i = 0; i < owners->count; i++)
        if (strcmp(owners->names[i], name) == 0)
            return i;
    if (owners->count == DEA_PANEL_CURVES)
        return DEA_PANEL_CURVES - 1;
    snprintf(owners->names[owners->count], sizeof owners->names[0], "%s", name);
    return owners->count++;
}

enum { PALETTE_ZONES, PALETTE_DEVICES, PALETTE_ENERGY };

static void describe(struct dea_panel_curve *curve, const struct dea_signal *signal, int kind, int quantity, int prefix,
                     struct owners *zones, struct owners *devices) {
    char owner[96];
    int length = prefix > 0 && signal->name[prefix - 1] == '.' ? prefix - 1 : prefix;
    snprintf(owner, sizeof owner, "%.*s", length, signal->name);
    const char *what = kind < KINDS - 1 ? kinds[kind].quantities[quantity] : "";
    const char *addition = "";
    if (strcmp(what, "port_voltage") == 0) {
        curve->broad = true;
        addition = "port";
    } else if (strcmp(what, "breakdown_field") == 0) {
        curve->dashed = true;
        addition = "breakdown";
    } else if (strncmp(what, "energy.", 7) == 0) {
        addition = what + 7;
    }
    snprintf(curve->label, sizeof curve->label, "%.*s%s%s%s", LONGEST_OWNER, owner,
             strlen(owner) > LONGEST_OWNER ? "..." : "", owner[0] != '\0' && addition[0] != '\0' ? " " : "", addition);
    bool of_device = strcmp(what, "x") == 0 || strcmp(what, "v") == 0;
    curve->palette = of_device ? PALETTE_DEVICES : PALETTE_ZONES;
    if (strncmp(what, "energy.", 7) == 0) {
        curve->palette = PALETTE_ENERGY;
        curve->colour = quantity;
        curve->broad = quantity == 0;                      /* what goes in is mostly stored */
        curve->dashed = place_of(devices, owner) % 2 == 1; /* the colours belong to the energies */
    } else {
        curve->colour = place_of(of_device ? devices : zones, owner);
    }
}

static void add_curve(struct dea_panel *panel, const struct dea_panel_curve *curve) {
    if (panel->curve_count < DEA_PANEL_CURVES)
        panel->curves[panel->curve_count++] = *curve;
    else
        panel->left_out++;
}

/* All signals of a kind; of the last kind those of the first unit met that no earlier panel has. */
static void fill_panel(const struct dea_table *table, int kind, const char *taken_units[], int taken,
                       struct owners *zones, struct owners *devices, struct dea_panel *panel) {
    *panel = (struct dea_panel){.axis = kinds[kind].axis};
    for (size_t i = 1; i < table->column_count; i++) {
        int quantity, prefix;
        const struct dea_signal *signal = &table->columns[i];
        if (kind_of(signal, &quantity, &prefix) != kind)
            continue;
        bool known = false;
        for (int k = 0; k < taken; k++)
            known = known || strcmp(taken_units[k], signal->unit) == 0;
        if (known || (panel->curve_count > 0 && strcmp(panel->unit, signal->unit) != 0))
            continue;
        snprintf(panel->unit, sizeof panel->unit, "%s", signal->unit);
        struct dea_panel_curve curve = {.column = i};
        describe(&curve, signal, kind, quantity, prefix, zones, devices);
        add_curve(panel, &curve);
    }
}

int dea_panels_choose(const struct dea_table *table, struct dea_panel panels[DEA_PANELS]) {
    struct owners zones = {.count = 0}, devices = {.count = 0};
    const char *taken_units[DEA_PANELS];
    int count = 0, taken = 0;
    for (int kind = 0; kind < KINDS && count < DEA_PANELS;) {
        bool last = kind == KINDS - 1;
        fill_panel(table, kind, taken_units, last ? taken : 0, &zones, &devices, &panels[count]);
        if (panels[count].curve_count == 0) {
            kind++;
            continue;
        }
        if (last)
            taken_units[taken++] = panels[count].unit; /* and once more, for the next unit */
        else
            kind++;
        count++;
    }
    return count;
}

/* ---- units ---- */

void dea_plot_unit(const char *si_unit, double largest, char *unit, size_t size, double *factor) {
    static const struct {
        double scale;
        const char *symbol;
    } prefixes[] = {{1e9, "G"},  {1e6, "M"},  {1e3, "k"},   {1.0, ""},   {1e-3, "m"},
                    {1e-6, "µ"}, {1e-9, "n"}, {1e-12, "p"}, {1e-15, "f"}};
    static const char *const simple[] = {"s", "m", "V", "A", "C", "F", "J", "N", "W", "Pa", "m/s", "N/m"};
    *factor = 1.0;
    if (strcmp(si_unit, "V/m") == 0) { /* breakdown strengths are quoted in it */
        *factor = 1e-6;
        snprintf(unit, size, "V/µm");
        return;
    }
    snprintf(unit, size, "%s", strcmp(si_unit, "1") == 0 ? "" : si_unit);
    for (size_t i = 0; i < sizeof simple / sizeof simple[0]; i++) {
        if (strcmp(si_unit, simple[i]) != 0 || !(largest > 0.0))
            continue;
        bool time = strcmp(si_unit, "s") == 0;
        size_t k = time ? 3 : 0; /* no kiloseconds */
        while (k + 1 < sizeof prefixes / sizeof prefixes[0] && largest < prefixes[k].scale * 0.99995)
            k++;
        *factor = 1.0 / prefixes[k].scale;
        snprintf(unit, size, "%s%s", prefixes[k].symbol, si_unit);
    }
}
