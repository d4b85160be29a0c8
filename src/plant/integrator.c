/* SUNDIALS IDA around the plant: set-up, steps, restarts, statistics, and words for its failures. */
#include "plant/integrator.h"
#include "plant/amplifier.h"
#include "plant/network.h"
#include "plant/vectors.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Newton's iterations stop at this part of the step's tolerance: leftovers of 0.33, IDA's own, were seen as noise that
 * cost steps (measured with tests/stress/accuracy: a fifth more steps for half the residuals saved). */
#define NEWTON_PART 0.05

#define MAX_TEST_FAILURES 30 /* of one step: a film short or a corner may need one far shorter than the last */
/* At rest for so many steps, each a good part of the natural period (in radians): see note_quiet. The swing left over,
 * and the one that ends the quiet, are in units of the step's tolerance. */
#define QUIET_STEPS 40
#define QUIET_SWING 100.0
#define WAKING_SWING 1000.0
#define SHORT_STEP 0.05
#define LONG_STEP 5.0

#define MAX_STANDSTILL 200  /* steps without progress in time */
#define RECENT 1e-9         /* part of the time reached for which a refused state still explains a failure */
#define CRAWL_STEPS 2000    /* so many steps in a row ... */
#define CRAWL_ADVANCE 1e-11 /* ... that advance by less than this part of the time reached will never end */

/* ---- set-up ---- */

/* IDA's own messages would go to stderr; the status codes say the same. */
static void drop_message(int code, const char *module, const char *function, char *message, void *context) {
    (void)code, (void)module, (void)function, (void)message, (void)context;
}

static bool make_vectors(struct dea_plant *plant) {
    sunindextype n = plant->state_count;
    N_Vector *vectors[] = {&plant->y,        &plant->yp,        &plant->id,     &plant->rates,
                           &plant->sample_y, &plant->sample_yp, &plant->kept_yp};
    for (size_t i = 0; i < sizeof vectors / sizeof vectors[0]; i++) {
        *vectors[i] = plant_new_vector(n, plant->context);
        if (*vectors[i] == NULL)
            return false;
    }
    plant->quad = plant_new_vector(LOSS_COUNT, plant->context);
    plant->sample_quad = plant_new_vector(LOSS_COUNT, plant->context);
    if (plant->quad == NULL || plant->sample_quad == NULL)
        return false;
    N_VConst(1.0, plant->id);
    if (plant->motion == MOTION_ALGEBRAIC)
        NV_DATA_S(plant->id)[plant->x] = 0.0;
    return true;
}

static enum dea_status set_up_ida(struct dea_plant *plant, struct dea_error *error) {
    void *ida = plant->ida = IDACreate(plant->context);
    if (ida == NULL)
        return dea_fail(error, DEA_ERR_MEMORY, "cannot create the integrator");
    bool good = IDASetErrHandlerFn(ida, drop_message, NULL) == IDA_SUCCESS;
    good = good && IDAInit(ida, plant_residual, 0.0, plant->y, plant->yp) == IDA_SUCCESS;
    good = good && IDASetUserData(ida, plant) == IDA_SUCCESS && IDAWFtolerances(ida, plant_weigh) == IDA_SUCCESS;
    good = good && IDASetId(ida, plant->id) == IDA_SUCCESS;
    good = good && IDASetLinearSolver(ida, plant->solver, plant->matrix) == IDA_SUCCESS;
    good = good && IDASetJacFn(ida, plant_jacobian) == IDA_SUCCESS;
    good = good && IDAQuadInit(ida, plant_quadrature, plant->quad) == IDA_SUCCESS;
    good = good && plant_judge_energy(plant);
    good = good && IDASetQuadErrCon(ida, SUNTRUE) == IDA_SUCCESS;
    good = good && IDASetMaxErrTestFails(ida, MAX_TEST_FAILURES) == IDA_SUCCESS;
    good = good && IDASetNonlinConvCoef(ida, NEWTON_PART) == IDA_SUCCESS;
    /* a Jacobian of another step length costs a second iteration and leaves noise that shortens the steps */
    good = good && IDASetDeltaCjLSetup(ida, 0.0) == IDA_SUCCESS;
    if (plant->options.max_step > 0.0)
        good = good && IDASetMaxStep(ida, plant->options.max_step) == IDA_SUCCESS;
    return good ? DEA_OK : dea_fail(error, DEA_ERR_INTERNAL, "cannot set up the integrator");
}

