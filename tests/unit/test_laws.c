/* Elastic laws: derivatives against differences of the energy, agreement where laws must agree, limits. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>
#include <string.h>

#include "deasim/material.h"

#include "differences.h"

static const struct dea_law gent = {.kind = DEA_GENT, .mu = 0.365e6, .jm = 16.6};
static const struct dea_law neo_hookean = {.kind = DEA_NEO_HOOKEAN, .mu = 0.365e6};
static const struct dea_law yeoh = {.kind = DEA_YEOH, .yeoh_terms = 3, .yeoh = {180.7e3, -16.7e3, 6.6e3}};
static const struct dea_law ogden = {
    .kind = DEA_OGDEN, .ogden_terms = 3, .ogden_mu = {0.2e6, 0.03e6, -0.05e6}, .ogden_alpha = {1.7, 4.3, -2.1}};
static const struct dea_law arruda_boyce = {.kind = DEA_ARRUDA_BOYCE, .mu = 15.36e3, .locking_stretch = 5.99};
static const struct dea_law *const laws[] = {&gent, &neo_hookean, &yeoh, &ogden, &arruda_boyce};
enum { LAWS = sizeof laws / sizeof laws[0] };

struct path {
    const struct dea_law *law;
    double other; /* the stretch held */
};

static double energy_by_lam1(double lam1, void *context) {
    const struct path *path = context;
    double energy;
    assert_int_equal(dea_law_energy(path->law, lam1, path->other, &energy), DEA_OK);
    return energy;
}

static double energy_by_lam2(double lam2, void *context) {
    const struct path *path = context;
    double energy;
    assert_int_equal(dea_law_energy(path->law, path->other, lam2, &energy), DEA_OK);
    return energy;
}

static double w1_by_lam1(double lam1, void *context) {
    const struct path *path = context;
    struct dea_stress stress;
    assert_int_equal(dea_law_stress(path->law, lam1, path->other, &stress), DEA_OK);
    return stress.w1;
}

static void assert_near(double value, double expected, double scale) {
    if (!(fabs(value - expected) <= scale))
        fail_msg("%.17g is not %.17g within %.3g", value, expected, scale);
}

static void stresses_are_derivatives_of_the_energy(void **state) {
    (void)state;
    unsigned long long seed = 2024;
    for (int l = 0; l < LAWS; l++) {
        double modulus = dea_law_modulus(laws[l]);
        for (int i = 0; i < 200; i++) {
            double lam1 = draw_between(&seed, 0.7, 2.2), lam2 = draw_between(&seed, 0.7, 2.2), h = 2e-3;
            struct dea_stress stress;
            assert_int_equal(dea_law_stress(laws[l], lam1, lam2, &stress), DEA_OK);
            struct path along1 = {laws[l], lam2}, along2 = {laws[l], lam1};
            double scale = 1e-10 * (modulus + fabs(stress.w1) + fabs(stress.w2) + stress.w11);
            assert_near(differentiate(energy_by_lam1, &along1, lam1, h), stress.w1, scale);
            assert_near(differentiate(energy_by_lam2, &along2, lam2, h), stress.w2, scale);
            assert_near(differentiate(w1_by_lam1, &along1, lam1, h), stress.w11, scale);
        }
    }
}

static void rest_is_free_of_energy_and_stress(void **state) {
    (void)state;
    for (int l = 0; l < LAWS; l++) {
        struct dea_stress stress;
        double energy;
        assert_int_equal(dea_law_energy(laws[l], 1.0, 1.0, &energy), DEA_OK);
        assert_int_equal(dea_law_stress(laws[l], 1.0, 1.0, &stress), DEA_OK);
        assert_near(energy, 0.0, 1e-15 * dea_law_modulus(laws[l]));
        assert_near(stress.w1, 0.0, 1e-15 * dea_law_modulus(laws[l]));
        /* small strain, width held: W11 = 4 mu */
        assert_near(stress.w11, 4.0 * dea_law_modulus(laws[l]), 1e-13 * stress.w11);
    }
}

