/* Static answers about a device: equilibrium at given voltages, and the first failure as the drive of the left zone
 * grows (eq. 7 to 10 of Rosset et al., compact planar dielectric elastomer actuators). Viscoelastic branches are
 * relaxed, hence absent. SI throughout. */
#ifndef DEASIM_DESIGN_H
#define DEASIM_DESIGN_H

#include "deasim/device.h"

/* One zone in equilibrium. All fields are 0 when the zone is not present. */
struct dea_static_zone {
    double voltage;     /* V */
    double stretch;     /* lam1 from the unstretched state; the natural stretch when slack */
    double true_field;  /* V over deformed thickness, sign of V, V/m */
    double stress1;     /* Cauchy stress along the motion, Maxwell stress included, Pa */
    double stress2;     /* same across, Pa */
    double tension;     /* pull on the platform, N */
    double capacitance; /* F, 0 when passive */
    bool slack;         /* buckled out of plane, pulls with zero force */
};

struct dea_static_point {
    double x; /* displacement, m */
    struct dea_static_zone zones[DEA_ZONES];
    bool stable; /* d2 E_total / dx2 >= 0 at these voltages */
};

/* Equilibrium at voltages[left, right]: the first rest position met from x = 0 in the direction of the force, which is
 * where the platform stays when the voltages grew slowly. DEA_ERR_INPUT when a passive zone is given a voltage,
 * DEA_ERR_SOLVER when there is no equilibrium: nothing holds the platform, or the prestretch lies outside the law. */
enum dea_status dea_static_solve(const struct dea_device *device, const double voltages[DEA_ZONES],
                                 struct dea_static_point *point, struct dea_error *error);

/* Equilibrium in which the left zone carries a given true field (V/m); its voltage is part of the answer. On the taut
 * path this is explicit in x, so equilibria beyond an electromechanical instability are found too (stable = false). */
enum dea_status dea_static_solve_field(const struct dea_device *device, double true_field, double right_voltage,
                                       struct dea_static_point *point, struct dea_error *error);

enum dea_limit_mode {
    DEA_LIMIT_NONE,
    DEA_LIMIT_BREAKDOWN,   /* true field reaches the breakdown field in a zone */
    DEA_LIMIT_SLACK1,      /* a zone loses tension along the motion */
    DEA_LIMIT_SLACK2,      /* ... across it */
    DEA_LIMIT_LAW,         /* the elastic law's margin falls to DEA_LAW_MARGIN_LIMIT (Gent, Arruda-Boyce) */
    DEA_LIMIT_PRESTRETCH,  /* failed before any voltage */
    DEA_LIMIT_INSTABILITY, /* the voltage turns over: electromechanical instability */
    DEA_LIMIT_SUPPLY,      /* nothing failed up to the largest voltage of the supply (only where one is given) */
    DEA_LIMIT_COUNT
};

/* "none", "breakdown", "slack1", "slack2", "gent", "prestretch", "instability", "supply". */
extern const char *const dea_limit_names[DEA_LIMIT_COUNT];

#define DEA_LAW_MARGIN_LIMIT 1e-3 /* fraction of the law's range (Gent: D/Jm) below which it counts as hit */

/* First failure as the left voltage grows from 0. Numbers are NAN for none and prestretch. */
struct dea_limit {
    enum dea_limit_mode mode;
    double voltage;    /* left, V */
    double x;          /* m */
    double stretch;    /* lam1 / lp1 of the left zone */
    double true_field; /* in the left zone, V/m */
};

/* Finds it to the last bits of x. The left zone must carry an electrode. */
enum dea_status dea_static_limit(const struct dea_device *device, double right_voltage, struct dea_limit *limit,
                                 struct dea_error *error);

#endif
