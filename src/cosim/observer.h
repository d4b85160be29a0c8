/* Watches a run: samples for the files, extremes over the whole run, events and what the scene wants done about them.
 */
#ifndef DEASIM_COSIM_OBSERVER_H
#define DEASIM_COSIM_OBSERVER_H

#include "deasim/plant.h"
#include "deasim/run.h"

struct observer;

/* Plants in the order of the scene's devices. Opens the result files. */
enum dea_status observer_open(const struct dea_scene *scene, const struct dea_run_options *options, double stop,
                              struct dea_plant *const *plants, int plant_count, struct dea_result *result,
                              struct observer **observer, struct dea_error *error);

/* First row, at the plants' start. */
enum dea_status observer_start(struct observer *observer, struct dea_error *error);

/* After a step of all plants from `from` to `to`: extremes, and every sample time in (from, to]. */
enum dea_status observer_follow(struct observer *observer, double from, double to, struct dea_error *error);

/* A jump of the inputs: extremes do not interpolate across it. */
void observer_break(struct observer *observer);

/* Books the events one plant met at time t: at roots of its last step, or those that hold now. Returns the strongest
 * policy asked for (DEA_POLICY_IGNORE: nothing to do); *zone is where for DEA_POLICY_SHORT. */
enum dea_policy observer_roots(struct observer *observer, int device, double t, int *zone);
enum dea_policy observer_conditions(struct observer *observer, int device, double t, int *zone);

/* Last row at t (unless just sampled), files closed, statistics and energies gathered into the result. Frees the
 * observer; NULL is fine. `failed` tells that the plants' state at t may be outside the model and is not sampled. */
enum dea_status observer_close(struct observer *observer, double t, bool failed, struct dea_error *error);

#endif