enum dea_status dea_plant_create(const struct dea_device *device, const struct dea_plant_options *options,
                                 struct dea_plant **created, struct dea_error *error) {
    *created = NULL;
    struct dea_plant *plant = calloc(1, sizeof *plant);
    if (plant == NULL)
        return dea_fail(error, DEA_ERR_MEMORY, "out of memory");
    plant->device = device;
    plant->options = *options;
    for (int k = 0; k < DEA_ZONES; k++)
        plant->inputs.source[k].end = INFINITY;
    enum dea_status status = plant_lay_out(plant, error);
    if (status == DEA_OK)
        status = plant_network_remember(plant, error);
    if (status == DEA_OK) {
        plant_list_limits(plant);
        plant_set_tolerance(plant);
    }
    if (status == DEA_OK && SUNContext_Create(NULL, &plant->context) != 0)
        status = dea_fail(error, DEA_ERR_MEMORY, "cannot create the SUNDIALS context");
    if (status == DEA_OK && !make_vectors(plant))
        status = dea_fail(error, DEA_ERR_MEMORY, "out of memory for %d states", plant->state_count);
    if (status == DEA_OK)
        status = plant_make_matrix(plant, error);
    if (status == DEA_OK)
        status = set_up_ida(plant, error);
    if (status == DEA_OK)
        status = dea_plant_watch(plant, 0, error);
    if (status != DEA_OK) {
        dea_plant_destroy(plant);
        return status;
    }
    *created = plant;
    return DEA_OK;
}

void dea_plant_destroy(struct dea_plant *plant) {
    if (plant == NULL)
        return;
    if (plant->ida != NULL) {
        /* IDAFree frees as many loss vectors as the highest order has at the time */
        struct dea_error ignored;
        (void)plant_free_order(plant, &ignored);
        IDAFree(&plant->ida);
    }
    if (plant->solver != NULL)
        SUNLinSolFree(plant->solver);
    if (plant->matrix != NULL)
        SUNMatDestroy(plant->matrix);
    N_Vector vectors[] = {plant->y,         plant->yp,      plant->id,   plant->rates,      plant->sample_y,
                          plant->sample_yp, plant->kept_yp, plant->quad, plant->sample_quad};
    for (size_t i = 0; i < sizeof vectors / sizeof vectors[0]; i++)
        if (vectors[i] != NULL)
            N_VDestroy(vectors[i]);
    if (plant->context != NULL)
        SUNContext_Free(&plant->context);
    for (int k = 0; k < DEA_ZONES; k++) {
        free(plant->points[k].branches);
        free(plant->points[k].states);
    }
    free(plant->imagined_states);
    free(plant->imagined_branches);
    free(plant->scale);
    free(plant->largest);
    free(plant->follows);
    free(plant->known.y);
    free(plant->slots);
    free(plant->row_scale);
    free(plant->column_starts);
    free(plant->entry_rows);
    free(plant);
}

/* ---- restarts ---- */

/* IDA's counters begin anew at each restart; keep the sum. */
static void collect_stats(const struct dea_plant *plant, struct dea_run_stats *stats) {
    long steps = 0, residuals = 0, setups = 0, test_failures = 0, iterations = 0, convergence_failures = 0,
         jacobians = 0;
    int last_order, current_order;
    double first, last, current, t;
    *stats = plant->stats;
    if (!plant->integrating ||
        IDAGetIntegratorStats(plant->ida, &steps, &residuals, &setups, &test_failures, &last_order, &current_order,
                              &first, &last, &current, &t) != IDA_SUCCESS ||
        IDAGetNonlinSolvStats(plant->ida, &iterations, &convergence_failures) != IDA_SUCCESS ||
        IDAGetNumJacEvals(plant->ida, &jacobians) != IDA_SUCCESS)
        return;
    stats->plant_steps += steps;
    stats->plant_rejected += test_failures + convergence_failures;
    stats->residuals += residuals;
    stats->jacobians += jacobians;
    stats->newton_iterations += iterations;
}

void dea_plant_stats(const struct dea_plant *plant, struct dea_run_stats *stats) {
    collect_stats(plant, stats);
}

