/* Branches from relaxation or creep, linear viscoelastic: modulus 1 + sum r_i exp(-t/tau_i) relative to equilibrium.
 * Creep follows exactly: the compliance 1/(s G(s)) has one pole per branch, each between two relaxation rates. */
#include "deasim/fit.h"
#include "design/least_squares.h"

#include <math.h>
#include <stdio.h>
#include <strings.h>

#define FEWEST_SPARE_POINTS 2
#define BISECTIONS 200
#define WORTH_A_BRANCH 2.0 /* gain in Akaike's criterion that justifies one more branch */

/* ---- reading ---- */

static enum dea_status check_time(void *context, const struct dea_columns *columns, size_t i, struct dea_error *error) {
    const double *times = columns->values[0];
    (void)context;
    if (!(times[i] > 0.0))
        return dea_fail(error, DEA_ERR_INPUT, "the time %g s is not positive; times count from the step", times[i]);
    if (i > 0 && !(times[i] > times[i - 1]))
        return dea_fail(error, DEA_ERR_INPUT, "the time %g s does not follow %g s", times[i], times[i - 1]);
    return DEA_OK;
}

enum dea_status dea_step_test_read(const char *path, enum dea_step_kind *kind, struct dea_columns *columns,
                                   struct dea_error *error) {
    const struct dea_column_wish wishes[2] = {{"time", true, {"s", NULL}}, {"stress or strain", false, {"Pa", "1"}}};
    DEA_TRY(dea_columns_read(path, wishes, check_time, NULL, columns, error));
    *kind = columns->unit_index[1] == 0 ? DEA_STEP_RELAXATION : DEA_STEP_CREEP;
    if (*kind == DEA_STEP_CREEP && strcasecmp(columns->names[1], "stretch") == 0)
        for (size_t i = 0; i < columns->count; i++)
            columns->values[1][i] -= 1.0;
    return DEA_OK;
}

/* ---- the answer ---- */

/* Relative modulus at the Laplace variable s = -rate, and minus its derivative by s weighted as the residue needs. */
static double modulus_at(const struct dea_step_model *model, double rate, double *weight) {
    double sum = 1.0;
    *weight = 0.0;
    for (int i = 0; i < model->count; i++) {
        double lag = 1.0 - rate * model->tau[i];
        sum -= model->ratio[i] * rate * model->tau[i] / lag;
        *weight += model->ratio[i] * rate * model->tau[i] / (lag * lag);
    }
    return sum;
}

/* Retardation rate between two relaxation rates, where the modulus falls from + to - infinity (from 1 below the
 * slowest). */
static double find_rate(const struct dea_step_model *model, double low, double high) {
    double weight;
    for (int i = 0; i < BISECTIONS; i++) {
        double middle = 0.5 * (low + high);
        if (middle <= low || middle >= high)
            break;
        if (modulus_at(model, middle, &weight) > 0.0)
            low = middle;
        else
            high = middle;
    }
    return 0.5 * (low + high);
}

static double creep_answer(const struct dea_step_model *model, double t) {
    double strain = 1.0;
    for (int i = 0; i < model->count; i++) {
        double weight, low = i + 1 < model->count ? 1.0 / model->tau[i + 1] : 0.0;
        double rate = find_rate(model, low, 1.0 / model->tau[i]);
        modulus_at(model, rate, &weight);
        strain -= exp(-rate * t) / weight;
    }
    return model->final * strain;
}

double dea_step_answer(const struct dea_step_model *model, double t) {
    if (model->kind == DEA_STEP_CREEP)
        return creep_answer(model, t);
    double stress = 1.0;
    for (int i = 0; i < model->count; i++)
        stress += model->ratio[i] * exp(-t / model->tau[i]);
    return model->final * stress;
}

/* ---- the fit: q = final, then ln ratio and ln tau of each branch ---- */

struct step_problem {
    enum dea_step_kind kind;
    int branches;
};

/* Branches sorted by time, which the creep answer relies on; `order` says where each came from. */
static struct dea_step_model model_from(const struct step_problem *problem, const double *q, int *order) {
    struct dea_step_model model = {.kind = problem->kind, .count = problem->branches, .final = q[0]};
    for (int i = 0; i < problem->branches; i++) {
        int place = i;
        double tau = exp(q[2 + 2 * i]);
        for (; place > 0 && model.tau[place - 1] > tau; place--) {
            model.tau[place] = model.tau[place - 1];
            model.ratio[place] = model.ratio[place - 1];
            order[place] = order[place - 1];
        }
        model.tau[place] = tau;
        model.ratio[place] = exp(q[1 + 2 * i]);
        order[place] = i;
    }
    return model;
}

static double predict(const double *q, double t, const void *context) {
    int order[DEA_FIT_BRANCHES];
    struct dea_step_model model = model_from(context, q, order);
    return dea_step_answer(&model, t);
}

