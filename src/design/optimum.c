/* Which way finds the optimum, and the search where no closed form holds. */
#include "deasim/optimum.h"

#include "design/search_library.h"

#include <math.h>
#include <string.h>

#define GRID_DESIGNS 20000 /* designs looked at before the search refines the best one */
#define SLOW_GRID_DESIGNS 2000
#define XTOL 1e-11 /* of a range */
#define MAX_EVALUATIONS 20000
#define MAX_ROUNDS 20
#define FIRST_WINDOW 1e-4  /* half of what the outermost line search looks at, of a range */
#define WINDOW_GROWTH 10.0 /* inner ones look farther: the ridge may run steeply */
#define AGREEMENT 1e-9

/* Failed designs rank below every working one. */
#define WORTHLESS (-1.0)

static bool closed_form_holds(const struct dea_design *design) {
    const struct dea_dielectric *dielectric = &design->dielectric;
    return design->elastic.kind != DEA_YEOH && design->elastic.kind != DEA_OGDEN && isinf(design->max_voltage) &&
           isfinite(dielectric->breakdown) && dielectric->permittivity_slope == 0.0 &&
           dielectric->breakdown_thickness_exponent == 0.0 && dielectric->breakdown_stretch_exponent == 0.0;
}

/* Displacement, or the sum of both directions. */
static enum dea_status find_stroke(const struct dea_optimum_task *task, const struct dea_design *design,
                                   struct dea_design_end *end, double *stroke, struct dea_error *error) {
    DEA_TRY(dea_design_limit(design, end, error));
    *stroke = end->mode == DEA_LIMIT_PRESTRETCH ? NAN : end->displacement;
    if (!task->both_ways || isnan(*stroke))
        return DEA_OK;
    struct dea_design mirrored = *design;
    struct dea_design_end other;
    mirrored.active_ratio = 1.0 - design->active_ratio;
    DEA_TRY(dea_design_limit(&mirrored, &other, error));
    *stroke += other.displacement;
    return DEA_OK;
}

/* ---- closed forms ---- */

static bool in_range(const struct dea_optimum_task *task, enum dea_design_key key, double value) {
    return !task->keys[key].ranged || (value >= task->keys[key].low && value <= task->keys[key].high);
}

/* lp1 free, with any of r_a and (for Gent, without a tension to be kept) lp2. False when no closed form applies. */
static bool try_closed_form(const struct dea_optimum_task *task, struct dea_design *design) {
    bool lp2_free = task->keys[DEA_KEY_PRESTRETCH2].free, r_free = task->keys[DEA_KEY_ACTIVE_RATIO].free;
    for (int key = 0; key < DEA_KEY_COUNT; key++)
        if (task->keys[key].free && key != DEA_KEY_ACTIVE_RATIO && key != DEA_KEY_PRESTRETCH1 &&
            key != DEA_KEY_PRESTRETCH2)
            return false;
    if (!task->keys[DEA_KEY_PRESTRETCH1].free || !closed_form_holds(&task->base) ||
        (task->both_ways && (r_free || task->base.active_ratio != 0.5)))
        return false;
    *design = task->base;
    if (lp2_free && (design->elastic.kind != DEA_GENT || design->least_tension > 0.0))
        return false;
    if (lp2_free)
        design->prestretch[1] = dea_exact_lp2(design->elastic.jm);

    double lam_a, lam_p;
    if (dea_optimum_pair(design, &lam_a, &lam_p) != DEA_OK)
        return false;
    if (r_free && !design->dead_load)
        design->active_ratio = 1.0 / (1.0 + sqrt(lam_a / lam_p));
    double r = design->dead_load ? 0.0 : design->active_ratio;
    design->prestretch[0] = r * lam_a + (1.0 - r) * lam_p;

    /* the pair must be where the drive really ends: not when direction 2 fails first or a range forbids it */
    struct dea_design_end end;
    return dea_design_limit(design, &end, NULL) == DEA_OK && fabs(end.lam_active - lam_a) <= AGREEMENT * lam_a &&
           fabs(end.lam_passive - lam_p) <= AGREEMENT * lam_p && in_range(task, DEA_KEY_ACTIVE_RATIO, r) &&
           in_range(task, DEA_KEY_PRESTRETCH1, design->prestretch[0]) &&
           in_range(task, DEA_KEY_PRESTRETCH2, design->prestretch[1]);
}

