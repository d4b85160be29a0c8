/* How a motion multiplies small errors. A difference between two neighbouring motions obeys the platform's equation
 * with the stiffness of the moment: while films are taut it swings as the platform does at rest, where a film goes
 * slack, a stop is met or the voltage undoes the stiffness it grows. Errors made at all times alike are carried along;
 * what becomes of them, over what would if the stiffness were always that of rest, is the sensitivity. Its unit of
 * position is the velocity over the natural frequency. */
#include "plant/integrator.h"

#include <math.h>

#define LARGEST 1e100  /* variance beyond which growth is not followed any more */
#define STEEPEST 100.0 /* growth of one step, in powers of e */

/* exp(A h) for m x'' = -k x - c x', in units of (omega x, x'). */
static void find_flow(double stiffness, double damping, double mass, double omega, double h, double flow[2][2]) {
    double rate = 0.5 * damping / mass, square = rate * rate - stiffness / mass;
    double angle = sqrt(fabs(square)) * h, decay = exp(-rate * h), along, across;
    if (square < 0.0) {
        along = decay * cos(angle);
        across = angle > 0.0 ? decay * h * sin(angle) / angle : decay * h;
    } else { /* one decays alone: the difference of the two is small beside both */
        double slow = exp(fmin((sqrt(square) - rate) * h, STEEPEST)), fast = exp(-(sqrt(square) + rate) * h);
        along = 0.5 * (slow + fast);
        across = angle > 1e-8 ? h * 0.5 * (slow - fast) / angle : decay * h;
    }
    flow[0][0] = along + rate * across;
    flow[0][1] = omega * across;
    flow[1][0] = -stiffness / (mass * omega) * across;
    flow[1][1] = along - rate * across;
}

/* Mean over a step of what has two values, `before` and `after`, and changes from one to the other where the distance
 * passes through zero. */
static double find_mean(double before, double after, double from, double to) {
    if ((from < 0.0) == (to < 0.0))
        return 0.5 * (before + after);
    double part = fabs(from) / (fabs(from) + fabs(to)); /* of the step, before the change */
    return part * before + (1.0 - part) * after;
}

/* Stiffness of a film as the platform meets it: its charge stays where it is behind a large resistance. */
static double film_stiffness(const struct dea_plant *plant, int k) {
    const struct dea_film *film = &plant->points[k].film;
    if (film->slack)
        return 0.0;
    double stiffness = film->stiffness - plant->relaxing[k];
    if (plant->keeps_charge[k]) {
        double slope, c = dea_zone_capacitance(plant->device, k, film->lam, &slope, NULL);
        double pull = film->voltage * slope * film->dlam_dx; /* C/m */
        stiffness += pull * pull / c;
    }
    return stiffness;
}

/* Mean stiffness of the last step at given voltages, stops included. Uses the evaluation at its end. */
static double find_stiffness(const struct dea_plant *plant, double x) {
    const struct dea_device *device = plant->device;
    const struct error_spread *spread = &plant->spread;
    double sum = 0.0, x_before = spread->x;
    for (int k = 0; k < DEA_ZONES; k++) {
        if (plant->zones[k].present)
            sum += find_mean(spread->stiffness[k], film_stiffness(plant, k), spread->margin[k],
                             plant->points[k].film.margin);
    }
    for (int side = 0; device->has_stops && side < 2; side++) {
        double sign = side > 0 ? 1.0 : -1.0;
        double from = sign * (x_before - device->stops[side]), to = sign * (x - device->stops[side]);
        double hard = device->stop_stiffness;
        sum += find_mean(from > 0.0 ? hard : 0.0, to > 0.0 ? hard : 0.0, from, to);
    }
    return sum;
}

static double position(const struct dea_plant *plant) {
    return NV_Ith_S(plant->y, plant->x) * plant->scale[plant->x];
}

void plant_note_place(struct dea_plant *plant) {
    struct error_spread *spread = &plant->spread;
    spread->x = position(plant);
    for (int k = 0; k < DEA_ZONES; k++) {
        spread->stiffness[k] = film_stiffness(plant, k);
        spread->margin[k] = plant->points[k].film.margin;
    }
}

void plant_note_sensitivity(struct dea_plant *plant) {
    const struct dea_device *device = plant->device;
    struct error_spread *spread = &plant->spread;
    double h = plant->t - plant->t_previous, resistance = plant->resistance;
    if (plant->motion == MOTION_ALGEBRAIC || device->stiffness <= 0.0 || h <= 0.0 || spread->xx > LARGEST ||
        spread->vv > LARGEST)
        return;
    double stiffness = find_stiffness(plant, position(plant)), calm;
    plant_note_place(plant);
    if (plant->motion == MOTION_VISCOUS) {
        double flow = exp(-fmax(stiffness / (resistance - plant->force_v) * h, -STEEPEST));
        spread->xx = flow * flow * spread->xx + h;
        calm = exp(-2.0 * device->stiffness / resistance * h);
    } else {
        double mass = device->effective_mass, omega = sqrt(device->stiffness / mass), flow[2][2];
        find_flow(stiffness, resistance - plant->force_v, mass, omega, h, flow);
        double xx = spread->xx, xv = spread->xv, vv = spread->vv;
        double a = flow[0][0], b = flow[0][1], c = flow[1][0], d = flow[1][1];
        spread->xx = a * a * xx + 2.0 * a * b * xv + b * b * vv + h;
        spread->xv = a * c * xx + (a * d + b * c) * xv + b * d * vv;
        spread->vv = c * c * xx + 2.0 * c * d * xv + d * d * vv + h;
        calm = exp(-resistance / mass * h);
    }
    spread->calm = calm * spread->calm + h;
    spread->sum += h * spread->xx;
    spread->calm_sum += h * spread->calm;
}

double dea_plant_sensitivity(const struct dea_plant *plant) {
    return plant->spread.calm_sum > 0.0 ? sqrt(plant->spread.sum / plant->spread.calm_sum) : 1.0;
}
