/* Arithmetic worked out without ngspice. */
#include "circuit/expression.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

static const char *const row_texts[] = {"a", "n1", "v1#branch"};
static const struct row_names row_names = {row_texts, 3};
static const double row[] = {2.0, 5.0, -0.25};

static void test_values(void **state) {
    (void)state;
    static const struct {
        const char *text;
        double value;
    } cases[] = {
        {"v(a)", 2.0},           {"i(v1)", -0.25},       {" v( a ) + v(n1) ", 7.0}, {"-v(a)*v(n1)", -10.0},
        {"v(n1)-v(a)-1", 2.0},   {"v(n1)/v(a)/2", 1.25}, {"2*(v(a)+1)", 6.0},       {"--v(a)", 2.0},
        {"+v(a)*-1", -2.0},      {"1e-3*v(a)", 2e-3},    {"1meg+v(a)", 1000002},    {"1.5k", 1500.0},
        {"v(a)-1e+2*3", -298.0}, {".5u*v(a)", 1e-6},     {"1-2-3", -4.0},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct expression expression;
        if (!expression_read(&expression, cases[i].text, &row_names))
            fail_msg("not understood: %s", cases[i].text);
        assert_float_equal(expression_evaluate(&expression, row), cases[i].value, 1e-12);
    }
}

static void test_parameters(void **state) {
    (void)state;
    struct expression expression;
    assert_true(expression_read_parameters(&expression, "2*n1 - a", &row_names));
    assert_float_equal(expression_evaluate(&expression, row), 8.0, 1e-12);
    assert_false(expression_read_parameters(&expression, "v(a)", &row_names));
    assert_false(expression_read(&expression, "2*n1", &row_names));
}

static void test_signals(void **state) {
    (void)state;
    struct expression expression, other;
    assert_true(expression_read_signal(&expression, "v(n1)", &row_names));
    assert_true(expression_read_signal(&other, "par('v(a)*2')", &row_names));
    assert_true(expression_subtract(&expression, &other));
    assert_true(expression_subtract_number(&expression, 0.5));
    assert_float_equal(expression_evaluate(&expression, row), 0.5, 1e-12);
    assert_false(expression_read_signal(&expression, "v(n1)+1", &row_names));
    assert_false(expression_read_signal(&expression, "2", &row_names));
    assert_false(expression_read_signal(&expression, "par('v(a)", &row_names));
}

static void test_not_understood(void **state) {
    (void)state;
    static const char *const texts[] = {"",      "v(b)", "v(a", "v(a,n1)",  "v(0)", "i(a)", "sqrt(4)", "2**3",
                                        "2^3",   "1 2",  "(1",  "1)",       "1+",   "*1",   "0x10",    "1v",
                                        "1kohm", "1e",   "nan", "v(a)?1:2", "1,5",  "2k7",  "v()",     "e5"};
    struct expression expression;
    for (size_t i = 0; i < sizeof texts / sizeof texts[0]; i++)
        if (expression_read(&expression, texts[i], &row_names))
            fail_msg("understood: %s", texts[i]);
}

/* Too long, or nested too deeply: left alone without harm. */
static void test_limits(void **state) {
    (void)state;
    char text[2000] = "1";
    struct expression expression;
    for (int i = 0; i < 12; i++)
        strcat(text, "+1");
    assert_false(expression_read(&expression, text, &row_names)); /* 25 operations */
    text[strlen(text) - 2] = '\0';
    assert_true(expression_read(&expression, text, &row_names));
    assert_float_equal(expression_evaluate(&expression, row), 12.0, 1e-12);
    assert_false(expression_subtract_number(&expression, 1.0));
    memset(text, '(', sizeof text - 1);
    text[sizeof text - 1] = '\0';
    assert_false(expression_read(&expression, text, &row_names));
    memset(text, '-', sizeof text - 1);
    assert_false(expression_read(&expression, text, &row_names));
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_values), cmocka_unit_test(test_parameters),
                                       cmocka_unit_test(test_signals), cmocka_unit_test(test_not_understood),
                                       cmocka_unit_test(test_limits)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
