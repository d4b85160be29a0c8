/* Union-find with path halving. */
#include "circuit/islands.h"

#include "circuit/netlist_internal.h"

#include <stdlib.h>

static int find_root(const struct dea_islands *islands, int node) {
    int at = node + 1;
    while (at < islands->count && islands->parents[at] != at)
        at = islands->parents[at];
    return at;
}

static bool make_room(struct dea_islands *islands, int node) {
    while (islands->count <= node + 1) {
        int *grown = dea_grow(islands->parents, islands->count, sizeof *grown);
        if (grown == NULL)
            return false;
        islands->parents = grown;
        grown[islands->count] = islands->count;
        islands->count++;
    }
    return true;
}

/* Halves the way of every node it passes, so that long ladders stay cheap. */
static void shorten_way(struct dea_islands *islands, int node) {
    int at = node + 1;
    while (islands->parents[at] != at) {
        islands->parents[at] = islands->parents[islands->parents[at]];
        at = islands->parents[at];
    }
}

bool dea_islands_join(struct dea_islands *islands, int p, int n) {
    if (!make_room(islands, p > n ? p : n))
        return false;
    shorten_way(islands, p);
    shorten_way(islands, n);
    int first = find_root(islands, p), second = find_root(islands, n);
    islands->parents[first > second ? first : second] = first > second ? second : first; /* ground stays a root */
    return true;
}

bool dea_islands_grounded(const struct dea_islands *islands, int node) {
    return find_root(islands, node) == 0;
}

int dea_islands_find_floating(const struct dea_islands *islands, int node_count) {
    for (int node = 0; node < node_count; node++)
        if (!dea_islands_grounded(islands, node))
            return node;
    return -1;
}

void dea_islands_clear(struct dea_islands *islands) {
    free(islands->parents);
    *islands = (struct dea_islands){0};
}
