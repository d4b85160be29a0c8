/* summary.json: the machine-readable end of a run. Keys of the contract, and a few more beside them. */
#include "deasim/new_file.h"
#include "output_internal.h"

#include <cJSON.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- values; each returns false when out of memory ---- */

/* Shortest of 15, 16, 17 digits that reads back the same; JSON knows no nan and no inf. */
static bool add_number(cJSON *object, const char *key, double value) {
    if (!isfinite(value))
        return cJSON_AddNullToObject(object, key) != NULL;
    char text[32], shorter[32];
    snprintf(text, sizeof text, "%.16g", value);
    if (strtod(text, NULL) != value) {
        snprintf(text, sizeof text, "%.17g", value); /* always enough */
    } else {
        snprintf(shorter, sizeof shorter, "%.15g", value);
        if (strtod(shorter, NULL) == value)
            memcpy(text, shorter, sizeof text);
    }
    return cJSON_AddRawToObject(object, key, text) != NULL;
}

/* Bytes of a valid UTF-8 sequence at the start of text, 0 when there is none (RFC 3629). */
static size_t utf8_length(const unsigned char *text) {
    size_t length = text[0] < 0x80                      ? 1
                    : text[0] >= 0xc2 && text[0] < 0xe0 ? 2
                    : text[0] >= 0xe0 && text[0] < 0xf0 ? 3
                    : text[0] >= 0xf0 && text[0] < 0xf5 ? 4
                                                        : 0;
    for (size_t i = 1; i < length; i++)
        if ((text[i] & 0xc0) != 0x80)
            return 0;
    bool overlong = (text[0] == 0xe0 && text[1] < 0xa0) || (text[0] == 0xf0 && text[1] < 0x90);
    bool beyond = (text[0] == 0xed && text[1] > 0x9f) || (text[0] == 0xf4 && text[1] > 0x8f);
    return overlong || beyond ? 0 : length;
}

/* Paths and tool messages may hold any bytes; what is not UTF-8 becomes '?'. */
static bool add_text(cJSON *object, const char *key, const char *text) {
    char *clean = strdup(text != NULL ? text : "");
    if (clean == NULL)
        return false;
    for (unsigned char *c = (unsigned char *)clean; *c != '\0';) {
        size_t length = utf8_length(c);
        if (length == 0)
            *c = '?';
        c += length > 0 ? length : 1;
    }
    bool good = cJSON_AddStringToObject(object, key, clean) != NULL;
    free(clean);
    return good;
}

/* ---- parts ---- */

static bool add_signals(cJSON *root, const struct dea_result *result) {
    cJSON *signals = cJSON_AddObjectToObject(root, "signals");
    bool good = signals != NULL;
    for (size_t i = 0; i < result->signal_count && good; i++) {
        const struct dea_signal_stats *stats = &result->stats[i];
        cJSON *signal = cJSON_AddObjectToObject(signals, result->signals[i].name);
        good = signal != NULL && add_text(signal, "unit", result->signals[i].unit) &&
               add_number(signal, "min", stats->min) && add_number(signal, "max", stats->max) &&
               add_number(signal, "final", stats->final) && add_number(signal, "t_min", stats->t_min) &&
               add_number(signal, "t_max", stats->t_max);
    }
    return good;
}

/* A measure that failed is null. */
static bool add_measures(cJSON *root, const struct dea_result *result) {
    cJSON *measures = cJSON_AddObjectToObject(root, "measures");
    bool good = measures != NULL;
    for (size_t i = 0; i < result->measure_count && good; i++)
        good = add_number(measures, result->measures[i].name,
                          result->measures[i].failed ? (double)NAN : result->measures[i].value);
    return good;
}

static bool add_events(cJSON *root, const struct dea_scene *scene, const struct dea_result *result) {
    cJSON *events = cJSON_AddArrayToObject(root, "events");
    bool good = events != NULL;
    for (size_t i = 0; i < result->event_count && good; i++) {
        const struct dea_event *event = &result->events[i];
        cJSON *entry = cJSON_CreateObject();
        if (entry == NULL || !cJSON_AddItemToArray(events, entry)) {
            cJSON_Delete(entry);
            return false;
        }
        good = add_number(entry, "t", event->time) && add_text(entry, "type", dea_event_names[event->kind]) &&
               add_text(entry, "zone", dea_event_zone(event)) &&
               add_text(entry, "device", scene->devices[event->device].name) &&
               cJSON_AddBoolToObject(entry, "cleared", event->cleared) != NULL;
    }
    return good && add_number(root, "events_dropped", (double)result->event_dropped);
}

