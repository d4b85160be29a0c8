/* The physics of a state: each zone's film, currents, the force on the platform, rates of change and of energy. */
#include "plant/amplifier.h"
#include "plant/integrator.h"
#include "plant/network.h"

#include <float.h>
#include <math.h>
#include <string.h>

#define SAME_DIGITS 4.0 /* last digits of the largest value so far, by which two states may differ and be one */

double plant_charge_value(const struct dea_charge_piece *piece, double t, double *rate) {
    double d = t - piece->start;
    const double *c = piece->c;
    if (rate != NULL)
        *rate = c[1] + d * (2.0 * c[2] + d * 3.0 * c[3]);
    return c[0] + d * (c[1] + d * (c[2] + d * c[3]));
}

/* Leakage through the film, plus a short. */
void plant_leak_through_film(const struct dea_plant *plant, int k, struct zone_point *point) {
    double v = point->film.voltage, shunt = plant->short_conductance[k];
    point->leak = dea_zone_leakage(plant->device, k, point->film.lam, v, &point->leak_v, &point->leak_lam) + shunt * v;
    point->leak_v += shunt;
}

/* Current of a source port through its resistances, limited by the amplifier. */
void plant_drive_current(const struct dea_plant *plant, int k, struct zone_point *point) {
    const struct dea_plant_port *port = &plant->options.ports[k];
    double slope, resistance = port->resistance + dea_zone_resistance(plant->device, k, point->film.lam, &slope);
    point->demand = point->current = (point->emf - point->film.voltage) / resistance;
    point->current_v = -1.0 / resistance;
    point->current_emf = 1.0 / resistance;
    point->current_lam = -point->current * slope / resistance;
    double limit = port->amplifier != NULL ? port->amplifier->current_limit : INFINITY;
    int index = plant->zones[k].current_limit;
    if (plant_limit_holds(plant, index, point->demand, limit)) {
        point->current = plant_hold_limit(plant, index, point->demand, limit);
        point->current_v = point->current_emf = point->current_lam = 0.0;
    }
}

static enum dea_status evaluate_zone(struct dea_plant *plant, int k, double t, const double *y, double x,
                                     bool with_derivatives) {
    const struct zone_layout *zone = &plant->zones[k];
    struct zone_point *point = &plant->points[k];
    for (int i = 0; zone->branch != ABSENT && i < 2 * plant->device->material.branch_count; i++)
        point->states[i] = y[zone->branch + i] * plant->scale[zone->branch + i];

    /* what is given on the electrical side */
    point->e = point->e_rate = point->emf = point->emf_rate = 0.0;
    if (zone->kind == DEA_PORT_IDEAL) {
        point->e = point->emf = dea_piece_value(&plant->inputs.source[k], t, &point->e_rate);
    } else if (zone->kind == DEA_PORT_CHARGE) {
        point->e = plant_charge_value(&plant->inputs.charge[k], t, &point->e_rate);
    } else if (zone->kind == DEA_PORT_NETWORK) {
        point->e = y[zone->charge] * plant->scale[zone->charge];
        point->emf = plant_network_port_voltage(plant, k, y);
        if (plant->rates_now != NULL)
            point->e_rate = plant->rates_now[zone->charge] * plant->scale[zone->charge];
    } else if (zone->kind == DEA_PORT_SOURCE) {
        point->e = y[zone->charge] * plant->scale[zone->charge];
        point->emf = dea_piece_value(&plant->inputs.source[k], t, &point->emf_rate);
        if (zone->amplifier != ABSENT)
            point->emf = y[zone->amplifier] * plant->scale[zone->amplifier];
    }
    if (dea_film_respond(plant->device, k, zone->control, x, point->e, point->states, with_derivatives, point->branches,
                         &point->film) != DEA_OK) {
        bool flat = !(dea_zone_stretch(plant->device, k, x) > 0.0);
        plant->trouble = flat     ? "the platform ran into the frame (platform.stops keep it off)"
                         : k == 0 ? "the left zone left the model (elastic limit, collapse or pull-in)"
                                  : "the right zone left the model (elastic limit, collapse or pull-in)";
        return DEA_RECOVERABLE;
    }
    if (zone->kind != DEA_PORT_PASSIVE && zone->kind != DEA_PORT_CHARGE)
        plant_leak_through_film(plant, k, point);
    if (zone->kind == DEA_PORT_SOURCE || (zone->kind == DEA_PORT_NETWORK && zone->resistive))
        plant_drive_current(plant, k, point);
    return DEA_OK;
}

/* The books look at the end of a step, and so do root functions, limits and signals after it; the integrator gives them
 * the same state up to its last digits. */
