/* Which nodes of a circuit hang together by what conducts at rest: union-find (Galler, Fischer, 1964). */
#ifndef DEASIM_CIRCUIT_ISLANDS_H
#define DEASIM_CIRCUIT_ISLANDS_H

#include <stdbool.h>

/* Zero before use; nodes are numbered from 0, ground is -1. */
struct dea_islands {
    int *parents; /* owned; of node i at i + 1 */
    int count;
};

/* False when out of memory. */
bool dea_islands_join(struct dea_islands *islands, int p, int n);

/* Does the node hang together with ground? */
bool dea_islands_grounded(const struct dea_islands *islands, int node);

/* The first of so many nodes that does not, -1 when all do. */
int dea_islands_find_floating(const struct dea_islands *islands, int node_count);

void dea_islands_clear(struct dea_islands *islands);

#endif
