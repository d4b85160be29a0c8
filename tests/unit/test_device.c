/* Derived constants of a device, its geometry, contacts and electrodes. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>
#include <string.h>

#include "deasim/device.h"

#include "differences.h"

static void assert_near(double value, double expected, double scale) {
    if (!(fabs(value - expected) <= scale))
        fail_msg("%.17g is not %.17g within %.3g", value, expected, scale);
}

/* Design C of Rosset et al.: Sylgard 186, 4 + 4 mm, 30 mm wide, 33 um, prestretch 1.2 x 1.2. */
static struct dea_device design_c(void) {
    struct dea_device d = {.width = 30e-3, .thickness = 33e-6, .prestretch = {1.2, 1.2}, .platform_mass = 0.428e-3};
    d.material.elastic = (struct dea_law){.kind = DEA_GENT, .mu = 0.365e6, .jm = 16.6};
    d.material.dielectric = (struct dea_dielectric){.permittivity = 2.5, .breakdown = 100e6};
    d.material.density = 1120.0;
    for (int k = 0; k < DEA_ZONES; k++)
        d.zones[k] = (struct dea_zone){.present = true, .electroded = true, .length = 4e-3};
    d.membrane_mass = d.slack = true;
    assert_int_equal(dea_device_prepare(&d, NULL), DEA_OK);
    return d;
}

static void design_c_has_its_known_constants(void **state) {
    (void)state;
    struct dea_device d = design_c();
    assert_near(d.stiffness, 554.07, 0.005);
    assert_near(d.zones[0].rest_capacitance, 80.5e-12, 0.05e-12);
    assert_near(d.effective_mass, 0.428e-3 + 2.0 * 1120.0 * 30e-3 * 4e-3 * 33e-6 / 3.0, 1e-18);
    assert_near(sqrt(d.stiffness / d.effective_mass) / (2.0 * M_PI), 180.0, 0.5);
    assert_near(d.zones[0].volume, 30e-3 * 4e-3 * 33e-6, 1e-24);
    assert_true(d.zones[0].side == 1.0 && d.zones[1].side == -1.0);
}

static double capacitance_at(double lam, void *context) {
    return dea_zone_capacitance(context, 0, lam, NULL, NULL);
}

static double capacitance_slope_at(double lam, void *context) {
    double slope;
    dea_zone_capacitance(context, 0, lam, &slope, NULL);
    return slope;
}

static void capacitance_follows_the_deformed_geometry(void **state) {
    (void)state;
    struct dea_device d = design_c();
    for (int sloped = 0; sloped < 2; sloped++) {
        d.material.dielectric.permittivity_slope = sloped ? -0.28 : 0.0;
        for (double lam = 0.8; lam < 2.0; lam += 0.1) {
            /* eps w l / t with l = l0 lam/lp1, t = t0 lp1/lam */
            double l = 4e-3 * lam / 1.2, t = 33e-6 * 1.2 / lam, slope, curvature;
            double eps = DEA_VACUUM_PERMITTIVITY * (2.5 + d.material.dielectric.permittivity_slope * lam);
            double c = dea_zone_capacitance(&d, 0, lam, &slope, &curvature);
            assert_near(c, eps * 30e-3 * l / t, 1e-14 * c);
            assert_near(differentiate(capacitance_at, &d, lam, 1e-2), slope, 1e-12 * slope);
            assert_near(differentiate(capacitance_slope_at, &d, lam, 1e-2), curvature, 1e-12 * slope);
            assert_near(dea_zone_field(&d, 1000.0, lam), 1000.0 / t, 1e-14 * 1000.0 / t);
        }
    }
}

static double resistance_at(double lam, void *context) {
    return dea_zone_resistance(context, 0, lam, NULL);
}

static void electrodes_resist_by_feed_and_stretch(void **state) {
    (void)state;
    struct dea_device d = design_c();
    d.zones[0].electrode_resistance = 700.0;
    d.zones[0].sheet_resistance = 50e3;
    for (int feed = 0; feed < 2; feed++) {
        d.zones[0].feed = feed == 0 ? DEA_FEED_LONG_EDGE : DEA_FEED_NARROW_END;
        for (double lam = 0.9; lam < 1.8; lam += 0.1) {
            double l = 4e-3 * lam / 1.2, squares = feed == 0 ? l / 30e-3 : 30e-3 / l, slope;
            double r = dea_zone_resistance(&d, 0, lam, &slope);
            assert_near(r, 700.0 + 2.0 * 50e3 * squares / 3.0, 1e-12 * r);
            assert_near(differentiate(resistance_at, &d, lam, 1e-2), slope, 1e-10 * fabs(slope));
        }
    }
}

static double force_by_x(double x, void *context) {
    return dea_stop_force(context, x, 0.05, NULL, NULL, NULL, NULL);
}

static double force_by_v(double v, void *context) {
    return dea_stop_force(context, 0.52e-3, v, NULL, NULL, NULL, NULL);
}

