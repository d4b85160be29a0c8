/* A netlist's run in a child process: ngspice may crash, hang or exit without taking results or messages along. */
#ifndef DEASIM_COSIM_SUPERVISE_H
#define DEASIM_COSIM_SUPERVISE_H

#include "cosim/observer.h"

/* Reads the netlist. A plain linear one is solved here; any other scene runs in a child, whose rows are passed to the
 * sink. Same contract as dea_run_scene. */
enum dea_status run_supervised(const struct dea_scene *scene, const struct dea_run_options *options,
                               const struct row_sink *sink, struct dea_result *result, struct dea_error *error);

#endif
