/* Progress bar and lines, into memory instead of a terminal. */
#include "deasim/report.h"
#include "output_support.h"

#include <math.h>

struct screen {
    struct dea_report report;
    char *text;
    size_t length;
};

static void open_screen(struct screen *screen) {
    *screen = (struct screen){0};
    screen->report.terminal = open_memstream(&screen->text, &screen->length);
    screen->report.progress = true;
    assert_non_null(screen->report.terminal);
    dea_report_begin(&screen->report);
}

static void close_screen(struct screen *screen) {
    fclose(screen->report.terminal);
    free(screen->text);
}

static void bar_shows_percent_time_and_time_left(void **state) {
    (void)state;
    struct screen screen;
    open_screen(&screen);
    /* As if a quarter had taken ten seconds. */
    screen.report.started -= 10.0;
    screen.report.drawn -= 10.0;
    dea_report_progress(&screen.report, 0.1, 0.4);
    assert_string_equal(screen.text, "\r[======>                 ]  25 %  100 ms of 400 ms, 30 s left");
    close_screen(&screen);
}

static void bar_is_drawn_ten_times_a_second_at_most(void **state) {
    (void)state;
    struct screen screen;
    open_screen(&screen);
    screen.report.drawn -= 1.0;
    double end = dea_clock() + 0.35;
    for (double now; (now = dea_clock()) < end;)
        dea_report_progress(&screen.report, 0.2 + 1e-3 * now, 4000.0);
    fflush(screen.report.terminal);
    int bars = 0;
    for (const char *c = screen.text; (c = strchr(c, '[')) != NULL; c++)
        bars++;
    assert_in_range(bars, 2, 4);
    close_screen(&screen);
}

static void warning_and_end_wipe_the_bar(void **state) {
    (void)state;
    struct screen screen;
    open_screen(&screen);
    screen.report.drawn -= 1.0;
    dea_report_progress(&screen.report, 4.0, 4.0);
    size_t width = strlen(screen.text) - 1;
    assert_int_equal(screen.report.bar_width, width);
    dea_report_warn(&screen.report, "slack in %s", "left");
    char expected[256];
    snprintf(expected, sizeof expected, "\r%*s\rwarning: slack in left\n", (int)width, "");
    assert_string_equal(screen.text + width + 1, expected);
    assert_int_equal(screen.report.bar_width, 0);
    size_t before = screen.length;
    dea_report_end(&screen.report); /* nothing left to wipe */
    fflush(screen.report.terminal);
    assert_int_equal(screen.length, before);
    close_screen(&screen);
}

static void odd_times_draw_nothing_wrong(void **state) {
    (void)state;
    struct screen screen;
    open_screen(&screen);
    static const double times[][2] = {{0, 1}, {1, 0}, {0, 0}, {-1, 1}, {NAN, 1}};
    for (size_t i = 0; i < sizeof times / sizeof times[0]; i++) {
        screen.report.drawn -= 1.0;
        dea_report_progress(&screen.report, times[i][0], times[i][1]);
    }
    fflush(screen.report.terminal);
    assert_null(strstr(screen.text, "nan"));
    screen.report.drawn -= 1.0;
    dea_report_progress(&screen.report, 2, 1); /* beyond the end stays a full bar */
    assert_non_null(strstr(screen.text, "[========================] 100 %"));
    close_screen(&screen);
}

static void details_go_to_the_log(void **state) {
    (void)state;
    struct screen screen;
    open_screen(&screen);
    char *log = NULL;
    size_t length = 0;
    screen.report.log = open_memstream(&log, &length);
    dea_report_detail(&screen.report, "step %d", 7);
    dea_report_warn(&screen.report, "careful");
    assert_string_equal(log, "step 7\nwarning: careful\n");
    fflush(screen.report.terminal);
    assert_string_equal(screen.text, "warning: careful\n");
    screen.report.verbose = true;
    dea_report_detail(&screen.report, "step %d", 8);
    assert_string_equal(screen.text, "warning: careful\nstep 8\n");
    fclose(screen.report.log);
    free(log);
    close_screen(&screen);
}

static void zeroed_report_is_silent(void **state) {
    (void)state;
    struct dea_report report = {0};
    dea_report_begin(&report);
    dea_report_progress(&report, 1, 2);
    dea_report_warn(&report, "nobody reads this");
    dea_report_detail(&report, "nor this");
    dea_report_end(&report);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(bar_shows_percent_time_and_time_left),
        cmocka_unit_test(bar_is_drawn_ten_times_a_second_at_most),
        cmocka_unit_test(warning_and_end_wipe_the_bar),
        cmocka_unit_test(odd_times_draw_nothing_wrong),
        cmocka_unit_test(details_go_to_the_log),
        cmocka_unit_test(zeroed_report_is_silent),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
