/* deasim check: read and vet, run nothing. */
#include "cli/cli.h"
#include "cli/options.h"
#include "deasim/quantity.h"

#include <getopt.h>
#include <stdio.h>

static const char usage[] = "usage: deasim check SCENE... [--set key=value]...\n\n"
                            "Reads each scene with its device, material, waveform and netlist files, reports the first "
                            "mistake, runs nothing.\n";

static int check_scene(const char *path, const struct cli_options *options) {
    struct dea_scene scene;
    enum dea_status status = cli_read_scene(path, options, &scene);
    for (int d = 0; status == DEA_OK && d < scene.device_count; d++) {
        const char *why;
        const struct dea_device *device = &scene.devices[d].device;
        if (dea_prestretch_fails(device, &why)) {
            fprintf(stderr, "%s: device %s cannot be run: %s\n", path, scene.devices[d].name, why);
            status = DEA_ERR_INPUT;
        } else if (!options->quiet) {
            char stiffness[32], capacitance[32];
            printf("%s: device %s, stiffness %s, rest capacitance %s\n", path, scene.devices[d].name,
                   dea_quantity_format(device->stiffness, "N/m", stiffness, sizeof stiffness),
                   dea_quantity_format(device->zones[0].present ? device->zones[0].rest_capacitance
                                                                : device->zones[1].rest_capacitance,
                                       "F", capacitance, sizeof capacitance));
        }
    }
    if (status == DEA_OK && !options->quiet)
        printf("%s: good\n", path);
    dea_scene_clear(&scene);
    return dea_exit_code(status);
}

int cli_check(int argc, char **argv) {
    struct cli_options options;
    int code = cli_parse_scene_options(argc, argv, usage, &options);
    if (code < 0) {
        code = 0;
        for (int i = optind; i < argc; i++) {
            int one = check_scene(argv[i], &options);
            code = one > code ? one : code;
        }
    }
    cli_clear_options(&options);
    return code;
}
