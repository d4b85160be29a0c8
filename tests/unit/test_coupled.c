/* Devices in circuits of every kind: they run, their books close, and a tenth of the accuracy changes no more than it
 * may. Then single traits of one device between plant and circuit. */
#include "capture.h"
#include "coupled_capture.h"
#include "coupled_cases.h"
#include "scenes.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

/* ---- every kind of circuit ---- */

static void judge_scene(const struct coupled_scene *listed) {
    struct dea_scene scene;
    struct coupled_rows coarse, fine;
    make_listed_scene(listed, &scene);
    run_scene(&scene, DEA_ENGINE_NGSPICE, 1e-4, 500, &coarse);
    run_scene(&scene, DEA_ENGINE_NGSPICE, 1e-5, 500, &fine);
    if (coarse.status != DEA_OK || fine.status != DEA_OK)
        fail_msg("%s: %s", listed->name, coarse.status != DEA_OK ? coarse.error.text : fine.error.text);
    struct coupled_error change = compare_rows(&coarse, &fine);
    if (!(change.x <= 1e-4 && change.port <= 1e-4))
        fail_msg("%s: A = 1e-5 changes x by %.2e, a port by %.2e", listed->name, change.x, change.port);
    if (!(coarse.result.energy.imbalance <= 1e-4 && coarse.result.coupling_error <= 1e-4))
        fail_msg("%s: imbalance %.2e, coupling error %.2e", listed->name, coarse.result.energy.imbalance,
                 coarse.result.coupling_error);
    assert_int_equal(coarse.result.relaxed, 0);
    free_rows(&coarse);
    free_rows(&fine);
    dea_scene_clear(&scene);
}

static void test_every_kind(void **state) {
    (void)state;
    size_t count;
    const struct coupled_scene *scenes = list_scenes(&count);
    for (size_t i = 0; i < count; i++)
        judge_scene(&scenes[i]);
}

static const struct coupled_scene *find_scene(const char *name) {
    size_t count;
    const struct coupled_scene *scenes = list_scenes(&count);
    for (size_t i = 0; i < count; i++)
        if (strcmp(scenes[i].name, name) == 0)
            return &scenes[i];
    fail_msg("no scene %s", name);
    return NULL;
}

static double last_value(const struct coupled_rows *rows, const char *name) {
    int column = find_signal(rows, name);
    if (column < 0)
        fail_msg("no signal %s", name);
    return rows->values[(rows->count - 1) * rows->columns + (size_t)column];
}

/* A node without any path to ground has no operating point; the message says where and what helps. */
static void test_floating_electrode_is_named(void **state) {
    (void)state;
    static const struct coupled_scene floating = {
        "floating", "device: {" TWO_ZONES "}",
        "t\nVs s 0 2500\nRs s left 1meg\nRr r 0 1k\nXdea left 0 right r pos DEA\n.end\n", 1e-3, ""};
    struct dea_scene scene;
    struct coupled_rows rows;
    make_listed_scene(&floating, &scene);
    run_scene(&scene, DEA_ENGINE_NGSPICE, 1e-4, 100, &rows);
    assert_int_equal(rows.status, DEA_ERR_SOLVER);
    assert_non_null(strstr(rows.error.text, "no operating point at t = 0, singular at right"));
    assert_non_null(strstr(rows.error.text, "rshunt"));
    free_rows(&rows);
    dea_scene_clear(&scene);
}

/* The pins follow the zones' order in the device file. */
static void test_right_zone_first(void **state) {
    (void)state;
    struct dea_scene scene;
    struct coupled_rows rows, usual;
    make_listed_scene(find_scene("right_first"), &scene);
    run_scene(&scene, DEA_ENGINE_NGSPICE, 1e-5, 500, &rows);
    dea_scene_clear(&scene);
    struct coupled_scene left_first = *find_scene("r_1e5");
    left_first.netlist = find_scene("right_first")->netlist;
    make_listed_scene(&left_first, &scene);
    run_scene(&scene, DEA_ENGINE_NGSPICE, 1e-5, 500, &usual);
    dea_scene_clear(&scene);
    assert_true(last_value(&rows, "right.port_voltage") > 2400.0);
    assert_true(last_value(&usual, "left.port_voltage") > 2400.0);
    double x = last_value(&rows, "x"), mirrored = last_value(&usual, "x");
    assert_true(mirrored > 1e-4);
    assert_true(fabs(x + mirrored) < 1e-5 * mirrored);
    free_rows(&rows);
    free_rows(&usual);
}

