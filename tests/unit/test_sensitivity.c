/* How many times a motion multiplies small errors: none where it only swings, as worked out by hand where it is
 * unstable, many where it bounces. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>
#include <stdio.h>

#include "deasim/film.h"

#include "capture.h"
#include "scenes.h"

enum { SAMPLES = 200 };

static void expect_between(const char *what, double value, double low, double high) {
    if (!(value >= low && value <= high))
        fail_msg("%s: %.9g is not between %g and %g", what, value, low, high);
}

static double measure(const struct dea_scene *scene, double accuracy) {
    struct capture run;
    capture_run(scene, accuracy, SAMPLES, &run);
    assert_true(run.status >= 0);
    double sensitivity = run.result.sensitivity;
    capture_free(&run);
    return sensitivity;
}

static double measure_case(const char *name, double accuracy) {
    char path[512];
    struct dea_scene scene;
    snprintf(path, sizeof path, "tests/cases/%s.yaml", name);
    read_tree_scene(path, &scene);
    double sensitivity = measure(&scene, accuracy);
    dea_scene_clear(&scene);
    return sensitivity;
}

static void test_swings_do_not_multiply(void **context) {
    (void)context;
    static struct test_scene s;
    static const enum test_scene_name names[] = {SCENE_RC_STEP, SCENE_RINGING, SCENE_VISCOUS, SCENE_ALGEBRAIC};
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        build_scene(&s, names[i]);
        expect_between(test_scene_names[names[i]], measure(&s.scene, 1e-3), 0.7, 1.4);
    }
}

/* Stiffness of both films at x = 0 under one voltage, N/m. */
static double biased_stiffness(const struct dea_device *device, double voltage) {
    double sum = 0.0;
    for (int k = 0; k < DEA_ZONES; k++) {
        struct dea_film film;
        assert_int_equal(dea_film_respond(device, k, DEA_CONTROL_VOLTAGE, 0.0, voltage, NULL, true, NULL, &film),
                         DEA_OK);
        sum += film.stiffness;
    }
    return sum;
}

/* On the top of a hill of constant curvature: errors made at time u have grown to cosh s(t - u) in position for one of
 * position, (omega/s) sinh s(t - u) for one of velocity; at rest both would swing on. Squares, integrated over u and t.
 */
static void test_unstable_rest(void **context) {
    (void)context;
    static struct test_scene s;
    static const double volts[] = {7800.0, 8500.0};
    for (size_t i = 0; i < 2; i++) {
        build_design_c(&s);
        s.device.device.slack = false;
        for (int k = 0; k < DEA_ZONES; k++)
            drive_zone(&s, k, dc_wave(volts[i]), 0.0);
        prepare_scene(&s);
        s.scene.stop = 5e-3;
        s.scene.max_step = 2e-6;
        const struct dea_device *device = &s.device.device;
        double curvature = -biased_stiffness(device, volts[i]) / device->effective_mass, t = s.scene.stop;
        assert_true(curvature > 0.0);
        double rate = sqrt(curvature), omega = sqrt(device->stiffness / device->effective_mass), ratio = omega / rate;
        double hyperbolic = (cosh(2.0 * rate * t) - 1.0) / (8.0 * curvature), flat = 0.25 * t * t;
        double expected = sqrt((hyperbolic + flat + ratio * ratio * (hyperbolic - flat)) / (0.5 * t * t));
        double found = measure(&s.scene, 1e-3);
        if (!(fabs(found - expected) <= 0.01 * expected))
            fail_msg("%g V: %.6g times instead of %.6g", volts[i], found, expected);
    }
}

/* Undamped bounces add up; a massless platform that meets its stops as often forgets. */
static void test_stops(void **context) {
    (void)context;
    expect_between("bounces", measure_case("end_stops_lossy", 1e-3), DEA_SENSITIVE, 1000.0);
    expect_between("creeps", measure_case("stop_chirp", 1e-3), 0.5, 1.5);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_swings_do_not_multiply),
        cmocka_unit_test(test_unstable_rest),
        cmocka_unit_test(test_stops),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
