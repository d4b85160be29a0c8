/* Elastic laws from pull tests. Along both tests the nominal stress is dW/dlam1: in pure shear lam2 is clamped, in
 * uniaxial tension lam2 = lam1^-1/2 makes dW/dlam2 vanish. */
#include "deasim/fit.h"
#include "design/least_squares.h"

#include <math.h>
#include <stdio.h>

#define FEWEST_SPARE_POINTS 2 /* beyond the parameters, or there is no interval */
#define MAX_STARTS 16

struct law_problem {
    const struct dea_pull_test *test;
    enum dea_law_kind kind;
    int terms;
};

/* ---- reading ---- */

static enum dea_status check_stretch(void *context, const struct dea_columns *columns, size_t i,
                                     struct dea_error *error) {
    (void)context;
    if (!(columns->values[0][i] > 0.0))
        return dea_fail(error, DEA_ERR_INPUT, "the stretch %g is not positive (strains must be given as 1 + strain)",
                        columns->values[0][i]);
    return DEA_OK;
}

enum dea_status dea_pull_test_read(const char *path, struct dea_columns *columns, struct dea_error *error) {
    const struct dea_column_wish wishes[2] = {{"stretch", true, {"1", NULL}}, {"stress", false, {"Pa", NULL}}};
    return dea_columns_read(path, wishes, check_stretch, NULL, columns, error);
}

/* ---- the test ---- */

double dea_pull_stress(const struct dea_pull_test *test, const struct dea_law *law, double stretch) {
    double lam1 = test->start * stretch, lam2 = test->kind == DEA_PULL_PURE_SHEAR ? test->lam2 : 1.0 / sqrt(lam1);
    struct dea_stress stress;
    if (!(dea_law_margin(law, lam1, lam2) > 0.0) || dea_law_stress(law, lam1, lam2, &stress) != DEA_OK)
        return NAN;
    switch (test->basis) {
    case DEA_STRESS_CLAMPED:
        return stress.w1 * test->start;
    case DEA_STRESS_TRUE:
        return stress.w1 * lam1;
    default:
        return stress.w1;
    }
}

/* Parameters of the search: logarithms of what must be positive. */
static struct dea_law law_from(const struct law_problem *problem, const double *q) {
    struct dea_law law = {.kind = problem->kind};
    switch (problem->kind) {
    case DEA_GENT:
        law.mu = exp(q[0]);
        law.jm = exp(q[1]);
        break;
    case DEA_ARRUDA_BOYCE:
        law.mu = exp(q[0]);
        law.locking_stretch = exp(q[1]);
        break;
    case DEA_YEOH:
        law.yeoh_terms = problem->terms;
        for (int i = 0; i < problem->terms; i++)
            law.yeoh[i] = q[i];
        break;
    case DEA_OGDEN:
        law.ogden_terms = problem->terms;
        for (int i = 0; i < problem->terms; i++) {
            law.ogden_mu[i] = q[2 * i];
            law.ogden_alpha[i] = q[2 * i + 1];
        }
        break;
    default:
        law.mu = exp(q[0]);
        break;
    }
    return law;
}

static double predict(const double *q, double stretch, const void *context) {
    const struct law_problem *problem = context;
    struct dea_law law = law_from(problem, q);
    return dea_pull_stress(problem->test, &law, stretch);
}

/* ---- parameters and starts ---- */

static int count_parameters(enum dea_law_kind kind, int terms) {
    switch (kind) {
    case DEA_GENT:
    case DEA_ARRUDA_BOYCE:
        return 2;
    case DEA_YEOH:
        return terms;
    case DEA_OGDEN:
        return 2 * terms;
    default:
        return 1;
    }
}

static void name_parameter(struct dea_fit_parameter *parameter, const char *name, int number, const char *si_unit) {
    if (number > 0)
        snprintf(parameter->name, sizeof parameter->name, "%s%d", name, number);
    else
        snprintf(parameter->name, sizeof parameter->name, "%s", name);
    parameter->si_unit = si_unit;
}

