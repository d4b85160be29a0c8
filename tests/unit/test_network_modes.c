/* What a linear circuit remembers, against the closed forms of R-L-C and R-C in front of a film. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>
#include <stdio.h>

#include "plant/plant_internal.h"

#include "scenes.h"

#define DURATION 10e-3 /* s */

enum { NODE_SOURCE, NODE_CHOKE, NODE_FILM, CURRENT_SOURCE, CURRENT_CHOKE, UNKNOWNS };

/* source - L - R - left film; without L a resistor of 1 Ohm takes its place. */
static void measure(double inductance, double resistance, struct dea_waveform waveform, double electrode,
                    double *ringing, double *creep, double *capacitance) {
    static struct test_scene s;
    build_design_c(&s);
    s.device.device.zones[0].electrode_resistance = electrode;
    s.device.device.zones[1].electroded = false;
    prepare_scene(&s);
    struct dea_stamp g[12] = {{NODE_SOURCE, CURRENT_SOURCE, 1.0},         {CURRENT_SOURCE, NODE_SOURCE, 1.0},
                              {NODE_SOURCE, CURRENT_CHOKE, 1.0},          {NODE_CHOKE, CURRENT_CHOKE, -1.0},
                              {CURRENT_CHOKE, NODE_SOURCE, 1.0},          {CURRENT_CHOKE, NODE_CHOKE, -1.0},
                              {NODE_CHOKE, NODE_CHOKE, 1.0 / resistance}, {NODE_CHOKE, NODE_FILM, -1.0 / resistance},
                              {NODE_FILM, NODE_CHOKE, -1.0 / resistance}, {NODE_FILM, NODE_FILM, 1.0 / resistance},
                              {CURRENT_CHOKE, CURRENT_CHOKE, -1.0}};
    struct dea_stamp c[1] = {{CURRENT_CHOKE, CURRENT_CHOKE, -inductance}};
    bool imposed[UNKNOWNS] = {[CURRENT_SOURCE] = true};
    struct dea_network_source source = {CURRENT_SOURCE, -1, waveform};
    struct dea_network network = {.node_count = 3,
                                  .branch_count = 2,
                                  .imposed = imposed,
                                  .conductances = g,
                                  .capacitances = c,
                                  .conductance_count = inductance > 0.0 ? 10 : 11,
                                  .capacitance_count = inductance > 0.0 ? 1 : 0,
                                  .sources = &source,
                                  .source_count = 1,
                                  .ports = {{NODE_FILM, -1}, {-1, -1}},
                                  .peak = 1000.0};
    struct dea_plant_options options = {
        .accuracy = 1e-3, .duration = DURATION, .network = &network, .settle_time = 1e-12};
    options.ports[0] = (struct dea_plant_port){.kind = DEA_PORT_NETWORK, .peak = 1000.0};
    struct dea_plant *plant;
    struct dea_error error;
    if (dea_plant_create(&s.device.device, &options, &plant, &error) != DEA_OK)
        fail_msg("%s", error.text);
    *ringing = plant->ringing;
    *creep = plant->creep;
    *capacitance = s.device.device.zones[0].rest_capacitance;
    dea_plant_destroy(plant);
}

static void expect_near(const char *what, double value, double expected, double relative) {
    if (!(fabs(value - expected) <= relative * expected))
        fail_msg("%s: %.9g instead of %.9g", what, value, expected);
}

/* A step makes the film's voltage ring at its full size until R has damped it; whether R is the circuit's or the
 * electrode's is all the same. */
static void test_step_rings(void **context) {
    (void)context;
    static const double electrodes[] = {0.0, 4e3};
    for (size_t i = 0; i < 2; i++) {
        double ringing, creep, film, l = 0.5, r = 1e4;
        measure(l, r - electrodes[i], step_wave(0.0, 1000.0, 0.0), electrodes[i], &ringing, &creep, &film);
        double decay = 0.5 * r / l, omega = sqrt(1.0 / (l * film) - decay * decay);
        expect_near("cycles", ringing, omega / (2.0 * M_PI * decay), 1e-6);
        expect_near("memory", creep, 1.0 / decay, 1e-6);
    }
}

/* No longer than the run. */
static void test_undamped_rings_for_the_run(void **context) {
    (void)context;
    double ringing, creep, film, l = 0.5;
    measure(l, 1e-3, step_wave(0.0, 1000.0, 0.0), 0.0, &ringing, &creep, &film);
    expect_near("cycles", ringing, DURATION / (2.0 * M_PI * sqrt(l * film)), 1e-3);
    expect_near("memory", creep, DURATION, 1e-9);
}

/* A ramp of many periods leaves 1/(omega rise) of it, a slow sine its frequency over the circuit's, a dc source
 * nothing.
 */
static void test_gentle_sources_ring_less(void **context) {
    (void)context;
    double step, ramp, sine, dc, creep, film, l = 0.5, r = 1e4, rise = 1e-3, frequency = 50.0;
    measure(l, r, step_wave(0.0, 1000.0, 0.0), 0.0, &step, &creep, &film);
    double omega = sqrt(1.0 / (l * film));
    measure(l, r, step_wave(0.0, 1000.0, rise), 0.0, &ramp, &creep, &film);
    measure(l, r, sine_wave(0.0, 1000.0, frequency), 0.0, &sine, &creep, &film);
    measure(l, r, dc_wave(1000.0), 0.0, &dc, &creep, &film);
    expect_near("ramp", ramp, step / (omega * rise), 0.02);
    expect_near("sine", sine, step * 2.0 * M_PI * frequency / omega, 0.02);
    assert_true(dc == 0.0);
}

/* Without inductors nothing rings, and what is forgotten soon is not looked at closely. */
static void test_charging_creeps(void **context) {
    (void)context;
    double ringing, creep, film;
    measure(0.0, 1e5, step_wave(0.0, 1000.0, 0.0), 0.0, &ringing, &creep, &film);
    assert_true(ringing == 0.0);
    expect_near("fast", creep, 1e5 * film, 1e-3);
    measure(0.0, 2e7, step_wave(0.0, 1000.0, 0.0), 0.0, &ringing, &creep, &film);
    assert_true(ringing == 0.0);
    expect_near("slow", creep, 2e7 * film, 1e-3);
    measure(0.0, 1e12, step_wave(0.0, 1000.0, 0.0), 0.0, &ringing, &creep, &film);
    expect_near("for ever", creep, DURATION, 1e-9);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_step_rings),
        cmocka_unit_test(test_undamped_rings_for_the_run),
        cmocka_unit_test(test_gentle_sources_ring_less),
        cmocka_unit_test(test_charging_creeps),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
