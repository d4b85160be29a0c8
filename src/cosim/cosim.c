/* The coupling: at every accepted circuit point the film charges are taken in; when the outlook the circuit was given
 * grows too old, the plants catch up and give a new one. The circuit's steps are only ever shortened, nothing is
 * redone, charge is conserved by construction. The mismatch between the capacitance promised and the one that came true
 * is the error estimate that sets how far an outlook may reach. */
#include "cosim/cosim_internal.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* How the asked accuracy A is shared out. The numbers come from tests/stress/cosim.c, which compares with circuit and
 * device integrated as one system: with them all parts weigh about the same, and the delivered error is a fraction of A
 * at every A from 1e-2 to 1e-6. */
#define PLANT_SHARE 0.5 /* of A, to the plants */
/* Of A, to the mismatch of one exchange. */
#define COUPLING_SHARE 0.01
/* A mismatch lags behind the motion, so what it leaves adds up from one free oscillation to the next: as many of them
 * as this and the share is halved. */
#define COUPLING_CYCLES 20.0
/* A swing below these parts of A, in capacitance and of the largest displacement, is left out: the platform rests. */
#define REST_SHARE 0.1
#define REST_SHARE_OF_POSITION 0.25
#define FIT_SHARE 0.004         /* of A, to the charge fits, over a natural time or what has been run of it */
#define MIN_HORIZON_RATIO 1e-12 /* of the run: below it the coupling has collapsed */
/* Of 1/omega: exchanges further apart would keep a swing alive, at what they may miss, for ever. */
#define SWING_REACH 0.7
#define PAST_CORNER 1e-9 /* of the run */
/* Of the horizon: an exchange this soon after the platform has met a stop knows the stop's force, and little has
 * happened yet. */
#define PAST_CONTACT 1e-3
/* Of the circuit's step in which a film went slack or taut: how far the outlook after it reaches. Its branches go other
 * ways from there on than the rates foresaw. */
#define TURN_REACH 2.0
#define MAX_POINTS 4096 /* of the circuit between two exchanges: memory stays flat, and the fits linear */

/* ---- devices ---- */

static double natural_time(const struct dea_device *device) {
    if (device->effective_mass > 0.0)
        return sqrt(device->effective_mass / device->stiffness);
    return device->damping / device->stiffness;
}

static enum dea_status create_devices(struct cosim *run, struct dea_error *error) {
    const struct dea_scene *scene = run->scene;
    run->count = run->netlist->instance_count;
    size_t count = (size_t)run->count;
    run->devices = calloc(count, sizeof *run->devices);
    run->observed = calloc(count, sizeof *run->observed);
    run->rest_voltages = calloc(count * DEA_ZONES, sizeof *run->rest_voltages);
    if (run->devices == NULL || run->observed == NULL || run->rest_voltages == NULL)
        return dea_fail(error, DEA_ERR_MEMORY, "out of memory for %zu devices", count);
    DEA_TRY(cosim_describe_devices(scene, &run->circuit_devices, error));
    unsigned kinds = 0;
    for (int kind = 0; kind < DEA_EVENT_COUNT; kind++)
        if (scene->policies[kind] != DEA_POLICY_IGNORE)
            kinds |= 1u << kind;
    bool each_once = run->count == scene->device_count;
    run->rests = !run->control->restless && run->control->horizon <= 0.0;
    for (int i = 0; i < run->count; i++) {
        const struct dea_netlist_instance *instance = &run->netlist->instances[i];
        const struct dea_device *device = &scene->devices[instance->device].device;
        struct coupled_demand demand = {PLANT_SHARE * scene->accuracy,
                                        run->stop,
                                        cosim_expect_voltage(device),
                                        scene->policies[DEA_EVENT_BREAKDOWN] > DEA_POLICY_WARN,
                                        run->rests ? REST_SHARE * scene->accuracy : 0.0,
                                        run->rests ? REST_SHARE_OF_POSITION * scene->accuracy : 0.0};
        DEA_TRY(
            coupled_create(&run->devices[i], device, scene->has_load_waveform ? &scene->load : NULL, &demand, error));
        run->devices[i].allowed_mismatch = COUPLING_SHARE * scene->accuracy /
                                           (1.0 + dea_plant_remembered_cycles(run->devices[i].plant) / COUPLING_CYCLES);
        DEA_TRY(dea_plant_watch(run->devices[i].plant, kinds, error));
        run->observed[i] = (struct observed){run->devices[i].plant, device,
                                             run->count == 1 ? NULL
                                             : each_once     ? scene->devices[instance->device].name
                                                             : instance->path,
                                             true};
        run->slowest = fmax(run->slowest, natural_time(device));
        char states[1024];
        dea_report_detail(run->options->report, "%s: states: %s", instance->path,
                          dea_plant_describe(run->devices[i].plant, states, sizeof states));
    }
    return DEA_OK;
}

