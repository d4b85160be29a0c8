/* Viscoelastic branches: derivatives against differences, energy and dissipation, agreement in small strain. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>

#include "deasim/material.h"

#include "differences.h"

static const double prestretch[2] = {1.2, 1.7};
static const struct dea_branch kinds[] = {
    {DEA_BRANCH_FOO, 3e4, 2e-3, INFINITY}, {DEA_BRANCH_FOO, 3e4, 2e-3, 9.0}, {DEA_BRANCH_NETWORK, 3e4, 2e-3, INFINITY}};
enum { KINDS = sizeof kinds / sizeof kinds[0] };

static void assert_near(double value, double expected, double scale) {
    if (!(fabs(value - expected) <= scale))
        fail_msg("%.17g is not %.17g within %.3g", value, expected, scale);
}

/* One quantity of a branch as a function of one argument. */
struct probe {
    const struct dea_branch *branch;
    double lam1, z[2];
    int argument; /* 0 lam1, 1 z0, 2 z1 */
    int quantity; /* 0 energy, 1 p1, 2 rate0, 3 rate1, 4 s2 */
};

static double evaluate_probe(double value, void *context) {
    const struct probe *probe = context;
    double lam1 = probe->argument == 0 ? value : probe->lam1;
    double z[2] = {probe->argument == 1 ? value : probe->z[0], probe->argument == 2 ? value : probe->z[1]};
    struct dea_branch_response r;
    double energy;
    assert_int_equal(dea_branch_energy(probe->branch, prestretch, lam1, z, &energy), DEA_OK);
    assert_int_equal(dea_branch_respond(probe->branch, prestretch, lam1, z, false, &r), DEA_OK);
    const double values[] = {energy, r.p1, r.rate[0], r.rate[1], r.s2};
    return values[probe->quantity];
}

static double slope(struct probe probe, int quantity, int argument) {
    probe.quantity = quantity;
    probe.argument = argument;
    double at = argument == 0 ? probe.lam1 : probe.z[argument - 1];
    return differentiate(evaluate_probe, &probe, at, 1e-3);
}

static void draw_state(unsigned long long *seed, struct probe *probe) {
    probe->lam1 = draw_between(seed, 0.95, 1.6);
    probe->z[0] = draw_between(seed, -0.15, 0.25);
    probe->z[1] = draw_between(seed, -0.15, 0.25);
}

static void derivatives_match_differences(void **state) {
    (void)state;
    unsigned long long seed = 11;
    for (int kind = 0; kind < KINDS; kind++) {
        for (int i = 0; i < 200; i++) {
            struct probe probe = {.branch = &kinds[kind]};
            draw_state(&seed, &probe);
            struct dea_branch_response r;
            assert_int_equal(dea_branch_respond(probe.branch, prestretch, probe.lam1, probe.z, true, &r), DEA_OK);
            double stress = 1e-9 * probe.branch->mu, rate = 1e-9 / probe.branch->tau;
            assert_near(slope(probe, 0, 0), r.p1, stress); /* the stress is a derivative of the energy */
            assert_near(slope(probe, 1, 0), r.dp1_dlam1, 10.0 * stress);
            for (int j = 0; j < 2; j++) {
                assert_near(slope(probe, 1, 1 + j), r.dp1_dz[j], 10.0 * stress);
                assert_near(slope(probe, 2 + j, 0), r.drate_dlam1[j], 10.0 * rate);
                for (int l = 0; l < 2; l++)
                    assert_near(slope(probe, 2 + j, 1 + l), r.drate_dz[j][l], 10.0 * rate);
            }
        }
    }
}

static void what_the_energy_loses_is_dissipated(void **state) {
    (void)state;
    unsigned long long seed = 5;
    for (int kind = 0; kind < KINDS; kind++) {
        for (int i = 0; i < 200; i++) {
            struct probe probe = {.branch = &kinds[kind]};
            draw_state(&seed, &probe);
            struct dea_branch_response r;
            assert_int_equal(dea_branch_respond(probe.branch, prestretch, probe.lam1, probe.z, false, &r), DEA_OK);
            double change = slope(probe, 0, 1) * r.rate[0] + slope(probe, 0, 2) * r.rate[1];
            assert_true(r.dissipation >= 0.0);
            assert_near(change, -r.dissipation, 1e-9 * probe.branch->mu / probe.branch->tau);
        }
    }
}

