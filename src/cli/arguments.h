/* Walking a command's arguments. */
#ifndef DEASIM_CLI_ARGUMENTS_H
#define DEASIM_CLI_ARGUMENTS_H

#include "deasim/status.h"

#include <getopt.h>

/* Takes one option into `options`: `letter` is its row's val, optarg its value. */
typedef enum dea_status cli_take_option(int letter, void *options, struct dea_error *error);

/* Hands each option of the command argv[0] to `take`; `known` is getopt_long's table, a val below 256 being the short
 * option too. 'h' is taken here: it prints the usage and ends the walk with DEA_STOPPED. Afterwards optind is the first
 * argument that is no option. DEA_ERR_INPUT for an option that is unknown, lacks its value or takes none; the message
 * names it and the command's --help. */
enum dea_status cli_walk_options(int argc, char **argv, const char *usage, const struct option *known,
                                 cli_take_option *take, void *options, struct dea_error *error);

/* "deasim COMMAND: message" on stderr; returns the exit code of the status. */
int cli_report(const char *command, const struct dea_error *error);

/* The exit code of a command that ended so; a failure is reported. */
int cli_end(const char *command, enum dea_status status, const struct dea_error *error);

#endif
