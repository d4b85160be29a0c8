/* What a run skips because the scene does not need it, each with the same run that does not skip: results agree, work
 * is spared. docs/skipping.md tells what is skipped and why. */
#include "coupled_capture.h"
#include "coupled_cases.h"
#include "skipped.h"

#include "cosim/cosim.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define DEVICE "device: {" TWO_ZONES "}"

static void make(const char *name, const char *device, const char *netlist, double stop, struct dea_scene *scene) {
    struct coupled_scene listed = {name, device, netlist, stop, ""};
    make_listed_scene(&listed, scene);
}

static void assert_good(const struct coupled_rows *rows) {
    if (rows->status != DEA_OK)
        fail_msg("%s", rows->error.text);
}

static void assert_agree(const char *name, const struct coupled_rows *rows, const struct coupled_rows *reference,
                         double tolerance) {
    struct coupled_error difference = compare_rows(rows, reference);
    if (!(difference.x <= tolerance && difference.port <= tolerance))
        fail_msg("%s: differs by %.2e in x, %.2e at a port", name, difference.x, difference.port);
}

/* ---- pairs ---- */

/* Columns of the lean run that both have, to the last bit. */
static bool same_columns(const struct coupled_rows *lean, const struct coupled_rows *full) {
    if (lean->count != full->count || lean->columns >= full->columns)
        return false;
    for (size_t i = 0; i < lean->columns; i++) {
        int j = find_signal(full, lean->signals[i].name);
        for (size_t r = 0; r < lean->count; r++)
            if (j < 0 || lean->values[r * lean->columns + i] != full->values[r * full->columns + (size_t)j])
                return false;
    }
    return true;
}

/* Relative L2 difference of a signal both have. */
static double column_difference(const struct coupled_rows *lean, const struct coupled_rows *full, const char *name) {
    int i = find_signal(lean, name), j = find_signal(full, name);
    double sum = 0.0, size = 0.0;
    for (size_t r = 0; i >= 0 && j >= 0 && r < lean->count; r++) {
        double a = lean->values[r * lean->columns + (size_t)i], b = full->values[r * full->columns + (size_t)j];
        sum += (a - b) * (a - b);
        size += b * b;
    }
    return lean->count == full->count && size > 0.0 ? sqrt(sum / size) : NAN;
}

/* Is as much spared as the list says? */
static bool is_spared(const struct skipped *pair, const struct dea_run_stats *lean, const struct dea_run_stats *full) {
    switch (pair->way) {
    case SKIPPED_CIRCUIT:
        return strcmp(lean->mode, "linear") == 0 && strcmp(full->mode, "cosim") == 0 && lean->circuit_points == 0 &&
               full->circuit_points > 0;
    case SKIPPED_SIGNALS:
        return lean->plant_steps == full->plant_steps && lean->residuals == full->residuals &&
               lean->circuit_points == full->circuit_points;
    case SKIPPED_STATES:
        return count_states(pair, false) - count_states(pair, true) == (int)pair->least_gain;
    default:
        return (double)full->plant_steps >= pair->least_gain * (double)lean->plant_steps;
    }
}

static void judge_pairs(enum skipped_way way) {
    size_t count;
    int wrong = 0;
    const struct skipped *pairs = list_skipped(&count);
    for (size_t i = 0; i < count; i++) {
        const struct skipped *pair = &pairs[i];
        struct coupled_rows lean, full;
        if (pair->way != way)
            continue;
        run_skipped(pair, true, 1000, &lean);
        run_skipped(pair, false, 1000, &full);
        struct coupled_error difference = {NAN, NAN};
        if (lean.status != DEA_OK || full.status != DEA_OK)
            print_message("%s: %s %s\n", pair->name, lean.error.text, full.error.text);
        else if (way == SKIPPED_SIGNALS)
            difference = (struct coupled_error){same_columns(&lean, &full) ? 0.0 : NAN, 0.0};
        else
            difference = (struct coupled_error){column_difference(&lean, &full, "x"),
                                                column_difference(&lean, &full, "left.port_voltage")};
        const struct dea_run_stats *a = &lean.result.stats_run, *b = &full.result.stats_run;
        if (!(difference.x <= pair->accuracy && difference.port <= pair->accuracy) || !is_spared(pair, a, b)) {
            print_message(
                "%s: x differs by %.2e, a port by %.2e; %ld points, %ld steps, %ld residuals against %ld, %ld, %ld\n",
                pair->name, difference.x, difference.port, a->circuit_points, a->plant_steps, a->residuals,
                b->circuit_points, b->plant_steps, b->residuals);
            wrong++;
        }
        free_rows(&lean);
        free_rows(&full);
    }
    assert_int_equal(wrong, 0);
}

