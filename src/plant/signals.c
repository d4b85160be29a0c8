/* What people read of a state: signals, stored energy and the balance since the start. */
#include "plant/integrator.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum zone_signal {
    ZONE_STRETCH,
    ZONE_TENSION,
    ZONE_STRESS2,
    ZONE_VOLTAGE,
    ZONE_PORT_VOLTAGE,
    ZONE_CHARGE,
    ZONE_CURRENT,
    ZONE_CAPACITANCE,
    ZONE_FIELD,
    ZONE_SIGNALS
};
enum { PASSIVE_SIGNALS = ZONE_VOLTAGE, ENERGY_SIGNALS = 4, PLATFORM_SIGNALS = 2 };

static const struct {
    const char *name, *unit;
} zone_signals[ZONE_SIGNALS] = {
    [ZONE_STRETCH] = {"stretch", "1"},           [ZONE_TENSION] = {"tension", "N"},
    [ZONE_STRESS2] = {"stress2", "Pa"},          [ZONE_VOLTAGE] = {"voltage", "V"},
    [ZONE_PORT_VOLTAGE] = {"port_voltage", "V"}, [ZONE_CHARGE] = {"charge", "C"},
    [ZONE_CURRENT] = {"current", "A"},           [ZONE_CAPACITANCE] = {"capacitance", "F"},
    [ZONE_FIELD] = {"true_field", "V/m"},
};
static const char *const energy_names[ENERGY_SIGNALS] = {"energy.in", "energy.stored", "energy.dissipated",
                                                         "energy.imbalance"};

static int count_zone_signals(const struct dea_plant *plant, int k) {
    if (!plant->zones[k].present)
        return 0;
    return plant->zones[k].kind == DEA_PORT_PASSIVE ? PASSIVE_SIGNALS : ZONE_SIGNALS;
}

int dea_plant_signal_count(const struct dea_plant *plant) {
    return PLATFORM_SIGNALS + count_zone_signals(plant, 0) + count_zone_signals(plant, 1) + ENERGY_SIGNALS;
}

void dea_plant_signal(const struct dea_plant *plant, int index, struct dea_signal *signal) {
    if (index < PLATFORM_SIGNALS) {
        snprintf(signal->name, sizeof signal->name, "%s", index == 0 ? "x" : "v");
        snprintf(signal->unit, sizeof signal->unit, "%s", index == 0 ? "m" : "m/s");
        return;
    }
    index -= PLATFORM_SIGNALS;
    for (int k = 0; k < DEA_ZONES; k++) {
        int count = count_zone_signals(plant, k);
        if (index < count) {
            snprintf(signal->name, sizeof signal->name, "%s.%s", dea_zone_names[k], zone_signals[index].name);
            snprintf(signal->unit, sizeof signal->unit, "%s", zone_signals[index].unit);
            return;
        }
        index -= count;
    }
    snprintf(signal->name, sizeof signal->name, "%s", energy_names[index]);
    snprintf(signal->unit, sizeof signal->unit, "J");
}

enum dea_signal_group dea_plant_signal_group(const struct dea_plant *plant, int index) {
    return index < PLATFORM_SIGNALS                                      ? DEA_SIGNALS_PLATFORM
           : index < dea_plant_signal_count(plant) - (int)ENERGY_SIGNALS ? DEA_SIGNALS_ZONES
                                                                         : DEA_SIGNALS_ENERGY;
}

/* Unknowns and, if wanted, their rates at a time within the last step: IDA's interpolant, or the state itself right
 * after a restart. The moment over which a circuit's corner was settled has neither: back along the rates. */
