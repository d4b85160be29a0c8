/* Equilibria outside the reference table: slack as a regime, dead load, stops, other laws, both zones biased, bad
 * input. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>
#include <string.h>

#include "deasim/design.h"

#define EPS0 DEA_VACUUM_PERMITTIVITY

/* Sylgard 186 as in Rosset et al., 4 mm + 4 mm, left zone driven. */
static struct dea_device sylgard_device(double lp1, double lp2) {
    struct dea_device device = {.width = 30e-3, .thickness = 33e-6, .prestretch = {lp1, lp2}, .slack = true};
    device.material.elastic = (struct dea_law){.kind = DEA_GENT, .mu = 0.365e6, .jm = 16.6};
    device.material.dielectric = (struct dea_dielectric){.permittivity = 2.5, .breakdown = 100e6};
    device.zones[0] = (struct dea_zone){.present = true, .electroded = true, .length = 4e-3};
    device.zones[1] = (struct dea_zone){.present = true, .length = 4e-3};
    assert_int_equal(dea_device_prepare(&device, NULL), DEA_OK);
    return device;
}

static double spring_w1(const struct dea_device *device, double lam) {
    struct dea_stress stress;
    assert_int_equal(dea_law_stress(&device->material.elastic, lam, device->prestretch[1], &stress), DEA_OK);
    return stress.w1;
}

/* Total energy at given voltages, load included: its minimum is the equilibrium, independent of any force formula. */
static double energy(const struct dea_device *device, const double voltages[2], double x) {
    double sum = -device->load * x;
    for (int k = 0; k < DEA_ZONES; k++) {
        if (!device->zones[k].present)
            continue;
        double w, lam = dea_zone_stretch(device, k, x);
        assert_int_equal(dea_law_energy(&device->material.elastic, lam, device->prestretch[1], &w), DEA_OK);
        sum += device->zones[k].volume * w;
        if (device->zones[k].electroded)
            sum -= 0.5 * voltages[k] * voltages[k] * dea_zone_capacitance(device, k, lam, NULL, NULL);
    }
    return sum;
}

static void assert_stationary(const struct dea_device *device, const double voltages[2], double x) {
    double h = 1e-6, scale = device->stiffness * 4e-3;
    double slope = (energy(device, voltages, x + h) - energy(device, voltages, x - h)) / (2.0 * h);
    assert_true(fabs(slope) < 1e-6 * scale);
    assert_true(energy(device, voltages, x + 50e-6) > energy(device, voltages, x));
    assert_true(energy(device, voltages, x - 50e-6) > energy(device, voltages, x));
}

static void slack_films_leave_the_platform_where_tension_ended(void **state) {
    (void)state;
    struct dea_device device = sylgard_device(0.66, 2.5);
    struct dea_limit limit;
    assert_int_equal(dea_static_limit(&device, 0.0, &limit, NULL), DEA_OK);
    assert_int_equal(limit.mode, DEA_LIMIT_SLACK1);

    double voltages[2] = {1.3 * limit.voltage, 0.0};
    struct dea_static_point point;
    assert_int_equal(dea_static_solve(&device, voltages, &point, NULL), DEA_OK);
    assert_true(fabs(point.x - limit.x) < 1e-9);
    assert_true(point.zones[0].slack);
    assert_true(point.zones[0].tension == 0.0);
    assert_true(fabs(point.zones[0].stress1) == 0.0);
    /* the natural stretch balances the Maxwell stress */
    double lam = point.zones[0].stretch, field = point.zones[0].true_field;
    assert_true(fabs(lam * spring_w1(&device, lam) / (EPS0 * 2.5 * field * field) - 1.0) < 1e-12);
    assert_true(lam > dea_zone_stretch(&device, 0, point.x));

    /* the same state asked for by its field */
    struct dea_static_point by_field;
    assert_int_equal(dea_static_solve_field(&device, -field, 0.0, &by_field, NULL), DEA_OK);
    assert_true(fabs(by_field.zones[0].voltage / voltages[0] + 1.0) < 1e-12);
    assert_true(fabs(by_field.x - point.x) < 1e-12);

    /* without the regime the passive membrane pushes and the platform goes on */
    device.slack = false;
    assert_int_equal(dea_static_solve(&device, voltages, &point, NULL), DEA_OK);
    assert_true(point.x > 1.05 * limit.x);
    assert_true(point.zones[1].tension < 0.0 && point.zones[1].stress1 < 0.0);
}

