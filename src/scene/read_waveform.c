/* Waveforms of sources (V) and of the load (N), by table per type. */
#include "scene/readers.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define MAX_KEYS 12

/* The unit of a level is that of what is driven; it is filled in when the table is used. */
#define LEVEL(name, member, is_required)                                                                               \
    {                                                                                                                  \
        .key = name, .required = is_required, .offset = offsetof(struct dea_waveform, member), .range = {              \
            .unit = NULL                                                                                               \
        }                                                                                                              \
    }
/* The checks of the waveform itself are finer; these ranges notice a forgotten unit. */
#define TIME(name, member, is_required)                                                                                \
    {                                                                                                                  \
        .key = name, .required = is_required, .offset = offsetof(struct dea_waveform, member), .range = {              \
            .unit = "s",                                                                                               \
            .low = 1e-12,                                                                                              \
            .high = 1e8,                                                                                               \
            .or_zero = true                                                                                            \
        }                                                                                                              \
    }
#define FREQUENCY(name, member, is_required)                                                                           \
    {                                                                                                                  \
        .key = name, .required = is_required, .offset = offsetof(struct dea_waveform, member), .range = {              \
            .unit = "Hz",                                                                                              \
            .low = 1e-9,                                                                                               \
            .high = 1e9                                                                                                \
        }                                                                                                              \
    }
#define TYPE_KEY                                                                                                       \
    { .key = "type", .kind = DEA_FIELD_ELSEWHERE, .required = true }
#define REPEAT_KEY                                                                                                     \
    { .key = "repeat", .kind = DEA_FIELD_BOOL, .offset = offsetof(struct dea_waveform, repeat) }

static const struct dea_field dc_fields[] = {TYPE_KEY, LEVEL("level", level, true)};
static const struct dea_field pulse_fields[] = {
    TYPE_KEY,
    LEVEL("low", low, false),
    LEVEL("high", high, true),
    TIME("delay", delay, false),
    TIME("rise", rise, false),
    TIME("fall", fall, false),
    TIME("width", width, false),
    {.key = "period",
     .offset = offsetof(struct dea_waveform, period),
     .range = {.unit = "s", .low = 1e-12, .high = 1e8}},
};
static const struct dea_field trapezoid_fields[] = {
    TYPE_KEY,
    LEVEL("low", low, false),
    LEVEL("high", high, true),
    TIME("delay", delay, false),
    TIME("rise", rise, true),
    TIME("flat", width, true),
    TIME("fall", fall, true),
    TIME("gap", gap, false),
    {.key = "period",
     .offset = offsetof(struct dea_waveform, period),
     .range = {.unit = "s", .low = 1e-12, .high = 1e8}},
};
static const struct dea_field pwl_fields[] = {
    TYPE_KEY, {.key = "points", .kind = DEA_FIELD_ELSEWHERE, .required = true}, REPEAT_KEY};
static const struct dea_field sine_fields[] = {
    TYPE_KEY,
    LEVEL("offset", offset, false),
    LEVEL("amplitude", amplitude, true),
    FREQUENCY("frequency", frequency, true),
    TIME("delay", delay, false),
    {.key = "phase",
     .offset = offsetof(struct dea_waveform, phase),
     .range = {.unit = "rad", .low = -100, .high = 100}},
    {.key = "decay", .offset = offsetof(struct dea_waveform, decay), .range = {.unit = "1/s", .low = 0, .high = 1e9}},
};
static const struct dea_field chirp_fields[] = {
    TYPE_KEY,
    LEVEL("offset", offset, false),
    LEVEL("amplitude", amplitude, true),
    FREQUENCY("from", frequency, true),
    FREQUENCY("to", frequency_end, true),
    {.key = "duration",
     .required = true,
     .offset = offsetof(struct dea_waveform, duration),
     .range = {.unit = "s", .low = 1e-12, .high = 1e8}},
    TIME("delay", delay, false),
};
static const struct dea_field file_fields[] = {
    TYPE_KEY, {.key = "path", .kind = DEA_FIELD_ELSEWHERE, .required = true}, REPEAT_KEY};

static const char *const type_names[] = {"dc", "pulse", "pwl", "sine", "chirp", "trapezoid", "file", NULL};
enum { TYPE_FILE = DEA_WAVE_COUNT }; /* the others are numbered as enum dea_waveform_kind */

static const struct {
    const struct dea_field *fields;
    size_t count;
} type_tables[] = {
    [DEA_WAVE_DC] = {dc_fields, DEA_COUNT(dc_fields)},
    [DEA_WAVE_PULSE] = {pulse_fields, DEA_COUNT(pulse_fields)},
    [DEA_WAVE_PWL] = {pwl_fields, DEA_COUNT(pwl_fields)},
    [DEA_WAVE_SINE] = {sine_fields, DEA_COUNT(sine_fields)},
    [DEA_WAVE_CHIRP] = {chirp_fields, DEA_COUNT(chirp_fields)},
    [DEA_WAVE_TRAPEZOID] = {trapezoid_fields, DEA_COUNT(trapezoid_fields)},
    [TYPE_FILE] = {file_fields, DEA_COUNT(file_fields)},
};

static struct dea_range level_range(const char *unit) {
    double largest = strcmp(unit, "V") == 0 ? 1e5 : 100;
    return (struct dea_range){.unit = unit, .low = -largest, .high = largest};
}