static enum dea_status find_state(struct dea_plant *plant, double t, bool with_rates, const double **y,
                                  const double **yp, struct dea_error *error) {
    double at = fmax(t, plant->restarted_at);
    bool gap = t < at, held = !plant->integrating || at == plant->t;
    *y = held && !gap ? NV_DATA_S(plant->y) : NV_DATA_S(plant->sample_y);
    *yp = held ? NV_DATA_S(plant->yp) : NV_DATA_S(plant->sample_yp);
    if (!held && (IDAGetDky(plant->ida, at, 0, plant->sample_y) != IDA_SUCCESS ||
                  ((with_rates || gap) && IDAGetDky(plant->ida, at, 1, plant->sample_yp) != IDA_SUCCESS)))
        return dea_fail(error, DEA_ERR_INTERNAL, "t = %.17g s is outside the last step %.17g .. %.17g s", t,
                        plant->t_previous, plant->t);
    if (gap)
        N_VLinearSum(1.0, held ? plant->y : plant->sample_y, t - at, held ? plant->yp : plant->sample_yp,
                     plant->sample_y);
    return DEA_OK;
}

static enum dea_status interpolate(struct dea_plant *plant, double t, unsigned wanted, const double **y,
                                   const double **yp, const double **quad, struct dea_error *error) {
    double at = fmax(t, plant->restarted_at);
    DEA_TRY(find_state(plant, t, plant->motion == MOTION_VISCOUS || plant->network != ABSENT, y, yp, error));
    *quad = NV_DATA_S(plant->quad);
    if (!plant->integrating || at == plant->t || !(wanted & DEA_SIGNALS_ENERGY))
        return DEA_OK;
    *quad = NV_DATA_S(plant->sample_quad);
    if (IDAGetQuadDky(plant->ida, at, 0, plant->sample_quad) != IDA_SUCCESS)
        return dea_fail(error, DEA_ERR_INTERNAL, "t = %.17g s: no integrals of the losses", t);
    return DEA_OK;
}

static enum dea_status fill_zone(struct dea_plant *plant, int k, double *values) {
    const struct dea_device *device = plant->device;
    const struct zone_point *point = &plant->points[k];
    const struct dea_film *film = &point->film;
    values[ZONE_STRETCH] = film->lam;
    values[ZONE_TENSION] = film->pull;
    DEA_TRY(dea_film_stress2(device, k, film->lam, film->voltage, point->branches, &values[ZONE_STRESS2]));
    if (plant->zones[k].kind == DEA_PORT_PASSIVE)
        return DEA_OK;
    values[ZONE_VOLTAGE] = film->voltage;
    values[ZONE_CHARGE] = film->charge;
    values[ZONE_CAPACITANCE] = film->capacitance;
    values[ZONE_FIELD] = dea_zone_field(device, film->voltage, film->lam);
    const struct zone_layout *zone = &plant->zones[k];
    bool through = zone->kind == DEA_PORT_SOURCE || (zone->kind == DEA_PORT_NETWORK && zone->resistive);
    values[ZONE_CURRENT] = through ? point->current : point->leak + point->charge_rate;
    values[ZONE_PORT_VOLTAGE] = film->voltage;
    if (through)
        values[ZONE_PORT_VOLTAGE] += point->current * dea_zone_resistance(device, k, film->lam, NULL);
    return DEA_OK;
}

static enum dea_status fill_energy(struct dea_plant *plant, double t, const double *y, const double *quad, double *in,
                                   double *load, double *stored, double *dissipated) {
    double x = y[plant->x] * plant->scale[plant->x], imposed[2], start_x = plant->start_x;
    plant_imposed_energy(plant, t, x, imposed);
    double electrical = quad[LOSS_WORK] + imposed[0] - plant->imposed_at_start[0] + plant->jump_work[0];
    *load = quad[LOSS_LOAD] + imposed[1] - plant->imposed_at_start[1] + plant->jump_work[1] +
            plant->device->load * (x - start_x);
    *in = electrical + *load;
    DEA_TRY(plant_stored_energy(plant, y, stored));
    *stored -= plant->stored_at_start;
    *dissipated = 0.0;
    for (int i = LOSS_BRANCH; i < LOSS_COUNT; i++)
        *dissipated += quad[i];
    return DEA_OK;
}

