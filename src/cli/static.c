/* deasim static: equilibrium of a device at given voltages or fields, and its first failure. */
#include "cli/arguments.h"
#include "cli/cli.h"
#include "cli/options.h"
#include "cli/range.h"
#include "cli/static_print.h"

#include "deasim/quantity.h"
#include "deasim/scene.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#define BEYOND 1e-12 /* relative: a point asked for exactly at the limit is not beyond it */

/* What is asked for beyond is a missing unit; scenes have the same limit of voltage. */
#define MOST_VOLTAGE 1e5 /* V */
#define MOST_FIELD 1e10  /* V/m */

enum { OPTION_SET = 256, OPTION_CSV, OPTION_JSON };

struct options {
    const char *device;
    bool by_voltage, by_field;
    struct dea_range range; /* V or V/m */
    double right_voltage;
    struct cli_options common; /* holds the --set overrides */
    bool csv, json;
};

static const char usage[] =
    "usage: deasim static DEVICE (--voltage V | --field E) [options]\n"
    "\n"
    "Equilibrium, stresses and capacitance of the device DEVICE (a YAML file), and its first failure as the drive of\n"
    "the left zone grows. Viscoelastic branches are relaxed.\n"
    "\n"
    "  -V, --voltage V        voltage of the left zone: 3300, \"3.3 kV\" or a sweep first:last:points, 0:4kV:41\n"
    "  -E, --field E          true field in the left zone instead: \"100 V/um\" or a sweep 0:1e8:11\n"
    "  -r, --right-voltage V  constant voltage of the right zone (default 0)\n"
    "      --set KEY=VALUE    change a value of the device file, geometry.width=\"20 mm\"; may be repeated\n"
    "      --csv              CSV in SI units\n"
    "      --json             one JSON object in SI units\n"
    "  -h, --help             this text\n"
    "\n"
    "example: deasim static models/planar_c_s5.yaml --voltage 0:4kV:9\n";

static enum dea_status check_range(const char *option, const struct dea_range *range, double most, const char *unit,
                                   struct dea_error *error) {
    if (fabs(range->first) <= most && fabs(range->last) <= most)
        return DEA_OK;
    return dea_fail(error, DEA_ERR_INPUT, "%s: up to %g %s either way is allowed; is the unit right?", option, most,
                    unit);
}

static enum dea_status parse_right_voltage(const char *text, double *voltage, struct dea_error *error) {
    struct dea_error inner;
    if (dea_quantity_parse(text, "V", voltage, &inner) != DEA_OK)
        return dea_fail(error, DEA_ERR_INPUT, "--right-voltage: %s", inner.text);
    const struct dea_range only = {*voltage, *voltage, 1};
    return check_range("--right-voltage", &only, MOST_VOLTAGE, "V", error);
}

static enum dea_status take_option(int letter, void *context, struct dea_error *error) {
    struct options *options = context;
    switch (letter) {
    case 'V':
        options->by_voltage = true;
        DEA_TRY(dea_range_parse("--voltage", optarg, "V", &options->range, error));
        return check_range("--voltage", &options->range, MOST_VOLTAGE, "V", error);
    case 'E':
        options->by_field = true;
        DEA_TRY(dea_range_parse("--field", optarg, "V/m", &options->range, error));
        return check_range("--field", &options->range, MOST_FIELD, "V/m", error);
    case 'r':
        return parse_right_voltage(optarg, &options->right_voltage, error);
    case OPTION_SET:
        return cli_add_override(&options->common, optarg, error);
    case OPTION_CSV:
        options->csv = true;
        return DEA_OK;
    case OPTION_JSON:
        options->json = true;
        return DEA_OK;
    default:
        return dea_fail(error, DEA_ERR_INTERNAL, "option %d is not taken", letter);
    }
}

