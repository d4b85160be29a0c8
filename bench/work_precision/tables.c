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

/* A comma or a bar would end the field. */
static void write_text(FILE *file, const char *text) {
    for (; *text != '\0'; text++)
        fputc(*text == ',' || *text == '|' ? ';' : *text, file);
}

void write_rows(const struct bench *bench, FILE *file) {
    fputs("scene,curve,setting,error_x,error_ports,error,wall_median_s,wall_least_s,runs,cpu_s,solve_s,own_s,"
          "circuit_points,newton_iterations,residual_calls,timed,problem\n",
          file);
    for (size_t i = 0; i < bench->point_count; i++) {
        const struct point *p = &bench->points[i];
        fprintf(file, "%s,%s,", bench->entry->name, p->curve);
        write_text(file, p->setting);
        const double numbers[] = {p->error.x,
                                  p->error.ports,
                                  point_error(p),
                                  point_whole_median(bench, p),
                                  point_whole(bench, p),
                                  (double)p->wall_count,
                                  p->cpu,
                                  point_solve(bench, p),
                                  p->own,
                                  p->points,
                                  p->iterations,
                                  p->work};
        for (size_t n = 0; n < sizeof numbers / sizeof numbers[0]; n++)
            write_number(file, numbers[n]);
        fprintf(file, ",%d,", p->chosen && p->wall_count > 0);
        write_text(file, p->problem);
        fputc('\n', file);
    }
}

/* ---- tables ---- */

static const char *const curves[] = {"deasim native",  "deasim linear", "deasim cosim", "ngspice",
                                     "fixed exchange", "scipy LSODA",   "scipy Radau",  "octave ode15s"};
static const double errors[] = {1e-2, 1e-3, 1e-4, 1e-5, 1e-6};

enum { CURVES = sizeof curves / sizeof curves[0], ERRORS = sizeof errors / sizeof errors[0] };

static void write_seconds(FILE *file, double seconds) {
    if (seconds < 1.5 * SMALLEST_DIFFERENCE)
        fputs("< 0.3 ms", file);
    else if (seconds < 1.0)
        fprintf(file, "%.3g ms", 1e3 * seconds);
    else
        fprintf(file, "%.3g s", seconds);
}

static void write_factor(FILE *file, double factor) {
    if (factor < 99.5)
        fprintf(file, "x %.2g", factor);
    else
        fprintf(file, "x %.0f", factor);
}

static void write_times(const struct bench *bench, FILE *file, enum time_kind kind) {
    fprintf(file, "\n| %s |", kind == TIME_SOLVING ? "solving alone" : "whole process");
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
            double time = curve_time(bench, curves[c], errors[e], kind);
            double ratio = time / curve_time(bench, own, errors[e], kind);
            fputc(' ', file);
            if (isfinite(time))
                write_seconds(file, time);
            else
                fputc('-', file);
            if (isfinite(ratio) && strcmp(curves[c], own) != 0) {
                fputs(", ", file);
                write_factor(file, ratio);
            }
            fputs(" |", file);
        }
        fputc('\n', file);
    }
}

#define MOST_FAILURES 12

static void write_failures(const struct bench *bench, FILE *file) {
    int failed = 0, listed = 0;
    for (size_t i = 0; i < bench->point_count; i++)
        failed += bench->points[i].problem[0] != '\0';
    if (failed == 0)
        return;
    fprintf(file, "\nFailures (%d of %zu points):\n", failed, bench->point_count);
    for (size_t i = 0; i < bench->point_count && listed < MOST_FAILURES; i++)
        if (bench->points[i].problem[0] != '\0') {
            fprintf(file, "\n- %s, %s: ", bench->points[i].curve, bench->points[i].setting);
            write_text(file, bench->points[i].problem);
            listed++;
        }
    if (failed > listed)
        fprintf(file, "\n- and %d more, all in the CSV", failed - listed);
    fputc('\n', file);
}