/* Times spread evenly in ln t, ratios that share the drop seen. */
static void choose_start(const struct step_problem *problem, const struct dea_columns *data, double shift, double *q) {
    size_t last = data->count - 1;
    double first_time = data->values[0][0], last_time = data->values[0][last];
    double early = data->values[1][0], late = data->values[1][last];
    double drop = problem->kind == DEA_STEP_RELAXATION ? early / late - 1.0 : late / early - 1.0;
    q[0] = late;
    for (int i = 0; i < problem->branches; i++) {
        double share = (i + 0.5 + shift) / problem->branches;
        q[1 + 2 * i] = log(fmax(drop, 1e-3) / problem->branches);
        q[2 + 2 * i] = log(first_time) + share * log(last_time / first_time);
    }
}

static enum dea_status fit_count(const struct step_problem *problem, const struct dea_columns *data,
                                 struct dea_step_model *model, struct dea_fit *fit, struct dea_error *error) {
    struct dea_least_squares squares = {predict, problem, data, 1 + 2 * problem->branches};
    if (data->count < (size_t)squares.count + FEWEST_SPARE_POINTS)
        return dea_fail(error, DEA_ERR_INPUT, "%zu points are too few for %d branch%s; at least %d are needed",
                        data->count, problem->branches, problem->branches == 1 ? "" : "es",
                        squares.count + FEWEST_SPARE_POINTS);
    double best[DEA_FIT_PARAMETERS] = {0.0}, least = INFINITY;
    for (double shift = -0.3; shift < 0.4; shift += 0.3) {
        double q[DEA_FIT_PARAMETERS] = {0.0};
        choose_start(problem, data, shift, q);
        DEA_TRY(dea_least_squares_try(&squares, q, best, &least, error));
    }
    if (!isfinite(least))
        return dea_fail(error, DEA_ERR_SOLVER, "no sum of %d branch%s comes near these data", problem->branches,
                        problem->branches == 1 ? "" : "es");

    /* branches in the order of their times, also in the report */
    int order[DEA_FIT_BRANCHES];
    double sorted[DEA_FIT_PARAMETERS] = {best[0]};
    bool logarithmic[DEA_FIT_PARAMETERS] = {false};
    *model = model_from(problem, best, order);
    *fit = (struct dea_fit){.count = squares.count};
    bool relaxation = problem->kind == DEA_STEP_RELAXATION;
    snprintf(fit->parameters[0].name, sizeof fit->parameters[0].name, "final");
    fit->parameters[0].si_unit = relaxation ? "Pa" : "1";
    for (int i = 0; i < problem->branches; i++) {
        struct dea_fit_parameter *ratio = &fit->parameters[1 + 2 * i], *tau = &fit->parameters[2 + 2 * i];
        sorted[1 + 2 * i] = best[1 + 2 * order[i]];
        sorted[2 + 2 * i] = best[2 + 2 * order[i]];
        logarithmic[1 + 2 * i] = logarithmic[2 + 2 * i] = true;
        snprintf(ratio->name, sizeof ratio->name, "ratio%d", i + 1);
        snprintf(tau->name, sizeof tau->name, "tau%d", i + 1);
        ratio->si_unit = "1";
        tau->si_unit = "s";
    }
    return dea_least_squares_judge(&squares, sorted, logarithmic, fit, error);
}

static bool all_determined(const struct dea_fit *fit) {
    for (int i = 0; i < fit->count; i++)
        if (!fit->parameters[i].determined)
            return false;
    return true;
}

static enum dea_status check_data(enum dea_step_kind kind, const struct dea_columns *data, struct dea_error *error) {
    if (data->count < 3)
        return dea_fail(error, DEA_ERR_INPUT, "%zu points are too few for any branch; at least 5 are needed",
                        data->count);
    double early = data->values[1][0], late = data->values[1][data->count - 1];
    if (!(early * late > 0.0))
        return dea_fail(error, DEA_ERR_INPUT, "the %s must keep its sign and not be 0",
                        kind == DEA_STEP_RELAXATION ? "stress" : "strain");
    return DEA_OK;
}

enum dea_status dea_fit_branches(enum dea_step_kind kind, const struct dea_columns *data, int count,
                                 struct dea_step_model *model, struct dea_fit *fit, struct dea_error *error) {
    DEA_TRY(check_data(kind, data, error));
    if (count < 0 || count > DEA_FIT_BRANCHES)
        return dea_fail(error, DEA_ERR_INPUT, "%d branches cannot be fitted; 1 to %d are allowed", count,
                        DEA_FIT_BRANCHES);
    if (count > 0) {
        struct step_problem problem = {kind, count};
        return fit_count(&problem, data, model, fit, error);
    }
    /* one more as long as it pays and the data determine it */
    struct step_problem problem = {kind, 1};
    DEA_TRY(fit_count(&problem, data, model, fit, error));
    for (problem.branches = 2; problem.branches <= DEA_FIT_BRANCHES; problem.branches++) {
        struct dea_step_model wider;
        struct dea_fit other;
        if (fit_count(&problem, data, &wider, &other, NULL) != DEA_OK)
            break;
        if (other.aicc < fit->aicc - WORTH_A_BRANCH && all_determined(&other)) {
            *model = wider;
            *fit = other;
        }
    }
    return DEA_OK;
}
