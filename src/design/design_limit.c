/* Where an increasing drive ends, fast: for stiffening laws every quantity that can fail is monotone along the taut
 * path, so the end of the path is known in closed form and each failure needs one root on a known bracket.
 * With eps and E_bd constant the balance is eps E^2 = lam_a (W1(lam_a) - W1(lam_p)), lam_p = lp1 - k (lam_a - lp1),
 * k = r_a/(1 - r_a); k = 0 is the dead load. */
#include "deasim/study.h"

#include "design/path.h"

#include <float.h>
#include <math.h>
#include <stddef.h>

#define RATIO_END 1e-9 /* r_a closer to 0 or 1 is taken as this far from it */
#define MAX_ITERATIONS 100
#define WALK_LENGTH 1e-2 /* any size does for the general walk, m */

/* The design with what does not change along the path. */
struct task {
    const struct dea_design *design;
    double ratio;        /* r_a kept off its ends; NAN with a dead load */
    double k;            /* -dlam_p/dlam_a */
    double permittivity; /* eps, F/m */
    double breakdown;    /* eps E_bd^2, Pa */
    double supply;       /* eps V_max^2 / (t0 lp1)^2, Pa; times lam_a^2 is the Maxwell stress the supply can give */
    bool has_supply;
};

/* One equilibrium. */
struct state {
    double lam_a, lam_p;
    struct dea_stress active, passive;
    double maxwell;       /* eps E^2, Pa */
    double maxwell_slope; /* by lam_a, Pa */
};

static enum dea_status evaluate(const struct task *task, double lam_a, double lam_p, struct state *state) {
    const struct dea_design *design = task->design;
    state->lam_a = lam_a;
    state->lam_p = lam_p;
    DEA_TRY(dea_law_stress(&design->elastic, lam_a, design->prestretch[1], &state->active));
    DEA_TRY(dea_law_stress(&design->elastic, lam_p, design->prestretch[1], &state->passive));
    double difference = state->active.w1 - state->passive.w1;
    state->maxwell = lam_a * difference;
    state->maxwell_slope = difference + lam_a * (state->active.w11 + task->k * state->passive.w11);
    return DEA_OK;
}

static double follow_passive(const struct task *task, double lam_a) {
    double lp1 = task->design->prestretch[0];
    return lp1 - task->k * (lam_a - lp1);
}

/* Stretch of the passive part at which its Cauchy stress has fallen to `tension`; the prestretch carries more. */
static enum dea_status find_relaxed(const struct dea_design *design, double *relaxed) {
    double low = 1.0 / sqrt(design->prestretch[1]), high = design->prestretch[0];
    *relaxed = low;
    if (design->least_tension == 0.0)
        return DEA_OK;
    for (int i = 0; i < MAX_ITERATIONS && high > nextafter(low, high); i++) {
        struct dea_stress stress;
        double middle = 0.5 * (low + high);
        DEA_TRY(dea_law_stress(&design->elastic, middle, design->prestretch[1], &stress));
        if (middle * stress.w1 < design->least_tension)
            low = middle;
        else
            high = middle;
    }
    *relaxed = high;
    return DEA_OK;
}

/* How far the Maxwell stress is past what breakdown and supply allow, with its slope by lam_a. */
static double excess(const struct task *task, const struct state *state, double *slope) {
    double cap = task->supply * state->lam_a * state->lam_a;
    if (task->has_supply && cap < task->breakdown) {
        *slope = state->maxwell_slope - 2.0 * task->supply * state->lam_a;
        return state->maxwell - cap;
    }
    *slope = state->maxwell_slope;
    return state->maxwell - task->breakdown;
}

/* Newton kept inside [low, high], where excess(low) < 0 <= excess(high); `state` enters as that of `high`. */
static enum dea_status find_cap(const struct task *task, double low, double high, struct state *state) {
    struct state start;
    double slope, lam = low;
    DEA_TRY(evaluate(task, low, low, &start));
    lam -= excess(task, &start, &slope) / start.maxwell_slope;
    for (int i = 0; i < MAX_ITERATIONS; i++) {
        if (!(lam > low && lam < high))
            lam = 0.5 * (low + high);
        DEA_TRY(evaluate(task, lam, follow_passive(task, lam), state));
        double value = excess(task, state, &slope);
        if (value < 0.0)
            low = lam;
        else
            high = lam;
        double next = lam - value / slope;
        if (fabs(next - lam) <= 2e-16 * lam || !(high > nextafter(low, high)))
            break;
        lam = next;
    }
    return DEA_OK;
}