static double energy_by_x(double x, void *context) {
    double energy;
    dea_stop_force(context, x, 0.0, NULL, NULL, &energy, NULL);
    return energy;
}

static void stops_push_back_store_and_lose(void **state) {
    (void)state;
    struct dea_device d = design_c();
    d.has_stops = true;
    d.stops[0] = -0.3e-3;
    d.stops[1] = 0.5e-3;
    d.stop_loss = 2.0;
    d.stop_stiffness = 0.0;
    assert_int_equal(dea_device_prepare(&d, NULL), DEA_OK);
    assert_near(d.stop_stiffness, 1000.0 * d.stiffness, 1e-9);
    double by_x, by_v, energy, loss;
    assert_true(dea_stop_force(&d, 0.5e-3, 1.0, &by_x, &by_v, &energy, &loss) == 0.0);
    assert_true(by_x == 0.0 && by_v == 0.0 && energy == 0.0 && loss == 0.0);

    double force = dea_stop_force(&d, 0.52e-3, 0.05, &by_x, &by_v, &energy, &loss);
    assert_near(force, -d.stop_stiffness * 20e-6 * (1.0 + 2.0 * 0.05), 1e-9 * fabs(force));
    assert_near(differentiate(force_by_x, &d, 0.52e-3, 1e-6), by_x, 1e-8 * fabs(by_x));
    assert_near(differentiate(force_by_v, &d, 0.05, 1e-2), by_v, 1e-8 * fabs(by_v));
    assert_near(energy, 0.5 * d.stop_stiffness * 4e-10, 1e-9 * energy);
    assert_near(-differentiate(energy_by_x, &d, 0.52e-3, 1e-6),
                dea_stop_force(&d, 0.52e-3, 0.0, NULL, NULL, NULL, NULL), 1e-8 * fabs(force));
    /* what the force takes beyond the stored energy is lost, on the way in and out */
    assert_near(-force * 0.05, d.stop_stiffness * 20e-6 * 0.05 + loss, 1e-9 * loss);
    dea_stop_force(&d, -0.31e-3, 0.02, NULL, NULL, NULL, &loss);
    assert_true(loss > 0.0);
    assert_true(dea_stop_force(&d, -0.31e-3, 0.0, NULL, NULL, NULL, NULL) > 0.0);
}

static void prepare_refuses_what_cannot_be(void **state) {
    (void)state;
    struct dea_error error;
    struct dea_device d = design_c();
    d.zones[1].length = 0.0;
    assert_int_equal(dea_device_prepare(&d, &error), DEA_ERR_INPUT);
    assert_string_equal(error.text, "zones.right.length must be positive");
    d = design_c();
    d.zones[0].present = d.zones[1].present = false;
    assert_int_equal(dea_device_prepare(&d, &error), DEA_ERR_INPUT);
    assert_string_equal(error.text, "a device needs at least one zone, left or right");
    d = design_c();
    d.thickness = -1.0;
    assert_int_equal(dea_device_prepare(&d, &error), DEA_ERR_INPUT);
    d = design_c();
    d.prestretch[1] = NAN;
    assert_int_equal(dea_device_prepare(&d, &error), DEA_ERR_INPUT);
    d = design_c();
    d.has_stops = true;
    d.stops[0] = 0.1e-3;
    d.stops[1] = 0.2e-3;
    assert_int_equal(dea_device_prepare(&d, &error), DEA_ERR_INPUT);
    assert_string_equal(error.text, "platform.stops must lie on both sides of x = 0");
    d = design_c();
    d.material.dielectric.permittivity_slope = -3.0;
    assert_int_equal(dea_device_prepare(&d, &error), DEA_ERR_INPUT);
    assert_string_equal(error.text, "permittivity is not positive at the prestretch");
}

static void failed_prestretches_are_told_apart(void **state) {
    (void)state;
    const char *why;
    struct dea_device d = design_c();
    assert_false(dea_prestretch_fails(&d, &why));
    assert_null(why);
    d.prestretch[0] = 0.9;
    assert_true(dea_prestretch_fails(&d, &why)); /* 0.9 <= 1.2^-1/2 = 0.913 */
    assert_non_null(strstr(why, "direction 1"));
    d.prestretch[0] = 1.2;
    d.prestretch[1] = 0.9;
    assert_true(dea_prestretch_fails(&d, &why));
    assert_non_null(strstr(why, "direction 2"));
    d.prestretch[1] = 4.5; /* I1 = 21.7 > 19.6 */
    assert_true(dea_prestretch_fails(&d, &why));
    assert_non_null(strstr(why, "limit"));
    assert_true(dea_prestretch_fails(&d, NULL));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(design_c_has_its_known_constants),
        cmocka_unit_test(capacitance_follows_the_deformed_geometry),
        cmocka_unit_test(electrodes_resist_by_feed_and_stretch),
        cmocka_unit_test(stops_push_back_store_and_lose),
        cmocka_unit_test(prepare_refuses_what_cannot_be),
        cmocka_unit_test(failed_prestretches_are_told_apart),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
