/* Equilibria: the platform position where the forces balance, reached downhill from where it is. */
#include "plant/plant_internal.h"

#include <math.h>

#define MAX_STRIDES 400
#define MAX_REFINEMENTS 200

/* Closes a bracket around a sign change: secant steps with the Illinois rule, bisection when they stall. */
static enum dea_status close_bracket(balance_force force, void *context, double a, double fa, double b, double fb,
                                     double *x) {
    int side = 0;
    for (int i = 0; i < MAX_REFINEMENTS && fa != 0.0 && fb != 0.0; i++) {
        double width = fabs(b - a), next = i % 8 == 7 ? 0.5 * (a + b) : (a * fb - b * fa) / (fb - fa), f;
        if (width <= 4e-16 * fmax(fabs(a), fabs(b)) || width < 1e-300)
            break;
        if (!((next > a && next < b) || (next > b && next < a)))
            next = 0.5 * (a + b);
        if (next == a || next == b)
            break;
        DEA_TRY(force(context, next, &f));
        if ((f > 0.0) == (fa > 0.0)) {
            a = next;
            fa = f;
            if (side == -1)
                fb *= 0.5;
            side = -1;
        } else {
            b = next;
            fb = f;
            if (side == 1)
                fa *= 0.5;
            side = 1;
        }
    }
    *x = fabs(fa) < fabs(fb) ? a : b;
    return DEA_OK;
}

/* Where everything is slack nothing pulls at all: the balance is the near edge of that range, where the force `fa` at a
 * has just faded. */
static enum dea_status find_edge(balance_force force, void *context, double a, double fa, double b, double *x) {
    for (int i = 0; i < MAX_REFINEMENTS && fabs(b - a) > 4e-16 * fmax(fabs(a), fabs(b)); i++) {
        double middle = 0.5 * (a + b), f;
        if (middle == a || middle == b)
            break;
        DEA_TRY(force(context, middle, &f));
        if ((f > 0.0) == (fa > 0.0) && f != 0.0)
            a = middle;
        else
            b = middle;
    }
    *x = b;
    return DEA_OK;
}

enum dea_status plant_find_balance(balance_force force, void *context, double x0, double stride, double force_scale,
                                   double *x) {
    double f0, f;
    DEA_TRY(force(context, x0, &f0));
    *x = x0;
    if (fabs(f0) <= 1e-15 * force_scale)
        return DEA_OK;
    double direction = f0 > 0.0 ? 1.0 : -1.0;
    for (int i = 0; i < MAX_STRIDES; i++) {
        double next = x0 + direction * stride;
        if (next == x0)
            return DEA_RECOVERABLE;
        if (force(context, next, &f) != DEA_OK) { /* left the model: look closer */
            stride *= 0.5;
            continue;
        }
        if (f == 0.0)
            return find_edge(force, context, x0, f0, next, x);
        if ((f > 0.0) != (f0 > 0.0))
            return close_bracket(force, context, x0, f0, next, f, x);
        x0 = next;
        f0 = f;
        stride *= 1.5;
    }
    return DEA_RECOVERABLE;
}

struct static_task {
    struct dea_device elastic; /* the device without its branches: relaxed */
    const double *voltages;
    double load;
};

static enum dea_status static_force(void *context, double x, double *force) {
    struct static_task *task = context;
    *force = task->load + task->elastic.load + dea_stop_force(&task->elastic, x, 0.0, NULL, NULL, NULL, NULL);
    for (int k = 0; k < DEA_ZONES; k++) {
        const struct dea_zone *zone = &task->elastic.zones[k];
        if (!zone->present)
            continue;
        struct dea_film film;
        enum dea_control control = zone->electroded ? DEA_CONTROL_VOLTAGE : DEA_CONTROL_PASSIVE;
        DEA_TRY(dea_film_respond(&task->elastic, k, control, x, task->voltages[k], NULL, false, NULL, &film));
        *force -= zone->side * film.pull;
    }
    return DEA_OK;
}

enum dea_status plant_find_equilibrium(const struct dea_device *device, const double voltages[DEA_ZONES], double load,
                                       double *x) {
    struct static_task task = {*device, voltages, load};
    task.elastic.material.branches = NULL;
    task.elastic.material.branch_count = 0;
    double shortest = INFINITY;
    for (int k = 0; k < DEA_ZONES; k++)
        if (device->zones[k].present)
            shortest = fmin(shortest, device->zones[k].length);
    return plant_find_balance(static_force, &task, 0.0, 1e-3 * shortest, device->stiffness * shortest, x);
}
