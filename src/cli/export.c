/* deasim export: a scene as a deck for plain ngspice. */
#include "deasim/export.h"

#include "cli/cli.h"
#include "cli/options.h"

#include <errno.h>
#include <getopt.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

static const char usage[] =
    "usage: deasim export SCENE [-o DECK] [--set key=value]... [--trust-netlist]\n\n"
    "Writes the scene as one self-contained deck for plain ngspice, devices as behavioural subcircuits.\n"
    "  -o, --output DECK  the file to write; default: standard output\n"
    "Run it with: ngspice -b -r out.raw DECK\n";

/* Takes an unfinished deck away again; a pipe or a device that was there before stays. */
static void remove_deck(const char *path) {
    struct stat found;
    if (lstat(path, &found) == 0 && S_ISREG(found.st_mode))
        remove(path);
}

static enum dea_status write_export(const struct cli_options *options, const struct dea_scene *scene,
                                    struct dea_error *error) {
    FILE *file = options->directory != NULL ? fopen(options->directory, "w") : stdout;
    if (file == NULL)
        return dea_fail(error, DEA_ERR_INPUT, "cannot write %s: %s", options->directory, strerror(errno));
    enum dea_status status = dea_export_scene(scene, options->trust_netlist, file, error);
    bool flushed = fflush(file) == 0;
    if (file != stdout)
        flushed = fclose(file) == 0 && flushed;
    if (status == DEA_OK && !flushed)
        status = dea_fail(error, DEA_ERR_OUTPUT, "the deck is incomplete: %s", strerror(errno));
    if (status != DEA_OK && options->directory != NULL)
        remove_deck(options->directory);
    return status;
}

int cli_export(int argc, char **argv) {
    struct cli_options options;
    int code = cli_parse_scene_options(argc, argv, usage, &options);
    if (code < 0) {
        struct dea_scene scene;
        struct dea_error error;
        enum dea_status status = cli_read_scene(argv[optind], &options, &scene);
        code = dea_exit_code(status);
        if (status == DEA_OK && write_export(&options, &scene, &error) != DEA_OK)
            code = cli_report("export", &error);
        dea_scene_clear(&scene);
    }
    cli_clear_options(&options);
    return code;
}
