/* Breakdown field and leakage of the film. */
#include "deasim/material.h"

#include <math.h>

/* Largest exponent of the leakage law: far beyond any breakdown field, so that a solver's wild guess stays finite. */
#define MAX_LEAKAGE_EXPONENT 60.0

double dea_breakdown_field(const struct dea_dielectric *dielectric, double thickness, double lam1, double lam2) {
    double field = dielectric->breakdown;
    if (dielectric->breakdown_thickness_exponent != 0.0)
        field *= pow(thickness / dielectric->breakdown_reference, -dielectric->breakdown_thickness_exponent);
    if (dielectric->breakdown_stretch_exponent != 0.0)
        field *= pow(lam1 * lam2, 0.5 * dielectric->breakdown_stretch_exponent);
    return field;
}

double dea_leakage_density(const struct dea_dielectric *dielectric, double true_field, double *derivative) {
    double exponent = fabs(true_field) / dielectric->conductivity_field;
    if (exponent > MAX_LEAKAGE_EXPONENT) { /* straight on from there */
        double sigma = dielectric->conductivity * exp(MAX_LEAKAGE_EXPONENT);
        *derivative = sigma;
        return sigma * true_field;
    }
    double sigma = dielectric->conductivity * exp(exponent);
    *derivative = sigma * (1.0 + exponent);
    return sigma * true_field;
}
