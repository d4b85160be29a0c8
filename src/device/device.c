/* Derived constants of a device and its geometry: stretch, capacitance, field, electrode resistance, end stops. */
#include "deasim/device.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

const char *const dea_zone_names[DEA_ZONES] = {"left", "right"};

static const double zone_sides[DEA_ZONES] = {+1.0, -1.0};

/* Two rigid contacts of one actuator: stiff against the membrane, soft enough to integrate. */
#define STOP_STIFFNESS_RATIO 1000.0

static enum dea_status check_geometry(const struct dea_device *device, struct dea_error *error) {
    if (!(device->width > 0.0 && device->thickness > 0.0))
        return dea_fail(error, DEA_ERR_INPUT, "width and thickness must be positive");
    if (!(device->prestretch[0] > 0.0 && device->prestretch[1] > 0.0))
        return dea_fail(error, DEA_ERR_INPUT, "prestretch must be positive");
    if (!device->zones[0].present && !device->zones[1].present)
        return dea_fail(error, DEA_ERR_INPUT, "a device needs at least one zone, left or right");
    for (int k = 0; k < DEA_ZONES; k++)
        if (device->zones[k].present && !(device->zones[k].length > 0.0))
            return dea_fail(error, DEA_ERR_INPUT, "zones.%s.length must be positive", dea_zone_names[k]);
    if (device->has_stops && !(device->stops[0] <= 0.0 && device->stops[1] >= 0.0))
        return dea_fail(error, DEA_ERR_INPUT, "platform.stops must lie on both sides of x = 0");
    return DEA_OK;
}

enum dea_status dea_device_prepare(struct dea_device *device, struct dea_error *error) {
    DEA_TRY(check_geometry(device, error));
    device->effective_mass = device->platform_mass;
    device->stiffness = 0.0;
    for (int k = 0; k < DEA_ZONES; k++) {
        struct dea_zone *zone = &device->zones[k];
        zone->side = zone_sides[k];
        zone->volume = zone->rest_capacitance = zone->per_stretch = 0.0;
        if (!zone->present)
            continue;
        zone->volume = device->width * zone->length * device->thickness;
        zone->per_stretch = DEA_VACUUM_PERMITTIVITY * device->width * zone->length /
                            (device->prestretch[0] * device->prestretch[0] * device->thickness);
        if (zone->electroded) {
            zone->rest_capacitance = dea_zone_capacitance(device, k, device->prestretch[0], NULL, NULL);
            if (!(zone->rest_capacitance > 0.0))
                return dea_fail(error, DEA_ERR_INPUT, "permittivity is not positive at the prestretch");
        }
        /* linear velocity field: a third of the film moves with the platform */
        if (device->membrane_mass)
            device->effective_mass += device->material.density * zone->volume / 3.0;
        /* k0 of physics.md section 11; a failed prestretch has none and is reported elsewhere */
        struct dea_stress stress;
        double per_length = device->prestretch[0] / zone->length;
        if (dea_law_stress(&device->material.elastic, device->prestretch[0], device->prestretch[1], &stress) == DEA_OK)
            device->stiffness += zone->volume * per_length * per_length * stress.w11;
    }
    if (device->has_stops && device->stop_stiffness <= 0.0)
        device->stop_stiffness = STOP_STIFFNESS_RATIO * device->stiffness;
    return DEA_OK;
}

void dea_device_clear(struct dea_device *device) {
    free(device->material.branches);
    memset(device, 0, sizeof *device);
}

bool dea_prestretch_fails(const struct dea_device *device, const char **why) {
    double lp1 = device->prestretch[0], lp2 = device->prestretch[1];
    const char *reason = NULL;
    if (!(dea_law_margin(&device->material.elastic, lp1, lp2) > 0.0))
        reason = "the prestretch is beyond the limit of the elastic law";
    else if (lp1 <= 1.0 / sqrt(lp2))
        reason = "the prestretch leaves no tension in direction 1 (lp1 <= lp2^-1/2)";
    else if (lp2 <= 1.0 / sqrt(lp1))
        reason = "the prestretch leaves no tension in direction 2 (lp2 <= lp1^-1/2)";
    if (why != NULL)
        *why = reason;
    return reason != NULL;
}

