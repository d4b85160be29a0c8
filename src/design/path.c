/* Equilibria parametrised by the displacement: with x given, both membranes' elastic forces are known, and the force
 * balance is linear in the square of the left voltage. */
#include "design/path.h"
#include "deasim/film.h"

#include <math.h>
#include <stddef.h>

/* Elastic and electric parts of one zone's nominal stress, with slopes by lam1. */
struct zone_stress {
    double w1, w11;    /* Pa */
    double c1, c2;     /* dC/dlam1, d2C/dlam1^2, F; 0 when passive */
    double per_length; /* |dlam1/dx|, 1/m */
    double volume;     /* m^3 */
};

static enum dea_status stress_zone(const struct dea_device *device, int zone, double lam, struct zone_stress *out) {
    struct dea_stress stress;
    DEA_TRY(dea_law_stress(&device->material.elastic, lam, device->prestretch[1], &stress));
    *out = (struct zone_stress){.w1 = stress.w1,
                                .w11 = stress.w11,
                                .per_length = device->prestretch[0] / device->zones[zone].length,
                                .volume = device->zones[zone].volume};
    if (device->zones[zone].electroded &&
        !(dea_zone_capacitance(device, zone, lam, &out->c1, &out->c2) > 0.0 && out->c1 > 0.0))
        return DEA_RECOVERABLE;
    return DEA_OK;
}

enum dea_status dea_path_evaluate(const struct dea_device *device, double right_voltage, double x,
                                  struct dea_path_point *point) {
    *point = (struct dea_path_point){.x = x, .margin = INFINITY};
    double voltages_squared[DEA_ZONES] = {0.0, right_voltage * right_voltage};
    struct zone_stress zones[DEA_ZONES];
    for (int k = 0; k < DEA_ZONES; k++) {
        if (!device->zones[k].present)
            continue;
        point->lam[k] = dea_zone_stretch(device, k, x);
        DEA_TRY(stress_zone(device, k, point->lam[k], &zones[k]));
        point->margin =
            fmin(point->margin, dea_law_margin(&device->material.elastic, point->lam[k], device->prestretch[1]));
    }

    /* everything but the left zone pushes the platform towards +x with `drive` */
    double by_x, drive = device->load + dea_stop_force(device, x, 0.0, &by_x, NULL, NULL, NULL);
    if (device->zones[1].present) {
        const struct zone_stress *right = &zones[1];
        double half = 0.5 * voltages_squared[1];
        point->net1[1] = right->w1 - half * right->c1 / right->volume;
        drive += right->volume * right->per_length * point->net1[1];
        by_x -= right->per_length * right->per_length * (right->volume * right->w11 - half * right->c2);
    }

    /* the left zone must balance it: per_length (volume w1 - V^2 c1 / 2) = drive */
    const struct zone_stress *left = &zones[0];
    double excess = left->volume * left->w1 - drive / left->per_length; /* = V^2 c1 / 2, J */
    double excess_by_x = left->volume * left->w11 * left->per_length - by_x / left->per_length;
    double square = 2.0 * excess / left->c1;
    point->voltage_squared = voltages_squared[0] = square;
    point->slope = (2.0 * excess_by_x - square * left->c2 * left->per_length) / left->c1;
    point->net1[0] = drive / (left->per_length * left->volume);

    for (int k = 0; k < DEA_ZONES; k++) {
        if (!device->zones[k].present)
            continue;
        double voltage = sqrt(fmax(voltages_squared[k], 0.0));
        point->field[k] = device->zones[k].electroded ? dea_zone_field(device, voltage, point->lam[k]) : 0.0;
        DEA_TRY(dea_film_stress2(device, k, point->lam[k], voltage, NULL, &point->stress2[k]));
    }
    return DEA_OK;
}

#define FIRST_STRIDE (1.0 / 256.0) /* of the shortest zone */
#define STRIDE_GROWTH 1.03
#define LARGEST_STRIDE (1.0 / 64.0) /* of the right zone */
#define FARTHEST 1e3                /* lengths of the left zone: beyond that nothing will happen */
#define BISECTIONS 200              /* more than a double can be halved between neighbours of one scale */

/* 1 the walk ends here, 0 it goes on, -1 outside the model. */
static int probe(const struct dea_device *device, double right_voltage, double x, dea_path_predicate ends,
                 const void *context, struct dea_path_point *point) {
    if (dea_path_evaluate(device, right_voltage, x, point) != DEA_OK)
        return -1;
    return ends(device, point, context) ? 1 : 0;
}

bool dea_path_walk(const struct dea_device *device, double right_voltage, double start, dea_path_predicate ends,
                   const void *context, struct dea_path_end *end) {
    const struct dea_zone *left = &device->zones[0], *right = &device->zones[1];
    double stride = FIRST_STRIDE * (right->present ? fmin(left->length, right->length) : left->length);
    double cap = right->present ? LARGEST_STRIDE * right->length : INFINITY;
    double low = start, high = start;
    int state = probe(device, right_voltage, start, ends, context, &end->before);
    end->after = end->before;
    end->outside = state < 0;
    if (state != 0)
        return true;

    /* bracket */
    while (state == 0) {
        low = high;
        end->before = end->after;
        if (low > FARTHEST * left->length)
            return false;
        high = low + stride;
        stride = fmin(stride * STRIDE_GROWTH, cap);
        state = probe(device, right_voltage, high, ends, context, &end->after);
    }

    /* bisect */
    end->outside = state < 0;
    for (int i = 0; i < BISECTIONS; i++) {
        double middle = 0.5 * (low + high);
        if (middle <= low || middle >= high)
            break;
        struct dea_path_point point;
        state = probe(device, right_voltage, middle, ends, context, &point);
        if (state == 0) {
            low = middle;
            end->before = point;
        } else {
            high = middle;
            end->after = point;
            end->outside = state < 0;
        }
    }
    if (end->outside)
        end->after = end->before;
    return true;
}

struct dea_device dea_relaxed_device(const struct dea_device *device) {
    struct dea_device relaxed = *device;
    relaxed.material.branches = NULL;
    relaxed.material.branch_count = 0;
    return relaxed;
}

enum dea_status dea_check_left_electrode(const struct dea_device *device, struct dea_error *error) {
    if (!device->zones[0].present || !device->zones[0].electroded)
        return dea_fail(error, DEA_ERR_INPUT, "zones.left carries no electrode, so there is nothing to drive");
    return DEA_OK;
}
