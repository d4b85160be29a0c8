/* Co-simulation: libngspice runs the circuit, IDA the devices; they exchange charge for capacitance. */
#ifndef DEASIM_COSIM_COSIM_H
#define DEASIM_COSIM_COSIM_H

#include "base/isolate.h"
#include "circuit/engine.h"
#include "cosim/observer.h"

/* Reads and vets the scene's netlist; what is left out or looks like a slip goes to `report` (may be NULL). Pin names
 * and counts follow the scene's devices. */
enum dea_status cosim_read_netlist(const struct dea_scene *scene, bool trusted, struct dea_report *report,
                                   struct dea_netlist *netlist, struct dea_error *error);

/* Electrical side of the scene's devices, in their order; *devices is malloc'd. */
enum dea_status cosim_describe_devices(const struct dea_scene *scene, struct dea_circuit_device **devices,
                                       struct dea_error *error);

/* .measure results into the result. */
enum dea_status cosim_keep_measures(const struct dea_engine_measure *measures, int count, struct dea_result *result,
                                    struct dea_error *error);

/* Voltage (V) a device is meant for: its breakdown field over the resting film; without one, where Maxwell stress meets
 * the modulus. */
double cosim_expect_voltage(const struct dea_device *device);

/* What .ic gives a node, V; 0 without one. */
double cosim_initial_voltage(const struct dea_netlist *netlist, const char *node);

/* End of the run: the scene's, or the netlist's .tran. */
enum dea_status cosim_choose_stop(const struct dea_scene *scene, const struct dea_netlist *netlist, double *stop,
                                  struct dea_error *error);

/* How ngspice runs: what the netlist's .tran asks for, and tolerances for the scene's accuracy, loosened `relaxed`
 * times.
 */
void cosim_choose_tolerances(const struct dea_scene *scene, const struct dea_netlist *netlist, double stop, int relaxed,
                             struct dea_deck_options *options);

/* How the coupling is steered beyond what the scene says. */
struct cosim_control {
    int relaxed;    /* how often the circuit's tolerances are loosened */
    double horizon; /* s: exchange at this interval whatever the mismatch, to measure the order; 0: as the mismatch
                       allows */
    bool pointwise; /* every circuit point is a step of the device, to measure what fitting many at once spares */
    bool restless;  /* foresee every swing, however small, to measure what resting spares */
};

/* Runs the coupled scene in this process. `channel` (may be NULL) is told of progress and asked whether to stop. */
enum dea_status cosim_run(const struct dea_scene *scene, const struct dea_netlist *netlist,
                          const struct dea_run_options *options, const struct cosim_control *control,
                          const struct row_sink *sink, struct dea_channel *channel, struct dea_result *result,
                          struct dea_error *error);

#endif
