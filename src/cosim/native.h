/* Runs as one IDA problem: on native sources, or together with a linear circuit. */
#ifndef DEASIM_COSIM_NATIVE_H
#define DEASIM_COSIM_NATIVE_H

#include "cosim/observer.h"
#include "deasim/network.h"

/* A linear circuit to be solved along. */
struct native_circuit {
    const struct dea_network *network;
    double stop; /* end of the run, s */
    /* Told the circuit's unknowns (V, A) and the platform's position (m) in time order, closer than the integrator's
     * steps; may be NULL. */
    enum dea_status (*tap)(void *context, double t, const double *unknowns, double x, struct dea_error *error);
    void *tap_context;
};

/* The scene's single device on its native sources, or in `circuit` (NULL: none). Rows go to the sink; otherwise as
 * dea_run_scene. */
enum dea_status run_native(const struct dea_scene *scene, const struct native_circuit *circuit,
                           const struct dea_run_options *options, const struct row_sink *sink,
                           struct dea_result *result, struct dea_error *error);

#endif
