/* Runs of a scene without a circuit. */
#ifndef DEASIM_COSIM_NATIVE_H
#define DEASIM_COSIM_NATIVE_H

#include "cosim/observer.h"

/* The scene's single device on its native sources. Rows go to the sink; otherwise as dea_run_scene. */
enum dea_status run_native(const struct dea_scene *scene, const struct dea_run_options *options,
                           const struct row_sink *sink, struct dea_result *result, struct dea_error *error);

#endif