static enum dea_status parse_options(int argc, char **argv, struct options *options, struct dea_error *error) {
    static const struct option known[] = {{"voltage", required_argument, NULL, 'V'},
                                          {"field", required_argument, NULL, 'E'},
                                          {"right-voltage", required_argument, NULL, 'r'},
                                          {"set", required_argument, NULL, OPTION_SET},
                                          {"csv", no_argument, NULL, OPTION_CSV},
                                          {"json", no_argument, NULL, OPTION_JSON},
                                          {"help", no_argument, NULL, 'h'},
                                          {NULL, 0, NULL, 0}};
    DEA_TRY(cli_walk_options(argc, argv, usage, known, take_option, options, error));
    if (optind >= argc)
        return dea_fail(error, DEA_ERR_INPUT, "no device file given, see deasim static --help");
    if (optind + 1 < argc)
        return dea_fail(error, DEA_ERR_INPUT, "\"%s\" is one argument too many", argv[optind + 1]);
    options->device = argv[optind];
    if (options->by_voltage == options->by_field)
        return dea_fail(error, DEA_ERR_INPUT, "give either --voltage or --field");
    if (options->csv && options->json)
        return dea_fail(error, DEA_ERR_INPUT, "give either --csv or --json");
    return DEA_OK;
}

static bool is_beyond(const struct dea_device *device, const struct dea_limit *limit, const struct static_row *row) {
    if (limit->mode == DEA_LIMIT_NONE)
        return false;
    if (limit->mode == DEA_LIMIT_PRESTRETCH || !row->solved)
        return true;
    double slip = BEYOND * row->point.zones[0].stretch;
    return fabs(row->voltage) > limit->voltage * (1.0 + BEYOND) ||
           dea_zone_stretch(device, 0, row->point.x) > limit->stretch * device->prestretch[0] + slip;
}

/* One point; a missing equilibrium is an answer, bad input is not. */
static enum dea_status solve_row(const struct options *options, const struct static_answer *answer, double value,
                                 struct static_row *row, struct dea_error *error) {
    double voltages[DEA_ZONES] = {value, options->right_voltage};
    enum dea_status status =
        options->by_voltage ? dea_static_solve(answer->device, voltages, &row->point, error)
                            : dea_static_solve_field(answer->device, value, options->right_voltage, &row->point, error);
    if (status != DEA_OK && status != DEA_ERR_SOLVER)
        return status;
    row->solved = status == DEA_OK;
    row->voltage = row->solved ? row->point.zones[0].voltage : options->by_voltage ? value : NAN;
    row->beyond = is_beyond(answer->device, &answer->limit, row);
    return DEA_OK;
}

static enum dea_status answer_all(const struct options *options, struct static_answer *answer,
                                  struct dea_error *error) {
    DEA_TRY(dea_static_limit(answer->device, options->right_voltage, &answer->limit, error));
    for (int i = 0; i < answer->count; i++)
        DEA_TRY(solve_row(options, answer, dea_range_value(&options->range, i), &answer->rows[i], error));
    if (options->json)
        return static_print_json(answer, error);
    if (options->csv)
        static_print_csv(answer);
    else
        static_print_table(answer);
    return DEA_OK;
}

static enum dea_status run(const struct options *options, struct dea_error *error) {
    struct dea_device device = {0};
    struct static_answer answer = {.device = &device,
                                   .path = options->device,
                                   .right_voltage = options->right_voltage,
                                   .count = options->range.count};
    enum dea_status status =
        dea_device_read(options->device, options->common.overrides, options->common.override_count, &device, error);
    if (status == DEA_OK) {
        answer.rows = calloc((size_t)answer.count, sizeof *answer.rows);
        status = answer.rows != NULL ? answer_all(options, &answer, error)
                                     : dea_fail(error, DEA_ERR_MEMORY, "out of memory for %d points", answer.count);
    }
    free(answer.rows);
    dea_device_clear(&device);
    return status;
}

int cli_static(int argc, char **argv) {
    struct options options = {0};
    struct dea_error error = {0};
    enum dea_status status = parse_options(argc, argv, &options, &error);
    if (status == DEA_OK)
        status = run(&options, &error);
    cli_clear_options(&options.common);
    return cli_end("static", status, &error);
}
