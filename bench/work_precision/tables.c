/* Rows of the CSV file and tables for people. */
#include "work_precision.h"

#include <math.h>
#include <string.h>

static void write_number(FILE *file, double value) {
    if (isfinite(value))
        fprintf(file, ",%.6g", value);
    else
        fputs(",", file);
}

void write_rows(const struct bench *bench, FILE *file) {
    for (size_t i = 0; i < bench->point_count; i++) {
        const struct point *p = &bench->points[i];
        fprintf(file, "%s,%s,%s", bench->entry->name, p->curve, p->setting);
        const double numbers[] = {
            p->error.x, p->error.ports, point_error(p), point_median(p), point_least(p), p->cpu > 0.0 ? p->cpu : NAN,
            p->inner,   p->points,      p->iterations,  p->work};
        for (size_t n = 0; n < sizeof numbers / sizeof numbers[0]; n++)
            write_number(file, numbers[n]);
        fprintf(file, ",%d,%s\n", p->chosen && p->wall_count > 0, p->problem);
    }
}

/* ---- tables ---- */

static const char *const curves[] = {"deasim native",  "deasim linear", "deasim cosim", "ngspice",
                                     "fixed exchange", "scipy LSODA",   "scipy Radau",  "octave ode15s"};
static const double errors[] = {1e-2, 1e-3, 1e-4, 1e-5, 1e-6};

enum { CURVES = sizeof curves / sizeof curves[0], ERRORS = sizeof errors / sizeof errors[0] };

static bool has_curve(const struct bench *bench, const char *curve) {
    for (size_t i = 0; i < bench->point_count; i++)
        if (strcmp(bench->points[i].curve, curve) == 0)
            return true;
    return false;
}

/* deasim's own way for the scene: what `deasim run` takes. */
static const char *own_curve(const struct bench *bench) {
    if (!bench->entry->circuit)
        return "deasim native";
    return bench->entry->linear ? "deasim linear" : "deasim cosim";
}

static void write_times(const struct bench *bench, FILE *file, bool inner) {
    fprintf(file, "\n| %s |", inner ? "solving alone" : "whole process");
    for (int e = 0; e < ERRORS; e++)
        fprintf(file, " %.0e |", errors[e]);
    fputs("\n|---|", file);
    for (int e = 0; e < ERRORS; e++)
        fputs("---|", file);
    fputc('\n', file);
    const char *own = own_curve(bench);
    for (int c = 0; c < CURVES; c++) {
        if (!has_curve(bench, curves[c]))
            continue;
        fprintf(file, "| %s |", curves[c]);
        for (int e = 0; e < ERRORS; e++) {
            double time = curve_time(bench, curves[c], errors[e], inner);
            double ratio = time / curve_time(bench, own, errors[e], inner);
            if (!isfinite(time))
                fputs(" - |", file);
            else if (strcmp(curves[c], own) == 0 || !isfinite(ratio))
                fprintf(file, " %.3g ms |", 1e3 * time);
            else
                fprintf(file, " %.3g ms, x %.2g |", 1e3 * time, ratio);
        }
        fputc('\n', file);
    }
}

static void write_failures(const struct bench *bench, FILE *file) {
    int failed = 0, listed = 0;
    for (size_t i = 0; i < bench->point_count; i++)
        failed += bench->points[i].problem[0] != '\0';
    if (failed == 0)
        return;
    fprintf(file, "\nFailures (%d of %zu points):", failed, bench->point_count);
    for (size_t i = 0; i < bench->point_count && listed < 8; i++)
        if (bench->points[i].problem[0] != '\0')
            fprintf(file, "%s %s %s: %s", listed++ > 0 ? ";" : "", bench->points[i].curve, bench->points[i].setting,
                    bench->points[i].problem);
    fputs(failed > listed ? "; ...\n" : "\n", file);
}

/* Device and electronics together against the electronics alone, at the same tolerances. */
static void write_overhead(const struct bench *bench, FILE *file) {
    bool any = false;
    for (size_t i = 0; i < bench->point_count; i++) {
        const struct point *alone = &bench->points[i];
        if (strcmp(alone->curve, "fixed capacitor") != 0)
            continue;
        for (size_t j = 0; j < bench->point_count; j++) {
            const struct point *own = &bench->points[j];
            double ratio = point_median(own) / point_median(alone), least = point_least(own) / point_least(alone);
            if (strcmp(own->curve, "deasim cosim") != 0 || strcmp(own->setting, alone->setting) != 0 ||
                !isfinite(ratio))
                continue;
            fprintf(file, "%s %s: x %.3g (least times x %.3g)",
                    any ? ";" : "\nAgainst ngspice alone with fixed capacitors, same tolerances:", own->setting, ratio,
                    least);
            any = true;
        }
    }
    if (any)
        fputs(".\n", file);
}

void write_tables(const struct bench *bench, FILE *file) {
    fprintf(file, "\n## %s: %s\n\nReference: A = %g", bench->entry->name, bench->entry->title,
            bench->reference_accuracy);
    if (bench->entry->twin != NULL)
        fputs(" on native sources", file);
    if (isfinite(bench->reference_doubt))
        fprintf(file, "; the run at ten times that differs by %.1e", bench->reference_doubt);
    fprintf(file, ". Least time of the runs for an error of at most the column's head; x: times %s.\n",
            own_curve(bench));
    write_times(bench, file, false);
    write_times(bench, file, true);
    write_overhead(bench, file);
    write_failures(bench, file);
}
