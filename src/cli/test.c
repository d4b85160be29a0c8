/* deasim test: run scenes and judge what they expect. */
#include "cli/cli.h"
#include "cli/options.h"
#include "deasim/expect.h"
#include "deasim/run.h"

#include <getopt.h>
#include <math.h>
#include <stdio.h>

static const char usage[] =
    "usage: deasim test SCENE... [--accuracy A] [--set key=value]... [--engine E] [--trust-netlist]\n"
    "                   [--time-limit T] [--quiet] [--verbose]\n\n"
    "Runs each scene, judges its `expect` lines, prints one line a scene, then \"N passed, N failed\".\n"
    "A scene passes when it runs to its end (or an event it asked to stop at) and every expectation is met.\n"
    "The options are those of deasim run; with --quiet only the scenes that fail have their line.\n";

/* Judges one result; prints each unmet expectation. */
static bool judge(const struct dea_scene *scene, const struct dea_result *result) {
    bool good = true;
    for (size_t i = 0; i < scene->expectation_count; i++) {
        char text[512];
        if (!dea_expectation_met(&scene->expectations[i], result, text, sizeof text)) {
            printf("  %s\n", text);
            good = false;
        }
    }
    return good;
}

/* Exit code of one scene: 0, 1 unmet, 2 bad input, 3 solver, 4 internal. */
static int test_scene(const char *path, const struct cli_options *options) {
    struct dea_scene scene;
    enum dea_status status = cli_read_scene(path, options, &scene);
    int code = dea_exit_code(status);
    if (status == DEA_OK) {
        struct dea_report report = {.terminal = options->verbose ? stderr : NULL, .verbose = options->verbose};
        struct dea_run_options run = {.report = &report,
                                      .engine = options->engine,
                                      .trust_netlist = options->trust_netlist,
                                      .time_limit = options->time_limit};
        struct dea_result result;
        struct dea_error error;
        status = dea_run_scene(&scene, &run, &result, &error);
        code = dea_exit_code(status);
        if (status < 0)
            fprintf(stderr, "%s: %s\n", path, error.text);
        else if (!judge(&scene, &result))
            code = dea_exit_code(DEA_ERR_EXPECTATION);
        if (code != 0 || !options->quiet)
            printf("%s %s  (%zu expectations, %ld steps, imbalance %.1e, %.2f s)\n", code == 0 ? "ok    " : "FAILED",
                   path, scene.expectation_count, result.stats_run.plant_steps, result.energy.imbalance,
                   result.stats_run.wall_s);
        dea_result_clear(&result);
    } else {
        printf("FAILED %s\n", path);
    }
    dea_scene_clear(&scene);
    fflush(stdout);
    return code;
}

int cli_test(int argc, char **argv) {
    struct cli_options options;
    int code = cli_parse_scene_options(argc, argv, usage, &options);
    if (code < 0) {
        int passed = 0, failed = 0;
        code = 0;
        for (int i = optind; i < argc; i++) {
            int one = test_scene(argv[i], &options);
            passed += one == 0;
            failed += one != 0;
            code = one > code ? one : code;
        }
        printf("%d passed, %d failed\n", passed, failed);
    }
    cli_clear_options(&options);
    return code;
}
