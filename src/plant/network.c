/* A linear circuit solved together with the device: its unknowns join the plant's, its equations the residual. Film
 * charges are the link: without electrode resistance the port voltage equals the film voltage (a constraint) and the
 * circuit sees dQ/dt; with it the current flows through R_e. */
#include "plant/network.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sundials/sundials_dense.h>

#define MAX_SETTLE_ITERATIONS 20
#define HOLD_CONDUCTANCE 1e10  /* S; of a node that .ic holds */
#define OPEN_CONDUCTANCE 1e-15 /* S; holds nodes that only capacitors touch while the operating point is solved */

/* An inductor's current is judged by no less than this part of what it would carry if it rang with a film at full
 * voltage: what a smaller error of it does to the voltages is far below their own tolerance. Judged by itself where it
 * is small, the circuit is made to ring by the very errors allowed to its voltages, and all steps follow that. */
#define RINGING_PART 0.1

/* ---- layout ---- */

enum dea_status plant_network_lay_out(struct dea_plant *plant, int *count, struct dea_error *error) {
    const struct dea_network *network = plant->options.network;
    plant->network = ABSENT;
    if (network == NULL)
        return DEA_OK;
    plant->network = *count;
    plant->network_count = network->node_count + network->branch_count;
    *count += plant->network_count;
    plant->row_scale = calloc((size_t)plant->network_count, sizeof *plant->row_scale);
    return plant->row_scale != NULL ? DEA_OK
                                    : dea_fail(error, DEA_ERR_MEMORY, "out of memory for the circuit's unknowns");
}

void plant_network_scale(struct dea_plant *plant) {
    const struct dea_network *network = plant->options.network;
    if (network == NULL)
        return;
    const struct dea_device *device = plant->device;
    double capacitance = fmax(device->zones[0].rest_capacitance, device->zones[1].rest_capacitance);
    double rate = device->effective_mass > 0.0 ? sqrt(device->stiffness / device->effective_mass)
                  : device->damping > 0.0      ? device->stiffness / device->damping
                                               : 1e3;
    double volts = fmax(network->peak, 1e-3), amperes = volts * capacitance * rate;
    for (int i = 0; i < plant->network_count; i++) {
        plant->scale[plant->network + i] = i < network->node_count ? volts : amperes;
        plant->row_scale[i] = i < network->node_count ? amperes : volts;
    }
    for (size_t s = 0; s < network->capacitance_count; s++) {
        const struct dea_stamp *stamp = &network->capacitances[s];
        int unknown = plant->network + stamp->row;
        if (stamp->row == stamp->column && stamp->row >= network->node_count) {
            double swing = volts * sqrt(capacitance / fabs(stamp->value)); /* A */
            plant->largest[unknown] = fmax(plant->largest[unknown], RINGING_PART * swing / amperes);
        }
    }
    /* a row is as large as its largest term */
    for (size_t s = 0; s < network->conductance_count; s++) {
        const struct dea_stamp *stamp = &network->conductances[s];
        double term = fabs(stamp->value) * plant->scale[plant->network + stamp->column];
        plant->row_scale[stamp->row] = fmax(plant->row_scale[stamp->row], term);
    }
}

/* ---- residual ---- */

static double unknown(const struct dea_plant *plant, const double *y, int i) {
    return i < 0 ? 0.0 : y[plant->network + i] * plant->scale[plant->network + i];
}

double plant_network_port_voltage(const struct dea_plant *plant, int zone, const double *y) {
    const struct dea_network_port *port = &plant->options.network->ports[zone];
    return unknown(plant, y, port->p) - unknown(plant, y, port->n);
}

/* Current a port draws: through R_e, or what charges and leaks through the film. */
static double port_current(const struct dea_plant *plant, int k) {
    const struct zone_point *point = &plant->points[k];
    return plant->zones[k].resistive ? point->current : point->e_rate + point->leak;
}

static void add_to_row(const struct dea_plant *plant, double *r, int row, double value) {
    if (row >= 0)
        r[plant->network + row] += value / plant->row_scale[row];
}