static void a_dead_load_holds_a_single_zone(void **state) {
    (void)state;
    struct dea_device device = sylgard_device(0.9, 2.0);
    device.zones[1].present = false;
    device.load = device.width * device.thickness * 0.9 * spring_w1(&device, 0.9);
    assert_int_equal(dea_device_prepare(&device, NULL), DEA_OK);
    double voltages[2] = {0.0, 0.0};
    struct dea_static_point point;
    assert_int_equal(dea_static_solve(&device, voltages, &point, NULL), DEA_OK);
    assert_true(fabs(point.x) < 1e-15);
    assert_true(fabs(point.zones[0].tension / device.load - 1.0) < 1e-12);

    voltages[0] = 2000.0;
    assert_int_equal(dea_static_solve(&device, voltages, &point, NULL), DEA_OK);
    double lam = point.zones[0].stretch, field = point.zones[0].true_field;
    double maxwell = EPS0 * 2.5 * field * field;
    assert_true(fabs(lam * (spring_w1(&device, lam) - spring_w1(&device, 0.9)) / maxwell - 1.0) < 1e-11);
    assert_true(point.zones[1].stretch == 0.0 && point.zones[1].tension == 0.0);

    /* no load at all: the film contracts to its natural width lp2^-1/2; a load towards the frame finds no hold */
    voltages[0] = device.load = 0.0;
    assert_int_equal(dea_static_solve(&device, voltages, &point, NULL), DEA_OK);
    assert_true(fabs(point.zones[0].stretch - 1.0 / sqrt(2.0)) < 1e-12);
    device.load = -1e-3;
    struct dea_error error;
    assert_int_equal(dea_static_solve(&device, voltages, &point, &error), DEA_ERR_SOLVER);
    assert_string_equal(error.text, "no equilibrium at 0 V left, 0 V right: nothing holds the platform");
}

static void equilibrium_is_a_minimum_of_energy_for_every_law(void **state) {
    (void)state;
    const struct dea_law laws[] = {
        {.kind = DEA_GENT, .mu = 0.365e6, .jm = 16.6},
        {.kind = DEA_NEO_HOOKEAN, .mu = 0.3e6},
        {.kind = DEA_YEOH, .yeoh_terms = 3, .yeoh = {180.7e3, -16.7e3, 6.6e3}},
        {.kind = DEA_OGDEN, .ogden_terms = 2, .ogden_mu = {0.2e6, 0.01e6}, .ogden_alpha = {2.0, 5.0}},
        {.kind = DEA_ARRUDA_BOYCE, .mu = 0.3e6, .locking_stretch = 3.0},
    };
    for (size_t i = 0; i < sizeof laws / sizeof laws[0]; i++) {
        struct dea_device device = sylgard_device(1.1, 1.3);
        device.material.elastic = laws[i];
        device.material.dielectric.permittivity = 2.76;
        device.material.dielectric.permittivity_slope = -0.28;
        device.zones[1].electroded = true;
        device.zones[0].length = 3e-3;
        device.zones[1].length = 7e-3;
        device.load = 4e-3;
        assert_int_equal(dea_device_prepare(&device, NULL), DEA_OK);
        const double voltages[2] = {2500.0, 800.0};
        struct dea_static_point point;
        assert_int_equal(dea_static_solve(&device, voltages, &point, NULL), DEA_OK);
        assert_true(point.x > 0.05e-3);
        assert_true(point.stable);
        assert_stationary(&device, voltages, point.x);
        /* the pulls and the load balance */
        assert_true(fabs(point.zones[1].tension + device.load - point.zones[0].tension) < 1e-12);
    }
}

