/* device: geometry, material, zones with their electrodes, platform, options. */
#include "scene/readers.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define RESISTANCE_RANGE(unit_name)                                                                                    \
    { .unit = unit_name, .low = 1e-3, .high = 1e12, .or_zero = true }

static enum dea_status read_geometry(const struct dea_node *node, void *target, struct dea_error *error) {
    static const struct dea_field fields[] = {
        {.key = "width",
         .required = true,
         .offset = offsetof(struct dea_device, width),
         .range = {.unit = "m", .low = 1e-6, .high = 1}},
        {.key = "thickness",
         .required = true,
         .offset = offsetof(struct dea_device, thickness),
         .range = {.unit = "m", .low = 1e-8, .high = 1e-2}},
        {.key = "prestretch",
         .kind = DEA_FIELD_PAIR,
         .required = true,
         .offset = offsetof(struct dea_device, prestretch),
         .range = {.unit = "1", .low = 0.05, .high = 20}},
    };
    return dea_fields_read(node, "a geometry", fields, DEA_COUNT(fields), target, error);
}

static enum dea_status read_material_key(const struct dea_node *node, void *target, struct dea_error *error) {
    return dea_read_material(node, &((struct dea_device *)target)->material, error);
}

/* ---- zones ---- */

static enum dea_status read_electrode(const struct dea_node *node, void *target, struct dea_error *error) {
    static const char *const feeds[] = {"long_edge", "narrow_end", NULL};
    static const struct dea_field fields[] = {
        {.key = "resistance",
         .offset = offsetof(struct dea_zone, electrode_resistance),
         .range = RESISTANCE_RANGE("Ohm")},
        {.key = "sheet_resistance",
         .offset = offsetof(struct dea_zone, sheet_resistance),
         .range = RESISTANCE_RANGE("Ohm/sq")},
        {.key = "feed", .kind = DEA_FIELD_CHOICE, .offset = offsetof(struct dea_zone, feed), .names = feeds},
    };
    struct dea_zone *zone = target;
    zone->electroded = true;
    DEA_TRY(dea_fields_read(node, "an electrode", fields, DEA_COUNT(fields), zone, error));
    const struct dea_node *feed = dea_node_get(node, "feed");
    if (feed != NULL && zone->sheet_resistance == 0)
        return dea_node_fail(feed, error, "feed has no effect without a sheet_resistance");
    return DEA_OK;
}

static enum dea_status read_zone(const struct dea_node *node, struct dea_zone *zone, struct dea_error *error) {
    static const struct dea_field fields[] = {
        {.key = "length",
         .required = true,
         .offset = offsetof(struct dea_zone, length),
         .range = {.unit = "m", .low = 1e-6, .high = 1}},
        {.key = "electrode", .kind = DEA_FIELD_READER, .read = read_electrode},
    };
    zone->present = true;
    return dea_fields_read(node, "a zone", fields, DEA_COUNT(fields), zone, error);
}

static enum dea_status read_left(const struct dea_node *node, void *target, struct dea_error *error) {
    return read_zone(node, &((struct dea_device *)target)->zones[0], error);
}

static enum dea_status read_right(const struct dea_node *node, void *target, struct dea_error *error) {
    return read_zone(node, &((struct dea_device *)target)->zones[1], error);
}

static enum dea_status read_zones(const struct dea_node *node, void *target, struct dea_error *error) {
    static const struct dea_field fields[] = {
        {.key = "left", .kind = DEA_FIELD_READER, .read = read_left},
        {.key = "right", .kind = DEA_FIELD_READER, .read = read_right},
    };
    struct dea_device *device = target;
    DEA_TRY(dea_fields_read(node, "zones", fields, DEA_COUNT(fields), target, error));
    device->right_first = dea_node_find(node, "right") < dea_node_find(node, "left");
    if (!device->zones[0].present && !device->zones[1].present)
        return dea_node_fail(node, error, "a device needs at least one zone; allowed: left, right");
    return DEA_OK;
}

/* ---- platform and options ---- */

