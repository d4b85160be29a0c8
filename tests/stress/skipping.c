/* What leaving out the needless spares: the pairs of support/skipped.h, work and time with and without.
 * Usage: stress_skipping [CSV] */
#include "skipped.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <sys/resource.h>

/* Rows of a run; many where they are what is skipped. */
enum { ROWS = 1000, MANY_ROWS = 100000, REPEATS = 5 };

/* Processor time of this process and of its children so far, s: other work on the machine hardly shows in it. */
static double used_time(void) {
    double sum = 0.0;
    const int whose[] = {RUSAGE_SELF, RUSAGE_CHILDREN};
    for (int i = 0; i < 2; i++) {
        struct rusage usage;
        if (getrusage(whose[i], &usage) == 0)
            sum += (double)(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec) +
                   1e-6 * (double)(usage.ru_utime.tv_usec + usage.ru_stime.tv_usec);
    }
    return sum;
}

/* The same work each time, the least time. */
static void measure(const struct skipped *pair, bool lean, struct dea_run_stats *stats) {
    double least = INFINITY;
    for (int i = 0; i < REPEATS; i++) {
        struct coupled_rows rows;
        double before = used_time();
        run_skipped(pair, lean, pair->way == SKIPPED_SIGNALS ? MANY_ROWS : ROWS, &rows);
        least = fmin(least, used_time() - before);
        if (rows.status != DEA_OK)
            fprintf(stderr, "%s: %s\n", pair->name, rows.error.text);
        *stats = rows.result.stats_run;
        stats->wall_s = least;
        free_rows(&rows);
    }
}

static void print_pair(FILE *csv, const struct skipped *pair) {
    struct dea_run_stats lean, full;
    measure(pair, true, &lean);
    measure(pair, false, &full);
    printf("%-15s %-19s %8ld %8ld %8ld %8ld %8ld %8ld %9.1f %9.1f %6.1f\n", skipped_ways[pair->way], pair->name,
           full.circuit_points, lean.circuit_points, full.plant_steps, lean.plant_steps, full.residuals, lean.residuals,
           1e3 * full.wall_s, 1e3 * lean.wall_s, full.wall_s / lean.wall_s);
    fflush(stdout);
    if (csv != NULL)
        fprintf(csv, "%s,%s,%g,%ld,%ld,%ld,%ld,%ld,%ld,%.1f,%.1f,%.2f\n", skipped_ways[pair->way], pair->name,
                pair->accuracy, full.circuit_points, lean.circuit_points, full.plant_steps, lean.plant_steps,
                full.residuals, lean.residuals, 1e3 * full.wall_s, 1e3 * lean.wall_s, full.wall_s / lean.wall_s);
}

int main(int argc, char **argv) {
    FILE *csv = argc > 1 ? fopen(argv[1], "w") : NULL;
    if (argc > 1 && csv == NULL) {
        perror(argv[1]);
        return 1;
    }
    if (csv != NULL)
        fputs(
            "skip,scene,accuracy,points_without,points_with,steps_without,steps_with,residuals_without,residuals_with,"
            "ms_without,ms_with,time_ratio\n",
            csv);
    printf("%-15s %-19s %17s %17s %17s %19s %6s\n", "", "", "circuit points", "device steps", "residual calls", "ms",
           "");
    printf("%-15s %-19s %8s %8s %8s %8s %8s %8s %9s %9s %6s\n", "skip", "scene", "without", "with", "without", "with",
           "without", "with", "without", "with", "ratio");
    struct test_folder folder;
    size_t count;
    const struct skipped *pairs = list_skipped(&count);
    enter_folder(&folder);
    for (size_t i = 0; i < count; i++)
        print_pair(csv, &pairs[i]);
    leave_folder(&folder);
    return csv != NULL && fclose(csv) != 0;
}
