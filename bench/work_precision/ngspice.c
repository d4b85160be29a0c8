/* Plain ngspice on the exported deck, over a grid of its options; and co-simulation with a fixed exchange interval. */
#include "work_precision.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#define FIXED_SHARE 0.12 /* of a scene's time */
#define GRID_SHARE 0.4

/* ---- decks ---- */

struct grid_point {
    double reltol, trtol, longest_step;
    const char *method;
};

/* Lines of the exported deck that the grid replaces. */
static bool is_replaced(const char *line) {
    static const char *const replaced[] = {".tran", ".save", ".print", ".meas", ".end\n", ".options acct"};
    for (size_t i = 0; i < sizeof replaced / sizeof replaced[0]; i++)
        if (strncasecmp(line, replaced[i], strlen(replaced[i])) == 0)
            return true;
    return false;
}

static bool write_deck(const struct bench *bench, const char *from, const char *to, const struct grid_point *grid,
                       double stop) {
    FILE *in = fopen(from, "r"), *out = fopen(to, "w");
    char *line = NULL;
    size_t room = 0;
    bool dropping = false;
    while (in != NULL && out != NULL && getline(&line, &room, in) >= 0) {
        if (line[0] != '+')
            dropping = is_replaced(line);
        if (!dropping)
            fputs(line, out);
    }
    free(line);
    if (in != NULL)
        fclose(in);
    if (out == NULL)
        return false;
    fprintf(out, ".options acct reltol=%g trtol=%g method=%s\n.save", grid->reltol, grid->trtol, grid->method);
    for (int i = 0; i < bench->signal_count; i++)
        fprintf(out, " %s", bench->nodes[i]);
    if (stop > 0.0)
        fprintf(out, "\n.tran %.17g %.17g 0 %.17g\n.end\n", fmin(grid->longest_step, stop), stop, grid->longest_step);
    return fclose(out) == 0;
}

/* ---- runs ---- */

/* Counters that `.options acct` prints. */
void ngspice_read_output(struct point *point) {
    FILE *file = fopen(point->output, "r");
    char line[256];
    double number;
    while (file != NULL && fgets(line, sizeof line, file) != NULL) {
        if (sscanf(line, "Total iterations = %lf", &number) == 1)
            point->iterations = number;
        else if (sscanf(line, "Accepted timepoints = %lf", &number) == 1)
            point->points = number;
        else if (sscanf(line, "Total analysis time (seconds) = %lf", &number) == 1)
            point->own = fmin(point->own, number);
    }
    if (file != NULL)
        fclose(file);
}

static double run_grid_point(struct bench *bench, const char *deck, const struct grid_point *grid) {
    char variant[PATH_ROOM + 64], raw[PATH_ROOM + 64];
    struct point *point = bench_add_point(bench, "ngspice", "reltol=%g trtol=%g %s step<=%g", grid->reltol, grid->trtol,
                                          grid->method, grid->longest_step);
    snprintf(variant, sizeof variant, "%s/ngspice-%zu.cir", bench->folder, bench->point_count);
    snprintf(raw, sizeof raw, "%s/ngspice-%zu.raw", bench->folder, bench->point_count);
    snprintf(point->output, sizeof point->output, "%.900s/ngspice-%zu.txt", bench->folder, bench->point_count);
    if (!write_deck(bench, deck, variant, grid, bench->stop)) {
        point_fail(point, "no deck");
        return INFINITY;
    }
    point_set_command(point, (const char *const[]){"ngspice", "-n", "-b", "-r", raw, variant, NULL});
    struct process_result result = process_run(point->arguments, point->output, bench->limit);
    struct trace trace = {0};
    point->cpu = result.cpu;
    ngspice_read_output(point);
    if (result.timed_out)
        point_blame(point, &result);
    else if (!trace_read_raw(raw, bench->nodes, bench->signal_count, 1e-3, &trace))
        point_blame(point, &result);
    else
        point->error = trace_compare(&trace, &bench->reference);
    if (trace.count > 0 && !isfinite(point->error.x))
        point_fail(point, "gave up at t = %.4g s", trace.time[trace.count - 1]);
    trace_clear(&trace);
    remove(raw);
    return result.cpu;
}

