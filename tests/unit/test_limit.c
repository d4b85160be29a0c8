/* First failures outside the reference table: exact laws of the limits, other elastic laws, loads, biased devices. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>

#include "deasim/design.h"

static struct dea_device sylgard_device(double lp1, double lp2, double left, double right) {
    struct dea_device device = {.width = 30e-3, .thickness = 33e-6, .prestretch = {lp1, lp2}, .slack = true};
    device.material.elastic = (struct dea_law){.kind = DEA_GENT, .mu = 0.365e6, .jm = 16.6};
    device.material.dielectric = (struct dea_dielectric){.permittivity = 2.5, .breakdown = 100e6};
    device.zones[0] = (struct dea_zone){.present = true, .electroded = true, .length = left};
    device.zones[1] = (struct dea_zone){.present = right > 0.0, .length = right};
    assert_int_equal(dea_device_prepare(&device, NULL), DEA_OK);
    return device;
}

static struct dea_limit find_limit(const struct dea_device *device, double right_voltage) {
    struct dea_limit limit;
    assert_int_equal(dea_static_limit(device, right_voltage, &limit, NULL), DEA_OK);
    return limit;
}

static void assert_close(double ours, double expected, double relative) {
    if (fabs(ours - expected) > relative * fabs(expected)) {
        print_error("%.17g, expected %.17g\n", ours, expected);
        fail();
    }
}

/* lam1p = lam2^-1/2 exactly: the closed form of the displacement at loss of tension. */
static void slack1_is_exact(void **state) {
    (void)state;
    struct dea_device device = sylgard_device(0.7, 2.4, 3e-3, 5e-3);
    struct dea_limit limit = find_limit(&device, 0.0);
    assert_int_equal(limit.mode, DEA_LIMIT_SLACK1);
    assert_close(limit.x, 5e-3 * (0.7 - 1.0 / sqrt(2.4)) / 0.7, 3e-14);
}

static void breakdown_sits_on_the_field(void **state) {
    (void)state;
    struct dea_device device = sylgard_device(1.2, 1.2, 4e-3, 4e-3);
    struct dea_limit limit = find_limit(&device, 0.0);
    assert_int_equal(limit.mode, DEA_LIMIT_BREAKDOWN);
    assert_close(limit.true_field, 100e6, 1e-14);
    assert_close(limit.x, 0.358173e-3, 2e-6); /* the device of the paper at 100 V/um true */
    assert_close(limit.voltage, limit.true_field * 33e-6 / limit.stretch, 1e-14);
}

/* Huang et al., Appl. Phys. Lett. 101, 122905 (2012): E_bd = 51 h^-0.25 lam^0.63 MV/m, h in mm. */
static void breakdown_may_depend_on_thickness_and_stretch(void **state) {
    (void)state;
    struct dea_device device = sylgard_device(1.2, 1.2, 4e-3, 4e-3);
    struct dea_dielectric *dielectric = &device.material.dielectric;
    dielectric->breakdown = 40e6;
    dielectric->breakdown_reference = 1e-3;
    dielectric->breakdown_thickness_exponent = 0.25;
    dielectric->breakdown_stretch_exponent = 0.63;
    struct dea_limit limit = find_limit(&device, 0.0);
    assert_int_equal(limit.mode, DEA_LIMIT_BREAKDOWN);
    double lam1 = 1.2 * limit.stretch, thickness_mm = 33e-3 / limit.stretch;
    assert_close(limit.true_field, 40e6 * pow(thickness_mm, -0.25) * pow(sqrt(1.2 * lam1), 0.63), 1e-14);
}

static void the_gent_limit_is_named_when_nothing_else_fails_first(void **state) {
    (void)state;
    struct dea_device device = sylgard_device(1.1, 4.25, 4e-3, 0.0);
    device.material.dielectric.breakdown = INFINITY;
    struct dea_stress stress;
    assert_int_equal(dea_law_stress(&device.material.elastic, 1.1, 4.25, &stress), DEA_OK);
    device.load = device.width * device.thickness * 1.1 * stress.w1;
    struct dea_limit limit = find_limit(&device, 0.0);
    assert_int_equal(limit.mode, DEA_LIMIT_LAW);
    double margin = dea_law_margin(&device.material.elastic, 1.1 * limit.stretch, 4.25);
    assert_close(margin, DEA_LAW_MARGIN_LIMIT, 1e-11);
}

/* A film that softens (Ogden, alpha = 1) under a dead load: the largest voltage found by scanning the balance
 * V^2 = (W1 - W1(lp1)) t0^2 lp1^2 / (eps lam). */
