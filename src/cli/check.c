/* deasim check: read and vet, run nothing. */
#include "cli/cli.h"
#include "cli/options.h"
#include "deasim/quantity.h"

#include <getopt.h>
#include <stdio.h>

static const char usage[] =
    "usage: deasim check SCENE... [--accuracy A] [--set key=value]... [--engine E] [--trust-netlist]\n"
    "                    [--quiet]\n\n"
    "Reads each scene with its device, material, waveform and netlist files, reports the first "
    "mistake, runs nothing.\nThe options are those of deasim run.\n";

static void print_device(const char *path, const struct dea_scene_device *named) {
    const struct dea_device *device = &named->device;
    const struct dea_zone *zone = &device->zones[device->zones[0].present ? 0 : 1];
    char stiffness[32], capacitance[32];
    printf("%s: device %s, stiffness %s, rest capacitance %s\n", path, named->name,
           dea_quantity_format(device->stiffness, "N/m", stiffness, sizeof stiffness),
           dea_quantity_format(zone->rest_capacitance, "F", capacitance, sizeof capacitance));
}

static int check_scene(const char *path, const struct cli_options *options) {
    struct dea_scene scene;
    struct dea_error error;
    struct dea_report report = {.terminal = options->quiet ? NULL : stderr};
    struct dea_run_options run = {
        .report = &report, .engine = options->engine, .trust_netlist = options->trust_netlist};
    enum dea_status status = cli_read_scene(path, options, &scene);
    if (status == DEA_OK) {
        status = dea_check_scene(&scene, &run, &error);
        if (status != DEA_OK)
            fprintf(stderr, "%s\n", error.text);
    }
    for (int d = 0; status == DEA_OK && !options->quiet && d < scene.device_count; d++)
        print_device(path, &scene.devices[d]);
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
