/* The start of a coupled run: the operating point of the circuit and the rest of the devices at its film voltages,
 * found together. */
#include "cosim/cosim_internal.h"

#include <math.h>
#include <string.h>

#define MAX_REST_ROUNDS 50
/* The operating point the devices rest at is found this much more closely than Newton's iterations are ended in the
 * run: antagonists rest where two large forces balance. The run's own may miss it by some of its tolerances. */
#define REST_PRECISION 1e-3
#define LEAST_RELTOL 1e-10
#define REST_MISS 20.0
#define SAME_REST 1e-10 /* relative, between two rounds */

/* A device at its film voltages, held at x (m) or, with NULL, where the forces balance. */
static enum dea_status rest_device(struct cosim *run, int i, const double *x, struct dea_error *error) {
    const struct dea_scene *scene = run->scene;
    return coupled_rest(&run->devices[i], &run->rest_voltages[i * DEA_ZONES], scene->start, x,
                        scene->has_initial_v ? &scene->initial_v : NULL, error);
}

enum dea_status cosim_rest_devices(struct cosim *run, struct dea_error *error) {
    for (int i = 0; i < run->count; i++)
        DEA_TRY(rest_device(run, i, run->scene->has_initial_x ? &run->scene->initial_x : NULL, error));
    return DEA_OK;
}

/* Takes the circuit's film voltages over; returns how far they are from those before. */
static double keep_voltages(struct cosim *run, const struct dea_circuit_point *point) {
    double change = 0.0;
    for (int i = 0; i < run->count; i++) {
        for (int p = 0; p < run->devices[i].port_count; p++) {
            double *kept = &run->rest_voltages[i * DEA_ZONES + p], found = point->ports[i * DEA_ZONES + p].film_voltage;
            change = fmax(change, fabs(found - *kept) / fmax(fabs(found), 1.0));
            *kept = found;
        }
    }
    return change;
}

enum dea_status cosim_judge_rest(struct cosim *run, const struct dea_circuit_point *point, struct dea_error *error) {
    run->rest_change = keep_voltages(run, point);
    run->resting = run->rest_change > run->rest_agreed;
    if (run->resting || run->rest_change <= SAME_REST)
        return DEA_OK;
    for (int i = 0; i < run->count; i++) { /* at the run's own voltages, where it rests: books start from one state */
        double x = run->devices[i].outlook.x[0];
        DEA_TRY(rest_device(run, i, &x, error));
    }
    return DEA_OK;
}

double cosim_initial_voltage(const struct dea_netlist *netlist, const char *node) {
    for (int i = 0; i < netlist->initial_count; i++)
        if (strcmp(netlist->initials[i].node, node) == 0)
            return netlist->initials[i].value;
    return 0.0;
}

/* With uic the films start at what .ic gives their electrodes, at rest, whatever the circuit does next. */
static enum dea_status start_from_initials(struct cosim *run, struct dea_error *error) {
    for (int i = 0; i < run->count; i++) {
        char *const *nodes = run->netlist->instances[i].nodes;
        for (int p = 0; p < run->devices[i].port_count; p++)
            run->rest_voltages[i * DEA_ZONES + p] = cosim_initial_voltage(run->netlist, nodes[2 * p]) -
                                                    cosim_initial_voltage(run->netlist, nodes[2 * p + 1]);
    }
    DEA_TRY(cosim_rest_devices(run, error));
    DEA_TRY(cosim_begin_observing(run, error));
    for (int i = 0; i < run->count; i++) {
        struct dea_port_sample ports[DEA_ZONES];
        for (int p = 0; p < run->devices[i].port_count; p++) {
            double v = run->rest_voltages[i * DEA_ZONES + p];
            ports[p] = (struct dea_port_sample){v, v, coupled_charge(&run->devices[i], p), 0.0};
            dea_engine_start_charge(run->engine, i, p, ports[p].charge);
        }
        DEA_TRY(coupled_take(&run->devices[i], i, 0.0, 0.0, ports, run->observer, error));
    }
    return DEA_OK;
}

/* Loads the circuit and runs it: to its first point while the devices' rest is looked for, to the end otherwise. */
static enum dea_status run_round(struct cosim *run, const struct dea_deck *deck, const struct dea_deck_options *options,
                                 double agreed, struct dea_error *error) {
    DEA_TRY(cosim_rest_devices(run, error));
    run->resting = !options->uic;
    run->rest_agreed = agreed;
    run->reached = run->exchanged_at = 0.0;
    run->horizon = fmin(run->stop * 1e-4, fmax(1e-3 * run->slowest, 1e-7 * run->stop));
    if (run->control->horizon > 0.0)
        run->horizon = run->control->horizon;
    DEA_TRY(dea_engine_load(run->engine, run->netlist, deck, run->circuit_devices, options, &run->callbacks, error));
    if (options->uic)
        DEA_TRY(start_from_initials(run, error));
    return dea_engine_run(run->engine, error);
}

/* The film voltages of the operating point, more closely than the run itself will find them; *found is false when
 * ngspice does not converge that far. Without leakage they do not depend on how the devices rest. */
static enum dea_status find_rest(struct cosim *run, bool *found, struct dea_error *error) {
    bool depends = false;
    for (int i = 0; i < run->count; i++)
        depends = depends || run->devices[i].device->material.dielectric.conductivity > 0.0;
    *found = false;
    run->rest_options = run->deck_options;
    run->rest_options.reltol = fmax(REST_PRECISION * run->deck_options.reltol, LEAST_RELTOL);
    DEA_TRY(dea_deck_build(run->netlist, run->circuit_devices, &run->rest_options, &run->rest_deck, error));
    for (int round = 0; round < MAX_REST_ROUNDS && !*found; round++) {
        enum dea_status status = run_round(run, &run->rest_deck, &run->rest_options, -1.0, error);
        if (status == DEA_ERR_SOLVER)
            return DEA_OK;
        if (status != DEA_STOPPED || !run->resting)
            return status;
        *found = !depends || run->rest_change <= SAME_REST;
    }
    return DEA_OK;
}

/* Operating point and static equilibrium together: the circuit's film voltages and the devices' rest at them are
 * iterated until they agree; the round that agrees runs on. */
enum dea_status cosim_run_from_rest(struct cosim *run, struct dea_error *error) {
    bool closer = run->deck_options.reltol > LEAST_RELTOL;
    for (int i = 0; i < run->count; i++) { /* free of both, the platform follows the run's own voltages at once */
        const struct dea_device *device = run->devices[i].device;
        closer = closer && (device->effective_mass > 0.0 || device->damping > 0.0);
    }
    double agreed = SAME_REST;
    for (int round = 0; round < MAX_REST_ROUNDS; round++) {
        enum dea_status status = run_round(run, &run->deck, &run->deck_options, agreed, error);
        if (!run->resting || status != DEA_STOPPED)
            return status;
        agreed = SAME_REST;
        if (closer) {
            bool found;
            DEA_TRY(find_rest(run, &found, error));
            if (found)
                agreed = REST_MISS * run->deck_options.reltol;
            closer = false;
        }
    }
    return dea_fail(error, DEA_ERR_SOLVER,
                    "the operating point of circuit and devices was not found in %d rounds: the film voltages still "
                    "change by %.3g",
                    MAX_REST_ROUNDS, run->rest_change);
}
