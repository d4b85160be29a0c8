/* A zone's film: pull as the slope of its energy, derivatives by position, charge, voltage and branch states, the
 * natural stretch of slack films by bisection, and what slack does to the energy. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>
#include <string.h>

#include "deasim/film.h"

#include "differences.h"

enum { BRANCHES = 3 };

static struct dea_branch branches[BRANCHES] = {
    {DEA_BRANCH_FOO, 4e4, 1e-3, INFINITY}, {DEA_BRANCH_FOO, 3e4, 1e-2, 20.0}, {DEA_BRANCH_NETWORK, 5e4, 0.1, INFINITY}};

static void assert_near(double value, double expected, double scale) {
    if (!(fabs(value - expected) <= scale))
        fail_msg("%.17g is not %.17g within %.3g", value, expected, scale);
}

static struct dea_device make_device(double lp1, double lp2, int branch_count, double permittivity_slope) {
    struct dea_device d = {.width = 30e-3, .thickness = 33e-6, .prestretch = {lp1, lp2}, .slack = true};
    d.material.elastic = (struct dea_law){.kind = DEA_GENT, .mu = 0.365e6, .jm = 16.6};
    d.material.dielectric = (struct dea_dielectric){.permittivity = 2.5 - permittivity_slope,
                                                    .permittivity_slope = permittivity_slope,
                                                    .breakdown = INFINITY,
                                                    .conductivity_field = INFINITY};
    d.material.branches = branches;
    d.material.branch_count = branch_count;
    d.zones[0] = (struct dea_zone){.present = true, .electroded = true, .length = 4e-3};
    d.zones[1] = (struct dea_zone){.present = true, .electroded = true, .length = 3e-3};
    assert_int_equal(dea_device_prepare(&d, NULL), DEA_OK);
    return d;
}

/* Arguments of a film and which of them moves, which result is looked at. */
struct probe {
    const struct dea_device *device;
    int zone;
    enum dea_control control;
    double x, e, states[2 * BRANCHES];
    int argument; /* 0 x, 1 e, 2 + j state j */
    enum { STRETCH, PULL, VOLTAGE, CHARGE, ENERGY } result;
};

static void respond(const struct probe *p, bool with_derivatives, struct dea_film *film,
                    struct dea_branch_response *responses) {
    assert_int_equal(
        dea_film_respond(p->device, p->zone, p->control, p->x, p->e, p->states, with_derivatives, responses, film),
        DEA_OK);
}

static double evaluate_probe(double value, void *context) {
    struct probe p = *(const struct probe *)context;
    struct dea_film film;
    struct dea_branch_response responses[BRANCHES];
    double energy;
    if (p.argument == 0)
        p.x = value;
    else if (p.argument == 1)
        p.e = value;
    else
        p.states[p.argument - 2] = value;
    respond(&p, false, &film, responses);
    switch (p.result) {
    case STRETCH:
        return film.lam;
    case PULL:
        return film.pull;
    case VOLTAGE:
        return film.voltage;
    case CHARGE:
        return film.charge;
    default:
        assert_int_equal(dea_film_energy(p.device, p.zone, film.lam, film.charge, p.states, &energy), DEA_OK);
        return energy;
    }
}

static double slope(struct probe p, int argument, int result) {
    p.argument = argument;
    p.result = result;
    double at = argument == 0 ? p.x : argument == 1 ? p.e : p.states[argument - 2];
    double step = argument == 0 ? 2e-6 : argument == 1 ? 1e-3 * fmax(fabs(p.e), 1e-12) : 1e-4;
    return differentiate(evaluate_probe, &p, at, step);
}

/* A state near x, taut or slack by the signs asked for; slack needs a low prestretch. */
static struct probe draw_probe(const struct dea_device *device, unsigned long long *seed, enum dea_control control,
                               bool slack) {
    struct probe p = {.device = device, .zone = draw_between(seed, 0, 1) < 0.5 ? 0 : 1, .control = control};
    double side = device->zones[p.zone].side, shift = slack ? -0.3 : 0.1;
    p.x = side * device->zones[p.zone].length * (shift + draw_between(seed, -0.05, 0.05));
    double volts = draw_between(seed, 500.0, 1500.0);
    p.e = control == DEA_CONTROL_PASSIVE   ? 0.0
          : control == DEA_CONTROL_VOLTAGE ? volts
                                           : volts * device->zones[p.zone].rest_capacitance;
    for (int j = 0; j < 2 * BRANCHES; j++)
        p.states[j] = draw_between(seed, -0.03, 0.03);
    return p;
}

