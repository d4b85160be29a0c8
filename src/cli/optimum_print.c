/* Text and JSON of `deasim optimum`. */
#include "cli/optimum_print.h"

#include "cli/json.h"

#include <math.h>
#include <stdio.h>

static const char *const method_names[] = {
    [DEA_OPTIMUM_GIVEN] = "given",
    [DEA_OPTIMUM_CLOSED] = "closed form",
    [DEA_OPTIMUM_SEARCH] = "search",
};

/* ---- text ---- */

static void print_key(const struct dea_optimum_task *task, const struct dea_optimum *optimum, enum dea_design_key key) {
    const struct dea_design_key_info *info = &dea_design_keys[key];
    double value = dea_design_get(&optimum->design, key);
    if (isnan(value))
        return;
    if (isinf(value))
        printf("  %-6s not given", info->name);
    else
        printf("  %-6s %.7g%s%s", info->name, value * info->factor, info->unit[0] != '\0' ? " " : "", info->unit);
    printf("%s%s\n", task->keys[key].free ? "  (chosen)" : "",
           optimum->at_bound[key] ? ", at the end of its range" : "");
}

static void print_end(const struct dea_optimum *optimum) {
    const struct dea_design_end *end = &optimum->end;
    bool dead_load = optimum->design.dead_load;
    printf("  displacement / %s %.7g\n", dead_load ? "active length" : "total length ", end->displacement);
    printf("  actuation stretch            %.7g\n", end->stretch);
    printf("  voltage                      %.7g V, true field %.6g V/um\n", end->voltage, end->true_field * 1e-6);
    printf("  ended by                     %s\n", dea_limit_names[end->mode]);
    printf("  stress along the motion      %.4f MPa active, %.4f MPa passive\n", end->stress1 * 1e-6,
           end->passive_stress1 * 1e-6);
    printf("  stress across, active        %.4f MPa\n", end->stress2 * 1e-6);
    if (optimum->slack_mode != DEA_LIMIT_NONE)
        printf("  static margin                tension would be lost (%s) at %.6g V, %.3f times the drive\n",
               dea_limit_names[optimum->slack_mode], optimum->slack_voltage, optimum->slack_voltage / end->voltage);
}

static void print_comparison(const struct dea_optimum *optimum, const struct optimum_comparison *comparison) {
    const struct dea_optimum *dead = &comparison->dead_load, *both = &comparison->both_ways;
    double gain = optimum->end.stretch - 1.0;
    printf("\ndead load instead of the passive membrane: stretch %.7g at lp1 %.6g, lp2 %.6g (%s)\n", dead->end.stretch,
           dead->design.prestretch[0], dead->design.prestretch[1], dea_limit_names[dead->end.mode]);
    printf("  the passive membrane costs a factor of %.4f in stretch - 1; %.4f at r_a 0.5\n",
           (dead->end.stretch - 1.0) / gain, (dead->end.stretch - 1.0) / (both->end.stretch - 1.0));
    printf("driven both ways at r_a 0.5: stroke / total length %.7g (+-%.7g) at lp1 %.6g, lp2 %.6g (%s)\n",
           both->stroke, 0.5 * both->stroke, both->design.prestretch[0], both->design.prestretch[1],
           dea_limit_names[both->end.mode]);
    printf("  that is %.4f times the one-way stroke\n", both->stroke / optimum->stroke);
}

static void print_transient(const char *name, const struct optimum_transient *transient) {
    printf("  %s: displacement peaks at %.4f times the static one, field at %.6g V/um", name, transient->peak_ratio,
           transient->peak_field * 1e-6);
    if (!isnan(transient->breakdown_ratio))
        printf(" (%.3f E_bd)", transient->breakdown_ratio);
    printf(",\n    least tension %.4g mN, least stress across %.4f MPa", transient->least_tension * 1e3,
           transient->least_stress2 * 1e-6);
    if (isnan(transient->first_time))
        printf("; no failure\n");
    else
        printf("; %s after %.4g ms.\n    Safe up to %.6g V, %.3f times the static voltage\n", transient->first_failure,
               transient->first_time * 1e3, transient->safe_voltage, transient->safe_voltage / transient->voltage);
}

static void print_dynamics(const struct optimum_dynamics *dynamics) {
    printf("\nswitched on (natural period %.4g ms)\n", dynamics->period * 1e3);
    print_transient("step", &dynamics->step);
    print_transient("ramp of one period", &dynamics->ramp);
}

void optimum_print(const struct dea_optimum_task *task, const struct dea_optimum *optimum,
                   const struct optimum_comparison *comparison, const struct optimum_dynamics *dynamics) {
    printf("%s (%s)\n", optimum->method == DEA_OPTIMUM_GIVEN ? "the given design" : "best design",
           method_names[optimum->method]);
    for (int key = 0; key < DEA_KEY_COUNT; key++)
        if (key != DEA_KEY_ACTIVE_RATIO || !optimum->design.dead_load)
            print_key(task, optimum, (enum dea_design_key)key);
    printf("reaches\n");
    if (task->both_ways)
        printf("  stroke / total length        %.7g\n", optimum->stroke);
    print_end(optimum);
    if (comparison != NULL)
        print_comparison(optimum, comparison);
    if (dynamics != NULL)
        print_dynamics(dynamics);
}