/* s2 = lam2 dW/dlam2 at fixed internal stretches: for foo, whose elastic stretch in direction 2 is lam2/xi2. */
static void lateral_stress_follows_from_the_energy(void **state) {
    (void)state;
    unsigned long long seed = 17;
    for (int kind = 0; kind < 2; kind++) {
        for (int i = 0; i < 50; i++) {
            struct probe probe = {.branch = &kinds[kind]};
            draw_state(&seed, &probe);
            struct dea_branch_response r;
            assert_int_equal(dea_branch_respond(probe.branch, prestretch, probe.lam1, probe.z, false, &r), DEA_OK);
            /* scaling lam2 is scaling 1/(1 + z1): s2 = -(1 + z1) dW/dz1 */
            assert_near(-(1.0 + probe.z[1]) * slope(probe, 0, 2), r.s2, 1e-9 * probe.branch->mu);
        }
    }
}

static void relaxed_states_rest(void **state) {
    (void)state;
    for (int kind = 0; kind < KINDS; kind++) {
        for (double lam1 = 0.9; lam1 < 2.0; lam1 += 0.2) {
            double z[2], energy;
            struct dea_branch_response r;
            dea_branch_relaxed(&kinds[kind], prestretch, lam1, z);
            assert_int_equal(dea_branch_respond(&kinds[kind], prestretch, lam1, z, false, &r), DEA_OK);
            assert_int_equal(dea_branch_energy(&kinds[kind], prestretch, lam1, z, &energy), DEA_OK);
            double rounding = 1e-14 * kinds[kind].mu;
            assert_near(r.p1, 0.0, rounding);
            assert_near(r.s2, 0.0, rounding);
            assert_near(r.rate[0] * kinds[kind].tau, 0.0, 1e-14);
            assert_near(r.rate[1] * kinds[kind].tau, 0.0, 1e-14);
            assert_near(energy, 0.0, rounding);
            assert_near(r.dissipation * kinds[kind].tau, 0.0, rounding);
        }
    }
}

/* xi = 1: the branch carries the stress its spring would have at the full stretches. */
static void fresh_branches_carry_the_full_stretch(void **state) {
    (void)state;
    double lam1 = prestretch[0], lam2 = prestretch[1];
    struct dea_law springs[KINDS] = {{.kind = DEA_NEO_HOOKEAN, .mu = 3e4},
                                     {.kind = DEA_GENT, .mu = 3e4, .jm = 9.0},
                                     {.kind = DEA_NEO_HOOKEAN, .mu = 3e4}};
    for (int kind = 0; kind < KINDS; kind++) {
        double z[2];
        struct dea_branch_response r;
        struct dea_stress stress;
        dea_branch_fresh(&kinds[kind], prestretch, z);
        assert_int_equal(dea_branch_respond(&kinds[kind], prestretch, lam1, z, false, &r), DEA_OK);
        assert_int_equal(dea_law_stress(&springs[kind], lam1, lam2, &stress), DEA_OK);
        assert_near(r.p1, stress.w1, 1e-12 * stress.w1);
        if (kinds[kind].kind == DEA_BRANCH_FOO)
            assert_near(r.s2, lam2 * stress.w2, 1e-12 * r.s2);
        else /* a2 stays lam2^-2: the network holds no memory of the width */
            assert_near(r.s2, 3e4 * (1.0 - 1.0 / (lam1 * lam1 * lam2 * lam2)), 1e-12 * r.s2);
    }
}