static void end_stops_take_part_in_the_balance(void **state) {
    (void)state;
    struct dea_device device = sylgard_device(1.2, 1.2);
    device.has_stops = true;
    device.stops[0] = -0.1e-3;
    device.stops[1] = 0.1e-3;
    assert_int_equal(dea_device_prepare(&device, NULL), DEA_OK);
    const double voltages[2] = {3300.0, 0.0};
    struct dea_static_point point;
    assert_int_equal(dea_static_solve(&device, voltages, &point, NULL), DEA_OK);
    assert_true(point.x > 0.1e-3 && point.x < 0.101e-3);
    double stop = dea_stop_force(&device, point.x, 0.0, NULL, NULL, NULL, NULL);
    assert_true(stop < 0.0);
    assert_true(fabs(point.zones[1].tension + stop - point.zones[0].tension) < 1e-10);
}

/* eps V^2 / t0^2 = lp1^2 W11(lp1): beyond it the middle is no longer a minimum (membranes counted as taut). */
static void both_sides_biased_lose_stability_at_the_pitchfork(void **state) {
    (void)state;
    struct dea_device device = sylgard_device(1.2, 1.2);
    device.slack = false;
    device.zones[1].electroded = true;
    assert_int_equal(dea_device_prepare(&device, NULL), DEA_OK);
    struct dea_stress stress;
    assert_int_equal(dea_law_stress(&device.material.elastic, 1.2, 1.2, &stress), DEA_OK);
    double pitchfork = 33e-6 * 1.2 * sqrt(stress.w11 / (EPS0 * 2.5));
    assert_true(fabs(pitchfork - 7421.0) < 0.5);
    for (int side = -1; side <= 1; side += 2) {
        double voltage = pitchfork * (1.0 + 1e-6 * side);
        const double voltages[2] = {voltage, voltage};
        struct dea_static_point point;
        assert_int_equal(dea_static_solve(&device, voltages, &point, NULL), DEA_OK);
        assert_true(point.x == 0.0);
        assert_int_equal(point.stable, side < 0);
    }
}

static void what_cannot_be_driven_is_refused(void **state) {
    (void)state;
    struct dea_device device = sylgard_device(1.2, 1.2);
    struct dea_static_point point;
    struct dea_limit limit;
    struct dea_error error;
    const double on_passive[2] = {0.0, 100.0}, not_a_number[2] = {NAN, 0.0};
    assert_int_equal(dea_static_solve(&device, on_passive, &point, &error), DEA_ERR_INPUT);
    assert_string_equal(error.text, "zones.right carries no electrode, it cannot be at 100 V");
    assert_int_equal(dea_static_solve(&device, not_a_number, &point, &error), DEA_ERR_INPUT);
    assert_string_equal(error.text, "the left voltage is not a number");
    assert_int_equal(dea_static_solve_field(&device, INFINITY, 0.0, &point, &error), DEA_ERR_INPUT);
    assert_string_equal(error.text, "the true field is not a number");
    device.zones[0].electroded = false;
    assert_int_equal(dea_static_limit(&device, 0.0, &limit, &error), DEA_ERR_INPUT);
    assert_string_equal(error.text, "zones.left carries no electrode, so there is nothing to drive");
    assert_int_equal(dea_static_solve_field(&device, 1e6, 0.0, &point, &error), DEA_ERR_INPUT);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(slack_films_leave_the_platform_where_tension_ended),
        cmocka_unit_test(a_dead_load_holds_a_single_zone),
        cmocka_unit_test(equilibrium_is_a_minimum_of_energy_for_every_law),
        cmocka_unit_test(end_stops_take_part_in_the_balance),
        cmocka_unit_test(both_sides_biased_lose_stability_at_the_pitchfork),
        cmocka_unit_test(what_cannot_be_driven_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
