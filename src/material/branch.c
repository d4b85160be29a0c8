/* Maxwell branches at finite strain: Foo et al. (2012) and the transient network of Linder et al. (2011). */
#include "deasim/material.h"

#include <math.h>

/* ---- Foo: Gent or neo-Hookean spring at elastic stretches lam_i/xi_i, xi_i = lp_i (1 + z_i) ---- */

struct foo_spring {
    double e1, e2;   /* elastic stretches squared */
    double e3;       /* (xi1 xi2 / lam1 lam2)^2 */
    double softness; /* 1 - (I1e - 3)/J_b, > 0 inside the domain */
};

static enum dea_status stretch_foo_spring(const struct dea_branch *branch, const double prestretch[2], double lam1,
                                          const double z[2], struct foo_spring *spring) {
    double xi1 = prestretch[0] * (1.0 + z[0]), grown2 = 1.0 + z[1];
    if (!(lam1 > 0.0 && xi1 > 0.0 && grown2 > 0.0))
        return DEA_RECOVERABLE;
    double r1 = lam1 / xi1, r2 = 1.0 / grown2; /* lam2 = lp2 is clamped */
    spring->e1 = r1 * r1;
    spring->e2 = r2 * r2;
    spring->e3 = 1.0 / (spring->e1 * spring->e2);
    spring->softness = 1.0 - (spring->e1 + spring->e2 + spring->e3 - 3.0) / branch->jm;
    return spring->softness > 0.0 ? DEA_OK : DEA_RECOVERABLE;
}

static enum dea_status respond_foo(const struct dea_branch *branch, const double prestretch[2], double lam1,
                                   const double z[2], bool with_derivatives, struct dea_branch_response *out) {
    struct foo_spring s;
    DEA_TRY(stretch_foo_spring(branch, prestretch, lam1, z, &s));
    double g = branch->mu / s.softness, eta3 = 3.0 * branch->mu * branch->tau;
    double s1 = g * (s.e1 - s.e3), s2 = g * (s.e2 - s.e3);
    double flow1 = (s1 - 0.5 * s2) / eta3, flow2 = (s2 - 0.5 * s1) / eta3;
    out->p1 = s1 / lam1;
    out->s2 = s2;
    out->rate[0] = (1.0 + z[0]) * flow1;
    out->rate[1] = (1.0 + z[1]) * flow2;
    out->dissipation = (s1 * s1 - s1 * s2 + s2 * s2) / eta3;

    /* logarithmic derivatives of the elastic stretches: q1 = ln(lam1/xi1), q2 = ln(lam2/xi2) */
    double g_by_q1 = g * 2.0 * (s.e1 - s.e3) / (branch->jm * s.softness);
    double s1_q1 = g * 2.0 * (s.e1 + s.e3) + g_by_q1 * (s.e1 - s.e3);
    out->dp1_dlam1 = (s1_q1 - s1) / (lam1 * lam1);
    if (!with_derivatives)
        return DEA_OK;
    double g_by_q2 = g * 2.0 * (s.e2 - s.e3) / (branch->jm * s.softness);
    double s1_q2 = g * 2.0 * s.e3 + g_by_q2 * (s.e1 - s.e3);
    double s2_q1 = g * 2.0 * s.e3 + g_by_q1 * (s.e2 - s.e3);
    double s2_q2 = g * 2.0 * (s.e2 + s.e3) + g_by_q2 * (s.e2 - s.e3);
    double q1_z0 = -1.0 / (1.0 + z[0]), q2_z1 = -1.0 / (1.0 + z[1]), q1_lam = 1.0 / lam1;

    out->dp1_dz[0] = s1_q1 * q1_z0 / lam1;
    out->dp1_dz[1] = s1_q2 * q2_z1 / lam1;
    double flow1_q1 = (s1_q1 - 0.5 * s2_q1) / eta3, flow1_q2 = (s1_q2 - 0.5 * s2_q2) / eta3;
    double flow2_q1 = (s2_q1 - 0.5 * s1_q1) / eta3, flow2_q2 = (s2_q2 - 0.5 * s1_q2) / eta3;
    out->drate_dlam1[0] = (1.0 + z[0]) * flow1_q1 * q1_lam;
    out->drate_dlam1[1] = (1.0 + z[1]) * flow2_q1 * q1_lam;
    out->drate_dz[0][0] = flow1 - flow1_q1;
    out->drate_dz[0][1] = (1.0 + z[0]) * flow1_q2 * q2_z1;
    out->drate_dz[1][0] = (1.0 + z[1]) * flow2_q1 * q1_z0;
    out->drate_dz[1][1] = flow2 - flow2_q2;
    return DEA_OK;
}

static enum dea_status foo_energy(const struct dea_branch *branch, const double prestretch[2], double lam1,
                                  const double z[2], double *energy) {
    struct foo_spring s;
    DEA_TRY(stretch_foo_spring(branch, prestretch, lam1, z, &s));
    double excess = s.e1 + s.e2 + s.e3 - 3.0;
    *energy =
        isinf(branch->jm) ? 0.5 * branch->mu * excess : -0.5 * branch->mu * branch->jm * log1p(-excess / branch->jm);
    return DEA_OK;
}

