/* Consistent states: the static start, and restarts where inputs jump. Closed forms give every derivative, so IDACalcIC
 * and its guesses are not needed. */
#include "plant/amplifier.h"
#include "plant/integrator.h"
#include "plant/network.h"

#include <math.h>
#include <string.h>

#define MAX_REST_ROUNDS 100 /* of operating point and leakage */

/* ---- the start ---- */

/* Forces at position x with each zone's electrical state at rest and its branches relaxed or as they are. */
struct rest_task {
    struct dea_plant *plant;
    struct dea_device elastic; /* the device without branches, used while they are relaxed */
    bool relaxed;
    double t;
    const double *voltages;           /* film voltages of charge ports; NULL: their charges are given */
    double film_voltages[DEA_ZONES];  /* those a circuit gives */
    struct dea_film films[DEA_ZONES]; /* of the last position */
};

/* Film voltage behind a resistance once the current only feeds the leakage: (emf - V)/R = leak(V), falling in V. */
static enum dea_status settle_film_voltage(struct rest_task *task, const struct dea_device *device, int k, double x,
                                           double emf) {
    struct dea_plant *plant = task->plant;
    struct zone_point *point = &plant->points[k];
    double low = fmin(0.0, emf), high = fmax(0.0, emf), v = emf;
    for (int i = 0; i < 200; i++) {
        DEA_TRY(dea_film_respond(device, k, DEA_CONTROL_VOLTAGE, x, v, point->states, false, point->branches,
                                 &task->films[k]));
        if (device->material.dielectric.conductivity <= 0.0)
            return DEA_OK;
        point->film = task->films[k];
        point->emf = emf;
        plant_leak_through_film(plant, k, point);
        plant_drive_current(plant, k, point);
        double surplus = point->current - point->leak, slope = point->current_v - point->leak_v,
               next = v - surplus / slope;
        if (surplus > 0.0)
            low = v;
        else
            high = v;
        if (!(next > low && next < high))
            next = 0.5 * (low + high);
        if (fabs(next - v) <= 1e-15 * fabs(emf))
            return DEA_OK;
        v = next;
    }
    return DEA_OK;
}

static enum dea_status rest_force(void *context, double x, double *force) {
    struct rest_task *task = context;
    struct dea_plant *plant = task->plant;
    const struct dea_device *device = task->relaxed ? &task->elastic : plant->device;
    *force = device->load + dea_piece_value(&plant->inputs.load, task->t, NULL);
    *force += dea_stop_force(device, x, 0.0, NULL, NULL, NULL, NULL);
    for (int k = 0; k < DEA_ZONES; k++) {
        const struct zone_layout *zone = &plant->zones[k];
        struct zone_point *point = &plant->points[k];
        if (!zone->present)
            continue;
        if ((zone->kind == DEA_PORT_CHARGE || zone->kind == DEA_PORT_NETWORK) && task->voltages != NULL) {
            DEA_TRY(dea_film_respond(device, k, DEA_CONTROL_VOLTAGE, x, task->voltages[k], point->states, false,
                                     point->branches, &task->films[k]));
        } else if (zone->kind == DEA_PORT_SOURCE) {
            DEA_TRY(settle_film_voltage(task, device, k, x, dea_piece_value(&plant->inputs.source[k], task->t, NULL)));
        } else {
            double e = zone->kind == DEA_PORT_IDEAL    ? dea_piece_value(&plant->inputs.source[k], task->t, NULL)
                       : zone->kind == DEA_PORT_CHARGE ? plant_charge_value(&plant->inputs.charge[k], task->t, NULL)
                                                       : 0.0;
            DEA_TRY(dea_film_respond(device, k, zone->control, x, e, point->states, false, point->branches,
                                     &task->films[k]));
        }
        *force -= device->zones[k].side * task->films[k].pull;
    }
    return DEA_OK;
}

static double shortest_zone(const struct dea_device *device) {
    double shortest = INFINITY;
    for (int k = 0; k < DEA_ZONES; k++)
        if (device->zones[k].present)
            shortest = fmin(shortest, device->zones[k].length);
    return shortest;
}

static void set_fresh_branches(struct dea_plant *plant) {
    const struct dea_material *material = &plant->device->material;
    for (int k = 0; k < DEA_ZONES; k++)
        for (int b = 0; b < material->branch_count; b++)
            dea_branch_fresh(&material->branches[b], plant->device->prestretch, plant->points[k].states + 2 * b);
}