/* Cauchy stress across the motion, the smaller of both parts. */
static double least_stress2(const struct task *task, const struct state *state) {
    double lp2 = task->design->prestretch[1];
    return fmin(lp2 * state->active.w2 - state->maxwell, lp2 * state->passive.w2);
}

/* First loss of tension across, between rest (positive) and `state` (negative): Illinois rule, then exact sign. */
static enum dea_status find_slack2(const struct task *task, struct state *state) {
    double low = task->design->prestretch[0], high = state->lam_a;
    struct state probe;
    DEA_TRY(evaluate(task, low, low, &probe));
    double at_low = least_stress2(task, &probe), at_high = least_stress2(task, state);
    int side = 0;
    for (int i = 0; i < MAX_ITERATIONS && high > nextafter(low, high); i++) {
        double lam = (at_low * high - at_high * low) / (at_low - at_high);
        if (!(lam > low && lam < high))
            lam = 0.5 * (low + high);
        DEA_TRY(evaluate(task, lam, follow_passive(task, lam), &probe));
        double value = least_stress2(task, &probe);
        if (value < 0.0) {
            if (side == -1)
                at_low *= 0.5;
            high = lam;
            at_high = value;
            side = -1;
        } else {
            if (side == +1)
                at_high *= 0.5;
            low = lam;
            at_low = value;
            side = +1;
        }
        *state = probe;
        if (fabs(value) <= 1e-16 * probe.maxwell || high - low <= 2e-16 * lam)
            break;
    }
    return DEA_OK;
}

/* Stretch at which the law's margin falls to DEA_LAW_MARGIN_LIMIT; INFINITY without a limit. */
static double law_end(const struct dea_design *design) {
    const struct dea_law *law = &design->elastic;
    double largest; /* I1 there */
    if (law->kind == DEA_GENT)
        largest = 3.0 + law->jm * (1.0 - DEA_LAW_MARGIN_LIMIT);
    else if (law->kind == DEA_ARRUDA_BOYCE)
        largest = 3.0 * law->locking_stretch * law->locking_stretch * (1.0 - DEA_LAW_MARGIN_LIMIT);
    else
        return INFINITY;
    /* lam^4 - (I1 - lp2^2) lam^2 + lp2^-2 = 0 */
    double square = design->prestretch[1] * design->prestretch[1], half = 0.5 * (largest - square);
    double discriminant = half * half - 1.0 / square;
    return discriminant > 0.0 ? sqrt(half + sqrt(discriminant)) : 0.0;
}

static void report(const struct task *task, enum dea_limit_mode mode, const struct state *state,
                   struct dea_design_end *end) {
    const struct dea_design *design = task->design;
    double lp1 = design->prestretch[0];
    end->mode = mode;
    end->lam_active = state->lam_a;
    end->lam_passive = state->lam_p;
    end->stretch = state->lam_a / lp1;
    end->displacement = (design->dead_load ? 1.0 : task->ratio) * (state->lam_a - lp1) / lp1;
    /* at breakdown the field is known, and better than from a stretch rounded to a double */
    end->true_field =
        mode == DEA_LIMIT_BREAKDOWN ? design->dielectric.breakdown : sqrt(state->maxwell / task->permittivity);
    end->voltage = end->true_field * design->thickness * lp1 / state->lam_a;
    end->stress1 = state->lam_a * state->passive.w1;
    end->stress2 = design->prestretch[1] * state->active.w2 - state->maxwell;
    end->passive_stress1 = state->lam_p * state->passive.w1;
}

