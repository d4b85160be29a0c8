/* A device on native sources or in a linear circuit: one IDA problem, restarted only at the corners of the waveforms.
 */
#include "cosim/native.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Of the run's length: the two steps after a corner that find the rates of a circuit's unknowns. Far below any time
 * constant that matters, far above the rounding of time. */
#define SETTLE_RATIO 1e-10

struct native_run {
    const struct dea_scene *scene;
    const struct native_circuit *circuit; /* NULL: native sources */
    const struct dea_network *network;    /* of the circuit */
    double *rows;                         /* owned; of the network's unknowns, for the tap */
    int row_length;
    bool jumped; /* since the last of these rows */
    const struct dea_run_options *options;
    double stop; /* s */
    struct dea_plant *plant;
    struct dea_plant_inputs inputs;
    struct dea_piece *pieces; /* owned; of the network's sources */
    struct observed observed;
    struct observer *observer;
};

/* ---- set-up ---- */

static void choose_port(const struct native_run *run, int k, struct dea_plant_port *port) {
    const struct dea_scene *scene = run->scene;
    const struct dea_zone *zone = &scene->devices[0].device.zones[k];
    const struct dea_source *source = &scene->sources[k];
    *port = (struct dea_plant_port){.kind = DEA_PORT_PASSIVE};
    if (!zone->present || !zone->electroded)
        return;
    if (run->network != NULL) {
        *port = (struct dea_plant_port){.kind = DEA_PORT_NETWORK, .peak = run->network->peak};
        return;
    }
    port->kind = DEA_PORT_IDEAL; /* without a source the electrode is grounded */
    if (!source->present)
        return;
    port->peak = dea_waveform_peak(&source->waveform);
    port->resistance = source->resistance;
    if (source->amplified) {
        port->amplifier = &source->amplifier;
        port->resistance += source->amplifier.output_resistance;
    }
    if (source->amplified || port->resistance > 0.0 || zone->electrode_resistance > 0.0 || zone->sheet_resistance > 0.0)
        port->kind = DEA_PORT_SOURCE;
}

static unsigned watched_events(const struct dea_scene *scene) {
    unsigned kinds = 0;
    for (int kind = 0; kind < DEA_EVENT_COUNT; kind++)
        if (scene->policies[kind] != DEA_POLICY_IGNORE)
            kinds |= 1u << kind;
    return kinds;
}

/* Periods of the fastest waveform over the run. */
static double count_periods(const struct native_run *run) {
    const struct dea_scene *scene = run->scene;
    double periods = scene->has_load_waveform ? dea_waveform_periods(&scene->load, run->stop) : 0.0;
    for (int k = 0; k < DEA_ZONES; k++)
        if (scene->sources[k].present)
            periods = fmax(periods, dea_waveform_periods(&scene->sources[k].waveform, run->stop));
    for (size_t i = 0; run->network != NULL && i < run->network->source_count; i++)
        periods = fmax(periods, dea_waveform_periods(&run->network->sources[i].waveform, run->stop));
    return periods;
}

static enum dea_status create_plant(struct native_run *run, struct dea_error *error) {
    const struct dea_scene *scene = run->scene;
    struct dea_plant_options options = {.accuracy = scene->accuracy,
                                        .duration = run->stop,
                                        .periods = count_periods(run),
                                        .max_step = scene->max_step,
                                        .network = run->network,
                                        .settle_time = SETTLE_RATIO * run->stop};
    if (scene->has_load_waveform)
        options.load_peak = dea_waveform_peak(&scene->load);
    options.load_peak += fabs(scene->devices[0].device.load);
    for (int k = 0; k < DEA_ZONES; k++)
        choose_port(run, k, &options.ports[k]);
    DEA_TRY(dea_plant_create(&scene->devices[0].device, &options, &run->plant, error));
    DEA_TRY(dea_plant_watch(run->plant, watched_events(scene), error));
    char states[1024];
    dea_report_detail(run->options->report, "states: %s", dea_plant_describe(run->plant, states, sizeof states));
    return DEA_OK;
}

