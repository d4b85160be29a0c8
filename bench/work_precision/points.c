/* Points of curves: memory, fronts, times at a given error. */
#include "work_precision.h"

#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

struct point *bench_add_point(struct bench *bench, const char *curve, const char *format, ...) {
    struct point *grown = realloc(bench->points, (bench->point_count + 1) * sizeof *grown);
    if (grown == NULL)
        abort();
    bench->points = grown;
    struct point *point = &grown[bench->point_count++];
    *point = (struct point){.error = {NAN, NAN}, .inner = NAN, .points = NAN, .iterations = NAN, .work = NAN};
    snprintf(point->curve, sizeof point->curve, "%s", curve);
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(point->setting, sizeof point->setting, format, arguments);
    va_end(arguments);
    return point;
}

void point_set_command(struct point *point, const char *const *arguments) {
    for (int i = 0; i + 1 < MAX_ARGUMENTS && arguments[i] != NULL; i++) {
        point->arguments[i] = strdup(arguments[i]);
        if (point->arguments[i] == NULL)
            abort();
    }
}

void point_fail(struct point *point, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(point->problem, sizeof point->problem, format, arguments);
    va_end(arguments);
}

double point_error(const struct point *point) {
    return point->problem[0] != '\0' ? NAN : fmax(point->error.x, point->error.ports);
}

static int compare_numbers(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

double point_median(const struct point *point) {
    double sorted[MAX_ROUNDS];
    int n = point->wall_count;
    if (n == 0)
        return NAN;
    memcpy(sorted, point->walls, (size_t)n * sizeof *sorted);
    qsort(sorted, (size_t)n, sizeof *sorted, compare_numbers);
    return n % 2 == 1 ? sorted[n / 2] : 0.5 * (sorted[n / 2 - 1] + sorted[n / 2]);
}

double point_least(const struct point *point) {
    double least = INFINITY;
    for (int i = 0; i < point->wall_count; i++)
        least = fmin(least, point->walls[i]);
    return point->wall_count > 0 ? least : NAN;
}

static bool is_beaten(const struct bench *bench, const struct point *point) {
    for (size_t i = 0; i < bench->point_count; i++) {
        const struct point *other = &bench->points[i];
        if (other == point || strcmp(other->curve, point->curve) != 0)
            continue;
        if (point_error(other) <= point_error(point) && other->walls[0] < point->walls[0])
            return true;
    }
    return false;
}

void choose_front(struct bench *bench, const char *curve) {
    for (size_t i = 0; i < bench->point_count; i++) {
        struct point *point = &bench->points[i];
        if (strcmp(point->curve, curve) == 0)
            point->chosen = isfinite(point_error(point)) && !is_beaten(bench, point);
    }
}

double curve_time(const struct bench *bench, const char *curve, double error, bool inner) {
    const struct point *below = NULL, *above = NULL; /* the nearest on either side */
    double best = NAN;
    for (size_t i = 0; i < bench->point_count; i++) {
        const struct point *p = &bench->points[i];
        double e = point_error(p), t = inner ? p->inner : point_least(p);
        if (strcmp(p->curve, curve) != 0 || !p->chosen || !isfinite(e) || !isfinite(t))
            continue;
        if (e <= error && !(t >= best)) {
            best = t;
            below = p;
        }
        if (e > error && (above == NULL || e < point_error(above)))
            above = p;
    }
    if (below == NULL || above == NULL)
        return best;
    double t0 = inner ? above->inner : point_least(above), e0 = point_error(above), e1 = point_error(below);
    if (t0 >= best)
        return best;
    return t0 * pow(best / t0, log(e0 / error) / log(e0 / e1));
}
