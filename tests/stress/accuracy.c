/* What accuracy is delivered for what is asked: A = 1e-2 .. 1e-8 on the named scenes, or on random ones.
 *     stress_accuracy            named scenes
 *     stress_accuracy FROM TO    random scenes of these seeds
 * Truth is the independent program; where that is too slow for a scene, the run itself at 1e-11 stands in. */
#include "capture.h"
#include "scenes.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SAMPLES = 997, DECADES = 7 };

static void measure(const char *name, const struct dea_scene *scene) {
    struct independent_trace truth;
    double started = dea_clock();
    bool known = independent_run(scene, 1e-15, SAMPLES, &truth);
    printf("%-22s truth %5.1f s %s\n", name, dea_clock() - started, truth.trouble);
    printf("%8s %10s %9s %10s %10s %7s %8s %6s %6s %8s\n", "A", "error", "error/A", "port", "imbalance", "steps",
           "residual", "jac", "fails", "ms");
    for (int d = 2; d < 2 + DECADES; d++) {
        double accuracy = pow(10.0, -d), port = NAN;
        struct capture run;
        capture_run(scene, accuracy, SAMPLES, &run);
        double error = known ? capture_error(&run, &truth, &port) : NAN;
        const struct dea_run_stats *stats = &run.result.stats_run;
        printf("%8.0e %10.2e %9.4f %10.2e %10.2e %7ld %8ld %6ld %6ld %8.2f %s%s\n", accuracy, error, error / accuracy,
               port, run.result.energy.imbalance, stats->plant_steps, stats->residuals, stats->jacobians,
               stats->plant_rejected, 1e3 * stats->wall_s, run.status < 0 ? run.result.reason : "",
               error > accuracy                         ? " EXCEEDED"
               : run.result.energy.imbalance > accuracy ? " UNBALANCED"
                                                        : "");
        capture_free(&run);
    }
    independent_free(&truth);
    fflush(stdout);
}

int main(int argc, char **argv) {
    static struct test_scene s;
    if (argc == 3) {
        for (int seed = atoi(argv[1]); seed <= atoi(argv[2]); seed++) {
            char name[64];
            snprintf(name, sizeof name, "random %d", seed);
            build_random_scene(&s, (unsigned)seed);
            measure(name, &s.scene);
        }
        return 0;
    }
    for (int i = 0; i < SCENE_COUNT; i++) {
        if (argc == 2 && strstr(test_scene_names[i], argv[1]) == NULL)
            continue;
        build_scene(&s, (enum test_scene_name)i);
        measure(test_scene_names[i], &s.scene);
    }
    return 0;
}
