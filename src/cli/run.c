/* deasim run: one scene in time. */
#include "deasim/run.h"
#include "cli/arguments.h"
#include "cli/cli.h"
#include "cli/options.h"
#include "deasim/new_file.h"

#include <errno.h>
#include <getopt.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const char usage[] =
    "usage: deasim run SCENE [-o DIR] [--accuracy A] [--set key=value]... [--json] [--quiet] [--verbose]\n"
    "                  [--engine auto|ngspice|native] [--trust-netlist] [--time-limit T]\n\n"
    "Runs a scene and prints a summary.\n"
    "  -o, --output DIR   write result.csv, .raw, .h5 (as the scene's output.formats asks), summary.json and log.txt "
    "there\n"
    "  --accuracy A       promised relative error of the displacement and the port voltages, 1e-12 to 0.1\n"
    "  --set KEY=VALUE    override a value of the scene, for example --set transient.stop=\"10 ms\"\n"
    "  --engine E         auto: as the scene needs; ngspice: co-simulate every netlist; native: refuse netlists\n"
    "  --trust-netlist    let the netlist run commands and use files (.control, shell, write, ...)\n"
    "  --time-limit T     give a netlist's run at most this wall-clock time\n"
    "  --json             print the summary as one JSON object\n"
    "  -q, --quiet        no progress bar, no warnings, no summary\n"
    "  -v, --verbose      also say which states the run has and other details\n"
    "  -h, --help         this text\n"
    "Interrupting (Ctrl-C) keeps what was computed and exits with 3.\n";

static volatile sig_atomic_t interrupted;

static void interrupt(int signal_number) {
    interrupted = signal_number;
}

static void catch_signals(void) {
    const struct sigaction action = {.sa_handler = interrupt};
    struct sigaction before;
    sigaction(SIGINT, &action, NULL);
    sigaction(SIGTERM, &action, NULL);
    if (sigaction(SIGHUP, NULL, &before) == 0 && before.sa_handler != SIG_IGN) /* as it is under nohup */
        sigaction(SIGHUP, &action, NULL);
}

/* The log lives beside the results; opening it also finds out whether DIR can be written. */
static enum dea_status open_log(const char *directory, FILE **log, struct dea_error *error) {
    char path[4096];
    DEA_TRY(dea_directory_make(directory, error));
    if (snprintf(path, sizeof path, "%s/log.txt", directory) >= (int)sizeof path)
        return dea_fail(error, DEA_ERR_INPUT, "%s: the path is too long", directory);
    DEA_TRY(dea_new_file_check(path, error));
    /* append, line by line: a netlist's run writes to it from a process of its own */
    if ((unlink(path) != 0 && errno != ENOENT) || (*log = fopen(path, "a")) == NULL ||
        setvbuf(*log, NULL, _IOLBF, 0) != 0)
        return dea_fail(error, DEA_ERR_INPUT, "cannot write %s: %s", path, strerror(errno));
    return DEA_OK;
}

static enum dea_status print_result(const struct cli_options *options, const struct dea_scene *scene,
                                    const struct dea_result *result, struct dea_error *error) {
    if (options->json) {
        char *json = dea_summary_json(scene, result);
        if (json == NULL)
            return dea_fail(error, DEA_ERR_MEMORY, "out of memory for the summary");
        puts(json);
        free(json);
    } else if (!options->quiet) {
        dea_summary_print(scene, result, stdout);
    }
    return DEA_OK;
}

static int run_scene(const struct cli_options *options, const struct dea_scene *scene) {
    struct dea_error error;
    struct dea_report report = {.terminal = options->quiet ? NULL : stderr,
                                .verbose = options->verbose,
                                .progress = !options->quiet && !options->json && isatty(STDERR_FILENO)};
    struct dea_run_options run = {.directory = options->directory,
                                  .report = &report,
                                  .interrupt = &interrupted,
                                  .engine = options->engine,
                                  .trust_netlist = options->trust_netlist,
                                  .time_limit = options->time_limit};
    struct dea_run_options check = run;
    check.report = NULL; /* the run itself warns */
    /* before a folder is made for its results */
    if (dea_check_scene(scene, &check, &error) != DEA_OK ||
        (options->directory != NULL && open_log(options->directory, &report.log, &error) != DEA_OK))
        return cli_report("run", &error);
    catch_signals();
    struct dea_result result;
    enum dea_status status = dea_run_scene(scene, &run, &result, &error);
    if (status < 0)
        cli_report("run", &error);
    if (report.log != NULL && status < 0)
        fprintf(report.log, "%s\n", error.text);

    /* whatever happened, say what was computed; a run that never began has nothing to say */
    bool began = result.signal_count > 0 && result.stats[0].max >= result.stats[0].min;
    if (began) {
        enum dea_status written =
            options->directory != NULL ? dea_summary_write(options->directory, scene, &result, &error) : DEA_OK;
        if (written != DEA_OK)
            cli_report("run", &error);
        enum dea_status printed = print_result(options, scene, &result, &error);
        if (printed != DEA_OK)
            cli_report("run", &error);
        if (status >= 0 && (written != DEA_OK || printed != DEA_OK))
            status = written != DEA_OK ? written : printed;
    }
    if (report.log != NULL && fclose(report.log) != 0 && status >= 0) {
        fprintf(stderr, "deasim run: %s/log.txt is incomplete: %s\n", options->directory, strerror(errno));
        status = DEA_ERR_OUTPUT;
    }
    dea_result_clear(&result);
    return dea_exit_code(status);
}

int cli_run(int argc, char **argv) {
    struct cli_options options;
    int code = cli_parse_scene_options(argc, argv, usage, &options);
    if (code < 0) {
        struct dea_scene scene;
        enum dea_status status = cli_read_scene(argv[optind], &options, &scene);
        code = status == DEA_OK ? run_scene(&options, &scene) : dea_exit_code(status);
        dea_scene_clear(&scene);
    }
    cli_clear_options(&options);
    return code;
}