static enum dea_status read_points(const struct dea_node *node, const char *unit, struct dea_waveform *waveform,
                                   struct dea_error *error) {
    const struct dea_range ranges[2] = {{.unit = "s", .low = 0, .high = 1e8}, level_range(unit)};
    DEA_TRY(dea_field_list(node, "points [time, value]", 1, DEA_TREE_MAX_NODES, error));
    waveform->times = calloc(node->count, sizeof *waveform->times);
    waveform->values = calloc(node->count, sizeof *waveform->values);
    if (waveform->times == NULL || waveform->values == NULL)
        return dea_fail(error, DEA_ERR_MEMORY, "out of memory for %zu points", node->count);
    waveform->point_count = node->count;
    for (size_t i = 0; i < node->count; i++) {
        const struct dea_node *entry = node->items[i];
        double point[2];
        DEA_TRY(dea_field_pair(entry, ranges, point, error));
        if (i > 0 && point[0] < waveform->times[i - 1])
            return dea_node_fail(entry, error, "time %g s goes back behind %g s of the point before", point[0],
                                 waveform->times[i - 1]);
        waveform->times[i] = point[0];
        waveform->values[i] = point[1];
    }
    return DEA_OK;
}

static enum dea_status read_file(const struct dea_node *node, const char *unit, struct dea_waveform *waveform,
                                 struct dea_error *error) {
    struct dea_error inner = {0};
    bool repeat = waveform->repeat;
    char text[1024];
    DEA_TRY(dea_field_text(node, sizeof text, text, error));
    char *path = dea_node_resolve_path(node);
    if (path == NULL)
        return dea_fail(error, DEA_ERR_MEMORY, "out of memory while reading YAML");
    enum dea_status status = dea_waveform_read_csv(path, unit, waveform, &inner);
    free(path);
    waveform->repeat = repeat;
    if (status != DEA_OK)
        dea_node_fail(node, error, "%s", inner.text);
    return status;
}

/* Pulse and trapezoid: what the keys left out stand for. */
static enum dea_status complete_pulse(const struct dea_node *node, struct dea_waveform *waveform,
                                      struct dea_error *error) {
    const struct dea_node *period = dea_node_get(node, "period"), *gap = dea_node_get(node, "gap");
    if (waveform->kind == DEA_WAVE_PULSE) {
        if (dea_node_get(node, "width") != NULL)
            return DEA_OK;
        if (period != NULL)
            return dea_node_fail(node, error, "the key 'width' of a pulse with a period is missing");
        waveform->width = INFINITY; /* SPICE: until the end of the run */
        return DEA_OK;
    }
    if (period != NULL && gap != NULL)
        return dea_node_fail(period, error, "give either period or gap, not both");
    waveform->repeat = period != NULL || gap != NULL;
    if (period != NULL) {
        double active = waveform->rise + waveform->width + waveform->fall;
        waveform->gap = waveform->period - active;
        if (waveform->gap < -1e-12 * waveform->period)
            return dea_node_fail(period, error, "the period %g s is shorter than rise + flat + fall = %g s",
                                 waveform->period, active);
        waveform->gap = fmax(waveform->gap, 0);
        waveform->period = 0;
    }
    return DEA_OK;
}

enum dea_status dea_read_waveform(const struct dea_node *node, const char *unit, struct dea_waveform *waveform,
                                  struct dea_error *error) {
    struct dea_field fields[MAX_KEYS];
    struct dea_error inner = {0};
    char what[40];
    int type;
    *waveform = (struct dea_waveform){0};
    const struct dea_node *chosen = dea_node_get(node, "type");
    if (node->kind == DEA_NODE_MAPPING && chosen == NULL)
        return dea_node_fail(node, error,
                             "the key 'type' of a waveform is missing; "
                             "allowed: dc, pulse, pwl, sine, chirp, trapezoid, file");
    if (chosen == NULL)
        return dea_fields_check_keys(node, "a waveform", dc_fields, DEA_COUNT(dc_fields), error);
    DEA_TRY(dea_field_choice(chosen, type_names, &type, error));
    size_t count = type_tables[type].count;
    memcpy(fields, type_tables[type].fields, count * sizeof *fields);
    for (size_t i = 0; i < count; i++)
        if (fields[i].kind == DEA_FIELD_QUANTITY && fields[i].range.unit == NULL)
            fields[i].range = level_range(unit);
    snprintf(what, sizeof what, "a %s waveform", type_names[type]);
    DEA_TRY(dea_fields_read(node, what, fields, count, waveform, error));

    waveform->kind = type == TYPE_FILE ? DEA_WAVE_PWL : (enum dea_waveform_kind)type;
    if (type == TYPE_FILE)
        DEA_TRY(read_file(dea_node_get(node, "path"), unit, waveform, error));
    if (type == DEA_WAVE_PWL)
        DEA_TRY(read_points(dea_node_get(node, "points"), unit, waveform, error));
    if (type == DEA_WAVE_PULSE || type == DEA_WAVE_TRAPEZOID)
        DEA_TRY(complete_pulse(node, waveform, error));
    enum dea_status status = dea_waveform_check(waveform, &inner);
    if (status != DEA_OK)
        dea_node_fail(node, error, "%s", inner.text);
    return status;
}