static bool is_known(const struct dea_plant *plant, double t, const double *y, double rate_x, bool with_derivatives) {
    const struct known_state *known = &plant->known;
    bool moving = plant->device->has_stops && plant->motion != MOTION_INERTIAL; /* rate_x matters, and is not in y */
    if (!known->valid || known->t != t || known->with_derivatives < with_derivatives ||
        (moving && known->rate_x != rate_x))
        return false;
    for (int i = 0; i < plant->state_count; i++)
        if (!(fabs(known->y[i] - y[i]) <= SAME_DIGITS * DBL_EPSILON * plant->largest[i]))
            return false;
    return true;
}

void plant_remember(struct dea_plant *plant, double t, const double *y, double rate_x, bool with_derivatives) {
    struct known_state *known = &plant->known;
    known->valid = true;
    known->with_derivatives = with_derivatives;
    known->t = t;
    known->rate_x = rate_x;
    memcpy(known->y, y, (size_t)plant->state_count * sizeof *y);
}

void plant_forget(struct dea_plant *plant) {
    plant->known.valid = false;
}

/* Force of the stops with its derivatives. One held on pulls a little, too: until the moment is found at which it would
 * begin to. */
static double stop_force(struct dea_plant *plant, double x, double rate_x) {
    const struct dea_device *device = plant->device;
    if (plant->stops_held[0] == STOP_UNDECIDED)
        return dea_stop_force(device, x, rate_x, &plant->force_x, &plant->force_v, NULL, &plant->stop_loss);
    double force = 0.0;
    plant->force_x = plant->force_v = plant->stop_loss = 0.0;
    for (int side = 0; side < 2; side++) {
        if (plant->stops_held[side] != STOP_ON)
            continue;
        force -= device->stop_stiffness * (x - device->stops[side]);
        plant->force_x -= device->stop_stiffness;
    }
    return force;
}

enum dea_status plant_evaluate(struct dea_plant *plant, double t, const double *y, double rate_x,
                               bool with_derivatives) {
    const struct dea_device *device = plant->device;
    if (is_known(plant, t, y, rate_x, with_derivatives))
        return DEA_OK;
    plant_forget(plant);
    double x = y[plant->x] * plant->scale[plant->x];
    plant->force = device->load + dea_piece_value(&plant->inputs.load, t, NULL);
    for (int k = 0; k < DEA_ZONES; k++) {
        if (!plant->zones[k].present)
            continue;
        DEA_TRY(evaluate_zone(plant, k, t, y, x, with_derivatives));
        plant->force -= device->zones[k].side * plant->points[k].film.pull;
    }
    plant->force += stop_force(plant, x, rate_x);
    return DEA_OK;
}

double plant_velocity(const struct dea_plant *plant, const double *y, const double *yp) {
    if (plant->motion == MOTION_INERTIAL)
        return y[plant->v] * plant->scale[plant->v];
    return plant->motion == MOTION_VISCOUS ? yp[plant->x] * plant->scale[plant->x] : 0.0;
}

double plant_pace(const struct dea_plant *plant, const double *y, const double *yp) {
    return plant->v != ABSENT ? y[plant->v] * plant->scale[plant->v] : yp[plant->x] * plant->scale[plant->x];
}

void plant_rates(const struct dea_plant *plant, double t, const double *y, double *rates) {
    const struct dea_device *device = plant->device;
    const double *scale = plant->scale;
    rates[plant->x] = 0.0;
    if (plant->motion == MOTION_INERTIAL) {
        double v = y[plant->v] * scale[plant->v];
        rates[plant->x] = v / scale[plant->x];
        rates[plant->v] = (plant->force - device->damping * v) / (device->effective_mass * scale[plant->v]);
    } else if (plant->motion == MOTION_VISCOUS) {
        rates[plant->x] = plant->force / (device->damping * scale[plant->x]);
    }
    for (int k = 0; k < DEA_ZONES; k++) {
        const struct zone_layout *zone = &plant->zones[k];
        const struct zone_point *point = &plant->points[k];
        if (zone->branch != ABSENT)
            for (int b = 0; b < device->material.branch_count; b++)
                for (int i = 0; i < 2; i++)
                    rates[zone->branch + 2 * b + i] = point->branches[b].rate[i] / scale[zone->branch + 2 * b + i];
        if (zone->amplifier != ABSENT) {
            double command = dea_piece_value(&plant->inputs.source[k], t, NULL);
            double rate = zone->pole * (command - point->emf);
            rates[zone->amplifier] =
                plant_hold_limit(plant, zone->slew_limit, rate, zone->slew) / scale[zone->amplifier];
        }
        if (zone->charge != ABSENT)
            rates[zone->charge] = (point->current - point->leak) / scale[zone->charge];
    }
}