static void test_linear_circuits(void **state) {
    (void)state;
    judge_pairs(SKIPPED_CIRCUIT);
}

static void test_many_circuit_points(void **state) {
    (void)state;
    judge_pairs(SKIPPED_POINTS);
}

static void test_circuits_at_rest(void **state) {
    (void)state;
    judge_pairs(SKIPPED_REST);
}

static void test_unwritten_signals(void **state) {
    (void)state;
    judge_pairs(SKIPPED_SIGNALS);
}

static void test_needless_states(void **state) {
    (void)state;
    judge_pairs(SKIPPED_STATES);
}

/* ---- rest ---- */

/* What a hold costs hardly grows with its length: bounds a third above the counts. */
static void test_length_of_a_hold(void **state) {
    (void)state;
    size_t count;
    const struct skipped *pairs = list_skipped(&count);
    for (size_t i = 0; i < count; i++) {
        if (strcmp(pairs[i].name, "half_bridge_10_s") != 0)
            continue;
        struct skipped longer = pairs[i];
        struct coupled_rows rows;
        longer.stop = 60.0;
        run_skipped(&longer, true, 1000, &rows);
        assert_good(&rows);
        assert_true(rows.result.energy.imbalance <= 1e-4 && rows.result.coupling_error <= 1e-4);
        if (rows.result.stats_run.circuit_points > 6500 || rows.result.stats_run.plant_steps > 11000)
            fail_msg("%ld points, %ld steps", rows.result.stats_run.circuit_points, rows.result.stats_run.plant_steps);
        free_rows(&rows);
    }
}

/* An hour on leakage: as one problem, and beside ngspice. */
static void test_hours_of_leakage(void **state) {
    (void)state;
    static const char netlist[] = "t\nVs s 0 PULSE(0 3000 5m 10u 10u 1e6 2e6)\nRc s left 10Meg\nCc left 0 100p\n"
                                  "Rl left 0 100G\nRb right 0 1k\nXdea left 0 right 0 pos DEA\n.end\n";
    struct dea_scene scene;
    struct coupled_rows linear, coupled;
    make("hour", DEVICE, netlist, 3600.0, &scene);
    run_scene(&scene, DEA_ENGINE_AUTO, 1e-4, 1000, &linear);
    run_scene(&scene, DEA_ENGINE_NGSPICE, 1e-4, 1000, &coupled);
    assert_good(&linear);
    assert_good(&coupled);
    assert_string_equal(linear.result.stats_run.mode, "linear");
    assert_true(linear.result.stats_run.plant_steps <= 3500);
    assert_agree("hour", &coupled, &linear, 1e-4);
    /* ngspice's own step control goes no further than sqrt(trtol) s where nothing flows */
    assert_true(coupled.result.stats_run.circuit_points <= 75000);
    assert_true(coupled.result.stats_run.plant_steps <= 8000);
    free_rows(&linear);
    free_rows(&coupled);
    dea_scene_clear(&scene);
}

/* A small swing that nothing damps is no rest. */
static void test_small_swing_is_followed(void **state) {
    (void)state;
    static const char netlist[] = "t\nVs s 0 PWL(0 500 1m 500 1.01m 510)\nRs s left 1meg\nRb right 0 1k\n"
                                  "Xdea left 0 right 0 pos DEA\n.end\n";
    struct dea_scene scene;
    struct coupled_rows with, linear;
    make("swing", "device: {" ELASTIC "}", netlist, 0.2, &scene);
    run_with_control(&scene, 1e-4, &(struct cosim_control){0}, 2000, &with);
    run_scene(&scene, DEA_ENGINE_AUTO, 1e-5, 2000, &linear);
    assert_good(&with);
    assert_good(&linear);
    assert_agree("swing", &with, &linear, 1e-4);
    free_rows(&with);
    free_rows(&linear);
    dea_scene_clear(&scene);
}

/* A load that pushes while the circuit rests: the circuit hears of it at once. A film behind 1 GOhm answers in voltage.
 */