static void a_softening_film_turns_the_voltage_over(void **state) {
    (void)state;
    struct dea_device device = sylgard_device(1.3, 2.0, 4e-3, 0.0);
    struct dea_law *law = &device.material.elastic;
    *law = (struct dea_law){.kind = DEA_OGDEN, .ogden_terms = 1, .ogden_mu = {0.5e6}, .ogden_alpha = {1.0}};
    device.material.dielectric.breakdown = INFINITY;
    struct dea_stress rest, stress;
    assert_int_equal(dea_law_stress(law, 1.3, 2.0, &rest), DEA_OK);
    device.load = device.width * device.thickness * 1.3 * rest.w1;
    assert_int_equal(dea_device_prepare(&device, NULL), DEA_OK);
    struct dea_limit limit = find_limit(&device, 0.0);
    assert_int_equal(limit.mode, DEA_LIMIT_INSTABILITY);
    double largest = 0.0;
    for (int i = 1; i < 200000; i++) {
        double lam = 1.3 + 1e-5 * i;
        assert_int_equal(dea_law_stress(law, lam, 2.0, &stress), DEA_OK);
        largest = fmax(largest, (stress.w1 - rest.w1) / lam);
    }
    double thickness = 33e-6 * 1.3;
    assert_close(limit.voltage, thickness * sqrt(largest / (DEA_VACUUM_PERMITTIVITY * 2.5)), 1e-9);

    /* just below there is an equilibrium close to the limit, above there is none */
    struct dea_static_point point;
    double voltages[2] = {limit.voltage * (1.0 - 1e-9), 0.0};
    assert_int_equal(dea_static_solve(&device, voltages, &point, NULL), DEA_OK);
    assert_true(point.stable && point.x < limit.x && point.x > 0.99 * limit.x);
    voltages[0] = limit.voltage * (1.0 + 1e-9);
    assert_int_equal(dea_static_solve(&device, voltages, &point, NULL), DEA_ERR_SOLVER);
}

static void a_film_without_breakdown_under_a_dead_load_fails_across_the_motion(void **state) {
    (void)state;
    struct dea_device device = sylgard_device(1.1, 3.0, 4e-3, 0.0);
    device.material.elastic = (struct dea_law){.kind = DEA_NEO_HOOKEAN, .mu = 0.3e6};
    device.material.dielectric.breakdown = INFINITY;
    struct dea_stress stress;
    assert_int_equal(dea_law_stress(&device.material.elastic, 1.1, 3.0, &stress), DEA_OK);
    device.load = device.width * device.thickness * 1.1 * stress.w1;
    /* stress2 = stress1 + mu (lam2^2 - lam1^2), and the load keeps stress1 = lam1 P: it ends where that is 0 */
    struct dea_limit limit = find_limit(&device, 0.0);
    assert_int_equal(limit.mode, DEA_LIMIT_SLACK2);
    double lam1 = 1.1 * limit.stretch;
    assert_close(lam1 * stress.w1 + 0.3e6 * 9.0, 0.3e6 * lam1 * lam1, 1e-13);
}

static void a_biased_right_zone_can_fail_before_any_left_voltage(void **state) {
    (void)state;
    struct dea_device device = sylgard_device(1.2, 1.2, 4e-3, 4e-3);
    device.zones[1].electroded = true;
    assert_int_equal(dea_device_prepare(&device, NULL), DEA_OK);
    struct dea_limit limit = find_limit(&device, 3500.0);
    assert_int_equal(limit.mode, DEA_LIMIT_BREAKDOWN);
    assert_true(limit.voltage == 0.0 && limit.x < 0.0);

    /* a moderate bias: the mirror of a drive from the other side at the start, a shorter stroke at the end */
    struct dea_limit unbiased = find_limit(&device, 0.0), biased = find_limit(&device, 1500.0);
    assert_int_equal(biased.mode, DEA_LIMIT_BREAKDOWN);
    assert_true(biased.x < unbiased.x && biased.voltage > unbiased.voltage);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(slack1_is_exact),
        cmocka_unit_test(breakdown_sits_on_the_field),
        cmocka_unit_test(breakdown_may_depend_on_thickness_and_stretch),
        cmocka_unit_test(the_gent_limit_is_named_when_nothing_else_fails_first),
        cmocka_unit_test(a_softening_film_turns_the_voltage_over),
        cmocka_unit_test(a_film_without_breakdown_under_a_dead_load_fails_across_the_motion),
        cmocka_unit_test(a_biased_right_zone_can_fail_before_any_left_voltage),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