double plant_algebraic_rate(const struct dea_plant *plant, double t, const double *rates) {
    const struct dea_device *device = plant->device;
    double by_x = plant->force_x, by_time;
    dea_piece_value(&plant->inputs.load, t, &by_time);
    for (int k = 0; k < DEA_ZONES; k++) {
        const struct zone_layout *zone = &plant->zones[k];
        if (!zone->present)
            continue;
        const struct zone_point *point = &plant->points[k];
        double side = device->zones[k].side, e_rate = point->e_rate;
        if (zone->kind == DEA_PORT_SOURCE || (zone->kind == DEA_PORT_NETWORK && zone->resistive))
            e_rate = rates[zone->charge] * plant->scale[zone->charge];
        by_x -= side * point->film.dpull_dx;
        by_time -= side * point->film.dpull_de * e_rate;
        if (zone->branch != ABSENT)
            for (int b = 0; b < device->material.branch_count; b++)
                for (int i = 0; i < 2; i++)
                    by_time -= side * point->film.dpull_dp1 * point->branches[b].dp1_dz[i] * point->branches[b].rate[i];
    }
    return by_x != 0.0 ? -by_time / by_x : 0.0;
}

/* A slack film's stretch moves with the charge and the branches. Their rates are the integrator's where it has any:
 * worked out from the state, behind a small resistance or time constant, they are leftovers of Newton's iteration. */
double plant_stretch_rate(const struct dea_plant *plant, int k, double rate_x) {
    const struct zone_layout *zone = &plant->zones[k];
    const struct zone_point *point = &plant->points[k];
    if (!point->film.slack)
        return point->film.dlam_dx * rate_x;
    const double *now = plant->rates_now, *scale = plant->scale;
    double e_rate = zone->kind != DEA_PORT_SOURCE ? point->e_rate
                    : now != NULL                 ? now[zone->charge] * scale[zone->charge]
                                                  : point->current - point->leak;
    double rate = point->film.dlam_de * e_rate;
    for (int b = 0; b < plant->device->material.branch_count; b++)
        for (int i = 0; i < 2; i++) {
            int state = zone->branch + 2 * b + i;
            double z_rate = now != NULL ? now[state] * scale[state] : point->branches[b].rate[i];
            rate += point->film.dlam_dp1 * point->branches[b].dp1_dz[i] * z_rate;
        }
    return rate;
}

void plant_losses(const struct dea_plant *plant, double t, double x, double rate_x, double *losses) {
    const struct dea_device *device = plant->device;
    for (int i = 0; i < LOSS_COUNT; i++)
        losses[i] = 0.0;
    /* F dx = d(F x) - x dF for the imposed part of the load; the constant part is a potential */
    double load_rate;
    dea_piece_value(&plant->inputs.load, t, &load_rate);
    losses[LOSS_LOAD] = -x * load_rate;
    losses[LOSS_DAMPING] = device->damping * rate_x * rate_x;
    losses[LOSS_STOP] = plant->stop_loss;
    for (int k = 0; k < DEA_ZONES; k++) {
        const struct zone_layout *zone = &plant->zones[k];
        if (!zone->present)
            continue;
        const struct zone_point *point = &plant->points[k];
        for (int b = 0; b < device->material.branch_count; b++)
            losses[LOSS_BRANCH] += device->zones[k].volume * point->branches[b].dissipation;
        if (zone->kind == DEA_PORT_PASSIVE)
            continue;
        /* V dQ = d(Q V / 2) + V^2 dC / 2: slow, however fast a circuit makes the charge ring, and free of the rounding
         * of a current that is the small difference of two voltages */
        double slope;
        dea_zone_capacitance(device, k, point->film.lam, &slope, NULL);
        losses[LOSS_WORK] +=
            0.5 * point->film.voltage * point->film.voltage * slope * plant_stretch_rate(plant, k, rate_x);
        if (zone->kind == DEA_PORT_CHARGE) /* leakage and R_e belong to the circuit */
            continue;
        bool resistive = zone->kind == DEA_PORT_SOURCE || zone->resistive;
        double through = point->film.voltage * point->leak;
        double across = resistive ? (point->emf - point->film.voltage) * point->current : 0.0;
        losses[LOSS_LEAKAGE] += through;
        losses[LOSS_RESISTIVE] += across;
        losses[LOSS_WORK] += through + across;
    }
}
