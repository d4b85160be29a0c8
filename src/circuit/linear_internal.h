/* What reading a linear circuit shares between its files. */
#ifndef DEASIM_CIRCUIT_LINEAR_INTERNAL_H
#define DEASIM_CIRCUIT_LINEAR_INTERNAL_H

#include "circuit/islands.h"
#include "circuit/linear.h"
#include "circuit/netlist_internal.h"

#define NOMINAL_TEMPERATURE                                                                                            \
    27.0 /* Celsius; that of the circuit as well, options that change it are not linear here                           \
          */

enum { GROUND = -1 };

/* Rows of branches are numbered from here on until the number of nodes is known. */
enum { BRANCH = 1 << 24 };

/* A voltage-defined branch and the element it belongs to. */
struct branch {
    char *name;        /* owned: "l1", "v.xa.v2" */
    double inductance; /* H */
    bool multiplied;   /* several inductors in parallel */
    bool imposed;
};

struct reader {
    struct dea_network *network;
    struct branch *branches; /* owned */
    int branch_count;
    struct dea_islands islands; /* of what conducts at rest */
    char *line;                 /* owned copy of the present line, cut into words */
    char **words;               /* owned */
    int word_count;
    double step, stop;
    bool linear;
    struct dea_error *error;
};

/* The unknown of a node, a new one where the name is; GROUND is none. */
enum dea_status dea_linear_find_node(struct reader *reader, const char *name, int *node);

/* The element of the present line; `second` is the pass for elements that refer to others. */
enum dea_status dea_linear_read_element(struct reader *reader, bool second);

/* .ic v(node)=value ..., when all nodes are known. */
enum dea_status dea_linear_read_initials(struct reader *reader);

/* Adds the independent source of the present line, `multiplier` of them, to these rows; or finds it not linear. */
enum dea_status dea_linear_add_source(struct reader *reader, int row, int other_row, double multiplier);

#endif
