/* Amplifiers at their limits of current and slew rate. Which limit holds stays fixed during a step, so that the
 * integrator sees smooth equations: a clipped right side would let it step across the corner unnoticed, and behind an
 * output resistance so small that all of the clipping happens within the step's tolerance its Newton iteration would
 * take a slope for one where there is none. The integrator locates the moments at which limits begin and end to hold.
 */
#include "plant/amplifier.h"
#include "plant/integrator.h"

#include <math.h>

#define NEAR_LIMIT 1.0 /* steps' tolerances */
#define OVERSTEP 1e-9  /* beyond a limit by this part and not located: changed at the end of the step */
/* A demand that stays at its limit makes that begin and end to hold without end. After so many changes, each within
 * this part of the run of the one before, the demand is clipped instead, for a while. */
#define QUICK_TURNS 20
#define AT_ONCE 1e-7
#define CLIPPED_FOR 1e-4 /* of the run */

/* What a limit bounds, in units of the limit; with `yp` as the integrator knows it, which says more than a difference
 * of two voltages all but equal. */
static double demand_current(const struct dea_plant *plant, int k, const double *yp) {
    const struct zone_layout *zone = &plant->zones[k];
    const struct zone_point *point = &plant->points[k];
    double wanted = yp != NULL ? yp[zone->charge] * plant->scale[zone->charge] + point->leak : point->demand;
    return wanted / plant->options.ports[k].amplifier->current_limit;
}

static double demand_slew(const struct dea_plant *plant, int k, double t, const double *yp) {
    const struct zone_layout *zone = &plant->zones[k];
    if (yp != NULL)
        return yp[zone->amplifier] * plant->scale[zone->amplifier] / zone->slew;
    return zone->pole * (dea_piece_value(&plant->inputs.source[k], t, NULL) - plant->points[k].emf) / zone->slew;
}

static double demand(const struct dea_plant *plant, const struct held_limit *limit, double t, const double *yp) {
    const double *rates = limit->held == 0 ? yp : NULL; /* one that holds is left by the unlimited value */
    return limit->of_slew ? demand_slew(plant, limit->zone, t, rates) : demand_current(plant, limit->zone, rates);
}

/* Positive while the limit stays as it is. */
static double limit_reserve(const struct held_limit *limit, double demanded) {
    if (limit->held == LIMIT_UNDECIDED)
        return 1.0;
    return limit->held == 0 ? 1.0 - fabs(demanded) : limit->held * demanded - 1.0;
}

void plant_list_limits(struct dea_plant *plant) {
    plant->limit_count = 0;
    for (int k = 0; k < DEA_ZONES; k++) {
        const struct dea_amplifier *amplifier = plant->options.ports[k].amplifier;
        plant->zones[k].current_limit = plant->zones[k].slew_limit = ABSENT;
        if (!plant->zones[k].present || plant->zones[k].kind != DEA_PORT_SOURCE || amplifier == NULL)
            continue;
        if (plant->zones[k].amplifier != ABSENT && !isinf(plant->zones[k].slew)) {
            plant->zones[k].slew_limit = plant->limit_count;
            plant->limits[plant->limit_count++] =
                (struct held_limit){.zone = k, .of_slew = true, .held = LIMIT_UNDECIDED};
        }
        if (!isinf(amplifier->current_limit)) {
            plant->zones[k].current_limit = plant->limit_count;
            plant->limits[plant->limit_count++] = (struct held_limit){.zone = k, .held = LIMIT_UNDECIDED};
        }
    }
}

double plant_hold_limit(const struct dea_plant *plant, int index, double value, double limit) {
    int held = index != ABSENT ? plant->limits[index].held : LIMIT_UNDECIDED;
    if (held == LIMIT_UNDECIDED)
        return fmax(-limit, fmin(limit, value));
    return held == 0 ? value : held * limit;
}

bool plant_limit_holds(const struct dea_plant *plant, int index, double value, double limit) {
    int held = index != ABSENT ? plant->limits[index].held : LIMIT_UNDECIDED;
    return held == LIMIT_UNDECIDED ? fabs(value) > limit : held != 0;
}

void plant_release_limits(struct dea_plant *plant) {
    plant_forget(plant);
    for (int i = 0; i < plant->limit_count; i++) {
        plant->limits[i].held = LIMIT_UNDECIDED;
        plant->limits[i].turns = false;
    }
}

