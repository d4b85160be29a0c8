/* .measure lines followed step by step: right on signals whose values are known, and left alone where only ngspice
 * knows what is meant. That they agree with ngspice on circuits is tests/cli/test_linear.sh. */
#include "circuit/measures.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

enum { SIGNALS = 4, MAX_LINES = 40 };

#define STEP 0.05 /* s; the sine below is followed to 2e-7 */
#define CLOSE 1e-6

static const char *const names[SIGNALS] = {"a", "ramp", "v1#branch", "held"};

/* A sine, a ramp through 0.5 s, its double as a current, and a ramp that rests at 1 from 1 s on. */
static void fill_row(double t, double row[SIGNALS]) {
    row[0] = sin(2.0 * M_PI * t);
    row[1] = t - 0.5;
    row[2] = 2.0 * (t - 0.5);
    row[3] = fmin(t, 1.0);
}

/* Two seconds in steps; the sine is moved by `jump` from 1 s on. */
static void follow(struct dea_measures *measures, double jump) {
    for (int step = 0; step < 40; step++) {
        double rows[DEA_MEASURE_ROWS][SIGNALS], from = step * STEP, to = (step + 1) * STEP;
        for (int i = 0; i < DEA_MEASURE_ROWS; i++) {
            fill_row(from + (to - from) * i / (DEA_MEASURE_ROWS - 1), rows[i]);
            rows[i][0] += step >= 20 ? jump : 0.0;
        }
        dea_measures_follow(measures, from, to, &rows[0][0]);
    }
}

static struct dea_measures *read_lines(char *const *lines, int count) {
    struct dea_netlist_line all[MAX_LINES + 1] = {{.text = NULL}};
    for (int i = 0; i < count; i++)
        all[i + 1] = (struct dea_netlist_line){.text = lines[i], .passed = true};
    const struct dea_netlist netlist = {.lines = all, .line_count = count + 1, .measure_count = count};
    struct dea_measures *measures;
    struct dea_error error;
    assert_int_equal(dea_measures_read(&netlist, names, SIGNALS, &measures, &error), DEA_OK);
    return measures;
}

/* Value of one line; NAN: failed. */
static double measure(const char *what, double jump) {
    char text[256], *line = text;
    snprintf(text, sizeof text, ".measure tran m %s", what);
    struct dea_measures *measures = read_lines(&line, 1);
    if (measures == NULL)
        fail_msg("not understood: %s", text);
    follow(measures, jump);
    int count;
    const struct dea_engine_measure *result = dea_measures_results(measures, &count);
    assert_int_equal(count, 1);
    assert_string_equal(result->name, "m");
    double value = result->failed ? NAN : result->value;
    dea_measures_destroy(measures);
    return value;
}

static void assert_measures(const char *what, double expected) {
    double value = measure(what, 0.0);
    if (!(fabs(value - expected) < CLOSE))
        fail_msg("%s is %.9g, not %.9g", what, value, expected);
}

static void test_extremes(void **state) {
    (void)state;
    assert_measures("MAX v(a)", 1.0);
    assert_measures("min v(a) from=0 to=1", -1.0);
    assert_measures("PP V(A)", 2.0);
    assert_measures("max_at v(a) to=0.7", 0.25);
    assert_measures("min_at v(a) from=1.1", 1.75);
    /* windows that end within steps, without an extreme inside */
    assert_measures("max v(a) from=0.011 to=0.187", sin(2.0 * M_PI * 0.187));
    assert_measures("min v(a) from=0.011 to=0.187", sin(2.0 * M_PI * 0.011));
    assert_measures("max i(V1)", 3.0);
    assert_measures("max par('-i(v1)')", 1.0);
}

static void test_integrals(void **state) {
    (void)state;
    assert_measures("avg v(a) from=0 to=0.5", 2.0 / M_PI);
    assert_measures("avg v(a) from=0.013 to=0.487",
                    (cos(2.0 * M_PI * 0.013) - cos(2.0 * M_PI * 0.487)) / (2.0 * M_PI * 0.474));
    assert_measures("rms v(a) from=0.3 to=1.3", sqrt(0.5));
    assert_measures("integ v(ramp)", 1.0);
    assert_measures("integ par('v(a)*v(a)') from=0.1 to=1.1", 0.5);
    assert_measures("avg v(ramp) from = 0.5 to = 1", 0.25);
    assert_measures("integ v(ramp) from=1.5 to=90", 0.625); /* a window that the run ends in */
}

static void test_moments(void **state) {
    (void)state;
    assert_measures("when v(a)=0.5", 1.0 / 12.0);
    assert_measures("when v(a)=0.5 fall=1", 5.0 / 12.0);
    assert_measures("when v(a)=0.5 cross=3", 13.0 / 12.0);
    assert_measures("when v(a)=0.5 cross=last", 17.0 / 12.0);
    assert_measures("when v(a)=0.5 rise=last", 13.0 / 12.0);
    assert_measures("when v(a)=0.5 td=0.3", 5.0 / 12.0);
    assert_measures("when v(a)=-500m rise=1 from=1", 23.0 / 12.0);
    assert_measures("when v(ramp)=v(held)", 1.5);
    assert_measures("trig v(a) val=0.5 rise=1 targ v(a) val=0.5 fall=2", 16.0 / 12.0);
    assert_measures("trig v(a) val=0 fall=1 targ v(a) val=0 rise=1", 0.5);
    assert_measures("trig at=0.2 targ v(a) val=0.5 fall=1", 5.0 / 12.0 - 0.2);
    assert_measures("trig v(a) val=0.5 fall=1 td=1 targ at=2", 2.0 - 17.0 / 12.0);
    assert_measures("trig v(a) val = 0.5 rise = 1 targ v(a) val=0.5 cross=4", 16.0 / 12.0);
}

