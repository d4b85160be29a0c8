/* Decimal numbers of result files against printf and strtod. */
#include "output/output_internal.h"
#include "output_support.h"

#include <float.h>
#include <math.h>

static void check_write(double value) {
    char own[64], reference[64];
    int length = dea_number_write(value, own);
    assert_in_range(length, 1, DEA_NUMBER_LENGTH);
    own[length] = '\0';
    snprintf(reference, sizeof reference, "%.12g", value);
    assert_string_equal(own, reference);

    double read;
    assert_ptr_equal(dea_number_read(own, own + length, &read), own + length);
    double expected = strtod(reference, NULL);
    if (isinf(expected))
        assert_true(read == expected);
    else
        assert_true(fabs(read - expected) <= 1e-15 * fabs(expected));
}

static void chosen_numbers_match_printf(void **state) {
    (void)state;
    static const double values[] = {0.0,
                                    -0.0,
                                    1.0,
                                    -1.0,
                                    0.1,
                                    0.5,
                                    1e-4,
                                    1e-5,
                                    9.99999999999e-5,
                                    99999.9999999,
                                    999999999999.0,
                                    999999999999.5,
                                    1e12,
                                    1e22,
                                    1e23,
                                    123456789012.0,
                                    1234567890125.0,
                                    0.000123456789012,
                                    3300.0,
                                    100e6,
                                    2.5e-11,
                                    1e-32,
                                    1e32,
                                    1e-33,
                                    1e33,
                                    4.9e-324,
                                    DBL_MIN,
                                    DBL_MAX,
                                    -DBL_MAX,
                                    INFINITY,
                                    -INFINITY,
                                    0.9999999999995,
                                    0.99999999999949,
                                    9.5,
                                    1e11,
                                    99999999999.95};
    for (size_t i = 0; i < sizeof values / sizeof values[0]; i++)
        check_write(values[i]);
}

/* Deterministic numbers over all exponents, round ones and arbitrary bit patterns among them. */
static void many_numbers_match_printf(void **state) {
    (void)state;
    uint64_t seed = 88172645463325252u;
    for (int i = 0; i < 300000; i++) {
        seed ^= seed << 13;
        seed ^= seed >> 7;
        seed ^= seed << 17;
        double value;
        memcpy(&value, &seed, sizeof value);
        if (i % 3 != 0)
            value = ((double)(seed >> 11) / 9007199254740992.0 - 0.5) * pow(10.0, (int)(seed % 90) - 45);
        if (i % 3 == 2)
            value = round(value * 1e6) / 1e6;
        if (!isnan(value))
            check_write(value);
    }
}

static void nan_has_no_sign(void **state) {
    (void)state;
    char text[DEA_NUMBER_LENGTH];
    assert_int_equal(dea_number_write(-NAN, text), 3);
    assert_memory_equal(text, "nan", 3);
    double value;
    assert_ptr_equal(dea_number_read(text, text + 3, &value), text + 3);
    assert_true(isnan(value));
}

static void reading_stops_where_the_number_does(void **state) {
    (void)state;
    static const struct {
        const char *text;
        int length; /* -1: no number */
        double value;
    } cases[] = {{"12,3", 2, 12},
                 {"-1.5e3x", 6, -1500},
                 {"1e", 1, 1},
                 {"1e+", 1, 1},
                 {"", -1, 0},
                 {"-", -1, 0},
                 {".", -1, 0},
                 {".5", 2, 0.5},
                 {"x", -1, 0},
                 {"1.2.3", 3, 1.2},
                 {"1e400", 5, HUGE_VAL},
                 {"1e-400", 6, 0},
                 {"+7", 2, 7},
                 {"1e99999999999", 13, HUGE_VAL},
                 {"0.000000000000000000000000000001234567890123456789", 50, 1.234567890123456789e-30},
                 {"123456789012345678901234567890", 30, 123456789012345678901234567890.0},
                 {"0e99999", 7, 0}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        const char *text = cases[i].text, *stop;
        double value = -1;
        stop = dea_number_read(text, text + strlen(text), &value);
        if (cases[i].length < 0) {
            assert_null(stop);
            continue;
        }
        assert_ptr_equal(stop, text + cases[i].length);
        if (isinf(cases[i].value))
            assert_true(value == cases[i].value);
        else
            assert_true(fabs(value - cases[i].value) <= 1e-15 * fabs(cases[i].value));
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(chosen_numbers_match_printf),
        cmocka_unit_test(many_numbers_match_printf),
        cmocka_unit_test(nan_has_no_sign),
        cmocka_unit_test(reading_stops_where_the_number_does),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