/* ---- inputs ---- */

/* Pieces that hold just after t. Only those that ended are looked up again. */
static void set_inputs(struct native_run *run, double t) {
    const struct dea_scene *scene = run->scene;
    for (int k = 0; k < DEA_ZONES; k++)
        if (scene->sources[k].present && !(run->inputs.source[k].end > t))
            dea_waveform_piece(&scene->sources[k].waveform, t, &run->inputs.source[k]);
    if (scene->has_load_waveform && !(run->inputs.load.end > t))
        dea_waveform_piece(&scene->load, t, &run->inputs.load);
    for (size_t i = 0; run->network != NULL && i < run->network->source_count; i++)
        if (!(run->pieces[i].end > t))
            dea_waveform_piece(&run->network->sources[i].waveform, t, &run->pieces[i]);
}

static double next_corner(const struct native_run *run) {
    double corner = run->stop;
    for (size_t i = 0; run->network != NULL && i < run->network->source_count; i++)
        corner = fmin(corner, run->pieces[i].end);
    for (int k = 0; k < DEA_ZONES; k++)
        corner = fmin(corner, run->inputs.source[k].end);
    return fmin(corner, run->inputs.load.end);
}

/* ---- the run ---- */

static enum dea_status apply_policy(struct native_run *run, enum dea_policy policy, struct dea_error *error) {
    if (policy == DEA_POLICY_STOP)
        return DEA_STOPPED;
    if (policy == DEA_POLICY_SHORT) {
        for (int k = 0; k < DEA_ZONES; k++)
            if (observer_short_zones(run->observer) & 1u << k)
                dea_plant_short_film(run->plant, k, 1.0 / SHORT_RESISTANCE);
        observer_break(run->observer);
        DEA_TRY(dea_plant_restart(run->plant, &run->inputs, error));
        run->jumped = true;
        return observer_resume(run->observer, 0, dea_plant_time(run->plant), error);
    }
    return DEA_OK;
}

/* The course of the circuit's unknowns over a step. Its start is the end of the last one, unless something jumped. */
static enum dea_status tap_circuit(struct native_run *run, double from, double to, struct dea_error *error) {
    if (run->circuit == NULL || run->circuit->tap == NULL)
        return DEA_OK;
    double *last = run->rows + (CIRCUIT_ROWS - 1) * run->row_length;
    memcpy(run->rows, last, (size_t)run->row_length * sizeof *last);
    for (int i = run->jumped ? 0 : 1; i < CIRCUIT_ROWS; i++) {
        double *row = run->rows + i * run->row_length;
        double t = i == CIRCUIT_ROWS - 1 ? to : from + (to - from) * i / (CIRCUIT_ROWS - 1);
        DEA_TRY(dea_plant_network(run->plant, t, row, &row[run->row_length - 1], error));
    }
    run->jumped = false;
    return run->circuit->tap(run->circuit->tap_context, from, to, run->rows, error);
}

/* Until the next corner. */
static enum dea_status integrate_piece(struct native_run *run, double corner, struct dea_error *error) {
    double shortest = 16.0 * DBL_EPSILON * corner; /* corners this close are one */
    while (corner - dea_plant_time(run->plant) > shortest) {
        DEA_TRY(observer_check_interrupt(run->observer, dea_plant_time(run->plant), error));
        struct dea_step step;
        DEA_TRY(dea_plant_step(run->plant, corner, &step, error));
        DEA_TRY(observer_follow(run->observer, 0, step.from, step.to, error));
        DEA_TRY(tap_circuit(run, step.from, step.to, error));
        DEA_TRY(observer_write(run->observer, step.to, error));
        if (step.root) {
            int zone;
            enum dea_policy policy = observer_roots(run->observer, 0, step.to, &zone);
            DEA_TRY(apply_policy(run, policy, error));
        }
    }
    return DEA_OK;
}