/* Evaluates the state with the rates an ideal source's current needs: i = dQ/dt + leak with Q = C(lam) V. */
static enum dea_status evaluate_currents(struct dea_plant *plant, double t, const double *y, const double *yp,
                                         double *velocity) {
    bool ideal = false;
    for (int k = 0; k < DEA_ZONES; k++)
        ideal = ideal || (plant->zones[k].present && plant->zones[k].kind == DEA_PORT_IDEAL);
    *velocity = plant_velocity(plant, y, yp);
    plant->rates_now = plant->network != ABSENT ? yp : NULL;
    DEA_TRY(plant_evaluate(plant, t, y, *velocity, ideal || plant->motion == MOTION_ALGEBRAIC));
    if (plant->motion == MOTION_ALGEBRAIC) {
        double *rates = NV_DATA_S(plant->rates);
        plant_rates(plant, t, y, rates);
        *velocity = plant_algebraic_rate(plant, t, rates);
    }
    for (int k = 0; k < DEA_ZONES; k++) {
        struct zone_point *point = &plant->points[k];
        if (!plant->zones[k].present)
            continue;
        if (plant->zones[k].kind == DEA_PORT_CHARGE || plant->zones[k].kind == DEA_PORT_NETWORK)
            point->charge_rate = point->e_rate;
        if (plant->zones[k].kind != DEA_PORT_IDEAL)
            continue;
        const struct dea_film *film = &point->film;
        double lam_rate = plant_stretch_rate(plant, k, *velocity);
        point->charge_rate = film->dcharge_de * point->e_rate + film->dcharge_dlam * lam_rate;
    }
    return DEA_OK;
}

enum dea_status dea_plant_signals(struct dea_plant *plant, double t, unsigned wanted, double *values,
                                  struct dea_error *error) {
    const double *y = NULL, *yp = NULL, *quad = NULL;
    DEA_TRY(interpolate(plant, t, wanted, &y, &yp, &quad, error));
    double velocity, load;
    if (wanted == DEA_SIGNALS_PLATFORM && plant->v != ABSENT) { /* both are unknowns */
        values[0] = y[plant->x] * plant->scale[plant->x];
        values[1] = y[plant->v] * plant->scale[plant->v];
        return DEA_OK;
    }
    if (evaluate_currents(plant, t, y, yp, &velocity) != DEA_OK)
        return dea_fail(error, DEA_ERR_SOLVER, "t = %.9g s: %s", t,
                        plant->trouble != NULL ? plant->trouble : "outside the model");
    values[0] = y[plant->x] * plant->scale[plant->x];
    values[1] = velocity;
    values += PLATFORM_SIGNALS;
    for (int k = 0; k < DEA_ZONES; k++) {
        if (!plant->zones[k].present)
            continue;
        if (wanted & DEA_SIGNALS_ZONES && fill_zone(plant, k, values) != DEA_OK)
            return dea_fail(error, DEA_ERR_SOLVER, "t = %.9g s: the %s zone is outside the model", t,
                            dea_zone_names[k]);
        values += count_zone_signals(plant, k);
    }
    if (!(wanted & DEA_SIGNALS_ENERGY))
        return DEA_OK;
    if (fill_energy(plant, t, y, quad, &values[0], &load, &values[1], &values[2]) != DEA_OK)
        return dea_fail(error, DEA_ERR_SOLVER, "t = %.9g s: no stored energy outside the model", t);
    values[3] = values[0] - values[1] - values[2];
    return DEA_OK;
}

enum dea_status dea_plant_network(struct dea_plant *plant, double t, double *unknowns, double *x,
                                  struct dea_error *error) {
    const double *y, *yp;
    DEA_TRY(find_state(plant, t, false, &y, &yp, error));
    for (int i = 0; i < plant->network_count; i++)
        unknowns[i] = y[plant->network + i] * plant->scale[plant->network + i];
    *x = y[plant->x] * plant->scale[plant->x];
    return DEA_OK;
}