static void assert_derivatives(const struct probe *p, bool slack) {
    struct dea_film film;
    struct dea_branch_response responses[BRANCHES];
    respond(p, true, &film, responses);
    assert_int_equal(film.slack, slack);
    double stiffness = p->device->stiffness, length = p->device->zones[p->zone].length;
    double e = p->control == DEA_CONTROL_PASSIVE ? 1.0 : fabs(p->e), pull = stiffness * length;
    assert_near(slope(*p, 0, STRETCH), film.dlam_dx, 1e-8 / length);
    assert_near(slope(*p, 0, PULL), film.dpull_dx, 1e-7 * stiffness);
    if (p->control != DEA_CONTROL_PASSIVE) {
        assert_near(slope(*p, 1, STRETCH), film.dlam_de, 1e-8 / e);
        assert_near(slope(*p, 1, PULL), film.dpull_de, 1e-7 * pull / e);
        double by_e = film.dvoltage_de + film.dvoltage_dlam * film.dlam_de;
        assert_near(slope(*p, 1, VOLTAGE), by_e, 1e-7 * fmax(fabs(film.voltage) / e, 1.0));
        by_e = film.dcharge_de + film.dcharge_dlam * film.dlam_de;
        assert_near(slope(*p, 1, CHARGE), by_e, 1e-7 * fabs(film.charge) / e);
        assert_near(slope(*p, 0, VOLTAGE), film.dvoltage_dlam * film.dlam_dx, 1e-7 * fabs(film.voltage) / length);
        assert_near(slope(*p, 0, CHARGE), film.dcharge_dlam * film.dlam_dx, 1e-7 * fabs(film.charge) / length);
    }
    for (int b = 0; b < p->device->material.branch_count; b++)
        for (int i = 0; i < 2; i++) {
            double by_stress = responses[b].dp1_dz[i];
            assert_near(slope(*p, 2 + 2 * b + i, STRETCH), film.dlam_dp1 * by_stress, 1e-8);
            assert_near(slope(*p, 2 + 2 * b + i, PULL), film.dpull_dp1 * by_stress, 1e-7 * pull);
        }
}

static void derivatives_match_differences(void **state) {
    (void)state;
    static const enum dea_control controls[] = {DEA_CONTROL_PASSIVE, DEA_CONTROL_CHARGE, DEA_CONTROL_VOLTAGE};
    unsigned long long seed = 99;
    for (int c = 0; c < 3; c++)
        for (int sloped = 0; sloped < 2; sloped++)
            for (int slack = 0; slack < 2; slack++)
                for (int count = 0; count <= BRANCHES; count += BRANCHES)
                    for (int i = 0; i < 20; i++) {
                        struct dea_device d = make_device(0.95, 1.6, count, sloped ? -0.2 : 0.0);
                        struct probe p = draw_probe(&d, &seed, controls[c], slack);
                        assert_derivatives(&p, slack);
                    }
}

/* Under charge control nothing flows in: the pull is the slope of the stored energy, taut and slack. */
static void the_pull_is_the_slope_of_the_energy(void **state) {
    (void)state;
    unsigned long long seed = 3;
    for (int i = 0; i < 100; i++) {
        struct dea_device d = make_device(0.95, 1.6, BRANCHES, i % 2 ? -0.2 : 0.0);
        struct probe p = draw_probe(&d, &seed, i % 3 ? DEA_CONTROL_CHARGE : DEA_CONTROL_PASSIVE, i % 4 == 3);
        struct dea_film film;
        struct dea_branch_response responses[BRANCHES];
        respond(&p, false, &film, responses);
        double side = d.zones[p.zone].side;
        assert_near(slope(p, 0, ENERGY), side * film.pull, 1e-8 * d.stiffness * 4e-3);
        if (p.control == DEA_CONTROL_CHARGE) /* and the voltage its slope by charge */
            assert_near(slope(p, 1, ENERGY), film.voltage, 1e-8 * film.voltage);
    }
}

