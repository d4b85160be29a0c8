/* Parameters of plain netlists: what they are worth, and what is left to ngspice. */
#include "circuit/parameters.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static bool read_lines(struct dea_parameters *parameters, const char *first, const char *second) {
    char title[] = "a title", texts[2][128];
    struct dea_netlist_line lines[3] = {
        {.text = title}, {.text = texts[0], .passed = true}, {.text = texts[1], .passed = true}};
    snprintf(texts[0], sizeof texts[0], "%s", first);
    snprintf(texts[1], sizeof texts[1], "%s", second);
    const struct dea_netlist netlist = {.lines = lines, .line_count = 3};
    return dea_parameters_read(parameters, &netlist);
}

static void test_values(void **state) {
    (void)state;
    struct dea_parameters parameters;
    assert_true(read_lines(&parameters, ".param Rs=400k cs = 40p", ".PARAM tau={rs*cs} half='tau/2' low=-5"));
    static const struct {
        const char *name;
        double value;
    } expected[] = {{"rs", 400e3}, {"cs", 40e-12}, {"tau", 16e-6}, {"half", 8e-6}, {"low", -5.0}};
    assert_int_equal(parameters.count, 5);
    for (int i = 0; i < 5; i++) {
        assert_string_equal(parameters.names[i], expected[i].name);
        assert_true(parameters.values[i] == expected[i].value ||
                    (i >= 2 && parameters.values[i] / expected[i].value - 1.0 < 1e-15));
    }
    dea_parameters_clear(&parameters);
}

static void test_put_in(void **state) {
    (void)state;
    static const struct {
        const char *line, *with;
    } cases[] = {{"R1 a b {R}", "R1 a b 250"},
                 {"R1 a b r='2*r' m={m}", "R1 a b r=500 m=3"},
                 {"V1 s 0 SIN({r} {-m} 50)", "V1 s 0 SIN(250 -3 50)"},
                 {"V1 s 0 PWL(0,{m},1,{ r + 1 })", "V1 s 0 PWL(0,3,1,251)"},
                 {"C1 a 0 1n", "C1 a 0 1n"},
                 {"R1 a b {r/m}", "R1 a b 83.333333333333329"}};
    struct dea_parameters parameters;
    assert_true(read_lines(&parameters, ".param r=250 m=3", ""));
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        char *line = dea_parameters_put_in(&parameters, cases[i].line);
        assert_non_null(line);
        assert_string_equal(line, cases[i].with);
        free(line);
    }
    static const char *const left_alone[] = {"R1 a b {x}",   "R1 a b {r",        "R1 a b k{r}",
                                             "R1 a b {r}k",  "R1 a b {sqrt(r)}", "R1 a b {r/0}",
                                             "R1 a b '{r}'", "R1 a b {}",        "{r} a b 1"};
    for (size_t i = 0; i < sizeof left_alone / sizeof left_alone[0]; i++)
        if (dea_parameters_put_in(&parameters, left_alone[i]) != NULL)
            fail_msg("understood: %s", left_alone[i]);
    dea_parameters_clear(&parameters);
}

static void test_left_to_ngspice(void **state) {
    (void)state;
    static const char *const lines[] = {
        ".param a=b",     ".param a={later} later=1", ".param a=1 a=2", ".param a",    ".param a=",   ".param a 1",
        ".param a=1,b=2", ".param a=2*(1+1)",         ".param f(x)=x",  ".param a=1V", ".param 1a=1", ".param time=1",
        ".param a={1/0}", ".param a=\"1\"",           ".params a=1"};
    for (size_t i = 0; i < sizeof lines / sizeof lines[0]; i++) {
        struct dea_parameters parameters;
        if (read_lines(&parameters, lines[i], ""))
            fail_msg("understood: %s", lines[i]);
        dea_parameters_clear(&parameters);
    }
    struct dea_parameters parameters;
    assert_false(read_lines(&parameters, ".param a=1", ".param a=2"));
    dea_parameters_clear(&parameters);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_values), cmocka_unit_test(test_put_in),
                                       cmocka_unit_test(test_left_to_ngspice)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