double dea_zone_stretch(const struct dea_device *device, int zone, double x) {
    const struct dea_zone *z = &device->zones[zone];
    return device->prestretch[0] * (1.0 + z->side * x / z->length);
}

double dea_zone_capacitance(const struct dea_device *device, int zone, double lam1, double *slope, double *curvature) {
    const struct dea_dielectric *dielectric = &device->material.dielectric;
    double factor = device->zones[zone].per_stretch;
    double a = dielectric->permittivity, b = dielectric->permittivity_slope;
    if (slope != NULL)
        *slope = factor * lam1 * (2.0 * a + 3.0 * b * lam1);
    if (curvature != NULL)
        *curvature = factor * (2.0 * a + 6.0 * b * lam1);
    return factor * lam1 * lam1 * (a + b * lam1);
}

double dea_zone_field(const struct dea_device *device, double voltage, double lam1) {
    return voltage * lam1 / (device->thickness * device->prestretch[0]);
}

double dea_zone_resistance(const struct dea_device *device, int zone, double lam1, double *slope) {
    const struct dea_zone *z = &device->zones[zone];
    if (z->sheet_resistance == 0.0) {
        if (slope != NULL)
            *slope = 0.0;
        return z->electrode_resistance;
    }
    double sheet = 2.0 * z->sheet_resistance / 3.0; /* two electrodes, distributed feed: R_sq/3 squares each */
    double aspect = z->length * lam1 / (device->prestretch[0] * device->width); /* l/w */
    if (z->feed == DEA_FEED_LONG_EDGE) {
        if (slope != NULL)
            *slope = sheet * aspect / lam1;
        return z->electrode_resistance + sheet * aspect;
    }
    if (slope != NULL)
        *slope = -sheet / (aspect * lam1);
    return z->electrode_resistance + sheet / aspect;
}

double dea_zone_leakage(const struct dea_device *device, int zone, double lam1, double voltage, double *by_voltage,
                        double *by_stretch) {
    double current = 0.0, by_v = 0.0, by_lam = 0.0;
    if (device->material.dielectric.conductivity > 0.0) {
        double per_lam = device->width * device->zones[zone].length / device->prestretch[0];
        double field_per_volt = lam1 / (device->thickness * device->prestretch[0]);
        double slope, density = dea_leakage_density(&device->material.dielectric, voltage * field_per_volt, &slope);
        current = density * per_lam * lam1;
        by_v = slope * field_per_volt * per_lam * lam1;
        by_lam = slope * voltage * field_per_volt * per_lam + density * per_lam;
    }
    if (by_voltage != NULL)
        *by_voltage = by_v;
    if (by_stretch != NULL)
        *by_stretch = by_lam;
    return current;
}

double dea_stop_force(const struct dea_device *device, double x, double v, double *df_dx, double *df_dv, double *energy,
                      double *loss) {
    double force = 0.0, by_x = 0.0, by_v = 0.0, stored = 0.0, lost = 0.0;
    if (device->has_stops && (x > device->stops[1] || x < device->stops[0])) {
        /* Hunt-Crossley contact: F = k d (1 + chi d'), with d the depth and d' its rate */
        double side = x > device->stops[1] ? 1.0 : -1.0;
        double depth = side > 0.0 ? x - device->stops[1] : device->stops[0] - x;
        double k = device->stop_stiffness, chi = device->stop_loss, rate = side * v;
        force = -side * k * depth * (1.0 + chi * rate);
        by_x = -k * (1.0 + chi * rate);
        by_v = -k * depth * chi;
        stored = 0.5 * k * depth * depth;
        lost = k * depth * chi * rate * rate;
    }
    if (df_dx != NULL)
        *df_dx = by_x;
    if (df_dv != NULL)
        *df_dv = by_v;
    if (energy != NULL)
        *energy = stored;
    if (loss != NULL)
        *loss = lost;
    return force;
}
