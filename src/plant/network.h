/* The linear circuit inside the plant; see network.c. Functions on rows and entries work on scaled unknowns. */
#ifndef DEASIM_PLANT_NETWORK_H
#define DEASIM_PLANT_NETWORK_H

#include "plant/plant_internal.h"

/* Places the circuit's unknowns behind the device's; nothing without a network. */
enum dea_status plant_network_lay_out(struct dea_plant *plant, int *count, struct dea_error *error);
void plant_network_scale(struct dea_plant *plant);

/* network_modes.c: how many cycles of ringing, and for how long, the circuit remembers. Nothing without a network, or
 * where the length of the run is not known. */
enum dea_status plant_network_remember(struct dea_plant *plant, struct dea_error *error);

/* Voltage between a zone's pins, V. */
double plant_network_port_voltage(const struct dea_plant *plant, int zone, const double *y);

/* Rows of the circuit, and of the charges of films without R_e. Uses the last evaluation. */
void plant_network_residual(const struct dea_plant *plant, double t, const double *y, const double *yp, double *r);
void plant_network_jacobian(const struct dea_plant *plant, double cj, double *data);
void plant_network_mark(const struct dea_plant *plant, char *pattern, bool slack);

/* Operating point with films drawing the given currents (A): fills the circuit's unknowns and the voltages between the
 * pins. */
enum dea_status plant_network_rest(struct dea_plant *plant, double t, const double drawn[DEA_ZONES],
                                   double voltages[DEA_ZONES], struct dea_error *error);

/* A consistent state right after a corner, by two implicit Euler steps of options.settle_time; moves the plant's time
 * on by them. */
enum dea_status plant_network_settle(struct dea_plant *plant, struct dea_error *error);

/* Second derivatives of all unknowns over the next h (s) into `bends` (plant->rates), by a trial step that is taken
 * back. DEA_RECOVERABLE when it cannot be taken. */
enum dea_status plant_network_try(struct dea_plant *plant, double h, double *bends);

#endif
