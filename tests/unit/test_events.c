/* Events of a platform without mass: each is met once, at any accuracy. */
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
    struct dea_scene scene = {0};
    struct dea_error error;
    snprintf(path, sizeof path, "%s/tests/cases/%s.yaml", SOURCE_ROOT, name);
    if (dea_scene_read(path, NULL, 0, &scene, &error) != DEA_OK)
        fail_msg("%s", error.text);
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
static void test_stop_left_slowly(void **context) {
    (void)context;
    struct visits fine = visit_stops("stop_left_slowly", 1e-8);
    for (double accuracy = 1e-2; accuracy > 0.5e-4; accuracy *= 0.1) {
        struct visits found = visit_stops("stop_left_slowly", accuracy);
        assert_in_range(found.stops, fine.stops, fine.stops + 4);
        assert_true(fabs(found.first_leave - fine.first_leave) <= 0.1 * accuracy * fine.first_leave);
        assert_true(fabs(found.last_leave - fine.last_leave) <= 0.1 * accuracy * fine.last_leave);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_stops_without_mass),
        cmocka_unit_test(test_stop_left_slowly),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
