/* Plain ngspice on the exported deck, over a grid of its options; and co-simulation with a fixed exchange interval. */
#include "work_precision.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

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

static bool write_deck(const struct bench *bench, const char *from, const char *to, const struct grid_point *grid) {
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
    fprintf(out, "\n.tran %.17g %.17g 0 %.17g\n.end\n", grid->longest_step, bench->stop, grid->longest_step);
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
            point->inner = fmin(point->inner, number);
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
    if (!write_deck(bench, deck, variant, grid)) {
        point_fail(point, "no deck");
        return INFINITY;
    }
    point_set_command(point, (const char *const[]){"ngspice", "-n", "-b", "-r", raw, variant, NULL});
    struct process_result result = process_run(point->arguments, point->output, bench->limit);
    struct trace trace = {0};
    point->walls[0] = result.wall;
    ngspice_read_output(point);
    if (result.timed_out)
        point_fail(point, "took more than %g s", bench->limit);
    else if (!trace_read_raw(raw, bench->nodes, bench->signal_count, 1e-3, &trace))
        point_fail(point, "no result");
    else
        point->error = trace_compare(&trace, &bench->reference);
    if (trace.count > 0 && !isfinite(point->error.x))
        point_fail(point, "gave up at t = %.4g s", trace.time[trace.count - 1]);
    trace_clear(&trace);
    remove(raw);
    return result.wall;
}

static bool export_deck(const struct bench *bench, char *deck, size_t size) {
    snprintf(deck, size, "%s/exported.cir", bench->folder);
    char program[PATH_ROOM], scene[PATH_ROOM], verb[] = "export", flag[] = "-o";
    snprintf(program, sizeof program, "%s", bench->program);
    snprintf(scene, sizeof scene, "%s", bench->entry->scene);
    char *arguments[] = {program, verb, scene, flag, deck, NULL};
    return process_run(arguments, NULL, bench->limit).good;
}

void ngspice_curve(struct bench *bench) {
    static const double reltols[] = {1e-3, 1e-4, 1e-5, 1e-6}, trtols[] = {7.0, 1.0};
    static const char *const methods[] = {"trap", "gear"};
    char deck[PATH_ROOM + 16];
    if (!export_deck(bench, deck, sizeof deck)) {
        point_fail(bench_add_point(bench, "ngspice", "export"), "deasim export refuses the scene");
        return;
    }
    for (int m = 0; m < (bench->quick ? 1 : 2); m++) {
        for (int r = 0; r < 4; r++) {
            for (int t = 0; t < 2; t++) {
                struct grid_point grid = {reltols[r], trtols[t], bench->entry->longest_step, methods[m]};
                for (int s = 0; s < 4; s++, grid.longest_step /= 5.0)
                    if (run_grid_point(bench, deck, &grid) > 0.3 * bench->limit)
                        break;
            }
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
        char *arguments[] = {program, scene, accuracy, deck, NULL};
        if (!process_run(arguments, NULL, bench->limit).good) {
            point_fail(point, "no deck");
            continue;
        }
        point_set_command(point, (const char *const[]){"ngspice", "-n", "-b", "-r", raw, deck, NULL});
        point->walls[0] = process_run(point->arguments, NULL, bench->limit).wall;
        point->chosen = true;
    }
}

/* ---- fixed exchange ---- */

void fixed_exchange_curve(struct bench *bench) {
    char program[PATH_ROOM], interval[32], table[PATH_ROOM + 64], counts[PATH_ROOM + 64];
    find_program(bench, "fixed_exchange", program, sizeof program);
    double longest = bench->stop / 100.0;
    for (int s = 0; s < (bench->quick ? 3 : 6); s++) {
        double step = longest * pow(10.0, -0.5 * (s + 1));
        struct point *point = bench_add_point(bench, "fixed exchange", "every %.3g s", step);
        snprintf(interval, sizeof interval, "%.17g", step);
        snprintf(table, sizeof table, "%s/fixed-%d.txt", bench->folder, s);
        snprintf(counts, sizeof counts, "%s/fixed-%d.counts", bench->folder, s);
        point_set_command(point, (const char *const[]){program, bench->entry->scene, interval, table, NULL});
        struct process_result result = process_run(point->arguments, counts, bench->limit);
        struct trace trace = {0};
        point->walls[0] = result.wall;
        if (!result.good || !trace_read_table(table, bench->signal_count, &trace)) {
            point_fail(point, "%s", result.timed_out ? "took too long" : "the run failed");
            continue;
        }
        point->error = trace_compare(&trace, &bench->reference);
        if (!isfinite(point->error.x))
            point_fail(point, "did not reach the end");
        trace_clear(&trace);
        FILE *file = fopen(counts, "r");
        if (file != NULL) {
            if (fscanf(file, "%lf %lf %lf", &point->points, &point->iterations, &point->work) != 3)
                point->points = NAN;
            fclose(file);
        }
        point->chosen = true;
    }
}
