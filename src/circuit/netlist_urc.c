/* Uniform RC lines (U): ngspice replaces each by a chain of elements before the run, and takes time that grows with the
 * square of their number. Nothing ends it meanwhile, so the number is bounded here. */
#include "circuit/netlist_internal.h"

#include <string.h>

#define MOST_LUMPS 200 /* of a line; ngspice takes 1 ms for so many, 38 s for 10000 */
#define LEAST_GROWTH                                                                                                   \
    1.2                    /* of the chain's elements from one to the next: their number is a logarithm over that of k \
                            */
#define MOST_GROWTH 1000.0 /* a power of it overflows */

/* The plain number given as `name = value` or `name value` in what follows; whatever else is refused. */
static enum dea_status check_range(struct dea_netlist_job *job, int index, const char *cursor, const char *name,
                                   double least, double most) {
    char token[DEA_TOKEN_MAX];
    while (dea_netlist_token(&cursor, token)) {
        double value;
        if (strcmp(token, name) != 0)
            continue;
        bool given = dea_netlist_token(&cursor, token);
        if (given && strcmp(token, "=") == 0)
            given = dea_netlist_token(&cursor, token);
        if (!given || !dea_spice_number(token, &value) || !(value >= least && value <= most))
            return dea_netlist_fail(job, index, "%s of a URC line must be a plain number from %g to %g, not \"%.40s\"",
                                    name, least, most, given ? token : "");
    }
    return DEA_OK;
}

enum dea_status dea_netlist_check_urc(struct dea_netlist_job *job, int index) {
    const char *cursor = job->netlist->lines[index].text;
    char token[DEA_TOKEN_MAX];
    int words = 0;
    if (cursor[0] == '.') { /* .model name type parameters */
        while (words < 3 && dea_netlist_token(&cursor, token))
            words++;
        return strcmp(token, "urc") == 0 ? check_range(job, index, cursor, "k", LEAST_GROWTH, MOST_GROWTH) : DEA_OK;
    }
    while (words < 5 && dea_netlist_token(&cursor, token)) /* Uname n1 n2 n3 model parameters */
        words++;
    return check_range(job, index, cursor, "n", 1.0, MOST_LUMPS);
}