/* ---- network: a1 = (1 + z0)/lp1^2, a3 = (1 + z1) (lp1 lp2)^2, a2 = lam2^-2 constant ---- */

struct network_state {
    double stretched1; /* lam1^2 a1 */
    double stretched3; /* a3 / (lam1 lam2)^2 */
};

static enum dea_status stretch_network(const double prestretch[2], double lam1, const double z[2],
                                       struct network_state *state) {
    if (!(lam1 > 0.0 && z[0] > -1.0 && z[1] > -1.0))
        return DEA_RECOVERABLE;
    double r = lam1 / prestretch[0];
    state->stretched1 = r * r * (1.0 + z[0]);
    state->stretched3 = (1.0 + z[1]) / (r * r);
    return DEA_OK;
}

static enum dea_status respond_network(const struct dea_branch *branch, const double prestretch[2], double lam1,
                                       const double z[2], bool with_derivatives, struct dea_branch_response *out) {
    struct network_state s;
    DEA_TRY(stretch_network(prestretch, lam1, z, &s));
    double r = lam1 / prestretch[0], mu = branch->mu, tau = branch->tau;
    double s1 = mu * (s.stretched1 - s.stretched3);
    out->p1 = s1 / lam1;
    out->s2 = mu * (1.0 - s.stretched3); /* lam2^2 a2 = 1 */
    out->rate[0] = (1.0 / (r * r) - 1.0 - z[0]) / tau;
    out->rate[1] = (r * r - 1.0 - z[1]) / tau;
    /* written as squares so that it cannot cancel to a negative number */
    double d1 = s.stretched1 - 1.0, d3 = s.stretched3 - 1.0;
    out->dissipation = 0.5 * mu / tau * (d1 * d1 / s.stretched1 + d3 * d3 / s.stretched3);
    out->dp1_dlam1 = mu * (s.stretched1 + 3.0 * s.stretched3) / (lam1 * lam1);
    if (!with_derivatives)
        return DEA_OK;
    out->dp1_dz[0] = mu * r * r / lam1;
    out->dp1_dz[1] = -mu / (r * r * lam1);
    out->drate_dlam1[0] = -2.0 / (r * r * r * prestretch[0] * tau);
    out->drate_dlam1[1] = 2.0 * r / (prestretch[0] * tau);
    out->drate_dz[0][0] = out->drate_dz[1][1] = -1.0 / tau;
    out->drate_dz[0][1] = out->drate_dz[1][0] = 0.0;
    return DEA_OK;
}

/* W = G/2 [lam1^2 a1 + 1 + a3/(lam1 lam2)^2 - 3 - ln(a1 a3 / lam2^2)]; the logarithm is what makes the stated
 * dissipation close the balance: dW/dz . z' + dissipation = 0 at fixed stretch. */
static enum dea_status network_energy(const struct dea_branch *branch, const double prestretch[2], double lam1,
                                      const double z[2], double *energy) {
    struct network_state s;
    DEA_TRY(stretch_network(prestretch, lam1, z, &s));
    *energy = 0.5 * branch->mu * (s.stretched1 + s.stretched3 - 2.0 - log1p(z[0]) - log1p(z[1]));
    return DEA_OK;
}

/* ---- public ---- */

enum dea_status dea_branch_respond(const struct dea_branch *branch, const double prestretch[2], double lam1,
                                   const double z[2], bool with_derivatives, struct dea_branch_response *response) {
    return branch->kind == DEA_BRANCH_FOO ? respond_foo(branch, prestretch, lam1, z, with_derivatives, response)
                                          : respond_network(branch, prestretch, lam1, z, with_derivatives, response);
}

enum dea_status dea_branch_energy(const struct dea_branch *branch, const double prestretch[2], double lam1,
                                  const double z[2], double *energy) {
    return branch->kind == DEA_BRANCH_FOO ? foo_energy(branch, prestretch, lam1, z, energy)
                                          : network_energy(branch, prestretch, lam1, z, energy);
}

void dea_branch_relaxed(const struct dea_branch *branch, const double prestretch[2], double lam1, double z[2]) {
    double r = lam1 / prestretch[0];
    if (branch->kind == DEA_BRANCH_FOO) {
        z[0] = r - 1.0;
        z[1] = 0.0;
    } else {
        z[0] = 1.0 / (r * r) - 1.0;
        z[1] = r * r - 1.0;
    }
}

void dea_branch_fresh(const struct dea_branch *branch, const double prestretch[2], double z[2]) {
    double both = prestretch[0] * prestretch[1];
    if (branch->kind == DEA_BRANCH_FOO) {
        z[0] = 1.0 / prestretch[0] - 1.0;
        z[1] = 1.0 / prestretch[1] - 1.0;
    } else { /* a1 = a3 = 1: no memory of the prestretch */
        z[0] = prestretch[0] * prestretch[0] - 1.0;
        z[1] = 1.0 / (both * both) - 1.0;
    }
}