/* Instances keep apart: names, states, books. */
static void test_two_devices(void **state) {
    (void)state;
    struct dea_scene scene;
    struct coupled_rows rows;
    make_listed_scene(find_scene("twice"), &scene);
    run_scene(&scene, DEA_ENGINE_NGSPICE, 1e-4, 500, &rows);
    assert_int_equal(rows.status, DEA_OK);
    assert_true(find_signal(&rows, "x") < 0);
    double one = last_value(&rows, "xone.x"), two = last_value(&rows, "xtwo.x");
    assert_true(one > 0.0 && two > 0.0 && fabs(one - two) > 1e-3 * one);
    free_rows(&rows);
    dea_scene_clear(&scene);
    make_listed_scene(find_scene("two_devices"), &scene);
    run_scene(&scene, DEA_ENGINE_NGSPICE, 1e-4, 500, &rows);
    assert_int_equal(rows.status, DEA_OK);
    assert_true(find_signal(&rows, "DEA.x") >= 0 && find_signal(&rows, "DEB.left.port_voltage") >= 0);
    free_rows(&rows);
    dea_scene_clear(&scene);
}

/* Bias at t = 0: operating point and rest together, leakage included. Nothing moves until the drive does. */
static void test_rest_under_bias(void **state) {
    (void)state;
    static const char *const names[] = {"bias", "bias_leak", "bias_exp"};
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        struct dea_scene scene;
        struct coupled_rows rows;
        make_listed_scene(find_scene(names[i]), &scene);
        run_scene(&scene, DEA_ENGINE_NGSPICE, 1e-5, 400, &rows);
        assert_int_equal(rows.status, DEA_OK);
        int x = find_signal(&rows, "x");
        double first = rows.values[x];
        assert_true(fabs(first) > 1e-5);
        for (size_t r = 0; r < rows.count && rows.times[r] < 1e-3; r++)
            assert_true(fabs(rows.values[r * rows.columns + (size_t)x] - first) < 1e-7 * fabs(first));
        free_rows(&rows);
        dea_scene_clear(&scene);
    }
}

/* With uic the films start empty unless .ic gives their electrodes a voltage. */
static void test_start_from_initial_conditions(void **state) {
    (void)state;
    struct dea_scene scene;
    struct coupled_rows rows;
    make_listed_scene(find_scene("uic_plain"), &scene);
    run_scene(&scene, DEA_ENGINE_NGSPICE, 1e-4, 400, &rows);
    assert_int_equal(rows.status, DEA_OK);
    int port = find_signal(&rows, "left.port_voltage");
    assert_true(fabs(rows.values[port]) < 1.0);
    assert_true(last_value(&rows, "left.port_voltage") > 1990.0);
    free_rows(&rows);
    dea_scene_clear(&scene);
    make_listed_scene(find_scene("uic"), &scene);
    run_scene(&scene, DEA_ENGINE_NGSPICE, 1e-4, 400, &rows);
    assert_int_equal(rows.status, DEA_OK);
    port = find_signal(&rows, "left.port_voltage");
    assert_true(fabs(rows.values[port] - 1500.0) < 1.0);
    free_rows(&rows);
    dea_scene_clear(&scene);
}

/* ---- events ---- */

#define BEHIND_1M "t\nVs s 0 PWL(0 0 1m 3300)\nRs s left 1meg\nRr right 0 1k\nXdea left 0 right 0 pos DEA\n.end\n"
#define DAMPED "device: {" ELASTIC ", platform: {damping: 0.2 N s/m}}"

static void run_events(const char *netlist, double stop, const char *events, enum dea_engine_choice engine,
                       struct coupled_rows *rows) {
    struct dea_scene scene;
    FILE *file = fopen("events.cir", "w");
    assert_non_null(file);
    fputs(netlist, file);
    assert_int_equal(fclose(file), 0);
    make_scene(DAMPED, "events.cir", stop, events, &scene);
    run_scene(&scene, engine, 1e-5, 200, rows);
    dea_scene_clear(&scene);
}

static const struct dea_signal_stats *find_stats(const struct coupled_rows *rows, const char *name) {
    int column = find_signal(rows, name);
    assert_true(column >= 0);
    return &rows->result.stats[column];
}

/* The run ends when the field is reached, with the books closed and extremes cut there. */
static void test_breakdown_stops(void **state) {
    (void)state;
    struct coupled_rows rows, linear;
    run_events(BEHIND_1M, 0.1, "events: {breakdown: stop}", DEA_ENGINE_NGSPICE, &rows);
    run_events(BEHIND_1M, 0.1, "events: {breakdown: stop}", DEA_ENGINE_AUTO, &linear);
    assert_string_equal(linear.result.stats_run.mode, "linear");
    assert_int_equal(rows.status, DEA_STOPPED);
    assert_int_equal(rows.result.event_count, 1);
    assert_int_equal(rows.result.events[0].kind, DEA_EVENT_BREAKDOWN);
    assert_int_equal(rows.result.events[0].zone, 0);
    assert_true(rows.result.t_end == rows.result.events[0].time);
    assert_true(fabs(rows.result.t_end - linear.result.t_end) < 1e-5 * linear.result.t_end);
    assert_true(rows.times[rows.count - 1] == rows.result.t_end);
    assert_true(fabs(find_stats(&rows, "left.true_field")->max - 100e6) < 1e-5 * 100e6);
    assert_true(rows.result.energy.imbalance < 1e-5);
    assert_true(rows.result.coupling_error < 1e-5);
    free_rows(&rows);
    free_rows(&linear);
}

