/* output and expect: which signals to write, and what a test scene expects of them. */
#include "scene/readers.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define MAX_ROWS 1e8 /* of a result file */

/* ---- signal names ---- */

static const struct signal_kind {
    const char *name, *unit;
    bool electrical; /* only of electroded zones */
} zone_signals[] = {
    {"voltage", "V", true},  {"port_voltage", "V", true}, {"charge", "C", true},
    {"current", "A", true},  {"capacitance", "F", true},  {"true_field", "V/m", true},
    {"stretch", "1", false}, {"tension", "N", false},     {"stress2", "Pa", false},
};

static const char *const energy_signals[] = {"energy.in", "energy.stored", "energy.dissipated",
                                             "energy.imbalance"}; /* J */
#define DEVICE_SIGNALS (2 + DEA_COUNT(energy_signals))            /* x, v, energies */

/* Every signal of the scene, as "left.voltage" or, with several devices, "DEB.left.voltage". malloc'd. */
struct signal_list {
    char (*names)[96];
    const char **pointers, **units;
    size_t count;
};

static void add_signal(struct signal_list *list, const char *prefix, const char *zone, const char *name,
                       const char *unit) {
    snprintf(list->names[list->count], sizeof list->names[0], "%s%s%s%s%s", prefix, prefix[0] != '\0' ? "." : "", zone,
             zone[0] != '\0' ? "." : "", name);
    list->pointers[list->count] = list->names[list->count];
    list->units[list->count++] = unit;
}

static void free_signals(struct signal_list *list) {
    free(list->names);
    free(list->pointers);
    free(list->units);
}

static enum dea_status list_signals(const struct dea_scene *scene, struct signal_list *list, struct dea_error *error) {
    size_t most = (size_t)scene->device_count * (DEVICE_SIGNALS + DEA_ZONES * DEA_COUNT(zone_signals));
    *list = (struct signal_list){calloc(most, sizeof *list->names), calloc(most, sizeof *list->pointers),
                                 calloc(most, sizeof *list->units), 0};
    if (list->names == NULL || list->pointers == NULL || list->units == NULL) {
        free_signals(list);
        return dea_fail(error, DEA_ERR_MEMORY, "out of memory for the names of signals");
    }
    for (int d = 0; d < scene->device_count; d++) {
        const char *prefix = scene->device_count > 1 ? scene->devices[d].name : "";
        add_signal(list, prefix, "", "x", "m");
        add_signal(list, prefix, "", "v", "m/s");
        for (int k = 0; k < DEA_ZONES; k++) {
            const struct dea_zone *zone = &scene->devices[d].device.zones[k];
            for (size_t i = 0; zone->present && i < DEA_COUNT(zone_signals); i++)
                if (zone->electroded || !zone_signals[i].electrical)
                    add_signal(list, prefix, dea_zone_names[k], zone_signals[i].name, zone_signals[i].unit);
        }
        for (size_t i = 0; i < DEA_COUNT(energy_signals); i++)
            add_signal(list, prefix, "", energy_signals[i], "J");
    }
    return DEA_OK;
}

/* Copies a signal's name and finds its unit. */
static enum dea_status read_signal(const struct dea_node *node, const struct signal_list *list, char *name, size_t size,
                                   const char **unit, struct dea_error *error) {
    DEA_TRY(dea_field_text(node, size, name, error));
    for (size_t i = 0; i < list->count; i++)
        if (strcmp(list->names[i], name) == 0) {
            *unit = list->units[i];
            return DEA_OK;
        }
    char allowed[700] = "";
    for (size_t i = 0, length = 0; i < list->count && length + 100 < sizeof allowed; i++)
        length +=
            (size_t)snprintf(allowed + length, sizeof allowed - length, "%s%s", i > 0 ? ", " : "", list->names[i]);
    const char *nearest = dea_nearest_name(name, list->pointers, list->count);
    if (nearest != NULL)
        return dea_node_fail(node, error, "the scene has no signal '%.95s'; did you mean '%s'? allowed: %s", name,
                             nearest, allowed);
    return dea_node_fail(node, error, "the scene has no signal '%.95s'; allowed: %s", name, allowed);
}

/* ---- output ---- */

static enum dea_status read_formats(const struct dea_node *node, void *target, struct dea_error *error) {
    static const char *const names[] = {"csv", "raw", "hdf5", NULL};
    struct dea_scene *scene = target;
    int format;
    DEA_TRY(dea_field_list(node, "formats", 0, 3, error));
    scene->formats = 0;
    for (size_t i = 0; i < node->count; i++) {
        DEA_TRY(dea_field_choice(node->items[i], names, &format, error));
        scene->formats |= 1u << format; /* the bits of enum dea_format */
    }
    return DEA_OK;
}

static enum dea_status read_signal_names(const struct dea_node *node, const struct signal_list *list,
                                         struct dea_scene *scene, struct dea_error *error) {
    char name[96];
    const char *unit;
    DEA_TRY(dea_field_list(node, "signals", 1, list->count, error));
    scene->signals = calloc(node->count, sizeof *scene->signals);
    if (scene->signals == NULL)
        return dea_fail(error, DEA_ERR_MEMORY, "out of memory for the names of signals");
    for (size_t i = 0; i < node->count; i++) {
        DEA_TRY(read_signal(node->items[i], list, name, sizeof name, &unit, error));
        for (size_t j = 0; j < scene->signal_count; j++)
            if (strcmp(scene->signals[j], name) == 0)
                return dea_node_fail(node->items[i], error, "signal '%s' is already in the list", name);
        scene->signals[i] = strdup(name);
        if (scene->signals[i] == NULL)
            return dea_fail(error, DEA_ERR_MEMORY, "out of memory for the names of signals");
        scene->signal_count++;
    }
    return DEA_OK;
}

