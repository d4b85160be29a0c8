/* The coupling as a whole: what it delivers for the accuracy asked, against circuit and device integrated as one system
 * by another program. */
#include "coupled_capture.h"
#include "coupled_cases.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { SAMPLES = 1500 };

static void check_run(const struct coupled_rows *rows, double a) {
    if (rows->status != DEA_OK)
        fail_msg("%s", rows->error.text);
    assert_true(rows->result.energy.imbalance <= a);
    assert_true(rows->result.coupling_error <= a);
    assert_string_equal(rows->result.stats_run.mode, "cosim");
}

/* Errors of x and of the port voltages stay below each accuracy asked, and are not far smaller than needed. */
static void judge_case(const char *name, double coarsest, double finest) {
    const struct coupled_case *c = find_case(name);
    assert_non_null(c);
    struct dea_scene scene;
    struct coupled_trace trace;
    make_circuit_scene(c->device, &c->circuit, SILENT_EVENTS, &scene);
    assert_true(solve_circuit(&c->circuit, &scene.devices[0].device, 1e-11, SAMPLES, &trace));
    for (double a = coarsest; a > 0.9 * finest; a *= 0.1) {
        struct coupled_rows rows;
        run_scene(&scene, DEA_ENGINE_NGSPICE, a, SAMPLES, &rows);
        check_run(&rows, a);
        struct coupled_error e = compare_with_trace(&rows, &trace);
        if (!(e.x <= a && e.port <= a))
            fail_msg("%s at A = %.0e: error %.3g A in x, %.3g A at the ports", name, a, e.x / a, e.port / a);
        free_rows(&rows);
    }
    free_trace(&trace);
    dea_scene_clear(&scene);
}

static void test_rc_step(void **state) {
    (void)state;
    judge_case("rc_step", 1e-2, 1e-6);
}

static void test_two_side_sine(void **state) {
    (void)state;
    judge_case("two_side_sine", 1e-2, 1e-6);
}

static void test_ladder(void **state) {
    (void)state;
    judge_case("ladder", 1e-2, 1e-6);
}

static void test_rlc(void **state) {
    (void)state;
    judge_case("rlc", 1e-2, 1e-4);
    judge_case("rlc_soft", 1e-2, 1e-5);
}

static void test_hold_on_leakage(void **state) {
    (void)state;
    judge_case("hold", 1e-2, 1e-6);
    judge_case("film_leak", 1e-2, 1e-4);
}

static void test_without_mass(void **state) {
    (void)state;
    judge_case("massless_ramp", 1e-2, 1e-5);
    judge_case("massless_bias", 1e-2, 1e-5);
    judge_case("massless_viscous", 1e-2, 1e-6);
    judge_case("massless_branches", 1e-2, 1e-5);
}

static void test_other_drives(void **state) {
    (void)state;
    judge_case("r_1k", 1e-3, 1e-4);
    judge_case("r_1G", 1e-3, 1e-4);
    judge_case("v_100", 1e-3, 1e-4);
    judge_case("both_bias", 1e-3, 1e-5);
    judge_case("reversal", 1e-3, 1e-5);
    judge_case("r_electrode", 1e-3, 1e-5);
}

/* ---- order ---- */

/* Error of x at a fixed exchange interval, the circuit's own error far below. */
static double exchange_error(const struct dea_scene *scene, const struct coupled_trace *trace, double interval) {
    struct coupled_rows rows;
    run_with_horizon(scene, 1e-6, interval, SAMPLES, &rows);
    if (rows.status != DEA_OK)
        fail_msg("%s", rows.error.text);
    double error = compare_with_trace(&rows, trace).x;
    free_rows(&rows);
    return error;
}

static void check_order(const char *name, double interval, double least, double most_error) {
    const struct coupled_case *c = find_case(name);
    struct dea_scene scene;
    struct coupled_trace trace;
    make_circuit_scene(c->device, &c->circuit, SILENT_EVENTS, &scene);
    assert_true(solve_circuit(&c->circuit, &scene.devices[0].device, 1e-11, SAMPLES, &trace));
    double coarse = exchange_error(&scene, &trace, interval), fine = exchange_error(&scene, &trace, interval / 4);
    double order = 0.5 * log2(coarse / fine);
    if (!(order >= least && coarse <= most_error))
        fail_msg("%s: order %.2f, errors %.2e and %.2e", name, order, coarse, fine);
    free_trace(&trace);
    dea_scene_clear(&scene);
}

/* With inertia the outlook is a Taylor series; without, what decides is that the capacitance gives way to its own
 * voltage: as on a massless, branchless film behind 1 MOhm, also with the other side at 4 kV. */
static void test_order_of_the_exchange(void **state) {
    (void)state;
    check_order("rc_step", 400e-6, 3.4, 2e-3);
    check_order("two_side_sine", 800e-6, 3.6, 5e-3);
    check_order("massless_ramp", 50e-6, 1.9, 1e-4);
    check_order("massless_bias", 50e-6, 1.9, 1e-3);
    check_order("massless_viscous", 50e-6, 2.4, 3e-4);
    check_order("massless_branches", 200e-6, 1.9, 5e-4);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_rc_step, set_up_folder, tear_down_folder),
        cmocka_unit_test_setup_teardown(test_two_side_sine, set_up_folder, tear_down_folder),
        cmocka_unit_test_setup_teardown(test_ladder, set_up_folder, tear_down_folder),
        cmocka_unit_test_setup_teardown(test_rlc, set_up_folder, tear_down_folder),
        cmocka_unit_test_setup_teardown(test_hold_on_leakage, set_up_folder, tear_down_folder),
        cmocka_unit_test_setup_teardown(test_without_mass, set_up_folder, tear_down_folder),
        cmocka_unit_test_setup_teardown(test_other_drives, set_up_folder, tear_down_folder),
        cmocka_unit_test_setup_teardown(test_order_of_the_exchange, set_up_folder, tear_down_folder),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