static enum dea_status limit_stiffening(const struct dea_design *design, struct dea_design_end *end) {
    double lp1 = design->prestretch[0], ratio = fmin(fmax(design->active_ratio, RATIO_END), 1.0 - RATIO_END);
    double permittivity = DEA_VACUUM_PERMITTIVITY * design->dielectric.permittivity;
    double per_voltage = 1.0 / (design->thickness * lp1), field = design->dielectric.breakdown;
    struct task task = {.design = design,
                        .ratio = ratio,
                        .k = design->dead_load ? 0.0 : ratio / (1.0 - ratio),
                        .permittivity = permittivity,
                        .breakdown = permittivity * field * field,
                        .has_supply = isfinite(design->max_voltage)};
    if (task.has_supply)
        task.supply = permittivity * design->max_voltage * design->max_voltage * per_voltage * per_voltage;

    /* the far end of the taut path: both parts lose tension together, or the law ends */
    double relaxed, lam_end = law_end(design);
    DEA_TRY(find_relaxed(design, &relaxed));
    double lam_a = design->dead_load ? INFINITY : lp1 + (lp1 - relaxed) / task.k, lam_p = relaxed;
    enum dea_limit_mode mode = DEA_LIMIT_SLACK1;
    if (lam_end <= lam_a) {
        mode = DEA_LIMIT_LAW;
        lam_a = fmax(lam_end, lp1);
        lam_p = follow_passive(&task, lam_a);
    }
    if (!isfinite(lam_a)) { /* neo-Hookean under a dead load: stress2 ends it, lam1 = lp2 is already past that */
        lam_a = 1e3 * fmax(lp1, design->prestretch[1]);
        lam_p = lp1;
        mode = DEA_LIMIT_NONE;
    }
    struct state state;
    DEA_TRY(evaluate(&task, lam_a, lam_p, &state));

    /* what comes before it */
    double slope;
    if (lam_a > lp1 && excess(&task, &state, &slope) >= 0.0) {
        DEA_TRY(find_cap(&task, lp1, lam_a, &state));
        bool supplied = task.has_supply && task.supply * state.lam_a * state.lam_a < task.breakdown;
        mode = supplied ? DEA_LIMIT_SUPPLY : DEA_LIMIT_BREAKDOWN;
    }
    if (least_stress2(&task, &state) < 0.0) {
        DEA_TRY(find_slack2(&task, &state));
        mode = DEA_LIMIT_SLACK2;
    }
    report(&task, mode, &state, end);
    return DEA_OK;
}

/* The general walk along the path of a device of this design. */
static enum dea_status limit_any(const struct dea_design *design, struct dea_design_end *end, struct dea_error *error) {
    struct dea_design inner = *design;
    inner.active_ratio = fmin(fmax(design->active_ratio, RATIO_END), 1.0 - RATIO_END);
    struct dea_device device;
    struct dea_limit limit;
    struct dea_static_point point;
    DEA_TRY(dea_design_to_device(&inner, WALK_LENGTH, WALK_LENGTH, false, &device, error));
    DEA_TRY(dea_find_limit(&device, 0.0, design->least_tension, &limit, error));
    end->mode = limit.mode;
    if (isnan(limit.voltage))
        return DEA_OK;
    double voltages[DEA_ZONES] = {limit.voltage, 0.0};
    if (limit.voltage > design->max_voltage) {
        end->mode = DEA_LIMIT_SUPPLY;
        voltages[0] = design->max_voltage;
    }
    DEA_TRY(dea_static_solve(&device, voltages, &point, error));
    if (end->mode != DEA_LIMIT_SUPPLY)
        point.x = limit.x;
    end->lam_active = dea_zone_stretch(&device, 0, point.x);
    end->stretch = end->lam_active / design->prestretch[0];
    end->displacement = point.x / WALK_LENGTH;
    end->voltage = voltages[0];
    end->true_field = dea_zone_field(&device, end->voltage, end->lam_active);
    end->stress1 = point.zones[0].stress1;
    end->stress2 = point.zones[0].stress2;
    end->lam_passive = design->dead_load ? design->prestretch[0] : dea_zone_stretch(&device, 1, point.x);
    struct dea_stress passive;
    if (dea_law_stress(&design->elastic, end->lam_passive, design->prestretch[1], &passive) != DEA_OK)
        return dea_fail(error, DEA_ERR_INTERNAL, "the passive part left its elastic law");
    end->passive_stress1 = end->lam_passive * passive.w1;
    return DEA_OK;
}

