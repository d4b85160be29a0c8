/* From a netlist that turns out linear to one IDA problem. Plain netlists do without ngspice; it flattens the others,
 * and evaluates .measure lines that are not understood here. */
#include "cosim/linear.h"

#include "circuit/linear.h"
#include "circuit/measures.h"
#include "cosim/cosim.h"
#include "cosim/coupled.h"
#include "cosim/native.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* Tables of all pairs of unknowns and a dense operating point: beyond this ngspice is quicker (measured on ladders). */
#define MAX_UNKNOWNS 2000

struct linear_run {
    const struct dea_scene *scene;
    const struct dea_netlist *netlist;
    struct dea_circuit_device *devices; /* owned */
    struct dea_engine *engine;          /* NULL where ngspice is not needed */
    struct dea_deck deck;
    struct dea_deck_options deck_options;
    struct dea_network network;
    double stop; /* s */
    int unknowns;
    const char **names;            /* owned; of a row: unknowns, then the node that shows the position */
    double *rows;                  /* owned; of a step, the position as the voltage of its node */
    struct dea_measures *measures; /* owned; NULL: none, or the file below for ngspice to evaluate */
    char folder[64];               /* of that file, "" where there is none */
    struct dea_recorder *recorder;
    struct dea_engine_callbacks callbacks;
    struct dea_report *report; /* hears ngspice's warnings; NULL: not wanted */
};

/* ---- reading the circuit ---- */

static void pass_message(void *context, enum dea_message_kind kind, const char *text) {
    const struct linear_run *run = context;
    if (run->report != NULL && kind == DEA_MESSAGE_WARNING)
        dea_report_warn(run->report, "%s", text);
}

/* ngspice flattens subcircuits, puts parameters in and lists what is left. */
static enum dea_status list_with_ngspice(struct linear_run *run, struct dea_listing *listing, struct dea_error *error) {
    const struct dea_netlist *netlist = run->netlist;
    run->deck_options =
        (struct dea_deck_options){.stop = run->stop, .step = netlist->tran.step, .max_step = netlist->tran.max_step};
    DEA_TRY(cosim_describe_devices(run->scene, &run->devices, error));
    DEA_TRY(dea_deck_build(netlist, run->devices, &run->deck_options, &run->deck, error));
    DEA_TRY(dea_engine_open(&run->engine, error));
    run->callbacks = (struct dea_engine_callbacks){.context = run, .message = pass_message};
    DEA_TRY(
        dea_engine_load(run->engine, netlist, &run->deck, run->devices, &run->deck_options, &run->callbacks, error));
    return dea_engine_list(run->engine, listing, error);
}

/* The listing as equations. */
static enum dea_status read_listing(struct linear_run *run, const struct dea_listing *listing, bool *linear, char *why,
                                    size_t why_size, struct dea_error *error) {
    const struct dea_netlist *netlist = run->netlist;
    int zones[DEA_ZONES], ports = coupled_order_ports(&run->scene->devices[0].device, zones);
    double step = netlist->tran.step > 0.0 ? netlist->tran.step : run->stop / 1000.0;
    DEA_TRY(
        dea_linear_read(listing, netlist, zones, ports, step, run->stop, &run->network, linear, why, why_size, error));
    run->unknowns = run->network.node_count + run->network.branch_count;
    if (*linear && run->unknowns > MAX_UNKNOWNS) {
        *linear = false;
        snprintf(why, why_size, "too large, %d unknowns", run->unknowns);
    }
    return DEA_OK;
}

/* ---- measures ---- */

/* What is understood here is followed along the run. */
static enum dea_status read_measures(struct linear_run *run, struct dea_error *error) {
    const struct dea_netlist_instance *instance = &run->netlist->instances[0];
    int zones[DEA_ZONES], pos = 2 * coupled_order_ports(&run->scene->devices[0].device, zones);
    int row_length = run->unknowns + 1;
    run->names = calloc((size_t)row_length, sizeof *run->names);
    run->rows = calloc((size_t)row_length * CIRCUIT_ROWS, sizeof *run->rows);
    if (run->names == NULL || run->rows == NULL)
        return dea_fail(error, DEA_ERR_MEMORY, "out of memory for the circuit's voltages");
    for (int i = 0; i < run->unknowns; i++)
        run->names[i] = run->network.names[i];
    run->names[run->unknowns] = instance->nodes[pos];
    return dea_measures_read(run->netlist, run->names, row_length, &run->measures, error);
}

/* A raw file of the whole row, as ngspice would have written it. */
static enum dea_status open_record(struct linear_run *run, struct dea_error *error) {
    const char *place = getenv("TMPDIR");
    if (snprintf(run->folder, sizeof run->folder, "%.40s/deasim.XXXXXX", place != NULL ? place : "/tmp") < 0 ||
        mkdtemp(run->folder) == NULL) {
        run->folder[0] = '\0';
        return dea_fail(error, DEA_ERR_OUTPUT, "no temporary folder for the circuit's voltages: %s", strerror(errno));
    }
    size_t count = (size_t)run->unknowns + 1;
    struct dea_signal *signals = calloc(count, sizeof *signals);
    if (signals == NULL)
        return dea_fail(error, DEA_ERR_MEMORY, "out of memory for the circuit's voltages");
    for (size_t i = 0; i < count; i++) {
        bool current = (int)i >= run->network.node_count && (int)i < run->unknowns;
        snprintf(signals[i].name, sizeof signals[i].name, "%s", run->names[i]);
        snprintf(signals[i].unit, sizeof signals[i].unit, "%s", current ? "A" : "V");
    }
    enum dea_status status =
        dea_recorder_open(run->folder, DEA_FORMAT_RAW, "circuit", signals, count, &run->recorder, error);
    free(signals);
    return status;
}

