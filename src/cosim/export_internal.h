/* Shared by the files that write a deck for plain ngspice. Every state is the voltage of a capacitor that a current
 * charges at the state's rate; states are scaled to order one. */
#ifndef DEASIM_COSIM_EXPORT_INTERNAL_H
#define DEASIM_COSIM_EXPORT_INTERNAL_H

#include "deasim/scene.h"

#include <stdio.h>

#define EXPORT_SCALE_CURRENT 1e-3 /* A per unit of a state's rate times its time constant */
#define EXPORT_EDGE 1e-7          /* of the run: how long a jump takes */

/* How a device starts. Without uic, x (unless given) and stretch are guesses: ngspice's operating point finds the rest.
 */
struct export_start {
    bool fresh, has_x, uic;                       /* branches as just prestretched; x given; no operating point */
    double x, v;                                  /* m, m/s */
    double kick;                                  /* s: how long v takes to be there */
    double stretch[DEA_ZONES], charge[DEA_ZONES]; /* of the films, 1 and C */
};

/* A state y of this time constant (s), between the nodes NAME and 0. */
void export_state(FILE *file, const char *name, double time_constant);

/* Device `index` of the scene as a subcircuit. `stop` is the end of the run, s. */
void export_device(FILE *file, const struct dea_scene *scene, int index, const struct export_start *start, double stop);

/* A voltage source NAME between `node` and 0. */
void export_source(FILE *file, const char *name, const char *node, const struct dea_waveform *waveform, double stop);

/* What a source gives before t = 0. */
double export_value_at_rest(const struct dea_waveform *waveform);

/* Call of the single device, its native sources with their amplifiers. */
void export_native_drive(FILE *file, const struct dea_scene *scene, double stop);

/* Longest step (s) at which a sine or chirp of the native drive is still followed; INFINITY without one. */
double export_native_step(const struct dea_scene *scene);

#endif
