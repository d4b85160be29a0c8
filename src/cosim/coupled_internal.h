/* Parts of a coupled device: what the circuit is told (told.c), the rest (coupled.c). */
#ifndef DEASIM_COSIM_COUPLED_INTERNAL_H
#define DEASIM_COSIM_COUPLED_INTERNAL_H

#include "cosim/coupled.h"

struct window_point *coupled_last_point(const struct coupled *coupled, int port);

/* The tangent of Q(V) of one film at time t, about a charge. */
struct told_film coupled_tell_film(const struct coupled *coupled, int port, double t, double charge);

/* All numbers of one time at once; a circuit asks for each of them in each Newton iteration. */
void coupled_tell_all(struct coupled *coupled, double t);

/* Charge over voltage on a tangent, F; far from where it was taken, near no voltage, that would mean nothing and is
 * bounded. */
double coupled_quotient(const struct told_film *film, double voltage);

/* Film voltage that holds charge q at time t under what was told; *capacitance (may be NULL) is their quotient. */
double coupled_film_voltage(const struct coupled *coupled, int port, double t, double q, double *capacitance);

#endif
