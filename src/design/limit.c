/* The first failure along the taut path: breakdown, slack, the elastic law's limit, electromechanical instability. */
#include "design/path.h"

#include <math.h>
#include <stddef.h>

const char *const dea_limit_names[DEA_LIMIT_COUNT] = {
    [DEA_LIMIT_NONE] = "none",
    [DEA_LIMIT_BREAKDOWN] = "breakdown",
    [DEA_LIMIT_SLACK1] = "slack1",
    [DEA_LIMIT_SLACK2] = "slack2",
    [DEA_LIMIT_LAW] = "gent",
    [DEA_LIMIT_PRESTRETCH] = "prestretch",
    [DEA_LIMIT_INSTABILITY] = "instability",
    [DEA_LIMIT_SUPPLY] = "supply",
};

static double breakdown_field(const struct dea_device *device, double lam) {
    double thickness = device->thickness * device->prestretch[0] / lam;
    return dea_breakdown_field(&device->material.dielectric, thickness, lam, device->prestretch[1]);
}

/* The failure a point of the path has suffered, in the order in which they are to be named when several coincide. */
static enum dea_limit_mode judge(const struct dea_device *device, const struct dea_path_point *point,
                                 double least_tension) {
    bool breakdown = false, slack1 = false, slack2 = false;
    for (int k = 0; k < DEA_ZONES; k++) {
        if (!device->zones[k].present)
            continue;
        breakdown =
            breakdown || (device->zones[k].electroded && point->field[k] >= breakdown_field(device, point->lam[k]));
        slack1 = slack1 || !(point->lam[k] * point->net1[k] > least_tension);
        slack2 = slack2 || !(point->stress2[k] >= 0.0);
    }
    if (breakdown)
        return DEA_LIMIT_BREAKDOWN;
    if (slack1)
        return DEA_LIMIT_SLACK1;
    if (slack2)
        return DEA_LIMIT_SLACK2;
    if (!(point->margin > DEA_LAW_MARGIN_LIMIT))
        return DEA_LIMIT_LAW;
    return point->slope > 0.0 ? DEA_LIMIT_NONE : DEA_LIMIT_INSTABILITY;
}

static bool has_failed(const struct dea_device *device, const struct dea_path_point *point, const void *context) {
    return judge(device, point, *(const double *)context) != DEA_LIMIT_NONE;
}

enum dea_status dea_find_limit(const struct dea_device *device, double right_voltage, double least_tension,
                               struct dea_limit *limit, struct dea_error *error) {
    *limit = (struct dea_limit){DEA_LIMIT_NONE, NAN, NAN, NAN, NAN};
    double voltages[DEA_ZONES] = {0.0, right_voltage};
    DEA_TRY(dea_check_left_electrode(device, error));
    DEA_TRY(dea_check_voltages(device, voltages, error));
    if (dea_prestretch_fails(device, NULL)) {
        limit->mode = DEA_LIMIT_PRESTRETCH;
        return DEA_OK;
    }
    struct dea_device relaxed = dea_relaxed_device(device);
    double start;
    DEA_TRY(dea_find_rest(&relaxed, voltages, &start, error));
    struct dea_path_end end;
    if (!dea_path_walk(&relaxed, right_voltage, start, has_failed, &least_tension, &end))
        return DEA_OK;
    limit->mode = end.outside ? DEA_LIMIT_LAW : judge(&relaxed, &end.after, least_tension);
    limit->x = end.before.x;
    limit->voltage = sqrt(fmax(end.before.voltage_squared, 0.0));
    limit->stretch = end.before.lam[0] / device->prestretch[0];
    limit->true_field = end.before.field[0];
    /* at breakdown the field is known, and better than from a stretch rounded to a double */
    double strength = breakdown_field(&relaxed, end.after.lam[0]);
    if (limit->mode == DEA_LIMIT_BREAKDOWN && end.before.field[0] < strength && end.after.field[0] >= strength) {
        limit->true_field = strength;
        limit->voltage = strength * relaxed.thickness / limit->stretch;
    }
    return DEA_OK;
}

enum dea_status dea_static_limit(const struct dea_device *device, double right_voltage, struct dea_limit *limit,
                                 struct dea_error *error) {
    return dea_find_limit(device, right_voltage, 0.0, limit, error);
}
