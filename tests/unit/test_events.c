/* End stops of a platform without mass, or damped too much to swing: each is met and left once, at any accuracy. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>
#include <stdio.h>

#include "capture.h"
#include "scenes.h"

enum { SAMPLES = 500 };

struct visits {
    int stops; /* comings and goings */
    double first_leave, last_leave;
    long steps;
};

static struct visits visit_stops(const char *name, double accuracy) {
    char path[512];
    struct dea_scene scene;
    snprintf(path, sizeof path, "tests/cases/%s.yaml", name);
    read_tree_scene(path, &scene);
    struct capture run;
    capture_run(&scene, accuracy, SAMPLES, &run);
    assert_int_equal(run.status, DEA_OK);
    struct visits visits = {.steps = run.result.stats_run.plant_steps};
    for (size_t i = 0; i < run.result.event_count; i++) {
        const struct dea_event *event = &run.result.events[i];
        if (event->kind != DEA_EVENT_STOP)
            continue;
        visits.stops++;
        if (event->cleared)
            visits.last_leave = event->time;
        if (event->cleared && visits.first_leave == 0.0)
            visits.first_leave = event->time;
    }
    capture_free(&run);
    dea_scene_clear(&scene);
    return visits;
}

/* Without damping either: on the stop or off it as the forces say. The same moments at any accuracy, in few steps. */
static void test_stops_without_mass(void **context) {
    (void)context;
    struct visits fine = visit_stops("stop_without_mass", 1e-8);
    assert_int_equal(fine.stops, 23);
    for (double accuracy = 1e-2; accuracy > 0.5e-6; accuracy *= 0.1) {
        struct visits found = visit_stops("stop_without_mass", accuracy);
        assert_int_equal(found.stops, fine.stops);
        assert_true(fabs(found.first_leave - fine.first_leave) <= 0.01 * accuracy * fine.first_leave);
        assert_true(fabs(found.last_leave - fine.last_leave) <= 0.01 * accuracy * fine.last_leave);
        assert_in_range(found.steps, 100, 4000);
    }
}

/* Damped: it leaves when the push changes sign, however little it lies in the stop. */
static void expect_to_leave(const char *name) {
    struct visits fine = visit_stops(name, 1e-8);
    for (double accuracy = 1e-2; accuracy > 0.5e-4; accuracy *= 0.1) {
        struct visits found = visit_stops(name, accuracy);
        if (found.stops < fine.stops || found.stops > fine.stops + 4)
            fail_msg("%s at %g: %d events instead of %d", name, accuracy, found.stops, fine.stops);
        assert_true(fabs(found.first_leave - fine.first_leave) <= 1e-3 * fine.first_leave);
        assert_true(fabs(found.last_leave - fine.last_leave) <= 1e-3 * fine.last_leave);
    }
}

static void test_stop_left_slowly(void **context) {
    (void)context;
    expect_to_leave("stop_left_slowly");
    expect_to_leave("stop_left_overdamped");
}

/* Thrown onto the stop against the forces: met and left once, by its momentum. */
static void test_thrown_onto_a_stop(void **context) {
    (void)context;
    static struct test_scene s;
    build_design_c(&s);
    s.device.device.damping = 2.0;
    s.device.device.has_stops = true;
    s.device.device.stops[0] = -1e-3;
    s.device.device.stops[1] = 0.02e-3;
    prepare_scene(&s);
    s.scene.has_initial_v = true;
    s.scene.initial_v = 0.8;
    s.scene.stop = 20e-3;
    struct capture run;
    capture_run(&s.scene, 1e-4, SAMPLES, &run);
    assert_int_equal(run.status, DEA_OK);
    assert_int_equal(run.result.event_count, 2);
    for (size_t i = 0; i < 2; i++) {
        assert_int_equal(run.result.events[i].kind, DEA_EVENT_STOP);
        assert_int_equal(run.result.events[i].cleared, i == 1);
    }
    assert_true(run.result.events[1].time > 2.0 * run.result.events[0].time);
    capture_free(&run);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_stops_without_mass),
        cmocka_unit_test(test_stop_left_slowly),
        cmocka_unit_test(test_thrown_onto_a_stop),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
