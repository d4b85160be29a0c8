/* Traps of ngspice's synchronisation interface. Each test names the guard it watches and fails without it. The others
 * are in test_engine.c: breakpoint and left limit, the last resort for the operating point that may never end
 * (test_failures_are_explained). */
#include "base/isolate.h"
#include "circuit/engine.h"
#include "loaded_text.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#define MAX_STEP 1e-4 /* s */
#define FLOOR (1e-10 * MAX_STEP)

/* A run, what it asks for and what it sees. */
struct watch {
    double (*request)(long step, double delta); /* of the step before it, s; NULL: none */
    int stop_after;                             /* points; 0: none */
    long steps, points;
    double largest_step, last_time; /* s */
};

static void limit(void *context, double t, double *delta) {
    struct watch *watch = context;
    (void)t;
    watch->steps++;
    if (watch->request != NULL)
        *delta = watch->request(watch->steps, *delta);
}

static enum dea_status take(void *context, const struct dea_circuit_point *point, struct dea_error *error) {
    struct watch *watch = context;
    (void)error;
    if (watch->points > 0)
        watch->largest_step = fmax(watch->largest_step, point->time - watch->last_time);
    watch->last_time = point->time;
    watch->points++;
    return watch->points == watch->stop_after ? DEA_STOPPED : DEA_OK;
}

static struct dea_deck_options usual_options(void) {
    return (struct dea_deck_options){.stop = 50.0 * MAX_STEP, .max_step = MAX_STEP};
}

static enum dea_status run_on(struct dea_engine *engine, const char *text, const struct dea_deck_options *options,
                              struct watch *watch, struct dea_engine_stats *stats, struct dea_error *error) {
    const struct dea_engine_callbacks callbacks = {
        .context = watch, .port_value = give_still, .before_step = limit, .accepted = take};
    struct loaded_text loaded;
    enum dea_status status = load_text(engine, text, &still_port, options, &callbacks, &loaded, error);
    if (status == DEA_OK)
        status = dea_engine_run(engine, error);
    dea_engine_stats(engine, stats);
    clear_text(&loaded);
    return status;
}

static enum dea_status run(const char *text, const struct dea_deck_options *options, struct watch *watch,
                           struct dea_engine_stats *stats, struct dea_error *error) {
    struct dea_engine *engine;
    assert_int_equal(dea_engine_open(&engine, error), DEA_OK);
    enum dea_status status = run_on(engine, text, options, watch, stats, error);
    dea_engine_close(engine);
    return status;
}

#define DIVIDER "t\nV1 in 0 PULSE(0 100 0 10u 10u 1 2)\nR1 in p 1meg\nXdea p 0 pos DEA\n"

/* ---- lengths of steps ---- */

static double ask_nothing(long step, double delta) {
    (void)step;
    (void)delta;
    return 0.0;
}

/* Guard: the floor under what before_step asks for. A step of no length would be repeated for ever. */
static void test_asking_for_nothing_gets_the_floor(void **state) {
    (void)state;
    struct watch watch = {.request = ask_nothing};
    struct dea_engine_stats stats;
    struct dea_error error;
    const struct dea_deck_options options = usual_options();
    assert_int_equal(run(DIVIDER, &options, &watch, &stats, &error), DEA_ERR_SOLVER);
    assert_non_null(strstr(error.text, "the run is not advancing past t = "));
    assert_true(stats.shortest >= FLOOR * (1.0 - 1e-6));
    assert_true(watch.steps < 20000); /* guard: TINY_WINDOW in check_progress, long before the other window */
}

static double ask_twice(long step, double delta) {
    (void)step;
    return 2.0 * delta;
}

/* Guard: `wanted < *delta`. A longer step would jump the source's corners at 1 and 1.01 ms. */
static void test_longer_steps_are_not_taken(void **state) {
    (void)state;
    struct watch watch = {.request = ask_twice};
    struct dea_engine_stats stats;
    struct dea_error error;
    const struct dea_deck_options options = usual_options();
    assert_int_equal(run(DIVIDER, &options, &watch, &stats, &error), DEA_OK);
    assert_true(watch.largest_step <= MAX_STEP * (1.0 + 1e-9));
}

