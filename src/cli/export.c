/* deasim export: a scene as a deck for plain ngspice. */
#include "deasim/export.h"
#include "deasim/new_file.h"

#include "cli/arguments.h"
#include "cli/cli.h"
#include "cli/options.h"

#include <getopt.h>
#include <stdio.h>

static const char usage[] =
    "usage: deasim export SCENE [-o DECK] [--set key=value]... [--trust-netlist]\n\n"
    "Writes the scene as one self-contained deck for plain ngspice, devices as behavioural subcircuits.\n"
    "  -o, --output DECK  the file to write; default: standard output\n"
    "Run it with: ngspice -b -r out.raw DECK\n";

static enum dea_status write_export(const struct cli_options *options, const struct dea_scene *scene,
                                    struct dea_error *error) {
    if (options->directory == NULL)
        return dea_export_scene(scene, options->trust_netlist, stdout, error);
    struct dea_new_file deck;
    DEA_TRY(dea_new_file_open(options->directory, &deck, error));
    enum dea_status status = dea_export_scene(scene, options->trust_netlist, deck.file, error);
    return dea_new_file_finish(&deck, status, error);
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
