/* The summary a person reads: one screen, field units, aligned. */
#include "output_internal.h"

#include "deasim/quantity.h"

#include <math.h>
#include <string.h>

#define EVENTS_SHOWN 10
#define DUST 1e-9 /* of a signal's largest value */
#define TEXT 32   /* bytes of a formatted value */

/* As people of the field write it; a field in V/um is what breakdown strengths are quoted in. */
static const char *format_value(double value, const char *unit, char buffer[TEXT]) {
    if (!isfinite(value))
        snprintf(buffer, TEXT, "-");
    else if (strcmp(unit, "V/m") == 0)
        snprintf(buffer, TEXT, "%.4g V/um", value * 1e-6);
    else
        dea_quantity_format(value, unit, buffer, TEXT);
    return buffer;
}

/* ---- table of signals ---- */

enum { MIN, MAX, FINAL, AT_MAX, COLUMNS };

/* What is lost in rounding beside the signal's range is shown as 0. */
static double drop_dust(double value, const struct dea_signal_stats *stats) {
    double largest = fmax(fabs(stats->min), fabs(stats->max));
    return fabs(value) < DUST * largest ? 0.0 : value;
}

static void format_row(const struct dea_signal *signal, const struct dea_signal_stats *stats,
                       char cells[COLUMNS][TEXT]) {
    format_value(drop_dust(stats->min, stats), signal->unit, cells[MIN]);
    format_value(drop_dust(stats->max, stats), signal->unit, cells[MAX]);
    format_value(drop_dust(stats->final, stats), signal->unit, cells[FINAL]);
    format_value(stats->t_max, "s", cells[AT_MAX]);
}

static void print_signals(const struct dea_result *result, FILE *file) {
    static const char *const heads[COLUMNS] = {"min", "max", "final", "max at"};
    if (result->signal_count == 0)
        return;
    int name_width = 6, widths[COLUMNS];
    for (int c = 0; c < COLUMNS; c++)
        widths[c] = (int)strlen(heads[c]);
    char cells[COLUMNS][TEXT];
    for (size_t i = 0; i < result->signal_count; i++) {
        format_row(&result->signals[i], &result->stats[i], cells);
        int length = (int)strlen(result->signals[i].name);
        name_width = length > name_width ? length : name_width;
        for (int c = 0; c < COLUMNS; c++)
            widths[c] = (int)strlen(cells[c]) > widths[c] ? (int)strlen(cells[c]) : widths[c];
    }
    fprintf(file, "\n  %-*s", name_width, "signal");
    for (int c = 0; c < COLUMNS; c++)
        fprintf(file, "  %*s", widths[c], heads[c]);
    fputc('\n', file);
    for (size_t i = 0; i < result->signal_count; i++) {
        format_row(&result->signals[i], &result->stats[i], cells);
        fprintf(file, "  %-*s", name_width, result->signals[i].name);
        for (int c = 0; c < COLUMNS; c++)
            fprintf(file, "  %*s", widths[c], cells[c]);
        fputc('\n', file);
    }
}

static void print_measures(const struct dea_result *result, FILE *file) {
    if (result->measure_count == 0)
        return;
    int width = 7;
    for (size_t i = 0; i < result->measure_count; i++) {
        int length = (int)strlen(result->measures[i].name);
        width = length > width ? length : width;
    }
    fprintf(file, "\n  %-*s  value\n", width, "measure");
    for (size_t i = 0; i < result->measure_count; i++) {
        const struct dea_netlist_measure *measure = &result->measures[i];
        if (measure->failed)
            fprintf(file, "  %-*s  failed\n", width, measure->name);
        else
            fprintf(file, "  %-*s  %.6g\n", width, measure->name, measure->value);
    }
}

/* ---- events ---- */

