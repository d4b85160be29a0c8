/* deasim plot: the picture of a run. */
#include "cli/arguments.h"
#include "cli/cli.h"
#include "deasim/result.h"

#include <stdio.h>
#include <stdlib.h>

static const char usage[] =
    "usage: deasim plot DIR...\n\n"
    "Draws DIR/result.csv, the result of `deasim run SCENE -o DIR`, as DIR/result.png and prints the picture's path:\n"
    "voltages, displacement, true field with its breakdown limit, and energies (or currents) over a shared time axis.\n"
    "Signals that are not in the result are left out. Needs gnuplot.\n\n"
    "  -h, --help   this text\n";

static int plot_folder(const char *directory) {
    char *path;
    struct dea_error error = {0};
    enum dea_status status = dea_plot_run(directory, &path, &error);
    if (status != DEA_OK)
        return cli_report("plot", &error);
    puts(path);
    free(path);
    return 0;
}

static enum dea_status take_option(int letter, void *options, struct dea_error *error) {
    (void)options;
    return dea_fail(error, DEA_ERR_INTERNAL, "option %d is not taken", letter);
}

int cli_plot(int argc, char **argv) {
    static const struct option long_options[] = {{"help", no_argument, NULL, 'h'}, {NULL, 0, NULL, 0}};
    struct dea_error error;
    enum dea_status status = cli_walk_options(argc, argv, usage, long_options, take_option, NULL, &error);
    if (status != DEA_OK)
        return cli_end("plot", status, &error);
    if (optind >= argc) {
        fprintf(stderr, "deasim plot: name a result folder\n%s", usage);
        return 2;
    }
    int code = 0;
    for (int i = optind; i < argc; i++) {
        int one = plot_folder(argv[i]);
        code = one > code ? one : code;
    }
    return code;
}
