/* Shared options of the commands that read scenes. */
#include "cli/options.h"

#include "cli/arguments.h"
#include "deasim/quantity.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { OPTION_ACCURACY = 256, OPTION_SET, OPTION_JSON, OPTION_TRUST, OPTION_ENGINE, OPTION_TIME_LIMIT };

static const struct {
    struct option option;
    const char *commands; /* that take it */
} rows[] = {
    {{"output", required_argument, NULL, 'o'}, "run export"},
    {{"accuracy", required_argument, NULL, OPTION_ACCURACY}, "run check test"},
    {{"set", required_argument, NULL, OPTION_SET}, "run check test export"},
    {{"json", no_argument, NULL, OPTION_JSON}, "run"},
    {{"quiet", no_argument, NULL, 'q'}, "run check test"},
    {{"verbose", no_argument, NULL, 'v'}, "run test"},
    {{"trust-netlist", no_argument, NULL, OPTION_TRUST}, "run check test export"},
    {{"engine", required_argument, NULL, OPTION_ENGINE}, "run check test"},
    {{"time-limit", required_argument, NULL, OPTION_TIME_LIMIT}, "run test"},
    {{"help", no_argument, NULL, 'h'}, "run check test export"},
};
enum { ROWS = sizeof rows / sizeof rows[0] };

enum dea_status cli_add_override(struct cli_options *options, const char *text, struct dea_error *error) {
    const char *equals = strchr(text, '=');
    if (equals == NULL || equals == text)
        return dea_fail(error, DEA_ERR_INPUT, "--set %s: write key=value, for example --set transient.stop=\"10 ms\"",
                        text);
    if (options->override_count == CLI_MAX_OVERRIDES)
        return dea_fail(error, DEA_ERR_INPUT, "--set: at most %d overrides", CLI_MAX_OVERRIDES);
    char *copy = strdup(text);
    if (copy == NULL)
        return dea_fail(error, DEA_ERR_MEMORY, "out of memory for --set %s", text);
    copy[equals - text] = '\0';
    options->override_texts[options->override_count] = copy;
    options->overrides[options->override_count++] = (struct dea_override){copy, copy + (equals - text) + 1};
    return DEA_OK;
}

static enum dea_status parse_accuracy(const char *text, double *accuracy, struct dea_error *error) {
    struct dea_error inner;
    if (dea_quantity_parse(text, "1", accuracy, &inner) != DEA_OK || !(*accuracy >= 1e-12 && *accuracy <= 0.1))
        return dea_fail(error, DEA_ERR_INPUT, "--accuracy %s: a number from 1e-12 to 0.1 is allowed", text);
    return DEA_OK;
}

static enum dea_status parse_engine(const char *text, enum dea_engine_choice *engine, struct dea_error *error) {
    static const char *const names[] = {"auto", "ngspice", "native"};
    for (int i = 0; i < 3; i++) {
        if (strcmp(text, names[i]) == 0) {
            *engine = (enum dea_engine_choice)i;
            return DEA_OK;
        }
    }
    return dea_fail(error, DEA_ERR_INPUT, "--engine %s: auto, ngspice or native is allowed", text);
}

static enum dea_status parse_time_limit(const char *text, double *limit, struct dea_error *error) {
    struct dea_error inner;
    if (dea_quantity_parse(text, "s", limit, &inner) == DEA_OK && *limit > 0.0)
        return DEA_OK;
    return dea_fail(error, DEA_ERR_INPUT, "--time-limit %s: a time above 0 is allowed, for example 10min", text);
}

static enum dea_status take_option(int letter, void *context, struct dea_error *error) {
    struct cli_options *options = context;
    switch (letter) {
    case 'o':
        options->directory = optarg;
        return DEA_OK;
    case OPTION_ACCURACY:
        return parse_accuracy(optarg, &options->accuracy, error);
    case OPTION_SET:
        return cli_add_override(options, optarg, error);
    case OPTION_TRUST:
        options->trust_netlist = true;
        return DEA_OK;
    case OPTION_ENGINE:
        return parse_engine(optarg, &options->engine, error);
    case OPTION_TIME_LIMIT:
        return parse_time_limit(optarg, &options->time_limit, error);
    case OPTION_JSON:
        options->json = true;
        return DEA_OK;
    case 'q':
        options->quiet = true;
        return DEA_OK;
    case 'v':
        options->verbose = true;
        return DEA_OK;
    default:
        return dea_fail(error, DEA_ERR_INTERNAL, "option %d is not taken", letter);
    }
}

int cli_parse_scene_options(int argc, char **argv, const char *usage, struct cli_options *options) {
    struct dea_error error;
    struct option known[ROWS + 1] = {{0}};
    memset(options, 0, sizeof *options);
    for (int i = 0, count = 0; i < ROWS; i++)
        if (strstr(rows[i].commands, argv[0]) != NULL)
            known[count++] = rows[i].option;
    enum dea_status status = cli_walk_options(argc, argv, usage, known, take_option, options, &error);
    if (status != DEA_OK)
        return cli_end(argv[0], status, &error);
    if (optind >= argc) {
        fprintf(stderr, "deasim %s: name a scene file\n%s", argv[0], usage);
        return 2;
    }
    if (optind + 1 < argc && strstr("run export", argv[0]) != NULL) {
        fprintf(stderr, "deasim %s: one scene at a time (deasim test runs several); what is \"%s\"?\n", argv[0],
                argv[optind + 1]);
        return 2;
    }
    return -1;
}

void cli_clear_options(struct cli_options *options) {
    for (size_t i = 0; i < options->override_count; i++)
        free(options->override_texts[i]);
    options->override_count = 0;
}

enum dea_status cli_read_scene(const char *path, const struct cli_options *options, struct dea_scene *scene) {
    struct dea_error error;
    enum dea_status status = dea_scene_read(path, options->overrides, options->override_count, scene, &error);
    if (status != DEA_OK)
        fprintf(stderr, "%s\n", error.text);
    else if (options->accuracy > 0.0)
        scene->accuracy = options->accuracy;
    return status;
}
