/* Waveforms: exact corners, SPICE meaning, and pieces that always move on. */
#include "deasim/waveform.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static const double pi = 3.14159265358979323846;

#define assert_equal(actual, expected) assert_true_message((actual), (expected), #actual, __LINE__)

static void assert_true_message(double actual, double expected, const char *what, int line) {
    if (!(actual == expected))
        fail_msg("line %d: %s is %.17g, not %.17g", line, what, actual, expected);
}

static void assert_close(double actual, double expected, double tolerance) {
    if (!(fabs(actual - expected) <= tolerance))
        fail_msg("%.17g is not %.17g within %g", actual, expected, tolerance);
}

static struct dea_waveform paper_pulse(void) {
    return (struct dea_waveform){.kind = DEA_WAVE_PULSE,
                                 .high = 3300,
                                 .delay = 1e-3,
                                 .rise = 100e-6,
                                 .fall = 100e-6,
                                 .width = 58.9e-3,
                                 .period = 1};
}

static void check_passes(const struct dea_waveform *waveform) {
    struct dea_error error;
    if (dea_waveform_check(waveform, &error) != DEA_OK)
        fail_msg("%s", error.text);
}

static void check_refuses(const struct dea_waveform *waveform, const char *text) {
    struct dea_error error;
    assert_int_equal(dea_waveform_check(waveform, &error), DEA_ERR_INPUT);
    assert_string_equal(error.text, text);
}

/* ---- pulses ---- */

static void test_pulse_corners(void **state) {
    (void)state;
    struct dea_waveform w = paper_pulse();
    check_passes(&w);
    const double ends[] = {1e-3, 1.1e-3, 60e-3, 60.1e-3, 1.001, 1.0011};
    const double slopes[] = {0, 3.3e7, 0, -3.3e7, 0, 3.3e7};
    double t = 0;
    for (size_t i = 0; i < sizeof ends / sizeof ends[0]; i++) {
        struct dea_piece piece;
        dea_waveform_piece(&w, t, &piece);
        assert_equal(piece.start, t);
        assert_close(piece.end, ends[i], 1e-15);
        assert_close(piece.slope, slopes[i], 1e-2);
        t = piece.end;
    }
    assert_equal(dea_waveform_value(&w, 0), 0);
    assert_close(dea_waveform_value(&w, 1.05e-3), 1650, 1e-9);
    assert_equal(dea_waveform_value(&w, 30e-3), 3300);
    assert_equal(dea_waveform_value(&w, 0.5), 0);
    assert_equal(dea_waveform_value(&w, 12345.030), 3300);
    assert_equal(dea_waveform_value(&w, 12345.5), 0);
}

static void test_single_pulse_and_step(void **state) {
    (void)state;
    struct dea_waveform w = paper_pulse();
    struct dea_piece piece;
    w.period = 0;
    check_passes(&w);
    dea_waveform_piece(&w, 61e-3, &piece);
    assert_true(isinf(piece.end));
    assert_equal(dea_waveform_value(&w, 1.03), 0);

    w.width = INFINITY;
    check_passes(&w);
    dea_waveform_piece(&w, 2e-3, &piece);
    assert_true(isinf(piece.end));
    assert_equal(dea_piece_value(&piece, 1e6, NULL), 3300);
    w.period = 1;
    check_refuses(&w, "pulse: width is inf s; a time from 0 to 1e+15 s is needed");
}

static void test_jumps(void **state) {
    (void)state;
    struct dea_waveform w = {.kind = DEA_WAVE_PULSE, .low = -5, .high = 7, .delay = 0.25, .width = 0.5, .period = 1};
    struct dea_piece before, after;
    check_passes(&w);
    dea_waveform_piece(&w, 0.1, &before);
    assert_equal(before.end, 0.25);
    assert_equal(dea_piece_value(&before, before.end, NULL), -5);
    dea_waveform_piece(&w, before.end, &after);
    assert_equal(after.start, 0.25);
    assert_equal(after.end, 0.75);
    assert_equal(dea_piece_value(&after, after.start, NULL), 7);
    assert_equal(dea_waveform_value(&w, nextafter(0.75, 0)), 7);
    assert_equal(dea_waveform_value(&w, 0.75), -5);
    assert_equal(dea_waveform_value(&w, 1.25), 7);
    dea_waveform_piece(&w, 0.75, &after);
    assert_equal(after.end, 1.25);
}

