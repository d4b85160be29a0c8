/* Rest position of the platform at given voltages: the first zero of the force met from x = 0 in its direction. */
#include "deasim/film.h"
#include "design/path.h"

#include <math.h>
#include <stddef.h>

#define MAX_STRIDES 4000
#define FIRST_STRIDE (1.0 / 64.0) /* of the shortest zone */
#define STRIDE_GROWTH 1.05
#define SMALLEST_STRIDE 1e-15 /* of the shortest zone */
#define BISECTIONS 200        /* more than a double can be halved between neighbours of one scale */

struct balance {
    const struct dea_device *device; /* without branches */
    const double *voltages;
    double direction; /* +1 or -1: side to which the force at x = 0 pushes */
};

/* Force on the platform at rest, counted positive in the search direction, and its slope along it. */
struct push {
    double at; /* distance travelled from x = 0, m, >= 0 */
    double force, slope;
};

static enum dea_status respond(const struct dea_device *device, int zone, double x, double voltage,
                               struct dea_film *film) {
    enum dea_control control = device->zones[zone].electroded ? DEA_CONTROL_VOLTAGE : DEA_CONTROL_PASSIVE;
    return dea_film_respond(device, zone, control, x, voltage, NULL, true, NULL, film);
}

static enum dea_status push_platform(const struct balance *balance, double at, struct push *out) {
    const struct dea_device *device = balance->device;
    double by_x, x = balance->direction * at;
    double force = device->load + dea_stop_force(device, x, 0.0, &by_x, NULL, NULL, NULL);
    for (int k = 0; k < DEA_ZONES; k++) {
        if (!device->zones[k].present)
            continue;
        struct dea_film film;
        DEA_TRY(respond(device, k, x, balance->voltages[k], &film));
        force -= device->zones[k].side * film.pull;
        by_x -= device->zones[k].side * film.dpull_dx;
    }
    *out = (struct push){at, balance->direction * force, by_x};
    return DEA_OK;
}

/* Smallest `at` in (low, high] where the force is gone, given force(low) > 0 >= force(high). The predicate, not the
 * value, is bisected: between two slack films the force is exactly 0 over a range, whose near end is wanted. */
static enum dea_status bisect_force(const struct balance *balance, double low, double high, double *root) {
    for (int i = 0; i < BISECTIONS; i++) {
        double middle = 0.5 * (low + high);
        if (middle <= low || middle >= high)
            break;
        struct push push;
        DEA_TRY(push_platform(balance, middle, &push));
        if (push.force > 0.0)
            low = middle;
        else
            high = middle;
    }
    *root = high;
    return DEA_OK;
}

/* Position of the least force between two points where it first falls, then rises. */
static enum dea_status find_least_push(const struct balance *balance, struct push low, struct push high,
                                       struct push *least) {
    for (int i = 0; i < BISECTIONS; i++) {
        double middle = 0.5 * (low.at + high.at);
        if (middle <= low.at || middle >= high.at)
            break;
        struct push push;
        DEA_TRY(push_platform(balance, middle, &push));
        if (push.force <= 0.0) {
            *least = push;
            return DEA_OK;
        }
        if (push.slope < 0.0)
            low = push;
        else
            high = push;
    }
    *least = high;
    return DEA_OK;
}

/* Walks from x = 0 until the force vanishes. DEA_RECOVERABLE when nothing holds the platform. */
static enum dea_status walk_to_rest(const struct balance *balance, struct push here, double *root) {
    double shortest = INFINITY;
    for (int k = 0; k < DEA_ZONES; k++)
        if (balance->device->zones[k].present)
            shortest = fmin(shortest, balance->device->zones[k].length);
    double stride = FIRST_STRIDE * shortest;
    for (int i = 0; i < MAX_STRIDES; i++) {
        struct push next;
        if (push_platform(balance, here.at + stride, &next) != DEA_OK || !isfinite(next.force)) {
            stride *= 0.5; /* beyond the law's limit or the end of a zone: the zero lies before, or there is none */
            if (stride < SMALLEST_STRIDE * shortest)
                return DEA_RECOVERABLE;
            continue;
        }
        if (next.force <= 0.0)
            return bisect_force(balance, here.at, next.at, root);
        if (here.slope < 0.0 && next.slope > 0.0) { /* two zeros may hide in between */
            struct push least;
            DEA_TRY(find_least_push(balance, here, next, &least));
            if (least.force <= 0.0)
                return bisect_force(balance, here.at, least.at, root);
        }
        here = next;
        stride *= STRIDE_GROWTH;
    }
    return DEA_RECOVERABLE;
}

enum dea_status dea_find_rest(const struct dea_device *device, const double voltages[DEA_ZONES], double *x,
                              struct dea_error *error) {
    struct balance balance = {device, voltages, 1.0};
    struct push start;
    if (push_platform(&balance, 0.0, &start) != DEA_OK)
        return dea_fail(error, DEA_ERR_SOLVER, "no equilibrium: the prestretch lies outside the elastic law");
    *x = 0.0;
    if (start.force == 0.0)
        return DEA_OK;
    if (start.force < 0.0) {
        balance.direction = -1.0;
        start.force = -start.force;
    }
    double root;
    if (walk_to_rest(&balance, start, &root) != DEA_OK)
        return dea_fail(error, DEA_ERR_SOLVER, "no equilibrium at %g V left, %g V right: nothing holds the platform",
                        voltages[0], voltages[1]);
    *x = balance.direction * root;
    return DEA_OK;
}