static void print_events(const struct dea_scene *scene, const struct dea_result *result, FILE *file) {
    size_t count = result->event_count + result->event_dropped;
    size_t shown = result->event_count < EVENTS_SHOWN ? result->event_count : EVENTS_SHOWN;
    if (count == 0) {
        fprintf(file, "\n  events    none\n");
        return;
    }
    fprintf(file, "\n  events    %zu", count);
    fprintf(file, shown < count ? ", the first %zu:\n" : "\n", shown);
    for (size_t i = 0; i < shown; i++) {
        const struct dea_event *event = &result->events[i];
        char time[TEXT];
        fprintf(file, "    %12s  ", format_value(event->time, "s", time));
        if (scene->device_count > 1)
            fprintf(file, "%s.", scene->devices[event->device].name);
        fprintf(file, "%s %s%s\n", dea_event_zone(event), dea_event_names[event->kind], event->cleared ? " over" : "");
    }
}

/* ---- energy and coupling ---- */

/* "(branches 1.2 uJ, damping 3 uJ)": the parts that are not zero. */
static void print_parts(const char *const names[], const double values[], int count, FILE *file) {
    bool any = false;
    for (int i = 0; i < count; i++) {
        char text[TEXT];
        if (values[i] == 0.0)
            continue;
        fprintf(file, "%s%s %s", any ? ", " : "  (", names[i], format_value(values[i], "J", text));
        any = true;
    }
    fputs(any ? ")\n" : "\n", file);
}

static void print_energy(const struct dea_energy *energy, FILE *file) {
    static const char *const supplies[] = {"electrical", "load"};
    static const char *const losses[] = {"branches", "damping", "resistances", "leakage", "end stops"};
    char in[TEXT], stored[TEXT], dissipated[TEXT], exchanged[TEXT];
    fprintf(file, "\n  energy    in          %10s", format_value(energy->in, "J", in));
    print_parts(supplies, (const double[]){energy->electrical, energy->load}, 2, file);
    fprintf(file, "            stored      %10s\n", format_value(energy->stored, "J", stored));
    fprintf(file, "            dissipated  %10s", format_value(energy->dissipated, "J", dissipated));
    print_parts(losses,
                (const double[]){energy->branch, energy->damping, energy->resistive, energy->leakage, energy->stop}, 5,
                file);
    fprintf(file, "            imbalance   %10.2g  of %s exchanged\n", energy->imbalance,
            format_value(energy->exchanged, "J", exchanged));
}

static void print_statistics(const struct dea_result *result, FILE *file) {
    const struct dea_run_stats *stats = &result->stats_run;
    if (result->sensitivity >= DEA_SENSITIVE)
        fprintf(file, "  errors    grow %.3g times with the motion (accuracy may not be as asked)\n",
                result->sensitivity);
    if (stats->circuit_points > 0) {
        fprintf(file, "  coupling  error       %10.2g%s\n", result->coupling_error,
                result->relaxed > 0 ? "  (circuit tolerances loosened: accuracy not as asked)" : "");
        fprintf(file, "  circuit   %ld points, %ld rejected\n", stats->circuit_points, stats->circuit_rejected);
    }
    if (stats->plant_steps > 0)
        fprintf(file, "  device    %ld steps, %ld residuals, %ld Jacobians, %ld restarts\n", stats->plant_steps,
                stats->residuals, stats->jacobians, stats->restarts);
}

void dea_summary_print(const struct dea_scene *scene, const struct dea_result *result, FILE *file) {
    char t_end[TEXT], wall[TEXT];
    const char *title = scene->title != NULL && scene->title[0] != '\0' ? scene->title : scene->path;
    fprintf(file, "%s: %s at %s (%s, %s of computing)\n", title != NULL ? title : "scene",
            dea_outcome_text(result->status), format_value(result->t_end, "s", t_end),
            result->stats_run.mode[0] != '\0' ? result->stats_run.mode : "-",
            format_value(result->stats_run.wall_s, "s", wall));
    if (result->reason[0] != '\0')
        fprintf(file, "  %s\n", result->reason);
    print_signals(result, file);
    print_measures(result, file);
    print_events(scene, result, file);
    print_energy(&result->energy, file);
    print_statistics(result, file);
}