/* 0.1 + 0.2 + 0.3 > 0.6 in doubles: the period is full all the same and leaves no sliver. */
static void test_full_period(void **state) {
    (void)state;
    struct dea_waveform w = {
        .kind = DEA_WAVE_PULSE, .high = 1, .rise = 0.1, .width = 0.2, .fall = 0.3, .period = 0.6, .delay = 0.7};
    check_passes(&w);
    double t = 0.7;
    for (int i = 0; i < 3000; i++) {
        struct dea_piece piece;
        dea_waveform_piece(&w, t, &piece);
        assert_equal(piece.start, t);
        double length = piece.end - piece.start;
        assert_close(length, 0.1 * (1 + i % 3), 1e-12);
        t = piece.end;
    }
    assert_close(t, 0.7 + 1000 * 0.6, 1e-12);
}

static void test_trapezoid(void **state) {
    (void)state;
    struct dea_waveform w = {.kind = DEA_WAVE_TRAPEZOID,
                             .low = 100,
                             .high = 300,
                             .delay = 1,
                             .rise = 1,
                             .width = 2,
                             .fall = 4,
                             .gap = 3,
                             .repeat = true};
    check_passes(&w);
    assert_equal(dea_waveform_value(&w, 0.5), 100);
    assert_equal(dea_waveform_value(&w, 1.5), 200);
    assert_equal(dea_waveform_value(&w, 3), 300);
    assert_equal(dea_waveform_value(&w, 6), 200);
    assert_equal(dea_waveform_value(&w, 9), 100);
    assert_equal(dea_waveform_value(&w, 11.5), 200);
    assert_equal(dea_waveform_value(&w, 1e6 + 1.5), 200);
    assert_equal(dea_waveform_peak(&w), 300);
    w.repeat = false;
    w.gap = NAN;
    check_passes(&w);
    assert_equal(dea_waveform_value(&w, 11.5), 100);
    w.repeat = true;
    check_refuses(&w, "trapezoid: gap is nan s; a time from 0 to 1e+15 s is needed");
}

/* ---- sine and chirp ---- */

static void test_sine(void **state) {
    (void)state;
    struct dea_waveform w = {.kind = DEA_WAVE_SINE,
                             .offset = 1000,
                             .amplitude = -500,
                             .frequency = 2,
                             .delay = 0.25,
                             .phase = pi / 6,
                             .decay = 0.5};
    struct dea_piece piece;
    check_passes(&w);
    assert_close(dea_waveform_value(&w, 0), 750, 1e-10);
    dea_waveform_piece(&w, 0, &piece);
    assert_equal(piece.end, 0.25);
    dea_waveform_piece(&w, 0.25, &piece);
    assert_true(isinf(piece.end));
    assert_close(dea_waveform_value(&w, 0.25), 750, 1e-10);
    double rate, t = 1.375, tau = t - 0.25;
    double expected = 1000 - 500 * exp(-0.5 * tau) * sin(pi / 6 + 4 * pi * tau);
    assert_close(dea_piece_value(&piece, t, &rate), expected, 1e-10);
    double h = 1e-5;
    assert_close(rate, (dea_piece_value(&piece, t + h, NULL) - dea_piece_value(&piece, t - h, NULL)) / (2 * h), 1e-4);
    assert_equal(dea_waveform_peak(&w), 1500);
}

static void test_chirp(void **state) {
    (void)state;
    struct dea_waveform w = {.kind = DEA_WAVE_CHIRP,
                             .offset = 2,
                             .amplitude = 3,
                             .frequency = 10,
                             .frequency_end = 250,
                             .duration = 1.7,
                             .delay = 0.3,
                             .phase = 0.4};
    struct dea_piece before, sweep, held;
    check_passes(&w);
    dea_waveform_piece(&w, 0, &before);
    assert_close(before.value, 2 + 3 * sin(0.4), 1e-14);
    dea_waveform_piece(&w, before.end, &sweep);
    assert_equal(sweep.start, 0.3);
    assert_equal(sweep.end, 0.3 + 1.7);
    dea_waveform_piece(&w, sweep.end, &held);
    assert_equal(held.start, sweep.end);
    assert_true(isinf(held.end));

    /* value and frequency run on across the end: phase = 2 pi (f0 D + (f1 - f0) D / 2) = 2 pi 221 */
    double rate_before, rate_after;
    assert_equal(dea_piece_value(&sweep, sweep.end, &rate_before), dea_piece_value(&held, sweep.end, &rate_after));
    assert_close(rate_before, rate_after, 1e-8);
    assert_close(dea_piece_value(&held, held.start, NULL), 2 + 3 * sin(0.4), 1e-10);
    assert_close(dea_waveform_value(&w, 2.0 + 1.0 / 500), 2 + 3 * sin(0.4 + pi), 1e-9);
    double tau = 0.5;
    assert_close(dea_waveform_value(&w, 0.8), 2 + 3 * sin(0.4 + 2 * pi * (10 * tau + 240 * tau * tau / 3.4)), 1e-10);
    assert_equal(dea_waveform_peak(&w), 5);
}

