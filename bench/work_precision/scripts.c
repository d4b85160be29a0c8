/* scipy and Octave on circuits of sources and resistors: the problem goes to the scripts as JSON, they solve and time
 * it themselves, without the start of their interpreters. */
#include "work_precision.h"

#include "deasim/scene.h"

#include <cjson/cJSON.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define SCRIPT_ROWS 2000 /* as the timed runs of deasim */

/* ---- the problem ---- */

/* A waveform of straight pieces as corners. */
static cJSON *list_corners(const struct dea_source *source, double stop) {
    cJSON *corners = cJSON_CreateArray();
    for (double t = 0.0; t < stop;) {
        struct dea_piece piece = {.kind = DEA_PIECE_LINE, .end = INFINITY};
        if (source->present)
            dea_waveform_piece(&source->waveform, t, &piece);
        double end = fmin(piece.end, stop);
        const double numbers[] = {t, dea_piece_value(&piece, t, NULL), end, dea_piece_value(&piece, end, NULL)};
        cJSON_AddItemToArray(corners, cJSON_CreateDoubleArray(numbers, 4));
        t = end;
    }
    return corners;
}

static cJSON *describe_zone(const struct dea_scene *scene, int k) {
    const struct dea_zone *zone = &scene->devices[0].device.zones[k];
    cJSON *object = cJSON_CreateObject();
    cJSON_AddNumberToObject(object, "side", zone->side);
    cJSON_AddNumberToObject(object, "length", zone->length);
    cJSON_AddNumberToObject(object, "resistance", scene->sources[k].resistance + zone->electrode_resistance);
    cJSON_AddItemToObject(object, "corners", list_corners(&scene->sources[k], scene->stop));
    return object;
}

static bool write_problem(const struct dea_scene *scene, const char *path) {
    const struct dea_device *device = &scene->devices[0].device;
    const struct dea_material *material = &device->material;
    cJSON *root = cJSON_CreateObject(), *zones = cJSON_AddArrayToObject(root, "zones"),
          *branches = cJSON_AddArrayToObject(root, "branches");
    const struct {
        const char *name;
        double value;
    } numbers[] = {{"stop", scene->stop},
                   {"rows", SCRIPT_ROWS},
                   {"width", device->width},
                   {"thickness", device->thickness},
                   {"lp1", device->prestretch[0]},
                   {"lp2", device->prestretch[1]},
                   {"mu", material->elastic.mu},
                   {"jm", material->elastic.jm},
                   {"permittivity", DEA_VACUUM_PERMITTIVITY * material->dielectric.permittivity},
                   {"mass", device->effective_mass},
                   {"damping", device->damping},
                   {"load", device->load}};
    for (size_t i = 0; i < sizeof numbers / sizeof numbers[0]; i++)
        cJSON_AddNumberToObject(root, numbers[i].name, numbers[i].value);
    for (int k = 0; k < DEA_ZONES; k++)
        cJSON_AddItemToArray(zones, describe_zone(scene, k));
    for (int b = 0; b < material->branch_count; b++) {
        cJSON *branch = cJSON_CreateObject();
        cJSON_AddNumberToObject(branch, "mu", material->branches[b].mu);
        cJSON_AddNumberToObject(branch, "tau", material->branches[b].tau);
        cJSON_AddItemToArray(branches, branch);
    }
    char *text = cJSON_Print(root);
    FILE *file = fopen(path, "w");
    bool good = text != NULL && file != NULL && fputs(text, file) >= 0;
    if (file != NULL && fclose(file) != 0)
        good = false;
    free(text);
    cJSON_Delete(root);
    return good;
}

/* ---- the scripts ---- */

/* What a script says per tolerance: "METHOD TOLERANCE calls seconds seconds ..."; the trace is METHOD-TOLERANCE.txt. */
static void read_script_line(struct bench *bench, char *line) {
    char *rest = NULL, *method = strtok_r(line, " \n", &rest), *tolerance = strtok_r(NULL, " \n", &rest),
         *calls = strtok_r(NULL, " \n", &rest), path[2 * PATH_ROOM];
    if (calls == NULL)
        return;
    struct point *point = bench_add_point(bench, method, "rtol=%s", tolerance);
    for (char *c = point->curve; *c != '\0'; c++)
        if (*c == '_')
            *c = ' ';
    if (strcmp(calls, "failed") == 0) {
        point_fail(point, "failed: %.*s", (int)strcspn(rest, "\n"), rest);
        return;
    }
    point->work = atof(calls);
    for (char *word; (word = strtok_r(NULL, " \n", &rest)) != NULL && point->wall_count < MAX_ROUNDS;)
        point->walls[point->wall_count++] = atof(word);
    point->own = point_least(point);
    snprintf(path, sizeof path, "%s/%s-%s.txt", bench->folder, method, tolerance);
    struct trace trace = {0};
    if (trace_read_table(path, bench->signal_count, &trace)) {
        point->error = trace_compare(&trace, &bench->reference);
        point->chosen = isfinite(point->error.x);
    } else {
        point_fail(point, "left no result");
    }
    trace_clear(&trace);
}