static bool add_energy(cJSON *root, const struct dea_energy *energy) {
    cJSON *object = cJSON_AddObjectToObject(root, "energy");
    return object != NULL && add_number(object, "in", energy->in) && add_number(object, "stored", energy->stored) &&
           add_number(object, "dissipated", energy->dissipated) && add_number(object, "imbalance", energy->imbalance) &&
           add_number(object, "exchanged", energy->exchanged) && add_number(object, "electrical", energy->electrical) &&
           add_number(object, "load", energy->load) && add_number(object, "branch", energy->branch) &&
           add_number(object, "damping", energy->damping) && add_number(object, "resistive", energy->resistive) &&
           add_number(object, "leakage", energy->leakage) && add_number(object, "stop", energy->stop);
}

static bool add_stats(cJSON *root, const struct dea_result *result) {
    const struct dea_run_stats *stats = &result->stats_run;
    cJSON *coupling = cJSON_AddObjectToObject(root, "coupling");
    if (coupling == NULL || !add_number(coupling, "error", result->coupling_error) ||
        !add_number(coupling, "redone", 0.0) || /* of the format; the coupling only shortens steps */
        !add_number(coupling, "relaxed", (double)result->relaxed))
        return false;
    cJSON *object = cJSON_AddObjectToObject(root, "stats");
    return object != NULL && add_number(object, "circuit_points", (double)stats->circuit_points) &&
           add_number(object, "circuit_rejected", (double)stats->circuit_rejected) &&
           add_number(object, "circuit_iterations", (double)stats->circuit_iterations) &&
           add_number(object, "plant_steps", (double)stats->plant_steps) &&
           add_number(object, "plant_rejected", (double)stats->plant_rejected) &&
           add_number(object, "residuals", (double)stats->residuals) &&
           add_number(object, "jacobians", (double)stats->jacobians) &&
           add_number(object, "newton_iterations", (double)stats->newton_iterations) &&
           add_number(object, "restarts", (double)stats->restarts) && add_number(object, "wall_s", stats->wall_s) &&
           add_text(object, "mode", stats->mode);
}

/* Breakdown fields that do not move with the stretch, under the name of the signal they limit. */
static bool add_limits(cJSON *root, const struct dea_scene *scene) {
    cJSON *limits = cJSON_AddObjectToObject(root, "limits");
    bool good = limits != NULL;
    for (int i = 0; i < scene->device_count && good; i++) {
        const struct dea_device *device = &scene->devices[i].device;
        const struct dea_dielectric *dielectric = &device->material.dielectric;
        if (!isfinite(dielectric->breakdown) || dielectric->breakdown_thickness_exponent != 0.0 ||
            dielectric->breakdown_stretch_exponent != 0.0)
            continue;
        for (int k = 0; k < DEA_ZONES && good; k++) {
            char name[160];
            snprintf(name, sizeof name, "%s%s%s.true_field", scene->device_count > 1 ? scene->devices[i].name : "",
                     scene->device_count > 1 ? "." : "", dea_zone_names[k]);
            if (device->zones[k].present && device->zones[k].electroded)
                good = add_number(limits, name, dielectric->breakdown);
        }
    }
    return good;
}

char *dea_summary_json(const struct dea_scene *scene, const struct dea_result *result) {
    cJSON *root = cJSON_CreateObject();
    char *text = NULL;
    if (root != NULL && add_text(root, "scene", scene->path) && add_text(root, "title", scene->title) &&
        add_text(root, "status", dea_outcome_text(result->status)) && add_text(root, "reason", result->reason) &&
        add_number(root, "t_end", result->t_end) && add_signals(root, result) && add_measures(root, result) &&
        add_events(root, scene, result) && add_energy(root, &result->energy) && add_stats(root, result) &&
        add_number(root, "sensitivity", result->sensitivity) && add_limits(root, scene))
        text = cJSON_Print(root);
    cJSON_Delete(root);
    return text;
}

/* ---- the file ---- */

enum dea_status dea_summary_write(const char *directory, const struct dea_scene *scene, const struct dea_result *result,
                                  struct dea_error *error) {
    char *path, *text = dea_summary_json(scene, result);
    if (text == NULL || asprintf(&path, "%s/summary.json", directory) < 0) {
        free(text);
        return dea_fail(error, DEA_ERR_MEMORY, "out of memory for the summary of %s", directory);
    }
    struct dea_new_file made;
    struct dea_error why;
    enum dea_status status = dea_new_file_open(path, &made, &why);
    if (status == DEA_OK) {
        fprintf(made.file, "%s\n", text);
        status = dea_new_file_finish(&made, DEA_OK, &why);
    }
    if (status != DEA_OK) /* also where the folder went away since the run began */
        status = dea_fail(error, DEA_ERR_OUTPUT, "%s", why.text);
    free(path);
    free(text);
    return status;
}
