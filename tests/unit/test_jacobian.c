/* The analytic Jacobian against differences of the residual, at random states of random devices and drives: with and
 * without mass and damping, branches of both kinds, slack and taut, leakage, sheet electrodes, amplifiers, stops, dense
 * and sparse. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sunmatrix/sunmatrix_dense.h>
#include <sunmatrix/sunmatrix_sparse.h>

#include "plant/plant_internal.h"

#include "scenes.h"

enum { SEEDS = 240, MAX_UNKNOWNS = 120 };

#define STRIDE 2e-6 /* of a difference, in scaled unknowns */
#define ALLOWED 2e-6

/* What the tests met, so that no kind is missed. */
struct tally {
    int motions[3], sparse, dense, slack, taut, amplified, ideal, leaking, sheet, stopped, foo, network, states;
};

static double draw(uint32_t *state) { /* Numerical Recipes' linear congruential numbers, 0 .. 1 */
    *state = *state * 1664525u + 1013904223u;
    return *state / 4294967296.0;
}

static struct dea_plant *create_plant(const struct test_scene *s) {
    const struct dea_device *device = &s->device.device;
    struct dea_plant_options options = {.accuracy = 1e-4, .duration = s->scene.stop, .load_peak = fabs(device->load)};
    struct dea_plant_inputs inputs;
    memset(&inputs, 0, sizeof inputs);
    inputs.load.end = INFINITY;
    for (int k = 0; k < DEA_ZONES; k++) {
        const struct dea_source *source = &s->scene.sources[k];
        struct dea_plant_port *port = &options.ports[k];
        inputs.source[k].end = INFINITY;
        if (!device->zones[k].electroded)
            continue;
        port->kind = DEA_PORT_IDEAL;
        if (!source->present)
            continue;
        port->peak = dea_waveform_peak(&source->waveform);
        port->resistance = source->resistance;
        port->amplifier = source->amplified ? &source->amplifier : NULL;
        bool soft = source->amplified || source->resistance > 0.0 || device->zones[k].sheet_resistance > 0.0;
        port->kind = soft ? DEA_PORT_SOURCE : DEA_PORT_IDEAL;
        dea_waveform_piece(&source->waveform, 0.0, &inputs.source[k]);
    }
    struct dea_plant *plant;
    struct dea_error error;
    if (dea_plant_create(device, &options, &plant, &error) != DEA_OK)
        return NULL;
    if (dea_plant_start(plant, 0.0, &inputs, DEA_START_EQUILIBRIUM, NULL, NULL, &error) == DEA_OK)
        return plant;
    dea_plant_destroy(plant);
    return NULL;
}

static void count_kinds(const struct dea_plant *plant, struct tally *tally) {
    const struct dea_device *device = plant->device;
    tally->motions[plant->motion]++;
    tally->sparse += plant->sparse;
    tally->dense += !plant->sparse;
    tally->leaking += device->material.dielectric.conductivity > 0.0;
    tally->stopped += plant->force_x != 0.0;
    for (int b = 0; b < device->material.branch_count; b++) {
        tally->foo += device->material.branches[b].kind == DEA_BRANCH_FOO;
        tally->network += device->material.branches[b].kind == DEA_BRANCH_NETWORK;
    }
    for (int k = 0; k < DEA_ZONES; k++) {
        tally->slack += plant->points[k].film.slack;
        tally->taut += !plant->points[k].film.slack;
        tally->amplified += plant->zones[k].amplifier != ABSENT;
        tally->ideal += plant->zones[k].kind == DEA_PORT_IDEAL;
        tally->sheet += device->zones[k].sheet_resistance > 0.0;
    }
    tally->states++;
}

/* Column of dF/dy + cj dF/dy' by a central difference; false beyond the model. */
static bool difference(struct dea_plant *plant, double cj, int column, double stride, double *slopes) {
    double *y = N_VGetArrayPointer(plant->y), *yp = N_VGetArrayPointer(plant->yp);
    double *r = N_VGetArrayPointer(plant->rates), y0 = y[column], yp0 = yp[column];
    bool good = true;
    for (int side = 1; side >= -1 && good; side -= 2) {
        y[column] = y0 + side * stride;
        yp[column] = yp0 + cj * side * stride;
        good = plant_residual(plant->t, plant->y, plant->yp, plant->rates, plant) == 0;
        for (int i = 0; i < plant->state_count && good; i++)
            slopes[i] = side > 0 ? r[i] : (slopes[i] - r[i]) / (2.0 * stride);
    }
    y[column] = y0;
    yp[column] = yp0;
    return good;
}

