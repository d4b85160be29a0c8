/* Switches turn when their controls reach the thresholds: a film that charges while its switch opens keeps the voltage
 * of that instant. */
#include "circuit/engine.h"
#include "loaded_text.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#define TAU (1e6 * STILL_CAPACITANCE)

struct course {
    double held;       /* V, at the end */
    double turned;     /* s, when the voltage was last seen to rise */
    double last, time; /* V, s */
    long points;
};

static enum dea_status keep(void *context, const struct dea_circuit_point *point, struct dea_error *error) {
    struct course *course = context;
    (void)error;
    double v = point->ports[0].port_voltage;
    if (v > course->last + 1e-3)
        course->turned = point->time;
    course->last = course->held = v;
    course->time = point->time;
    course->points++;
    return DEA_OK;
}

/* Runs a netlist for 0.6 ms with the tolerances of a relative accuracy of 1e-3. */
static void run(const char *text, struct course *course) {
    struct dea_deck_options options = {.stop = 0.6e-3, .step = 1e-6, .reltol = 3e-4, .trtol = 0.011};
    const struct dea_engine_callbacks callbacks = {.context = course, .port_value = give_still, .accepted = keep};
    struct loaded_text loaded;
    struct dea_engine *engine;
    struct dea_error error = {.text = ""};
    *course = (struct course){.last = 0.0};
    if (dea_engine_open(&engine, &error) != DEA_OK ||
        load_text(engine, text, &still_port, &options, &callbacks, &loaded, &error) != DEA_OK ||
        dea_engine_run(engine, &error) != DEA_OK)
        fail_msg("%s", error.text);
    dea_engine_close(engine);
    clear_text(&loaded);
}

/* 100 V come at 0.1 ms through 1 MOhm; the switch opens at `opened`. */
static void check_held(const char *text, double opened) {
    struct course course;
    run(text, &course);
    double held = 100.0 * (1.0 - exp(-(opened - 0.1e-3) / TAU));
    if (fabs(course.held - held) > 0.02)
        fail_msg("holds %.6g V instead of %.6g V, opened at %.6g s instead of %.6g s", course.held, held, course.turned,
                 opened);
    assert_true(course.points < 300);
}

#define SOURCE "title\nVin in 0 PULSE(0 100 0.1m 10n 10n 1 2)\nXdea p 0 pos DEA\n"
#define MODEL ".model shv SW(VT=0.5 VH=0.1 RON=1meg ROFF=1e15)\n"

/* The control falls from 1 V at 0.15 ms to 0 V at 0.35 ms: 0.4 V at 0.27 ms. */
static void test_a_switch_opens_at_its_lower_threshold(void **state) {
    (void)state;
    check_held(SOURCE MODEL "S1 in p clk 0 shv\nVclk clk 0 PULSE(1 0 0.15m 0.2m 0.2m 1 2)\n", 0.27e-3);
}

/* It opens while the film discharges fast, with a time constant of 8 us from 0.26 ms on: the step in which it turns
 * must be short, or the charge of half of it is missing. */
static void test_a_switch_opens_in_a_discharge(void **state) {
    (void)state;
    struct course course;
    run("title\nVin in 0 PULSE(0 100 0.05m 10n 10n 0.21m 2)\nXdea p 0 pos DEA\n"
        ".model fast SW(VT=0.5 VH=0.1 RON=100k ROFF=1e15)\nS1 in p clk 0 fast\n"
        "Vclk clk 0 PULSE(1 0 0.15m 0.2m 0.2m 1 2)\n",
        &course);
    double held = 100.0 * exp(-(0.27e-3 - 0.260015e-3) / (0.1 * TAU));
    if (fabs(course.held - held) > 0.02)
        fail_msg("holds %.6g V instead of %.6g V", course.held, held);
}

/* A differential control, a high common voltage, in a subcircuit with parameters. */
static void test_a_switch_in_a_subcircuit(void **state) {
    (void)state;
    check_held(SOURCE ".subckt arm a b g vt=2 \n.model inner SW VT={vt*0.25} VH=0.1 RON=1meg ROFF=1e15\n"
                      "S1 a b g common inner\nVcommon common 0 700\n.ends\n"
                      "Xarm in p clk arm\nVclk clk 0 PULSE(701 700 0.15m 0.2m 0.2m 1 2)\n",
               0.27e-3);
}

/* 1 V across 1 kOhm is 1 mA. */
static void test_a_switch_by_current(void **state) {
    (void)state;
    check_held(SOURCE ".model by_current CSW(IT=0.5m IH=0.1m RON=1meg ROFF=1e15)\nW1 in p Vsense by_current\n"
                      "Vclk clk 0 PULSE(1 0 0.15m 0.2m 0.2m 1 2)\nRclk clk m 1k\nVsense m 0 0\n",
               0.27e-3);
}

/* A control that bends: 1 V over RC of 0.1 ms from 0.15 ms on, 0.4 V after ln(2.5) time constants. */
static void test_a_bent_control(void **state) {
    (void)state;
    check_held(SOURCE MODEL "S1 in p c 0 shv\nVclk clk 0 PULSE(1 0 0.15m 10n 10n 1 2)\nRc clk c 1k\nCc c 0 0.1u\n",
               0.15e-3 + 5e-9 + log(2.5) * 0.1e-3);
}

/* A control that hangs around its threshold costs points, but not many. */
static void test_a_hovering_control(void **state) {
    (void)state;
    struct course course;
    run(SOURCE MODEL "S1 in p c 0 shv\nVclk c 0 SIN(0.6 1u 300k)\n", &course);
    assert_true(course.points < 6000);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_a_switch_opens_at_its_lower_threshold),
        cmocka_unit_test(test_a_switch_opens_in_a_discharge),
        cmocka_unit_test(test_a_switch_in_a_subcircuit),
        cmocka_unit_test(test_a_switch_by_current),
        cmocka_unit_test(test_a_bent_control),
        cmocka_unit_test(test_a_hovering_control),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