/* ---- exchange ---- */

/* For a callback that cannot fail: the next one that can reports it. */
static enum dea_status report_failure(const struct cosim *run, struct dea_error *error) {
    if (run->status < 0 && error != NULL)
        *error = run->failure;
    return run->status;
}

/* All plants catch up with the circuit; the mismatch sets how far the new outlooks reach. */
static enum dea_status exchange_all(struct cosim *run, struct dea_error *error) {
    double mismatch = 0.0, end = run->reached; /* mismatch over what it may be */
    enum dea_status status = DEA_OK;
    for (int i = 0; i < run->count; i++) {
        struct exchange exchange;
        const struct coupled *device = &run->devices[i];
        double fit = FIT_SHARE * run->scene->accuracy * fmin(natural_time(device->device), run->reached);
        if (run->control->pointwise)
            fit = -1.0;
        DEA_TRY(coupled_advance(&run->devices[i], i, fit, run->observer, &exchange, error));
        mismatch = fmax(mismatch, exchange.mismatch / device->allowed_mismatch);
        if (exchange.policy == DEA_POLICY_STOP) {
            status = DEA_STOPPED;
            end = fmin(end, dea_plant_time(device->plant));
        }
    }
    if (status == DEA_STOPPED) {
        run->exchanged_at = end;
        DEA_TRY(observer_write(run->observer, end, error));
        return status;
    }
    double grow = mismatch > 0.0 ? 0.9 * pow(mismatch, -1.0 / 3.0) : 3.0;
    run->horizon = fmin((run->reached - run->exchanged_at) * fmin(fmax(grow, 0.25), 3.0), run->stop / 20.0);
    run->exchanged_at = run->reached;
    if (run->control->horizon > 0.0)
        run->horizon = run->control->horizon;
    if (run->horizon < MIN_HORIZON_RATIO * run->stop)
        return dea_fail(error, DEA_ERR_SOLVER,
                        "t = %.9g s: the coupling collapsed: exchanges %.3g s apart still differ %.3g times as much in "
                        "capacitance as they may",
                        run->reached, run->horizon, mismatch);
    for (int i = 0; i < run->count; i++) {
        const struct coupled *device = &run->devices[i];
        DEA_TRY(coupled_renew(&run->devices[i], run->horizon, error));
        if (device->device->effective_mass > 0.0 && !device->at_rest && run->rests)
            run->horizon = fmin(run->horizon, SWING_REACH * natural_time(device->device));
        double contact = coupled_next_contact(device, run->horizon) - run->reached;
        run->horizon = fmin(run->horizon, contact + PAST_CONTACT * run->horizon);
        double corner = coupled_next_corner(device) - run->reached; /* of the load: nothing is foreseen beyond it */
        if (corner > 0.0)                                           /* one that is missed by rounding is passed soon */
            run->horizon = fmin(run->horizon, fmax(corner, PAST_CORNER * run->stop));
    }
    return observer_write(run->observer, run->reached, error);
}

/* ---- callbacks of the engine ---- */

static double answer(void *context, int instance, int port, enum dea_external which, double t) {
    struct cosim *run = context;
    return coupled_tell(&run->devices[instance], port, which, t);
}