/* Writes the resting films into the unknowns. */
static void store_rest(struct dea_plant *plant, const struct rest_task *task, double x, double v) {
    const struct dea_material *material = &plant->device->material;
    double *y = NV_DATA_S(plant->y);
    y[plant->x] = x / plant->scale[plant->x];
    if (plant->v != ABSENT)
        y[plant->v] = v / plant->scale[plant->v];
    for (int k = 0; k < DEA_ZONES; k++) {
        const struct zone_layout *zone = &plant->zones[k];
        if (!zone->present)
            continue;
        double *states = plant->points[k].states;
        for (int b = 0; zone->branch != ABSENT && b < material->branch_count; b++) {
            if (task->relaxed)
                dea_branch_relaxed(&material->branches[b], plant->device->prestretch, task->films[k].lam,
                                   states + 2 * b);
            for (int i = 0; i < 2; i++)
                y[zone->branch + 2 * b + i] = states[2 * b + i] / plant->scale[zone->branch + 2 * b + i];
        }
        if (zone->amplifier != ABSENT)
            y[zone->amplifier] =
                dea_piece_value(&plant->inputs.source[k], task->t, NULL) / plant->scale[zone->amplifier];
        if (zone->charge != ABSENT)
            y[zone->charge] = task->films[k].charge / plant->scale[zone->charge];
    }
}

/* ---- consistency ---- */

struct frozen_task {
    struct dea_plant *plant;
    double t;
};

/* Net force with every other unknown frozen, for the position of a massless, undamped platform. */
static enum dea_status frozen_force(void *context, double x, double *force) {
    struct frozen_task *task = context;
    struct dea_plant *plant = task->plant;
    double *y = NV_DATA_S(plant->y);
    y[plant->x] = x / plant->scale[plant->x];
    DEA_TRY(plant_evaluate(plant, task->t, y, 0.0, false));
    *force = plant->force;
    return DEA_OK;
}

/* Moves an algebraic platform to where the present inputs hold it. */
static enum dea_status balance_platform(struct dea_plant *plant, double t) {
    if (plant->motion != MOTION_ALGEBRAIC)
        return DEA_OK;
    double *y = NV_DATA_S(plant->y), x = y[plant->x] * plant->scale[plant->x];
    double shortest = shortest_zone(plant->device);
    struct frozen_task task = {plant, t};
    DEA_TRY(plant_find_balance(frozen_force, &task, x, fmin(1e-3 * shortest, 0.1 * plant->scale[plant->x]),
                               plant->device->stiffness * shortest, &x));
    y[plant->x] = x / plant->scale[plant->x];
    return DEA_OK;
}

/* Derivatives of all unknowns at a balanced state. */
static enum dea_status derive_rates(struct dea_plant *plant, double t) {
    double *y = NV_DATA_S(plant->y), *yp = NV_DATA_S(plant->yp);
    double v = plant->motion == MOTION_INERTIAL ? y[plant->v] * plant->scale[plant->v] : 0.0;
    DEA_TRY(plant_evaluate(plant, t, y, v, true));
    plant_rates(plant, t, y, yp);
    if (plant->motion == MOTION_VISCOUS) /* contact resists motion too: (c - dF/dv) v = F(v = 0) */
        yp[plant->x] *= plant->device->damping / (plant->device->damping - plant->force_v);
    if (plant->motion == MOTION_ALGEBRAIC)
        yp[plant->x] = plant_algebraic_rate(plant, t, yp) / plant->scale[plant->x];
    return DEA_OK;
}

static enum dea_status make_consistent(struct dea_plant *plant, struct dea_error *error) {
    if (plant->network != ABSENT) {
        DEA_TRY(plant_network_settle(plant, error));
        plant_note_place(plant);
        return plant_restart_integrator(plant, error);
    }
    if (balance_platform(plant, plant->t) != DEA_OK)
        return dea_fail(error, DEA_ERR_SOLVER, "t = %.9g s: no equilibrium of the massless platform: %s", plant->t,
                        plant->trouble != NULL ? plant->trouble : "the forces do not balance anywhere");
    if (derive_rates(plant, plant->t) != DEA_OK)
        return dea_fail(error, DEA_ERR_SOLVER, "t = %.9g s: the state is outside the model: %s", plant->t,
                        plant->trouble != NULL ? plant->trouble : "unknown reason");
    plant_note_place(plant);
    return plant_restart_integrator(plant, error);
}

