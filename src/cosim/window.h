/* The film charge between two exchanges, as the circuit delivered it, made into as few cubics as the mechanics can tell
 * apart. */
#ifndef DEASIM_COSIM_WINDOW_H
#define DEASIM_COSIM_WINDOW_H

#include "deasim/plant.h"

#include <stddef.h>

/* One accepted circuit point: charge and its rate. */
struct window_point {
    double t, q, i; /* s, C, A */
};

struct window {
    struct window_point *points; /* owned; points[0] is the last exchange */
    size_t count, capacity;
};

/* Empties the window and sets its first point. */
enum dea_status window_begin(struct window *window, const struct window_point *first);
enum dea_status window_add(struct window *window, const struct window_point *point);
void window_clear(struct window *window);

/* Cubic Hermite through two points; value at t with its rate (may be NULL). */
void window_hermite(const struct window_point *a, const struct window_point *b, struct dea_charge_piece *piece);
double window_value(const struct window_point *a, const struct window_point *b, double t, double *rate);

/* The longest piece that starts at points[first] and stands for all points up to the returned index, at most `last`:
 * one cubic with the window's end charges and the exact integrals of Q and t Q, accepted while the integral of its
 * error in Q^2 stays below `tolerance` (C^2 s): that is what moves a platform with inertia. Two neighbouring points are
 * met exactly. */
size_t window_fit(const struct window *window, size_t first, size_t last, double tolerance,
                  struct dea_charge_piece *piece);

#endif
