/* Runs as one IDA problem: on native sources, or together with a linear circuit. */
#ifndef DEASIM_COSIM_NATIVE_H
#define DEASIM_COSIM_NATIVE_H

#include "cosim/observer.h"
#include "deasim/network.h"

/* The scene's single device on its native sources, or with `network` (NULL: none) on that circuit until `stop` (s).
 * Rows go to the sink; otherwise as dea_run_scene. */
enum dea_status run_native(const struct dea_scene *scene, const struct dea_network *network, double stop,
                           const struct dea_run_options *options, const struct row_sink *sink,
                           struct dea_result *result, struct dea_error *error);

#endif