/* A sine or chirp must not be stepped over whole periods. */
static double limit_step(const struct dea_plant *plant) {
    double limit = plant->options.max_step > 0.0 ? plant->options.max_step : INFINITY;
    const struct dea_piece *pieces[] = {&plant->inputs.load, &plant->inputs.source[0], &plant->inputs.source[1]};
    for (size_t i = 0; i < sizeof pieces / sizeof pieces[0]; i++)
        if (pieces[i]->kind != DEA_PIECE_LINE && pieces[i]->omega > 0.0)
            limit = fmin(limit, 0.25 * 2.0 * M_PI / pieces[i]->omega);
    for (size_t i = 0; plant->network != ABSENT && i < plant->options.network->source_count; i++) {
        const struct dea_piece *piece = &plant->inputs.network[i];
        if (piece->kind != DEA_PIECE_LINE && piece->omega > 0.0)
            limit = fmin(limit, 0.25 * 2.0 * M_PI / piece->omega);
    }
    return limit;
}

enum dea_status plant_restart_integrator(struct dea_plant *plant, struct dea_error *error) {
    collect_stats(plant, &plant->stats);
    plant_note_sizes(plant);
    plant->integrating = false;
    plant->restarted_at = plant->t;
    double step = limit_step(plant);
    bool good = IDAReInit(plant->ida, plant->t, plant->y, plant->yp) == IDA_SUCCESS;
    good = good && IDAQuadReInit(plant->ida, plant->quad) == IDA_SUCCESS;
    good = good && IDASetMaxStep(plant->ida, isinf(step) ? 0.0 : step) == IDA_SUCCESS;
    return good ? DEA_OK : dea_fail(error, DEA_ERR_INTERNAL, "t = %.9g s: cannot restart the integrator", plant->t);
}

void dea_plant_set_charge(struct dea_plant *plant, int zone, const struct dea_charge_piece *piece) {
    plant->inputs.charge[zone] = *piece;
    plant_forget(plant);
}

void dea_plant_short_film(struct dea_plant *plant, int zone, double conductance) {
    plant->short_conductance[zone] = conductance;
    plant_forget(plant);
}

/* ---- steps ---- */

static const char *explain(int flag) {
    switch (flag) {
    case IDA_ERR_FAIL:
        return "the error test failed again and again: the step shrank without getting accurate enough";
    case IDA_CONV_FAIL:
        return "Newton's method did not converge with ever shorter steps";
    case IDA_LSETUP_FAIL:
    case IDA_LSOLVE_FAIL:
        return "the linear system is singular: the platform's position is undetermined or at a limit point";
    case IDA_RES_FAIL:
    case IDA_REP_RES_ERR:
    case IDA_FIRST_RES_FAIL:
        return "the state left the model and shorter steps did not bring it back";
    case IDA_ILL_INPUT:
        return "an event holds at the restart and right after it";
    case IDA_TOO_MUCH_ACC:
        return "the accuracy asked for is beyond double precision";
    case IDA_REP_QRHS_ERR:
    case IDA_QRHS_FAIL:
    case IDA_FIRST_QRHS_ERR:
        return "the loss integrals left the model";
    default:
        return "the integrator failed";
    }
}

/* Films that are all slack leave a platform without mass and damping anywhere. Uses the last evaluation. */
static bool nothing_holds(const struct dea_plant *plant) {
    bool slack = plant->motion == MOTION_ALGEBRAIC;
    for (int k = 0; k < DEA_ZONES; k++)
        slack = slack && (!plant->zones[k].present || plant->points[k].film.slack);
    return slack;
}

static enum dea_status report_failure(const struct dea_plant *plant, const char *why, int flag,
                                      struct dea_error *error) {
    if (nothing_holds(plant))
        why = "slack films hold a platform without mass and damping nowhere: give it platform.damping";
    char steps[512] = "";
    int used = 0, kept = (int)(sizeof plant->trail / sizeof plant->trail[0]);
    long first = plant->trail_length > kept ? plant->trail_length - kept : 0;
    for (long i = first; i < plant->trail_length && used < (int)sizeof steps - 64; i++)
        used += snprintf(steps + used, sizeof steps - (size_t)used, "\n  t = %.12g s  dt = %.3g s  order %d",
                         plant->trail[i % kept].t, plant->trail[i % kept].h, plant->trail[i % kept].order);
    char code[24] = "";
    if (flag < 0)
        snprintf(code, sizeof code, " (IDA %d)", flag);
    bool recent = plant->trouble != NULL && plant->t - plant->trouble_t <= RECENT * plant->t;
    return dea_fail(error, DEA_ERR_SOLVER, "t = %.9g s: %s%s%s%s%s%s", plant->t, why, code, recent ? "; " : "",
                    recent ? plant->trouble : "", used > 0 ? "\nlast steps:" : "", steps);
}

