/* A second, independent program for the same physics, to judge the first: written straight from physics formulas,
 * shares no code with src/, extended precision, explicit extrapolation integrator that stops at every kink. */
#ifndef DEASIM_TEST_INDEPENDENT_H
#define DEASIM_TEST_INDEPENDENT_H

#include "deasim/scene.h"

enum { INDEPENDENT_EVENTS = 512 };

struct independent_trace {
    size_t count;                              /* samples, at i stop / (count - 1) */
    double *x;                                 /* m */
    double *v;                                 /* m/s */
    double *port[DEA_ZONES], *film[DEA_ZONES]; /* V, at the port and at the film */
    int event_count;
    struct {
        double t; /* s */
        enum dea_event_kind kind;
        int zone;
        bool cleared;
    } events[INDEPENDENT_EVENTS];   /* breakdown, slack, stops */
    double work, branch_loss, loss; /* J: by the sources and the load, in branches, all losses */
    double stored;                  /* J: change */
    long steps;
    char trouble[200]; /* why it gave up; empty when it did not */
};

/* Runs a native scene with `tolerance` per step (relative to each state's largest value). False with trace->trouble
 * when it cannot. The caller frees. Ideal sources that jump are not booked in `work`. */
bool independent_run(const struct dea_scene *scene, double tolerance, size_t samples, struct independent_trace *trace);
void independent_free(struct independent_trace *trace);

#endif