/* ---- points ---- */

static void test_points(void **state) {
    (void)state;
    double times[] = {1, 2, 2, 4}, values[] = {10, 20, -60, 40};
    struct dea_waveform w = {.kind = DEA_WAVE_PWL, .times = times, .values = values, .point_count = 4};
    struct dea_piece piece;
    check_passes(&w);
    assert_equal(dea_waveform_value(&w, 0), 10);
    dea_waveform_piece(&w, 0, &piece);
    assert_equal(piece.end, 1);
    dea_waveform_piece(&w, 1, &piece);
    assert_equal(piece.end, 2);
    assert_equal(dea_piece_value(&piece, 2, NULL), 20);
    assert_equal(dea_waveform_value(&w, 2), -60);
    assert_equal(dea_waveform_value(&w, 3), -10);
    assert_equal(dea_waveform_value(&w, 4), 40);
    assert_equal(dea_waveform_value(&w, 1e9), 40);
    assert_equal(dea_waveform_peak(&w), 60);

    /* repeated: period 3, the end jumps back to the first value */
    w.repeat = true;
    check_passes(&w);
    dea_waveform_piece(&w, 3.5, &piece);
    assert_equal(piece.end, 4);
    assert_equal(dea_piece_value(&piece, 4, NULL), 40);
    assert_equal(dea_waveform_value(&w, 4), 10);
    assert_equal(dea_waveform_value(&w, 4.5), 15);
    assert_equal(dea_waveform_value(&w, 6), -10);
    assert_equal(dea_waveform_value(&w, 3e6 + 3), -10);
}

static void test_one_point_is_a_level(void **state) {
    (void)state;
    double times[] = {1}, values[] = {10};
    struct dea_waveform w = {.kind = DEA_WAVE_PWL, .times = times, .values = values, .point_count = 1};
    check_passes(&w);
    assert_equal(dea_waveform_value(&w, 0), 10);
    assert_equal(dea_waveform_value(&w, 2), 10);
    w.repeat = true;
    check_refuses(&w, "pwl: to repeat, its last point must be later than its first");
}

/* ---- properties over many random waveforms ---- */

static double random_unit(uint64_t *seed) {
    *seed ^= *seed << 13;
    *seed ^= *seed >> 7;
    *seed ^= *seed << 17;
    return (double)(*seed >> 11) * 0x1p-53;
}

/* A time from 1 ns to 10 s, log-uniform, sometimes 0 and sometimes a round number. */
static double random_time(uint64_t *seed) {
    double choice = random_unit(seed), value = pow(10, -9 + 10 * random_unit(seed));
    if (choice < 0.2)
        return 0;
    return choice < 0.5 ? pow(10, floor(log10(value))) : value;
}

static struct dea_waveform random_waveform(uint64_t *seed, double times[8], double values[8]) {
    struct dea_waveform w = {.low = -100 * random_unit(seed), .high = 1000 * random_unit(seed)};
    double choice = random_unit(seed);
    w.delay = random_time(seed);
    w.rise = random_time(seed);
    w.width = random_time(seed) + 1e-9;
    w.fall = random_time(seed);
    w.repeat = true;
    if (choice < 0.4) {
        w.kind = DEA_WAVE_PULSE;
        w.period = w.rise + w.width + w.fall + random_time(seed);
    } else if (choice < 0.7) {
        w.kind = DEA_WAVE_TRAPEZOID;
        w.gap = random_time(seed);
    } else {
        w.kind = DEA_WAVE_PWL;
        w.times = times;
        w.values = values;
        w.point_count = 3 + (size_t)(5 * random_unit(seed));
        times[0] = w.delay;
        for (size_t i = 0; i < w.point_count; i++) {
            values[i] = 100 * random_unit(seed) - 50;
            if (i > 0)
                times[i] = times[i - 1] + random_time(seed);
            if (i > 1 && times[i] == times[i - 2])
                times[i] += 1e-6;
        }
        if (times[w.point_count - 1] == times[0])
            times[w.point_count - 1] += 1e-3;
    }
    return w;
}