void optimum_print_sweep(const struct dea_optimum_task *task, const struct optimum_sweep *sweep) {
    const struct dea_design_key_info *info = &dea_design_keys[sweep->key];
    bool laws = sweep->key == DEA_KEY_JM && task->keys[DEA_KEY_PRESTRETCH2].free;
    char head[32];
    snprintf(head, sizeof head, "%s%s%s%s", info->name, info->unit[0] ? "[" : "", info->unit, info->unit[0] ? "]" : "");
    printf("%10s %9s %9s %9s %10s %10s %10s  %-10s", head, "r_a", "lp1", "lp2", task->both_ways ? "stroke" : "d",
           "stretch", "V[V]", "ended by");
    if (laws)
        printf(" %10s %10s", "eq.11 lp2", "exact lp2");
    putchar('\n');
    for (int i = 0; i < sweep->range.count; i++) {
        const struct dea_optimum *optimum = &sweep->optima[i];
        printf("%10.6g %9.6f %9.6f %9.6f %10.7f %10.7f %10.3f  %-10s", dea_range_value(&sweep->range, i) * info->factor,
               optimum->design.active_ratio, optimum->design.prestretch[0], optimum->design.prestretch[1],
               optimum->stroke, optimum->end.stretch, optimum->end.voltage, dea_limit_names[optimum->end.mode]);
        if (laws)
            printf(" %10.6f %10.6f", dea_rule_lp2(optimum->design.elastic.jm),
                   dea_exact_lp2(optimum->design.elastic.jm));
        putchar('\n');
    }
    if (laws)
        printf("eq.11: the empirical rule of Rosset et al. with its misprint corrected; exact: sqrt((Jm + 3)/3)\n");
}

/* ---- JSON ---- */

static bool fill_optimum(cJSON *object, const struct dea_optimum *optimum) {
    const struct dea_design_end *end = &optimum->end;
    bool good = cJSON_AddStringToObject(object, "method", method_names[optimum->method]) != NULL &&
                cli_json_number(object, "stroke", optimum->stroke);
    cJSON *design = cJSON_AddObjectToObject(object, "design");
    for (int key = 0; key < DEA_KEY_COUNT && good; key++)
        good = design != NULL && cli_json_number(design, dea_design_keys[key].name,
                                                 dea_design_get(&optimum->design, (enum dea_design_key)key));
    cJSON *reached = cJSON_AddObjectToObject(object, "end");
    good = good && reached != NULL && cJSON_AddStringToObject(reached, "mode", dea_limit_names[end->mode]) != NULL &&
           cli_json_number(reached, "displacement", end->displacement) &&
           cli_json_number(reached, "stretch", end->stretch) && cli_json_number(reached, "voltage", end->voltage) &&
           cli_json_number(reached, "true_field", end->true_field) &&
           cli_json_number(reached, "stress1", end->stress1) && cli_json_number(reached, "stress2", end->stress2) &&
           cli_json_number(reached, "passive_stress1", end->passive_stress1);
    cJSON *slack = cJSON_AddObjectToObject(object, "slack");
    return good && slack != NULL &&
           cJSON_AddStringToObject(slack, "mode", dea_limit_names[optimum->slack_mode]) != NULL &&
           cli_json_number(slack, "voltage", optimum->slack_voltage) &&
           cli_json_number(slack, "true_field", optimum->slack_field);
}

static bool add_optimum(cJSON *object, const char *key, const struct dea_optimum *optimum) {
    cJSON *child = cJSON_AddObjectToObject(object, key);
    return child != NULL && fill_optimum(child, optimum);
}

static bool add_transient(cJSON *object, const char *key, const struct optimum_transient *transient) {
    cJSON *child = cJSON_AddObjectToObject(object, key);
    return child != NULL && cli_json_number(child, "rise", transient->rise) &&
           cli_json_number(child, "peak_ratio", transient->peak_ratio) &&
           cli_json_number(child, "peak_field", transient->peak_field) &&
           cli_json_number(child, "breakdown_ratio", transient->breakdown_ratio) &&
           cli_json_number(child, "least_tension", transient->least_tension) &&
           cli_json_number(child, "least_stress2", transient->least_stress2) &&
           cJSON_AddStringToObject(child, "first_failure", transient->first_failure) != NULL &&
           cli_json_number(child, "first_time", transient->first_time) &&
           cli_json_number(child, "safe_voltage", transient->safe_voltage);
}

static bool add_dynamics(cJSON *root, const struct optimum_dynamics *dynamics) {
    cJSON *object = cJSON_AddObjectToObject(root, "dynamic");
    return object != NULL && cli_json_number(object, "period", dynamics->period) &&
           add_transient(object, "step", &dynamics->step) && add_transient(object, "ramp", &dynamics->ramp);
}

enum dea_status optimum_print_json(const struct dea_optimum *optimum, const struct optimum_comparison *comparison,
                                   const struct optimum_dynamics *dynamics, struct dea_error *error) {
    cJSON *root = cJSON_CreateObject();
    bool good = root != NULL && fill_optimum(root, optimum);
    if (comparison != NULL)
        good = good && add_optimum(root, "dead_load", &comparison->dead_load) &&
               add_optimum(root, "both_ways", &comparison->both_ways);
    if (dynamics != NULL)
        good = good && add_dynamics(root, dynamics);
    return cli_json_print(root, good, error);
}

enum dea_status optimum_print_sweep_json(const struct optimum_sweep *sweep, struct dea_error *error) {
    cJSON *root = cJSON_CreateObject();
    cJSON *points = cJSON_AddArrayToObject(root, "points");
    bool good = points != NULL && cJSON_AddStringToObject(root, "over", dea_design_keys[sweep->key].name) != NULL;
    for (int i = 0; i < sweep->range.count && good; i++) {
        cJSON *point = cJSON_CreateObject();
        good = point != NULL && cJSON_AddItemToArray(points, point) && fill_optimum(point, &sweep->optima[i]);
    }
    return cli_json_print(root, good, error);
}
