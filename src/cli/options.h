/* What the commands that read scenes have in common on the command line. */
#ifndef DEASIM_CLI_OPTIONS_H
#define DEASIM_CLI_OPTIONS_H

#include "deasim/run.h"

#include <stdbool.h>

enum { CLI_MAX_OVERRIDES = 64 };

struct cli_options {
    const char *directory; /* -o; NULL: none */
    double accuracy;       /* --accuracy; 0: as in the scene */
    struct dea_override overrides[CLI_MAX_OVERRIDES];
    char *override_texts[CLI_MAX_OVERRIDES]; /* owned copies the overrides point into */
    size_t override_count;
    bool json, quiet, verbose;
    bool trust_netlist;            /* --trust-netlist */
    enum dea_engine_choice engine; /* --engine */
    double time_limit;             /* --time-limit, s; 0: none */
};

/* Parses those options that the command argv[0] (run, check, test, export) takes; afterwards optind is the first scene.
 * Returns -1 to go on, else the exit code (help printed, or a mistake reported on stderr). `usage` is the command's
 * help text. */
int cli_parse_scene_options(int argc, char **argv, const char *usage, struct cli_options *options);
void cli_clear_options(struct cli_options *options);

/* Reads a scene with the options applied; reports a failure on stderr. */
enum dea_status cli_read_scene(const char *path, const struct cli_options *options, struct dea_scene *scene);

/* Splits "key=value" into an override. */
enum dea_status cli_add_override(struct cli_options *options, const char *text, struct dea_error *error);

#endif
