/* Breakdown field and leakage. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>

#include "deasim/material.h"

#include "differences.h"

static void assert_near(double value, double expected, double scale) {
    if (!(fabs(value - expected) <= scale))
        fail_msg("%.17g is not %.17g within %.3g", value, expected, scale);
}

static void a_constant_breakdown_field_stays_constant(void **state) {
    (void)state;
    struct dea_dielectric d = {.permittivity = 2.5, .breakdown = 100e6};
    assert_true(dea_breakdown_field(&d, 20e-6, 1.2, 1.3) == 100e6);
    assert_true(dea_breakdown_field(&d, 200e-6, 2.2, 3.3) == 100e6);
    d.breakdown = INFINITY;
    assert_true(isinf(dea_breakdown_field(&d, 20e-6, 1.2, 1.3)));
}

/* 51 h^-0.25 lam^0.63 MV/m, h in mm: Huang et al., APL 101, 122905 (2012), abstract. */
static void the_power_law_knows_thickness_and_stretch(void **state) {
    (void)state;
    struct dea_dielectric vhb = {.breakdown = 51e6,
                                 .breakdown_reference = 1e-3,
                                 .breakdown_thickness_exponent = 0.25,
                                 .breakdown_stretch_exponent = 0.63};
    assert_near(dea_breakdown_field(&vhb, 1e-3, 1.0, 1.0), 51e6, 1e-6);
    double expected = 51e6 * pow(0.04, -0.25) * pow(5.0, 0.63); /* lam = sqrt(lam1 lam2) */
    assert_near(dea_breakdown_field(&vhb, 40e-6, 5.0, 5.0), expected, 1e-12 * expected);
    assert_near(dea_breakdown_field(&vhb, 40e-6, 2.5, 10.0), expected, 1e-12 * expected);
}

static void ohmic_leakage_is_linear(void **state) {
    (void)state;
    struct dea_dielectric d = {.conductivity = 1e-12, .conductivity_field = INFINITY};
    double slope;
    assert_near(dea_leakage_density(&d, 80e6, &slope), 80e-6, 1e-18);
    assert_near(slope, 1e-12, 1e-26);
    assert_near(dea_leakage_density(&d, -80e6, &slope), -80e-6, 1e-18);
    assert_true(dea_leakage_density(&d, 0.0, &slope) == 0.0);
}

static double density_at(double field, void *context) {
    double slope;
    return dea_leakage_density(context, field, &slope);
}

static void exponential_leakage_is_odd_and_has_its_slope(void **state) {
    (void)state;
    struct dea_dielectric d = {.conductivity = 1e-13, .conductivity_field = 20e6};
    for (double field = -150e6; field < 155e6; field += 10e6) {
        double slope, other, density = dea_leakage_density(&d, field, &slope);
        assert_near(density, 1e-13 * exp(fabs(field) / 20e6) * field, 1e-13 * fabs(density));
        assert_near(dea_leakage_density(&d, -field, &other), -density, 0.0);
        if (fabs(field) > 5e6) /* the second derivative jumps at 0 */
            assert_near(differentiate(density_at, &d, field, 1e6), slope, 1e-8 * slope);
    }
}

static void wild_fields_stay_finite_and_monotone(void **state) {
    (void)state;
    struct dea_dielectric d = {.conductivity = 1e-13, .conductivity_field = 1e6};
    double before = 0.0, slope;
    for (double field = 1e6; field < 1e15; field *= 1.7) {
        double density = dea_leakage_density(&d, field, &slope);
        assert_true(isfinite(density) && density > before && slope > 0.0);
        before = density;
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_constant_breakdown_field_stays_constant),
        cmocka_unit_test(the_power_law_knows_thickness_and_stretch),
        cmocka_unit_test(ohmic_leakage_is_linear),
        cmocka_unit_test(exponential_leakage_is_odd_and_has_its_slope),
        cmocka_unit_test(wild_fields_stay_finite_and_monotone),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
