/* Circuits that are linear are solved together with the device, without ngspice stepping beside it. */
#ifndef DEASIM_COSIM_LINEAR_H
#define DEASIM_COSIM_LINEAR_H

#include "circuit/netlist.h"
#include "cosim/observer.h"

/* Recognises a linear circuit and runs the scene in it. *done is false, and nothing has been written, when the netlist
 * needs ngspice. */
enum dea_status run_linear(const struct dea_scene *scene, const struct dea_netlist *netlist,
                           const struct dea_run_options *options, const struct row_sink *sink,
                           struct dea_result *result, bool *done, struct dea_error *error);

#endif
