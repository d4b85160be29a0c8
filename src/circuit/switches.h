/* Switches (S and W elements) of a circuit. ngspice lets a step pass a switch's threshold by 0.05 V, and when it
 * rejects a step in which a switch has turned, the switch stays turned in the shorter one if hysteresis allows: it
 * turns early. Both go away when a step ends just before the threshold and the next one passes it: from there on
 * ngspice's own truncation control decides how long that one may be. */
#ifndef DEASIM_CIRCUIT_SWITCHES_H
#define DEASIM_CIRCUIT_SWITCHES_H

#include "circuit/engine.h"

#define XSPICE
#include <ngspice/sharedspice.h>

struct dea_switches;

/* Finds the switches of the loaded circuit and has ngspice save their controls. *made is NULL without any. */
enum dea_status dea_switches_find(struct dea_engine *engine, struct dea_switches **made, struct dea_error *error);
void dea_switches_destroy(struct dea_switches *switches);

/* Where their controls are in ngspice's list of vectors. */
void dea_switches_map(struct dea_switches *switches, const vecvaluesall *values);

/* Takes in an accepted point. */
void dea_switches_follow(struct dea_switches *switches, double time, const vecvaluesall *values);

/* How long (s) the step after the last point may be, at most `delta`: it ends just before a switch turns. `duration` is
 * the run's, s. */
double dea_switches_limit(struct dea_switches *switches, double delta, double duration);

#endif
