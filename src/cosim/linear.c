/* From a netlist that turns out linear to one IDA problem. ngspice reads the netlist and evaluates its .measure lines;
 * in between it does nothing. */
#include "cosim/linear.h"

#include "circuit/linear.h"
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
    struct dea_engine *engine;
    struct dea_deck deck;
    struct dea_deck_options deck_options;
    struct dea_network network;
    double stop; /* s */
    /* the circuit's unknowns for .measure, in a folder of their own */
    char folder[64];
    struct dea_recorder *recorder;
    double *row; /* owned */
    int unknowns;
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
static enum dea_status read_circuit(struct linear_run *run, bool *linear, char *why, size_t why_size,
                                    struct dea_error *error) {
    const struct dea_netlist *netlist = run->netlist;
    run->deck_options =
        (struct dea_deck_options){.stop = run->stop, .step = netlist->tran.step, .max_step = netlist->tran.max_step};
    DEA_TRY(cosim_describe_devices(run->scene, &run->devices, error));
    DEA_TRY(dea_deck_build(netlist, run->devices, &run->deck_options, &run->deck, error));
    DEA_TRY(dea_engine_open(&run->engine, error));
    run->callbacks = (struct dea_engine_callbacks){.context = run, .message = pass_message};
    DEA_TRY(
        dea_engine_load(run->engine, netlist, &run->deck, run->devices, &run->deck_options, &run->callbacks, error));
    struct dea_listing listing;
    enum dea_status status = dea_engine_list(run->engine, &listing, error);
    if (status == DEA_OK) {
        int zones[DEA_ZONES], ports = coupled_order_ports(&run->scene->devices[0].device, zones);
        double step = netlist->tran.step > 0.0 ? netlist->tran.step : run->stop / 1000.0;
        status = dea_linear_read(&listing, netlist, zones, ports, step, run->stop, &run->network, linear, why, why_size,
                                 error);
    }
    dea_listing_clear(&listing);
    run->unknowns = run->network.node_count + run->network.branch_count;
    if (*linear && run->unknowns > MAX_UNKNOWNS) {
        *linear = false;
        snprintf(why, why_size, "too large, %d unknowns", run->unknowns);
    }
    return status;
}

/* ---- measures ---- */

/* A raw file of all unknowns and the position pin, as ngspice would have written it. */
static enum dea_status open_record(struct linear_run *run, struct dea_error *error) {
    const struct dea_network *network = &run->network;
    const char *place = getenv("TMPDIR");
    if (snprintf(run->folder, sizeof run->folder, "%.40s/deasim.XXXXXX", place != NULL ? place : "/tmp") < 0 ||
        mkdtemp(run->folder) == NULL) {
        run->folder[0] = '\0';
        return dea_fail(error, DEA_ERR_OUTPUT, "no temporary folder for the circuit's voltages: %s", strerror(errno));
    }
    struct dea_signal *signals = calloc((size_t)run->unknowns + 1, sizeof *signals);
    run->row = calloc((size_t)run->unknowns + 1, sizeof *run->row);
    enum dea_status status = DEA_OK;
    if (signals == NULL || run->row == NULL)
        status = dea_fail(error, DEA_ERR_MEMORY, "out of memory for the circuit's voltages");
    for (int i = 0; status == DEA_OK && i < run->unknowns; i++) {
        snprintf(signals[i].name, sizeof signals[i].name, "%s", network->names[i]);
        snprintf(signals[i].unit, sizeof signals[i].unit, "%s", i < network->node_count ? "V" : "A");
    }
    if (status == DEA_OK) {
        const struct dea_netlist_instance *instance = &run->netlist->instances[0];
        int zones[DEA_ZONES], pos = 2 * coupled_order_ports(&run->scene->devices[0].device, zones);
        snprintf(signals[run->unknowns].name, sizeof signals[0].name, "%s", instance->nodes[pos]);
        snprintf(signals[run->unknowns].unit, sizeof signals[0].unit, "V");
        status = dea_recorder_open(run->folder, DEA_FORMAT_RAW, "circuit", signals, (size_t)run->unknowns + 1,
                                   &run->recorder, error);
    }
    free(signals);
    return status;
}

static enum dea_status record(void *context, double t, const double *unknowns, double x, struct dea_error *error) {
    struct linear_run *run = context;
    memcpy(run->row, unknowns, (size_t)run->unknowns * sizeof *run->row);
    run->row[run->unknowns] = 1e3 * x; /* 1 V is 1 mm */
    return dea_recorder_append(run->recorder, t, run->row, error);
}

static enum dea_status measure(struct linear_run *run, struct dea_report *report, struct dea_result *result,
                               struct dea_error *error) {
    char path[96];
    DEA_TRY(dea_recorder_close(run->recorder, error));
    run->recorder = NULL;
    snprintf(path, sizeof path, "%s/result.raw", run->folder);
    run->report = report; /* what was said of the circuit before, the run beside ngspice would say */
    DEA_TRY(dea_engine_measure_file(run->engine, path, error));
    DEA_TRY(cosim_keep_measures(run->engine, result, error));
    for (size_t i = 0; i < result->measure_count; i++) /* evaluated outside a run, ngspice does not name it */
        if (result->measures[i].failed)
            dea_report_warn(report, ".measure tran %s failed", result->measures[i].name);
    return DEA_OK;
}

/* ---- the run ---- */

static enum dea_status solve(struct linear_run *run, const struct dea_run_options *options, const struct row_sink *sink,
                             struct dea_result *result, struct dea_error *error) {
    struct native_circuit circuit = {.network = &run->network, .stop = run->stop};
    bool measures = run->netlist->measure_count > 0;
    if (measures) {
        DEA_TRY(open_record(run, error));
        circuit.tap = record;
        circuit.tap_context = run;
    }
    enum dea_status status = run_native(run->scene, &circuit, options, sink, result, error);
    if (status >= 0 && measures)
        DEA_TRY(measure(run, options->report, result, error));
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
    free(run->devices);
    free(run->row);
}

enum dea_status run_linear(const struct dea_scene *scene, const struct dea_netlist *netlist,
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
        status = read_circuit(&run, &linear, why, sizeof why, error);
    if (status == DEA_OK && !linear)
        dea_report_detail(options->report, "the circuit is not solved as linear: %s", why);
    if (status == DEA_OK && linear) {
        status = solve(&run, options, sink, result, error);
        *done = true;
        /* no operating point as equations: let ngspice try, it has more ways */
        if (status == DEA_ERR_SOLVER && (result->signal_count == 0 || result->stats[0].max < result->stats[0].min)) {
            dea_report_detail(options->report, "%s; trying ngspice", error->text);
            dea_result_clear(result);
            *done = false;
            status = DEA_OK;
        }
    }
    clear(&run);
    return status;
}
