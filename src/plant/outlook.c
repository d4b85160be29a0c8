/* The plant's near future for a circuit that asks for capacitances between two exchanges: Taylor series with inertia,
 * the exact exponential of the linearised balance without. */
#include "plant/integrator.h"

#include <math.h>

/* Below this part of the rest stiffness the response to a voltage counts as limited: past a pitchfork it would be
 * infinite. */
#define SOFTEST 0.02
/* A film is taut for sure if what the tangent leaves of its tension is more than this part of what it is made of, and
 * the stretch has changed by no more than that part. */
#define SURELY_TAUT 0.1
#define NEAR_STRETCH 0.01
/* Looking for contact with an end stop: places within the horizon, and how closely of it the time is found. */
#define CONTACT_PARTS 8
#define CONTACT_PRECISION 1e-6

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
    const double *y = NV_DATA_S(plant->y);
    double stiffness, drift = drift_force(plant, &stiffness), c = device->damping;
    out->charge_stiffness = stiffness;
    out->x[0] = y[plant->x] * plant->scale[plant->x];
    out->x[1] = out->x[2] = out->x[3] = out->fast = 0.0;
    out->settling = 1.0;
    out->swing = INFINITY;
    if (plant->motion == MOTION_INERTIAL) {
        double m = device->effective_mass, v = y[plant->v] * plant->scale[plant->v];
        double a = (plant->force - c * v) / m;
        if (stiffness > SOFTEST * device->stiffness) {
            out->creep = drift / stiffness;
            out->balance = out->x[0] + m * a / stiffness;
            out->swing = hypot(m * a / stiffness, (v - out->creep) * sqrt(m / stiffness));
        }
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

void dea_outlook_rest(struct dea_outlook *outlook) {
    outlook->x[0] = outlook->balance;
    outlook->x[1] = outlook->creep;
    outlook->x[2] = outlook->x[3] = 0.0;
    outlook->mass = outlook->damping = 0.0;
    for (int k = 0; k < DEA_ZONES; k++) /* the circuit is asked for no offset where there is inertia */
        outlook->soft_gain[k] = 0.0;
}

/* What a taut film's capacitance makes of its own voltage: (1/2) (dC/dx)^2 over the platform's resistance to motion. */
static double find_gain(const struct dea_plant *plant, int k) {
    const struct dea_device *device = plant->device;
    const struct dea_film *film = &plant->points[k].film;
    if (film->slack || plant->zones[k].kind == DEA_PORT_PASSIVE)
        return 0.0;
    double slope;
    dea_zone_capacitance(device, k, film->lam, &slope, NULL);
    double per_x = slope * device->prestretch[0] / device->zones[k].length;
    return 0.5 * per_x * per_x;
}

/* Of a slack film: d(C)/d(V^2), from dlam/dQ at fixed branches and Q = C V. */
static double find_own_softness(const struct dea_device *device, int k, const struct dea_film *film) {
    double slope, c = film->capacitance, q = film->charge;
    dea_zone_capacitance(device, k, film->lam, &slope, NULL);
    double charge_per_v2 = 0.5 * c * c / fmax(fabs(q), 1e-30) / fmax(1.0 - q / c * slope * film->dlam_de, SOFTEST);
    return slope * fabs(film->dlam_de) * charge_per_v2;
}

/* The tangent of a film's tension without its Maxwell part. */
static void look_at_tension(struct dea_plant *plant, int k) {
    const struct dea_device *device = plant->device;
    const struct zone_point *point = &plant->points[k];
    const struct dea_film *film = &point->film;
    double c1, c2, v = film->voltage, per_length = device->prestretch[0] / device->zones[k].length;
    double volume = device->zones[k].volume;
    struct tension_ahead *tension = &plant->tension[k];
    dea_zone_capacitance(device, k, film->lam, &c1, &c2);
    *tension = (struct tension_ahead){.slack = film->slack,
                                      .lam = film->lam,
                                      .slope = film->margin * volume + 0.5 * v * v * c1,
                                      .stiffness = film->stiffness / (per_length * per_length) + 0.5 * v * v * c2};
    int branches = plant->zones[k].branch != ABSENT ? device->material.branch_count : 0;
    for (int b = 0; b < branches; b++)
        for (int i = 0; i < 2; i++)
            tension->rate += volume * point->branches[b].dp1_dz[i] * point->branches[b].rate[i];
}

static bool is_surely_taut(const struct tension_ahead *tension, double ahead, double lam, double maxwell) {
    if (tension->slack || fabs(lam - tension->lam) > NEAR_STRETCH * tension->lam)
        return false;
    double elastic = tension->slope + tension->stiffness * (lam - tension->lam) + tension->rate * ahead;
    return elastic - maxwell > SURELY_TAUT * (fabs(tension->slope) + maxwell);
}

static double stiffness_at_voltage(const struct dea_plant *plant) {
    double stiffness = -plant->force_x;
    for (int i = 0; i < DEA_ZONES; i++)
        if (plant->zones[i].present)
            stiffness += plant->points[i].film.stiffness;
    return fmax(stiffness, SOFTEST * plant->device->stiffness);
}

double dea_outlook_softness(const struct dea_outlook *outlook, int zone, double h) {
    if (h <= 0.0)
        return outlook->damping > 0.0 || outlook->mass > 0.0 ? 0.0 : outlook->soft_gain[zone] / outlook->stiffness;
    return outlook->soft_gain[zone] / (outlook->stiffness + outlook->damping / h + 2.0 * outlook->mass / (h * h));
}

enum dea_status dea_plant_look_ahead(struct dea_plant *plant, double horizon, struct dea_outlook *out) {
    const double *y = NV_DATA_S(plant->y), *yp = NV_DATA_S(plant->yp);
    DEA_TRY(plant_evaluate(plant, plant->t, y, plant_velocity(plant, y, yp), true));
    out->start = plant->t;
    look_at_platform(plant, horizon, out);
    for (int k = 0; k < DEA_ZONES; k++) {
        const struct zone_point *point = &plant->points[k];
        if (!plant->zones[k].present)
            continue;
        out->charge[k] = point->film.charge;
        out->charge_rate[k] = point->e_rate;
        out->capacitance[k] = point->film.capacitance;
        out->soft_gain[k] = find_gain(plant, k);
        if (point->film.capacitance > 0.0)
            look_at_tension(plant, k);
    }
    out->stiffness = stiffness_at_voltage(plant);
    out->damping = plant->device->damping;
    out->mass = plant->device->effective_mass;
    return DEA_OK;
}

double dea_outlook_position(const struct dea_outlook *outlook, double t) {
    double velocity, acceleration;
    return dea_outlook_motion(outlook, t, &velocity, &acceleration);
}

double dea_outlook_motion(const struct dea_outlook *outlook, double t, double *velocity, double *acceleration) {
    double d = t - outlook->start;
    const double *x = outlook->x;
    double position = x[0] + d * (x[1] + d * (x[2] + d * x[3]));
    *velocity = x[1] + d * (2.0 * x[2] + d * 3.0 * x[3]);
    *acceleration = 2.0 * x[2] + d * 6.0 * x[3];
    if (outlook->fast != 0.0) {
        double settling = outlook->settling, decay = exp(-d / settling);
        position -= outlook->fast * expm1(-d / settling);
        *velocity += outlook->fast * decay / settling;
        *acceleration -= outlook->fast * decay / (settling * settling);
    }
    return position;
}

static bool is_off_stops(const struct dea_device *device, double x) {
    return x >= device->stops[0] && x <= device->stops[1];
}

double dea_outlook_contact(const struct dea_outlook *outlook, const struct dea_device *device, double horizon) {
    if (!device->has_stops)
        return INFINITY;
    bool off = is_off_stops(device, outlook->x[0]);
    double before = 0.0, after = 0.0;
    for (int part = 1; part <= CONTACT_PARTS && after == 0.0; part++) {
        double ahead = part * horizon / CONTACT_PARTS;
        if (is_off_stops(device, dea_outlook_position(outlook, outlook->start + ahead)) != off)
            after = ahead;
        else
            before = ahead;
    }
    if (after == 0.0)
        return INFINITY;
    while (after - before > CONTACT_PRECISION * horizon) {
        double middle = 0.5 * (before + after);
        if (is_off_stops(device, dea_outlook_position(outlook, outlook->start + middle)) == off)
            before = middle;
        else
            after = middle;
    }
    return outlook->start + after;
}

/* A zone's film with branches that have gone on at their rates since the last look ahead. */
static enum dea_status imagine(struct dea_plant *plant, int k, double ahead, double x, double charge,
                               bool with_derivatives, struct dea_film *film) {
    const struct zone_point *point = &plant->points[k];
    int branches = plant->zones[k].branch != ABSENT ? plant->device->material.branch_count : 0;
    for (int b = 0; b < branches; b++)
        for (int i = 0; i < 2; i++)
            plant->imagined_states[2 * b + i] = point->states[2 * b + i] + ahead * point->branches[b].rate[i];
    return dea_film_respond(plant->device, k, plant->zones[k].control, x, charge, plant->imagined_states,
                            with_derivatives, plant->imagined_branches, film);
}

enum dea_status dea_plant_imagine_film(struct dea_plant *plant, int zone, double ahead, double x, double charge,
                                       struct dea_film_outlook *out) {
    const struct dea_device *device = plant->device;
    double c1, lam = dea_zone_stretch(device, zone, x), c = dea_zone_capacitance(device, zone, lam, &c1, NULL);
    double v = charge / c;
    if (is_surely_taut(&plant->tension[zone], ahead, lam, 0.5 * v * v * c1)) { /* the branches need not be asked */
        *out = (struct dea_film_outlook){lam, c, false, 0.0};
        return DEA_OK;
    }
    struct dea_film film;
    DEA_TRY(imagine(plant, zone, ahead, x, charge, true, &film));
    *out = (struct dea_film_outlook){film.lam, film.capacitance, film.slack,
                                     film.slack ? find_own_softness(device, zone, &film) : 0.0};
    return DEA_OK;
}

enum dea_status dea_plant_imagine_defect(struct dea_plant *plant, const struct dea_outlook *outlook, double t,
                                         const double charges[DEA_ZONES], double *defect) {
    const struct dea_device *device = plant->device;
    double v, a, x = dea_outlook_motion(outlook, t, &v, &a);
    double force = device->load + dea_piece_value(&plant->inputs.load, t, NULL);
    for (int k = 0; k < DEA_ZONES; k++) {
        struct dea_film film;
        if (!plant->zones[k].present)
            continue;
        DEA_TRY(imagine(plant, k, t - outlook->start, x, charges[k], false, &film));
        force -= device->zones[k].side * film.pull;
    }
    force += dea_stop_force(device, x, v, NULL, NULL, NULL, NULL);
    *defect = force - device->damping * v - device->effective_mass * a;
    return DEA_OK;
}
