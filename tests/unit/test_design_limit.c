/* The fast limit of a design against the general walk along the path, over random designs. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>

#include "deasim/study.h"

/* Park and Miller's generator: the same designs on every machine. */
static double uniform(uint32_t *seed, double low, double high) {
    *seed = (uint32_t)((uint64_t)*seed * 48271u % 2147483647u);
    return low + (high - low) * ((double)*seed / 2147483647.0);
}

static struct dea_design random_design(uint32_t *seed) {
    struct dea_design design = dea_design_of_paper();
    static const enum dea_law_kind kinds[] = {DEA_GENT, DEA_GENT, DEA_NEO_HOOKEAN, DEA_ARRUDA_BOYCE};
    design.elastic.kind = kinds[(int)uniform(seed, 0.0, 4.0)];
    design.elastic.mu = uniform(seed, 0.05e6, 1e6);
    design.elastic.jm = uniform(seed, 4.0, 40.0);
    design.elastic.locking_stretch = uniform(seed, 1.8, 6.0);
    design.dielectric.permittivity = uniform(seed, 2.0, 8.0);
    design.dielectric.breakdown = uniform(seed, 0.0, 1.0) < 0.1 ? INFINITY : uniform(seed, 20e6, 300e6);
    design.prestretch[0] = uniform(seed, 0.5, 2.5);
    design.prestretch[1] = uniform(seed, 0.7, 4.0);
    design.active_ratio = uniform(seed, 0.02, 0.98);
    design.thickness = uniform(seed, 5e-6, 100e-6);
    design.dead_load = uniform(seed, 0.0, 1.0) < 0.2;
    return design;
}

/* Largest relative difference of two ends. */
static double distance(const struct dea_design_end *fast, const struct dea_limit *walk) {
    double voltage = fabs(fast->voltage / walk->voltage - 1.0), stretch = fabs(fast->stretch / walk->stretch - 1.0);
    double field = fabs(fast->true_field / walk->true_field - 1.0);
    return fmax(fmax(voltage, stretch), field);
}

static void fast_limit_agrees_with_the_walk(void **state) {
    (void)state;
    uint32_t seed = 20150317;
    int seen[DEA_LIMIT_COUNT] = {0};
    double worst = 0.0;
    for (int i = 0; i < 20000; i++) {
        struct dea_design design = random_design(&seed);
        struct dea_design_end end;
        assert_int_equal(dea_design_limit(&design, &end, NULL), DEA_OK);
        struct dea_device device;
        assert_int_equal(dea_design_to_device(&design, 1e-2, 1e-2, false, &device, NULL), DEA_OK);
        struct dea_limit limit;
        assert_int_equal(dea_static_limit(&device, 0.0, &limit, NULL), DEA_OK);
        if (end.mode != limit.mode) {
            print_error("design %d: fast %s, walk %s\n", i, dea_limit_names[end.mode], dea_limit_names[limit.mode]);
            fail();
        }
        seen[end.mode]++;
        if (!isnan(limit.voltage))
            worst = fmax(worst, distance(&end, &limit));
    }
    assert_true(worst < 1e-12);
    assert_true(seen[DEA_LIMIT_BREAKDOWN] > 1000 && seen[DEA_LIMIT_SLACK1] > 1000 && seen[DEA_LIMIT_SLACK2] > 1000);
    assert_true(seen[DEA_LIMIT_PRESTRETCH] > 1000);
    print_message("largest difference %.2g; breakdown %d, slack1 %d, slack2 %d, gent %d, prestretch %d\n", worst,
                  seen[DEA_LIMIT_BREAKDOWN], seen[DEA_LIMIT_SLACK1], seen[DEA_LIMIT_SLACK2], seen[DEA_LIMIT_LAW],
                  seen[DEA_LIMIT_PRESTRETCH]);
}

/* A tension to be kept: at the end the passive part carries exactly that, in the fast way and in the general one. */
static void least_tension_ends_the_drive(void **state) {
    (void)state;
    struct dea_design design = dea_design_of_paper();
    design.prestretch[0] = 0.88;
    design.least_tension = 90e3;
    struct dea_design_end end, general;
    assert_int_equal(dea_design_limit(&design, &end, NULL), DEA_OK);
    assert_int_equal(end.mode, DEA_LIMIT_SLACK1);
    assert_true(fabs(end.passive_stress1 / 90e3 - 1.0) < 1e-12);
    assert_true(end.true_field < 100e6);
    design.dielectric.permittivity_slope = 1e-300; /* not constant, hence the general way */
    assert_int_equal(dea_design_limit(&design, &general, NULL), DEA_OK);
    assert_int_equal(general.mode, DEA_LIMIT_SLACK1);
    assert_true(fabs(general.stretch / end.stretch - 1.0) < 1e-13);
    assert_true(fabs(general.passive_stress1 / 90e3 - 1.0) < 1e-11);
    assert_true(fabs(general.stress1 / end.stress1 - 1.0) < 1e-11);

    design.least_tension = 200e3; /* more than the prestretch gives */
    assert_int_equal(dea_design_limit(&design, &end, NULL), DEA_OK);
    assert_int_equal(end.mode, DEA_LIMIT_PRESTRETCH);
}

/* A supply that ends before anything fails, both ways. */
static void supply_ends_the_drive(void **state) {
    (void)state;
    struct dea_design design = dea_design_of_paper();
    design.max_voltage = 1500.0;
    struct dea_design_end end, general;
    assert_int_equal(dea_design_limit(&design, &end, NULL), DEA_OK);
    assert_int_equal(end.mode, DEA_LIMIT_SUPPLY);
    assert_true(fabs(end.voltage / 1500.0 - 1.0) < 1e-14);
    design.dielectric.permittivity_slope = 1e-300;
    assert_int_equal(dea_design_limit(&design, &general, NULL), DEA_OK);
    assert_int_equal(general.mode, DEA_LIMIT_SUPPLY);
    assert_true(fabs(general.stretch / end.stretch - 1.0) < 1e-13);
    assert_true(fabs(general.displacement / end.displacement - 1.0) < 1e-12);
    assert_true(fabs(general.stress2 / end.stress2 - 1.0) < 1e-12);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(fast_limit_agrees_with_the_walk),
        cmocka_unit_test(least_tension_ends_the_drive),
        cmocka_unit_test(supply_ends_the_drive),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