/* Finds the resting position: given, or downhill from x = 0. Leaves the films of that position in the task. */
static enum dea_status find_rest(struct rest_task *task, const double *x, double *position, struct dea_error *error) {
    struct dea_plant *plant = task->plant;
    task->elastic = *plant->device;
    task->elastic.material.branches = NULL;
    task->elastic.material.branch_count = 0;
    if (!task->relaxed)
        set_fresh_branches(plant);
    double force, shortest = shortest_zone(plant->device);
    enum dea_status status = DEA_OK;
    if (x != NULL)
        *position = *x;
    else
        status =
            plant_find_balance(rest_force, task, 0.0, 1e-3 * shortest, plant->device->stiffness * shortest, position);
    if (status == DEA_OK) /* films of the final position, not of the last trial */
        status = rest_force(task, *position, &force);
    if (status != DEA_OK)
        return dea_fail(error, DEA_ERR_SOLVER,
                        "no static equilibrium at the start: the drive's initial voltages or the load "
                        "are beyond what the membrane can hold");
    return DEA_OK;
}

enum dea_status dea_plant_rest_charges(struct dea_plant *plant, const double voltages[DEA_ZONES], enum dea_start start,
                                       const double *x, struct dea_plant_inputs *inputs, struct dea_error *error) {
    plant->inputs = *inputs;
    plant_forget(plant);
    struct rest_task task = {.plant = plant, .relaxed = start == DEA_START_EQUILIBRIUM, .voltages = voltages};
    double position;
    DEA_TRY(find_rest(&task, x, &position, error));
    for (int k = 0; k < DEA_ZONES; k++)
        if (plant->zones[k].present && plant->zones[k].kind == DEA_PORT_CHARGE)
            inputs->charge[k] = (struct dea_charge_piece){.c = {task.films[k].charge}};
    return DEA_OK;
}

/* Device at rest and operating point of its circuit together: the film voltages are those the circuit gives when the
 * films draw their leakage, which depends on them. */
static enum dea_status rest_with_network(struct rest_task *task, const double *x, double *position,
                                         struct dea_error *error) {
    struct dea_plant *plant = task->plant;
    double drawn[DEA_ZONES] = {0.0, 0.0}, pins[DEA_ZONES], *films = task->film_voltages;
    task->voltages = films;
    for (int round = 0; round < MAX_REST_ROUNDS; round++) {
        double change = 0.0;
        DEA_TRY(plant_network_rest(plant, task->t, drawn, pins, error));
        for (int k = 0; k < DEA_ZONES; k++)
            films[k] =
                pins[k] - (plant->zones[k].resistive
                               ? drawn[k] * dea_zone_resistance(plant->device, k, plant->device->prestretch[0], NULL)
                               : 0.0);
        DEA_TRY(find_rest(task, x, position, error));
        for (int k = 0; k < DEA_ZONES; k++) {
            if (!plant->zones[k].present || plant->zones[k].kind != DEA_PORT_NETWORK)
                continue;
            double leak = dea_zone_leakage(plant->device, k, task->films[k].lam, films[k], NULL, NULL);
            change = fmax(change, fabs(leak - drawn[k]) / fmax(fabs(leak), 1e-18));
            drawn[k] = leak;
        }
        if (change < 1e-12)
            return DEA_OK;
    }
    return dea_fail(error, DEA_ERR_SOLVER,
                    "the operating point of circuit and leaking films was not found in %d rounds", MAX_REST_ROUNDS);
}

enum dea_status dea_plant_start(struct dea_plant *plant, double t, const struct dea_plant_inputs *inputs,
                                enum dea_start start, const double *x, const double *v, struct dea_error *error) {
    plant->inputs = *inputs;
    plant->trouble = NULL;
    plant_forget(plant);
    plant_release_limits(plant);
    plant_release_stops(plant);
    plant->t = plant->t_previous = t;
    plant->spread = (struct error_spread){.xx = 0.0};
    struct rest_task task = {.plant = plant, .relaxed = start == DEA_START_EQUILIBRIUM, .t = t};
    double position;
    N_VConst(0.0, plant->quad);
    N_VConst(0.0, plant->yp);
    plant->rates_now = NV_DATA_S(plant->yp);
    if (plant->network != ABSENT)
        DEA_TRY(rest_with_network(&task, x, &position, error));
    else
        DEA_TRY(find_rest(&task, x, &position, error));
    store_rest(plant, &task, position, v != NULL ? *v : 0.0);
    if (plant->network == ABSENT) {
        DEA_TRY(make_consistent(plant, error));
        plant_choose_limits(plant);
    } else if (plant_evaluate(plant, t, NV_DATA_S(plant->y), 0.0, true) != DEA_OK) {
        return dea_fail(error, DEA_ERR_SOLVER, "the start is outside the model");
    }
    return plant_open_books(plant, error);
}

/* ---- restarts ---- */

/* Adds `sign` times what the books miss of the boundary terms at a jump: they hold [Q V / 2] of every port, while an
 * ideal source does [Q V] - int Q dV and any other port, its charge frozen, nothing. */
