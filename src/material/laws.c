/* Elastic laws behind one table. All but Ogden depend on the first invariant alone, so each of them only supplies
 * its energy and the derivatives by I1; the chain rule to stretches is shared. */
#include "deasim/material.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

/* Energy and its derivatives by I1, at a given excess = I1 - 3. */
struct invariant_response {
    double first;  /* dW/dI1, Pa */
    double second; /* d2W/dI1^2, Pa */
};

struct law_functions {
    const char *name;
    enum dea_status (*energy)(const struct dea_law *, double excess, double *energy);
    enum dea_status (*response)(const struct dea_law *, double excess, struct invariant_response *);
    double (*margin)(const struct dea_law *, double excess);
    double (*modulus)(const struct dea_law *);
};

/* ---- Gent ---- */

static double gent_margin(const struct dea_law *law, double excess) {
    return (law->jm - excess) / law->jm;
}

static enum dea_status gent_energy(const struct dea_law *law, double excess, double *energy) {
    if (!(excess < law->jm))
        return DEA_RECOVERABLE;
    *energy = -0.5 * law->mu * law->jm * log1p(-excess / law->jm);
    return DEA_OK;
}

static enum dea_status gent_response(const struct dea_law *law, double excess, struct invariant_response *response) {
    double distance = law->jm - excess; /* D of physics.md section 2 */
    if (!(distance > 0.0))
        return DEA_RECOVERABLE;
    response->first = 0.5 * law->mu * law->jm / distance;
    response->second = response->first / distance;
    return DEA_OK;
}

static double mu_modulus(const struct dea_law *law) {
    return law->mu;
}

/* ---- neo-Hookean ---- */

static double no_margin(const struct dea_law *law, double excess) {
    (void)law;
    (void)excess;
    return 1.0;
}

static enum dea_status neo_hookean_energy(const struct dea_law *law, double excess, double *energy) {
    *energy = 0.5 * law->mu * excess;
    return DEA_OK;
}

static enum dea_status neo_hookean_response(const struct dea_law *law, double excess,
                                            struct invariant_response *response) {
    (void)excess;
    response->first = 0.5 * law->mu;
    response->second = 0.0;
    return DEA_OK;
}

/* ---- Yeoh ---- */

static enum dea_status yeoh_energy(const struct dea_law *law, double excess, double *energy) {
    double sum = 0.0;
    for (int i = law->yeoh_terms - 1; i >= 0; i--)
        sum = (sum + law->yeoh[i]) * excess;
    *energy = sum;
    return DEA_OK;
}

static enum dea_status yeoh_response(const struct dea_law *law, double excess, struct invariant_response *response) {
    double power = 1.0, previous = 0.0; /* excess^(i), excess^(i-1) */
    response->first = response->second = 0.0;
    for (int i = 0; i < law->yeoh_terms; i++) {
        response->first += (i + 1) * law->yeoh[i] * power;
        response->second += (i + 1) * i * law->yeoh[i] * previous;
        previous = power;
        power *= excess;
    }
    return DEA_OK;
}

static double yeoh_modulus(const struct dea_law *law) {
    return 2.0 * law->yeoh[0];
}

/* ---- Arruda-Boyce: W = mu lam_L^2 [y beta + ln(beta / sinh beta)], y = sqrt(I1/3)/lam_L, beta the inverse Langevin of
 * y (Arruda and Boyce, J. Mech. Phys. Solids 41, 389, 1993) ---- */

