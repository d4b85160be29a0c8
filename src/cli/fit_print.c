/* Text and JSON of `deasim fit`. */
#include "cli/fit_print.h"

#include "deasim/quantity.h"

#include "cli/json.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* ---- text ---- */

static const char *format(double value, const char *si_unit, char *buffer, int size) {
    if (strcmp(si_unit, "1") == 0)
        snprintf(buffer, (size_t)size, "%.5g", value);
    else
        dea_quantity_format(value, si_unit, buffer, size);
    return buffer;
}

static void print_parameter(const struct dea_fit_parameter *p) {
    char value[64], low[64], high[64];
    printf("  %-15s %-12s", p->name, format(p->value, p->si_unit, value, sizeof value));
    if (isfinite(p->low) && isfinite(p->high))
        printf(" 95 %% interval %s to %s%s\n", format(p->low, p->si_unit, low, sizeof low),
               format(p->high, p->si_unit, high, sizeof high),
               p->determined ? "" : "  (hardly determined by these data)");
    else
        printf(" not determined by these data\n");
}

static void print_law(const struct dea_law *law) {
    printf("elastic: {law: %s", dea_law_name(law->kind));
    if (law->kind == DEA_GENT || law->kind == DEA_NEO_HOOKEAN || law->kind == DEA_ARRUDA_BOYCE)
        printf(", mu: %.6g MPa", law->mu * 1e-6);
    if (law->kind == DEA_GENT)
        printf(", jm: %.6g", law->jm);
    if (law->kind == DEA_ARRUDA_BOYCE)
        printf(", locking_stretch: %.6g", law->locking_stretch);
    for (int i = 0; i < law->yeoh_terms; i++)
        printf(", c%d0: %.6g kPa", i + 1, law->yeoh[i] * 1e-3);
    if (law->kind == DEA_OGDEN)
        for (int i = 0; i < law->ogden_terms; i++)
            printf("%s{mu: %.6g kPa, alpha: %.6g}%s", i == 0 ? ", terms: [" : ", ", law->ogden_mu[i] * 1e-3,
                   law->ogden_alpha[i], i + 1 == law->ogden_terms ? "]" : "");
    printf("}\n");
}

static void print_branches(const struct fit_answer *answer) {
    const struct dea_step_model *model = &answer->model;
    if (answer->mu == 0.0) {
        printf("with --mu MU the branch moduli are written for a material file (mu_b = ratio MU)\n");
        return;
    }
    printf("branches:\n");
    for (int i = 0; i < model->count; i++)
        printf("  - {kind: foo, mu: %.6g kPa, tau: %.6g s}\n", model->ratio[i] * answer->mu * 1e-3, model->tau[i]);
}

void fit_print(const struct fit_answer *answer) {
    const struct dea_fit *fit = &answer->fit;
    char residual[64];
    const char *unit = answer->branches && answer->model.kind == DEA_STEP_CREEP ? "1" : "Pa";
    printf("%s: %s, %zu points\n", answer->path,
           !answer->branches                           ? dea_law_name(answer->law.kind)
           : answer->model.kind == DEA_STEP_RELAXATION ? "relaxation"
                                                       : "creep",
           fit->points);
    for (int i = 0; i < fit->count; i++)
        print_parameter(&fit->parameters[i]);
    printf("  data scatter by %s about the fit, R^2 %.6f\n", format(fit->residual, unit, residual, sizeof residual),
           fit->r_squared);
    bool determined = true;
    for (int i = 0; i < fit->count; i++)
        determined = determined && fit->parameters[i].determined;
    if (!determined)
        printf("  the data do not carry that many parameters: take fewer %s, or test over a wider range\n",
               answer->branches ? "branches" : "terms or a simpler law");
    if (answer->branches)
        print_branches(answer);
    else
        print_law(&answer->law);
}

/* ---- JSON ---- */

static bool fill_json(cJSON *root, const struct fit_answer *answer) {
    const struct dea_fit *fit = &answer->fit;
    const char *model = !answer->branches                           ? dea_law_name(answer->law.kind)
                        : answer->model.kind == DEA_STEP_RELAXATION ? "relaxation"
                                                                    : "creep";
    bool good = cJSON_AddStringToObject(root, "model", model) != NULL;
    cJSON *parameters = cJSON_AddObjectToObject(root, "parameters");
    good = good && parameters != NULL;
    for (int i = 0; i < fit->count && good; i++) {
        const struct dea_fit_parameter *p = &fit->parameters[i];
        cJSON *object = cJSON_AddObjectToObject(parameters, p->name);
        good = object != NULL && cli_json_number(object, "value", p->value) && cli_json_number(object, "low", p->low) &&
               cli_json_number(object, "high", p->high) &&
               cJSON_AddStringToObject(object, "unit", p->si_unit) != NULL &&
               cJSON_AddBoolToObject(object, "determined", p->determined) != NULL;
    }
    return good && cli_json_number(root, "points", (double)fit->points) &&
           cli_json_number(root, "residual", fit->residual) && cli_json_number(root, "r_squared", fit->r_squared) &&
           cli_json_number(root, "aicc", fit->aicc);
}

enum dea_status fit_print_json(const struct fit_answer *answer, struct dea_error *error) {
    cJSON *root = cJSON_CreateObject();
    return cli_json_print(root, root != NULL && fill_json(root, answer), error);
}