static bool export_deck(const struct bench *bench, char *deck, size_t size) {
    snprintf(deck, size, "%s/exported.cir", bench->folder);
    char program[PATH_ROOM], scene[PATH_ROOM], verb[] = "export", flag[] = "-o";
    snprintf(program, sizeof program, "%s", bench->program);
    snprintf(scene, sizeof scene, "%s", bench->entry->scene);
    char *arguments[] = {program, verb, scene, flag, deck, NULL};
    return process_run(arguments, NULL, bench->limit).good;
}

/* A deck that ends with its operating point: a transient of next to no span may take ngspice very long. */
static void set_start(struct bench *bench, const char *deck) {
    struct grid_point grid = {1e-3, 7.0, bench->entry->longest_step, "trap"};
    char variant[PATH_ROOM + 64], raw[PATH_ROOM + 64];
    snprintf(variant, sizeof variant, "%s/ngspice-start.cir", bench->folder);
    snprintf(raw, sizeof raw, "%s/ngspice-start.raw", bench->folder);
    if (write_deck(bench, deck, variant, &grid, 0.0))
        bench_set_start(bench, "ngspice", (const char *const[]){"ngspice", "-n", "-b", "-r", raw, variant, NULL},
                        INFINITY);
}

/* Settings of the grid from cheap to dear, so that it can end when its time is up: tolerances and longest step are
 * tightened together. What took long is not tried with a shorter step. */
void ngspice_curve(struct bench *bench) {
    static const double reltols[] = {1e-3, 1e-4, 1e-5, 1e-6}, trtols[] = {7.0, 1.0};
    static const char *const methods[] = {"trap", "gear"};
    enum { RELTOLS = 4, TRTOLS = 2, METHODS = 2, STEPS = 5, SETTINGS = RELTOLS * TRTOLS * METHODS };
    char deck[PATH_ROOM + 16];
    double cpu[SETTINGS] = {0.0};
    if (!export_deck(bench, deck, sizeof deck)) {
        point_fail(bench_add_point(bench, "ngspice", "export"), "deasim export refuses the scene");
        return;
    }
    set_start(bench, deck);
    double deadline = bench_deadline(bench, GRID_SHARE);
    for (int level = 0; level < STEPS + RELTOLS - 1; level++) {
        for (int g = 0; g < SETTINGS; g++) {
            int m = g / (RELTOLS * TRTOLS), r = g / TRTOLS % RELTOLS, s = level - r;
            struct grid_point grid = {reltols[r], trtols[g % TRTOLS], bench->entry->longest_step * pow(0.2, s),
                                      methods[m]};
            if (s < 0 || s >= STEPS || cpu[g] > 0.3 * bench->limit || (bench->quick && (m > 0 || r == 1 || r == 3)))
                continue;
            if (is_late(deadline))
                bench->grid_left_out++;
            else
                cpu[g] = run_grid_point(bench, deck, &grid);
        }
    }
    choose_front(bench, "ngspice");
}

/* ---- the electronics alone ---- */

/* Path of a program beside deasim: build/release/bench/NAME. */
static void find_program(const struct bench *bench, const char *name, char *path, size_t size) {
    const char *slash = strrchr(bench->program, '/');
    int folder = slash != NULL ? (int)(slash - bench->program) : 1;
    snprintf(path, size, "%.*s/bench/%s", folder, slash != NULL ? bench->program : ".", name);
}