/* Before the drive begins a branch of 0.1 us knows its own rate only to its last digit over that time: no steps are to
 * be made of that. */
static void test_fast_branch_waits(void **state) {
    (void)state;
    static const char device[] =
        "device: {" ELASTIC ", geometry: {width: 8.06 mm, thickness: 97.2 um, prestretch: [1.41859, 2.12965]}, "
        "material: {base: " SOURCE_ROOT "/models/materials/sylgard186_elastic.yaml, "
        "elastic: {law: ogden, terms: [{mu: 0.3 MPa, alpha: 2}, {mu: 10 kPa, alpha: 4}]}, branches: ["
        "{kind: network, mu: 2064.32, tau: 1.09676e-07}, {kind: foo, mu: 38148.6, tau: 0.00135272}, "
        "{kind: network, mu: 3242.8, tau: 0.393982}, {kind: foo, mu: 28316.3, tau: 299.782}]}, "
        "zones: {left: {length: 0.00709602, electrode: {sheet_resistance: 4889.84, feed: long_edge}}, "
        "right: {length: 0.00828298, electrode: {resistance: 1.29531e+06}}}, "
        "platform: {mass: 2.39006e-05 kg, damping: 0 N s/m}}";
    static const char netlist[] = "t\nVs s 0 PULSE(0 1500 10.5m 50u 50u 60m 1)\nRs s left 1meg\nRb right 0 1meg\n"
                                  "Xdea left 0 right 0 pos DEA\n.end\n";
    struct dea_scene scene;
    struct coupled_rows rows;
    make("waits", device, netlist, 40e-3, &scene);
    run_scene(&scene, DEA_ENGINE_NGSPICE, 1e-3, 400, &rows);
    assert_good(&rows);
    if (rows.result.stats_run.plant_steps > 10000)
        fail_msg("%ld steps", rows.result.stats_run.plant_steps);
    free_rows(&rows);
    dea_scene_clear(&scene);
}

static void test_load_ends_the_rest(void **state) {
    (void)state;
    static const char netlist[] = "t\nVs s 0 2500\nRs s left 1G\nCl left 0 100p\nRb right 0 1k\n"
                                  "Xdea left 0 right 0 pos DEA\n.end\n";
    static const struct coupled_scene listed = {
        "load", DEVICE, netlist, 8.0, "load: {type: pulse, high: 0.1 N, delay: 3.3 s, rise: 0 s, width: 2 s}"};
    struct dea_scene scene;
    struct coupled_rows with, without, linear;
    make_listed_scene(&listed, &scene);
    run_with_control(&scene, 1e-4, &(struct cosim_control){0}, 4000, &with);
    run_with_control(&scene, 1e-4, &(struct cosim_control){.restless = true}, 4000, &without);
    run_scene(&scene, DEA_ENGINE_AUTO, 1e-5, 4000, &linear);
    assert_good(&with);
    assert_good(&without);
    assert_good(&linear);
    assert_string_equal(linear.result.stats_run.mode, "linear");
    assert_agree("load", &with, &linear, 1e-4);
    assert_agree("load, restless", &without, &linear, 1e-4);
    free_rows(&with);
    free_rows(&without);
    free_rows(&linear);
    dea_scene_clear(&scene);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_linear_circuits, set_up_folder, tear_down_folder),
        cmocka_unit_test_setup_teardown(test_many_circuit_points, set_up_folder, tear_down_folder),
        cmocka_unit_test_setup_teardown(test_circuits_at_rest, set_up_folder, tear_down_folder),
        cmocka_unit_test_setup_teardown(test_unwritten_signals, set_up_folder, tear_down_folder),
        cmocka_unit_test_setup_teardown(test_needless_states, set_up_folder, tear_down_folder),
        cmocka_unit_test_setup_teardown(test_length_of_a_hold, set_up_folder, tear_down_folder),
        cmocka_unit_test_setup_teardown(test_hours_of_leakage, set_up_folder, tear_down_folder),
        cmocka_unit_test_setup_teardown(test_small_swing_is_followed, set_up_folder, tear_down_folder),
        cmocka_unit_test_setup_teardown(test_fast_branch_waits, set_up_folder, tear_down_folder),
        cmocka_unit_test_setup_teardown(test_load_ends_the_rest, set_up_folder, tear_down_folder),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