static void name_parameters(const struct law_problem *problem, struct dea_fit *fit, bool *logarithmic) {
    bool positive = problem->kind != DEA_YEOH && problem->kind != DEA_OGDEN;
    for (int i = 0; i < DEA_FIT_PARAMETERS; i++)
        logarithmic[i] = positive;
    if (positive)
        name_parameter(&fit->parameters[0], "mu", 0, "Pa");
    if (problem->kind == DEA_GENT)
        name_parameter(&fit->parameters[1], "jm", 0, "1");
    if (problem->kind == DEA_ARRUDA_BOYCE)
        name_parameter(&fit->parameters[1], "locking_stretch", 0, "1");
    for (int i = 0; i < problem->terms && problem->kind == DEA_YEOH; i++) {
        name_parameter(&fit->parameters[i], "c", 10 * (i + 1), "Pa");
    }
    for (int i = 0; i < problem->terms && problem->kind == DEA_OGDEN; i++) {
        name_parameter(&fit->parameters[2 * i], "mu", i + 1, "Pa");
        name_parameter(&fit->parameters[2 * i + 1], "alpha", i + 1, "1");
    }
}

/* Largest I1 of the data: laws with a limit start beyond it. */
static double largest_invariant(const struct dea_pull_test *test, const struct dea_columns *data) {
    double largest = 3.0;
    for (size_t i = 0; i < data->count; i++) {
        double lam1 = test->start * data->values[0][i];
        double lam2 = test->kind == DEA_PULL_PURE_SHEAR ? test->lam2 : 1.0 / sqrt(lam1), lam3 = 1.0 / (lam1 * lam2);
        largest = fmax(largest, lam1 * lam1 + lam2 * lam2 + lam3 * lam3);
    }
    return largest;
}

/* Factor by which a law that is linear in its modulus comes closest to the data. */
static double scale_to_data(const struct dea_pull_test *test, const struct dea_law *unit,
                            const struct dea_columns *data) {
    double product = 0.0, square = 0.0;
    for (size_t i = 0; i < data->count; i++) {
        double stress = dea_pull_stress(test, unit, data->values[0][i]);
        product += isfinite(stress) ? stress * data->values[1][i] : 0.0;
        square += isfinite(stress) ? stress * stress : 0.0;
    }
    return square > 0.0 ? product / square : NAN;
}

/* Start number `index` of the search; false when there is none of that number. */
static bool choose_start(const struct law_problem *problem, const struct dea_columns *data, int index, double *q) {
    static const double reaches[] = {1.02, 1.1, 1.4, 2.0, 4.0, 10.0, 50.0}; /* limit over largest I1 - 3 */
    static const double alphas[][2] = {{2.0, -2.0}, {1.5, 5.0}, {3.0, 8.0}, {-2.0, 4.0}, {1.3, -1.0}};
    struct dea_law unit = {.kind = problem->kind, .mu = 1.0};
    double excess = largest_invariant(problem->test, data) - 3.0, scale;
    if (problem->kind == DEA_OGDEN) {
        if (index >= (int)(sizeof alphas / sizeof alphas[0]))
            return false;
        unit = (struct dea_law){.kind = DEA_NEO_HOOKEAN, .mu = 1.0};
        scale = scale_to_data(problem->test, &unit, data);
        for (int i = 0; i < problem->terms; i++) {
            q[2 * i + 1] = i < 2 ? alphas[index][i] : 2.0 + 3.0 * i;
            q[2 * i] = 2.0 * scale / (q[2 * i + 1] * problem->terms);
        }
        return isfinite(scale);
    }
    if (problem->kind == DEA_YEOH || problem->kind == DEA_NEO_HOOKEAN) {
        if (index > 0)
            return false;
        unit.kind = DEA_NEO_HOOKEAN;
        scale = scale_to_data(problem->test, &unit, data);
        for (int i = 0; i < problem->terms && problem->kind == DEA_YEOH; i++)
            q[i] = i == 0 ? 0.5 * scale : 0.0;
        if (problem->kind == DEA_NEO_HOOKEAN)
            q[0] = log(scale);
        return isfinite(q[0]);
    }
    if (index >= (int)(sizeof reaches / sizeof reaches[0]))
        return false;
    unit.jm = excess * reaches[index];
    unit.locking_stretch = sqrt((3.0 + unit.jm) / 3.0);
    scale = scale_to_data(problem->test, &unit, data);
    q[0] = log(scale);
    q[1] = log(problem->kind == DEA_GENT ? unit.jm : unit.locking_stretch);
    return true;
}