/* What is known of the reference from elsewhere. */
static void write_reference(const struct bench *bench, FILE *file) {
    fprintf(file, "Reference: deasim at A = %g", bench->reference_accuracy);
    if (bench->entry->twin != NULL)
        fputs(" on native sources", file);
    if (isfinite(bench->reference_doubt))
        fprintf(file, "; its run at ten times that differs by %.1e", bench->reference_doubt);
    if (isfinite(bench->reference_second))
        fprintf(file, ", LSODA of scipy at 1e-12 by %.1e", bench->reference_second);
    double ngspice = curve_least_error(bench, "ngspice");
    if (isfinite(ngspice))
        fprintf(file, ", the closest of plain ngspice by %.1e", ngspice);
    fputs(".\n", file);
    if (bench->grid_left_out > 0)
        fprintf(file, "There was no time for %d finer settings of ngspice's grid.\n", bench->grid_left_out);
}

void write_section(const struct bench *bench, FILE *file) {
    if (bench->entry->only_overhead)
        return;
    fprintf(file, "### %s\n\n", bench->entry->title);
    write_reference(bench, file);
    fprintf(file, "\n![error against time and work](performance/%s.png)\n", bench->entry->name);
    write_times(bench, file, TIME_WHOLE);
    write_times(bench, file, TIME_SOLVING);
    write_failures(bench, file);
    fputc('\n', file);
}

/* ---- among the scenes ---- */

static void write_summary_factor(const struct bench *bench, FILE *file, const char *const *names, double error) {
    const char *own = own_curve(bench);
    double least[2] = {NAN, NAN};
    for (int k = 0; k < 2; k++)
        for (int i = 0; names[i] != NULL; i++)
            least[k] = fmin(least[k], curve_time(bench, names[i], error, k == 0 ? TIME_SOLVING : TIME_WHOLE) /
                                          curve_time(bench, own, error, k == 0 ? TIME_SOLVING : TIME_WHOLE));
    if (isfinite(least[0]) && isfinite(least[1])) {
        fputc(' ', file);
        write_factor(file, least[0]);
        fputs(" (", file);
        write_factor(file, least[1]);
        fputs(") |", file);
    } else {
        fputs(" - |", file);
    }
}

/* | scene | way | deasim at 1e-3 | ngspice at 1e-2, 1e-3, 1e-4 | fixed exchange at 1e-2, 1e-3 | scripts at 1e-4 | */
void write_summary(const struct bench *bench, FILE *file) {
    if (bench->entry->only_overhead)
        return;
    const char *own = own_curve(bench);
    double solving = curve_time(bench, own, 1e-3, TIME_SOLVING), whole = curve_time(bench, own, 1e-3, TIME_WHOLE);
    fprintf(file, "| %s | %s | ", bench->entry->title, own + strlen("deasim "));
    if (isfinite(whole)) {
        write_seconds(file, solving);
        fputs(" (", file);
        write_seconds(file, whole);
        fputs(") |", file);
    } else {
        fputs("- |", file);
    }
    const char *const ngspice[] = {"ngspice", NULL}, *const fixed[] = {"fixed exchange", NULL},
                      *const scripts[] = {"scipy LSODA", "scipy Radau", "octave ode15s", NULL};
    for (int e = 0; e < 3; e++)
        write_summary_factor(bench, file, ngspice, errors[e]);
    for (int e = 0; e < 2; e++)
        write_summary_factor(bench, file, fixed, errors[e]);
    write_summary_factor(bench, file, scripts, 1e-4);
    fputc('\n', file);
}

static void write_overhead_row(const struct bench *bench, FILE *file, const struct point *own,
                               const struct point *alone) {
    fprintf(file, "| %s | %s | ", bench->entry->title, own->setting);
    write_seconds(file, point_least(own));
    fputs(" | ", file);
    write_seconds(file, point_least(alone));
    fprintf(file, " | %.3g | %.3g | %.0f | %.0f | %.3g | %.2f |\n", point_least(own) / point_least(alone),
            point_median(own) / point_median(alone), own->points, alone->points, own->points / alone->points,
            own->iterations / alone->iterations);
}

void write_overhead(const struct bench *bench, FILE *file) {
    for (size_t i = 0; i < bench->point_count; i++)
        for (size_t j = 0; j < bench->point_count; j++) {
            const struct point *alone = &bench->points[i], *own = &bench->points[j];
            if (strcmp(alone->curve, "fixed capacitor") == 0 && strcmp(own->curve, "deasim cosim") == 0 &&
                strcmp(own->setting, alone->setting) == 0 && own->wall_count > 0 && alone->wall_count > 0)
                write_overhead_row(bench, file, own, alone);
        }
}
