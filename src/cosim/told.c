/* What a circuit is told of the films of a device, and what it makes of them. */
#include "cosim/coupled_internal.h"

#include <math.h>

/* As many times itself a capacitance may grow with its own voltage within a step: a slack film near pull-in yields at
 * an almost constant voltage. */
#define MAX_SOFT_PART 5.0

struct window_point *coupled_last_point(const struct coupled *coupled, int port) {
    return &coupled->windows[port].points[coupled->windows[port].count - 1];
}

/* Charge of a film a circuit step after its last point. */
static double foresee_charge(const struct coupled *coupled, int port, double t) {
    const struct window *window = &coupled->windows[port];
    const struct window_point *last = &window->points[window->count - 1];
    double rate = coupled->outlook.charge_rate[coupled->zones[port]];
    if (window->count > 1)
        rate = (last->q - last[-1].q) / (last->t - last[-1].t);
    return last->q + rate * (t - last->t);
}

/* How far the correction of the last outlook has faded, 1 to 0. */
static double fade(const struct coupled *coupled, double ahead) {
    double part = coupled->horizon > 0.0 ? fmin(ahead / coupled->horizon, 1.0) : 1.0;
    return (1.0 - part) * (1.0 - part) * (1.0 + 2.0 * part);
}

struct told_film coupled_tell_film(const struct coupled *coupled, int port, double t, double charge) {
    const struct dea_outlook *outlook = &coupled->outlook;
    const struct dea_device *device = coupled->device;
    int k = coupled->zones[port];
    double ahead = fmax(t - outlook->start, 0.0), x = dea_outlook_position(outlook, outlook->start + ahead);
    /* a wild outlook must not lead out of the model */
    double lam = fmin(fmax(dea_zone_stretch(device, k, x), 0.2 * device->prestretch[0]), 5.0 * device->prestretch[0]);
    double c = dea_zone_capacitance(device, k, lam, NULL, NULL), v, soft = 0.0;
    struct dea_film_outlook film = {.slack = false};
    if (device->slack && dea_plant_imagine_film(coupled->plant, k, ahead, x, charge, &film) == DEA_OK &&
        film.slack) { /* its own charge stretches it, at once */
        lam = film.stretch;
        c = film.capacitance;
        soft = film.softness;
        v = charge / c;
    } else {
        v = (outlook->charge[k] + outlook->charge_rate[k] * ahead) / c;
        /* Inertia keeps the platform from following its own voltage within a step, the outlook alone is smoother;
         * damping lets it follow what the voltage does beyond the outlook since the last point. */
        if (outlook->mass <= 0.0 && outlook->damping <= 0.0) {
            soft = dea_outlook_softness(outlook, k, ahead);
        } else if (outlook->mass <= 0.0) {
            const struct window_point *last = coupled_last_point(coupled, port);
            double foreseen = (outlook->charge[k] + outlook->charge_rate[k] * (last->t - outlook->start)) / c;
            soft = dea_outlook_softness(outlook, k, t - last->t);
            v = copysign(sqrt(fmax(v * v - foreseen * foreseen + last->q / c * last->q / c, 0.0)), last->q);
        }
    }
    if (soft * v * v > MAX_SOFT_PART * c)
        soft = MAX_SOFT_PART * c / (v * v);
    /* at the outlook's own voltage, where the capacitance grows with V^2 as the film gives way */
    double slope = c + 2.0 * soft * v * v + coupled->fading[port] * fade(coupled, ahead);
    return (struct told_film){slope, -2.0 * soft * v * v * v, lam, dea_zone_resistance(device, k, lam, NULL),
                              film.slack};
}

void coupled_tell_all(struct coupled *coupled, double t) {
    double ahead = fmax(t - coupled->outlook.start, 0.0);
    coupled->told_at = t;
    coupled->position = dea_outlook_position(&coupled->outlook, coupled->outlook.start + ahead) +
                        coupled->fading_position * fade(coupled, ahead);
    for (int p = 0; p < coupled->port_count; p++)
        coupled->told[p] = coupled_tell_film(coupled, p, t, foresee_charge(coupled, p, t));
}

double coupled_tell(struct coupled *coupled, int port, enum dea_external which, double t) {
    if (t != coupled->told_at)
        coupled_tell_all(coupled, t);
    switch (which) {
    case DEA_EXTERNAL_CAPACITANCE:
        return coupled->told[port].c;
    case DEA_EXTERNAL_OFFSET:
        return coupled->told[port].q0;
    case DEA_EXTERNAL_RESISTANCE:
        return coupled->told[port].resistance;
    case DEA_EXTERNAL_STRETCH:
        return coupled->told[port].stretch;
    case DEA_EXTERNAL_SHORT:
        return coupled->shorted[port];
    default:
        return coupled->position;
    }
}

double coupled_quotient(const struct told_film *film, double v) {
    if (film->q0 == 0.0)
        return film->c;
    double least = 1.0 / (1.0 + 2.0 * MAX_SOFT_PART);
    return fabs(film->q0) < (1.0 - least) * film->c * fabs(v) ? film->c + film->q0 / v : least * film->c;
}

double coupled_film_voltage(const struct coupled *coupled, int port, double t, double q, double *capacitance) {
    struct told_film film = coupled_tell_film(coupled, port, t, q);
    double v = (q - film.q0) / film.c;
    if (capacitance != NULL)
        *capacitance = coupled_quotient(&film, v);
    return v;
}
