/* Closed forms of the optimum. At breakdown the balance lam_a (W1(lam_a) - W1(lam_p)) = eps E_bd^2 ties the active and
 * the passive stretch without r_a. Every r_a then has lp1 = r_a lam_a + (1 - r_a) lam_p and, with rho = lam_a/lam_p,
 *     d = r_a (1 - r_a)(rho - 1)/(r_a rho + 1 - r_a),
 * which grows with rho: the best pair is the one with the largest rho, for every r_a. */
#include "deasim/optimum.h"

#include <math.h>

#define BISECTIONS 200
#define NEWTON_STEPS 100
#define SCAN 64 /* intervals in which the slope of rho is looked at for a change of sign */

/* Stretch beyond which the law has no response; some large stretch for laws without an end. */
static double last_stretch(const struct dea_design *design) {
    const struct dea_law *law = &design->elastic;
    double lp2 = design->prestretch[1], square = lp2 * lp2, largest;
    if (law->kind == DEA_GENT)
        largest = 3.0 + law->jm;
    else if (law->kind == DEA_ARRUDA_BOYCE)
        largest = 3.0 * law->locking_stretch * law->locking_stretch;
    else
        return 1e3;
    double half = 0.5 * (largest - square), discriminant = half * half - 1.0 / square;
    return discriminant > 0.0 ? sqrt(half + sqrt(discriminant)) : 0.0;
}

/* lam_a at breakdown for a given lam_p: Newton inside (lam_p, last). */
static enum dea_status find_active(const struct dea_design *design, double lam_p, double last, double *lam_a,
                                   double *slope_of_lift) {
    struct dea_stress passive, active;
    double lp2 = design->prestretch[1], field = design->dielectric.breakdown;
    double cap = DEA_VACUUM_PERMITTIVITY * design->dielectric.permittivity * field * field;
    DEA_TRY(dea_law_stress(&design->elastic, lam_p, lp2, &passive));
    *slope_of_lift = lam_p * passive.w11; /* at lam_a = lam_p */
    double low = lam_p, high = last, lam = lam_p + cap / *slope_of_lift;
    for (int i = 0; i < NEWTON_STEPS; i++) {
        if (!(lam > low && lam < high))
            lam = 0.5 * (low + high);
        if (dea_law_stress(&design->elastic, lam, lp2, &active) != DEA_OK) {
            high = lam;
            continue;
        }
        double value = lam * (active.w1 - passive.w1) - cap;
        *slope_of_lift = active.w1 - passive.w1 + lam * active.w11;
        if (value < 0.0)
            low = lam;
        else
            high = lam;
        double next = lam - value / *slope_of_lift;
        if (fabs(next - lam) <= 2e-16 * lam || !(high > nextafter(low, high)))
            break;
        lam = next;
    }
    *lam_a = lam;
    return DEA_OK;
}

/* Sign of d(lam_a/lam_p)/dlam_p: lam_a' = lam_a W11(lam_p)/slope, so it is that of lam_p W11(lam_p) - slope. */
static enum dea_status ratio_slope(const struct dea_design *design, double lam_p, double last, double *lam_a,
                                   double *slope) {
    struct dea_stress passive;
    double slope_of_lift;
    DEA_TRY(find_active(design, lam_p, last, lam_a, &slope_of_lift));
    DEA_TRY(dea_law_stress(&design->elastic, lam_p, design->prestretch[1], &passive));
    *slope = lam_p * passive.w11 - slope_of_lift;
    return DEA_OK;
}

/* Least passive stretch: where the tension to be kept is left, lp2^-1/2 when none is. */
static double least_passive(const struct dea_design *design, double last) {
    double low = 1.0 / sqrt(design->prestretch[1]), high = last;
    for (int i = 0; i < BISECTIONS && design->least_tension > 0.0; i++) {
        struct dea_stress stress;
        double middle = 0.5 * (low + high);
        if (middle <= low || middle >= high)
            break;
        if (dea_law_stress(&design->elastic, middle, design->prestretch[1], &stress) == DEA_OK &&
            middle * stress.w1 < design->least_tension)
            low = middle;
        else
            high = middle;
    }
    return design->least_tension > 0.0 ? high : low;
}

enum dea_status dea_optimum_pair(const struct dea_design *design, double *lam_active, double *lam_passive) {
    double last = last_stretch(design), slope, low = least_passive(design, last);
    if (!(low < last) || !isfinite(design->dielectric.breakdown))
        return DEA_RECOVERABLE;
    *lam_passive = low;
    DEA_TRY(ratio_slope(design, low, last, lam_active, &slope));
    if (slope <= 0.0)
        return DEA_OK; /* rho falls from the start: the pair that is just about to go slack */

    /* first change of sign, then bisection */
    double span = fmin(last, 4.0 * low) - low, high = low;
    for (int i = 1; i <= SCAN && slope > 0.0; i++) {
        low = high;
        high = *lam_passive + span * i / (SCAN + 1);
        DEA_TRY(ratio_slope(design, high, last, lam_active, &slope));
    }
    if (slope > 0.0)
        return DEA_RECOVERABLE;
    for (int i = 0; i < BISECTIONS; i++) {
        double middle = 0.5 * (low + high);
        if (middle <= low || middle >= high)
            break;
        DEA_TRY(ratio_slope(design, middle, last, lam_active, &slope));
        if (slope > 0.0)
            low = middle;
        else
            high = middle;
    }
    *lam_passive = low;
    return ratio_slope(design, low, last, lam_active, &slope);
}

double dea_exact_lp2(double jm) {
    return sqrt((jm + 3.0) / 3.0);
}

double dea_rule_lp2(double jm) {
    /* largest uniaxial stretch: the root above 1 of s^3 - (Jm + 3) s + 2 = 0, from above, where Newton is monotone */
    double s = sqrt(jm + 3.0);
    for (int i = 0; i < NEWTON_STEPS; i++) {
        double step = (s * s * s - (jm + 3.0) * s + 2.0) / (3.0 * s * s - (jm + 3.0));
        s -= step;
        if (fabs(step) <= 2e-16 * s)
            break;
    }
    return 0.57 * s;
}