/* Net nominal stress at a stretch, from the stresses themselves. */
static double net_stress(const struct probe *p, double lam) {
    const struct dea_device *d = p->device;
    struct dea_stress stress;
    assert_int_equal(dea_law_stress(&d->material.elastic, lam, d->prestretch[1], &stress), DEA_OK);
    double sum = stress.w1;
    for (int b = 0; b < d->material.branch_count; b++) {
        struct dea_branch_response r;
        const double *z = p->states + 2 * b;
        assert_int_equal(dea_branch_respond(&d->material.branches[b], d->prestretch, lam, z, false, &r), DEA_OK);
        sum += r.p1;
    }
    double slope_c, c = dea_zone_capacitance(d, p->zone, lam, &slope_c, NULL);
    double volts = p->control == DEA_CONTROL_CHARGE ? p->e / c : p->control == DEA_CONTROL_VOLTAGE ? p->e : 0.0;
    return sum - 0.5 * volts * volts * slope_c / d->zones[p->zone].volume;
}

/* The smallest stretch above the geometric one without net stress. */
static double bisect_natural_stretch(const struct probe *p) {
    double low = dea_zone_stretch(p->device, p->zone, p->x), high = low;
    while (net_stress(p, high) < 0.0)
        high += 1e-2;
    for (int i = 0; i < 60; i++) {
        double middle = 0.5 * (low + high);
        if (net_stress(p, middle) < 0.0)
            low = middle;
        else
            high = middle;
    }
    return 0.5 * (low + high);
}

static void slack_films_keep_their_natural_stretch(void **state) {
    (void)state;
    static const enum dea_control controls[] = {DEA_CONTROL_PASSIVE, DEA_CONTROL_CHARGE, DEA_CONTROL_VOLTAGE};
    unsigned long long seed = 41;
    for (int i = 0; i < 150; i++) {
        struct dea_device d = make_device(0.95, 1.6, i % 2 ? BRANCHES : 0, i % 5 ? 0.0 : -0.2);
        struct probe p = draw_probe(&d, &seed, controls[i % 3], true);
        struct dea_film film;
        struct dea_branch_response responses[BRANCHES];
        respond(&p, true, &film, responses);
        assert_true(film.slack && film.pull == 0.0 && film.margin < 0.0 && film.stiffness == 0.0);
        assert_near(film.lam, bisect_natural_stretch(&p), 1e-13);
        if (film.voltage > 0.0)
            assert_near(film.capacitance, dea_zone_capacitance(&d, p.zone, film.lam, NULL, NULL), 0.0);
        /* it does not depend on where the platform is */
        struct probe further = p;
        further.x -= d.zones[p.zone].side * 0.1e-3;
        struct dea_film other;
        respond(&further, false, &other, responses);
        assert_near(other.lam, film.lam, 1e-14);
    }
}

/* A passive film without branches: lam2^-1/2 exactly (physics: natural width of a clamped strip). */
static void a_passive_film_is_slack_below_its_natural_width(void **state) {
    (void)state;
    struct dea_device d = make_device(0.95, 1.6, 0, 0.0);
    d.zones[1].electroded = false;
    struct dea_film film;
    double x = 1e-3;
    assert_int_equal(dea_film_respond(&d, 1, DEA_CONTROL_PASSIVE, x, 0.0, NULL, false, NULL, &film), DEA_OK);
    assert_true(film.slack);
    assert_near(film.lam, 1.0 / sqrt(1.6), 1e-15);
    assert_true(film.voltage == 0.0 && film.charge == 0.0 && film.capacitance == 0.0);
    d.slack = false;
    assert_int_equal(dea_film_respond(&d, 1, DEA_CONTROL_PASSIVE, x, 0.0, NULL, false, NULL, &film), DEA_OK);
    assert_true(!film.slack && film.pull < 0.0 && film.margin < 0.0);
}

