/* Branches from relaxation and creep, against sums of exponentials and against creep integrated in time. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>

#include "deasim/fit.h"

#define POINTS 100

static void assert_close(const char *what, double ours, double expected, double relative) {
    if (fabs(ours - expected) > relative * fabs(expected)) {
        print_error("%s: %.12g, expected %.12g\n", what, ours, expected);
        fail();
    }
}

/* e + sum r_i (e - v_i) = final, v_i' = (e - v_i)/tau_i by the midpoint rule in small steps. */
static double integrate_creep(const struct dea_step_model *model, double end) {
    double v[DEA_FIT_BRANCHES] = {0.0}, total = 1.0, strain = 0.0;
    int steps = 200000;
    for (int i = 0; i < model->count; i++)
        total += model->ratio[i];
    for (int n = 0; n <= steps; n++) {
        double middle[DEA_FIT_BRANCHES], h = end / steps, sum = model->final, half = model->final;
        for (int i = 0; i < model->count; i++)
            sum += model->ratio[i] * v[i];
        strain = sum / total;
        for (int i = 0; i < model->count; i++) {
            middle[i] = v[i] + 0.5 * h * (strain - v[i]) / model->tau[i];
            half += model->ratio[i] * middle[i];
        }
        for (int i = 0; i < model->count && n < steps; i++)
            v[i] += h * (half / total - middle[i]) / model->tau[i];
    }
    return strain;
}

static void creep_answers_the_same_material(void **state) {
    (void)state;
    const struct dea_step_model model = {DEA_STEP_CREEP, 3, 0.2, {0.3, 0.5, 0.1}, {0.05, 0.4, 2.0}};
    for (double t = 0.01; t < 10.0; t *= 3.0)
        assert_close("creep", dea_step_answer(&model, t), integrate_creep(&model, t), 1e-8);
    assert_close("jump", dea_step_answer(&model, 0.0), 0.2 / 1.9, 1e-12);
    assert_close("end", dea_step_answer(&model, 1e3), 0.2, 1e-12);
}

static void exact_data_give_the_branches_back(void **state) {
    (void)state;
    for (int kind = 0; kind < 2; kind++) {
        const struct dea_step_model made = {
            kind == 0 ? DEA_STEP_RELAXATION : DEA_STEP_CREEP, 2, 2e5, {0.3, 0.2}, {0.01, 1.0}};
        double times[POINTS], values[POINTS];
        for (int i = 0; i < POINTS; i++) {
            times[i] = 1e-3 * pow(1e4, (double)i / (POINTS - 1));
            values[i] = dea_step_answer(&made, times[i]);
        }
        struct dea_columns data = {.values = {times, values}, .count = POINTS};
        struct dea_step_model model;
        struct dea_fit fit;
        assert_int_equal(dea_fit_branches(made.kind, &data, 2, &model, &fit, NULL), DEA_OK);
        assert_close("final", model.final, 2e5, 1e-7);
        for (int i = 0; i < 2; i++) {
            assert_close("ratio", model.ratio[i], made.ratio[i], 1e-6);
            assert_close("tau", model.tau[i], made.tau[i], 1e-6);
            assert_close("reported", fit.parameters[2 + 2 * i].value, made.tau[i], 1e-6);
        }
    }
}

static void assert_inside(const struct dea_fit *fit, int i, double truth) {
    const struct dea_fit_parameter *p = &fit->parameters[i];
    if (p->low < truth && truth < p->high)
        return;
    print_error("%s: %g to %g does not hold %g\n", p->name, p->low, p->high, truth);
    fail();
}

/* The number of branches is found as well. */
static void sample_tests_are_recovered(void **state) {
    (void)state;
    enum dea_step_kind kind;
    struct dea_columns data;
    struct dea_step_model model;
    struct dea_fit fit;
    assert_int_equal(dea_step_test_read(TEST_DATA "/relaxation.csv", &kind, &data, NULL), DEA_OK);
    assert_int_equal(kind, DEA_STEP_RELAXATION);
    assert_int_equal(dea_fit_branches(kind, &data, 0, &model, &fit, NULL), DEA_OK);
    assert_int_equal(model.count, 2);
    const double relaxation[] = {500e3, 0.08, 2e-3, 0.06, 0.2};
    for (int i = 0; i < 5; i++)
        assert_inside(&fit, i, relaxation[i]);
    dea_columns_clear(&data);

    assert_int_equal(dea_step_test_read(TEST_DATA "/creep.csv", &kind, &data, NULL), DEA_OK);
    assert_int_equal(kind, DEA_STEP_CREEP);
    assert_int_equal(dea_fit_branches(kind, &data, 0, &model, &fit, NULL), DEA_OK);
    assert_int_equal(model.count, 2);
    const double creep[] = {0.1, 0.3, 0.5, 0.5, 20.0};
    for (int i = 0; i < 5; i++)
        assert_inside(&fit, i, creep[i]);
    dea_columns_clear(&data);
}

static void too_little_is_refused(void **state) {
    (void)state;
    double times[] = {1.0, 2.0, 3.0, 4.0}, values[] = {4.0, 3.0, 2.0, 1.0};
    struct dea_columns data = {.values = {times, values}, .count = 4};
    struct dea_step_model model;
    struct dea_fit fit;
    struct dea_error error;
    assert_int_equal(dea_fit_branches(DEA_STEP_RELAXATION, &data, 1, &model, &fit, &error), DEA_ERR_INPUT);
    assert_string_equal(error.text, "4 points are too few for 1 branch; at least 5 are needed");
    assert_int_equal(dea_fit_branches(DEA_STEP_RELAXATION, &data, 6, &model, &fit, &error), DEA_ERR_INPUT);
    assert_string_equal(error.text, "6 branches cannot be fitted; 1 to 5 are allowed");
    values[3] = -1.0;
    assert_int_equal(dea_fit_branches(DEA_STEP_RELAXATION, &data, 1, &model, &fit, &error), DEA_ERR_INPUT);
    assert_string_equal(error.text, "the stress must keep its sign and not be 0");
    data.count = 2;
    assert_int_equal(dea_fit_branches(DEA_STEP_CREEP, &data, 0, &model, &fit, &error), DEA_ERR_INPUT);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(creep_answers_the_same_material),
        cmocka_unit_test(exact_data_give_the_branches_back),
        cmocka_unit_test(sample_tests_are_recovered),
        cmocka_unit_test(too_little_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
