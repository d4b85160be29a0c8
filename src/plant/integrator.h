/* Between start.c and integrator.c: the part of the integrator that restarts use. */
#ifndef DEASIM_PLANT_INTEGRATOR_H
#define DEASIM_PLANT_INTEGRATOR_H

#include "plant/plant_internal.h"

/* All orders again, after order 2 for a quiet platform: the inputs change. */
enum dea_status plant_free_order(struct dea_plant *plant, struct dea_error *error);

/* start.c: the amplifiers' limits begin or end to hold, the run goes on from there. */
enum dea_status plant_turn_over(struct dea_plant *plant, struct dea_error *error);

/* Puts IDA to (t, y, yp) with the quadratures as they stand, first order, no history. */
enum dea_status plant_restart_integrator(struct dea_plant *plant, struct dea_error *error);

/* Notes the stored energy and boundary terms the audit starts from. */
enum dea_status plant_open_books(struct dea_plant *plant, struct dea_error *error);

/* tolerance.c */
/* Step tolerance and rounding of the unknowns from the promised accuracy. */
void plant_set_tolerance(struct dea_plant *plant);
/* IDA's weight function. */
int plant_weigh(N_Vector y, N_Vector weights, void *context);
/* Notes how large the unknowns have become. */
void plant_note_sizes(struct dea_plant *plant);
/* Sets the tolerance of the loss integrals by the energy moved so far. */
bool plant_judge_energy(struct dea_plant *plant);
/* Length of the first step after a restart, at most a part of `length`, s. */
double plant_first_step(struct dea_plant *plant, double length);

/* sensitivity.c: where a step begins, and after it. Use the last evaluation. */
void plant_note_place(struct dea_plant *plant);
void plant_note_sensitivity(struct dea_plant *plant);

/* evaluate.c: pieces of a zone's evaluation that the static start uses too. */
void plant_leak_through_film(const struct dea_plant *plant, int zone, struct zone_point *point);
void plant_drive_current(const struct dea_plant *plant, int zone, struct zone_point *point);
double plant_charge_value(const struct dea_charge_piece *piece, double t, double *rate);

#endif