/* Compares all columns. Entries where two strides disagree sit at a kink (slack, slew or current limit, contact). */
static void compare(struct dea_plant *plant, double cj, int seed, long *compared) {
    int n = plant->state_count;
    static double fine[MAX_UNKNOWNS], coarse[MAX_UNKNOWNS], largest[MAX_UNKNOWNS];
    assert_int_equal(plant_jacobian(plant->t, cj, plant->y, plant->yp, NULL, plant->matrix, plant, NULL, NULL, NULL),
                     0);
    const double *data = plant->sparse ? SM_DATA_S(plant->matrix) : SM_DATA_D(plant->matrix);
    for (int row = 0; row < n; row++) {
        largest[row] = 0.0;
        for (int column = 0; column < n; column++) {
            int slot = plant->slots[row * n + column];
            largest[row] = fmax(largest[row], slot == ABSENT ? 0.0 : fabs(data[slot]));
        }
    }
    for (int column = 0; column < n; column++) {
        if (!difference(plant, cj, column, STRIDE, fine) || !difference(plant, cj, column, 10.0 * STRIDE, coarse))
            continue;
        for (int row = 0; row < n; row++) {
            int slot = plant->slots[row * n + column];
            double value = slot == ABSENT ? 0.0 : data[slot], allowed = ALLOWED * fmax(largest[row], 1e-3);
            if (fabs(fine[row] - coarse[row]) > 0.5 * allowed)
                continue;
            if (fabs(value - fine[row]) > allowed)
                fail_msg("seed %d: entry (%d, %d) is %.12g, by differences %.12g (cj %g, row up to %.3g)", seed, row,
                         column, value, fine[row], cj, largest[row]);
            ++*compared;
        }
    }
}

static void test_random_states(void **context) {
    (void)context;
    static struct test_scene s;
    struct tally tally = {0};
    long compared = 0, wanted = 0;
    for (int seed = 0; seed < SEEDS; seed++) {
        uint32_t random = (uint32_t)seed;
        build_random_scene(&s, (unsigned)seed);
        struct dea_device *device = &s.device.device;
        if (seed % 4 == 0) /* enough unknowns for the sparse solver */
            for (int b = 0; b < 16; b++)
                add_branch(&s, b % 2 ? DEA_BRANCH_FOO : DEA_BRANCH_NETWORK, 2e4 * (b + 1), 1e-3 * (b + 1),
                           b == 3 ? 40.0 : INFINITY);
        if (seed % 5 == 0) {
            device->has_stops = true;
            device->stops[0] = -2e-5;
            device->stops[1] = 2e-5;
            device->stop_loss = 0.5;
        }
        prepare_scene(&s);
        struct dea_plant *plant = create_plant(&s);
        if (plant == NULL)
            continue;
        double *y = N_VGetArrayPointer(plant->y), *yp = N_VGetArrayPointer(plant->yp);
        assert_true(plant->state_count <= MAX_UNKNOWNS);
        plant->t = fmin(0.3 * s.scene.stop, 0.9 * fmin(plant->inputs.source[0].end, plant->inputs.source[1].end));
        for (int i = 0; i < plant->state_count; i++) {
            y[i] += 2.0 * draw(&random) - 1.0;
            yp[i] = 100.0 * (2.0 * draw(&random) - 1.0);
        }
        if (seed % 3 == 0) /* far enough for one zone to go slack */
            y[plant->x] = (seed % 2 ? 0.2 : -0.2) * 4e-3 / plant->scale[plant->x];
        if (plant_residual(plant->t, plant->y, plant->yp, plant->rates, plant) == 0) {
            count_kinds(plant, &tally);
            wanted += 2l * plant->state_count * plant->state_count;
            compare(plant, 0.0, seed, &compared);
            compare(plant, 1e3, seed, &compared);
        }
        dea_plant_destroy(plant);
    }
    print_message(
        "%d states: %d %d %d motions, %d sparse, %d slack, %d amplified, %d ideal, %d leaking, %d sheet, %d at "
        "stops; %.1f %% of the entries compared\n",
        tally.states, tally.motions[0], tally.motions[1], tally.motions[2], tally.sparse, tally.slack, tally.amplified,
        tally.ideal, tally.leaking, tally.sheet, tally.stopped, 100.0 * (double)compared / (double)wanted);
    assert_true(tally.motions[0] > 20 && tally.motions[1] > 5 && tally.motions[2] > 5);
    assert_true(tally.sparse > 10 && tally.dense > 10 && tally.slack > 10 && tally.taut > 10);
    assert_true(tally.amplified > 5 && tally.ideal > 5 && tally.leaking > 5 && tally.sheet > 5 && tally.stopped > 5);
    assert_true(tally.foo > 20 && tally.network > 20);
    assert_true(compared > 0.9 * (double)wanted);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_random_states)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