void plant_network_residual(const struct dea_plant *plant, double t, const double *y, const double *yp, double *r) {
    const struct dea_network *network = plant->options.network;
    int first = plant->network;
    for (int i = 0; i < plant->network_count; i++)
        r[first + i] = 0.0;
    for (size_t s = 0; s < network->conductance_count; s++) {
        const struct dea_stamp *stamp = &network->conductances[s];
        int column = first + stamp->column;
        add_to_row(plant, r, stamp->row, stamp->value * y[column] * plant->scale[column]);
    }
    for (size_t s = 0; s < network->capacitance_count; s++) {
        const struct dea_stamp *stamp = &network->capacitances[s];
        int column = first + stamp->column;
        add_to_row(plant, r, stamp->row, stamp->value * yp[column] * plant->scale[column]);
    }
    for (size_t s = 0; s < network->source_count; s++) {
        double value = dea_piece_value(&plant->inputs.network[s], t, NULL);
        add_to_row(plant, r, network->sources[s].row, -value);
        add_to_row(plant, r, network->sources[s].other_row, value);
    }
    for (int k = 0; k < DEA_ZONES; k++) {
        const struct zone_layout *zone = &plant->zones[k];
        if (!zone->present || zone->kind != DEA_PORT_NETWORK)
            continue;
        double current = port_current(plant, k);
        add_to_row(plant, r, network->ports[k].p, current);
        add_to_row(plant, r, network->ports[k].n, -current);
        if (!zone->resistive)
            r[zone->charge] = (plant->points[k].emf - plant->points[k].film.voltage) / fmax(network->peak, 1e-3);
    }
}

/* ---- Jacobian ---- */

static void put(const struct dea_plant *plant, double *data, int row, int column, double value) {
    if (row != ABSENT && column != ABSENT)
        data[plant->slots[row * plant->state_count + column]] += value;
}

/* Entries of a function of film voltage and stretch in one row: by charge, position and, when slack, the branches. */
static void put_film_function(const struct dea_plant *plant, double *data, int k, int row, double by_v, double by_lam) {
    const struct zone_layout *zone = &plant->zones[k];
    const struct dea_film *film = &plant->points[k].film;
    double total = by_v * film->dvoltage_dlam + by_lam;
    put(plant, data, row, zone->charge,
        (by_v * film->dvoltage_de + total * film->dlam_de) * plant->scale[zone->charge]);
    if (!film->slack) {
        put(plant, data, row, plant->x, total * film->dlam_dx * plant->scale[plant->x]);
        return;
    }
    for (int b = 0; zone->branch != ABSENT && b < plant->device->material.branch_count; b++)
        for (int i = 0; i < 2; i++) {
            int column = zone->branch + 2 * b + i;
            put(plant, data, row, column,
                total * film->dlam_dp1 * plant->points[k].branches[b].dp1_dz[i] * plant->scale[column]);
        }
}

static void put_port(const struct dea_plant *plant, double *data, int k, double cj) {
    const struct dea_network *network = plant->options.network;
    const struct zone_layout *zone = &plant->zones[k];
    const struct zone_point *point = &plant->points[k];
    const int pins[2] = {network->ports[k].p, network->ports[k].n};
    bool resistive = zone->resistive;
    double charge_row = resistive ? plant->scale[zone->charge] : fmax(network->peak, 1e-3);
    for (int side = 0; side < 2; side++) {
        double sign = side == 0 ? 1.0 : -1.0;
        if (pins[side] < 0)
            continue;
        int row = plant->network + pins[side];
        double weight = sign / plant->row_scale[pins[side]];
        if (resistive) {
            put_film_function(plant, data, k, row, weight * point->current_v, weight * point->current_lam);
            for (int other = 0; other < 2; other++)
                if (pins[other] >= 0)
                    put(plant, data, row, plant->network + pins[other],
                        weight * (other == 0 ? 1.0 : -1.0) * point->current_emf *
                            plant->scale[plant->network + pins[other]]);
        } else {
            put(plant, data, row, zone->charge, weight * cj * plant->scale[zone->charge]);
            put_film_function(plant, data, k, row, weight * point->leak_v, weight * point->leak_lam);
        }
        /* the charge's own row sees the port voltage */
        double by_emf = resistive ? -point->current_emf : 1.0;
        put(plant, data, zone->charge, row, sign * by_emf / charge_row * plant->scale[row]);
    }
    if (!resistive)
        put_film_function(plant, data, k, zone->charge, -1.0 / charge_row, 0.0);
}

void plant_network_jacobian(const struct dea_plant *plant, double cj, double *data) {
    const struct dea_network *network = plant->options.network;
    for (size_t s = 0; s < network->conductance_count + network->capacitance_count; s++) {
        bool resistive = s < network->conductance_count;
        const struct dea_stamp *stamp =
            resistive ? &network->conductances[s] : &network->capacitances[s - network->conductance_count];
        int column = plant->network + stamp->column;
        put(plant, data, plant->network + stamp->row, column,
            (resistive ? 1.0 : cj) * stamp->value * plant->scale[column] / plant->row_scale[stamp->row]);
    }
    for (int k = 0; k < DEA_ZONES; k++)
        if (plant->zones[k].present && plant->zones[k].kind == DEA_PORT_NETWORK)
            put_port(plant, data, k, cj);
}