/* Follows `pieces` pieces from t: each starts where the last ended, ends later, is finite and joins its neighbours. */
static void follow_pieces(const struct dea_waveform *w, double t, int pieces) {
    double peak = dea_waveform_peak(w);
    for (int i = 0; i < pieces; i++) {
        struct dea_piece piece, again;
        dea_waveform_piece(w, t, &piece);
        if (i > 0)
            assert_equal(piece.start, t);
        assert_true(piece.start <= t && piece.end > t && isfinite(piece.end));
        double middle = piece.start + (piece.end - piece.start) / 2;
        dea_waveform_piece(w, nextafter(piece.end, 0), &again);
        assert_equal(again.start, piece.start);
        assert_equal(again.end, piece.end);
        dea_waveform_piece(w, middle, &again);
        assert_true(middle == piece.end || again.start == piece.start);
        double left = dea_piece_value(&piece, piece.end, NULL);
        assert_true(fabs(left) <= peak * (1 + 1e-12) && fabs(piece.value) <= peak);
        t = piece.end;
    }
}

static void test_pieces_move_on(void **state) {
    (void)state;
    uint64_t seed = 0x9e3779b97f4a7c15;
    for (int i = 0; i < 2000; i++) {
        double times[8], values[8];
        struct dea_waveform w = random_waveform(&seed, times, values);
        check_passes(&w);
        double period = w.kind == DEA_WAVE_PULSE       ? w.period
                        : w.kind == DEA_WAVE_TRAPEZOID ? w.rise + w.width + w.fall + w.gap
                                                       : times[w.point_count - 1] - times[0];
        follow_pieces(&w, 0, 200);
        follow_pieces(&w, w.delay + 1e5 * period, 200);
        follow_pieces(&w, w.delay + period * floor(1e9 * random_unit(&seed)), 50);
    }
}

/* 1e5 periods walked piece by piece: the count of corners is exact and the time has not drifted. */
static void test_long_walk(void **state) {
    (void)state;
    uint64_t seed = 7;
    for (int i = 0; i < 40; i++) {
        struct dea_waveform w = {.kind = DEA_WAVE_PULSE, .high = 1, .delay = random_unit(&seed)};
        w.rise = 1e-3 * random_unit(&seed);
        w.width = 1e-3 * random_unit(&seed);
        w.fall = 1e-3 * random_unit(&seed);
        w.period = w.rise + w.width + w.fall + (1e-6 + 1e-3 * random_unit(&seed));
        check_passes(&w);
        double t = w.delay;
        for (int corner = 0; corner < 400000; corner++) {
            struct dea_piece piece;
            dea_waveform_piece(&w, t, &piece);
            if (piece.start != t || !(piece.end > t))
                fail_msg("walk %d, corner %d: from %.17g to %.17g at %.17g", i, corner, piece.start, piece.end, t);
            t = piece.end;
        }
        assert_equal(t, w.delay + 1e5 * w.period);
    }
}

/* Where a double cannot resolve the period any more, the value stays a number and nothing hangs. */
static void test_far_times(void **state) {
    (void)state;
    struct dea_waveform w = paper_pulse();
    const double far[] = {1e12, 1e15, 1e16, 1e18, 1e300};
    for (size_t i = 0; i < sizeof far / sizeof far[0]; i++) {
        struct dea_piece piece;
        dea_waveform_piece(&w, far[i], &piece);
        assert_true(piece.start <= far[i] && piece.end > far[i]);
        assert_true(isfinite(dea_waveform_value(&w, far[i])));
    }
}

/* ---- refusals ---- */

static void test_check_messages(void **state) {
    (void)state;
    struct dea_waveform w = {.kind = DEA_WAVE_DC, .level = NAN};
    check_refuses(&w, "dc: level is nan; a finite number up to 1e+30 is needed");
    w = paper_pulse();
    w.high = INFINITY;
    check_refuses(&w, "pulse: high is inf; a finite number up to 1e+30 is needed");
    w = paper_pulse();
    w.delay = -1e-3;
    check_refuses(&w, "pulse: delay is -0.001 s; a time from 0 to 1e+15 s is needed");
    w = paper_pulse();
    w.rise = 1e-18;
    check_refuses(&w, "pulse: rise is 1e-18 s; the shortest time apart from 0 is 1 fs");
    w = paper_pulse();
    w.period = 0.05;
    check_refuses(&w, "pulse: period 0.05 s is shorter than rise + width + fall = 0.0591 s");
    w = (struct dea_waveform){.kind = DEA_WAVE_PULSE, .high = 1};
    check_refuses(&w, "pulse: rise, width and fall are all 0, so it never leaves low");
    w = (struct dea_waveform){.kind = DEA_WAVE_SINE, .amplitude = 1};
    check_refuses(&w, "sine: frequency is 0; a frequency above 0 Hz is needed");
    w.frequency = -1;
    check_refuses(&w, "sine: frequency is -1 Hz; a number from 0 to 1e+15 Hz is needed");
    w.frequency = 1;
    w.decay = -1;
    check_refuses(&w, "sine: decay is -1 1/s; a number from 0 to 1e+15 1/s is needed");
    w = (struct dea_waveform){.kind = DEA_WAVE_CHIRP, .amplitude = 1, .frequency = 1, .frequency_end = 2};
    check_refuses(&w, "chirp: duration is 0; a time above 0 s is needed");
    w.duration = 1;
    w.frequency = w.frequency_end = 0;
    check_refuses(&w, "chirp: frequency and frequency_end are both 0");
}