/* What is to be said of each zone at x. */
static enum dea_status describe(const struct dea_device *device, const double voltages[DEA_ZONES], double x,
                                struct dea_static_point *point) {
    double by_x;
    dea_stop_force(device, x, 0.0, &by_x, NULL, NULL, NULL);
    *point = (struct dea_static_point){.x = x};
    for (int k = 0; k < DEA_ZONES; k++) {
        if (!device->zones[k].present)
            continue;
        struct dea_film film;
        DEA_TRY(respond(device, k, x, voltages[k], &film));
        struct dea_static_zone *zone = &point->zones[k];
        zone->voltage = voltages[k];
        zone->stretch = film.lam;
        zone->true_field = device->zones[k].electroded ? dea_zone_field(device, voltages[k], film.lam) : 0.0;
        zone->stress1 = film.slack ? 0.0 : film.lam * film.margin;
        DEA_TRY(dea_film_stress2(device, k, film.lam, voltages[k], NULL, &zone->stress2));
        zone->tension = film.pull;
        zone->capacitance = film.capacitance;
        zone->slack = film.slack;
        by_x -= device->zones[k].side * film.dpull_dx;
    }
    point->stable = by_x <= 0.0;
    return DEA_OK;
}

enum dea_status dea_check_voltages(const struct dea_device *device, const double voltages[DEA_ZONES],
                                   struct dea_error *error) {
    for (int k = 0; k < DEA_ZONES; k++) {
        if (!isfinite(voltages[k]))
            return dea_fail(error, DEA_ERR_INPUT, "the %s voltage is not a number", dea_zone_names[k]);
        if (voltages[k] != 0.0 && !(device->zones[k].present && device->zones[k].electroded))
            return dea_fail(error, DEA_ERR_INPUT, "zones.%s carries no electrode, it cannot be at %g V",
                            dea_zone_names[k], voltages[k]);
    }
    return DEA_OK;
}

enum dea_status dea_static_solve(const struct dea_device *device, const double voltages[DEA_ZONES],
                                 struct dea_static_point *point, struct dea_error *error) {
    DEA_TRY(dea_check_voltages(device, voltages, error));
    struct dea_device relaxed = dea_relaxed_device(device);
    double x;
    DEA_TRY(dea_find_rest(&relaxed, voltages, &x, error));
    if (describe(&relaxed, voltages, x, point) != DEA_OK)
        return dea_fail(error, DEA_ERR_SOLVER, "no equilibrium at %g V left, %g V right", voltages[0], voltages[1]);
    return DEA_OK;
}

/* ---- given field ---- */

/* True when the left zone carries at least `field` at voltage V; also where no equilibrium is left. */
static bool field_reached(const struct dea_device *device, double voltage, double right_voltage, double field,
                          struct dea_static_point *point) {
    double voltages[DEA_ZONES] = {voltage, right_voltage};
    return dea_static_solve(device, voltages, point, NULL) != DEA_OK || point->zones[0].true_field >= field;
}

/* Beyond the taut path: the field grows with the voltage, so the voltage is bisected. */
static enum dea_status solve_slack_field(const struct dea_device *device, double field, double right_voltage,
                                         double voltage, struct dea_static_point *point, struct dea_error *error) {
    double low = voltage, high = fmax(voltage, 1.0);
    while (!field_reached(device, high, right_voltage, field, point))
        high *= 2.0;
    for (int i = 0; i < BISECTIONS; i++) {
        double middle = 0.5 * (low + high);
        if (middle <= low || middle >= high)
            break;
        if (field_reached(device, middle, right_voltage, field, point))
            high = middle;
        else
            low = middle;
    }
    double voltages[DEA_ZONES] = {high, right_voltage};
    DEA_TRY(dea_static_solve(device, voltages, point, error));
    if (fabs(point->zones[0].true_field - field) > 1e-9 * field)
        return dea_fail(error, DEA_ERR_SOLVER, "no equilibrium with a true field of %g V/m", field);
    return DEA_OK;
}

static bool field_or_slack(const struct dea_device *device, const struct dea_path_point *point, const void *context) {
    const double *field = context;
    bool slack = false;
    for (int k = 0; k < DEA_ZONES; k++)
        slack = slack || (device->slack && device->zones[k].present && point->net1[k] < 0.0);
    return slack || point->field[0] >= *field;
}

enum dea_status dea_static_solve_field(const struct dea_device *device, double true_field, double right_voltage,
                                       struct dea_static_point *point, struct dea_error *error) {
    double voltages[DEA_ZONES] = {0.0, right_voltage}, field = fabs(true_field);
    DEA_TRY(dea_check_left_electrode(device, error));
    DEA_TRY(dea_check_voltages(device, voltages, error));
    if (!isfinite(true_field))
        return dea_fail(error, DEA_ERR_INPUT, "the true field is not a number");
    struct dea_device relaxed = dea_relaxed_device(device);
    double start;
    DEA_TRY(dea_find_rest(&relaxed, voltages, &start, error));

    /* along the taut path until the field is there or a film goes slack */
    struct dea_path_end end;
    double voltage = 0.0;
    if (dea_path_walk(&relaxed, right_voltage, start, field_or_slack, &field, &end)) {
        const struct dea_path_point *there = field == 0.0 ? &end.before : &end.after;
        voltage = sqrt(fmax(there->voltage_squared, 0.0));
        voltages[0] = copysign(voltage, true_field);
        if (there->field[0] >= field && describe(&relaxed, voltages, there->x, point) == DEA_OK)
            return DEA_OK;
    }
    DEA_TRY(solve_slack_field(&relaxed, field, right_voltage, voltage, point, error));
    if (true_field < 0.0) {
        point->zones[0].voltage = -point->zones[0].voltage;
        point->zones[0].true_field = -point->zones[0].true_field;
    }
    return DEA_OK;
}
