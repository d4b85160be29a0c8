/* Pairs of runs: one that leaves out what its scene does not need, and the same one that does not. The unit test judges
 * that they agree and what is spared, bench/skipping.sh prints it. */
#ifndef DEASIM_TEST_SKIPPED_H
#define DEASIM_TEST_SKIPPED_H

#include "coupled_capture.h"

enum skipped_way {
    SKIPPED_CIRCUIT, /* ngspice, where the circuit is linear */
    SKIPPED_POINTS,  /* device steps at every circuit point */
    SKIPPED_REST,    /* small steps at rest */
    SKIPPED_SIGNALS, /* signals nobody writes */
    SKIPPED_STATES   /* states that make no difference */
};

extern const char *const skipped_ways[]; /* names for people */

struct skipped {
    enum skipped_way way;
    const char *name;
    const char *device;  /* YAML of the lean scene's device */
    const char *full;    /* of the other one; NULL: the same */
    const char *drive;   /* YAML of the drive; a netlist in place is lean.cir */
    const char *other;   /* drive of the other one; NULL: the same */
    const char *netlist; /* written to lean.cir; NULL: none */
    double stop;         /* s */
    double accuracy;
    double least_gain; /* the other run takes so many times the steps, or has so many more states */
};

const struct skipped *list_skipped(size_t *count);

/* Runs the lean one or the other of a pair in the present folder, `samples` rows. The caller frees. */
void run_skipped(const struct skipped *pair, bool lean, size_t samples, struct coupled_rows *rows);

/* How many unknowns its device has. */
int count_states(const struct skipped *pair, bool lean);

#endif
