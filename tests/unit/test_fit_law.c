/* Elastic laws from pull tests: exact data give the law back, noisy data give intervals that hold what they promise. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "deasim/fit.h"

#define POINTS 60

/* Park and Miller's generator and Box and Muller's transform: the same noise on every machine. */
static double gaussian(uint32_t *seed) {
    double u[2];
    for (int i = 0; i < 2; i++) {
        *seed = (uint32_t)((uint64_t)*seed * 48271u % 2147483647u);
        u[i] = (double)*seed / 2147483647.0;
    }
    return sqrt(-2.0 * log(u[0])) * cos(2.0 * acos(-1.0) * u[1]);
}

struct made {
    double stretch[POINTS], stress[POINTS];
    struct dea_columns columns;
};

static void make(struct made *made, const struct dea_pull_test *test, const struct dea_law *law, double last,
                 double noise, uint32_t *seed) {
    for (int i = 0; i < POINTS; i++) {
        made->stretch[i] = 1.0 + (last - 1.0) * i / (POINTS - 1);
        made->stress[i] = dea_pull_stress(test, law, made->stretch[i]) + (noise > 0.0 ? noise * gaussian(seed) : 0.0);
        assert_true(isfinite(made->stress[i]));
    }
    made->columns = (struct dea_columns){.values = {made->stretch, made->stress}, .count = POINTS};
}

static void assert_close(const char *what, double ours, double expected, double relative) {
    if (fabs(ours - expected) > relative * fabs(expected)) {
        print_error("%s: %.12g, expected %.12g\n", what, ours, expected);
        fail();
    }
}

static void exact_data_give_the_law_back(void **state) {
    (void)state;
    const struct dea_law laws[] = {
        {.kind = DEA_GENT, .mu = 0.365e6, .jm = 16.6},
        {.kind = DEA_NEO_HOOKEAN, .mu = 0.3e6},
        {.kind = DEA_YEOH, .yeoh_terms = 3, .yeoh = {180.7e3, -16.7e3, 6.6e3}},
        {.kind = DEA_OGDEN, .ogden_terms = 1, .ogden_mu = {0.2e6}, .ogden_alpha = {2.7}},
        {.kind = DEA_OGDEN, .ogden_terms = 2, .ogden_mu = {0.2e6, -0.02e6}, .ogden_alpha = {2.2, -3.0}},
        {.kind = DEA_ARRUDA_BOYCE, .mu = 0.3e6, .locking_stretch = 2.5},
    };
    const struct dea_pull_test tests[] = {
        {DEA_PULL_PURE_SHEAR, DEA_STRESS_NOMINAL, 2.0, 0.70710678118654752},
        {DEA_PULL_PURE_SHEAR, DEA_STRESS_CLAMPED, 1.0, 1.0},
        {DEA_PULL_UNIAXIAL, DEA_STRESS_TRUE, 1.0, 1.0},
    };
    for (size_t k = 0; k < sizeof laws / sizeof laws[0]; k++)
        for (size_t t = 0; t < sizeof tests / sizeof tests[0]; t++) {
            struct made made;
            struct dea_law found;
            struct dea_fit fit;
            make(&made, &tests[t], &laws[k], 3.2, 0.0, NULL);
            int terms = laws[k].kind == DEA_YEOH ? 3 : laws[k].kind == DEA_OGDEN ? laws[k].ogden_terms : 1;
            assert_int_equal(dea_fit_law(&tests[t], &made.columns, laws[k].kind, terms, &found, &fit, NULL), DEA_OK);
            assert_true(fit.r_squared > 1.0 - 1e-12);
            for (int i = 0; i < POINTS; i++)
                assert_true(fabs(dea_pull_stress(&tests[t], &found, made.stretch[i]) - made.stress[i]) < 1e-3);
            if (laws[k].kind == DEA_GENT) {
                assert_close("mu", found.mu, 0.365e6, 1e-8);
                assert_close("jm", found.jm, 16.6, 1e-8);
                assert_string_equal(fit.parameters[1].name, "jm");
            }
            if (laws[k].kind == DEA_YEOH)
                assert_close("c20", found.yeoh[1], -16.7e3, 1e-6);
        }
}