/* The same stresses and energies at many stretches, within `tolerance` of the first law's. */
static void assert_same_law(const struct dea_law *a, const struct dea_law *b, double tolerance) {
    unsigned long long seed = 7;
    for (int i = 0; i < 200; i++) {
        double lam1 = draw_between(&seed, 0.6, 3.0), lam2 = draw_between(&seed, 0.6, 3.0), energy_a, energy_b;
        struct dea_stress sa, sb;
        assert_int_equal(dea_law_stress(a, lam1, lam2, &sa), DEA_OK);
        assert_int_equal(dea_law_stress(b, lam1, lam2, &sb), DEA_OK);
        assert_int_equal(dea_law_energy(a, lam1, lam2, &energy_a), DEA_OK);
        assert_int_equal(dea_law_energy(b, lam1, lam2, &energy_b), DEA_OK);
        double scale = tolerance * (fabs(sa.w1) + fabs(sa.w2) + sa.w11);
        assert_near(sb.w1, sa.w1, scale);
        assert_near(sb.w2, sa.w2, scale);
        assert_near(sb.w11, sa.w11, scale);
        assert_near(energy_b, energy_a, scale);
    }
}

static void laws_agree_where_they_must(void **state) {
    (void)state;
    struct dea_law wide_gent = gent;
    wide_gent.jm = 1e9;
    assert_same_law(&neo_hookean, &wide_gent, 1e-7); /* the excess over Jm remains */
    struct dea_law ogden2 = {.kind = DEA_OGDEN, .ogden_terms = 1, .ogden_mu = {neo_hookean.mu}, .ogden_alpha = {2.0}};
    assert_same_law(&neo_hookean, &ogden2, 1e-13);
    struct dea_law yeoh1 = {.kind = DEA_YEOH, .yeoh_terms = 1, .yeoh = {0.5 * neo_hookean.mu}};
    assert_same_law(&neo_hookean, &yeoh1, 1e-15);
    struct dea_law long_chains = {.kind = DEA_ARRUDA_BOYCE, .mu = neo_hookean.mu, .locking_stretch = 1e5};
    assert_same_law(&neo_hookean, &long_chains, 1e-7);
    /* Mooney-Rivlin as two Ogden terms: mu2/alpha2 with alpha2 = -2 adds the second invariant */
    struct dea_law mooney = {
        .kind = DEA_OGDEN, .ogden_terms = 2, .ogden_mu = {0.3e6, -0.05e6}, .ogden_alpha = {2.0, -2.0}};
    double energy, lam1 = 1.3, lam2 = 1.6, lam3 = 1.0 / (lam1 * lam2);
    assert_int_equal(dea_law_energy(&mooney, lam1, lam2, &energy), DEA_OK);
    double i1 = lam1 * lam1 + lam2 * lam2 + lam3 * lam3;
    double i2 = 1.0 / (lam1 * lam1) + 1.0 / (lam2 * lam2) + 1.0 / (lam3 * lam3);
    assert_near(energy, 0.15e6 * (i1 - 3.0) + 0.025e6 * (i2 - 3.0), 1e-9 * energy);
}

/* Series of Arruda and Boyce (1993), eq. 12, five terms: good to 1e-4 well below locking. */
static void arruda_boyce_follows_its_series(void **state) {
    (void)state;
    double lock = 8.0, lam1 = 1.2, lam2 = 1.1, lam3 = 1.0 / (lam1 * lam2);
    struct dea_law law = {.kind = DEA_ARRUDA_BOYCE, .mu = 1e5, .locking_stretch = lock};
    double i1 = lam1 * lam1 + lam2 * lam2 + lam3 * lam3, n = lock * lock, energy;
    assert_int_equal(dea_law_energy(&law, lam1, lam2, &energy), DEA_OK);
    double series = 0.5 * (i1 - 3.0) + (i1 * i1 - 9.0) / (20.0 * n) + 11.0 * (pow(i1, 3) - 27.0) / (1050.0 * n * n) +
                    19.0 * (pow(i1, 4) - 81.0) / (7000.0 * n * n * n) +
                    519.0 * (pow(i1, 5) - 243.0) / (673750.0 * n * n * n * n);
    assert_near(energy, 1e5 * series, 1e-7 * energy);
}