/* ---- search ---- */

struct search {
    const struct dea_optimum_task *task;
    enum dea_design_key keys[DEA_KEY_COUNT]; /* the free ones */
    unsigned count;
};

static struct dea_design design_at(const struct search *search, const double *place) {
    struct dea_design design = search->task->base;
    for (unsigned i = 0; i < search->count; i++) {
        double low = search->task->keys[search->keys[i]].low, high = search->task->keys[search->keys[i]].high;
        double value = fmin(fmax(low + place[i] * (high - low), low), high);
        (void)dea_design_set(&design, search->keys[i], value, NULL); /* keys were checked */
    }
    return design;
}

static double worth(unsigned count, const double *place, double *gradient, void *context) {
    const struct search *search = context;
    struct dea_design design = design_at(search, place);
    struct dea_design_end end;
    double stroke;
    (void)count;
    (void)gradient;
    if (find_stroke(search->task, &design, &end, &stroke, NULL) != DEA_OK || isnan(stroke))
        return WORTHLESS;
    return stroke;
}

/* Best point of a regular grid over the ranges, cell centres. */
static double scan_grid(struct search *search, double best[DEA_KEY_COUNT]) {
    double budget = closed_form_holds(&search->task->base) ? GRID_DESIGNS : SLOW_GRID_DESIGNS, most = WORTHLESS;
    int side = (int)pow(budget, 1.0 / search->count);
    long all = 1;
    for (unsigned i = 0; i < search->count; i++)
        all *= side;
    for (long n = 0; n < all; n++) {
        double place[DEA_KEY_COUNT];
        long rest = n;
        for (unsigned i = 0; i < search->count; i++, rest /= side)
            place[i] = ((double)(rest % side) + 0.5) / side;
        double value = worth(search->count, place, NULL, search);
        if (value > most) {
            most = value;
            memcpy(best, place, sizeof place);
        }
    }
    return most;
}

/* One run of a search without gradients, which jump where the failure mode changes; *value is only ever raised. */
static enum dea_status climb(struct search *search, nlopt_algorithm algorithm, double step, double place[DEA_KEY_COUNT],
                             double *value, struct dea_error *error) {
    struct search_library nlopt;
    DEA_TRY(search_library_load(&nlopt, error));
    nlopt_opt engine = nlopt.create(algorithm, search->count);
    if (engine == NULL)
        return dea_fail(error, DEA_ERR_MEMORY, "out of memory for the search");
    double tried[DEA_KEY_COUNT], reached;
    memcpy(tried, place, sizeof tried);
    bool good = nlopt.set_max_objective(engine, worth, search) > 0 && nlopt.set_lower_bounds1(engine, 0.0) > 0 &&
                nlopt.set_upper_bounds1(engine, 1.0) > 0 && nlopt.set_initial_step1(engine, step) > 0 &&
                nlopt.set_xtol_abs1(engine, XTOL) > 0 && nlopt.set_maxeval(engine, MAX_EVALUATIONS) > 0;
    nlopt_result result = good ? nlopt.optimize(engine, tried, &reached) : NLOPT_FAILURE;
    nlopt.destroy(engine);
    if (result <= 0 && result != NLOPT_ROUNDOFF_LIMITED)
        return dea_fail(error, DEA_ERR_SOLVER, "the search for the optimum failed (%s)",
                        nlopt.result_to_string(result));
    if (reached > *value) {
        *value = reached;
        memcpy(place, tried, sizeof tried);
    }
    return DEA_OK;
}

/* A design and what it is worth. */
struct trial {
    double place[DEA_KEY_COUNT], value;
};

static void polish(struct search *search, unsigned k, struct trial *trial);

/* Puts variable k at `at` and lets the variables behind it follow. */
static struct trial look(struct search *search, unsigned k, const struct trial *from, double at) {
    struct trial trial = *from;
    trial.place[k] = at;
    if (k + 1 == search->count)
        trial.value = worth(search->count, trial.place, NULL, search);
    else
        polish(search, k + 1, &trial);
    return trial;
}

/* Golden section along variable k of the best over all variables behind it: where two failure modes meet the stroke
 * has a ridge with a kink, on which simplex methods stall but nested line searches do not. */
