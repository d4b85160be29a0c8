/* Co-simulation as it is usually set up, for comparison: circuit and device exchange at fixed times. Between two of
 * them ngspice keeps the film capacitances; then the device is moved over the same span, the charge taken as linear,
 * and gives new ones. No prediction, no error control; the circuit's tolerances are those of deasim at the
 * accuracy. usage: fixed_exchange SCENE ACCURACY INTERVAL STOP TABLE; the table has time, x and the port voltages, all
 * SI. */
#include "circuit/engine.h"
#include "cosim/cosim.h"
#include "cosim/coupled.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#define DEVICE_ACCURACY 1e-7

struct run {
    const struct dea_device *device;
    struct dea_plant *plant;
    struct dea_plant_inputs inputs;
    int zones[DEA_ZONES], port_count;
    double interval, held[DEA_ZONES], position, last_charge[DEA_ZONES];
    long exchanges;
    FILE *table;
    struct dea_error *error;
};

static double answer(void *context, int instance, int port, enum dea_external which, double t) {
    struct run *run = context;
    (void)instance, (void)t;
    switch (which) {
    case DEA_EXTERNAL_CAPACITANCE:
        return run->held[port];
    case DEA_EXTERNAL_POSITION:
        return run->position;
    default:
        return 0.0; /* no offset; the benchmark's devices have neither leakage nor sheet resistance */
    }
}

static double next_exchange(const struct run *run) {
    return (double)(run->exchanges + 1) * run->interval;
}

static void limit_step(void *context, double t, double *delta) {
    const struct run *run = context;
    *delta = fmin(*delta, fmax(next_exchange(run) - t, 1e-3 * run->interval));
}

static void write_row(const struct run *run, const struct dea_circuit_point *point) {
    fprintf(run->table, "%.17g %.17g", point->time, run->position);
    for (int p = 0; p < run->port_count; p++)
        fprintf(run->table, " %.17g", point->ports[p].port_voltage);
    fputc('\n', run->table);
}

static enum dea_status hold_capacitances(struct run *run, double horizon) {
    struct dea_outlook outlook;
    if (dea_plant_look_ahead(run->plant, horizon, &outlook) != DEA_OK)
        return dea_fail(run->error, DEA_ERR_SOLVER, "the device left the model");
    run->position = outlook.x[0];
    for (int p = 0; p < run->port_count; p++)
        run->held[p] = outlook.capacitance[run->zones[p]];
    return DEA_OK;
}

static enum dea_status rest_device(struct run *run, const double voltages[DEA_ZONES], struct dea_error *error) {
    DEA_TRY(dea_plant_rest_charges(run->plant, voltages, DEA_START_EQUILIBRIUM, NULL, &run->inputs, error));
    DEA_TRY(dea_plant_start(run->plant, 0.0, &run->inputs, DEA_START_EQUILIBRIUM, NULL, NULL, error));
    return hold_capacitances(run, run->interval);
}

static enum dea_status take_point(void *context, const struct dea_circuit_point *point, struct dea_error *error) {
    struct run *run = context;
    if (point->time <= 0.0) { /* the device rests at what the circuit found with its resting capacitance */
        double voltages[DEA_ZONES] = {0.0, 0.0};
        for (int p = 0; p < run->port_count; p++) {
            voltages[run->zones[p]] = point->ports[p].film_voltage;
            run->last_charge[p] = point->ports[p].charge;
        }
        DEA_TRY(rest_device(run, voltages, error));
        write_row(run, point);
        return DEA_OK;
    }
    if (point->time < next_exchange(run) - 1e-6 * run->interval)
        return DEA_OK;
    double from = dea_plant_time(run->plant);
    for (int p = 0; p < run->port_count; p++) {
        double q = point->ports[p].charge;
        struct dea_charge_piece piece = {from, {run->last_charge[p], (q - run->last_charge[p]) / (point->time - from)}};
        dea_plant_set_charge(run->plant, run->zones[p], &piece);
        run->last_charge[p] = q;
    }
    while (dea_plant_time(run->plant) < point->time) {
        struct dea_step step;
        DEA_TRY(dea_plant_step(run->plant, point->time, &step, error));
    }
    run->exchanges++;
    DEA_TRY(hold_capacitances(run, run->interval));
    write_row(run, point);
    return DEA_OK;
}