/* The next step must not outrun the outlook: first refresh it, then shorten the step. */
static void limit_step(void *context, double t, double *delta) {
    struct cosim *run = context;
    if (run->resting || run->status != DEA_OK)
        return;
    if (t + *delta > run->exchanged_at + run->horizon && t > run->exchanged_at && t <= run->reached)
        run->status = exchange_all(run, &run->failure);
    *delta = fmin(*delta, fmax(run->exchanged_at + run->horizon - t, 0.1 * run->horizon));
    for (int i = 0; i < run->count; i++) { /* land on the load's corners */
        double corner = coupled_next_corner(&run->devices[i]);
        if (t < corner && t + *delta > corner && corner - t > run->stop * MIN_HORIZON_RATIO)
            *delta = corner - t;
    }
}

/* First row, and what is beyond a limit from the start. */
enum dea_status cosim_begin_observing(struct cosim *run, struct dea_error *error) {
    DEA_TRY(observer_start(run->observer, error));
    for (int i = 0; i < run->count; i++) {
        int zone;
        enum dea_policy policy = observer_conditions(run->observer, i, 0.0, &zone);
        coupled_short(&run->devices[i], observer_short_zones(run->observer));
        if (policy == DEA_POLICY_STOP)
            return DEA_STOPPED;
    }
    return DEA_OK;
}

static enum dea_status take_point(void *context, const struct dea_circuit_point *point, struct dea_error *error) {
    struct cosim *run = context;
    if (run->resting) {
        DEA_TRY(cosim_judge_rest(run, point, error));
        if (run->resting)
            return DEA_STOPPED;
        DEA_TRY(cosim_begin_observing(run, error));
        for (int i = 0; i < run->count; i++)
            DEA_TRY(coupled_take(&run->devices[i], i, 0.0, 0.0, &point->ports[i * DEA_ZONES], run->observer, error));
        return DEA_OK;
    }
    DEA_TRY(report_failure(run, error));
    for (int i = 0; i < run->count; i++)
        DEA_TRY(coupled_take(&run->devices[i], i, run->reached, point->time, &point->ports[i * DEA_ZONES],
                             run->observer, error));
    double step = point->time - run->reached;
    run->reached = point->time;
    bool exchange = run->devices[0].windows[0].count >= MAX_POINTS, turned = false;
    for (int i = 0; i < run->count && run->control->horizon <= 0.0; i++) {
        const struct coupled *device = &run->devices[i];
        exchange = exchange || device->drift > device->allowed_mismatch; /* not the way that was foreseen */
        turned = turned || device->turned;
    }
    if (exchange || turned)
        DEA_TRY(exchange_all(run, error));
    if (turned)
        run->horizon = fmin(run->horizon, TURN_REACH * step);
    if (run->channel != NULL) {
        dea_channel_progress(run->channel, point->time);
        if (dea_channel_stop_requested(run->channel))
            return dea_fail(error, DEA_ERR_INTERRUPTED, "t = %.9g s: interrupted", point->time);
    }
    return DEA_OK;
}

static void pass_message(void *context, enum dea_message_kind kind, const char *text) {
    struct cosim *run = context;
    if (kind == DEA_MESSAGE_WARNING && !run->resting)
        dea_report_warn(run->options->report, "%s", text);
    else
        dea_report_detail(run->options->report, "ngspice: %s", text);
}

/* ---- the run ---- */

enum dea_status cosim_keep_measures(const struct dea_engine_measure *measures, int count, struct dea_result *result,
                                    struct dea_error *error) {
    if (count == 0)
        return DEA_OK;
    result->measures = calloc((size_t)count, sizeof *result->measures);
    if (result->measures == NULL)
        return dea_fail(error, DEA_ERR_MEMORY, "out of memory for %d measures", count);
    result->measure_count = (size_t)count;
    for (int i = 0; i < count; i++) {
        struct dea_netlist_measure *kept = &result->measures[i];
        snprintf(kept->name, sizeof kept->name, "%s", measures[i].name);
        kept->value = measures[i].value;
        kept->failed = measures[i].failed;
    }
    return DEA_OK;
}

