/* Known numbers of a known device (Sylgard 186, 4 + 4 mm: stiffness, resonances, overshoot), loss as a loop's area, and
 * what stiffness, many branches and many cycles cost. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>
#include <string.h>

#include "capture.h"
#include "scenes.h"

#define REST_FREQUENCY 180.0 /* Hz, about */

static double value(const struct capture *run, size_t row, const char *name) {
    int column = capture_column(run, name);
    assert_true(column > 0);
    return run->values[row * run->columns + (size_t)column];
}

static void run_scene(const struct test_scene *s, double accuracy, size_t samples, struct capture *run) {
    capture_run(&s->scene, accuracy, samples, run);
    if (run->status != DEA_OK)
        fail_msg("%s", run->error.text);
    assert_int_equal(run->rows, samples + 1);
}

/* Frequency of a free oscillation from the upward passages of v through 0, interpolated between rows. */
static double measure_frequency(const struct capture *run) {
    double first = NAN, last = NAN, count = 0.0;
    for (size_t i = 1; i + 1 < run->rows; i++) {
        double a = value(run, i, "v"), b = value(run, i + 1, "v"), t = run->values[i * run->columns];
        if (!(a < 0.0 && b >= 0.0))
            continue;
        last = t + (run->values[(i + 1) * run->columns] - t) * a / (a - b);
        if (isnan(first))
            first = last;
        else
            count += 1.0;
    }
    return count / (last - first);
}

static void test_resonances(void **context) {
    (void)context;
    static struct test_scene s;
    build_design_c(&s);
    assert_true(fabs(s.device.device.stiffness - 554.07) < 0.005);
    assert_true(fabs(s.device.device.zones[0].rest_capacitance - 80.5e-12) < 0.05e-12);
    for (int biased = 0; biased <= 1; biased++) {
        build_design_c(&s);
        if (biased)
            for (int k = 0; k < DEA_ZONES; k++)
                drive_zone(&s, k, dc_wave(3300.0), 0.0);
        s.scene.has_load_waveform = true;
        s.scene.load = step_wave(0.0, 1e-5, 0.0);
        struct capture run;
        run_scene(&s, 1e-6, 2000, &run);
        double found = measure_frequency(&run), expected = biased ? 161.6 : REST_FREQUENCY;
        if (fabs(found - expected) > (biased ? 0.1 : 0.6))
            fail_msg("%g Hz instead of %g Hz", found, expected);
        capture_free(&run);
    }
}

static void test_overshoot(void **context) {
    (void)context;
    static struct test_scene s;
    static const double ramps[] = {0.0, 0.5, 1.0, 2.0}, ratios[] = {1.96, 1.75, 1.34, 1.17};
    for (size_t i = 0; i < 4; i++) {
        build_design_c(&s);
        drive_zone(&s, 0, step_wave(0.0, 3300.0, ramps[i] / REST_FREQUENCY), 0.0);
        struct capture run;
        run_scene(&s, 1e-5, 2000, &run);
        double ratio = capture_stats(&run, "x")->max / 0.42957e-3; /* static displacement at 3300 V */
        if (fabs(ratio - ratios[i]) > 0.012)
            fail_msg("overshoot %g after a ramp of %g periods, not %g", ratio, ramps[i], ratios[i]);
        capture_free(&run);
    }
}

static void test_loss_is_loop_area(void **context) {
    (void)context;
    enum { PERIODS = 40, PER_PERIOD = 400 };
    static struct test_scene s;
    build_scene(&s, SCENE_SINE);
    s.scene.sources[0].resistance = 0.0;
    s.device.device.material.branch_count = 1; /* settled after a few of the periods */
    prepare_scene(&s);
    s.scene.stop = PERIODS / 60.0;
    struct capture run;
    run_scene(&s, 1e-7, (size_t)PERIODS * PER_PERIOD, &run);
    double loop = 0.0;
    size_t end = run.rows - 1, begin = end - PER_PERIOD;
    for (size_t i = begin; i < end; i++)
        loop += 0.5 * (value(&run, i, "left.port_voltage") + value(&run, i + 1, "left.port_voltage")) *
                (value(&run, i + 1, "left.charge") - value(&run, i, "left.charge"));
    double lost = value(&run, end, "energy.dissipated") - value(&run, begin, "energy.dissipated");
    assert_true(lost > 0.0);
    if (fabs(loop - lost) > 2e-4 * lost)
        fail_msg("a cycle loses %.9g J, its loop in V and Q holds %.9g J", lost, loop);
    capture_free(&run);
}

