/* The plant's near future for a circuit that asks for capacitances between two exchanges: Taylor series with inertia,
 * the exact exponential of the linearised balance without. */
#include "plant/integrator.h"

#include <math.h>

/* Below this part of the rest stiffness the response to a voltage counts as limited: past a pitchfork it would be
 * infinite. */
#define SOFTEST 0.02

/* What moves the net force besides x and v: charges, branches, the load; N/s. Also net stiffness, N/m. */
static double drift_force(const struct dea_plant *plant, double *stiffness) {
    const struct dea_device *device = plant->device;
    double drift;
    dea_piece_value(&plant->inputs.load, plant->t, &drift);
    *stiffness = -plant->force_x;
    for (int k = 0; k < DEA_ZONES; k++) {
        const struct zone_point *point = &plant->points[k];
        if (!plant->zones[k].present)
            continue;
        double side = device->zones[k].side;
        *stiffness += side * point->film.dpull_dx;
        drift -= side * point->film.dpull_de * point->e_rate;
        for (int b = 0; b < device->material.branch_count; b++)
            for (int i = 0; i < 2; i++)
                drift -= side * point->film.dpull_dp1 * point->branches[b].dp1_dz[i] * point->branches[b].rate[i];
    }
    return drift;
}

static void look_at_platform(const struct dea_plant *plant, double horizon, struct dea_outlook *out) {
    const struct dea_device *device = plant->device;
    const double *y = N_VGetArrayPointer(plant->y);
    double stiffness, drift = drift_force(plant, &stiffness), c = device->damping;
    out->x[0] = y[plant->x] * plant->scale[plant->x];
    out->x[1] = out->x[2] = out->x[3] = out->fast = 0.0;
    out->settling = 1.0;
    if (plant->motion == MOTION_INERTIAL) {
        double m = device->effective_mass, v = y[plant->v] * plant->scale[plant->v];
        double a = (plant->force - c * v) / m;
        out->x[1] = v;
        out->x[2] = 0.5 * a;
        out->x[3] = (drift - stiffness * v - (c - plant->force_v) * a) / (6.0 * m);
    } else if (plant->motion == MOTION_VISCOUS && stiffness * horizon > 0.05 * c) {
        /* c x' = F - K x + drift t, solved exactly */
        out->settling = c / stiffness;
        out->x[1] = drift / stiffness;
        out->fast = (plant->force / c - out->x[1]) * out->settling;
    } else if (plant->motion == MOTION_VISCOUS) {
        out->x[1] = plant->force / c;
        out->x[2] = 0.5 * (drift - stiffness * out->x[1]) / c;
        out->x[3] = -stiffness * out->x[2] / (3.0 * c);
    } else {
        out->x[1] = stiffness > 0.0 ? drift / stiffness : 0.0;
    }
}

/* What a film's capacitance makes of its own voltage: (1/2) (dC/dx)^2 over the platform's resistance to motion when
 * taut; when slack, d(C)/d(V^2) by its own natural stretch, from dlam/dQ at fixed branches and Q = C V. */
static double find_gain(const struct dea_plant *plant, int k) {
    const struct dea_device *device = plant->device;
    const struct dea_film *film = &plant->points[k].film;
    double slope;
    dea_zone_capacitance(device, k, film->lam, &slope, NULL);
    if (!film->slack) {
        double per_x = slope * device->prestretch[0] / device->zones[k].length;
        return 0.5 * per_x * per_x;
    }
    double c = film->capacitance, q = film->charge;
    double charge_per_v2 = 0.5 * c * c / fmax(fabs(q), 1e-30) / fmax(1.0 - q / c * slope * film->dlam_de, SOFTEST);
    return slope * fabs(film->dlam_de) * charge_per_v2;
}

static double stiffness_at_voltage(const struct dea_plant *plant) {
    double stiffness = -plant->force_x;
    for (int i = 0; i < DEA_ZONES; i++)
        if (plant->zones[i].present)
            stiffness += plant->points[i].film.stiffness;
    return fmax(stiffness, SOFTEST * plant->device->stiffness);
}

double dea_outlook_softness(const struct dea_outlook *outlook, int zone, double h) {
    if (outlook->slack[zone])
        return outlook->soft_gain[zone];
    if (h <= 0.0)
        return outlook->damping > 0.0 || outlook->mass > 0.0 ? 0.0 : outlook->soft_gain[zone] / outlook->stiffness;
    return outlook->soft_gain[zone] / (outlook->stiffness + outlook->damping / h + 2.0 * outlook->mass / (h * h));
}

enum dea_status dea_plant_look_ahead(struct dea_plant *plant, double horizon, struct dea_outlook *out) {
    const double *y = N_VGetArrayPointer(plant->y), *yp = N_VGetArrayPointer(plant->yp);
    DEA_TRY(plant_evaluate(plant, plant->t, y, plant_velocity(plant, y, yp), true));
    out->start = plant->t;
    look_at_platform(plant, horizon, out);
    for (int k = 0; k < DEA_ZONES; k++) {
        const struct zone_point *point = &plant->points[k];
        if (!plant->zones[k].present)
            continue;
        out->slack[k] = point->film.slack;
        out->lam[k][0] = point->film.lam;
        out->lam[k][1] = point->film.dlam_de * point->e_rate;
        for (int b = 0; b < plant->device->material.branch_count; b++)
            for (int i = 0; i < 2; i++)
                out->lam[k][1] += point->film.dlam_dp1 * point->branches[b].dp1_dz[i] * point->branches[b].rate[i];
        out->lam[k][2] = out->lam[k][3] = 0.0;
        out->charge[k] = point->film.charge;
        out->charge_rate[k] = point->e_rate;
        out->capacitance[k] = point->film.capacitance;
        out->soft_gain[k] = plant->zones[k].kind == DEA_PORT_PASSIVE ? 0.0 : find_gain(plant, k);
    }
    out->stiffness = stiffness_at_voltage(plant);
    out->damping = plant->device->damping;
    out->mass = plant->device->effective_mass;
    return DEA_OK;
}

double dea_outlook_position(const struct dea_outlook *outlook, double t) {
    double d = t - outlook->start;
    const double *x = outlook->x;
    double position = x[0] + d * (x[1] + d * (x[2] + d * x[3]));
    return outlook->fast != 0.0 ? position - outlook->fast * expm1(-d / outlook->settling) : position;
}

double dea_outlook_stretch(const struct dea_device *device, const struct dea_outlook *outlook, int zone, double t) {
    if (!outlook->slack[zone])
        return dea_zone_stretch(device, zone, dea_outlook_position(outlook, t));
    double d = t - outlook->start;
    const double *lam = outlook->lam[zone];
    return lam[0] + d * (lam[1] + d * (lam[2] + d * lam[3]));
}