#define SCRIPT_SHARE 0.15 /* of a scene's time for each script */

static struct process_result run_script(const struct bench *bench, const char *const *command, const char *scope,
                                        const char *output, double limit) {
    char *arguments[MAX_ARGUMENTS] = {0};
    const char *const further[] = {bench->problem, bench->folder, scope};
    int count = 0;
    for (; command[count] != NULL; count++)
        arguments[count] = strdup(command[count]);
    for (int i = 0; i < 3; i++)
        arguments[count++] = strdup(further[i]);
    struct process_result result = process_run(arguments, output, limit);
    for (int i = 0; i < count; i++)
        free(arguments[i]);
    return result;
}

/* The interpreter's start with the libraries and the problem read, and then everything the script tells. */
static void measure_script(struct bench *bench, const char *const *command, const char *const *methods) {
    char output[PATH_ROOM + 32], *line = NULL;
    size_t room = 0;
    double least = INFINITY;
    snprintf(output, sizeof output, "%s/script.txt", bench->folder);
    for (int i = 0; i < 3; i++)
        least = fmin(least, run_script(bench, command, "start", NULL, 60.0).wall);
    for (int i = 0; methods[i] != NULL; i++)
        bench_set_start(bench, methods[i], NULL, least);
    struct process_result result =
        run_script(bench, command, bench->quick ? "quick" : "full", output, fmax(10.0, SCRIPT_SHARE * bench->budget));
    FILE *file = fopen(output, "r");
    while (file != NULL && getline(&line, &room, file) >= 0)
        read_script_line(bench, line);
    free(line);
    if (file != NULL)
        fclose(file);
    if (!result.good)
        point_blame(bench_add_point(bench, methods[0], "the tolerances after the last one listed"), &result);
}

/* A second reference, by a program that shares nothing with deasim but the equations. */
static void compare_second(struct bench *bench, const char *const *command) {
    char path[PATH_ROOM + 64];
    struct trace trace = {0};
    snprintf(path, sizeof path, "%s/scipy_LSODA-1e-12.txt", bench->folder);
    remove(path);
    struct process_result result = run_script(bench, command, "reference", NULL, 60.0);
    if (result.good && trace_read_table(path, bench->signal_count, &trace)) {
        struct trace_error error = trace_compare(&trace, &bench->reference);
        bench->reference_second = fmax(error.x, error.ports);
    }
    trace_clear(&trace);
}

static bool works(const char *const *command) {
    char *arguments[8] = {0};
    for (int i = 0; command[i] != NULL; i++)
        arguments[i] = strdup(command[i]);
    bool good = process_run(arguments, NULL, 60.0).good;
    for (int i = 0; arguments[i] != NULL; i++)
        free(arguments[i]);
    return good;
}

void script_curves(struct bench *bench) {
    static const char *const scipy[] = {"/usr/bin/python3", "bench/work_precision/scipy_ode.py", NULL};
    static const char *const octave[] = {"octave-cli", "--quiet", "bench/work_precision/octave_ode.m", NULL};
    const char *path = bench->entry->twin != NULL ? bench->entry->twin : bench->entry->scene;
    struct dea_scene scene = {0};
    struct dea_error error;
    snprintf(bench->problem, sizeof bench->problem, "%.1000s/problem.json", bench->folder);
    bool good = dea_scene_read(path, NULL, 0, &scene, &error) == DEA_OK && write_problem(&scene, bench->problem);
    dea_scene_clear(&scene);
    if (!good)
        return;
    if (works((const char *const[]){"/usr/bin/python3", "-c", "import scipy.integrate", NULL})) {
        compare_second(bench, scipy);
        measure_script(bench, scipy, (const char *const[]){"scipy LSODA", "scipy Radau", NULL});
    } else {
        printf("%s: scipy is skipped: it needs the package python3-scipy\n", bench->entry->name);
    }
    if (works((const char *const[]){"octave-cli", "--version", NULL}))
        measure_script(bench, octave, (const char *const[]){"octave ode15s", NULL});
    else
        printf("%s: Octave is skipped: it needs the package octave\n", bench->entry->name);
}