/* Inverse Langevin to machine precision: Newton on coth(b) - 1/b = y from a rational start; *slope = db/dy. */
static double invert_langevin(double y, double *slope) {
    double beta = y * (3.0 - y * (2.6 - 0.7 * y)) / ((1.0 - y) * (1.0 + 0.1 * y));
    double derivative = 1.0 / 3.0;
    for (int i = 0; i < 12; i++) {
        double value;
        if (beta < 0.3) { /* series: the closed forms cancel */
            double b2 = beta * beta;
            value =
                beta * (1.0 / 3.0 - b2 * (1.0 / 45.0 - b2 * (2.0 / 945.0 - b2 * (1.0 / 4725.0 - b2 * 2.0 / 93555.0))));
            derivative = 1.0 / 3.0 - b2 * (1.0 / 15.0 - b2 * (2.0 / 189.0 - b2 * (1.0 / 675.0 - b2 * 2.0 / 10395.0)));
        } else {
            double inverse_sinh = beta > 300.0 ? 0.0 : 1.0 / sinh(beta);
            value = 1.0 / tanh(beta) - 1.0 / beta;
            derivative = 1.0 / (beta * beta) - inverse_sinh * inverse_sinh;
        }
        double step = (y - value) / derivative;
        beta += step;
        if (fabs(step) <= 4e-16 * beta)
            break;
    }
    *slope = 1.0 / derivative;
    return beta;
}

/* ln(beta / sinh beta) without overflow, and for long chains (small beta) without cancellation: the sum is
 * sinh(beta)/beta - 1. */
static double log_beta_over_sinh(double beta) {
    if (beta > 1.0)
        return log(2.0 * beta) - beta - log1p(-exp(-2.0 * beta));
    double sum = 0.0, b2 = beta * beta;
    for (int k = 9; k >= 1; k--)
        sum = (1.0 + sum) * b2 / (2 * k * (2 * k + 1));
    return -log1p(sum);
}

static double chain_density(const struct dea_law *law, double invariant) {
    double slope, y = sqrt(invariant / 3.0) / law->locking_stretch;
    double beta = invert_langevin(y, &slope);
    return law->mu * law->locking_stretch * law->locking_stretch * (y * beta + log_beta_over_sinh(beta));
}

static double arruda_boyce_margin(const struct dea_law *law, double excess) {
    return 1.0 - (excess + 3.0) / (3.0 * law->locking_stretch * law->locking_stretch);
}

static enum dea_status arruda_boyce_energy(const struct dea_law *law, double excess, double *energy) {
    if (!(arruda_boyce_margin(law, excess) > 0.0))
        return DEA_RECOVERABLE;
    *energy = chain_density(law, excess + 3.0) - chain_density(law, 3.0);
    return DEA_OK;
}

static enum dea_status arruda_boyce_response(const struct dea_law *law, double excess,
                                             struct invariant_response *response) {
    if (!(arruda_boyce_margin(law, excess) > 0.0))
        return DEA_RECOVERABLE;
    double slope, locking = law->locking_stretch, y = sqrt((excess + 3.0) / 3.0) / locking;
    double beta = invert_langevin(y, &slope);
    response->first = law->mu * beta / (6.0 * y);
    response->second = law->mu / 6.0 * (slope / y - beta / (y * y)) / (6.0 * locking * locking * y);
    return DEA_OK;
}

static double arruda_boyce_modulus(const struct dea_law *law) {
    struct invariant_response response = {0};
    return arruda_boyce_response(law, 0.0, &response) == DEA_OK ? 2.0 * response.first : law->mu;
}

/* ---- Ogden: in principal stretches, W = sum mu_p/alpha_p (l1^a + l2^a + l3^a - 3) ---- */

static double ogden_modulus(const struct dea_law *law) {
    double sum = 0.0;
    for (int i = 0; i < law->ogden_terms; i++)
        sum += 0.5 * law->ogden_mu[i] * law->ogden_alpha[i];
    return sum;
}

static double ogden_energy(const struct dea_law *law, double lam1, double lam2) {
    double sum = 0.0;
    for (int i = 0; i < law->ogden_terms; i++) {
        double a = law->ogden_alpha[i];
        sum += law->ogden_mu[i] / a * (pow(lam1, a) + pow(lam2, a) + pow(lam1 * lam2, -a) - 3.0);
    }
    return sum;
}

