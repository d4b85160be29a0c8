/* Does every example keep its promise? Each is run at its own accuracy and at those given (1e-2, 1e-3, 1e-4), and at a
 * tenth of each: energy imbalance and coupling error must stay below A, the results at A and A/10 within A.
 *     stress_examples [-a A]... SCENE...
 * Exit code 1 when one does not. */
#include "coupled_capture.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { SAMPLES = 2000, MOST_ACCURACIES = 16 };

/* Decreasing, each once. */
static int sort_accuracies(double *accuracies, int count) {
    int kept = 0;
    for (int i = 1; i < count; i++)
        for (int k = i; k > 0 && accuracies[k] > accuracies[k - 1]; k--) {
            double swap = accuracies[k];
            accuracies[k] = accuracies[k - 1];
            accuracies[k - 1] = swap;
        }
    for (int i = 0; i < count; i++)
        if (kept == 0 || accuracies[i] < accuracies[kept - 1] * (1.0 - 1e-9))
            accuracies[kept++] = accuracies[i];
    return kept;
}

/* One line; true when all that is promised holds. */
static bool print_row(const char *name, double accuracy, const struct coupled_rows *rows,
                      const struct coupled_rows *finer) {
    const struct dea_result *result = &rows->result;
    struct coupled_error change = compare_rows(rows, finer);
    bool good = rows->status >= 0 && finer->status >= 0 && change.x <= accuracy && change.port <= accuracy &&
                result->energy.imbalance <= accuracy && result->coupling_error <= accuracy;
    printf("%-26s %7.0e %9.1e %9.1e %9.1e %9.1e %8ld %7ld %8.2f %.*s%s%s\n", name, accuracy, result->energy.imbalance,
           result->coupling_error, change.x, change.port, result->stats_run.circuit_points,
           result->stats_run.plant_steps, result->stats_run.wall_s, result->relaxed, "rrrr", good ? "" : "  <<< ",
           rows->status < 0 ? rows->error.text : "");
    fflush(stdout);
    return good;
}

static bool measure_scene(const char *path, const double *wanted, int wanted_count) {
    struct dea_scene scene;
    struct dea_error error;
    if (dea_scene_read(path, NULL, 0, &scene, &error) != DEA_OK) {
        printf("%s\n", error.text);
        dea_scene_clear(&scene);
        return false;
    }
    double accuracies[MOST_ACCURACIES + 1] = {scene.accuracy};
    memcpy(accuracies + 1, wanted, (size_t)wanted_count * sizeof *wanted);
    int count = sort_accuracies(accuracies, wanted_count + 1);
    const char *slash = strrchr(path, '/'), *name = slash != NULL ? slash + 1 : path;
    bool good = true;
    struct coupled_rows rows = {0}, finer = {0};
    for (int i = 0; i < count; i++) {
        if (i == 0 || fabs(accuracies[i] / accuracies[i - 1] - 0.1) > 1e-9) {
            free_rows(&rows);
            run_scene(&scene, DEA_ENGINE_AUTO, accuracies[i], SAMPLES, &rows);
        }
        run_scene(&scene, DEA_ENGINE_AUTO, 0.1 * accuracies[i], SAMPLES, &finer);
        good = print_row(i == 0 ? name : "", accuracies[i], &rows, &finer) && good;
        free_rows(&rows);
        rows = finer; /* the next decade begins with it */
        finer = (struct coupled_rows){0};
    }
    free_rows(&rows);
    dea_scene_clear(&scene);
    return good;
}

int main(int argc, char **argv) {
    double accuracies[MOST_ACCURACIES] = {1e-2, 1e-3, 1e-4};
    int count = 3, given = 0, option, failed = 0;
    while ((option = getopt(argc, argv, "a:")) != -1) {
        if (option != 'a' || given == MOST_ACCURACIES) {
            fputs("usage: stress_examples [-a A]... SCENE...\n", stderr);
            return 2;
        }
        accuracies[given++] = atof(optarg);
        count = given;
    }
    printf("%-26s %7s %9s %9s %9s %9s %8s %7s %8s\n", "scene", "A", "imbalance", "coupling", "x", "port", "points",
           "steps", "s");
    for (int i = optind; i < argc; i++)
        failed += !measure_scene(argv[i], accuracies, count);
    printf("%d passed, %d failed\n", argc - optind - failed, failed);
    return failed > 0;
}
