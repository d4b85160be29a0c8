/* A netlist's run in its child process: asked to end, killed, out of time, not wanted any more. What was computed
 * stays. */
#include "cosim/supervise.h"
#include "coupled_capture.h"
#include "coupled_cases.h"

#include <ctype.h>
#include <dirent.h>
#include <math.h>
#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#define SAMPLE 0.1e-3 /* s between two rows */

/* Minutes of work: a million periods, each a thousand points or so. */
static const char endless[] = "t\nVs s 0 SIN(1000 1000 10k)\nRs s left 100k\nRr right 0 1k\n"
                              "Xdea left 0 right 0 pos DEA\n.end\n";

/* The only child of this process; 0: none, not even a zombie. */
static pid_t find_child(void) {
    DIR *proc = opendir("/proc");
    pid_t found = 0;
    assert_non_null(proc);
    for (struct dirent *entry; (entry = readdir(proc)) != NULL;) {
        char path[300];
        int parent = 0;
        if (!isdigit((unsigned char)entry->d_name[0]))
            continue;
        snprintf(path, sizeof path, "/proc/%s/stat", entry->d_name);
        FILE *file = fopen(path, "r");
        if (file != NULL && fscanf(file, "%*d (%*[^)]) %*c %d", &parent) == 1 && parent == getpid())
            found = (pid_t)atoi(entry->d_name);
        if (file != NULL)
            fclose(file);
    }
    closedir(proc);
    return found;
}

/* What becomes of the run once it is under way: after a number of rows, and after the child has sent a result. */
struct fate {
    int ask;               /* signal that asks the run to end; 0: none */
    int strike;            /* signal for the child; 0: none */
    bool refuse;           /* rows are not taken any more */
    bool with_result;      /* not before a partial result is here */
    double time_limit;     /* s; 0: none */
    const char *directory; /* of the log; NULL: none */
};

enum { ROWS_BEFORE = 20 };

struct rows {
    const struct fate *fate;
    const struct dea_result *result;
    long count;
    double last; /* s */
    bool met;    /* its fate */
};

static volatile sig_atomic_t interrupted;

static enum dea_status count_open(void *context, const struct dea_signal *signals, size_t count,
                                  struct dea_error *error) {
    (void)context, (void)signals, (void)count, (void)error;
    return DEA_OK;
}

static enum dea_status count_row(void *context, double t, const double *values, size_t count, struct dea_error *error) {
    struct rows *rows = context;
    for (size_t i = 0; i < count; i++)
        assert_true(isfinite(values[i]));
    assert_true(rows->count == 0 || t > rows->last);
    rows->count++;
    rows->last = t;
    if (rows->met || rows->count < ROWS_BEFORE || (rows->fate->with_result && rows->result->signal_count == 0))
        return DEA_OK;
    rows->met = true;
    interrupted = rows->fate->ask;
    if (rows->fate->strike != 0)
        assert_int_equal(kill(find_child(), rows->fate->strike), 0);
    return rows->fate->refuse ? dea_fail(error, DEA_ERR_OUTPUT, "the disk is full") : DEA_OK;
}

static enum dea_status run_endless(const struct fate *fate, struct rows *rows, struct dea_result *result,
                                   struct dea_error *error) {
    struct dea_scene scene;
    FILE *file = fopen("endless.cir", "w");
    assert_non_null(file);
    assert_true(fputs(endless, file) >= 0);
    assert_int_equal(fclose(file), 0);
    make_scene("{" TWO_ZONES "}", "endless.cir", 100.0, SILENT_EVENTS "\noutput: {sample: 0.1 ms}", &scene);
    *rows = (struct rows){.fate = fate, .result = result};
    *result = (struct dea_result){0};
    interrupted = 0;
    struct dea_report silent = {0};
    struct dea_run_options options = {.report = &silent,
                                      .engine = DEA_ENGINE_NGSPICE,
                                      .interrupt = &interrupted,
                                      .time_limit = fate->time_limit,
                                      .directory = fate->directory};
    struct row_sink sink = {.context = rows, .open = count_open, .row = count_row};
    enum dea_status status = run_supervised(&scene, &options, &sink, result, error);
    dea_scene_clear(&scene);
    assert_int_equal(find_child(), 0);
    return status;
}