static void ogden_stress(const struct dea_law *law, double lam1, double lam2, struct dea_stress *stress) {
    *stress = (struct dea_stress){0};
    for (int i = 0; i < law->ogden_terms; i++) {
        double a = law->ogden_alpha[i], mu = law->ogden_mu[i];
        double p1 = pow(lam1, a), p2 = pow(lam2, a), p3 = 1.0 / (p1 * p2);
        stress->w1 += mu * (p1 - p3) / lam1;
        stress->w11 += mu * ((a - 1.0) * p1 + (a + 1.0) * p3) / (lam1 * lam1);
        stress->w2 += mu * (p2 - p3) / lam2;
    }
}

/* ---- the table ---- */

static const struct law_functions laws[DEA_LAW_COUNT] = {
    [DEA_GENT] = {"gent", gent_energy, gent_response, gent_margin, mu_modulus},
    [DEA_NEO_HOOKEAN] = {"neo_hookean", neo_hookean_energy, neo_hookean_response, no_margin, mu_modulus},
    [DEA_YEOH] = {"yeoh", yeoh_energy, yeoh_response, no_margin, yeoh_modulus},
    [DEA_OGDEN] = {"ogden", NULL, NULL, no_margin, ogden_modulus},
    [DEA_ARRUDA_BOYCE] = {"arruda_boyce", arruda_boyce_energy, arruda_boyce_response, arruda_boyce_margin,
                          arruda_boyce_modulus},
};

/* I1 - 3, written so that it does not cancel near rest. */
static double invariant_excess(double lam1, double lam2) {
    double lam3 = 1.0 / (lam1 * lam2);
    return (lam1 - 1.0) * (lam1 + 1.0) + (lam2 - 1.0) * (lam2 + 1.0) + (lam3 - 1.0) * (lam3 + 1.0);
}

enum dea_status dea_law_energy(const struct dea_law *law, double lam1, double lam2, double *energy) {
    if (!(lam1 > 0.0 && lam2 > 0.0))
        return DEA_RECOVERABLE;
    if (law->kind == DEA_OGDEN) {
        *energy = ogden_energy(law, lam1, lam2);
        return DEA_OK;
    }
    return laws[law->kind].energy(law, invariant_excess(lam1, lam2), energy);
}

enum dea_status dea_law_stress(const struct dea_law *law, double lam1, double lam2, struct dea_stress *stress) {
    if (!(lam1 > 0.0 && lam2 > 0.0))
        return DEA_RECOVERABLE;
    if (law->kind == DEA_OGDEN) {
        ogden_stress(law, lam1, lam2, stress);
        return DEA_OK;
    }
    struct invariant_response f;
    DEA_TRY(laws[law->kind].response(law, invariant_excess(lam1, lam2), &f));

    /* chain rule: I1 = lam1^2 + lam2^2 + (lam1 lam2)^-2 */
    double lam3_squared = 1.0 / (lam1 * lam1 * lam2 * lam2);
    double i1_1 = 2.0 * (lam1 - lam3_squared / lam1);
    double i1_11 = 2.0 + 6.0 * lam3_squared / (lam1 * lam1);
    double i1_2 = 2.0 * (lam2 - lam3_squared / lam2);
    stress->w1 = f.first * i1_1;
    stress->w11 = f.second * i1_1 * i1_1 + f.first * i1_11;
    stress->w2 = f.first * i1_2;
    return DEA_OK;
}

double dea_law_margin(const struct dea_law *law, double lam1, double lam2) {
    return laws[law->kind].margin(law, invariant_excess(lam1, lam2));
}

double dea_law_modulus(const struct dea_law *law) {
    return laws[law->kind].modulus(law);
}

const char *dea_law_name(enum dea_law_kind kind) {
    return kind < DEA_LAW_COUNT ? laws[kind].name : "unknown";
}

enum dea_law_kind dea_law_from_name(const char *name) {
    for (int kind = 0; kind < DEA_LAW_COUNT; kind++)
        if (strcmp(laws[kind].name, name) == 0)
            return (enum dea_law_kind)kind;
    return DEA_LAW_COUNT;
}