/* The ports' side of the balance: losses outside the film, and the difference of the film work on both sides. */
static void settle_books(struct cosim *run) {
    struct dea_energy *energy = &run->result->energy;
    double difference = 0.0;
    for (int i = 0; i < run->count; i++) {
        struct dea_energy plant;
        if (dea_plant_energy(run->devices[i].plant, &plant, NULL) != DEA_OK)
            continue;
        difference += fabs(run->devices[i].books.film_work - plant.electrical);
        double outside = run->devices[i].books.resistive + run->devices[i].books.leakage;
        energy->resistive += run->devices[i].books.resistive;
        energy->leakage += run->devices[i].books.leakage;
        energy->dissipated += outside;
        energy->electrical += run->devices[i].books.film_work - plant.electrical + outside;
        energy->in += run->devices[i].books.film_work - plant.electrical + outside;
        energy->exchanged += fabs(outside);
    }
    if (energy->exchanged > 0.0) {
        energy->imbalance =
            fmax(energy->imbalance, fabs(energy->in - energy->stored - energy->dissipated) / energy->exchanged);
        run->result->coupling_error = difference / energy->exchanged;
    }
    struct dea_engine_stats stats;
    dea_engine_stats(run->engine, &stats);
    run->result->stats_run.circuit_points = stats.points;
    run->result->stats_run.circuit_rejected = stats.rejected;
    run->result->stats_run.circuit_iterations = stats.iterations;
}

static void clear_run(struct cosim *run) {
    dea_engine_close(run->engine);
    dea_deck_clear(&run->deck);
    dea_deck_clear(&run->rest_deck);
    for (int i = 0; run->devices != NULL && i < run->count; i++)
        coupled_clear(&run->devices[i]);
    free(run->circuit_devices);
    free(run->devices);
    free(run->observed);
    free(run->rest_voltages);
}

enum dea_status cosim_run(const struct dea_scene *scene, const struct dea_netlist *netlist,
                          const struct dea_run_options *options, const struct cosim_control *control,
                          const struct row_sink *sink, struct dea_channel *channel, struct dea_result *result,
                          struct dea_error *error) {
    struct cosim run = {
        .scene = scene,
        .netlist = netlist,
        .options = options,
        .control = control,
        .channel = channel,
        .result = result,
        .callbacks = {
            .port_value = answer, .before_step = limit_step, .accepted = take_point, .message = pass_message}};
    run.callbacks.context = &run;
    snprintf(result->stats_run.mode, sizeof result->stats_run.mode, "cosim");
    result->relaxed = control->relaxed;
    enum dea_status status = cosim_choose_stop(scene, netlist, &run.stop, error);
    if (status == DEA_OK)
        status = create_devices(&run, error);
    if (status == DEA_OK) {
        cosim_choose_tolerances(scene, netlist, run.stop, control->relaxed, &run.deck_options);
        status = dea_deck_build(netlist, run.circuit_devices, &run.deck_options, &run.deck, error);
    }
    if (status == DEA_OK)
        status = dea_engine_open(&run.engine, error);
    if (status == DEA_OK)
        status = cosim_rest_devices(&run, error);
    if (status == DEA_OK)
        status = observer_open(scene, options, run.stop, run.observed, run.count, sink, result, &run.observer, error);
    if (status == DEA_OK) {
        dea_report_begin(options->report);
        status = cosim_run_from_rest(&run, error);
        result->circuit_gave_up = status == DEA_ERR_SOLVER && run.status == DEA_OK && run.reached > 0.0;
        if (status == DEA_OK)
            status = report_failure(&run, error);
        bool keeps = status == DEA_OK || status == DEA_ERR_INTERRUPTED || result->circuit_gave_up;
        if (keeps && run.reached > run.exchanged_at) { /* the devices follow to where the circuit got */
            enum dea_status last = exchange_all(&run, status >= 0 ? error : NULL);
            if (status == DEA_OK)
                status = last;
        }
        dea_report_end(options->report);
        enum dea_status closed = observer_close(run.observer, run.exchanged_at, status < 0, status >= 0 ? error : NULL);
        if (closed != DEA_OK && status >= 0)
            status = closed;
        settle_books(&run);
        int count = 0;
        const struct dea_engine_measure *measures = dea_engine_measures(run.engine, &count);
        enum dea_status measured = cosim_keep_measures(measures, count, result, status >= 0 ? error : NULL);
        if (measured != DEA_OK && status >= 0)
            status = measured;
    }
    clear_run(&run);
    return status;
}
