/* Walking a command's arguments with getopt_long. */
#include "cli/arguments.h"

#include <stdio.h>

/* What getopt_long refuses, without its own message on the terminal. */
static enum dea_status refuse_option(int verdict, char **argv, const struct option *known, struct dea_error *error) {
    const char *command = argv[0], *written = argv[optind - 1];
    if (verdict == ':')
        return dea_fail(error, DEA_ERR_INPUT, "a value is missing after %s, see deasim %s --help", written, command);
    for (const struct option *row = known; optopt != 0 && row->name != NULL; row++)
        if (row->val == optopt && row->has_arg == no_argument)
            return dea_fail(error, DEA_ERR_INPUT, "--%s takes no value, see deasim %s --help", row->name, command);
    if (optopt != 0)
        return dea_fail(error, DEA_ERR_INPUT, "unknown option -%c, see deasim %s --help", optopt, command);
    return dea_fail(error, DEA_ERR_INPUT, "unknown option %s, see deasim %s --help", written, command);
}

enum dea_status cli_walk_options(int argc, char **argv, const char *usage, const struct option *known,
                                 cli_take_option *take, void *options, struct dea_error *error) {
    char letters[64] = ":"; /* a leading colon tells a missing value from an unknown option */
    size_t used = 1;
    for (const struct option *row = known; row->name != NULL && used + 3 < sizeof letters; row++)
        if (row->val < 256)
            used += (size_t)snprintf(letters + used, sizeof letters - used, "%c%s", row->val,
                                     row->has_arg == required_argument ? ":" : "");
    optind = 1;
    opterr = 0;
    for (int letter; (letter = getopt_long(argc, argv, letters, known, NULL)) != -1;) {
        if (letter == ':' || letter == '?')
            return refuse_option(letter, argv, known, error);
        if (letter == 'h') {
            fputs(usage, stdout);
            return DEA_STOPPED;
        }
        DEA_TRY(take(letter, options, error));
    }
    return DEA_OK;
}

int cli_report(const char *command, const struct dea_error *error) {
    fprintf(stderr, "deasim %s: %s\n", command, error->text);
    return dea_exit_code(error->status);
}

int cli_end(const char *command, enum dea_status status, const struct dea_error *error) {
    return status < 0 ? cli_report(command, error) : 0;
}
