/* .measure lines of a circuit that is solved without ngspice: worked out step by step, nothing of the run is kept.
 * Within a step a signal is the polynomial through five of its values, so results are as accurate as the run. */
#ifndef DEASIM_CIRCUIT_MEASURES_H
#define DEASIM_CIRCUIT_MEASURES_H

#include "circuit/engine.h"

#define DEA_MEASURE_ROWS 5 /* of a step, at equal distances: its start, its quarters, its end */

struct dea_measures;

/* Understands all .measure lines, or none: *measures is NULL where ngspice has to evaluate them. names[] are those of
 * the values in a row as ngspice spells them: "left", "xa.m", "v1#branch". */
enum dea_status dea_measures_read(const struct dea_netlist *netlist, const char *const *names, int count,
                                  struct dea_measures **measures, struct dea_error *error);

/* The next step in time, `from` < `to` in s; rows holds DEA_MEASURE_ROWS rows of `count` values. What has jumped since
 * the step before is taken as it is. */
void dea_measures_follow(struct dea_measures *measures, double from, double to, const double *rows);

/* Results, in the order of the lines; owned by the measures. */
const struct dea_engine_measure *dea_measures_results(struct dea_measures *measures, int *count);

void dea_measures_destroy(struct dea_measures *measures);

#endif
