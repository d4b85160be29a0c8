/* Charge windows: rates from charges alone, also beside a corner, and cubics that stand for many points. */
#include "cosim/window.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

static enum dea_status add(struct window *window, double t, double q) {
    return window_add(window, &(struct window_point){.t = t, .q = q});
}

static enum dea_status begin(struct window *window, double t, double q) {
    return window_begin(window, &(struct window_point){.t = t, .q = q});
}

static double wave(double t, double *rate) {
    if (rate != NULL)
        *rate = 2.0 * M_PI * 3.0 * cos(2.0 * M_PI * 3.0 * t);
    return sin(2.0 * M_PI * 3.0 * t);
}

/* Largest error between the points of sin(6 pi t), with steps that vary by half. */
static double interpolate_wave(int count) {
    struct window window = {0};
    double t = 0.0, worst = 0.0;
    assert_int_equal(begin(&window, 0.0, wave(0.0, NULL)), DEA_OK);
    for (int i = 1; i <= count; i++) {
        t = ((double)i + 0.25 * sin(1.7 * i)) / (double)count;
        assert_int_equal(add(&window, t, wave(t, NULL)), DEA_OK);
    }
    for (size_t n = 0; n + 1 < window.count; n++)
        window_find_rates(&window, n);
    for (size_t n = 0; n + 1 < window.count; n++) {
        const struct window_point *a = &window.points[n], *b = a + 1;
        for (int i = 0; i <= 8; i++) {
            double at = a->t + (b->t - a->t) * i / 8.0;
            worst = fmax(worst, fabs(window_value(a, b, at, NULL) - wave(at, NULL)));
        }
    }
    window_clear(&window);
    return worst;
}

static void test_third_order(void **state) {
    (void)state;
    double coarse = interpolate_wave(100), fine = interpolate_wave(400);
    assert_true(coarse < 1e-3);
    assert_true(coarse / fine > 40.0); /* 4^3 = 64 */
}

static void test_cubic_between_points(void **state) {
    (void)state;
    struct window_point a = {.t = 1.0, .q = 2.0, .before = NAN, .after = 3.0};
    struct window_point b = {.t = 1.5, .q = 1.0, .before = -4.0, .after = NAN};
    double rate;
    assert_true(fabs(window_value(&a, &b, 1.0, &rate) - 2.0) < 1e-15 && fabs(rate - 3.0) < 1e-14);
    assert_true(fabs(window_value(&a, &b, 1.5, &rate) - 1.0) < 1e-15 && fabs(rate + 4.0) < 1e-14);
}

/* A source that starts to ramp: long quiet step, corner, short steps. No overshoot into the quiet step. */
static void test_corner_is_not_smeared(void **state) {
    (void)state;
    struct window window = {0};
    const double t[] = {0.0, 1.0, 2.0, 2.001, 2.003, 2.007};
    assert_int_equal(begin(&window, 0.0, 5.0), DEA_OK);
    for (size_t i = 1; i < sizeof t / sizeof t[0]; i++)
        assert_int_equal(add(&window, t[i], 5.0 + 1e3 * fmax(t[i] - 2.0, 0.0)), DEA_OK);
    for (size_t n = 0; n + 1 < window.count; n++)
        window_find_rates(&window, n);
    for (size_t n = 0; n + 1 < window.count; n++)
        for (int i = 0; i <= 8; i++) {
            double at = t[n] + (t[n + 1] - t[n]) * i / 8.0;
            double value = window_value(&window.points[n], &window.points[n + 1], at, NULL);
            assert_true(fabs(value - (5.0 + 1e3 * fmax(at - 2.0, 0.0))) < 1e-9);
        }
    /* on both sides of the corner its own rate */
    assert_true(fabs(window.points[2].before) < 1e-9);
    assert_true(fabs(window.points[2].after - 1e3) < 1e-6);
    window_clear(&window);
}

/* The last interval of a window has no later neighbour, the first one of the next has an earlier one. */
static void test_restart_keeps_a_neighbour(void **state) {
    (void)state;
    struct window window = {0};
    assert_int_equal(begin(&window, 0.0, 0.0), DEA_OK);
    assert_int_equal(add(&window, 0.1, 0.01), DEA_OK);
    assert_int_equal(add(&window, 0.2, 0.04), DEA_OK);
    window_find_rates(&window, 1);
    assert_true(fabs(window.points[2].before - 0.4) < 1e-14); /* t^2 is met exactly */
    window_restart(&window);
    assert_int_equal(window.count, 2);
    assert_int_equal(window.first, 1);
    assert_true(window.points[1].t == 0.2 && window.points[0].t == 0.1);
    assert_int_equal(add(&window, 0.25, 0.0625), DEA_OK);
    window_find_rates(&window, 1);
    assert_true(fabs(window.points[1].after - 0.4) < 1e-14);
    assert_true(fabs(window.points[2].before - 0.5) < 1e-14);
    window_clear(&window);
}

/* Ripple of 50 periods on a slow ramp: one cubic stands for 1000 points, its end charges and mean are exact. */
static void fill_ripple(struct window *window, int count) {
    for (int i = 0; i <= count; i++) {
        double t = (double)i / count, q = 1.0 + 0.1 * t + 0.001 * sin(2.0 * M_PI * 50.0 * t);
        assert_int_equal(i == 0 ? begin(window, t, q) : add(window, t, q), DEA_OK);
    }
    for (size_t n = 0; n + 1 < window->count; n++)
        window_find_rates(window, n);
}

static void test_one_cubic_for_ripple(void **state) {
    (void)state;
    struct window window = {0};
    struct dea_charge_piece piece;
    fill_ripple(&window, 1000);
    size_t last = window.count - 1;
    assert_int_equal(window_fit(&window, 0, last, 1e-4, &piece), last);
    assert_true(fabs(piece.c[0] - 1.0) < 1e-12);
    double end = piece.c[0] + piece.c[1] + piece.c[2] + piece.c[3];
    assert_true(fabs(end - 1.1) < 1e-12);
    double mean = piece.c[0] + piece.c[1] / 2.0 + piece.c[2] / 3.0 + piece.c[3] / 4.0;
    assert_true(fabs(mean - 1.05) < 1e-8);
    /* the same points one by one when that is asked: a piece never strays further in Q^2 s than told */
    assert_true(window_fit(&window, 0, last, 1e-9, &piece) < 10);
    window_clear(&window);
}

static void test_two_points_are_met_exactly(void **state) {
    (void)state;
    struct window window = {0};
    struct dea_charge_piece piece;
    fill_ripple(&window, 1000);
    assert_int_equal(window_fit(&window, 7, 8, 0.0, &piece), 8);
    double h = window.points[8].t - window.points[7].t;
    double end = piece.c[0] + h * (piece.c[1] + h * (piece.c[2] + h * piece.c[3]));
    assert_true(piece.start == window.points[7].t && piece.c[0] == window.points[7].q);
    assert_true(fabs(end - window.points[8].q) < 1e-15);
    window_clear(&window);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_third_order),           cmocka_unit_test(test_cubic_between_points),
        cmocka_unit_test(test_corner_is_not_smeared), cmocka_unit_test(test_restart_keeps_a_neighbour),
        cmocka_unit_test(test_one_cubic_for_ripple),  cmocka_unit_test(test_two_points_are_met_exactly),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