/* The books of a film that breaks down between two points of the circuit, slack and its capacitance on the rise. */
static void test_breakdown_of_slack_film(void **state) {
    (void)state;
    struct dea_scene scene;
    read_tree_scene("tests/cases/breakdown_of_slack_film.yaml", &scene);
    struct capture run;
    capture_run(&scene, 1e-3, 500, &run);
    assert_int_equal(run.status, DEA_STOPPED);
    if (!(run.result.coupling_error <= 1e-4 && run.result.energy.imbalance <= 1e-4))
        fail_msg("coupling error %g, imbalance %g", run.result.coupling_error, run.result.energy.imbalance);
    capture_free(&run);
    dea_scene_clear(&scene);
}

/* A punctured film is 1 kOhm from then on; the platform goes home. Compare tests/cases/breakdown_short.yaml. */
static void test_breakdown_shorts(void **state) {
    (void)state;
    struct coupled_rows rows;
    run_events(BEHIND_1M, 0.1, "events: {breakdown: short}", DEA_ENGINE_NGSPICE, &rows);
    assert_int_equal(rows.status, DEA_OK);
    double divided = 3300.0 * 1e3 / (1e6 + 1e3);
    assert_true(fabs(last_value(&rows, "left.voltage") - divided) < 1e-4 * divided);
    assert_true(fabs(last_value(&rows, "left.current") - divided / 1e3) < 1e-4 * divided / 1e3);
    assert_true(fabs(last_value(&rows, "x")) < 5e-9);
    double field = find_stats(&rows, "left.true_field")->max; /* the short comes one circuit step late */
    assert_true(field > 99.99e6 && field < 100.1e6);
    assert_true(rows.result.energy.imbalance < 1e-5);
    assert_true(rows.result.coupling_error < 1e-5);
    free_rows(&rows);
}

/* What holds at the start is told at the start. */
static void test_breakdown_at_the_start(void **state) {
    (void)state;
    static const char biased[] = "t\nVs s 0 3600\nRs s left 1meg\nRr right 0 1k\nXdea left 0 right 0 pos DEA\n.end\n";
    struct coupled_rows rows;
    run_events(biased, 0.01, "events: {breakdown: stop}", DEA_ENGINE_NGSPICE, &rows);
    assert_int_equal(rows.status, DEA_STOPPED);
    assert_true(rows.result.t_end == 0.0);
    free_rows(&rows);
    run_events(biased, 0.01, "events: {breakdown: short}", DEA_ENGINE_NGSPICE, &rows);
    assert_int_equal(rows.status, DEA_OK);
    assert_true(fabs(last_value(&rows, "left.voltage") - 3600.0 * 1e3 / (1e6 + 1e3)) < 1e-3);
    free_rows(&rows);
    run_events(biased, 0.01, "events: {breakdown: warn}", DEA_ENGINE_NGSPICE, &rows);
    assert_int_equal(rows.status, DEA_OK);
    assert_int_equal(rows.result.event_count, 1);
    assert_true(rows.result.events[0].time == 0.0);
    free_rows(&rows);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_every_kind, set_up_folder, tear_down_folder),
        cmocka_unit_test_setup_teardown(test_floating_electrode_is_named, set_up_folder, tear_down_folder),
        cmocka_unit_test_setup_teardown(test_right_zone_first, set_up_folder, tear_down_folder),
        cmocka_unit_test_setup_teardown(test_two_devices, set_up_folder, tear_down_folder),
        cmocka_unit_test_setup_teardown(test_rest_under_bias, set_up_folder, tear_down_folder),
        cmocka_unit_test_setup_teardown(test_start_from_initial_conditions, set_up_folder, tear_down_folder),
        cmocka_unit_test_setup_teardown(test_breakdown_stops, set_up_folder, tear_down_folder),
        cmocka_unit_test(test_breakdown_of_slack_film),
        cmocka_unit_test_setup_teardown(test_breakdown_shorts, set_up_folder, tear_down_folder),
        cmocka_unit_test_setup_teardown(test_breakdown_at_the_start, set_up_folder, tear_down_folder),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