void plant_network_mark(const struct dea_plant *plant, char *pattern, bool slack) {
    const struct dea_network *network = plant->options.network;
    int n = plant->state_count;
    for (size_t s = 0; s < network->conductance_count; s++)
        pattern[(plant->network + network->conductances[s].row) * n + plant->network +
                network->conductances[s].column] = 1;
    for (size_t s = 0; s < network->capacitance_count; s++)
        pattern[(plant->network + network->capacitances[s].row) * n + plant->network +
                network->capacitances[s].column] = 1;
    for (int k = 0; k < DEA_ZONES; k++) {
        const struct zone_layout *zone = &plant->zones[k];
        if (!zone->present || zone->kind != DEA_PORT_NETWORK)
            continue;
        const int pins[2] = {network->ports[k].p, network->ports[k].n};
        int branches = slack && zone->branch != ABSENT ? 2 * plant->device->material.branch_count : 0;
        for (int side = 0; side < 2; side++) {
            if (pins[side] < 0)
                continue;
            int row = plant->network + pins[side];
            pattern[row * n + zone->charge] = pattern[row * n + plant->x] = pattern[zone->charge * n + row] = 1;
            for (int other = 0; other < 2; other++)
                if (pins[other] >= 0)
                    pattern[row * n + plant->network + pins[other]] = 1;
            for (int i = 0; i < branches; i++)
                pattern[row * n + zone->branch + i] = 1;
        }
    }
}

/* ---- operating point ---- */

/* Puts a stiff source in the place of what hangs on a node, currents of branches excepted: as ngspice does. */
static void hold_node(const struct dea_network *network, const struct dea_network_initial *initial, sunrealtype **a,
                      double *w) {
    for (int column = 0; column < network->node_count; column++)
        a[column][initial->node] = 0.0;
    a[initial->node][initial->node] = HOLD_CONDUCTANCE;
    w[initial->node] = HOLD_CONDUCTANCE * initial->voltage;
}

/* Node voltages and branch currents at rest: capacitors open, inductors short, films drawing the given currents. */
static bool solve_at_rest(struct dea_plant *plant, double t, const double drawn[DEA_ZONES], double *w) {
    const struct dea_network *network = plant->options.network;
    int n = plant->network_count;
    sunrealtype **a = SUNDlsMat_newDenseMat(n, n);
    sunindextype *pivots = SUNDlsMat_newIndexArray(n);
    bool good = a != NULL && pivots != NULL;
    if (good) {
        for (int column = 0; column < n; column++)
            for (int row = 0; row < n; row++)
                a[column][row] = row == column && row < network->node_count ? OPEN_CONDUCTANCE : 0.0;
        for (size_t s = 0; s < network->conductance_count; s++)
            a[network->conductances[s].column][network->conductances[s].row] += network->conductances[s].value;
        memset(w, 0, (size_t)n * sizeof *w);
        for (size_t s = 0; s < network->source_count; s++) {
            double value = dea_piece_value(&plant->inputs.network[s], t, NULL);
            if (network->sources[s].row >= 0)
                w[network->sources[s].row] += value;
            if (network->sources[s].other_row >= 0)
                w[network->sources[s].other_row] -= value;
        }
        for (int k = 0; k < DEA_ZONES; k++) {
            if (network->ports[k].p >= 0)
                w[network->ports[k].p] -= drawn[k];
            if (network->ports[k].n >= 0)
                w[network->ports[k].n] += drawn[k];
        }
        for (size_t s = 0; s < network->initial_count; s++)
            hold_node(network, &network->initials[s], a, w);
        good = SUNDlsMat_denseGETRF(a, n, n, pivots) == 0;
        if (good)
            SUNDlsMat_denseGETRS(a, n, pivots, w);
    }
    if (a != NULL)
        SUNDlsMat_destroyMat(a);
    if (pivots != NULL)
        SUNDlsMat_destroyArray(pivots);
    for (int i = 0; good && i < n; i++)
        good = isfinite(w[i]);
    return good;
}

enum dea_status plant_network_rest(struct dea_plant *plant, double t, const double drawn[DEA_ZONES],
                                   double voltages[DEA_ZONES], struct dea_error *error) {
    double *y = NV_DATA_S(plant->y);
    double *w = calloc((size_t)plant->network_count, sizeof *w);
    if (w == NULL)
        return dea_fail(error, DEA_ERR_MEMORY, "out of memory for the circuit's operating point");
    bool good = solve_at_rest(plant, t, drawn, w);
    for (int i = 0; good && i < plant->network_count; i++)
        y[plant->network + i] = w[i] / plant->scale[plant->network + i];
    free(w);
    if (!good)
        return dea_fail(error, DEA_ERR_SOLVER, "the linear circuit has no operating point (singular matrix)");
    for (int k = 0; k < DEA_ZONES; k++)
        voltages[k] = plant->zones[k].present && plant->zones[k].kind == DEA_PORT_NETWORK
                          ? plant_network_port_voltage(plant, k, y)
                          : 0.0;
    return DEA_OK;
}