static enum dea_status create_plant(struct run *run, struct dea_error *error) {
    struct dea_plant_options options = {.accuracy = DEVICE_ACCURACY};
    const double none[DEA_ZONES] = {0.0, 0.0};
    run->port_count = coupled_order_ports(run->device, run->zones);
    for (int p = 0; p < run->port_count; p++)
        options.ports[run->zones[p]] = (struct dea_plant_port){.kind = DEA_PORT_CHARGE, .peak = 3000.0};
    run->inputs.load = (struct dea_piece){.kind = DEA_PIECE_LINE, .end = INFINITY};
    DEA_TRY(dea_plant_create(run->device, &options, &run->plant, error));
    return rest_device(run, none, error);
}

static enum dea_status run_circuit(struct run *run, const struct dea_scene *scene, double stop,
                                   struct dea_error *error) {
    struct dea_netlist netlist = {0};
    struct dea_circuit_device *devices = NULL;
    struct dea_deck deck = {0};
    struct dea_engine *engine = NULL;
    enum dea_status status = cosim_read_netlist(scene, false, NULL, &netlist, error);
    if (status == DEA_OK)
        status = cosim_describe_devices(scene, &devices, error);
    struct dea_deck_options options = {0};
    struct dea_engine_callbacks callbacks = {
        .context = run, .port_value = answer, .before_step = limit_step, .accepted = take_point};
    if (status == DEA_OK) {
        cosim_choose_tolerances(scene, &netlist, stop, 0, &options);
        options.step = options.max_step = run->interval;
    }
    if (status == DEA_OK)
        status = dea_deck_build(&netlist, devices, &options, &deck, error);
    if (status == DEA_OK)
        status = dea_engine_open(&engine, error);
    if (status == DEA_OK)
        status = dea_engine_load(engine, &netlist, &deck, devices, &options, &callbacks, error);
    if (status == DEA_OK)
        status = dea_engine_run(engine, error);
    if (engine != NULL) {
        struct dea_engine_stats counted;
        struct dea_run_stats plant = {0};
        dea_engine_stats(engine, &counted);
        dea_plant_stats(run->plant, &plant);
        printf("%ld %ld %ld\n", counted.points, counted.iterations, plant.residuals);
    }
    dea_engine_close(engine);
    dea_deck_clear(&deck);
    free(devices);
    dea_netlist_clear(&netlist);
    return status;
}

int main(int count, char **arguments) {
    if (count != 6) {
        fprintf(stderr, "usage: fixed_exchange SCENE ACCURACY INTERVAL STOP TABLE\n");
        return 2;
    }
    struct dea_error error = {.status = DEA_OK};
    struct dea_scene scene = {0};
    struct run run = {.interval = atof(arguments[3]), .error = &error};
    struct dea_override accuracy = {"transient.accuracy", arguments[2]};
    double stop = atof(arguments[4]);
    enum dea_status status = dea_scene_read(arguments[1], &accuracy, 1, &scene, &error);
    if (status == DEA_OK && (scene.netlist == NULL || scene.device_count != 1 || !(run.interval > 0.0 && stop > 0.0)))
        status = dea_fail(&error, DEA_ERR_INPUT, "fixed_exchange wants a netlist, one device, an interval and a stop");
    run.table = status == DEA_OK ? fopen(arguments[5], "w") : NULL;
    if (status == DEA_OK && run.table == NULL)
        status = dea_fail(&error, DEA_ERR_OUTPUT, "cannot write %s", arguments[5]);
    if (status == DEA_OK) {
        run.device = &scene.devices[0].device;
        status = create_plant(&run, &error);
    }
    if (status == DEA_OK)
        status = run_circuit(&run, &scene, stop, &error);
    if (status != DEA_OK)
        fprintf(stderr, "%s\n", error.text);
    if (run.table != NULL && fclose(run.table) != 0)
        status = DEA_ERR_OUTPUT;
    dea_plant_destroy(run.plant);
    dea_scene_clear(&scene);
    return status == DEA_OK ? 0 : 3;
}
