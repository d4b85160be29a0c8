/* Walking a command's arguments. */
#ifndef DEASIM_CLI_ARGUMENTS_H
#define DEASIM_CLI_ARGUMENTS_H

#include "deasim/status.h"

#include <getopt.h>

/* Takes one option into `options`: `letter` is its row's val, optarg its value. DEA_STOPPED ends the walk without
 * error, as for --help. */
typedef enum dea_status cli_take_option(int letter, void *options, struct dea_error *error);

/* Hands each option of the command argv[0] to `take`; `letters` and `known` are getopt_long's. Afterwards optind is the
 * first argument that is no option. DEA_ERR_INPUT for an option that is unknown, lacks its value or takes none; the
 * message names it and the command's --help. */
enum dea_status cli_walk_options(int argc, char **argv, const char *letters, const struct option *known,
                                 cli_take_option *take, void *options, struct dea_error *error);

#endif