static void pull_and_stretch_are_continuous_at_the_onset_of_slack(void **state) {
    (void)state;
    struct dea_device d = make_device(0.95, 1.6, BRANCHES, 0.0);
    struct probe p = {
        .device = &d, .zone = 0, .control = DEA_CONTROL_CHARGE, .e = 1000.0 * d.zones[0].rest_capacitance};
    double taut = 0.0, slack = -1.9e-3;
    struct dea_film film;
    struct dea_branch_response responses[BRANCHES];
    for (int i = 0; i < 60; i++) {
        p.x = 0.5 * (taut + slack);
        respond(&p, false, &film, responses);
        if (film.slack)
            slack = p.x;
        else
            taut = p.x;
    }
    struct dea_film after;
    p.x = taut;
    respond(&p, false, &film, responses);
    p.x = slack;
    respond(&p, false, &after, responses);
    assert_near(film.pull, 0.0, 1e-12);
    assert_near(after.lam, film.lam, 1e-14);
    assert_near(after.voltage, film.voltage, 1e-10 * film.voltage);
}

static void stiffness_at_given_voltage_is_the_slope_of_the_pull(void **state) {
    (void)state;
    unsigned long long seed = 8;
    for (int i = 0; i < 50; i++) {
        struct dea_device d = make_device(1.2, 1.2, BRANCHES, i % 2 ? -0.2 : 0.0);
        struct probe by_charge = draw_probe(&d, &seed, DEA_CONTROL_CHARGE, false);
        struct dea_film film, same;
        struct dea_branch_response responses[BRANCHES];
        respond(&by_charge, true, &film, responses);
        struct probe by_voltage = by_charge;
        by_voltage.control = DEA_CONTROL_VOLTAGE;
        by_voltage.e = film.voltage;
        respond(&by_voltage, true, &same, responses);
        assert_near(same.pull, film.pull, 1e-12 * d.stiffness * 4e-3);
        assert_near(film.stiffness, same.stiffness, 1e-9 * d.stiffness);
        assert_near(d.zones[by_charge.zone].side * same.dpull_dx, same.stiffness, 1e-9 * d.stiffness);
    }
}

/* stress2 = lam2 dW/dlam2 - eps E^2 for the spring alone. */
static void stress_across_is_spring_minus_maxwell(void **state) {
    (void)state;
    struct dea_device d = make_device(1.2, 1.4, 0, 0.0);
    struct dea_stress spring;
    double lam = 1.25, volts = 2500.0, stress2, field = volts * lam / (33e-6 * 1.2);
    assert_int_equal(dea_law_stress(&d.material.elastic, lam, 1.4, &spring), DEA_OK);
    assert_int_equal(dea_film_stress2(&d, 0, lam, volts, NULL, &stress2), DEA_OK);
    assert_near(stress2, 1.4 * spring.w2 - 2.5 * DEA_VACUUM_PERMITTIVITY * field * field, 1e-10 * fabs(stress2));
}

static void what_lies_outside_is_recoverable(void **state) {
    (void)state;
    struct dea_device d = make_device(1.2, 1.2, 0, 0.0);
    struct dea_film film;
    /* squeezed flat, beyond the Gent limit, not a number */
    assert_int_equal(dea_film_respond(&d, 0, DEA_CONTROL_VOLTAGE, -4e-3, 0.0, NULL, true, NULL, &film),
                     DEA_RECOVERABLE);
    assert_int_equal(dea_film_respond(&d, 0, DEA_CONTROL_VOLTAGE, 14e-3, 0.0, NULL, true, NULL, &film),
                     DEA_RECOVERABLE);
    assert_int_equal(dea_film_respond(&d, 0, DEA_CONTROL_VOLTAGE, NAN, 0.0, NULL, true, NULL, &film), DEA_RECOVERABLE);
    /* a voltage no spring of this law without limit can hold: pull-in without end */
    d.material.elastic = (struct dea_law){.kind = DEA_NEO_HOOKEAN, .mu = 0.365e6};
    assert_int_equal(dea_film_respond(&d, 0, DEA_CONTROL_VOLTAGE, -0.5e-3, 60e3, NULL, true, NULL, &film),
                     DEA_RECOVERABLE);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(derivatives_match_differences),
        cmocka_unit_test(the_pull_is_the_slope_of_the_energy),
        cmocka_unit_test(slack_films_keep_their_natural_stretch),
        cmocka_unit_test(a_passive_film_is_slack_below_its_natural_width),
        cmocka_unit_test(pull_and_stretch_are_continuous_at_the_onset_of_slack),
        cmocka_unit_test(stiffness_at_given_voltage_is_the_slope_of_the_pull),
        cmocka_unit_test(stress_across_is_spring_minus_maxwell),
        cmocka_unit_test(what_lies_outside_is_recoverable),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