static void limits_are_recoverable_failures(void **state) {
    (void)state;
    struct dea_stress stress = {.w1 = 42.0};
    double energy = 42.0;
    /* I1 = Jm + 3 exactly and beyond; lock at sqrt(I1/3) = lam_L */
    double lam = 4.0, at_limit_jm = lam * lam + 1.0 + 1.0 / (lam * lam) - 3.0;
    struct dea_law edge = gent;
    edge.jm = at_limit_jm * (1.0 - 1e-12);
    assert_int_equal(dea_law_stress(&edge, lam, 1.0, &stress), DEA_RECOVERABLE);
    assert_int_equal(dea_law_energy(&edge, lam, 1.0, &energy), DEA_RECOVERABLE);
    assert_true(dea_law_margin(&edge, lam, 1.0) <= 0.0);
    edge.jm = at_limit_jm * (1.0 + 1e-9);
    assert_int_equal(dea_law_stress(&edge, lam, 1.0, &stress), DEA_OK);
    assert_true(stress.w1 > 1e12 && isfinite(stress.w11));

    stress.w1 = energy = 42.0;
    assert_int_equal(dea_law_stress(&arruda_boyce, 11.0, 1.0, &stress), DEA_RECOVERABLE);
    assert_int_equal(dea_law_energy(&arruda_boyce, 11.0, 1.0, &energy), DEA_RECOVERABLE);
    for (int l = 0; l < LAWS; l++) {
        assert_int_equal(dea_law_stress(laws[l], 0.0, 1.0, &stress), DEA_RECOVERABLE);
        assert_int_equal(dea_law_stress(laws[l], -1.0, 1.0, &stress), DEA_RECOVERABLE);
        assert_int_equal(dea_law_stress(laws[l], NAN, 1.0, &stress), DEA_RECOVERABLE);
        assert_int_equal(dea_law_stress(laws[l], 1.0, NAN, &stress), DEA_RECOVERABLE);
        assert_int_equal(dea_law_energy(laws[l], 0.0, 1.0, &energy), DEA_RECOVERABLE);
    }
    assert_true(stress.w1 == 42.0 && energy == 42.0); /* untouched */
}

static void margins_fall_from_near_one_to_zero(void **state) {
    (void)state;
    assert_near(dea_law_margin(&gent, 1.0, 1.0), 1.0, 1e-15);
    assert_near(dea_law_margin(&arruda_boyce, 1.0, 1.0), 1.0 - 1.0 / (5.99 * 5.99), 1e-15);
    assert_true(dea_law_margin(&neo_hookean, 9.0, 9.0) == 1.0);
    double before = 1.0;
    for (double lam = 1.1; lam < 4.5; lam += 0.1) {
        double margin = dea_law_margin(&gent, lam, 1.0);
        assert_true(margin < before);
        before = margin;
    }
    assert_true(before < 0.0);
}

static void near_locking_the_chains_stay_exact(void **state) {
    (void)state;
    /* coth b - 1/b = y with b so large that coth is 1: y = 1 - 1/b */
    double b = 400.0, y = 1.0 - 1.0 / b, lock = 3.0, i1 = 3.0 * lock * lock * y * y;
    /* uniaxial-like: lam2 = 1, lam1^2 + 1 + lam1^-2 = i1 */
    double s = i1 - 1.0, lam1 = sqrt(0.5 * (s + sqrt(s * s - 4.0)));
    struct dea_law law = {.kind = DEA_ARRUDA_BOYCE, .mu = 1e5, .locking_stretch = lock};
    struct dea_stress stress;
    assert_int_equal(dea_law_stress(&law, lam1, 1.0, &stress), DEA_OK);
    double expected = law.mu * b / (6.0 * y) * 2.0 * (lam1 - pow(lam1, -3.0));
    assert_near(stress.w1, expected, 1e-9 * expected);
}

static void names_and_laws_belong_together(void **state) {
    (void)state;
    for (int kind = 0; kind < DEA_LAW_COUNT; kind++)
        assert_int_equal(dea_law_from_name(dea_law_name((enum dea_law_kind)kind)), kind);
    assert_int_equal(dea_law_from_name("hooke"), DEA_LAW_COUNT);
    assert_string_equal(dea_law_name(DEA_LAW_COUNT), "unknown");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(stresses_are_derivatives_of_the_energy),
        cmocka_unit_test(rest_is_free_of_energy_and_stress),
        cmocka_unit_test(laws_agree_where_they_must),
        cmocka_unit_test(arruda_boyce_follows_its_series),
        cmocka_unit_test(limits_are_recoverable_failures),
        cmocka_unit_test(margins_fall_from_near_one_to_zero),
        cmocka_unit_test(near_locking_the_chains_stay_exact),
        cmocka_unit_test(names_and_laws_belong_together),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
