/* The design that moves its platform farthest: exact where a closed form or a single root exists, searched otherwise.
 */
#ifndef DEASIM_OPTIMUM_H
#define DEASIM_OPTIMUM_H

#include "deasim/study.h"

/* What may be chosen, and from what range. */
struct dea_optimum_task {
    struct dea_design base;
    struct {
        bool free;
        bool ranged;      /* the user gave a range; otherwise the widest sensible one */
        double low, high; /* SI; set by dea_optimum_find when not ranged */
    } keys[DEA_KEY_COUNT];
    bool both_ways; /* both parts carry electrodes and are driven in turn: the stroke from end to end counts */
};

enum dea_optimum_method {
    DEA_OPTIMUM_GIVEN,  /* nothing was free */
    DEA_OPTIMUM_CLOSED, /* closed forms and at most one root */
    DEA_OPTIMUM_SEARCH, /* grid, then subplex */
};

struct dea_optimum {
    struct dea_design design;
    struct dea_design_end end;
    double stroke; /* what was maximised: d, or d of both directions together */
    enum dea_optimum_method method;
    bool at_bound[DEA_KEY_COUNT]; /* the best value of a free key is an end of its range */
    /* static margin to loss of tension: the drive that would lose it if nothing else failed; NAN when it never does */
    enum dea_limit_mode slack_mode; /* slack1 or slack2 */
    double slack_voltage;           /* V */
    double slack_field;             /* V/m */
};

/* DEA_ERR_INPUT when no design in the ranges works or a range is empty. */
enum dea_status dea_optimum_find(const struct dea_optimum_task *task, struct dea_optimum *optimum,
                                 struct dea_error *error);

/* The best stretches (active and passive, at breakdown) at the lp2 of a design: they do not depend on r_a. Exact for
 * stiffening laws with a constant dielectric when breakdown, not slack, ends the drive.
 * DEA_RECOVERABLE when there is no such pair. */
enum dea_status dea_optimum_pair(const struct dea_design *design, double *lam_active, double *lam_passive);

/* Empirical rule of the paper for the best lp2 of a Gent film: (lp2/0.57)^2 + 2/(lp2/0.57) - 3 - Jm = 0. Eq. 11 as
 * printed has 0.57 lp2 instead, which contradicts the text around it. */
double dea_rule_lp2(double jm);

/* The exact law behind it: lp2 = sqrt((Jm + 3)/3), whatever mu, eps, E_bd, t0 and r_a. */
double dea_exact_lp2(double jm);

#endif