static void test_check_points(void **state) {
    (void)state;
    double times[] = {0, 1, 2, 3}, values[] = {0, 1, 2, 3};
    struct dea_waveform w = {.kind = DEA_WAVE_PWL};
    check_refuses(&w, "pwl: it has no points");
    w.times = times;
    w.values = values;
    w.point_count = 4;
    check_passes(&w);
    times[2] = 0.5;
    check_refuses(&w, "pwl: time of point 3, 0.5 s, goes back behind 1 s");
    times[2] = times[3] = 1;
    check_refuses(&w, "pwl: points 2, 3 and 4 have the same time 1 s; two make a jump");
    times[2] = nextafter(1, 2);
    check_refuses(&w, "pwl: points 2 and 3 are less than 1 fs apart");
    times[2] = NAN;
    check_refuses(&w, "pwl: time of point 3 is nan s; a time from 0 to 1e+15 s is needed");
    times[2] = 2;
    values[1] = NAN;
    check_refuses(&w, "pwl: value of point 2 is nan; a finite number up to 1e+30 is needed");
}

static void test_periods(void **state) {
    (void)state;
    double times[] = {1, 3}, values[] = {0, 5};
    struct dea_waveform pulse = {.kind = DEA_WAVE_PULSE, .high = 1, .width = 1, .delay = 2, .period = 4};
    assert_equal(dea_waveform_periods(&pulse, 10), 2);
    assert_equal(dea_waveform_periods(&pulse, 1), 0);
    pulse.period = 0;
    assert_equal(dea_waveform_periods(&pulse, 10), 0);
    struct dea_waveform trapezoid = {.kind = DEA_WAVE_TRAPEZOID, .rise = 1, .width = 2, .fall = 1, .gap = 4};
    assert_equal(dea_waveform_periods(&trapezoid, 16), 0);
    trapezoid.repeat = true;
    assert_equal(dea_waveform_periods(&trapezoid, 16), 2);
    struct dea_waveform points = {.kind = DEA_WAVE_PWL, .times = times, .values = values, .point_count = 2};
    assert_equal(dea_waveform_periods(&points, 9), 0);
    points.repeat = true;
    assert_equal(dea_waveform_periods(&points, 9), 4);
    struct dea_waveform sine = {.kind = DEA_WAVE_SINE, .frequency = 50, .delay = 1};
    assert_equal(dea_waveform_periods(&sine, 2), 50);
    struct dea_waveform chirp = {.kind = DEA_WAVE_CHIRP, .frequency = 50, .frequency_end = 5, .duration = 1};
    assert_equal(dea_waveform_periods(&chirp, 2), 100);
    struct dea_waveform dc = {.kind = DEA_WAVE_DC};
    assert_equal(dea_waveform_periods(&dc, 1e8), 0);
}

static void test_clear(void **state) {
    (void)state;
    struct dea_waveform w = {.kind = DEA_WAVE_PWL, .times = malloc(8), .values = malloc(8), .point_count = 1};
    dea_waveform_clear(&w);
    assert_null(w.times);
    assert_equal(dea_waveform_value(&w, 1), 0);
    dea_waveform_clear(&w);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_pulse_corners),  cmocka_unit_test(test_single_pulse_and_step),
        cmocka_unit_test(test_jumps),          cmocka_unit_test(test_full_period),
        cmocka_unit_test(test_trapezoid),      cmocka_unit_test(test_sine),
        cmocka_unit_test(test_chirp),          cmocka_unit_test(test_points),
        cmocka_unit_test(test_pieces_move_on), cmocka_unit_test(test_one_point_is_a_level),
        cmocka_unit_test(test_long_walk),      cmocka_unit_test(test_far_times),
        cmocka_unit_test(test_check_messages), cmocka_unit_test(test_check_points),
        cmocka_unit_test(test_periods),        cmocka_unit_test(test_clear),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