static double ask_unevenly(long step, double delta) {
    double wanted = step % 100 > 95 ? 1e-9 * MAX_STEP : 2e-10 * MAX_STEP; /* ngspice at most doubles a step */
    return wanted < delta ? wanted : delta;
}

/* Guard: STALL_WINDOW in check_progress. Steps that are not all tiny do not bring the run forward either. */
static void test_uneven_crawl_is_ended(void **state) {
    (void)state;
    struct watch watch = {.request = ask_unevenly};
    struct dea_engine_stats stats;
    struct dea_error error;
    const struct dea_deck_options options = usual_options();
    assert_int_equal(run(DIVIDER, &options, &watch, &stats, &error), DEA_ERR_SOLVER);
    assert_non_null(strstr(error.text, "the run is not advancing past t = "));
    assert_true(watch.steps > 50000);
}

/* Guard: the fourth number of .tran. Without it no step is longer than tstep, which is only the grid of a printout. */
static void test_tstep_does_not_limit(void **state) {
    (void)state;
    struct watch watch = {0};
    struct dea_engine_stats stats;
    struct dea_error error;
    struct dea_deck_options options = usual_options();
    options.step = 1e-7;
    assert_int_equal(run("t\nV1 p 0 100\nXdea p 0 pos DEA\n", &options, &watch, &stats, &error), DEA_OK);
    assert_true(watch.largest_step > 0.9 * MAX_STEP);
    assert_true(watch.points < 100);
}

/* ---- one run after the other ---- */

/* Guard: unload. The stop condition of a run that was ended goes with its circuit, or it would end the next run too. */
static void test_stopped_run_does_not_stop_the_next(void **state) {
    (void)state;
    struct watch first = {.stop_after = 10}, second = {0};
    struct dea_engine_stats stats;
    struct dea_error error;
    const struct dea_deck_options options = usual_options();
    struct dea_engine *engine;
    assert_int_equal(dea_engine_open(&engine, &error), DEA_OK);
    assert_int_equal(run_on(engine, DIVIDER, &options, &first, &stats, &error), DEA_STOPPED);
    assert_int_equal(first.points, 10);
    if (run_on(engine, DIVIDER, &options, &second, &stats, &error) != DEA_OK)
        fail_msg("%s", error.text);
    assert_true(second.points > 50);
    assert_true(stats.reached == options.stop);
    dea_engine_close(engine);
}

/* A circuit after which ngspice asks to exit, then a good one. */
static enum dea_status run_after_exit(struct dea_channel *channel, void *context, struct dea_error *error) {
    (void)channel;
    (void)context;
    struct watch watch = {0};
    struct dea_engine_stats stats;
    struct dea_engine *engine;
    const struct dea_deck_options options = usual_options();
    DEA_TRY(dea_engine_open(&engine, error));
    enum dea_status status = run_on(engine, DIVIDER "R2 p 0 {foo*2}\n", &options, &watch, &stats, error);
    dea_engine_close(engine);
    if (status != DEA_ERR_INPUT)
        return dea_fail(error, DEA_ERR_INTERNAL, "the first circuit was not refused");
    return dea_engine_open(&engine, error);
}

/* Guard: `library_dead`. After ngspice has asked to exit, a call into it would crash. */
static void test_no_engine_after_exit(void **state) {
    (void)state;
    struct dea_error error;
    assert_int_equal(dea_isolate_run(run_after_exit, NULL, NULL, NULL, NULL, &error), DEA_ERR_SOLVER);
    assert_non_null(strstr(error.text, "ngspice has asked to exit and cannot be used again in this process"));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_asking_for_nothing_gets_the_floor),
        cmocka_unit_test(test_longer_steps_are_not_taken),
        cmocka_unit_test(test_uneven_crawl_is_ended),
        cmocka_unit_test(test_tstep_does_not_limit),
        cmocka_unit_test(test_stopped_run_does_not_stop_the_next),
        cmocka_unit_test(test_no_engine_after_exit),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