void plant_choose_limits(struct dea_plant *plant) {
    plant_forget(plant);
    for (int i = 0; i < plant->limit_count; i++) {
        double demanded = demand(plant, &plant->limits[i], plant->t, NULL);
        plant->limits[i].held = fabs(demanded) <= 1.0 ? 0 : demanded > 0.0 ? 1 : -1;
    }
}

void plant_limit_roots(const struct dea_plant *plant, double t, const double *yp, double *values) {
    for (int i = 0; i < plant->limit_count; i++)
        values[i] = limit_reserve(&plant->limits[i], demand(plant, &plant->limits[i], t, yp));
}

/* ---- changes ---- */

static double run_length(const struct dea_plant *plant) {
    return fmax(plant->options.duration, plant->t);
}

/* Notes a change; whether it is one of many at once. */
static bool chatters(const struct dea_plant *plant, struct held_limit *limit) {
    bool quick = plant->t - limit->turned < AT_ONCE * run_length(plant);
    limit->quick_turns = quick ? limit->quick_turns + 1 : 0;
    limit->turned = plant->t;
    return limit->quick_turns >= QUICK_TURNS;
}

enum dea_status plant_note_limits(struct dea_plant *plant, const int *hits) {
    if (plant->limit_count == 0)
        return DEA_OK;
    const double *y = NV_DATA_S(plant->y), *yp = NV_DATA_S(plant->yp);
    plant->rates_now = yp;
    DEA_TRY(plant_evaluate(plant, plant->t, y, plant_velocity(plant, y, yp), false));
    for (int i = 0; i < plant->limit_count; i++) {
        struct held_limit *limit = &plant->limits[i];
        limit->demanded = demand(plant, limit, plant->t, yp);
        limit->turns = limit->held == LIMIT_UNDECIDED
                           ? plant->t > limit->turned + CLIPPED_FOR * run_length(plant)
                           : (hits != NULL && hits[i] != 0) || limit_reserve(limit, limit->demanded) < -OVERSTEP;
    }
    return DEA_OK;
}

/* The unknown that a limit begins to bound, put to where the demand is the limit: within the tolerance it is there
 * already, but a demand that is a small difference may be anywhere in that. Farther off it stays where it is: the step
 * went past the limit. */
static enum dea_status put_to_limit(struct dea_plant *plant, const struct held_limit *limit, double side) {
    enum { ITERATIONS = 4 };
    double *y = NV_DATA_S(plant->y), *yp = NV_DATA_S(plant->yp);
    const struct zone_layout *zone = &plant->zones[limit->zone];
    int moved = limit->of_slew ? zone->amplifier : zone->charge;
    double before = y[moved], near = NEAR_LIMIT * plant->rtol * fmax(fabs(before), plant->largest[moved]);
    const struct zone_point *point = &plant->points[limit->zone];
    for (int i = 0; i < ITERATIONS; i++) {
        DEA_TRY(plant_evaluate(plant, plant->t, y, plant_velocity(plant, y, yp), true));
        double excess = demand(plant, limit, plant->t, NULL) - side;
        if (limit->of_slew) {
            y[zone->amplifier] += excess * zone->slew / zone->pole / plant->scale[zone->amplifier];
        } else if (point->film.dvoltage_de > 0.0) {
            double volts = excess * plant->options.ports[limit->zone].amplifier->current_limit / point->current_emf;
            y[zone->charge] += volts / point->film.dvoltage_de / plant->scale[zone->charge];
        }
    }
    if (fabs(y[moved] - before) > near)
        y[moved] = before;
    return DEA_OK;
}

bool plant_limits_turn(const struct dea_plant *plant) {
    for (int i = 0; i < plant->limit_count; i++)
        if (plant->limits[i].turns)
            return true;
    return false;
}

enum dea_status plant_turn_limits(struct dea_plant *plant) {
    plant_forget(plant);
    for (int i = 0; i < plant->limit_count; i++) {
        struct held_limit *limit = &plant->limits[i];
        if (!limit->turns)
            continue;
        limit->turns = false;
        if (limit->held != LIMIT_UNDECIDED && chatters(plant, limit)) {
            limit->held = LIMIT_UNDECIDED;
            continue;
        }
        bool ends = limit->held == LIMIT_UNDECIDED ? fabs(limit->demanded) <= 1.0 : limit->held != 0;
        int side = ends ? 0 : limit->demanded > 0.0 ? 1 : -1;
        limit->held = 0;
        if (side != 0)
            DEA_TRY(put_to_limit(plant, limit, side));
        limit->held = side;
    }
    return DEA_OK;
}