/* The prestretch carries the least tension, when one is asked for. */
static bool keeps_tension_at_rest(const struct dea_design *design) {
    struct dea_stress rest;
    double lp1 = design->prestretch[0];
    return design->least_tension == 0.0 ||
           (dea_law_stress(&design->elastic, lp1, design->prestretch[1], &rest) == DEA_OK &&
            lp1 * rest.w1 > design->least_tension);
}

static enum dea_status check_positive(enum dea_design_key key, double value, double bound, struct dea_error *error) {
    if (value > 0.0 && value <= bound)
        return DEA_OK;
    return dea_fail(error, DEA_ERR_INPUT, "%s = %g is not possible; it must be positive", dea_design_keys[key].name,
                    value);
}

static enum dea_status check_design(const struct dea_design *design, struct dea_error *error) {
    const struct dea_law *law = &design->elastic;
    if (!(design->active_ratio >= 0.0 && design->active_ratio <= 1.0))
        return dea_fail(error, DEA_ERR_INPUT, "r_a = %g is not possible; it must be between 0 and 1",
                        design->active_ratio);
    DEA_TRY(check_positive(DEA_KEY_PRESTRETCH1, design->prestretch[0], DBL_MAX, error));
    DEA_TRY(check_positive(DEA_KEY_PRESTRETCH2, design->prestretch[1], DBL_MAX, error));
    DEA_TRY(check_positive(DEA_KEY_BREAKDOWN, design->dielectric.breakdown, INFINITY, error));
    DEA_TRY(check_positive(DEA_KEY_PERMITTIVITY, design->dielectric.permittivity, DBL_MAX, error));
    DEA_TRY(check_positive(DEA_KEY_THICKNESS, design->thickness, DBL_MAX, error));
    if (law->kind == DEA_GENT)
        DEA_TRY(check_positive(DEA_KEY_JM, law->jm, DBL_MAX, error));
    if (law->kind != DEA_YEOH && law->kind != DEA_OGDEN)
        DEA_TRY(check_positive(DEA_KEY_MODULUS, law->mu, DBL_MAX, error));
    if (!(design->least_tension >= 0.0 && isfinite(design->least_tension)))
        return dea_fail(error, DEA_ERR_INPUT, "the least tension must not be negative, but is %g Pa",
                        design->least_tension);
    if (!(design->max_voltage > 0.0))
        return dea_fail(error, DEA_ERR_INPUT, "the largest voltage must be positive, not %g V", design->max_voltage);
    return DEA_OK;
}

enum dea_status dea_design_limit(const struct dea_design *design, struct dea_design_end *end, struct dea_error *error) {
    *end = (struct dea_design_end){DEA_LIMIT_NONE, NAN, NAN, NAN, NAN, NAN, NAN, NAN, NAN, NAN};
    DEA_TRY(check_design(design, error));
    const struct dea_dielectric *dielectric = &design->dielectric;
    double lp1 = design->prestretch[0], lp2 = design->prestretch[1];
    if (!(dea_law_margin(&design->elastic, lp1, lp2) > 0.0) || lp1 * lp1 * lp2 <= 1.0 || lp1 * lp2 * lp2 <= 1.0 ||
        !keeps_tension_at_rest(design)) {
        end->mode = DEA_LIMIT_PRESTRETCH;
        return DEA_OK;
    }
    bool stiffening = design->elastic.kind != DEA_YEOH && design->elastic.kind != DEA_OGDEN;
    bool constant = dielectric->permittivity_slope == 0.0 && dielectric->breakdown_thickness_exponent == 0.0 &&
                    dielectric->breakdown_stretch_exponent == 0.0;
    if (!stiffening || !constant)
        return limit_any(design, end, error);
    if (limit_stiffening(design, end) != DEA_OK)
        return dea_fail(error, DEA_ERR_INTERNAL, "the path of a design left its elastic law");
    return DEA_OK;
}