/* 95 % intervals of a thousand noisy tests hold the truth in 95 % of them, give or take three standard deviations. */
static void intervals_hold_what_they_promise(void **state) {
    (void)state;
    const struct dea_pull_test test = {DEA_PULL_PURE_SHEAR, DEA_STRESS_NOMINAL, 2.0, 0.70710678118654752};
    const struct dea_law law = {.kind = DEA_GENT, .mu = 0.365e6, .jm = 16.6};
    uint32_t seed = 4711;
    int inside[2] = {0, 0};
    for (int i = 0; i < 1000; i++) {
        struct made made;
        struct dea_law found;
        struct dea_fit fit;
        make(&made, &test, &law, 3.6, 10e3, &seed);
        assert_int_equal(dea_fit_law(&test, &made.columns, DEA_GENT, 1, &found, &fit, NULL), DEA_OK);
        inside[0] += fit.parameters[0].low <= law.mu && law.mu <= fit.parameters[0].high;
        inside[1] += fit.parameters[1].low <= law.jm && law.jm <= fit.parameters[1].high;
        assert_true(fit.parameters[0].determined && fit.parameters[1].determined);
        assert_true(fit.residual > 6e3 && fit.residual < 15e3);
    }
    for (int k = 0; k < 2; k++)
        assert_in_range(inside[k], 929, 971);
}

static void what_the_data_do_not_say_is_marked(void **state) {
    (void)state;
    const struct dea_pull_test test = {DEA_PULL_UNIAXIAL, DEA_STRESS_NOMINAL, 1.0, 1.0};
    const struct dea_law law = {.kind = DEA_GENT, .mu = 0.365e6, .jm = 16.6};
    uint32_t seed = 99;
    struct made made;
    struct dea_law found;
    struct dea_fit fit;
    make(&made, &test, &law, 1.15, 2e3, &seed); /* far from the limit of the chains */
    assert_int_equal(dea_fit_law(&test, &made.columns, DEA_GENT, 1, &found, &fit, NULL), DEA_OK);
    assert_true(fit.parameters[0].determined);
    assert_false(fit.parameters[1].determined);
}

static void the_sample_test_is_recovered(void **state) {
    (void)state;
    const struct dea_pull_test test = {DEA_PULL_PURE_SHEAR, DEA_STRESS_NOMINAL, 2.0, 0.70710678118654752};
    struct dea_columns data;
    struct dea_law found;
    struct dea_fit fit;
    assert_int_equal(dea_pull_test_read(TEST_DATA "/pull_pure_shear.csv", &data, NULL), DEA_OK);
    assert_int_equal(data.count, 61);
    assert_int_equal(dea_fit_law(&test, &data, DEA_GENT, 1, &found, &fit, NULL), DEA_OK);
    assert_true(fit.parameters[0].low < 0.365e6 && 0.365e6 < fit.parameters[0].high);
    assert_true(fit.parameters[1].low < 16.6 && 16.6 < fit.parameters[1].high);
    assert_close("mu", found.mu, 0.365e6, 0.02);
    dea_columns_clear(&data);
}

static void too_little_is_refused(void **state) {
    (void)state;
    struct dea_pull_test test = {DEA_PULL_UNIAXIAL, DEA_STRESS_NOMINAL, 1.0, 1.0};
    const struct dea_law law = {.kind = DEA_GENT, .mu = 0.365e6, .jm = 16.6};
    struct made made;
    struct dea_law found;
    struct dea_fit fit;
    struct dea_error error;
    make(&made, &test, &law, 2.0, 0.0, NULL);
    made.columns.count = 3;
    assert_int_equal(dea_fit_law(&test, &made.columns, DEA_GENT, 1, &found, &fit, &error), DEA_ERR_INPUT);
    assert_string_equal(error.text, "3 points at 2 stretches are too few for the 2 parameters of a gent law; at least "
                                    "4 are needed");
    made.columns.count = POINTS;
    for (int i = 0; i < POINTS; i++)
        made.stretch[i] = 1.5;
    assert_int_equal(dea_fit_law(&test, &made.columns, DEA_YEOH, 3, &found, &fit, &error), DEA_ERR_INPUT);
    assert_string_equal(error.text, "60 points at 1 stretch are too few for the 3 parameters of a yeoh law; at least 5 "
                                    "are needed");
    assert_int_equal(dea_fit_law(&test, &made.columns, DEA_YEOH, 4, &found, &fit, &error), DEA_ERR_INPUT);
    assert_string_equal(error.text, "a yeoh fit may have 1 to 3 terms, not 4");
    make(&made, &test, &law, 2.0, 0.0, NULL);
    for (int i = 0; i < POINTS; i++)
        made.stress[i] = -made.stress[i] - 1e3;
    assert_int_equal(dea_fit_law(&test, &made.columns, DEA_GENT, 1, &found, &fit, &error), DEA_ERR_SOLVER);
    test.lam2 = -1.0;
    assert_int_equal(dea_fit_law(&test, &made.columns, DEA_GENT, 1, &found, &fit, &error), DEA_ERR_INPUT);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(exact_data_give_the_law_back),
        cmocka_unit_test(intervals_hold_what_they_promise),
        cmocka_unit_test(what_the_data_do_not_say_is_marked),
        cmocka_unit_test(the_sample_test_is_recovered),
        cmocka_unit_test(too_little_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