void fixed_capacitor_curve(struct bench *bench) {
    char program[PATH_ROOM], scene[PATH_ROOM], accuracy[32], deck[PATH_ROOM + 64], raw[PATH_ROOM + 64];
    find_program(bench, "fixed_capacitor", program, sizeof program);
    snprintf(scene, sizeof scene, "%s", bench->entry->scene);
    for (double exponent = bench->entry->loosest; exponent <= fmin(bench->entry->tightest, 4.0); exponent += 1.0) {
        snprintf(accuracy, sizeof accuracy, "%g", pow(10.0, -exponent));
        struct point *point = bench_add_point(bench, "fixed capacitor", "A=%s", accuracy);
        snprintf(deck, sizeof deck, "%s/capacitor-%s.cir", bench->folder, accuracy);
        snprintf(raw, sizeof raw, "%s/capacitor.raw", bench->folder);
        snprintf(point->output, sizeof point->output, "%.900s/capacitor-%s.txt", bench->folder, accuracy);
        char *arguments[] = {program, scene, accuracy, deck, NULL};
        if (!process_run(arguments, NULL, bench->limit).good) {
            point_fail(point, "no deck");
            continue;
        }
        point_set_command(point, (const char *const[]){"ngspice", "-n", "-b", "-r", raw, deck, NULL});
        point->chosen = true;
    }
}

/* ---- fixed exchange ---- */

static void read_counts(struct point *point, const char *path) {
    FILE *file = fopen(path, "r");
    if (file == NULL)
        return;
    if (fscanf(file, "%lf %lf %lf", &point->points, &point->iterations, &point->work) != 3)
        point->points = point->iterations = point->work = NAN;
    fclose(file);
}

static double run_fixed_exchange(struct bench *bench, char *program, double accuracy, double step) {
    char interval[32], tolerance[32], stop[32], table[PATH_ROOM + 64], counts[PATH_ROOM + 64];
    struct point *point = bench_add_point(bench, "fixed exchange", "every %.3g s; circuit A=%g", step, accuracy);
    snprintf(interval, sizeof interval, "%.17g", step);
    snprintf(tolerance, sizeof tolerance, "%g", accuracy);
    snprintf(table, sizeof table, "%s/fixed-%zu.txt", bench->folder, bench->point_count);
    snprintf(counts, sizeof counts, "%s/fixed-%zu.counts", bench->folder, bench->point_count);
    snprintf(stop, sizeof stop, "%.17g", step);
    bench_set_start(bench, "fixed exchange",
                    (const char *const[]){program, bench->entry->scene, tolerance, interval, stop, "/dev/null", NULL},
                    INFINITY);
    snprintf(stop, sizeof stop, "%.17g", bench->stop);
    point_set_command(point,
                      (const char *const[]){program, bench->entry->scene, tolerance, interval, stop, table, NULL});
    struct process_result result = process_run(point->arguments, counts, bench->limit);
    struct trace trace = {0};
    point->cpu = result.cpu;
    if (!result.good || !trace_read_table(table, bench->signal_count, &trace))
        point_blame(point, &result);
    else
        point->error = trace_compare(&trace, &bench->reference);
    if (trace.count > 0 && !isfinite(point->error.x))
        point_fail(point, "did not reach the end");
    trace_clear(&trace);
    read_counts(point, counts);
    return result.cpu;
}

/* Intervals from a hundredth of the span down, each with loose and with tight tolerances of the circuit. */
void fixed_exchange_curve(struct bench *bench) {
    static const double accuracies[] = {1e-2, 1e-3, 1e-4};
    enum { ACCURACIES = 3 };
    char program[PATH_ROOM];
    double cpu[ACCURACIES] = {0.0};
    find_program(bench, "fixed_exchange", program, sizeof program);
    double deadline = bench_deadline(bench, FIXED_SHARE);
    for (int s = 0; s < (bench->quick ? 4 : 7); s++)
        for (int a = 0; a < ACCURACIES; a++)
            if (cpu[a] < 0.5 * bench->limit && !is_late(deadline))
                cpu[a] = run_fixed_exchange(bench, program, accuracies[a], bench->stop / 100.0 * pow(10.0, -0.5 * s));
    choose_front(bench, "fixed exchange");
}
