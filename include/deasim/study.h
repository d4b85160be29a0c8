/* The design problem of Rosset et al.: a membrane of given total length split into an active and a passive part. Which
 * split and prestretch move the platform farthest before something fails? SI throughout; displacements are relative to
 * the total length of both parts (eq. 10). */
#ifndef DEASIM_STUDY_H
#define DEASIM_STUDY_H

#include "deasim/design.h"

/* One design. Width and length do not matter to the relative answers. */
struct dea_design {
    struct dea_law elastic;
    struct dea_dielectric dielectric;
    double thickness;     /* t0, prestretched, 0 V, m */
    double prestretch[2]; /* lp1, lp2 */
    double active_ratio;  /* r_a, 0 to 1; the ends are the limits towards them */
    double max_voltage;   /* what the supply can give, V; INFINITY: no bound */
    double least_tension; /* Cauchy stress along the motion that every part must keep, Pa; 0: until slack */
    bool dead_load;       /* the passive part is replaced by the constant force that holds lp1 (r_a is not used) */
};

/* Where an increasing drive ends; slack1 is where the least tension is reached. All numbers but the mode are NAN when
 * the prestretch has failed. */
struct dea_design_end {
    enum dea_limit_mode mode;
    double lam_active, lam_passive; /* lam1 from the unstretched state; both lp1 + ... of eq. 3 */
    double stretch;                 /* lam_active / lp1 */
    double displacement;     /* d = r_a (stretch - 1); with a dead load stretch - 1, relative to the active part */
    double voltage;          /* V */
    double true_field;       /* V/m */
    double stress1, stress2; /* Cauchy stresses of the active part, Maxwell stress included, Pa */
    double passive_stress1;  /* of the passive part, Pa: the smallest tension in the device */
};

/* The design of the paper: Sylgard 186 (mu 0.365 MPa, Jm 16.6, eps_r 2.5, 100 V/um), t0 25 um, lp 1 x 2, r_a 0.5. */
struct dea_design dea_design_of_paper(void);

/* The design a device file describes: left zone active, right zone passive, or a dead load when there is no right
 * zone. DEA_ERR_INPUT when the left zone has no electrode. */
enum dea_status dea_design_from_device(const struct dea_device *device, struct dea_design *design,
                                       struct dea_error *error);

/* The device of a design, `length` (m) in total and `width` wide, with its right zone passive (`bidirectional` false)
 * or electroded. Prepared. */
enum dea_status dea_design_to_device(const struct dea_design *design, double width, double length, bool bidirectional,
                                     struct dea_device *device, struct dea_error *error);

/* First failure, or the supply's end, along increasing drive. A fraction of a microsecond for the stiffening laws
 * (Gent, neo-Hookean, Arruda-Boyce) with a constant dielectric; the general walk of dea_static_limit otherwise.
 * DEA_ERR_INPUT when a number is not physical. */
enum dea_status dea_design_limit(const struct dea_design *design, struct dea_design_end *end, struct dea_error *error);

/* ---- parameters by name: r_a, lp1, lp2, E_bd, Jm, mu, eps_r, t0 ---- */

enum dea_design_key {
    DEA_KEY_ACTIVE_RATIO,
    DEA_KEY_PRESTRETCH1,
    DEA_KEY_PRESTRETCH2,
    DEA_KEY_BREAKDOWN,
    DEA_KEY_JM,
    DEA_KEY_MODULUS,
    DEA_KEY_PERMITTIVITY,
    DEA_KEY_THICKNESS,
    DEA_KEY_COUNT
};

struct dea_design_key_info {
    const char *name;    /* as written on the command line */
    const char *si_unit; /* for dea_quantity_parse */
    const char *label;   /* axis text */
    const char *unit;    /* field unit of the axis */
    double factor;       /* field units per SI unit */
};

extern const struct dea_design_key_info dea_design_keys[DEA_KEY_COUNT];

/* DEA_KEY_COUNT when unknown; letter case does not matter. */
enum dea_design_key dea_design_key_find(const char *name);

/* DEA_ERR_INPUT when the law has no such parameter (Jm of a neo-Hookean film). */
enum dea_status dea_design_set(struct dea_design *design, enum dea_design_key key, double value,
                               struct dea_error *error);
double dea_design_get(const struct dea_design *design, enum dea_design_key key);

#endif
