/* usage: work_precision PROGRAM FOLDER RESULTS TABLES quick|full [SCENE...]
 * Measures the scenes with the program; scratch files go to FOLDER, rows to RESULTS (CSV), tables to TABLES. Runs from
 * the top of the tree. */
#include "work_precision.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

/* All timed points in turn, several times: what else the machine does then meets all of them alike. */
static void time_points(struct bench *bench) {
    for (int round = 0; round < bench->rounds; round++) {
        for (size_t i = 0; i < bench->point_count; i++) {
            struct point *point = &bench->points[i];
            if (!point->chosen || point->arguments[0] == NULL)
                continue;
            struct process_result result =
                process_run(point->arguments, point->output[0] != '\0' ? point->output : NULL, bench->limit);
            if (strncmp(point->curve, "deasim", 6) == 0)
                deasim_read_output(point);
            else if (strcmp(point->curve, "ngspice") == 0)
                ngspice_read_output(point);
            if (result.timed_out)
                continue;
            if (round == 0)
                point->wall_count = 0;
            point->walls[point->wall_count++] = result.wall;
            point->cpu = round == 0 ? result.cpu : fmin(point->cpu, result.cpu);
        }
    }
}

static void free_points(struct bench *bench) {
    for (size_t i = 0; i < bench->point_count; i++)
        for (int a = 0; bench->points[i].arguments[a] != NULL; a++)
            free(bench->points[i].arguments[a]);
    free(bench->points);
}

static bool measure_scene(struct bench *bench) {
    const struct scene_entry *entry = bench->entry;
    if (mkdir(bench->folder, 0777) != 0 && errno != EEXIST) {
        fprintf(stderr, "cannot make %s: %s\n", bench->folder, strerror(errno));
        return false;
    }
    if (!deasim_prepare(bench) || !deasim_reference(bench))
        return false;
    if (entry->circuit) {
        deasim_curve(bench, entry->scene, "deasim cosim", "ngspice");
        if (entry->linear)
            deasim_curve(bench, entry->scene, "deasim linear", "auto");
        fixed_exchange_curve(bench);
        if (!entry->linear)
            fixed_capacitor_curve(bench);
    }
    if (!entry->circuit || entry->twin != NULL)
        deasim_curve(bench, entry->twin != NULL ? entry->twin : entry->scene, "deasim native", "native");
    if (entry->exports)
        ngspice_curve(bench);
    if (entry->ode)
        script_curves(bench);
    time_points(bench);
    return true;
}

static bool is_wanted(const char *name, char *const *wanted, int count) {
    for (int i = 0; i < count; i++)
        if (strcmp(wanted[i], name) == 0)
            return true;
    return count == 0;
}

int main(int count, char **arguments) {
    if (count < 6) {
        fprintf(stderr, "usage: work_precision PROGRAM FOLDER RESULTS TABLES quick|full [SCENE...]\n");
        return 2;
    }
    bool quick = strcmp(arguments[5], "quick") == 0, good = true;
    FILE *rows = fopen(arguments[3], "w"), *tables = fopen(arguments[4], "w");
    if (rows == NULL || tables == NULL) {
        fprintf(stderr, "cannot write %s or %s\n", arguments[3], arguments[4]);
        return 2;
    }
    fputs("scene,curve,setting,error_x,error_ports,error,wall_median_s,wall_least_s,cpu_s,solve_s,circuit_points,"
          "newton_iterations,residual_calls,timed,problem\n",
          rows);
    for (size_t i = 0; i < scene_entry_count; i++) {
        if (!is_wanted(scene_entries[i].name, arguments + 6, count - 6))
            continue;
        char folder[PATH_ROOM];
        snprintf(folder, sizeof folder, "%s/%s", arguments[2], scene_entries[i].name);
        struct bench bench = {.program = arguments[1],
                              .folder = folder,
                              .entry = &scene_entries[i],
                              .limit = quick ? 5.0 : 30.0,
                              .rounds = quick ? 3 : 5,
                              .quick = quick};
        if (measure_scene(&bench)) {
            write_rows(&bench, rows);
            write_tables(&bench, tables);
            fflush(rows);
            fflush(tables);
        } else {
            good = false;
        }
        trace_clear(&bench.reference);
        free_points(&bench);
    }
    return fclose(rows) == 0 && fclose(tables) == 0 && good ? 0 : 1;
}