static void test_values(void **state) {
    (void)state;
    assert_measures("find v(a) at=0.333", sin(2.0 * M_PI * 0.333));
    assert_measures("find v(a) at=2", 0.0);
    assert_measures("find v(ramp) when v(a)=0.5 fall=2", 17.0 / 12.0 - 0.5);
    assert_measures("find par('v(ramp)+i(v1)/2') at=1", 1.0);
}

/* A signal that comes to rest at the level passes it once. */
static void test_rest_at_the_level(void **state) {
    (void)state;
    assert_measures("when v(held)=1 rise=1", 1.0);
    assert_measures("when v(held)=1 cross=last", 1.0);
    assert_true(isnan(measure("when v(held)=1 fall=1", 0.0)));
    assert_true(isnan(measure("when v(held)=1 cross=2", 0.0)));
}

static void test_failures(void **state) {
    (void)state;
    static const char *const failing[] = {"when v(a)=2",
                                          "when v(a)=0.5 rise=3",
                                          "avg v(a) from=5",
                                          "max v(a) from=5",
                                          "integ v(a) from=5 to=6",
                                          "find v(a) at=3",
                                          "find v(a) when v(ramp)=7",
                                          "trig v(a) val=0.5 rise=1 targ v(a) val=2 rise=1",
                                          "max par('1/(v(ramp)-v(ramp))')"};
    for (size_t i = 0; i < sizeof failing / sizeof failing[0]; i++)
        if (!isnan(measure(failing[i], 0.0)))
            fail_msg("%s did not fail", failing[i]);
}

/* Both sides of a jump count, and it passes what lies in between. */
static void test_jump(void **state) {
    (void)state;
    assert_float_equal(measure("max v(a) from=1 to=1.05", 5.0), 5.0 + sin(0.1 * M_PI), CLOSE);
    assert_float_equal(measure("min v(a) from=0.95 to=1", 5.0), -sin(0.1 * M_PI), CLOSE);
    assert_float_equal(measure("when v(a)=3", 5.0), 1.0, CLOSE);
    assert_float_equal(measure("integ v(a)", 5.0), 5.0, CLOSE);
}

static void test_left_to_ngspice(void **state) {
    (void)state;
    static const char *const lines[] = {
        ".measure tran m max v(b)",                               /* not there */
        ".measure tran m max v(a,ramp)",                          /* fails in ngspice */
        ".measure tran m max v(0)",                               /* ground */
        ".measure tran m max a",                                  /* a vector by its name */
        ".measure tran m max v(a) td=1m",                         /* ignored by ngspice */
        ".measure tran m max v(a) from={x}",                      /* a parameter */
        ".measure tran m max v(a) to=-1",                         /* before the start */
        ".measure tran m max par('sqrt(v(a))')",                  /* a function */
        ".measure tran m max par('v(a)^2')",                      /* a power */
        ".measure tran m max par('v(a)') + 1",                    /* more behind it */
        ".measure tran m max par('(v(a)')",                       /* brackets that do not match */
        ".measure tran m trig v(a) val=1 targ v(a) val=1 rise=1", /* which edge? */
        ".measure tran m trig v(a) rise=1 targ v(a) val=1 rise=1",
        ".measure tran m trig v(a) val=1 rise=1",
        ".measure tran m when v(a)=1 rise=0",
        ".measure tran m when v(a)=1 rise=1.5",
        ".measure tran m when v(a)",
        ".measure tran m find v(a)",
        ".measure tran m find v(a) at=1 from=0",
        ".measure tran m deriv v(a) at=1",
        ".measure tran m param='1+1'",
        ".measure dc m max v(a)",
        ".measure tran m max",
        ".measure tran m",
    };
    for (size_t i = 0; i < sizeof lines / sizeof lines[0]; i++) {
        char first[] = ".measure tran good max v(a)", text[256], *both[] = {first, text};
        snprintf(text, sizeof text, "%s", lines[i]);
        struct dea_measures *measures = read_lines(both, 2);
        if (measures != NULL)
            fail_msg("understood: %s", lines[i]);
    }
}

static void test_order(void **state) {
    (void)state;
    char one[] = ".meas tran Zebra max v(ramp)", two[] = ".MEASURE TRAN apple min v(ramp)", *lines[] = {one, two};
    struct dea_measures *measures = read_lines(lines, 2);
    assert_non_null(measures);
    follow(measures, 0.0);
    int count;
    const struct dea_engine_measure *results = dea_measures_results(measures, &count);
    assert_int_equal(count, 2);
    assert_string_equal(results[0].name, "zebra");
    assert_float_equal(results[0].value, 1.5, CLOSE);
    assert_string_equal(results[1].name, "apple");
    assert_float_equal(results[1].value, -0.5, CLOSE);
    dea_measures_destroy(measures);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_extremes), cmocka_unit_test(test_integrals),         cmocka_unit_test(test_moments),
        cmocka_unit_test(test_values),   cmocka_unit_test(test_rest_at_the_level), cmocka_unit_test(test_failures),
        cmocka_unit_test(test_jump),     cmocka_unit_test(test_left_to_ngspice),   cmocka_unit_test(test_order)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