static enum dea_status start_plant(struct native_run *run, struct dea_error *error) {
    const struct dea_scene *scene = run->scene;
    /* t = 0 rests on what the drive gave before: a step at 0 is a step */
    for (int k = 0; k < DEA_ZONES; k++)
        run->inputs.source[k] =
            (struct dea_piece){.kind = DEA_PIECE_LINE, .end = scene->sources[k].present ? -INFINITY : INFINITY};
    run->inputs.load =
        (struct dea_piece){.kind = DEA_PIECE_LINE, .end = scene->has_load_waveform ? -INFINITY : INFINITY};
    for (size_t i = 0; run->network != NULL && i < run->network->source_count; i++)
        run->pieces[i] = (struct dea_piece){.kind = DEA_PIECE_LINE, .end = -INFINITY};
    run->inputs.network = run->pieces;
    set_inputs(run, -1.0);
    DEA_TRY(dea_plant_start(run->plant, 0.0, &run->inputs, scene->start,
                            scene->has_initial_x ? &scene->initial_x : NULL,
                            scene->has_initial_v ? &scene->initial_v : NULL, error));
    return observer_start(run->observer, error);
}

/* New inputs in force; a jump may have crossed a limit without a root. */
static enum dea_status turn_corner(struct native_run *run, double corner, struct dea_error *error) {
    set_inputs(run, corner);
    DEA_TRY(dea_plant_restart(run->plant, &run->inputs, error));
    run->jumped = true;
    observer_break(run->observer);
    DEA_TRY(observer_resume(run->observer, 0, dea_plant_time(run->plant), error));
    int zone;
    enum dea_policy policy = observer_conditions(run->observer, 0, dea_plant_time(run->plant), &zone);
    return apply_policy(run, policy, error);
}

static enum dea_status integrate(struct native_run *run, struct dea_error *error) {
    DEA_TRY(start_plant(run, error));
    run->jumped = true;
    DEA_TRY(tap_circuit(run, 0.0, 0.0, error));
    double corner = 0.0;
    while (corner < run->stop) {
        DEA_TRY(turn_corner(run, corner, error));
        corner = next_corner(run);
        DEA_TRY(integrate_piece(run, corner, error));
    }
    return DEA_OK;
}

enum dea_status run_native(const struct dea_scene *scene, const struct native_circuit *circuit,
                           const struct dea_run_options *options, const struct row_sink *sink,
                           struct dea_result *result, struct dea_error *error) {
    struct native_run run = {.scene = scene, .circuit = circuit, .options = options, .stop = scene->stop};
    size_t sources = 1;
    run.row_length = 1; /* the position */
    if (circuit != NULL) {
        run.network = circuit->network;
        run.stop = circuit->stop;
        sources += run.network->source_count;
        run.row_length += run.network->node_count + run.network->branch_count;
    }
    run.pieces = calloc(sources, sizeof *run.pieces);
    run.rows = calloc((size_t)run.row_length * CIRCUIT_ROWS, sizeof *run.rows);
    if (run.pieces == NULL || run.rows == NULL) {
        free(run.pieces);
        free(run.rows);
        return dea_fail(error, DEA_ERR_MEMORY, "out of memory for the circuit's sources");
    }
    enum dea_status status = create_plant(&run, error);
    if (status == DEA_OK) {
        run.observed = (struct observed){run.plant, &scene->devices[0].device, NULL, false};
        snprintf(result->stats_run.mode, sizeof result->stats_run.mode, "%s",
                 circuit != NULL                     ? "linear"
                 : dea_plant_is_algebraic(run.plant) ? "static"
                                                     : "native");
        status = observer_open(scene, options, run.stop, &run.observed, 1, sink, result, &run.observer, error);
    }
    if (status == DEA_OK) {
        dea_report_begin(options->report);
        status = integrate(&run, error);
        dea_report_end(options->report);
        enum dea_status closed =
            observer_close(run.observer, dea_plant_time(run.plant), status < 0, status >= 0 ? error : NULL);
        if (closed != DEA_OK && status >= 0)
            status = closed;
    }
    dea_plant_destroy(run.plant);
    free(run.pieces);
    free(run.rows);
    return status;
}