static void note_step(struct dea_plant *plant) {
    int kept = (int)(sizeof plant->trail / sizeof plant->trail[0]), order = 0;
    double h = 0.0;
    if (IDAGetLastStep(plant->ida, &h) != IDA_SUCCESS || IDAGetLastOrder(plant->ida, &order) != IDA_SUCCESS)
        return;
    plant->trail[plant->trail_length % kept].t = plant->t;
    plant->trail[plant->trail_length % kept].h = h;
    plant->trail[plant->trail_length % kept].order = order;
    plant->trail_length++;
    plant_note_sizes(plant);
}

/* Work moved during the step, for the audit's denominator. */
static void note_work(struct dea_plant *plant) {
    const double *quad = NV_DATA_S(plant->quad), *y = NV_DATA_S(plant->y);
    double x = y[plant->x] * plant->scale[plant->x], imposed[2], work[2];
    plant_imposed_energy(plant, plant->t, x, imposed);
    work[0] = quad[LOSS_WORK] + imposed[0] - plant->imposed_at_start[0] + plant->jump_work[0];
    work[1] = quad[LOSS_LOAD] + imposed[1] - plant->imposed_at_start[1] + plant->jump_work[1] +
              plant->device->load * (x - plant->start_x);
    plant->moved += fabs(work[0] - plant->work_seen[0]) + fabs(work[1] - plant->work_seen[1]);
    plant->work_seen[0] = work[0];
    plant->work_seen[1] = work[1];
    if (plant->v != ABSENT) {
        double v = y[plant->v] * plant->scale[plant->v];
        plant->kinetic = fmax(plant->kinetic, 0.5 * plant->device->effective_mass * v * v);
    }
}

static enum dea_status choose_first_step(struct dea_plant *plant, double limit, struct dea_error *error) {
    if (plant->integrating)
        return DEA_OK;
    double step = fmin(plant_first_step(plant, limit - plant->t), limit_step(plant));
    if (IDASetInitStep(plant->ida, step) != IDA_SUCCESS)
        return dea_fail(error, DEA_ERR_INTERNAL, "t = %.17g s: cannot choose the first step", plant->t);
    return DEA_OK;
}

/* Orders 3 to 5 of the BDF are unstable for an undamped oscillation once a step is a good part of its period: after a
 * ringing has died away they keep it alive at the tolerance, and the step with it, through hours of creep. Order 2 has
 * no such bound. It is taken while the platform moves far slower than it could swing, until the next corner of the
 * inputs, or until it moves again: a circuit gives no corners. One damped too much to swing needs it never. */
static enum dea_status note_quiet(struct dea_plant *plant, struct dea_error *error) {
    double h = 0.0;
    if (plant->v == ABSENT || plant_is_light(plant) || IDAGetLastStep(plant->ida, &h) != IDA_SUCCESS)
        return DEA_OK;
    const double *y = NV_DATA_S(plant->y);
    double omega = sqrt(fmax(plant->device->stiffness, 0.0) / plant->device->effective_mass);
    double swing = fabs(y[plant->v]) * plant->scale[plant->v];
    double size = omega * plant->largest[plant->x] * plant->scale[plant->x];
    if (plant->low_order)
        return swing > WAKING_SWING * plant->rtol * size ? plant_free_order(plant, error) : DEA_OK;
    bool quiet = swing < QUIET_SWING * plant->rtol * size && omega * h > SHORT_STEP && omega * h < LONG_STEP;
    plant->quiet_steps = quiet ? plant->quiet_steps + 1 : 0;
    return DEA_OK;
}

/* At the start of a step: down to order 2 once quiet for long enough. */
static enum dea_status lower_order(struct dea_plant *plant, struct dea_error *error) {
    if (plant->low_order || plant->quiet_steps < QUIET_STEPS)
        return DEA_OK;
    plant->low_order = true;
    if (IDASetMaxOrd(plant->ida, 2) != IDA_SUCCESS)
        return dea_fail(error, DEA_ERR_INTERNAL, "t = %.9g s: cannot lower the integrator's order", plant->t);
    return plant_restart_integrator(plant, error);
}

