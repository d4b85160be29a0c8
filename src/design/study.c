/* Designs: from and to devices, parameters by name. */
#include "deasim/study.h"

#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

const struct dea_design_key_info dea_design_keys[DEA_KEY_COUNT] = {
    [DEA_KEY_ACTIVE_RATIO] = {"r_a", "1", "active ratio r_a", "", 1.0},
    [DEA_KEY_PRESTRETCH1] = {"lp1", "1", "prestretch along the motion lp1", "", 1.0},
    [DEA_KEY_PRESTRETCH2] = {"lp2", "1", "prestretch across the motion lp2", "", 1.0},
    [DEA_KEY_BREAKDOWN] = {"E_bd", "V/m", "breakdown field E_bd", "V/um", 1e-6},
    [DEA_KEY_JM] = {"Jm", "1", "Gent limit J_m", "", 1.0},
    [DEA_KEY_MODULUS] = {"mu", "Pa", "shear modulus mu", "MPa", 1e-6},
    [DEA_KEY_PERMITTIVITY] = {"eps_r", "1", "relative permittivity eps_r", "", 1.0},
    [DEA_KEY_THICKNESS] = {"t0", "m", "prestretched thickness t0", "um", 1e6},
};

enum dea_design_key dea_design_key_find(const char *name) {
    for (int key = 0; key < DEA_KEY_COUNT; key++)
        if (strcasecmp(name, dea_design_keys[key].name) == 0)
            return (enum dea_design_key)key;
    return DEA_KEY_COUNT;
}

struct dea_design dea_design_of_paper(void) {
    return (struct dea_design){
        .elastic = {.kind = DEA_GENT, .mu = 0.365e6, .jm = 16.6},
        .dielectric = {.permittivity = 2.5, .breakdown = 100e6, .breakdown_reference = 1e-6},
        .thickness = 25e-6,
        .prestretch = {1.0, 2.0},
        .active_ratio = 0.5,
        .max_voltage = INFINITY,
    };
}

/* Where a parameter lives in the design; NULL when this law has none. */
static double *locate(struct dea_design *design, enum dea_design_key key) {
    switch (key) {
    case DEA_KEY_ACTIVE_RATIO:
        return &design->active_ratio;
    case DEA_KEY_PRESTRETCH1:
        return &design->prestretch[0];
    case DEA_KEY_PRESTRETCH2:
        return &design->prestretch[1];
    case DEA_KEY_BREAKDOWN:
        return &design->dielectric.breakdown;
    case DEA_KEY_JM:
        return design->elastic.kind == DEA_GENT ? &design->elastic.jm : NULL;
    case DEA_KEY_MODULUS:
        return design->elastic.kind == DEA_YEOH || design->elastic.kind == DEA_OGDEN ? NULL : &design->elastic.mu;
    case DEA_KEY_PERMITTIVITY:
        return &design->dielectric.permittivity;
    case DEA_KEY_THICKNESS:
        return &design->thickness;
    default:
        return NULL;
    }
}

enum dea_status dea_design_set(struct dea_design *design, enum dea_design_key key, double value,
                               struct dea_error *error) {
    double *place = locate(design, key);
    if (place == NULL)
        return dea_fail(error, DEA_ERR_INPUT, "a %s film has no parameter %s", dea_law_name(design->elastic.kind),
                        key < DEA_KEY_COUNT ? dea_design_keys[key].name : "of that name");
    *place = value;
    return DEA_OK;
}

double dea_design_get(const struct dea_design *design, enum dea_design_key key) {
    struct dea_design copy = *design;
    const double *place = locate(&copy, key);
    return place != NULL ? *place : NAN;
}

enum dea_status dea_design_from_device(const struct dea_device *device, struct dea_design *design,
                                       struct dea_error *error) {
    const struct dea_zone *left = &device->zones[0], *right = &device->zones[1];
    if (!left->present || !left->electroded)
        return dea_fail(error, DEA_ERR_INPUT, "zones.left carries no electrode, so there is nothing to drive");
    *design = (struct dea_design){
        .elastic = device->material.elastic,
        .dielectric = device->material.dielectric,
        .thickness = device->thickness,
        .prestretch = {device->prestretch[0], device->prestretch[1]},
        .active_ratio = right->present ? left->length / (left->length + right->length) : 1.0,
        .max_voltage = INFINITY,
        .dead_load = !right->present,
    };
    return DEA_OK;
}

enum dea_status dea_design_to_device(const struct dea_design *design, double width, double length, bool bidirectional,
                                     struct dea_device *device, struct dea_error *error) {
    *device = (struct dea_device){
        .width = width,
        .thickness = design->thickness,
        .prestretch = {design->prestretch[0], design->prestretch[1]},
        .material = {.elastic = design->elastic, .dielectric = design->dielectric},
        .slack = true,
    };
    snprintf(device->name, sizeof device->name, "design");
    double ratio = design->dead_load ? 1.0 : design->active_ratio;
    device->zones[0] = (struct dea_zone){.present = true, .electroded = true, .length = ratio * length};
    if (!design->dead_load) {
        device->zones[1] =
            (struct dea_zone){.present = true, .electroded = bidirectional, .length = (1.0 - ratio) * length};
        return dea_device_prepare(device, error);
    }
    struct dea_stress stress;
    if (dea_law_stress(&design->elastic, design->prestretch[0], design->prestretch[1], &stress) == DEA_OK)
        device->load = width * design->thickness * design->prestretch[0] * stress.w1;
    return dea_device_prepare(device, error);
}
