/* Runs as one IDA problem: on native sources, or together with a linear circuit. */
#ifndef DEASIM_COSIM_NATIVE_H
#define DEASIM_COSIM_NATIVE_H

#include "cosim/observer.h"
#include "deasim/network.h"

/* A linear circuit to be solved along. */
struct native_circuit {
    const struct dea_network *network;
    double stop; /* end of the run, s */
    /* Told every step's course in time order, first the start with from = to = 0; may be NULL. rows holds CIRCUIT_ROWS
     * rows at equal distances from `from` to `to` (s): the circuit's unknowns (V, A), then the platform's position (m).
     */
    enum dea_status (*tap)(void *context, double from, double to, const double *rows, struct dea_error *error);
    void *tap_context;
};

#define CIRCUIT_ROWS 5

/* The scene's single device on its native sources, or in `circuit` (NULL: none). Rows go to the sink; otherwise as
 * dea_run_scene. */
enum dea_status run_native(const struct dea_scene *scene, const struct native_circuit *circuit,
                           const struct dea_run_options *options, const struct row_sink *sink,
                           struct dea_result *result, struct dea_error *error);

#endif
