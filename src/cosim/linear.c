/* From a netlist that turns out linear to one IDA problem. */
#include "cosim/linear.h"

#include "circuit/linear.h"
#include "cosim/cosim.h"
#include "cosim/coupled.h"
#include "cosim/native.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ngspice flattens subcircuits, puts parameters in and lists what is left. */
static enum dea_status read_circuit(const struct dea_scene *scene, const struct dea_netlist *netlist, double stop,
                                    struct dea_network *network, bool *linear, char *why, size_t why_size,
                                    struct dea_error *error) {
    struct dea_circuit_device *devices = NULL;
    struct dea_engine *engine = NULL;
    struct dea_deck deck = {0};
    struct dea_listing listing = {0};
    struct dea_engine_callbacks silent = {0};
    struct dea_deck_options options = {.stop = stop, .step = netlist->tran.step, .max_step = netlist->tran.max_step};
    enum dea_status status = cosim_describe_devices(scene, &devices, error);
    if (status == DEA_OK)
        status = dea_deck_build(netlist, devices, &options, &deck, error);
    if (status == DEA_OK)
        status = dea_engine_open(&engine, error);
    if (status == DEA_OK)
        status = dea_engine_load(engine, netlist, &deck, devices, &options, &silent, error);
    if (status == DEA_OK)
        status = dea_engine_list(engine, &listing, error);
    if (status == DEA_OK) {
        int zones[DEA_ZONES], ports = coupled_order_ports(&scene->devices[0].device, zones);
        double step = netlist->tran.step > 0.0 ? netlist->tran.step : stop / 1000.0;
        status = dea_linear_read(&listing, netlist, zones, ports, step, stop, network, linear, why, why_size, error);
    }
    dea_listing_clear(&listing);
    dea_engine_close(engine);
    dea_deck_clear(&deck);
    free(devices);
    return status;
}

enum dea_status run_linear(const struct dea_scene *scene, const struct dea_netlist *netlist,
                           const struct dea_run_options *options, const struct row_sink *sink,
                           struct dea_result *result, bool *done, struct dea_error *error) {
    *done = false;
    if (options->engine == DEA_ENGINE_NGSPICE || !dea_linear_possible(netlist))
        return DEA_OK;
    struct dea_network network = {0};
    bool linear = false;
    char why[256] = "";
    double stop;
    DEA_TRY(cosim_choose_stop(scene, netlist, &stop, error));
    enum dea_status status = read_circuit(scene, netlist, stop, &network, &linear, why, sizeof why, error);
    if (status == DEA_OK && !linear)
        dea_report_detail(options->report, "the circuit is not linear: %s", why);
    if (status == DEA_OK && linear) {
        status = run_native(scene, &network, stop, options, sink, result, error);
        *done = true;
        /* no operating point as equations: let ngspice try, it has more ways */
        if (status == DEA_ERR_SOLVER && (result->signal_count == 0 || result->stats[0].max < result->stats[0].min)) {
            dea_report_detail(options->report, "%s; trying ngspice", error->text);
            dea_result_clear(result);
            *done = false;
            status = DEA_OK;
        }
    }
    dea_network_clear(&network);
    return status;
}