static void polish(struct search *search, unsigned k, struct trial *trial) {
    const double golden = 0.61803398874989485;
    double window = FIRST_WINDOW * pow(WINDOW_GROWTH, k);
    double low = fmax(trial->place[k] - window, 0.0), high = fmin(trial->place[k] + window, 1.0);
    struct trial left = look(search, k, trial, high - golden * (high - low));
    struct trial right = look(search, k, trial, low + golden * (high - low));
    while (high - low > XTOL) {
        if (left.value >= right.value) {
            high = right.place[k];
            right = left;
            left = look(search, k, &right, high - golden * (high - low));
        } else {
            low = left.place[k];
            left = right;
            right = look(search, k, &left, low + golden * (high - low));
        }
    }
    *trial = left.value >= right.value ? left : right;
}

/* Subplex and Nelder-Mead in turn, from coarse to fine steps, then line searches, until a whole round gains nothing. */
static enum dea_status refine(struct search *search, double place[DEA_KEY_COUNT], double value,
                              struct dea_error *error) {
    bool affordable = closed_form_holds(&search->task->base) || isfinite(search->task->base.max_voltage);
    for (int round = 0; round < MAX_ROUNDS; round++) {
        double before = value;
        for (double step = 0.1; step > 1e-5; step *= 0.1) {
            DEA_TRY(climb(search, NLOPT_LN_SBPLX, step, place, &value, error));
            DEA_TRY(climb(search, NLOPT_LN_NELDERMEAD, 0.7 * step, place, &value, error));
        }
        if (search->count <= (affordable ? 3U : 1U)) {
            struct trial trial = {.value = value};
            memcpy(trial.place, place, sizeof trial.place);
            polish(search, 0, &trial);
            if (trial.value > value) {
                value = trial.value;
                memcpy(place, trial.place, sizeof trial.place);
            }
        }
        if (value - before <= 1e-13 * fabs(value))
            break;
    }
    return DEA_OK;
}

/* Widest sensible range of a free key. */
static enum dea_status choose_range(struct dea_optimum_task *task, enum dea_design_key key, struct dea_error *error) {
    const struct dea_law *law = &task->base.elastic;
    double stretch = law->kind == DEA_GENT           ? sqrt(law->jm + 3.0)
                     : law->kind == DEA_ARRUDA_BOYCE ? sqrt(3.0) * law->locking_stretch
                                                     : 6.0;
    double *low = &task->keys[key].low, *high = &task->keys[key].high;
    if (task->keys[key].ranged) {
        if (!(*high > *low))
            return dea_fail(error, DEA_ERR_INPUT, "the range of %s is empty", dea_design_keys[key].name);
        return DEA_OK;
    }
    switch (key) {
    case DEA_KEY_ACTIVE_RATIO:
        *low = 0.0;
        *high = 1.0;
        return DEA_OK;
    case DEA_KEY_PRESTRETCH1:
    case DEA_KEY_PRESTRETCH2:
        *low = 1.0 / sqrt(stretch);
        *high = stretch;
        return DEA_OK;
    default:
        return dea_fail(error, DEA_ERR_INPUT, "%s is a property of the material; give it a range to choose from",
                        dea_design_keys[key].name);
    }
}

static enum dea_status search_best(struct dea_optimum_task *task, struct dea_optimum *optimum,
                                   struct dea_error *error) {
    struct search search = {.task = task};
    double place[DEA_KEY_COUNT];
    for (int key = 0; key < DEA_KEY_COUNT; key++) {
        if (!task->keys[key].free)
            continue;
        DEA_TRY(choose_range(task, (enum dea_design_key)key, error));
        search.keys[search.count++] = (enum dea_design_key)key;
    }
    double value = scan_grid(&search, place);
    if (value <= WORTHLESS)
        return dea_fail(error, DEA_ERR_INPUT, "no design in these ranges survives its prestretch");
    DEA_TRY(refine(&search, place, value, error));
    optimum->design = design_at(&search, place);
    for (unsigned i = 0; i < search.count; i++)
        optimum->at_bound[search.keys[i]] = place[i] < 1e-7 || place[i] > 1.0 - 1e-7;
    return DEA_OK;
}

