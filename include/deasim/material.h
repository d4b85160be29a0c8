/* Elastic laws, viscoelastic branches and the dielectric of a membrane.
 * Stretches are dimensionless and measured from the unstretched state; moduli, stresses and energies per volume in Pa.
 */
#ifndef DEASIM_MATERIAL_H
#define DEASIM_MATERIAL_H

#include "deasim/status.h"

#include <stdbool.h>

#define DEA_VACUUM_PERMITTIVITY 8.8541878128e-12 /* F/m, CODATA 2018 */
#define DEA_MAX_OGDEN_TERMS 6
#define DEA_MAX_YEOH_TERMS 3

enum dea_law_kind { DEA_GENT, DEA_NEO_HOOKEAN, DEA_YEOH, DEA_OGDEN, DEA_ARRUDA_BOYCE, DEA_LAW_COUNT };

/* Parameters of the equilibrium spring; only those of `kind` are read. */
struct dea_law {
    enum dea_law_kind kind;
    double mu;                               /* shear modulus, Pa (gent, neo-hookean, arruda-boyce) */
    double jm;                               /* Gent limit of I1 - 3, dimensionless */
    double locking_stretch;                  /* arruda-boyce lam_L, dimensionless */
    int yeoh_terms;                          /* number of Yeoh coefficients */
    double yeoh[DEA_MAX_YEOH_TERMS];         /* C10, C20, C30, Pa; W = sum C_i0 (I1 - 3)^i */
    int ogden_terms;                         /* number of Ogden terms */
    double ogden_mu[DEA_MAX_OGDEN_TERMS];    /* Pa; W = sum mu_p / alpha_p (l1^a + l2^a + l3^a - 3) */
    double ogden_alpha[DEA_MAX_OGDEN_TERMS]; /* dimensionless */
};

/* What one evaluation of a law gives at (lam1, lam2), incompressible, lam3 = 1/(lam1 lam2). */
struct dea_stress {
    double w1;  /* dW/dlam1, Pa */
    double w11; /* d2W/dlam1^2, Pa */
    double w2;  /* dW/dlam2, Pa */
};

/* Stretch energy per volume (Pa), 0 at rest. Returns DEA_RECOVERABLE outside the law's domain (physics: D <= 0). */
enum dea_status dea_law_energy(const struct dea_law *law, double lam1, double lam2, double *energy);

/* First and second derivatives of the energy. Returns DEA_RECOVERABLE outside the domain; *stress is then untouched. */
enum dea_status dea_law_stress(const struct dea_law *law, double lam1, double lam2, struct dea_stress *stress);

/* Distance to the law's limit as a fraction: Gent D/Jm, Arruda-Boyce 1 - I1/(3 lam_L^2); 1 for laws without a limit.
 * Positive inside the domain. */
double dea_law_margin(const struct dea_law *law, double lam1, double lam2);

/* Shear modulus at rest (Pa), for scales. */
double dea_law_modulus(const struct dea_law *law);

/* Name as written in a material file ("gent", ...) and back; the latter returns DEA_LAW_COUNT when unknown. */
const char *dea_law_name(enum dea_law_kind kind);
enum dea_law_kind dea_law_from_name(const char *name);

/* ---- viscoelastic branches ---- */

/* Foo et al., J. Appl. Phys. 111, 034102 (2012): Gent or neo-Hookean spring in series with a dashpot.
 * Network: transient network, Linder, Tkachuk, Miehe (2011), linear in pure shear. */
enum dea_branch_kind { DEA_BRANCH_FOO, DEA_BRANCH_NETWORK };

struct dea_branch {
    enum dea_branch_kind kind;
    double mu;  /* spring modulus mu_b (network: G), Pa, > 0 */
    double tau; /* relaxation time eta_b / mu_b, s, > 0 */
    double jm;  /* Gent limit of the spring (foo); INFINITY means neo-Hookean */
};

/* Two internal states per branch, stored relative to the relaxed prestretched state so that 0 means "relaxed there":
 * foo      z0 = xi1/lp1 - 1,        z1 = xi2/lp2 - 1
 * network  z0 = a1 lp1^2 - 1,       z1 = a3/(lp1 lp2)^2 - 1 */
struct dea_branch_state {
    double z[2];
};

/* Everything the plant needs of one branch at one stretch, with derivatives for the analytic Jacobian. */
struct dea_branch_response {
    double p1;        /* contribution to the nominal stress P1 = s1/lam1, Pa */
    double s2;        /* true stress in direction 2, Pa */
    double dp1_dlam1; /* Pa */
    double dp1_dz[2]; /* Pa */
    double rate[2];   /* dz/dt, 1/s */
    double drate_dlam1[2];
    double drate_dz[2][2]; /* row: rate, column: z */
    double dissipation;    /* per volume, W/m^3, >= 0 */
};

/* Evaluates a branch at stretch lam1 with lam2 = prestretch[1] clamped. `with_derivatives` false leaves the derivative
 * fields untouched. Returns DEA_RECOVERABLE outside the spring's domain (Gent limit, xi <= 0). */
enum dea_status dea_branch_respond(const struct dea_branch *branch, const double prestretch[2], double lam1,
                                   const double z[2], bool with_derivatives, struct dea_branch_response *response);

/* Stored energy per volume of a branch, Pa. */
enum dea_status dea_branch_energy(const struct dea_branch *branch, const double prestretch[2], double lam1,
                                  const double z[2], double *energy);

/* State of a branch that has fully relaxed at lam1 (0 stress). */
void dea_branch_relaxed(const struct dea_branch *branch, const double prestretch[2], double lam1, double z[2]);

/* State of a branch right after the prestretch was applied (xi = 1). */
void dea_branch_fresh(const struct dea_branch *branch, const double prestretch[2], double z[2]);

/* ---- dielectric ---- */

struct dea_dielectric {
    double permittivity;        /* relative, at lam1 = 0 of the linear law: eps_r = permittivity + slope lam1 */
    double permittivity_slope;  /* d eps_r / d lam1, dimensionless */
    double breakdown;           /* true field, V/m; with exponents 0 a constant; INFINITY when not given */
    double breakdown_reference; /* reference thickness of the power law, m */
    double breakdown_thickness_exponent; /* m in E_bd = breakdown (h/h_ref)^-m lam^n, h deformed thickness */
    double breakdown_stretch_exponent;   /* n; lam = sqrt(lam1 lam2) */
    double conductivity;                 /* s0, S/m */
    double conductivity_field;           /* E_B in sigma = s0 exp(E/E_B), V/m; INFINITY means ohmic */
};

struct dea_material {
    char name[64];
    struct dea_law elastic;
    struct dea_branch *branches; /* owned; NULL when branch_count is 0 */
    int branch_count;
    struct dea_dielectric dielectric;
    double density; /* kg/m^3 */
};

/* Breakdown field (V/m, true) of a film of deformed thickness (m) at stretches lam1, lam2. */
double dea_breakdown_field(const struct dea_dielectric *dielectric, double thickness, double lam1, double lam2);

/* Leakage current density (A/m^2) at true field E (V/m, either sign) and its derivative by E (A/(V m)). */
double dea_leakage_density(const struct dea_dielectric *dielectric, double true_field, double *derivative);

#endif