enum dea_status dea_read_output(const struct dea_node *node, struct dea_scene *scene, struct dea_error *error) {
    static const struct dea_field fields[] = {
        {.key = "sample",
         .offset = offsetof(struct dea_scene, sample),
         .range = {.unit = "s", .low = 1e-12, .high = 1e8}},
        {.key = "formats", .kind = DEA_FIELD_READER, .read = read_formats},
        {.key = "signals", .kind = DEA_FIELD_ELSEWHERE},
    };
    DEA_TRY(dea_fields_read(node, "an output", fields, DEA_COUNT(fields), scene, error));
    const struct dea_node *sample = dea_node_get(node, "sample"), *names = dea_node_get(node, "signals");
    if (sample != NULL && scene->has_transient && scene->sample > scene->stop)
        return dea_node_fail(sample, error, "the sample time %g s is longer than the run, %g s", scene->sample,
                             scene->stop);
    if (sample != NULL && scene->has_transient && scene->stop / scene->sample > MAX_ROWS)
        return dea_node_fail(sample, error, "the run would write %.3g rows; at most %g are allowed",
                             scene->stop / scene->sample, MAX_ROWS);
    if (names == NULL)
        return DEA_OK;
    struct signal_list list;
    DEA_TRY(list_signals(scene, &list, error));
    enum dea_status status = read_signal_names(names, &list, scene, error);
    free_signals(&list);
    return status;
}

/* ---- expect ---- */

static const struct dea_field expectation_fields[] = {
    {.key = "signal", .kind = DEA_FIELD_ELSEWHERE},
    {.key = "measure", .kind = DEA_FIELD_ELSEWHERE, .required = true},
    {.key = "above", .kind = DEA_FIELD_ELSEWHERE},
    {.key = "below", .kind = DEA_FIELD_ELSEWHERE},
};

/* What is measured, and in which unit its bounds are (NULL: any, for a .measure of the netlist). */
static enum dea_status read_measure(const struct dea_node *node, const struct signal_list *list,
                                    const struct dea_scene *scene, struct dea_expectation *expectation,
                                    const char **unit, struct dea_error *error) {
    static const char *const measures[] = {"min", "max", "final", "t_max", NULL};
    const struct dea_node *signal = dea_node_get(node, "signal"), *measure = dea_node_get(node, "measure");
    int index = 0;
    DEA_TRY(dea_field_text(measure, sizeof expectation->name, expectation->name, error));
    if (signal != NULL) {
        DEA_TRY(read_signal(signal, list, expectation->signal, sizeof expectation->signal, unit, error));
        DEA_TRY(dea_field_choice(measure, measures, &index, error));
        expectation->measure = (enum dea_measure)index;
        if (expectation->measure == DEA_MEASURE_T_MAX)
            *unit = "s";
        return DEA_OK;
    }
    for (index = 0; measures[index] != NULL; index++)
        if (strcmp(expectation->name, measures[index]) == 0)
            return dea_node_fail(measure, error, "measure '%s' needs the key 'signal'", expectation->name);
    if (scene->netlist == NULL)
        return dea_node_fail(measure, error, "without a netlist there is no .measure '%s'; give a signal",
                             expectation->name);
    expectation->measure = DEA_MEASURE_NETLIST;
    *unit = NULL;
    return DEA_OK;
}

static enum dea_status read_expectation(const struct dea_node *node, const struct signal_list *list,
                                        const struct dea_scene *scene, struct dea_expectation *expectation,
                                        struct dea_error *error) {
    const struct dea_node *above = dea_node_get(node, "above"), *below = dea_node_get(node, "below");
    *expectation = (struct dea_expectation){.above = -INFINITY, .below = INFINITY, .line = node->line};
    snprintf(expectation->file, sizeof expectation->file, "%.255s", node->origin->path);
    DEA_TRY(dea_fields_check_keys(node, "an expectation", expectation_fields, DEA_COUNT(expectation_fields), error));
    struct dea_range range = {.low = -INFINITY, .high = INFINITY};
    DEA_TRY(read_measure(node, list, scene, expectation, &range.unit, error));
    if (above != NULL)
        DEA_TRY(dea_field_quantity(above, &range, &expectation->above, error));
    if (below != NULL)
        DEA_TRY(dea_field_quantity(below, &range, &expectation->below, error));
    if (above == NULL && below == NULL)
        return dea_node_fail(node, error, "an expectation needs a bound: above, below or both");
    if (!(expectation->above < expectation->below))
        return dea_node_fail(above, error, "nothing lies above %g and below %g", expectation->above,
                             expectation->below);
    return DEA_OK;
}

enum dea_status dea_read_expectations(const struct dea_node *node, struct dea_scene *scene, struct dea_error *error) {
    struct signal_list list;
    DEA_TRY(dea_field_list(node, "expectations", 0, 1000, error));
    if (node->count == 0)
        return DEA_OK;
    scene->expectations = calloc(node->count, sizeof *scene->expectations);
    if (scene->expectations == NULL)
        return dea_fail(error, DEA_ERR_MEMORY, "out of memory for %zu expectations", node->count);
    scene->expectation_count = node->count;
    DEA_TRY(list_signals(scene, &list, error));
    enum dea_status status = DEA_OK;
    for (size_t i = 0; i < node->count && status == DEA_OK; i++)
        status = read_expectation(node->items[i], &list, scene, &scene->expectations[i], error);
    free_signals(&list);
    return status;
}
