/* A child process may crash, hang, exit or talk a lot; the parent always gets an answer. */
#include "base/isolate.h"
#include "memory.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include <cmocka.h>

#define ROW 20

static double seconds(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* ---- children ---- */

static enum dea_status send_rows(struct dea_channel *channel, void *context, struct dea_error *error) {
    (void)error;
    long rows = *(const long *)context;
    double row[ROW];
    for (long i = 0; i < rows; i++) {
        for (int k = 0; k < ROW; k++)
            row[k] = (double)i + k;
        DEA_TRY(dea_channel_send(channel, 7, row, sizeof row));
    }
    return DEA_OK;
}

static enum dea_status send_odd_sizes(struct dea_channel *channel, void *context, struct dea_error *error) {
    (void)context;
    char *data = malloc(DEA_MESSAGE_MAX);
    if (data == NULL)
        return dea_fail(error, DEA_ERR_MEMORY, "no memory");
    memset(data, 'x', DEA_MESSAGE_MAX);
    for (size_t size = 0; size < 3000; size++)
        DEA_TRY(dea_channel_send(channel, (uint32_t)size, data, size));
    DEA_TRY(dea_channel_send(channel, 99999, data, DEA_MESSAGE_MAX));
    enum dea_status refused = dea_channel_send(channel, 1, data, DEA_MESSAGE_MAX + 1);
    free(data);
    return refused == DEA_ERR_INTERNAL ? DEA_OK : DEA_ERR_EXPECTATION;
}

static enum dea_status fail_with_text(struct dea_channel *channel, void *context, struct dea_error *error) {
    (void)channel;
    (void)context;
    return dea_fail(error, DEA_ERR_INPUT, "scene.yaml:3: %s", "bad");
}

static enum dea_status crash(struct dea_channel *channel, void *context, struct dea_error *error) {
    (void)error;
    dea_channel_progress(channel, 0.0125);
    printf("about to fall\n");
    fflush(stdout);
    raise(*(const int *)context);
    return DEA_OK;
}

static enum dea_status leave_by_exit(struct dea_channel *channel, void *context, struct dea_error *error) {
    (void)context;
    (void)error;
    if (channel != NULL)
        _exit(42);
    return DEA_OK;
}

static enum dea_status hang(struct dea_channel *channel, void *context, struct dea_error *error) {
    (void)context;
    (void)error;
    dea_channel_progress(channel, 3.0);
    while (pause() != 0)
        ;
    return DEA_OK;
}

static enum dea_status wait_for_stop(struct dea_channel *channel, void *context, struct dea_error *error) {
    (void)context;
    for (double t = 0.0;; t += 1.0) {
        dea_channel_progress(channel, t);
        if (dea_channel_stop_requested(channel))
            return dea_fail(error, DEA_ERR_INTERRUPTED, "interrupted in order");
        usleep(1000);
    }
}

static enum dea_status eat_memory(struct dea_channel *channel, void *context, struct dea_error *error) {
    (void)channel;
    (void)context;
    for (int i = 0; i < 4096; i++)
        if (malloc((size_t)1 << 20) == NULL)
            return dea_fail(error, DEA_ERR_MEMORY, "no memory left");
    return DEA_OK;
}

/* ---- handlers ---- */

struct tally {
    long count;
    bool ordered;
    size_t bytes;
};

static enum dea_status count_rows(void *context, uint32_t type, const void *data, size_t size,
                                  struct dea_error *error) {
    struct tally *tally = context;
    (void)error;
    const double *row = data;
    if (type != 7 || size != ROW * sizeof(double) || row[0] != (double)tally->count ||
        row[ROW - 1] != (double)(tally->count + ROW - 1) || (uintptr_t)data % 8 != 0)
        tally->ordered = false;
    tally->count++;
    return DEA_OK;
}

static enum dea_status check_sizes(void *context, uint32_t type, const void *data, size_t size,
                                   struct dea_error *error) {
    struct tally *tally = context;
    (void)error;
    if (type != 99999 && (size != type || type != (uint32_t)tally->count))
        tally->ordered = false;
    if (size > 0 && (((const char *)data)[0] != 'x' || ((const char *)data)[size - 1] != 'x'))
        tally->ordered = false;
    tally->count++;
    tally->bytes += size;
    return DEA_OK;
}

static enum dea_status refuse_second(void *context, uint32_t type, const void *data, size_t size,
                                     struct dea_error *error) {
    (void)type;
    (void)data;
    (void)size;
    return ++*(int *)context == 2 ? dea_fail(error, DEA_ERR_OUTPUT, "disk full") : DEA_OK;
}

/* Rows until it is asked to end, then one of another type. */
static enum dea_status send_until_asked(struct dea_channel *channel, void *context, struct dea_error *error) {
    (void)context;
    double row = 0.0;
    while (!dea_channel_stop_requested(channel))
        if (dea_channel_send(channel, 1, &row, sizeof row) != DEA_OK || dea_channel_flush(channel) != DEA_OK)
            return dea_fail(error, DEA_ERR_INTERNAL, "the rows are not received");
    DEA_TRY(dea_channel_send(channel, 2, &row, sizeof row));
    return dea_fail(error, DEA_ERR_INTERRUPTED, "asked to end");
}

/* Stops at the third row, and again at every further one. */
static enum dea_status stop_third(void *context, uint32_t type, const void *data, size_t size,
                                  struct dea_error *error) {
    (void)data, (void)size, (void)error;
    int *seen = context;
    seen[type - 1]++;
    return type == 1 && seen[0] >= 3 ? DEA_STOPPED : DEA_OK;
}

/* ---- tests ---- */

static void test_rows_arrive_in_order_and_fast(void **state) {
    (void)state;
    long rows = 1000000;
    struct tally tally = {0, true, 0};
    struct dea_error error;
    double started = seconds();
    assert_int_equal(dea_isolate_run(send_rows, &rows, NULL, count_rows, &tally, &error), DEA_OK);
    double took = seconds() - started;
    assert_int_equal(tally.count, rows);
    assert_true(tally.ordered);
    print_message("%.2f million rows per second\n", 1e-6 * (double)rows / took);
}

static void test_any_size_up_to_the_limit(void **state) {
    (void)state;
    struct tally tally = {0, true, 0};
    struct dea_error error;
    assert_int_equal(dea_isolate_run(send_odd_sizes, NULL, NULL, check_sizes, &tally, &error), DEA_OK);
    assert_int_equal(tally.count, 3001);
    assert_true(tally.ordered);
    assert_int_equal(tally.bytes, 2999 * 3000 / 2 + DEA_MESSAGE_MAX);
}

static void test_failure_text_travels(void **state) {
    (void)state;
    struct dea_error error;
    assert_int_equal(dea_isolate_run(fail_with_text, NULL, NULL, NULL, NULL, &error), DEA_ERR_INPUT);
    assert_int_equal(error.status, DEA_ERR_INPUT);
    assert_string_equal(error.text, "scene.yaml:3: bad");
}

static void test_crash_names_signal_and_progress(void **state) {
    (void)state;
    struct dea_error error;
    char log_path[] = "isolate-log-XXXXXX";
    int file = mkstemp(log_path);
    assert_true(file >= 0);
    close(file);
    struct dea_isolate_limits limits = {.log_path = log_path};
    int number = SIGKILL; /* not SIGSEGV: sanitizers turn that into an exit */
    assert_int_equal(dea_isolate_run(crash, &number, &limits, NULL, NULL, &error), DEA_ERR_SOLVER);
    unlink(log_path);
    assert_non_null(strstr(error.text, "crashed with SIGKILL"));
    assert_non_null(strstr(error.text, "t = 0.0125 s"));
    assert_non_null(strstr(error.text, "its last words: about to fall"));
}

static void test_exit_is_not_success(void **state) {
    (void)state;
    struct dea_error error;
    assert_int_equal(dea_isolate_run(leave_by_exit, NULL, NULL, NULL, NULL, &error), DEA_ERR_SOLVER);
    assert_non_null(strstr(error.text, "exited by itself with code 42"));
}

static void test_hang_is_killed(void **state) {
    (void)state;
    struct dea_error error;
    struct dea_isolate_limits silence = {.silence_s = 0.3}, wall = {.wall_s = 0.3};
    double started = seconds();
    assert_int_equal(dea_isolate_run(hang, NULL, &silence, NULL, NULL, &error), DEA_ERR_SOLVER);
    assert_non_null(strstr(error.text, "was killed: it made no progress for too long"));
    assert_non_null(strstr(error.text, "t = 3 s"));
    assert_int_equal(dea_isolate_run(hang, NULL, &wall, NULL, NULL, &error), DEA_ERR_SOLVER);
    assert_non_null(strstr(error.text, "was killed: the wall time limit was reached"));
    assert_true(seconds() - started < 5.0);
}

static void test_progress_keeps_a_quiet_child_alive(void **state) {
    (void)state;
    struct dea_error error;
    volatile sig_atomic_t never = 0;
    struct dea_isolate_limits limits = {.silence_s = 0.2, .wall_s = 0.8, .stop = &never};
    assert_int_equal(dea_isolate_run(wait_for_stop, NULL, &limits, NULL, NULL, &error), DEA_ERR_SOLVER);
    assert_non_null(strstr(error.text, "wall time limit"));
}

static void test_stop_flag_ends_in_order(void **state) {
    (void)state;
    struct dea_error error;
    volatile sig_atomic_t stop = 1;
    struct dea_isolate_limits limits = {.stop = &stop};
    assert_int_equal(dea_isolate_run(wait_for_stop, NULL, &limits, NULL, NULL, &error), DEA_ERR_INTERRUPTED);
    assert_string_equal(error.text, "interrupted in order");
    struct dea_isolate_limits short_grace = {.stop = &stop, .grace_s = 0.2};
    assert_int_equal(dea_isolate_run(hang, NULL, &short_grace, NULL, NULL, &error), DEA_ERR_SOLVER);
    assert_non_null(strstr(error.text, "did not end when asked"));
}

static void test_handler_failure_ends_the_child(void **state) {
    (void)state;
    struct dea_error error;
    long rows = 10000000;
    int seen = 0;
    assert_int_equal(dea_isolate_run(send_rows, &rows, NULL, refuse_second, &seen, &error), DEA_ERR_OUTPUT);
    assert_string_equal(error.text, "disk full");
    assert_int_equal(seen, 2);
}

static void test_handler_can_ask_for_the_end(void **state) {
    (void)state;
    struct dea_error error;
    int seen[2] = {0, 0};
    assert_int_equal(dea_isolate_run(send_until_asked, NULL, NULL, stop_third, seen, &error), DEA_ERR_INTERRUPTED);
    assert_string_equal(error.text, "asked to end");
    assert_true(seen[0] >= 3);
    assert_int_equal(seen[1], 1); /* what came last was received too */
}

static void test_memory_limit(void **state) {
    (void)state;
#ifdef __SANITIZE_ADDRESS__
    skip(); /* the sanitizer's shadow needs terabytes of address space */
#endif
    struct dea_error error;
    struct dea_isolate_limits limits = {.memory_bytes = (size_t)1 << 30};
    assert_int_equal(dea_isolate_run(eat_memory, NULL, &limits, NULL, NULL, &error), DEA_ERR_MEMORY);
    assert_string_equal(error.text, "no memory left");
}

static void test_thousand_runs_leave_nothing(void **state) {
    (void)state;
    struct dea_error error;
    long rows = 10;
    struct tally tally = {0, true, 0};
    int lowest = dup(0);
    close(lowest);
    long after_warmup = 0;
    for (int i = 0; i < 1000; i++) {
        tally.count = 0;
        assert_int_equal(dea_isolate_run(send_rows, &rows, NULL, count_rows, &tally, &error), DEA_OK);
        if (i == 100)
            after_warmup = resident_bytes() / 1024;
    }
    assert_true(resident_bytes() / 1024 - after_warmup < 1024);
    int now = dup(0);
    close(now);
    assert_int_equal(now, lowest);                    /* no descriptor left */
    assert_int_equal(waitpid(-1, NULL, WNOHANG), -1); /* no child left */
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_rows_arrive_in_order_and_fast),
        cmocka_unit_test(test_any_size_up_to_the_limit),
        cmocka_unit_test(test_failure_text_travels),
        cmocka_unit_test(test_crash_names_signal_and_progress),
        cmocka_unit_test(test_exit_is_not_success),
        cmocka_unit_test(test_hang_is_killed),
        cmocka_unit_test(test_progress_keeps_a_quiet_child_alive),
        cmocka_unit_test(test_stop_flag_ends_in_order),
        cmocka_unit_test(test_handler_failure_ends_the_child),
        cmocka_unit_test(test_handler_can_ask_for_the_end),
        cmocka_unit_test(test_memory_limit),
        cmocka_unit_test(test_thousand_runs_leave_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
