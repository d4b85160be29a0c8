/* Least squares over MINPACK: lmdif searches, covar gives the covariance of the parameters. */
#include "design/least_squares.h"

#include "base/library.h"

#include <cminpack.h>

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define MAX_EVALUATIONS 4000
#define OUTSIDE 1e3 /* residual outside the model, in units of the largest datum */
/* An interval that spans more than a factor of e^2 = 7.4, or more than twice the value, determines nothing. */
#define LOOSE 1.0

/* What MINPACK needs besides the parameters, and its scratch. */
struct minpack {
    const struct dea_least_squares *problem;
    double scale; /* largest |datum| */
    double *residuals, *jacobian, *work;
    int pivots[DEA_FIT_PARAMETERS];
    __typeof__(lmdif) *lmdif;
    __typeof__(enorm) *enorm;
    __typeof__(covar) *covar;
};

static int residuals(void *context, int m, int n, const double *q, double *out, int flag) {
    const struct minpack *minpack = context;
    const struct dea_least_squares *problem = minpack->problem;
    (void)n;
    (void)flag;
    for (int i = 0; i < m; i++) {
        double predicted = problem->predict(q, problem->data->values[0][i], problem->context);
        double residual = (predicted - problem->data->values[1][i]) / minpack->scale;
        out[i] = isfinite(residual) ? residual : OUTSIDE;
    }
    return 0;
}

static void minpack_free(struct minpack *minpack) {
    free(minpack->residuals);
    free(minpack->jacobian);
    free(minpack->work);
}

static enum dea_status minpack_prepare(const struct dea_least_squares *problem, struct minpack *minpack,
                                       struct dea_error *error) {
    size_t m = problem->data->count, n = (size_t)problem->count;
    *minpack = (struct minpack){.problem = problem};
    const struct dea_library_function functions[] = {
        {"lmdif", &minpack->lmdif}, {"enorm", &minpack->enorm}, {"covar", &minpack->covar}};
    DEA_TRY(dea_library_load("libcminpack.so.1", "libcminpack1", functions, 3, error));
    for (size_t i = 0; i < m; i++)
        minpack->scale = fmax(minpack->scale, fabs(problem->data->values[1][i]));
    minpack->residuals = malloc(m * sizeof(double));
    minpack->jacobian = malloc(m * n * sizeof(double));
    minpack->work = malloc((m + 5 * n) * sizeof(double));
    if (minpack->residuals != NULL && minpack->jacobian != NULL && minpack->work != NULL)
        return DEA_OK;
    minpack_free(minpack);
    return dea_fail(error, DEA_ERR_MEMORY, "out of memory for a fit to %zu points", m);
}

/* One run; q moves to the solution. Returns MINPACK's verdict. */
static int minpack_run(struct minpack *minpack, double *q, int evaluations) {
    int m = (int)minpack->problem->data->count, n = minpack->problem->count, used;
    double scale[DEA_FIT_PARAMETERS], *work = minpack->work;
    return minpack->lmdif(residuals, minpack, m, n, q, minpack->residuals, 1e-15, 1e-12, 0.0, evaluations, 0.0, scale,
                          1, 10.0, 0, &used, minpack->jacobian, m, minpack->pivots, work, work + n, work + 2 * n,
                          work + 3 * n, work + 4 * n);
}

static double sum_of_squares(const struct minpack *minpack) {
    double norm = minpack->enorm((int)minpack->problem->data->count, minpack->residuals) * minpack->scale;
    return norm * norm;
}

enum dea_status dea_least_squares_try(const struct dea_least_squares *problem, double *q, double *best, double *least,
                                      struct dea_error *error) {
    struct minpack minpack;
    DEA_TRY(minpack_prepare(problem, &minpack, error));
    int verdict = minpack_run(&minpack, q, MAX_EVALUATIONS);
    double cost = sum_of_squares(&minpack);
    bool outside = false;
    for (size_t i = 0; i < problem->data->count; i++)
        outside = outside || !isfinite(problem->predict(q, problem->data->values[0][i], problem->context));
    minpack_free(&minpack);
    /* 1 to 4 arrived, 6 to 8 arrived as closely as rounding allows, 5 ran out of evaluations */
    bool arrived = verdict >= 1 && verdict != 5 && !outside && isfinite(cost);
    if (arrived && cost < *least) {
        *least = cost;
        memcpy(best, q, (size_t)problem->count * sizeof *best);
    }
    return DEA_OK;
}

/* 97.5 % point of Student's t: Abramowitz and Stegun, Handbook of Mathematical Functions, 26.7.5. */
static double student_quantile(double freedom) {
    const double z = 1.959963984540054;
    double z3 = z * z * z, z5 = z3 * z * z, z7 = z5 * z * z;
    return z + (z3 + z) / (4.0 * freedom) + (5.0 * z5 + 16.0 * z3 + 3.0 * z) / (96.0 * freedom * freedom) +
           (3.0 * z7 + 19.0 * z5 + 17.0 * z3 - 15.0 * z) / (384.0 * freedom * freedom * freedom);
}

static void judge_parameter(struct dea_fit_parameter *parameter, double q, bool logarithmic, double reach) {
    bool bounded = isfinite(reach);
    if (logarithmic) {
        parameter->value = exp(q);
        parameter->low = bounded ? exp(q - reach) : 0.0;
        parameter->high = bounded ? exp(q + reach) : INFINITY;
        parameter->determined = bounded && reach < LOOSE;
    } else {
        parameter->value = q;
        parameter->low = bounded ? q - reach : -INFINITY;
        parameter->high = bounded ? q + reach : INFINITY;
        parameter->determined = bounded && reach < LOOSE * fabs(q);
    }
}

enum dea_status dea_least_squares_judge(const struct dea_least_squares *problem, const double *q,
                                        const bool *logarithmic, struct dea_fit *fit, struct dea_error *error) {
    struct minpack minpack;
    DEA_TRY(minpack_prepare(problem, &minpack, error));
    int n = problem->count, m = (int)problem->data->count;
    double here[DEA_FIT_PARAMETERS];
    memcpy(here, q, (size_t)n * sizeof *q);
    minpack_run(&minpack, here, 1); /* for the Jacobian at the solution: no step is wanted */
    double cost = sum_of_squares(&minpack), freedom = m - n;
    /* columns of the Jacobian that depend on others within this give no interval */
    minpack.covar(n, minpack.jacobian, m, minpack.pivots, 1e-10, minpack.work);
    double variance = cost / (minpack.scale * minpack.scale) / freedom, quantile = student_quantile(freedom);
    for (int k = 0; k < n; k++) {
        double spread = minpack.jacobian[k * m + k];
        judge_parameter(&fit->parameters[k], q[k], logarithmic[k],
                        spread > 0.0 ? quantile * sqrt(spread * variance) : INFINITY);
    }
    minpack_free(&minpack);

    double mean = 0.0, spread = 0.0;
    for (int i = 0; i < m; i++)
        mean += problem->data->values[1][i] / m;
    for (int i = 0; i < m; i++)
        spread += pow(problem->data->values[1][i] - mean, 2.0);
    fit->count = n;
    fit->points = (size_t)m;
    fit->residual = sqrt(cost / freedom);
    fit->r_squared = spread > 0.0 ? 1.0 - cost / spread : 0.0;
    double k = n + 1.0; /* with the variance of the noise */
    fit->aicc = m * log(fmax(cost, DBL_MIN) / m) + 2.0 * k + 2.0 * k * (k + 1.0) / fmax(m - k - 1.0, 1e-3);
    return DEA_OK;
}
