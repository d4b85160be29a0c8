/* drive: a netlist, or a native source per electrode. */
#include "scene/readers.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#define RESISTANCE_RANGE                                                                                               \
    { .unit = "Ohm", .low = 1e-3, .high = 1e12, .or_zero = true }

static enum dea_status read_amplifier(const struct dea_node *node, void *target, struct dea_error *error) {
    static const struct dea_field fields[] = {
        {.key = "slew_rate",
         .offset = offsetof(struct dea_amplifier, slew_rate),
         .range = {.unit = "V/s", .low = 1e-3, .high = 1e12}},
        {.key = "current_limit",
         .offset = offsetof(struct dea_amplifier, current_limit),
         .range = {.unit = "A", .low = 1e-12, .high = 100}},
        {.key = "bandwidth",
         .offset = offsetof(struct dea_amplifier, bandwidth),
         .range = {.unit = "Hz", .low = 1e-3, .high = 1e12}},
        {.key = "output_resistance",
         .offset = offsetof(struct dea_amplifier, output_resistance),
         .range = RESISTANCE_RANGE},
    };
    struct dea_source *source = target;
    source->amplified = true;
    source->amplifier = (struct dea_amplifier){.slew_rate = INFINITY, .current_limit = INFINITY, .bandwidth = INFINITY};
    return dea_fields_read(node, "an amplifier", fields, DEA_COUNT(fields), &source->amplifier, error);
}

static enum dea_status read_source_waveform(const struct dea_node *node, void *target, struct dea_error *error) {
    return dea_read_waveform(node, "V", &((struct dea_source *)target)->waveform, error);
}

static enum dea_status read_source(const struct dea_node *node, const struct dea_zone *zone, struct dea_source *source,
                                   struct dea_error *error) {
    static const struct dea_field fields[] = {
        {.key = "waveform", .kind = DEA_FIELD_READER, .required = true, .read = read_source_waveform},
        {.key = "resistance", .offset = offsetof(struct dea_source, resistance), .range = RESISTANCE_RANGE},
        {.key = "amplifier", .kind = DEA_FIELD_READER, .read = read_amplifier},
    };
    DEA_TRY(dea_fields_read(node, "a source", fields, DEA_COUNT(fields), source, error));
    bool series = source->resistance > 0 || source->amplifier.output_resistance > 0 || zone->electrode_resistance > 0 ||
                  zone->sheet_resistance > 0;
    if (source->amplified && !series)
        return dea_node_fail(dea_node_get(node, "amplifier"), error,
                             "an amplifier needs a resistance in series: give output_resistance, the source's "
                             "resistance or the electrode's");
    return DEA_OK;
}

static enum dea_status read_sources(const struct dea_node *node, struct dea_scene *scene, struct dea_error *error) {
    const struct dea_device *device = &scene->devices[0].device;
    if (scene->device_count > 1)
        return dea_node_fail(node, error, "several devices need a netlist; native sources drive a single device");
    for (int k = 0; k < DEA_ZONES; k++) {
        const struct dea_zone *zone = &device->zones[k];
        struct dea_source *source = &scene->sources[k];
        const struct dea_node *entry = dea_node_get(node, dea_zone_names[k]);
        if (entry != NULL && !zone->present)
            return dea_node_fail(entry, error, "the device has no %s zone", dea_zone_names[k]);
        if (entry != NULL && !zone->electroded)
            return dea_node_fail(entry, error, "the %s zone is passive: it has no electrode to drive",
                                 dea_zone_names[k]);
        source->present = zone->present && zone->electroded; /* without an entry: grounded, dc 0 V */
        if (entry != NULL)
            DEA_TRY(read_source(entry, zone, source, error));
    }
    return DEA_OK;
}

static enum dea_status read_netlist(const struct dea_node *node, struct dea_scene *scene, struct dea_error *error) {
    char text[1024];
    struct stat info;
    DEA_TRY(dea_field_text(node, sizeof text, text, error));
    scene->netlist = dea_node_resolve_path(node);
    if (scene->netlist == NULL)
        return dea_fail(error, DEA_ERR_MEMORY, "out of memory while reading YAML");
    if (stat(scene->netlist, &info) != 0)
        return dea_node_fail(node, error, "cannot read %.200s: %s", scene->netlist, strerror(errno));
    if (!S_ISREG(info.st_mode))
        return dea_node_fail(node, error, "cannot read %.200s: it is %s", scene->netlist,
                             S_ISDIR(info.st_mode) ? "a directory" : "not a regular file");
    return DEA_OK;
}

enum dea_status dea_read_drive(const struct dea_node *node, struct dea_scene *scene, struct dea_error *error) {
    static const struct dea_field fields[] = {
        {.key = "netlist", .kind = DEA_FIELD_ELSEWHERE},
        {.key = "left", .kind = DEA_FIELD_ELSEWHERE},
        {.key = "right", .kind = DEA_FIELD_ELSEWHERE},
    };
    DEA_TRY(dea_fields_check_keys(node, "a drive", fields, DEA_COUNT(fields), error));
    const struct dea_node *netlist = dea_node_get(node, "netlist");
    if (netlist == NULL)
        return read_sources(node, scene, error);
    for (int k = 0; k < DEA_ZONES; k++) {
        const struct dea_node *source = dea_node_get(node, dea_zone_names[k]);
        if (source != NULL)
            return dea_node_fail(source, error, "a native source besides a netlist; give one or the other");
    }
    return read_netlist(netlist, scene, error);
}