/* Relaxation times over ten decades in one run of 10 000 s, the platform's inertia left out. */
static void test_creep(void **context) {
    (void)context;
    static struct test_scene s;
    build_design_c(&s);
    s.device.device.platform_mass = 0.0;
    s.device.device.membrane_mass = false;
    s.device.device.damping = 0.1;
    for (int decade = -6; decade <= 4; decade++)
        add_branch(&s, DEA_BRANCH_FOO, 2e4, pow(10.0, decade), INFINITY);
    drive_zone(&s, 0, step_wave(0.0, 2000.0, 0.0), 1e6);
    prepare_scene(&s);
    s.scene.stop = 1e4;
    struct capture run;
    run_scene(&s, 1e-4, 200, &run);
    if (run.result.stats_run.wall_s > 1.0 || run.result.energy.imbalance > 1e-4)
        fail_msg("%g s of computing, energy gap %g", run.result.stats_run.wall_s, run.result.energy.imbalance);
    capture_free(&run);
}

/* Work per residual grows in proportion to the branches: steps do not. */
static void test_branch_growth(void **context) {
    (void)context;
    static struct test_scene s;
    double seconds[2] = {INFINITY, INFINITY};
    long steps[2] = {0, 0};
    for (int repeat = 0; repeat < 3; repeat++)
        for (int many = 0; many <= 1; many++) {
            int count = many ? 32 : 4;
            build_design_c(&s);
            for (int b = 0; b < count; b++)
                add_branch(&s, DEA_BRANCH_FOO, 1.2e5 / count, 1e-3 * pow(100.0, (double)b / count), INFINITY);
            drive_zone(&s, 0, step_wave(0.0, 3000.0, 0.0), 1e6);
            prepare_scene(&s);
            struct capture run;
            run_scene(&s, 1e-5, 50, &run);
            seconds[many] = fmin(seconds[many], run.result.stats_run.wall_s);
            steps[many] = run.result.stats_run.plant_steps;
            capture_free(&run);
        }
    if (steps[1] > 2 * steps[0] || seconds[1] > 16.0 * seconds[0])
        fail_msg("4 branches: %ld steps, %g s; 32 branches: %ld steps, %g s", steps[0], seconds[0], steps[1],
                 seconds[1]);
}

/* Many cycles of a massless device: neither the error nor the energy gap grows out of hand. */
static void test_many_cycles(void **context) {
    (void)context;
    static struct test_scene s;
    build_scene(&s, SCENE_ALGEBRAIC);
    s.scene.stop = 1000.0 / 200.0;
    struct capture coarse, fine;
    run_scene(&s, 1e-4, 4999, &coarse);
    run_scene(&s, 1e-7, 4999, &fine);
    double error = capture_difference(&coarse, &fine, NULL);
    if (error > 1e-4 || coarse.result.energy.imbalance > 1e-4)
        fail_msg("after 1000 cycles: error %g, energy gap %g", error, coarse.result.energy.imbalance);
    capture_free(&coarse);
    capture_free(&fine);
}

/* One film slack by its voltage, the other one with it: nothing says where a platform without mass and damping is, and
 * the reason says that. */
static void test_nothing_holds_the_platform(void **context) {
    (void)context;
    static struct test_scene s;
    build_design_c(&s);
    s.device.device.platform_mass = 0.0;
    s.device.device.membrane_mass = false;
    s.device.device.prestretch[0] = 0.9577;
    s.device.device.prestretch[1] = 1.147;
    drive_zone(&s, 0, dc_wave(2500.0), 1e5);
    prepare_scene(&s);
    s.scene.stop = 1e-3;
    struct capture run;
    capture_run(&s.scene, 1e-3, 200, &run);
    assert_int_equal(run.status, DEA_ERR_SOLVER);
    if (strstr(run.error.text, "slack films hold a platform without mass and damping nowhere: give it "
                               "platform.damping") == NULL)
        fail_msg("%s", run.error.text);
    capture_free(&run);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_nothing_holds_the_platform),
        cmocka_unit_test(test_resonances),
        cmocka_unit_test(test_overshoot),
        cmocka_unit_test(test_loss_is_loop_area),
        cmocka_unit_test(test_creep),
        cmocka_unit_test(test_branch_growth),
        cmocka_unit_test(test_many_cycles),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
