/* The film charge between two exchanges, as the circuit delivered it, made into as few cubics as the mechanics can tell
 * apart. */
#ifndef DEASIM_COSIM_WINDOW_H
#define DEASIM_COSIM_WINDOW_H

#include "deasim/plant.h"

#include <stddef.h>

/* One accepted circuit point. Its charge is exact to the circuit's integration; the rate that integration gives is not:
 * by trapezoids it rings undamped where a node is stiff. So the rates come from the charges themselves, one for each
 * side of the point, which may be a corner. */
struct window_point {
    double t, q;                       /* s, C */
    double before, after;              /* A, at the end of the interval before, at the start of the one after */
    double film_voltage, port_voltage; /* V */
    double leak, stretch, capacitance; /* A, 1, F: charge over film voltage */
    double middle; /* F, capacitance halfway through the interval that ends here, once its work has been booked */
};

struct window {
    struct window_point *points; /* owned; points[first] is the last exchange, one earlier point may come before it */
    size_t first, count, capacity;
};

/* Empties the window and sets its first point. */
enum dea_status window_begin(struct window *window, const struct window_point *first);
enum dea_status window_add(struct window *window, const struct window_point *point);
/* The last point becomes the first of the next window; the one before it is kept for rates. */
void window_restart(struct window *window);
void window_clear(struct window *window);

/* Rates at both ends of the interval from points[n] to points[n + 1], from the neighbours there are: of the parabolas
 * through three points the one on each end's own side, or the flatter one for both where they differ as at a corner. */
void window_find_rates(struct window *window, size_t n);

/* Cubic Hermite through two points with the rates between them; value at t with its rate (may be NULL). */
void window_hermite(const struct window_point *a, const struct window_point *b, struct dea_charge_piece *piece);
double window_value(const struct window_point *a, const struct window_point *b, double t, double *rate);

/* The longest piece that starts at points[first] and stands for all points up to the returned index, at most `last`:
 * the cubic with the end charges and rates, or the one with the end charges and the exact integrals of Q and t Q, if
 * the integral of its error in Q^2 stays below `tolerance` (C^2 s): that is what moves a platform with inertia. Two
 * neighbouring points are met exactly. */
size_t window_fit(const struct window *window, size_t first, size_t last, double tolerance,
                  struct dea_charge_piece *piece);

#endif