/* ---- the task ---- */

/* Where tension would be lost if neither breakdown nor the supply ended the drive. */
static enum dea_status find_margin(struct dea_optimum *optimum, struct dea_error *error) {
    struct dea_design design = optimum->design;
    struct dea_design_end end;
    design.dielectric.breakdown = INFINITY;
    design.max_voltage = INFINITY;
    design.least_tension = 0.0;
    optimum->slack_mode = DEA_LIMIT_NONE;
    optimum->slack_voltage = optimum->slack_field = NAN;
    DEA_TRY(dea_design_limit(&design, &end, error));
    if (end.mode == DEA_LIMIT_SLACK1 || end.mode == DEA_LIMIT_SLACK2) {
        optimum->slack_mode = end.mode;
        optimum->slack_voltage = end.voltage;
        optimum->slack_field = end.true_field;
    }
    return DEA_OK;
}

static enum dea_status check_task(const struct dea_optimum_task *task, struct dea_error *error) {
    for (int key = 0; key < DEA_KEY_COUNT; key++)
        if (task->keys[key].free && isnan(dea_design_get(&task->base, (enum dea_design_key)key)))
            return dea_fail(error, DEA_ERR_INPUT, "a %s film has no parameter %s",
                            dea_law_name(task->base.elastic.kind), dea_design_keys[key].name);
    if (task->both_ways && task->base.dead_load)
        return dea_fail(error, DEA_ERR_INPUT, "a dead load cannot be driven the other way");
    if (task->base.dead_load && task->keys[DEA_KEY_ACTIVE_RATIO].free)
        return dea_fail(error, DEA_ERR_INPUT, "with a dead load there is no r_a to choose");
    if (task->keys[DEA_KEY_THICKNESS].free && isinf(task->base.max_voltage))
        return dea_fail(error, DEA_ERR_INPUT, "the thickness matters only when the supply is limited");
    if (task->keys[DEA_KEY_THICKNESS].free &&
        (task->keys[DEA_KEY_THICKNESS].ranged || task->base.dielectric.breakdown_thickness_exponent != 0.0))
        return dea_fail(
            error, DEA_ERR_INPUT,
            "t0 is chosen last, as the thickest film the supply can drive to the end; that needs a breakdown "
            "field that does not depend on it, and no range");
    return DEA_OK;
}

/* Stretches and fields do not depend on the thickness, voltages are proportional to it: the best film is one the supply
 * can drive to the end, the thickest of them. */
static enum dea_status find_with_thickness(const struct dea_optimum_task *task, struct dea_optimum *optimum,
                                           struct dea_error *error) {
    struct dea_optimum_task inner = *task;
    inner.keys[DEA_KEY_THICKNESS].free = false;
    inner.base.max_voltage = INFINITY;
    DEA_TRY(dea_optimum_find(&inner, optimum, error));
    double scale = task->base.max_voltage / optimum->end.voltage;
    optimum->design.thickness *= scale;
    optimum->end.voltage = optimum->design.max_voltage = task->base.max_voltage;
    optimum->slack_voltage *= scale;
    return DEA_OK;
}

enum dea_status dea_optimum_find(const struct dea_optimum_task *task, struct dea_optimum *optimum,
                                 struct dea_error *error) {
    struct dea_optimum_task own = *task;
    *optimum = (struct dea_optimum){.design = task->base, .method = DEA_OPTIMUM_GIVEN};
    DEA_TRY(check_task(task, error));
    if (task->keys[DEA_KEY_THICKNESS].free)
        return find_with_thickness(task, optimum, error);
    bool any = false;
    for (int key = 0; key < DEA_KEY_COUNT; key++)
        any = any || task->keys[key].free;
    if (any && try_closed_form(task, &optimum->design)) {
        optimum->method = DEA_OPTIMUM_CLOSED;
    } else if (any) {
        optimum->method = DEA_OPTIMUM_SEARCH;
        DEA_TRY(search_best(&own, optimum, error));
    }
    DEA_TRY(find_stroke(task, &optimum->design, &optimum->end, &optimum->stroke, error));
    if (isnan(optimum->stroke))
        return dea_fail(error, DEA_ERR_INPUT, "this design fails by its prestretch alone");
    return find_margin(optimum, error);
}
