/* Charge windows: storing circuit points and fitting cubics to many of them at once. */
#include "cosim/window.h"

#include <math.h>
#include <stdlib.h>

/* Second differences this much apart belong to a corner, not to a smooth curve. */
#define CORNER_RATIO 10.0

enum dea_status window_add(struct window *window, const struct window_point *point) {
    if (window->count == window->capacity) {
        size_t capacity = window->capacity > 0 ? 2 * window->capacity : 64;
        struct window_point *points = realloc(window->points, capacity * sizeof *points);
        if (points == NULL)
            return DEA_ERR_MEMORY;
        window->points = points;
        window->capacity = capacity;
    }
    window->points[window->count++] = *point;
    return DEA_OK;
}

enum dea_status window_begin(struct window *window, const struct window_point *first) {
    window->first = window->count = 0;
    return window_add(window, first);
}

void window_restart(struct window *window) {
    if (window->count < 2)
        return;
    window->points[0] = window->points[window->count - 2];
    window->points[1] = window->points[window->count - 1];
    window->first = 1;
    window->count = 2;
}

static double slope_between(const struct window_point *a, const struct window_point *b) {
    return (b->q - a->q) / (b->t - a->t);
}

void window_find_rates(struct window *window, size_t n) {
    struct window_point *points = window->points, *a = &points[n], *b = &points[n + 1];
    double h = b->t - a->t, slope = slope_between(a, b), bend_a = 0.0, bend_b = 0.0;
    bool earlier = n > 0, later = n + 2 < window->count;
    if (earlier)
        bend_a = bend_b = (slope - slope_between(&points[n - 1], a)) / (b->t - points[n - 1].t);
    if (later)
        bend_b = (slope_between(b, &points[n + 2]) - slope) / (points[n + 2].t - a->t);
    if (later && !earlier)
        bend_a = bend_b;
    bool corner = true;
    if (fabs(bend_a) > CORNER_RATIO * fabs(bend_b))
        bend_a = bend_b;
    else if (fabs(bend_b) > CORNER_RATIO * fabs(bend_a))
        bend_b = bend_a;
    else
        corner = false;
    a->after = n > 0 && n == window->first && !corner ? a->before : slope - bend_a * h;
    b->before = slope + bend_b * h;
}

void window_clear(struct window *window) {
    free(window->points);
    *window = (struct window){0};
}

void window_hermite(const struct window_point *a, const struct window_point *b, struct dea_charge_piece *piece) {
    double h = b->t - a->t, slope = slope_between(a, b);
    piece->start = a->t;
    piece->c[0] = a->q;
    piece->c[1] = a->after;
    piece->c[2] = (3.0 * slope - 2.0 * a->after - b->before) / h;
    piece->c[3] = (a->after + b->before - 2.0 * slope) / (h * h);
}

static double piece_value(const struct dea_charge_piece *piece, double t, double *rate) {
    double d = t - piece->start;
    const double *c = piece->c;
    if (rate != NULL)
        *rate = c[1] + d * (2.0 * c[2] + d * 3.0 * c[3]);
    return c[0] + d * (c[1] + d * (c[2] + d * c[3]));
}

double window_value(const struct window_point *a, const struct window_point *b, double t, double *rate) {
    struct dea_charge_piece piece;
    window_hermite(a, b, &piece);
    return piece_value(&piece, t, rate);
}

/* Integrals over one step: of Q, of (t - origin) Q, both exact for the Hermite cubic. */
static void step_moments(const struct window_point *a, const struct window_point *b, double origin, double *m0,
                         double *m1) {
    double h = b->t - a->t;
    *m0 = 0.5 * h * (a->q + b->q) + h * h / 12.0 * (a->after - b->before);
    double local = h * h * (0.15 * a->q + 0.35 * b->q) + h * h * h * (a->after / 30.0 - b->before / 20.0);
    *m1 = local + (a->t - origin) * *m0;
}

/* Cubic with end values q0, q1 and moments m0, m1 over [0, h]: q0 + (q1 - q0) s + s (1 - s) (a + b s), s = d / h. */
static void fit_cubic(const struct window_point *first, const struct window_point *last, double m0, double m1,
                      struct dea_charge_piece *piece) {
    double h = last->t - first->t, q0 = first->q, dq = last->q - first->q;
    /* int s(1-s) = 1/6, int s^2(1-s) = 1/12, int s^3(1-s) = 1/20 */
    double r0 = m0 / h - q0 - dq / 2.0, r1 = m1 / (h * h) - q0 / 2.0 - dq / 3.0;
    double b = (r1 - r0 / 2.0) / (1.0 / 20.0 - 1.0 / 24.0), a = 6.0 * r0 - b / 2.0;
    piece->start = first->t;
    piece->c[0] = q0;
    piece->c[1] = (dq + a) / h;
    piece->c[2] = (b - a) / (h * h);
    piece->c[3] = -b / (h * h * h);
}

/* Whether the running integral of the difference of squares stays within a tolerance over the points, by Simpson on
 * each step. */
static bool is_close(const struct window *window, size_t first, size_t last, double tolerance,
                     const struct dea_charge_piece *piece) {
    double sum = 0.0, before = 0.0;
    for (size_t n = first; n < last; n++) {
        const struct window_point *a = &window->points[n], *b = &window->points[n + 1];
        double h = b->t - a->t, middle = 0.5 * (a->q + b->q) + 0.125 * h * (a->after - b->before);
        double fit_middle = piece_value(piece, a->t + 0.5 * h, NULL), fit_end = piece_value(piece, b->t, NULL);
        double at_middle = middle * middle - fit_middle * fit_middle, at_end = b->q * b->q - fit_end * fit_end;
        sum += h * (1.0 / 6.0) * (before + 4.0 * at_middle + at_end);
        if (!(fabs(sum) <= tolerance))
            return false;
        before = at_end;
    }
    return true;
}

size_t window_fit(const struct window *window, size_t first, size_t last, double tolerance,
                  struct dea_charge_piece *piece) {
    while (last > first + 1) {
        window_hermite(&window->points[first], &window->points[last], piece); /* smooth at its ends */
        if (is_close(window, first, last, tolerance, piece))
            return last;
        double m0 = 0.0, m1 = 0.0, step0, step1;
        for (size_t n = first; n < last; n++) {
            step_moments(&window->points[n], &window->points[n + 1], window->points[first].t, &step0, &step1);
            m0 += step0;
            m1 += step1;
        }
        fit_cubic(&window->points[first], &window->points[last], m0, m1, piece);
        if (is_close(window, first, last, tolerance, piece))
            return last;
        last = first + (last - first) / 2;
    }
    window_hermite(&window->points[first], &window->points[first + 1], piece);
    return first + 1;
}
