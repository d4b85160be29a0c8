/* Delivered against asked accuracy over many scenes. usage: accuracy PROGRAM FOLDER CSV TABLE SCENE... */
#include "accuracy.h"

#include "deasim/scene.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#define SAMPLES 1000
#define RUN_LIMIT 60.0         /* s */
#define REFERENCE_LIMIT 120.0  /* s */
#define INDEPENDENT_LIMIT 20.0 /* s */
#define MANY_IMPACTS 8         /* on end stops, after which a motion depends on its smallest details */

struct study {
    const char *program, *folder, *scene;
    double stop, sample; /* s; 0: not known here */
    bool netlist;
    struct rows reference;
    char reference_name[16];
    double reference_at, doubt;
    int impacts;
    size_t expected; /* samples of a whole run */
    struct points *points;
};

static struct point *add_point(struct points *points) {
    if (points->count == points->room) {
        points->room = points->room > 0 ? 2 * points->room : 64;
        points->points = realloc(points->points, points->room * sizeof *points->points);
        if (points->points == NULL)
            abort();
    }
    struct point *point = &points->points[points->count++];
    *point = (struct point){.delivered = {NAN, NAN}, .doubt = NAN};
    return point;
}

/* The program's own reference: the most accurate run that ends in time, its doubt the difference to one ten times
 * looser. */
static bool find_reference(struct study *study) {
    struct run run;
    run_scene(study->program, study->scene, "auto", 1e-3, study->sample, study->folder, REFERENCE_LIMIT, &run);
    bool stiff = strcmp(run.mode, "cosim") == 0, good = run.good;
    if (!good)
        fprintf(stderr, "%s: %s\n", study->scene, run.problem);
    run_clear(&run);
    for (double accuracy = stiff ? 1e-8 : 1e-9; good && accuracy < 2e-6; accuracy *= 10.0) {
        run_scene(study->program, study->scene, "auto", accuracy, study->sample, study->folder, REFERENCE_LIMIT, &run);
        if (!run.good) {
            run_clear(&run);
            continue;
        }
        study->reference = run.rows;
        study->reference_at = accuracy;
        study->impacts = run.impacts;
        study->expected = run.rows.count;
        snprintf(study->reference_name, sizeof study->reference_name, "%s", run.mode);
        run_scene(study->program, study->scene, "auto", 10.0 * accuracy, study->sample, study->folder, REFERENCE_LIMIT,
                  &run);
        if (run.good) {
            struct delivered d = rows_compare(&run.rows, &study->reference);
            study->doubt = fmax(d.x, d.ports);
        }
        run_clear(&run);
        return true;
    }
    return false;
}

/* The independent program takes the reference's place where it can; the doubt is then between the two. */
static void ask_independent(struct study *study) {
    struct rows rows;
    if (study->netlist || !(study->stop > 0.0) ||
        !run_independent(study->scene, study->stop, SAMPLES, study->folder, INDEPENDENT_LIMIT, &study->reference,
                         &rows))
        return;
    struct delivered d = rows_compare(&study->reference, &rows);
    study->doubt = fmax(d.x, d.ports);
    rows_clear(&study->reference);
    study->reference = rows;
    study->reference_at = 0.0;
    snprintf(study->reference_name, sizeof study->reference_name, "independent");
}

static void measure(struct study *study, const char *engine) {
    for (int decade = FIRST_DECADE; decade <= LAST_DECADE; decade++) {
        struct run run;
        struct point *point = add_point(study->points);
        point->asked = pow(10.0, -decade);
        run_scene(study->program, study->scene, engine, point->asked, study->sample, study->folder, RUN_LIMIT, &run);
        snprintf(point->scene, sizeof point->scene, "%s", study->scene);
        snprintf(point->mode, sizeof point->mode, "%s",
                 run.mode[0] != '\0'               ? run.mode
                 : strcmp(engine, "ngspice") == 0  ? "cosim"
                 : study->reference_name[0] != 'i' ? study->reference_name
                                                   : "native");
        snprintf(point->problem, sizeof point->problem, "%s", run.problem);
        snprintf(point->reference, sizeof point->reference, "%s", study->reference_name);
        point->reference_at = study->reference_at;
        point->doubt = study->doubt;
        point->imbalance = run.imbalance;
        point->seconds = run.seconds;
        point->steps = run.steps;
        point->sensitive = study->impacts > MANY_IMPACTS;
        point->unsure = study->reference_at > 0.2 * point->asked;
        if (run.good && run.rows.count < 0.99 * (double)study->expected)
            snprintf(point->problem, sizeof point->problem, "ended early");
        else if (run.good)
            point->delivered = rows_compare(&run.rows, &study->reference);
        run_clear(&run);
    }
}

static void study_scene(struct study *study) {
    struct dea_scene scene = {0};
    struct dea_error error;
    size_t first = study->points->count;
    if (dea_scene_read(study->scene, NULL, 0, &scene, &error) != DEA_OK) {
        fprintf(stderr, "%s\n", error.text);
        dea_scene_clear(&scene);
        return;
    }
    study->netlist = scene.netlist != NULL;
    study->stop = scene.has_transient ? scene.stop : 0.0;
    study->sample = study->stop / SAMPLES;
    dea_scene_clear(&scene);
    study->doubt = NAN;
    if (find_reference(study)) {
        bool linear = strcmp(study->reference_name, "linear") == 0;
        ask_independent(study);
        measure(study, "auto");
        if (linear)
            measure(study, "ngspice");
    }
    for (size_t i = first; i < study->points->count; i++) {
        const struct point *point = &study->points->points[i];
        if (point->asked > 0.5e-2)
            printf("%-44s %-6s against %s (doubt %.1e):", point->scene, point->mode, point->reference, point->doubt);
        if (point->problem[0] != '\0')
            printf(" (%s)", point->problem);
        else
            printf(" %.3f", point_error(point) / point->asked);
        if (point->asked < 2e-6)
            printf("%s\n", point->sensitive ? " (many impacts)" : "");
    }
    fflush(stdout);
    rows_clear(&study->reference);
}

static FILE *open_or_stop(const char *path) {
    FILE *file = fopen(path, "w");
    if (file == NULL) {
        fprintf(stderr, "%s: %s\n", path, strerror(errno));
        exit(2);
    }
    return file;
}

int main(int argc, char **argv) {
    if (argc < 6) {
        fprintf(stderr, "usage: %s PROGRAM FOLDER CSV TABLE SCENE...\n", argv[0]);
        return 2;
    }
    if (mkdir(argv[2], 0755) != 0 && errno != EEXIST) {
        fprintf(stderr, "%s: %s\n", argv[2], strerror(errno));
        return 2;
    }
    struct points points = {0};
    for (int i = 5; i < argc; i++) {
        struct study study = {.program = argv[1], .folder = argv[2], .scene = argv[i], .points = &points};
        study_scene(&study);
    }
    FILE *csv = open_or_stop(argv[3]), *table = open_or_stop(argv[4]);
    write_csv(&points, csv);
    int exceeded = write_table(&points, table);
    bool written = fclose(csv) == 0 && fclose(table) == 0;
    free(points.points);
    return !written || exceeded > 0;
}