enum dea_status plant_stored_energy(struct dea_plant *plant, const double *y, double *energy) {
    const struct dea_device *device = plant->device;
    double part, x = y[plant->x] * plant->scale[plant->x];
    double v = plant->motion == MOTION_INERTIAL ? y[plant->v] * plant->scale[plant->v] : 0.0;
    *energy = 0.5 * device->effective_mass * v * v;
    dea_stop_force(device, x, v, NULL, NULL, &part, NULL);
    *energy += part;
    for (int k = 0; k < DEA_ZONES; k++) {
        if (!plant->zones[k].present)
            continue;
        const struct zone_point *point = &plant->points[k];
        DEA_TRY(dea_film_energy(device, k, point->film.lam, point->film.charge, point->states, &part));
        *energy += part;
    }
    return DEA_OK;
}

void plant_imposed_energy(const struct dea_plant *plant, double t, double x, double imposed[2]) {
    imposed[0] = 0.0;
    for (int k = 0; k < DEA_ZONES; k++) {
        const struct dea_film *film = &plant->points[k].film;
        if (plant->zones[k].present && plant->zones[k].kind != DEA_PORT_PASSIVE)
            imposed[0] += 0.5 * film->charge * film->voltage;
    }
    imposed[1] = dea_piece_value(&plant->inputs.load, t, NULL) * x;
}

enum dea_status plant_open_books(struct dea_plant *plant, struct dea_error *error) {
    const double *y = NV_DATA_S(plant->y);
    double x = y[plant->x] * plant->scale[plant->x];
    plant_imposed_energy(plant, plant->t, x, plant->imposed_at_start);
    plant->start_x = x;
    plant->jump_work[0] = plant->jump_work[1] = plant->moved = plant->work_seen[0] = plant->work_seen[1] = 0.0;
    if (plant_stored_energy(plant, y, &plant->stored_at_start) != DEA_OK)
        return dea_fail(error, DEA_ERR_SOLVER, "no stored energy at the start: the state is outside the model");
    return DEA_OK;
}

enum dea_status dea_plant_energy(struct dea_plant *plant, struct dea_energy *energy, struct dea_error *error) {
    const double *y = NULL, *yp = NULL, *quad = NULL;
    DEA_TRY(interpolate(plant, plant->t, DEA_SIGNALS_ALL, &y, &yp, &quad, error));
    if (plant_evaluate(plant, plant->t, y, plant_velocity(plant, y, yp), false) != DEA_OK ||
        fill_energy(plant, plant->t, y, quad, &energy->in, &energy->load, &energy->stored, &energy->dissipated) !=
            DEA_OK)
        return dea_fail(error, DEA_ERR_SOLVER, "t = %.9g s: no energy balance outside the model", plant->t);
    energy->electrical = energy->in - energy->load;
    energy->branch = quad[LOSS_BRANCH];
    energy->damping = quad[LOSS_DAMPING];
    energy->resistive = quad[LOSS_RESISTIVE];
    energy->leakage = quad[LOSS_LEAKAGE];
    energy->stop = quad[LOSS_STOP];
    /* total exchanged: what went in and out over the steps, or, when nothing is driven, what moved inside */
    energy->exchanged = fmax(fmax(plant->moved, plant->kinetic), fmax(fabs(energy->stored), energy->dissipated));
    double gap = fabs(energy->in - energy->stored - energy->dissipated);
    /* differences of stored energies are not known better than this; a run that moves less is at rest, and one whose
     * gap is rounding of what it stores has none */
    double whole = fabs(plant->stored_at_start), resolved = 1e-10 * whole;
    bool rounding = gap <= 1e-14 * whole && energy->exchanged <= 1e-12 * whole;
    energy->imbalance = rounding || gap <= 0.0 ? 0.0 : gap / fmax(energy->exchanged, resolved);
    return DEA_OK;
}
