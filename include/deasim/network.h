/* A linear circuit as equations G w + C w' = sources + port currents, w node voltages (V) then branch currents (A):
 * modified nodal analysis (Ho, Ruehli, Brennan, 1975). Rows of nodes are Kirchhoff's current law (A), rows of branches
 * voltage laws (V). */
#ifndef DEASIM_NETWORK_H
#define DEASIM_NETWORK_H

#include "deasim/device.h"
#include "deasim/waveform.h"

/* One entry of G or C. */
struct dea_stamp {
    int row, column;
    double value;
};

/* An independent source: its value enters a row, and a second one with the other sign (a current source between two
 * nodes). */
struct dea_network_source {
    int row, other_row;           /* ABSENT is -1: ground or none */
    struct dea_waveform waveform; /* V or A */
};

/* A node held at a voltage (V) while the operating point is sought, and let go at once: .ic without uic. */
struct dea_network_initial {
    int node;
    double voltage;
};

/* Pins of one electroded zone: unknowns of p and n, -1 for ground. */
struct dea_network_port {
    int p, n;
};

struct dea_network {
    int node_count, branch_count; /* unknowns: nodes first */
    char **names;                 /* owned; of the unknowns: "left", "l1#branch" */
    bool *imposed; /* owned; branch currents of voltage sources: fixed by the rest, never error-controlled */
    struct dea_stamp *conductances; /* owned; G */
    struct dea_stamp *capacitances; /* owned; C */
    size_t conductance_count, capacitance_count;
    struct dea_network_source *sources; /* owned */
    size_t source_count;
    struct dea_network_initial *initials; /* owned */
    size_t initial_count;
    struct dea_network_port ports[DEA_ZONES]; /* by zone */
    double peak;                              /* largest |source voltage|, V, for scales */
};

void dea_network_clear(struct dea_network *network);

#endif
