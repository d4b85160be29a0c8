/* usage: work_precision PROGRAM FOLDER RESULTS quick|full SECONDS SCENE, or work_precision --list
 * Measures one scene in about that many seconds times the scene's share. Scratch files go to FOLDER; RESULTS/SCENE.csv
 * has the rows, beside it .section, .summary and .overhead have the tables. Runs from the top of the tree. */
#include "work_precision.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

/* ---- timing ---- */

#define TIMING_SHARE 0.25 /* of the scene's time, whatever came before */

static void time_start(const struct bench *bench, struct start *start) {
    if (start->arguments[0] == NULL)
        return;
    struct process_result result = process_run(start->arguments, NULL, bench->limit);
    if (result.good)
        start->least = fmin(start->least, result.wall);
}

static void time_point(const struct bench *bench, struct point *point) {
    struct process_result result =
        process_run(point->arguments, point->output[0] != '\0' ? point->output : NULL, 2.0 * bench->limit);
    if (strncmp(point->curve, "deasim", 6) == 0)
        deasim_read_output(point);
    else if (strcmp(point->curve, "ngspice") == 0 || strcmp(point->curve, "fixed capacitor") == 0)
        ngspice_read_output(point);
    if (result.timed_out)
        return;
    point->cpu = point->wall_count == 0 ? result.cpu : fmin(point->cpu, result.cpu);
    point->walls[point->wall_count++] = result.wall;
}

/* All timed points in turn, as often as the scene's time allows and at least once: what else the machine does then
 * meets all of them alike. */
static void time_points(struct bench *bench) {
    double deadline = fmax(bench->began + bench->budget, bench_deadline(bench, TIMING_SHARE));
    for (int round = 0; round < bench->rounds && (round == 0 || !is_late(deadline)); round++) {
        for (int i = 0; i < bench->start_count; i++)
            time_start(bench, &bench->starts[i]);
        for (size_t i = 0; i < bench->point_count; i++) {
            struct point *point = &bench->points[i];
            if (!point->chosen || point->arguments[0] == NULL)
                continue;
            if (round > 0 && is_late(deadline))
                return;
            if (round == 0)
                point->wall_count = 0;
            time_point(bench, point);
        }
    }
}

/* ---- one scene ---- */

static void free_arguments(char **arguments) {
    for (int i = 0; arguments[i] != NULL; i++)
        free(arguments[i]);
}

static void clear_bench(struct bench *bench) {
    for (size_t i = 0; i < bench->point_count; i++)
        free_arguments(bench->points[i].arguments);
    for (int i = 0; i < bench->start_count; i++)
        free_arguments(bench->starts[i].arguments);
    free(bench->points);
    trace_clear(&bench->reference);
}

static bool measure_scene(struct bench *bench) {
    const struct scene_entry *entry = bench->entry;
    if (mkdir(bench->folder, 0777) != 0 && errno != EEXIST) {
        fprintf(stderr, "cannot make %s: %s\n", bench->folder, strerror(errno));
        return false;
    }
    if (!deasim_prepare(bench) || (!entry->only_overhead && !deasim_reference(bench)))
        return false;
    if (!entry->circuit || entry->twin != NULL)
        deasim_curve(bench, entry->twin != NULL ? entry->twin : entry->scene, "deasim native", "native");
    if (entry->linear)
        deasim_curve(bench, entry->scene, "deasim linear", "auto");
    if (entry->circuit)
        deasim_curve(bench, entry->scene, "deasim cosim", "ngspice");
    if (entry->overhead)
        fixed_capacitor_curve(bench);
    if (!entry->only_overhead) {
        if (entry->ode)
            script_curves(bench);
        if (entry->circuit)
            fixed_exchange_curve(bench);
        if (entry->exports)
            ngspice_curve(bench);
    }
    time_points(bench);
    return true;
}

/* ---- results ---- */

/* The CSV is written last and renamed into place: where it is, the scene is done. */
static bool write_results(const struct bench *bench, const char *folder) {
    static const struct {
        const char *ending;
        void (*write)(const struct bench *bench, FILE *file);
    } results[] = {
        {"section", write_section}, {"summary", write_summary}, {"overhead", write_overhead}, {"csv", write_rows}};
    for (size_t i = 0; i < sizeof results / sizeof results[0]; i++) {
        char path[PATH_ROOM], finished[PATH_ROOM];
        snprintf(finished, sizeof finished, "%s/%s.%s", folder, bench->entry->name, results[i].ending);
        snprintf(path, sizeof path, "%s/%s.part", folder, bench->entry->name);
        FILE *file = fopen(path, "w");
        if (file == NULL) {
            fprintf(stderr, "cannot write %s\n", path);
            return false;
        }
        results[i].write(bench, file);
        if (fclose(file) != 0 || rename(path, finished) != 0) {
            fprintf(stderr, "cannot write %s\n", finished);
            return false;
        }
    }
    return true;
}

static const struct scene_entry *find_entry(const char *name) {
    for (size_t i = 0; i < scene_entry_count; i++)
        if (strcmp(scene_entries[i].name, name) == 0)
            return &scene_entries[i];
    return NULL;
}

/* What a scene takes of a campaign of one second. */
static double scene_share(const struct scene_entry *entry) {
    double sum = 0.0;
    for (size_t i = 0; i < scene_entry_count; i++)
        sum += scene_entries[i].share > 0.0 ? scene_entries[i].share : 1.0;
    return (entry->share > 0.0 ? entry->share : 1.0) / sum;
}

int main(int count, char **arguments) {
    if (count == 2 && strcmp(arguments[1], "--list") == 0) {
        for (size_t i = 0; i < scene_entry_count; i++)
            puts(scene_entries[i].name);
        return 0;
    }
    const struct scene_entry *entry = count == 7 ? find_entry(arguments[6]) : NULL;
    double seconds = count == 7 ? atof(arguments[5]) : 0.0;
    if (entry == NULL || !(seconds > 0.0)) {
        fprintf(stderr, "usage: work_precision PROGRAM FOLDER RESULTS quick|full SECONDS SCENE, or --list\n");
        return 2;
    }
    bool quick = strcmp(arguments[4], "quick") == 0;
    char folder[PATH_ROOM];
    snprintf(folder, sizeof folder, "%s/%s", arguments[2], entry->name);
    struct bench bench = {.program = arguments[1],
                          .folder = folder,
                          .entry = entry,
                          .began = process_clock(),
                          .budget = seconds * scene_share(entry),
                          .limit = quick ? 4.0 : 30.0,
                          .rounds = quick ? 3 : MAX_ROUNDS,
                          .quick = quick,
                          .reference_doubt = NAN,
                          .reference_second = NAN};
    bool good = measure_scene(&bench) && write_results(&bench, arguments[3]);
    printf("%s: %.0f s of %.0f s\n", entry->name, process_clock() - bench.began, bench.budget);
    clear_bench(&bench);
    return good ? 0 : 1;
}