/* Follows a step, or records it; of the start there is only one row. */
static enum dea_status follow(void *context, double from, double to, const double *rows, struct dea_error *error) {
    struct linear_run *run = context;
    int row_length = run->unknowns + 1;
    memcpy(run->rows, rows, (size_t)row_length * CIRCUIT_ROWS * sizeof *rows);
    for (int i = 0; i < CIRCUIT_ROWS; i++)
        run->rows[i * row_length + run->unknowns] *= 1e3; /* 1 V is 1 mm */
    if (run->measures != NULL && to > from)
        dea_measures_follow(run->measures, from, to, run->rows);
    if (run->recorder == NULL)
        return DEA_OK;
    for (int i = to > from ? 1 : CIRCUIT_ROWS - 1; i < CIRCUIT_ROWS; i++)
        DEA_TRY(dea_recorder_append(run->recorder, from + (to - from) * i / (CIRCUIT_ROWS - 1),
                                    run->rows + i * row_length, error));
    return DEA_OK;
}

static enum dea_status evaluate_record(struct linear_run *run, struct dea_report *report, struct dea_error *error) {
    char path[96];
    DEA_TRY(dea_recorder_close(run->recorder, error));
    run->recorder = NULL;
    snprintf(path, sizeof path, "%s/result.raw", run->folder);
    run->report = report; /* what was said of the circuit before, the run beside ngspice would say */
    return dea_engine_measure_file(run->engine, path, error);
}

static enum dea_status conclude_measures(struct linear_run *run, struct dea_report *report, struct dea_result *result,
                                         struct dea_error *error) {
    int count;
    const struct dea_engine_measure *measures;
    if (run->measures != NULL) {
        measures = dea_measures_results(run->measures, &count);
    } else {
        DEA_TRY(evaluate_record(run, report, error));
        measures = dea_engine_measures(run->engine, &count);
    }
    DEA_TRY(cosim_keep_measures(measures, count, result, error));
    for (size_t i = 0; i < result->measure_count; i++)
        if (result->measures[i].failed)
            dea_report_warn(report, ".measure tran %s failed", result->measures[i].name);
    return DEA_OK;
}

/* ---- the run ---- */

/* The circuit as equations and what is measured in it. Without ngspice, where that may be called, *linear is false for
 * what only it can read. */
static enum dea_status read_circuit(struct linear_run *run, bool ngspice, bool *linear, char *why, size_t why_size,
                                    struct dea_error *error) {
    struct dea_listing listing = {0};
    *linear = true;
    enum dea_status status =
        ngspice ? list_with_ngspice(run, &listing, error) : dea_linear_list(run->netlist, &listing, linear, error);
    if (status == DEA_OK && *linear)
        status = read_listing(run, &listing, linear, why, why_size, error);
    dea_listing_clear(&listing);
    if (status == DEA_OK && *linear && run->netlist->measure_count > 0) {
        status = read_measures(run, error);
        *linear = ngspice || run->measures != NULL;
    }
    return status;
}

static enum dea_status solve(struct linear_run *run, const struct dea_run_options *options, const struct row_sink *sink,
                             struct dea_result *result, struct dea_error *error) {
    struct native_circuit circuit = {.network = &run->network, .stop = run->stop};
    bool measured = run->netlist->measure_count > 0;
    if (measured && run->measures == NULL)
        DEA_TRY(open_record(run, error));
    if (measured) {
        circuit.tap = follow;
        circuit.tap_context = run;
    }
    enum dea_status status = run_native(run->scene, &circuit, options, sink, result, error);
    if (status >= 0 && measured)
        DEA_TRY(conclude_measures(run, options->report, result, error));
    return status;
}

static void clear(struct linear_run *run) {
    char path[96];
    struct dea_error ignored; /* a failure has been reported already, or the record is not wanted any more */
    dea_recorder_close(run->recorder, &ignored);
    if (run->folder[0] != '\0') {
        snprintf(path, sizeof path, "%s/result.raw", run->folder);
        unlink(path);
        rmdir(run->folder);
    }
    dea_engine_close(run->engine);
    dea_deck_clear(&run->deck);
    dea_network_clear(&run->network);
    dea_measures_destroy(run->measures);
    free(run->devices);
    free(run->names);
    free(run->rows);
}

enum dea_status run_linear(const struct dea_scene *scene, const struct dea_netlist *netlist, bool ngspice,
                           const struct dea_run_options *options, const struct row_sink *sink,
                           struct dea_result *result, bool *done, struct dea_error *error) {
    *done = false;
    if (options->engine == DEA_ENGINE_NGSPICE || !dea_linear_possible(netlist))
        return DEA_OK;
    struct linear_run run = {.scene = scene, .netlist = netlist};
    bool linear = false;
    char why[256] = "";
    enum dea_status status = cosim_choose_stop(scene, netlist, &run.stop, error);
    if (status == DEA_OK)
        status = read_circuit(&run, ngspice, &linear, why, sizeof why, error);
    if (status == DEA_OK && !linear && ngspice)
        dea_report_detail(options->report, "the circuit is not solved as linear: %s", why);
    if (status == DEA_OK && linear) {
        status = solve(&run, options, sink, result, error);
        *done = true;
        /* no operating point as equations: let ngspice try, it has more ways */
        if (status == DEA_ERR_SOLVER && (result->signal_count == 0 || result->stats[0].max < result->stats[0].min)) {
            if (ngspice)
                dea_report_detail(options->report, "%s; trying ngspice", error->text);
            dea_result_clear(result);
            *done = false;
            status = DEA_OK;
        }
    }
    clear(&run);
    return status;
}
