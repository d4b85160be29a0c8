/* Circuits that are linear are solved together with the device, without ngspice stepping beside it. */
#ifndef DEASIM_COSIM_LINEAR_H
#define DEASIM_COSIM_LINEAR_H

#include "circuit/netlist.h"
#include "cosim/observer.h"

/* Recognises a linear circuit and runs the scene in it. *done is false, and nothing has been written, when the netlist
 * needs ngspice to step it. `ngspice` tells whether it may read the netlist and evaluate its .measure lines, which is
 * for a child process; without it *done is false for all but plain netlists. */
enum dea_status run_linear(const struct dea_scene *scene, const struct dea_netlist *netlist, bool ngspice,
                           const struct dea_run_options *options, const struct row_sink *sink,
                           struct dea_result *result, bool *done, struct dea_error *error);

#endif