/* ---- restarts ---- */

/* One step of implicit Euler over h from the present state; *moved receives the largest change of an unknown. */
static enum dea_status step_implicitly(struct dea_plant *plant, double h) {
    int n = plant->state_count;
    double *y = NV_DATA_S(plant->y), *yp = NV_DATA_S(plant->yp);
    double *before = NV_DATA_S(plant->sample_y), *residual = NV_DATA_S(plant->rates);
    double *delta = NV_DATA_S(plant->sample_yp);
    memcpy(before, y, (size_t)n * sizeof *y);
    double last = INFINITY;
    for (int iteration = 0; iteration < MAX_SETTLE_ITERATIONS; iteration++) {
        for (int i = 0; i < n; i++)
            yp[i] = (y[i] - before[i]) / h;
        if (plant_residual(plant->t + h, plant->y, plant->yp, plant->rates, plant) != 0 ||
            plant_jacobian(plant->t + h, 1.0 / h, plant->y, plant->yp, plant->rates, plant->matrix, plant, NULL, NULL,
                           NULL) != 0 ||
            SUNLinSolSetup(plant->solver, plant->matrix) != 0)
            return DEA_RECOVERABLE;
        for (int i = 0; i < n; i++)
            residual[i] = -residual[i];
        if (SUNLinSolSolve(plant->solver, plant->matrix, plant->sample_yp, plant->rates, 0.0) != 0)
            return DEA_RECOVERABLE;
        double worst = 0.0;
        for (int i = 0; i < n; i++) {
            y[i] += delta[i];
            bool follows = i >= plant->network && plant->options.network->imposed[i - plant->network];
            if (!follows) /* a source's current into a film is the difference of two charges over so short a time */
                worst = fmax(worst, fabs(delta[i]) / fmax(fabs(y[i]), 1.0));
        }
        /* until nothing moves any more, or only rounding does */
        bool rounding = worst <= 1e-9 && worst >= 0.5 * last;
        last = worst;
        if (worst <= 1e-14 || rounding) {
            for (int i = 0; i < n; i++)
                yp[i] = (y[i] - before[i]) / h;
            plant->t += h;
            return DEA_OK;
        }
    }
    return DEA_RECOVERABLE;
}

enum dea_status plant_network_settle(struct dea_plant *plant, struct dea_error *error) {
    double h = plant->options.settle_time;
    double *quad = NV_DATA_S(plant->quad);
    for (int step = 0; step < 2; step++) { /* the first absorbs jumps, the second gives the rates */
        double losses[LOSS_COUNT];
        plant->rates_now = NV_DATA_S(plant->yp);
        if (SUNLinSolInitialize(plant->solver) != 0 || step_implicitly(plant, h) != DEA_OK)
            return dea_fail(error, DEA_ERR_SOLVER,
                            "t = %.9g s: the circuit's equations cannot be solved at a corner: %s", plant->t,
                            plant->trouble != NULL ? plant->trouble : "Newton's method did not converge");
        double velocity = plant_pace(plant, NV_DATA_S(plant->y), NV_DATA_S(plant->yp));
        if (plant_quadrature_rates(plant, plant->t, NV_DATA_S(plant->y), velocity, losses) != DEA_OK)
            return dea_fail(error, DEA_ERR_SOLVER, "t = %.9g s: the state left the model", plant->t);
        for (int i = 0; i < LOSS_COUNT; i++)
            quad[i] += h * losses[i];
    }
    return DEA_OK;
}

enum dea_status plant_network_try(struct dea_plant *plant, double h, double *bends) {
    size_t size = (size_t)plant->state_count * sizeof *bends;
    double *y = NV_DATA_S(plant->y), *yp = NV_DATA_S(plant->yp);
    double *kept = NV_DATA_S(plant->kept_yp), t = plant->t;
    memcpy(kept, yp, size);
    enum dea_status status = SUNLinSolInitialize(plant->solver) == 0 ? step_implicitly(plant, h) : DEA_RECOVERABLE;
    for (int i = 0; status == DEA_OK && i < plant->state_count; i++)
        bends[i] = (yp[i] - kept[i]) / h;
    memcpy(y, NV_DATA_S(plant->sample_y), size);
    memcpy(yp, kept, size);
    plant->t = t;
    return status;
}
