/* What `map` and `optimum` have in common on the command line: the design they start from. */
#ifndef DEASIM_CLI_DESIGN_OPTIONS_H
#define DEASIM_CLI_DESIGN_OPTIONS_H

#include "cli/range.h"
#include "deasim/study.h"

#include <getopt.h>

enum { CLI_DESIGN_SET = 512, CLI_DESIGN_DEAD_LOAD, CLI_DESIGN_MAX_VOLTAGE, CLI_DESIGN_MAX_SETS = 16 };

/* Rows for a getopt_long table. */
#define CLI_DESIGN_LONG_OPTIONS                                                                                        \
    {"set", required_argument, NULL, CLI_DESIGN_SET}, {"dead-load", no_argument, NULL, CLI_DESIGN_DEAD_LOAD}, {        \
        "max-voltage", required_argument, NULL, CLI_DESIGN_MAX_VOLTAGE                                                 \
    }

struct cli_design_options {
    struct {
        enum dea_design_key key;
        double value;
    } sets[CLI_DESIGN_MAX_SETS];
    int set_count;
    bool dead_load;
    double max_voltage; /* V; 0: not given */
};

/* Takes one of the options above; any other letter is DEA_ERR_INTERNAL. */
enum dea_status cli_parse_design_option(int letter, struct cli_design_options *options, struct dea_error *error);

/* Looks up a parameter name; the message lists the names. */
enum dea_status cli_find_design_key(const char *option, const char *name, enum dea_design_key *key,
                                    struct dea_error *error);

/* Value of a parameter that is larger than a film's can be, or smaller: a unit is missing. What no film can have at all
 * is for the design itself to refuse. */
enum dea_status cli_check_design_value(const char *option, enum dea_design_key key, double value,
                                       struct dea_error *error);

/* "FIRST:LAST:POINTS" of a parameter, and "FIRST:LAST", which are two points. */
enum dea_status cli_parse_design_range(const char *option, enum dea_design_key key, const char *text,
                                       struct dea_range *range, struct dea_error *error);
enum dea_status cli_parse_design_span(const char *option, enum dea_design_key key, const char *text,
                                      struct dea_range *range, struct dea_error *error);

/* After getopt: reads the device file when one is left in argv, else starts from the paper's design; applies the
 * options. `device` (may be NULL) receives the device itself, that of the paper without a file; the caller clears it,
 * also after a failure. */
enum dea_status cli_finish_design(int argc, char **argv, const struct cli_design_options *options,
                                  struct dea_design *design, struct dea_device *device, struct dea_error *error);

#endif
