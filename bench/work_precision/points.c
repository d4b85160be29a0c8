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
    *point = (struct point){.error = {NAN, NAN}, .own = NAN, .cpu = NAN, .points = NAN, .iterations = NAN, .work = NAN};
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

void point_blame(struct point *point, const struct process_result *result) {
    if (result->timed_out)
        point_fail(point, "took too long");
    else
        point_fail(point, "failed: %s", result->message[0] != '\0' ? result->message : "no word why");
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

/* ---- starts ---- */

void bench_set_start(struct bench *bench, const char *curve, const char *const *arguments, double least) {
    for (int i = 0; i < bench->start_count; i++)
        if (strcmp(bench->starts[i].curve, curve) == 0)
            return;
    if (bench->start_count == MAX_STARTS)
        abort();
    struct start *start = &bench->starts[bench->start_count++];
    *start = (struct start){.least = least};
    snprintf(start->curve, sizeof start->curve, "%s", curve);
    for (int i = 0; arguments != NULL && i + 1 < MAX_ARGUMENTS && arguments[i] != NULL; i++) {
        start->arguments[i] = strdup(arguments[i]);
        if (start->arguments[i] == NULL)
            abort();
    }
}

static double start_of(const struct bench *bench, const char *curve) {
    for (int i = 0; i < bench->start_count; i++)
        if (strcmp(bench->starts[i].curve, curve) == 0)
            return bench->starts[i].least;
    return NAN;
}

bool is_script(const char *curve) {
    return strncmp(curve, "scipy", 5) == 0 || strncmp(curve, "octave", 6) == 0;
}

double point_solve(const struct bench *bench, const struct point *point) {
    double least = point_least(point);
    if (is_script(point->curve))
        return least;
    double difference = least - start_of(bench, point->curve);
    return difference > 0.0 ? fmax(difference, SMALLEST_DIFFERENCE) : NAN;
}

double point_whole(const struct bench *bench, const struct point *point) {
    return point_least(point) + (is_script(point->curve) ? start_of(bench, point->curve) : 0.0);
}

double point_whole_median(const struct bench *bench, const struct point *point) {
    return point_median(point) + (is_script(point->curve) ? start_of(bench, point->curve) : 0.0);
}

double bench_deadline(const struct bench *bench, double share) {
    return process_clock() + share * bench->budget;
}

bool is_late(double deadline) {
    return process_clock() > deadline;
}

/* ---- curves ---- */

bool has_curve(const struct bench *bench, const char *curve) {
    for (size_t i = 0; i < bench->point_count; i++)
        if (strcmp(bench->points[i].curve, curve) == 0)
            return true;
    return false;
}

const char *own_curve(const struct bench *bench) {
    if (!bench->entry->circuit)
        return "deasim native";
    return bench->entry->linear ? "deasim linear" : "deasim cosim";
}

static bool is_beaten(const struct bench *bench, const struct point *point) {
    for (size_t i = 0; i < bench->point_count; i++) {
        const struct point *other = &bench->points[i];
        if (other == point || strcmp(other->curve, point->curve) != 0)
            continue;
        if (point_error(other) <= point_error(point) && other->cpu < point->cpu)
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

double curve_least_error(const struct bench *bench, const char *curve) {
    double least = NAN;
    for (size_t i = 0; i < bench->point_count; i++)
        if (strcmp(bench->points[i].curve, curve) == 0)
            least = fmin(least, point_error(&bench->points[i]));
    return least;
}

static double point_time(const struct bench *bench, const struct point *point, enum time_kind kind) {
    return kind == TIME_WHOLE ? point_whole(bench, point) : point_solve(bench, point);
}

double curve_time(const struct bench *bench, const char *curve, double error, enum time_kind kind) {
    const struct point *below = NULL, *above = NULL; /* the nearest on either side */
    double best = NAN;
    for (size_t i = 0; i < bench->point_count; i++) {
        const struct point *p = &bench->points[i];
        double e = point_error(p), t = point_time(bench, p, kind);
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
    double t0 = point_time(bench, above, kind), e0 = point_error(above), e1 = point_error(below);
    if (t0 >= best)
        return best;
    return t0 * pow(best / t0, log(e0 / error) / log(e0 / e1));
}
