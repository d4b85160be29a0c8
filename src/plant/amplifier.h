/* The limits of amplifiers inside the plant; see amplifier.c. */
#ifndef DEASIM_PLANT_AMPLIFIER_H
#define DEASIM_PLANT_AMPLIFIER_H

#include "plant/plant_internal.h"

/* Finds the limits there are; none of them decided. */
void plant_list_limits(struct dea_plant *plant);

/* A value under a limit (its index, ABSENT for none), and whether the limit determines it. */
double plant_hold_limit(const struct dea_plant *plant, int index, double value, double limit);
bool plant_limit_holds(const struct dea_plant *plant, int index, double value, double limit);

/* At a restart: limits hold wherever they are exceeded, then as the consistent state has it (uses the last evaluation).
 */
void plant_release_limits(struct dea_plant *plant);
void plant_choose_limits(struct dea_plant *plant);

/* Root functions, one per limit. Uses the last evaluation. */
void plant_limit_roots(const struct dea_plant *plant, double t, const double *yp, double *values);

/* After a step: notes which limits turn; `hits` are the roots found, NULL for none. */
enum dea_status plant_note_limits(struct dea_plant *plant, const int *hits);
bool plant_limits_turn(const struct dea_plant *plant);
/* Turns them; the state needs new rates. */
enum dea_status plant_turn_limits(struct dea_plant *plant);

#endif