/* Stress over time after a small step of stretch, by many small steps of the classical fourth-order method. */
static void relax(const struct dea_branch *branch, double strain, int count, double end, double *stresses) {
    double lam1 = prestretch[0] * (1.0 + strain), z[2], h = end / count;
    struct dea_branch_response k[4];
    dea_branch_relaxed(branch, prestretch, prestretch[0], z);
    for (int i = 0; i < count; i++) {
        double at[2] = {z[0], z[1]};
        static const double part[4] = {0.5, 0.5, 1.0, 0.0}, weight[4] = {1.0 / 6, 1.0 / 3, 1.0 / 3, 1.0 / 6};
        double next[2] = {z[0], z[1]};
        for (int s = 0; s < 4; s++) {
            assert_int_equal(dea_branch_respond(branch, prestretch, lam1, at, false, &k[s]), DEA_OK);
            for (int j = 0; j < 2; j++) {
                next[j] += h * weight[s] * k[s].rate[j];
                at[j] = z[j] + h * part[s] * k[s].rate[j];
            }
        }
        stresses[i] = k[0].p1;
        z[0] = next[0];
        z[1] = next[1];
    }
}

/* With logarithmic elastic strains q, s1 = mu (4 q1 + 2 q2) and s2 = mu (2 q1 + 4 q2), so that the flow rule of foo
 * becomes q' = -q / tau in both directions: like the network, one decay from 4 mu strain / lam1. */
static void small_strains_relax_as_linear_theory_says(void **state) {
    (void)state;
    enum { COUNT = 4000 };
    static double foo[COUNT], network[COUNT];
    double strain = 1e-6, mu = 3e4, tau = 2e-3, end = 6e-3;
    relax(&kinds[0], strain, COUNT, end, foo);
    relax(&kinds[2], strain, COUNT, end, network);
    double start = 4.0 * mu * strain / (prestretch[0] * (1.0 + strain));
    assert_near(foo[0], start, 1e-5 * start);
    assert_near(network[0], start, 1e-5 * start);
    for (int i = 0; i < COUNT; i += 100) {
        double t = end * i / COUNT;
        assert_near(network[i], start * exp(-t / tau), 2e-5 * start);
        assert_near(foo[i], start * exp(-t / tau), 2e-5 * start);
    }
}

static void outside_the_spring_is_recoverable(void **state) {
    (void)state;
    struct dea_branch_response r;
    double energy, gone[2] = {-1.0, 0.0}, wide[2] = {0.0, -1.5}, far[2] = {-0.8, 0.0}, fine[2] = {0.0, 0.0};
    for (int kind = 0; kind < KINDS; kind++) {
        assert_int_equal(dea_branch_respond(&kinds[kind], prestretch, 1.2, gone, true, &r), DEA_RECOVERABLE);
        assert_int_equal(dea_branch_respond(&kinds[kind], prestretch, 1.2, wide, true, &r), DEA_RECOVERABLE);
        assert_int_equal(dea_branch_respond(&kinds[kind], prestretch, 0.0, fine, true, &r), DEA_RECOVERABLE);
        assert_int_equal(dea_branch_respond(&kinds[kind], prestretch, NAN, fine, true, &r), DEA_RECOVERABLE);
        assert_int_equal(dea_branch_energy(&kinds[kind], prestretch, 1.2, gone, &energy), DEA_RECOVERABLE);
    }
    /* beyond the Gent spring's limit: elastic stretch 5, I1 - 3 = 22 > 9 */
    assert_int_equal(dea_branch_respond(&kinds[1], prestretch, 1.2, far, true, &r), DEA_RECOVERABLE);
    assert_int_equal(dea_branch_energy(&kinds[1], prestretch, 1.2, far, &energy), DEA_RECOVERABLE);
    assert_int_equal(dea_branch_respond(&kinds[0], prestretch, 1.2, far, true, &r), DEA_OK);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(derivatives_match_differences),
        cmocka_unit_test(what_the_energy_loses_is_dissipated),
        cmocka_unit_test(lateral_stress_follows_from_the_energy),
        cmocka_unit_test(relaxed_states_rest),
        cmocka_unit_test(fresh_branches_carry_the_full_stretch),
        cmocka_unit_test(small_strains_relax_as_linear_theory_says),
        cmocka_unit_test(outside_the_spring_is_recoverable),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