/* The result speaks of rows that came through, not of later ones. */
static void check_kept(const struct rows *rows, const struct dea_result *result) {
    assert_true(rows->count >= ROWS_BEFORE);
    assert_true(result->signal_count > 0);
    assert_true(result->t_end > 0.0 && result->t_end <= rows->last + SAMPLE);
    assert_string_equal(result->signals[0].name, "x");
    assert_true(result->stats[0].max > result->stats[0].min);
}

/* In order: the last row is where the run ended, and the books are closed there. */
static void test_interrupt(void **state) {
    (void)state;
    struct rows rows;
    struct dea_result result;
    struct dea_error error;
    double started = dea_clock();
    assert_int_equal(run_endless(&(struct fate){.ask = SIGINT}, &rows, &result, &error), DEA_ERR_INTERRUPTED);
    assert_true(dea_clock() - started < 8.0); /* before it would be killed */
    assert_non_null(strstr(error.text, "s: interrupted by SIGINT"));
    check_kept(&rows, &result);
    assert_true(result.t_end >= rows.last && result.t_end < rows.last + SAMPLE);
    assert_true(result.energy.exchanged > 0.0 && result.energy.imbalance < 1e-3);
    assert_true(result.stats_run.circuit_points > 100);
    dea_result_clear(&result);
}

/* The partial result before the crash, how it crashed and how far it had come. */
static void test_crash(void **state) {
    (void)state;
    struct rows rows;
    struct dea_result result;
    struct dea_error error;
    double reached = 0.0;
    const struct fate fate = {.strike = SIGKILL, .with_result = true, .directory = "."};
    assert_int_equal(run_endless(&fate, &rows, &result, &error), DEA_ERR_SOLVER);
    assert_non_null(strstr(error.text, "crashed with SIGKILL"));
    const char *where = strstr(error.text, "at t = ");
    assert_non_null(where);
    assert_int_equal(sscanf(where, "at t = %lf s", &reached), 1);
    assert_true(reached >= rows.last - SAMPLE);
    assert_int_equal(access("log.txt", F_OK), 0);
    check_kept(&rows, &result);
    dea_result_clear(&result);
}

static void test_time_limit(void **state) {
    (void)state;
    struct rows rows;
    struct dea_result result;
    struct dea_error error;
    double started = dea_clock();
    assert_int_equal(run_endless(&(struct fate){.time_limit = 1.2}, &rows, &result, &error), DEA_ERR_SOLVER);
    assert_true(dea_clock() - started > 1.2 && dea_clock() - started < 8.0);
    assert_non_null(strstr(error.text, "the wall time limit was reached after 1."));
    check_kept(&rows, &result);
    dea_result_clear(&result);
}

/* A child that does nothing any more still obeys the clock. */
static void test_hang(void **state) {
    (void)state;
    struct rows rows;
    struct dea_result result;
    struct dea_error error;
    const struct fate fate = {.strike = SIGSTOP, .with_result = true, .time_limit = 1.5};
    double started = dea_clock();
    assert_int_equal(run_endless(&fate, &rows, &result, &error), DEA_ERR_SOLVER);
    assert_true(dea_clock() - started < 8.0);
    assert_non_null(strstr(error.text, "the wall time limit was reached"));
    assert_true(rows.met);
    check_kept(&rows, &result);
    dea_result_clear(&result);
}

/* Who does not take the rows says why, and the child does not go on for nobody. */
static void test_refused_rows(void **state) {
    (void)state;
    struct rows rows;
    struct dea_result result;
    struct dea_error error;
    assert_int_equal(run_endless(&(struct fate){.refuse = true}, &rows, &result, &error), DEA_ERR_OUTPUT);
    assert_string_equal(error.text, "the disk is full");
    assert_int_equal(rows.count, ROWS_BEFORE);
    assert_true(result.signal_count > 0 && result.t_end >= rows.last); /* what was computed is known all the same */
    dea_result_clear(&result);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_interrupt, set_up_folder, tear_down_folder),
        cmocka_unit_test_setup_teardown(test_crash, set_up_folder, tear_down_folder),
        cmocka_unit_test_setup_teardown(test_time_limit, set_up_folder, tear_down_folder),
        cmocka_unit_test_setup_teardown(test_hang, set_up_folder, tear_down_folder),
        cmocka_unit_test_setup_teardown(test_refused_rows, set_up_folder, tear_down_folder),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
