/* What is delivered for the accuracy asked, against the independent program: a slice of tests/stress/accuracy; and what
 * it costs. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>
#include <stdio.h>

#include "capture.h"
#include "scenes.h"

enum { SAMPLES = 499 };

/* Asked accuracies; delivered between a hundredth and the whole of it. */
static void test_delivered_accuracy(void **context) {
    (void)context;
    static struct test_scene s;
    static const enum test_scene_name names[] = {SCENE_RC_STEP, SCENE_RC_UNDAMPED, SCENE_SINE, SCENE_ANTIPHASE,
                                                 SCENE_VISCOUS, SCENE_ALGEBRAIC,   SCENE_RAMP, SCENE_STIFF_BRANCH};
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        struct independent_trace truth;
        build_scene(&s, names[i]);
        if (!independent_run(&s.scene, 1e-13, SAMPLES, &truth))
            fail_msg("%s: %s", test_scene_names[names[i]], truth.trouble);
        for (double accuracy = 1e-2; accuracy > 0.5e-8; accuracy *= 1e-2) {
            struct capture run;
            capture_run(&s.scene, accuracy, SAMPLES, &run);
            assert_int_equal(run.status, DEA_OK);
            double error = capture_error(&run, &truth, NULL), gap = run.result.energy.imbalance;
            if (!(error <= accuracy && error >= 0.009 * accuracy && gap <= 0.1 * accuracy))
                fail_msg("%s: asked %g, got %g, energy gap %g", test_scene_names[names[i]], accuracy, error, gap);
            capture_free(&run);
        }
        independent_free(&truth);
    }
}

/* A slice of `./dev bench accuracy`: no scene delivers less than asked, nor closes its books worse. */
static void test_scenes_keep_promise(void **context) {
    (void)context;
    static const char *const scenes[] = {"tests/cases/amplifier_tight_current.yaml",
                                         "tests/cases/amplifier_chopped.yaml",
                                         "tests/cases/massless_leaking.yaml",
                                         "tests/cases/slack_passive.yaml",
                                         "tests/cases/sine_resonance.yaml",
                                         "examples/rc_step.yaml",
                                         "tests/cases/charge_far_from_settled.yaml",
                                         "tests/cases/creep_through_pulses.yaml",
                                         "tests/cases/overdamped_sine.yaml",
                                         "tests/cases/slack_near_ideal_source.yaml",
                                         "tests/cases/ringing_choke.yaml"};
    for (size_t i = 0; i < sizeof scenes / sizeof scenes[0]; i++) {
        struct dea_scene scene;
        read_tree_scene(scenes[i], &scene);
        struct capture reference;
        capture_run(&scene, 1e-8, SAMPLES, &reference);
        assert_true(reference.status >= 0);
        for (double accuracy = 1e-2; accuracy > 0.5e-5; accuracy *= 1e-2) {
            struct capture run;
            capture_run(&scene, accuracy, SAMPLES, &run);
            double delivered = capture_difference(&run, &reference, NULL), gap = run.result.energy.imbalance;
            if (!(delivered <= accuracy && delivered > 0.0 && gap <= accuracy))
                fail_msg("%s: asked %g, got %g, energy gap %g", scenes[i], accuracy, delivered, gap);
            capture_free(&run);
        }
        capture_free(&reference);
        dea_scene_clear(&scene);
    }
}

/* Each entry of the energy balance, not only that they add up. */
static void test_energy_against_independent_books(void **context) {
    (void)context;
    static struct test_scene s;
    struct independent_trace truth;
    build_scene(&s, SCENE_RC_STEP);
    assert_true(independent_run(&s.scene, 1e-13, SAMPLES, &truth));
    struct capture run;
    capture_run(&s.scene, 1e-6, SAMPLES, &run);
    const struct dea_energy *energy = &run.result.energy;
    assert_true(fabs(energy->in - truth.work) <= 1e-5 * truth.work);
    assert_true(fabs(energy->branch - truth.branch_loss) <= 1e-5 * truth.loss);
    assert_true(fabs(energy->dissipated - truth.loss) <= 1e-5 * truth.loss);
    assert_true(fabs(energy->stored - truth.stored) <= 1e-5 * truth.stored);
    capture_free(&run);
    independent_free(&truth);
}

/* An RC step to a true error of 3e-4: so many steps and residuals at most. */
static void test_cost(void **context) {
    (void)context;
    static struct test_scene s;
    struct independent_trace truth;
    build_scene(&s, SCENE_RC_STEP);
    assert_true(independent_run(&s.scene, 1e-13, SAMPLES, &truth));
    struct capture run;
    capture_run(&s.scene, 1e-3, SAMPLES, &run);
    assert_true(capture_error(&run, &truth, NULL) <= 3e-4);
    assert_true(run.result.stats_run.plant_steps < 1200);
    assert_true(run.result.stats_run.residuals < 3000);
    capture_free(&run);
    independent_free(&truth);
}

/* A choke that could ring but does not: its small current, judged by itself, took five times the steps. */
static void test_cost_of_quiet_choke(void **context) {
    (void)context;
    struct dea_scene scene;
    read_tree_scene("tests/cases/quiet_choke.yaml", &scene);
    struct capture run;
    capture_run(&scene, 1e-3, SAMPLES, &run);
    assert_int_equal(run.status, DEA_OK);
    assert_in_range(run.result.stats_run.plant_steps, 1, 2500);
    capture_free(&run);
    dea_scene_clear(&scene);
}

/* Books of drives that move little for their size, or take their time. */
static void test_small_and_slow_energy(void **context) {
    (void)context;
    static struct test_scene s;
    static const double slow[] = {1e-3, 1e-6, 1e-7};
    for (size_t i = 0; i < sizeof slow / sizeof slow[0]; i++) {
        build_scene(&s, SCENE_SINE);
        s.scene.sources[0].waveform = sine_wave(1000.0, 1000.0, slow[i]);
        s.scene.stop = 3.0 / slow[i];
        struct capture run;
        capture_run(&s.scene, 1e-4, SAMPLES, &run);
        assert_int_equal(run.status, DEA_OK);
        if (run.result.energy.imbalance > 1e-4)
            fail_msg("%g Hz: energy gap %g", slow[i], run.result.energy.imbalance);
        capture_free(&run);
    }
    build_random_scene(&s, 5); /* a constant voltage: nothing moves */
    struct capture rest;
    capture_run(&s.scene, 1e-4, SAMPLES, &rest);
    assert_true(rest.result.energy.imbalance == 0.0);
    capture_free(&rest);
    build_scene(&s, SCENE_RC_STEP); /* stopped long before the step has charged the film */
    s.scene.sources[0].resistance = 1e9;
    s.scene.stop = 1e-6;
    struct capture run;
    capture_run(&s.scene, 1e-4, SAMPLES, &run);
    assert_int_equal(run.status, DEA_OK);
    assert_true(run.result.energy.imbalance <= 1e-4);
    capture_free(&run);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_delivered_accuracy),
        cmocka_unit_test(test_scenes_keep_promise),
        cmocka_unit_test(test_energy_against_independent_books),
        cmocka_unit_test(test_cost),
        cmocka_unit_test(test_cost_of_quiet_choke),
        cmocka_unit_test(test_small_and_slow_energy),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