static enum dea_status read_platform(const struct dea_node *node, void *target, struct dea_error *error) {
    static const struct dea_field fields[] = {
        {.key = "mass",
         .offset = offsetof(struct dea_device, platform_mass),
         .range = {.unit = "kg", .low = 1e-12, .high = 1, .or_zero = true}},
        {.key = "damping",
         .offset = offsetof(struct dea_device, damping),
         .range = {.unit = "N s/m", .low = 1e-12, .high = 1e4, .or_zero = true}},
        {.key = "load", .offset = offsetof(struct dea_device, load), .range = {.unit = "N", .low = -100, .high = 100}},
        {.key = "stops",
         .kind = DEA_FIELD_PAIR,
         .offset = offsetof(struct dea_device, stops),
         .range = {.unit = "m", .low = -1, .high = 1}},
        {.key = "stop_stiffness",
         .offset = offsetof(struct dea_device, stop_stiffness),
         .range = {.unit = "N/m", .low = 1e-3, .high = 1e12}},
        {.key = "stop_loss",
         .offset = offsetof(struct dea_device, stop_loss),
         .range = {.unit = "s/m", .low = 1e-6, .high = 1e6, .or_zero = true}},
    };
    struct dea_device *device = target;
    DEA_TRY(dea_fields_read(node, "a platform", fields, DEA_COUNT(fields), device, error));
    const struct dea_node *stops = dea_node_get(node, "stops");
    device->has_stops = stops != NULL;
    for (size_t i = 4; i < DEA_COUNT(fields); i++) {
        const struct dea_node *extra = dea_node_get(node, fields[i].key);
        if (extra != NULL && stops == NULL)
            return dea_node_fail(extra, error, "has no effect without stops");
    }
    if (stops != NULL && !(device->stops[0] <= 0 && device->stops[1] >= 0 && device->stops[0] < device->stops[1]))
        return dea_node_fail(stops, error, "the stops must lie on both sides of x = 0, the lower one first");
    return DEA_OK;
}

static enum dea_status read_options(const struct dea_node *node, void *target, struct dea_error *error) {
    static const struct dea_field fields[] = {
        {.key = "membrane_mass", .kind = DEA_FIELD_BOOL, .offset = offsetof(struct dea_device, membrane_mass)},
        {.key = "slack", .kind = DEA_FIELD_BOOL, .offset = offsetof(struct dea_device, slack)},
    };
    return dea_fields_read(node, "options", fields, DEA_COUNT(fields), target, error);
}

/* ---- the whole ---- */

/* Combinations that no single key can be blamed for. */
static enum dea_status check_device(const struct dea_node *node, const struct dea_device *device,
                                    struct dea_error *error) {
    const struct dea_dielectric *dielectric = &device->material.dielectric;
    double permittivity = dielectric->permittivity + dielectric->permittivity_slope * device->prestretch[0];
    const struct dea_node *place = dea_node_get(dea_node_get(node, "material"), "dielectric");
    if (!(permittivity > 0))
        return dea_node_fail(place, error,
                             "the permittivity at the prestretch %g is %g; it must be positive "
                             "(permittivity + permittivity_slope lam1)",
                             device->prestretch[0], permittivity);
    return DEA_OK;
}

enum dea_status dea_read_device(const struct dea_node *node, struct dea_device *device, struct dea_error *error) {
    static const struct dea_field fields[] = {
        {.key = "name", .kind = DEA_FIELD_TEXT, .offset = offsetof(struct dea_device, name), .size = 64},
        {.key = "geometry", .kind = DEA_FIELD_READER, .required = true, .read = read_geometry},
        {.key = "material", .kind = DEA_FIELD_READER, .required = true, .read = read_material_key},
        {.key = "zones", .kind = DEA_FIELD_READER, .required = true, .read = read_zones},
        {.key = "platform", .kind = DEA_FIELD_READER, .read = read_platform},
        {.key = "options", .kind = DEA_FIELD_READER, .read = read_options},
    };
    struct dea_error inner = {0};
    *device = (struct dea_device){.membrane_mass = true, .slack = true};
    DEA_TRY(dea_fields_read(node, "a device", fields, DEA_COUNT(fields), device, error));
    dea_name_from_file(node, device->name, sizeof device->name);
    DEA_TRY(check_device(node, device, error));
    enum dea_status status = dea_device_prepare(device, &inner);
    if (status != DEA_OK)
        dea_node_fail(node, error, "%s", inner.text);
    return status;
}