enum dea_status plant_free_order(struct dea_plant *plant, struct dea_error *error) {
    plant->quiet_steps = 0;
    if (plant->low_order && IDASetMaxOrd(plant->ida, 5) != IDA_SUCCESS)
        return dea_fail(error, DEA_ERR_INTERNAL, "t = %.9g s: cannot raise the integrator's order", plant->t);
    plant->low_order = false;
    return DEA_OK;
}

/* Roots of events are the caller's, those of limits our own. */
static enum dea_status note_roots(struct dea_plant *plant, bool found, bool *event, struct dea_error *error) {
    if (found && IDAGetRootInfo(plant->ida, plant->root_hits) != IDA_SUCCESS)
        return dea_fail(error, DEA_ERR_INTERNAL, "t = %.17g s: no information on the event", plant->t);
    for (int i = 0; found && i < plant->event_count; i++) {
        bool bends = plant->roots[i].kind == DEA_EVENT_SLACK || plant->roots[i].kind == DEA_EVENT_STOP;
        *event = *event || plant->root_hits[i] != 0;
        plant->bent =
            plant->bent || (plant->root_hits[i] != 0 && bends && (plant->network == ABSENT || plant_is_light(plant)));
    }
    if (plant_note_limits(plant, found ? plant->root_hits + plant->event_count : NULL) != DEA_OK)
        return dea_fail(error, DEA_ERR_SOLVER, "t = %.9g s: the state left the model", plant->t);
    return DEA_OK;
}

enum dea_status dea_plant_step(struct dea_plant *plant, double limit, struct dea_step *step, struct dea_error *error) {
    double reached = plant->t, quad_time;
    DEA_TRY(lower_order(plant, error));
    if (plant->bent || plant_limits_turn(plant))
        DEA_TRY(plant_turn_over(plant, error));
    if (IDASetStopTime(plant->ida, limit) != IDA_SUCCESS)
        return dea_fail(error, DEA_ERR_INTERNAL, "t = %.17g s: cannot stop at %.17g s", plant->t, limit);
    const char *earlier = plant->trouble;
    plant->trouble = NULL;
    DEA_TRY(choose_first_step(plant, limit, error));
    int flag = IDASolve(plant->ida, limit, &reached, plant->y, plant->yp, IDA_ONE_STEP);
    if (flag == IDA_ILL_INPUT && plant->event_count + plant->limit_count > 0 && plant->integrating) {
        /* a root right after the last one (an extreme that just touches a limit): IDA wants a fresh start from here */
        DEA_TRY(plant_restart_integrator(plant, error));
        if (IDASetStopTime(plant->ida, limit) != IDA_SUCCESS)
            return dea_fail(error, DEA_ERR_INTERNAL, "t = %.17g s: cannot stop at %.17g s", plant->t, limit);
        flag = IDASolve(plant->ida, limit, &reached, plant->y, plant->yp, IDA_ONE_STEP);
    }
    if (plant->trouble != NULL)
        plant->trouble_t = reached;
    else
        plant->trouble = earlier;
    if (flag < 0)
        return report_failure(plant, explain(flag), flag, error);
    plant->integrating = true;
    plant->t_previous = plant->t;
    plant->t = reached;
    if (IDAGetQuad(plant->ida, &quad_time, plant->quad) != IDA_SUCCESS ||
        (flag == IDA_ROOT_RETURN && IDAGetQuadDky(plant->ida, reached, 0, plant->quad) != IDA_SUCCESS))
        return dea_fail(error, DEA_ERR_INTERNAL, "t = %.17g s: no loss integrals", reached);
    note_step(plant);
    note_work(plant);
    plant_note_sensitivity(plant);
    DEA_TRY(note_quiet(plant, error));
    if (!plant_judge_energy(plant))
        return dea_fail(error, DEA_ERR_INTERNAL, "t = %.17g s: no tolerance for the loss integrals", reached);
    plant->standstill = reached > plant->t_previous ? 0 : plant->standstill + 1;
    bool crawling = false;
    if (++plant->crawl_steps == CRAWL_STEPS) {
        crawling = reached - plant->crawl_from < CRAWL_ADVANCE * reached;
        plant->crawl_steps = 0;
        plant->crawl_from = reached;
    }
    if (plant->standstill > MAX_STANDSTILL || crawling)
        return report_failure(plant, "the run is not advancing any more", flag, error);
    *step = (struct dea_step){plant->t_previous, plant->t, false};
    return note_roots(plant, flag == IDA_ROOT_RETURN, &step->root, error);
}

double dea_plant_time(const struct dea_plant *plant) {
    return plant->t;
}