static enum dea_status book_boundary(struct dea_plant *plant, double sign) {
    DEA_TRY(balance_platform(plant, plant->t));
    DEA_TRY(plant_evaluate(plant, plant->t, NV_DATA_S(plant->y), 0.0, false));
    for (int k = 0; k < DEA_ZONES; k++) {
        enum dea_port_kind kind = plant->zones[k].kind;
        double part = kind == DEA_PORT_IDEAL ? 0.5 : -0.5;
        if (plant->zones[k].present && kind != DEA_PORT_PASSIVE)
            plant->jump_work[0] += sign * part * plant->points[k].film.charge * plant->points[k].film.voltage;
    }
    return DEA_OK;
}

/* Work of the imposed voltages and load along a jump: the limit of a fast ramp, along which every differential unknown
 * is frozen and an algebraic platform follows. W = [Q V] - int Q dV; the integral by Gauss-Legendre on panels. */
static enum dea_status book_jump(struct dea_plant *plant, const struct dea_plant_inputs *next) {
    enum { PANELS = 16 };
    static const double nodes[3] = {-0.7745966692414834, 0.0, 0.7745966692414834};
    static const double weights[3] = {5.0 / 9.0, 8.0 / 9.0, 5.0 / 9.0};
    const struct dea_plant_inputs before = plant->inputs;
    double jump[DEA_ZONES], load_jump, size = 0.0;
    for (int k = 0; k < DEA_ZONES; k++) {
        jump[k] = plant->zones[k].kind == DEA_PORT_IDEAL ? dea_piece_value(&next->source[k], plant->t, NULL) -
                                                               dea_piece_value(&before.source[k], plant->t, NULL)
                                                         : 0.0;
        size += fabs(jump[k]);
    }
    load_jump = dea_piece_value(&next->load, plant->t, NULL) - dea_piece_value(&before.load, plant->t, NULL);
    if (size == 0.0 && load_jump == 0.0)
        return DEA_OK;
    double *y = NV_DATA_S(plant->y);
    DEA_TRY(book_boundary(plant, -1.0));
    for (int p = 0; p < PANELS; p++) {
        for (int g = 0; g < 3; g++) {
            double s = (p + 0.5 + 0.5 * nodes[g]) / PANELS, weight = 0.5 * weights[g] / PANELS;
            for (int k = 0; k < DEA_ZONES; k++)
                if (jump[k] != 0.0)
                    plant->inputs.source[k] =
                        (struct dea_piece){.kind = DEA_PIECE_LINE,
                                           .start = plant->t,
                                           .end = INFINITY,
                                           .value = dea_piece_value(&before.source[k], plant->t, NULL) + s * jump[k]};
            plant->inputs.load =
                (struct dea_piece){.kind = DEA_PIECE_LINE,
                                   .start = plant->t,
                                   .end = INFINITY,
                                   .value = dea_piece_value(&before.load, plant->t, NULL) + s * load_jump};
            DEA_TRY(balance_platform(plant, plant->t));
            DEA_TRY(plant_evaluate(plant, plant->t, y, 0.0, false));
            for (int k = 0; k < DEA_ZONES; k++)
                if (jump[k] != 0.0)
                    plant->jump_work[0] -= weight * plant->points[k].film.charge * jump[k];
            plant->jump_work[1] -= weight * y[plant->x] * plant->scale[plant->x] * load_jump;
        }
    }
    plant->inputs = *next;
    return book_boundary(plant, 1.0);
}

enum dea_status dea_plant_restart(struct dea_plant *plant, const struct dea_plant_inputs *inputs,
                                  struct dea_error *error) {
    plant->trouble = NULL;
    plant_forget(plant);
    plant_release_limits(plant);
    plant_release_stops(plant);
    if (book_jump(plant, inputs) != DEA_OK)
        return dea_fail(error, DEA_ERR_SOLVER, "t = %.9g s: the jump of the drive leaves the model: %s", plant->t,
                        plant->trouble != NULL ? plant->trouble : "no equilibrium on the way");
    plant->inputs = *inputs;
    plant->stats.restarts++;
    plant->bent = false;
    DEA_TRY(plant_free_order(plant, error));
    DEA_TRY(make_consistent(plant, error));
    plant_choose_limits(plant);
    return DEA_OK;
}

enum dea_status plant_turn_over(struct dea_plant *plant, struct dea_error *error) {
    if (plant_turn_limits(plant) != DEA_OK)
        return dea_fail(error, DEA_ERR_SOLVER, "t = %.9g s: the state is outside the model: %s", plant->t,
                        plant->trouble != NULL ? plant->trouble : "unknown reason");
    plant->stats.restarts++;
    plant->bent = false;
    plant_hold_stops(plant);
    return make_consistent(plant, error);
}