/* ---- the fit ---- */

static enum dea_status check_data(const struct law_problem *problem, const struct dea_columns *data, int parameters,
                                  struct dea_error *error) {
    double found[DEA_FIT_PARAMETERS];
    int distinct = 0;
    for (size_t i = 0; i < data->count && distinct < parameters; i++) {
        bool seen = false;
        for (int k = 0; k < distinct; k++)
            seen = seen || found[k] == data->values[0][i];
        if (!seen)
            found[distinct++] = data->values[0][i];
    }
    if (data->count < (size_t)parameters + FEWEST_SPARE_POINTS || distinct < parameters)
        return dea_fail(error, DEA_ERR_INPUT,
                        "%zu points at %d stretch%s are too few for the %d parameter%s of a %s law; at least %d are "
                        "needed",
                        data->count, distinct, distinct == 1 ? "" : "es", parameters, parameters == 1 ? "" : "s",
                        dea_law_name(problem->kind), parameters + FEWEST_SPARE_POINTS);
    return DEA_OK;
}

static enum dea_status check_test(const struct dea_pull_test *test, enum dea_law_kind kind, int terms,
                                  struct dea_error *error) {
    int most = kind == DEA_YEOH ? DEA_MAX_YEOH_TERMS : kind == DEA_OGDEN ? 3 : 1;
    if (terms < 1 || terms > most)
        return dea_fail(error, DEA_ERR_INPUT, "a %s fit may have 1 to %d terms, not %d", dea_law_name(kind), most,
                        terms);
    if (!(test->lam2 > 0.0 && isfinite(test->lam2) && test->start > 0.0 && isfinite(test->start)))
        return dea_fail(error, DEA_ERR_INPUT, "the stretches of the clamped film must be positive");
    return DEA_OK;
}

enum dea_status dea_fit_law(const struct dea_pull_test *test, const struct dea_columns *data, enum dea_law_kind kind,
                            int terms, struct dea_law *law, struct dea_fit *fit, struct dea_error *error) {
    struct law_problem problem = {test, kind, terms};
    struct dea_least_squares squares = {predict, &problem, data, count_parameters(kind, terms)};
    DEA_TRY(check_test(test, kind, terms, error));
    DEA_TRY(check_data(&problem, data, squares.count, error));

    /* the best of several starts */
    double best[DEA_FIT_PARAMETERS] = {0.0}, least = INFINITY;
    for (int start = 0; start < MAX_STARTS; start++) {
        double q[DEA_FIT_PARAMETERS] = {0.0};
        if (!choose_start(&problem, data, start, q))
            break;
        DEA_TRY(dea_least_squares_try(&squares, q, best, &least, error));
    }
    if (!isfinite(least))
        return dea_fail(error, DEA_ERR_SOLVER,
                        "no %s law comes near these data; is the stress negative or the kind of "
                        "test another one?",
                        dea_law_name(kind));
    bool logarithmic[DEA_FIT_PARAMETERS];
    *fit = (struct dea_fit){.count = squares.count};
    name_parameters(&problem, fit, logarithmic);
    *law = law_from(&problem, best);
    return dea_least_squares_judge(&squares, best, logarithmic, fit, error);
}
