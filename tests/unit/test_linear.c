/* Netlists solved with the device as one problem: every linear element gives what ngspice gives, and what is not
 * understood runs in ngspice by itself. */
#include "coupled_capture.h"
#include "coupled_cases.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define ACCURACY 1e-5
/* Each of the two runs is within the accuracy. */
#define AGREEMENT (2.0 * ACCURACY)
#define DEVICE "device: {" TWO_ZONES "}"

/* One netlist: V1 steps to 2 kV over 20 us behind 1 MOhm, unless `drive` says otherwise; `elements` come on top. */
struct linear_case {
    const char *name, *drive, *elements;
};

#define STEP "V1 s 0 PULSE(0 2000 1m 20u 20u 1 2)\nR1 s left 1Meg\nR2 right 0 1k\n"

/* Understood: must run as one problem. */
static const struct linear_case understood[] = {
    {"r", STEP, ""},
    {"r_multiplier", "V1 s 0 PULSE(0 2000 1m 20u 20u 1 2)\nR1 s left 3Meg m=3\nR2 right 0 1k\n", ""},
    {"r_tc", "V1 s 0 PULSE(0 2000 1m 20u 20u 1 2)\nR1 s left 1Meg tc1=1e-3 temp=87\nR2 right 0 1k\n", ""},
    {"r_tc2", "V1 s 0 PULSE(0 2000 1m 20u 20u 1 2)\nR1 s left 1Meg tc1=1e-3 tc2=1e-5 dtemp=30\nR2 right 0 1k\n", ""},
    {"r_scale", "V1 s 0 PULSE(0 2000 1m 20u 20u 1 2)\nR1 s left 2Meg scale=0.5\nR2 right 0 1k\n", ""},
    {"r_expression", "V1 s 0 PULSE(0 2000 1m 20u 20u 1 2)\nR1 s left R={2*ra}\n.param ra=500k\nR2 right 0 1k\n", ""},
    {"r_ac", "V1 s 0 PULSE(0 2000 1m 20u 20u 1 2)\nR1 s left 1Meg ac=1k\nR2 right 0 1k\n", ""},
    {"r_suffix", "V1 s 0 PULSE(0 2kV 1ms 20us 20us 1s 2s)\nR1 s left 1MegOhm\nR2 right 0 1kohm\n", ""},
    {"c", STEP, "C1 left 0 100p"},
    {"c_ic", STEP, "C1 left 0 100p ic=500"},
    {"c_multiplier", STEP, "C1 left 0 50p m=2"},
    {"c_tc", STEP, "C1 left 0 100p tc1=1e-3 tc2=1e-6 temp=127"},
    {"c_expression", STEP, "C1 left 0 C={cc}\n.param cc=100p"},
    {"l", "V1 s 0 PULSE(0 2000 1m 20u 20u 1 2)\nR1 s a 1Meg\nR2 right 0 1k\n", "L1 a left 100"},
    {"l_tc", "V1 s 0 PULSE(0 2000 1m 20u 20u 1 2)\nR1 s a 1Meg\nR2 right 0 1k\n", "L1 a left L=100 tc1=1e-3 dtemp=50"},
    {"c_scale", STEP, "C1 left 0 100p scale=2"},
    {"l_scale", "V1 s 0 PULSE(0 2000 1m 20u 20u 1 2)\nR1 s a 1Meg\nR2 right 0 1k\n", "L1 a left 100 scale=2"},
    {"l_ic", "V1 s 0 PULSE(0 2000 1m 20u 20u 1 2)\nR1 s a 1Meg\nR2 right 0 1k\n", "L1 a left 100 ic=1m"},
    {"l_multiplier", "V1 s 0 PULSE(0 2000 1m 20u 20u 1 2)\nR1 s a 1Meg\nR2 right 0 1k\n", "L1 a left 100 m=2"},
    {"k", "V1 s 0 PULSE(0 2000 1m 20u 20u 1 2)\nR1 s a 1Meg\nR2 right 0 1k\n",
     "L1 a 0 1000\nL2 left b 1500\nK1 L1 L2 0.8\nR3 b 0 1k\nR4 a 0 5Meg"},
    {"k_negative", "V1 s 0 PULSE(0 2000 1m 20u 20u 1 2)\nR1 s a 1Meg\nR2 right 0 1k\n",
     "L1 a 0 1000\nL2 left b 1500\nK1 L1 L2 -0.5\nR3 b 0 1k\nR4 a 0 5Meg\nR5 left 0 20Meg"},
    {"v_dc", "V1 s 0 2000\nR1 s left 1Meg\nR2 right 0 1k\nI1 0 right PULSE(0 1u 1m 10u 10u 1 2)\nR3 right 0 1G\n", ""},
    {"v_dc_keyword", "V1 s 0 DC 500 PULSE(500 2000 1m 20u 20u 1 2)\nR1 s left 1Meg\nR2 right 0 1k\n", ""},
    {"v_ac", "V1 s 0 DC 0 AC 1 PULSE(0 2000 1m 20u 20u 1 2)\nR1 s left 1Meg\nR2 right 0 1k\n", ""},
    {"v_dc_differs", "V1 s 0 DC 700 PULSE(0 2000 1m 20u 20u 1 2)\nR1 s left 1Meg\nR2 right 0 1k\n", ""},
    {"v_dc_sine_differs", "V1 s 0 DC 700 SIN(100 300 50 1m)\nR1 s left 1Meg\nR2 right 0 1k\n", ""},
    {"v_pulse_train", "V1 s 0 PULSE(0 2000 1m 0.1m 0.2m 1m 3m)\nR1 s left 1Meg\nR2 right 0 1k\n", ""},
    {"v_pulse_no_delay", "V1 s 0 PULSE(0 2000 0 0.1m 0.2m 1m 3m)\nR1 s left 1Meg\nR2 right 0 1k\n", ""},
    {"v_pulse_short", "V1 s 0 PULSE(0 2000 1m)\nR1 s left 1Meg\nR2 right 0 1k\n", ""},
    {"v_pulse_defaults", "V1 s 0 PULSE(0 2000 1m 0 0 5m)\nR1 s left 1Meg\nR2 right 0 1k\n", ""},
    {"v_pulse_tight", "V1 s 0 PULSE(0 2000 1m 1m 1m 1m 3m)\nR1 s left 1Meg\nR2 right 0 1k\n", ""},
    {"v_sine", "V1 s 0 SIN(1000 500 50)\nR1 s left 1Meg\nR2 right 0 1k\n", ""},
    {"v_sine_all", "V1 s 0 SIN(1000 500 50 2m 20 40)\nR1 s left 1Meg\nR2 right 0 1k\n", ""},
    {"v_sine_default", "V1 s 0 SIN(1000 500)\nR1 s left 1Meg\nR2 right 0 1k\n", ""},
    {"v_exp", "V1 s 0 EXP(0 2000 2m 1m 10m 3m)\nR1 s left 1Meg\nR2 right 0 1k\n", ""},
    {"v_exp_defaults", "V1 s 0 EXP(100 2000)\nR1 s left 1Meg\nR2 right 0 1k\n", ""},
    {"v_pwl", "V1 s 0 PWL(0 0 1m 0 1.1m 2000 8m 1500 9m 0)\nR1 s left 1Meg\nR2 right 0 1k\n", ""},
    {"v_pwl_late", "V1 s 0 PWL(1m 300 1.1m 2000 8m 1500)\nR1 s left 1Meg\nR2 right 0 1k\n", ""},
    {"v_pwl_repeat", "V1 s 0 PWL(0 0 1m 0 1.1m 2000 3m 1500 4m 0) r=0\nR1 s left 1Meg\nR2 right 0 1k\n", ""},
    {"v_pwl_repeat_later", "V1 s 0 PWL(0 0 1m 0 1.1m 2000 3m 1500 4m 1000) r=1.1m\nR1 s left 1Meg\nR2 right 0 1k\n",
     ""},
    {"v_pwl_delay", "V1 s 0 PWL(0 0 1m 0 1.1m 2000 3m 1500 4m 0) td=2m\nR1 s left 1Meg\nR2 right 0 1k\n", ""},
    {"v_pwl_repeat_delay", "V1 s 0 PWL(0 0 1m 0 1.1m 2000 3m 1500 4m 0) r=0 td=2m\nR1 s left 1Meg\nR2 right 0 1k\n",
     ""},
    {"v_pwl_value_at_start", "V1 s 0 PWL(0 800 1m 800 1.1m 2000)\nR1 s left 1Meg\nR2 right 0 1k\n", ""},
    {"v_pwl_moves_at_start", "V1 s 0 PWL(0 800 5m 2000)\nR1 s left 1Meg\nR2 right 0 1k\n", ""},
    {"v_am", "V1 s 0 AM(500 1 20 200 1m)\nR1 s left 1Meg\nR2 right 0 1k\n", ""},
    {"i_pulse", "I1 0 left PULSE(0 1m 1m 20u 20u 0.4m 2)\nR1 left 0 2Meg\nR2 right 0 1k\n", ""},
    {"i_multiplier", "I1 0 left PULSE(0 0.5m 1m 20u 20u 0.4m 2) m=2\nR1 left 0 2Meg\nR2 right 0 1k\n", ""},
    {"i_sine", "I1 0 left SIN(0.5m 0.2m 100)\nR1 left 0 2Meg\nR2 right 0 1k\n", ""},
    {"e", "V1 i 0 PULSE(0 5 1m 20u 20u 1 2)\nE1 s 0 i 0 400\nR1 s left 1Meg\nR2 right 0 1k\n", ""},
    {"e_brackets", "V1 i 0 PULSE(0 5 1m 20u 20u 1 2)\nE1 s 0 (i,0) 400\nR1 s left 1Meg\nR2 right 0 1k\n", ""},
    {"e_expression",
     "V1 i 0 PULSE(0 5 1m 20u 20u 1 2)\n.param g=200\nE1 s 0 i 0 {2*g}\nR1 s left 1Meg\nR2 right 0 1k\n", ""},
    {"g", "V1 i 0 PULSE(0 5 1m 20u 20u 1 2)\nG1 0 left i 0 0.2m\nR1 left 0 2Meg\nR2 right 0 1k\n", ""},
    {"g_multiplier", "V1 i 0 PULSE(0 5 1m 20u 20u 1 2)\nG1 0 left i 0 0.1m m=2\nR1 left 0 2Meg\nR2 right 0 1k\n", ""},
    {"f", "V1 i 0 PULSE(0 5 1m 20u 20u 1 2)\nR0 i 0 1k\nF1 left 0 V1 0.2\nR1 left 0 2Meg\nR2 right 0 1k\n", ""},
    {"f_multiplier",
     "V1 i 0 PULSE(0 5 1m 20u 20u 1 2)\nR0 i 0 1k\nF1 left 0 V1 0.1 m=2\nR1 left 0 2Meg\nR2 right 0 1k\n", ""},
    {"h", "V1 i 0 PULSE(0 5 1m 20u 20u 1 2)\nR0 i 0 1k\nH1 s 0 V1 -400k\nR1 s left 1Meg\nR2 right 0 1k\n", ""},
    {"subcircuit", STEP, ".subckt arm a b r=1k\nRa a m {r*2}\nCa m b 100p\n.ends\nXa left 0 arm r=10k"},
    {"subcircuit_nested", STEP,
     ".subckt inner a b r=1k c=1p\nRa a m {r}\nCa m b {c}\n.ends\n.subckt outer a b k=1\nX1 a b inner r={k*1k} "
     "c={k*20p}\n"
     ".ends\nXa left 0 outer k=2\nXb right 0 outer"},
    {"subcircuit_multiplier", STEP, ".subckt arm a b\nRa a m 10k\nCa m b 50p\n.ends\nXa left 0 arm m=2"},
    {"subcircuit_sources", STEP,
     ".subckt gain a b o\nVs a c 0\nRs c b 10Meg\nF1 0 o Vs 1000\nRo o 0 100k\n.ends\nXa left 0 right gain"},
    {"gmin_option", STEP, ".options gmin=1e-15"},
    {"initial", STEP, ".ic v(left)=500"},
    {"initial_high", "R1 left 0 1G\nR2 right 0 1k\n", ".ic v(left)=3000"},
    {"initial_beside", STEP, "C1 left 0 1n\n.ic v(left)=500"},
    {"initial_inside", STEP, ".subckt arm a b\nRa a m 1Meg\nCa m b 1n\n.ic v(m)=800\n.ends\nXa left 0 arm"},
    {"initial_both", "V1 s 0 1000\nR1 s left 1Meg\nR2 s right 5Meg\n",
     "C1 left right 100p\n.param w=1500\n.ic v(left)={w} v(right)=200"},
    {"initial_source", "V1 s 0 1000\nR1 s left 1Meg\nR2 right 0 1k\n",
     "C1 a 0 1n\nR3 a left 2Meg\n.ic v(a)=2500 v(s)=1000"},
    {"nodeset", STEP, "R9 left q 1Meg\nC9 q 0 1n\n.nodeset v(q)=500"},
    {"both_zones", "V1 s 0 SIN(1500 500 60)\nR1 s left 1Meg\nV2 t 0 PWL(0 500 2m 500 3m 1500)\nR2 t right 3Meg\n",
     "C3 left right 30p"},
    {"titles_and_comments", STEP, "* a comment\nC1 left 0 100p $ another\nR9 left 0 1G ; one more"},
};

/* Not understood: ngspice runs it, whatever it is. */
static const struct linear_case refused[] = {
    {"k_multiplier", "V1 s 0 PULSE(0 2000 1m 20u 20u 1 2)\nR1 s a 1Meg\nR2 right 0 1k\n",
     "L1 a 0 1000 m=2\nL2 left b 1500\nK1 L1 L2 0.5\nR3 b 0 1k\nR4 a 0 5Meg"},
    {"e_value_linear", "V1 i 0 PULSE(0 5 1m 20u 20u 1 2)\nE1 s 0 value={400*v(i)}\nR1 s left 1Meg\nR2 right 0 1k\n",
     ""},
    {"v_sffm", "V1 s 0 SFFM(1000 500 100 2 20)\nR1 s left 1Meg\nR2 right 0 1k\n", ""},
    {"v_pulse_count", "V1 s 0 PULSE(0 2000 1m 0.1m 0.2m 1m 3m 2)\nR1 s left 1Meg\nR2 right 0 1k\n", ""},
    {"poly", "V1 i 0 PULSE(0 5 1m 20u 20u 1 2)\nE1 s 0 POLY(1) i 0 0 400 1\nR1 s left 1Meg\nR2 right 0 1k\n", ""},
    {"b", "V1 i 0 PULSE(0 5 1m 20u 20u 1 2)\nB1 s 0 V=80*v(i)*v(i)\nR1 s left 1Meg\nR2 right 0 1k\n", ""},
    {"r_of_time", "V1 s 0 PULSE(0 2000 1m 20u 20u 1 2)\nR1 s left R='1Meg*(1+time*100)'\nR2 right 0 1k\n", ""},
    {"r_of_voltage", "V1 s 0 PULSE(0 2000 1m 20u 20u 1 2)\nR1 s left R='1Meg*(1+v(s)*1e-4)'\nR2 right 0 1k\n", ""},
    {"c_of_voltage", STEP, "C1 left 0 C='100p*(1+v(left)*1e-4)'"},
    {"q", STEP, "C1 left 0 Q='100p*v(left)'"},
    {"e_table",
     "V1 i 0 PULSE(0 5 1m 20u 20u 1 2)\nE1 s 0 TABLE {v(i)} = (0,0) (3,1500) (5,2000)\nR1 s left 1Meg\nR2 right 0 1k\n",
     ""},
    {"g_value", "V1 i 0 PULSE(0 5 1m 20u 20u 1 2)\nG1 0 left value={4e-5*v(i)*v(i)}\nR1 left 0 2Meg\nR2 right 0 1k\n",
     ""},
    {"diode", STEP, "D1 left 0 DX\n.model DX D"},
    {"switch", STEP, "S1 left 0 s 0 SX\n.model SX SW(VT=1k RON=1G ROFF=1T)"},
    {"r_model", STEP, "R9 left 0 RX L=10u W=1u\n.model RX R(RSH=1k)"},
    {"r_model_value", STEP, "R9 left 0 10Meg RX\n.model RX R(TC1=0.01 TNOM=100)"},
    {"c_model", STEP, "C9 left 0 CX 100p\n.model CX C(TC1=0.01 TNOM=100)"},
    {"temp", STEP, "R9 left 0 10Meg tc1=0.01\n.temp 77"},
    {"temp_option", STEP, "R9 left 0 10Meg tc1=0.01\n.options temp=77"},
    {"temper", STEP, "R9 left 0 R='10Meg*(1+0.01*temper)'\n.options temp=77"},
    {"position", STEP, "E1 y 0 pos 0 2\nR3 y 0 1k"},
    {"initial_nowhere", STEP, ".ic v(nowhere)=500"},
    {"uic", STEP, "C1 left 0 1n ic=500\n.tran 10u 20m uic"},
    {"rshunt", STEP, "C3 left q 100p\n.options rshunt=1e9"},
    {"line", STEP, "T1 left 0 q 0 Z0=50 TD=1u\nR9 q 0 10Meg"},
    {"v_pulse_early", "V1 s 0 PULSE(0 2000 -1m 0.1m 0.2m 1m 3m)\nR1 s left 1Meg\nR2 right 0 1k\n", ""},
    {"v_pulse_crowded", "V1 s 0 PULSE(0 2000 1m 1m 1m 2m 3m)\nR1 s left 1Meg\nR2 right 0 1k\n", ""},
    {"v_sine_early", "V1 s 0 SIN(1000 500 50 -2m)\nR1 s left 1Meg\nR2 right 0 1k\n", ""},
    {"v_exp_crossed", "V1 s 0 EXP(0 2000 5m 1m 2m 3m)\nR1 s left 1Meg\nR2 right 0 1k\n", ""},
};

static void make_case(const struct linear_case *one, struct dea_scene *scene) {
    static char netlist[1 << 17];
    snprintf(netlist, sizeof netlist, "t\n%s%s\nXdea left 0 right 0 pos DEA\n%s.end\n", one->drive, one->elements,
             strstr(one->elements, ".tran") == NULL ? ".tran 10u 20m\n" : "");
    struct coupled_scene listed = {one->name, DEVICE, netlist, 20e-3, ""};
    make_listed_scene(&listed, scene);
}

/* 1 when a case does not run in the expected way, or does not agree with ngspice. */
static int judge_case(const struct linear_case *one, const char *mode) {
    struct dea_scene scene;
    struct coupled_rows rows, ngspice;
    make_case(one, &scene);
    run_scene(&scene, DEA_ENGINE_AUTO, ACCURACY, 500, &rows);
    int wrong = rows.status != DEA_OK || strcmp(rows.result.stats_run.mode, mode) != 0;
    if (wrong)
        print_message("%s: runs as %s %s\n", one->name, rows.result.stats_run.mode, rows.error.text);
    if (!wrong && strcmp(mode, "linear") == 0) {
        run_scene(&scene, DEA_ENGINE_NGSPICE, ACCURACY, 500, &ngspice);
        struct coupled_error difference = compare_rows(&rows, &ngspice);
        wrong = ngspice.status != DEA_OK || strcmp(ngspice.result.stats_run.mode, "cosim") != 0 ||
                !(difference.x <= AGREEMENT && difference.port <= AGREEMENT);
        if (wrong)
            print_message("%s: differs by %.2e in x, %.2e at a port %s\n", one->name, difference.x, difference.port,
                          ngspice.error.text);
        free_rows(&ngspice);
    }
    free_rows(&rows);
    dea_scene_clear(&scene);
    return wrong;
}

static void test_understood(void **state) {
    (void)state;
    int wrong = 0;
    for (size_t i = 0; i < sizeof understood / sizeof understood[0]; i++)
        wrong += judge_case(&understood[i], "linear");
    assert_int_equal(wrong, 0);
}

static void test_refused(void **state) {
    (void)state;
    int wrong = 0;
    for (size_t i = 0; i < sizeof refused / sizeof refused[0]; i++)
        wrong += judge_case(&refused[i], "cosim");
    assert_int_equal(wrong, 0);
}

/* At any accuracy, also where an edge of the source changes faster than the time can be resolved; and no row is off,
 * also not those at the very corners. */
static void test_tight_accuracy(void **state) {
    (void)state;
    struct dea_scene scene;
    struct coupled_scene listed = {
        "tight", DEVICE,
        "t\nV1 b 0 PULSE(0 2000 1m 100u 100u 24.9m 50m)\nV2 s b PULSE(0 300 3m 0.1u 0.1u 1m 9.3m)\nR0 s a 500\n"
        "C1 s a 5p\nR1 a left 100k\nR2 right 0 1k\nXdea left 0 right 0 pos DEA\n.end\n",
        40e-3, ""};
    make_listed_scene(&listed, &scene);
    struct coupled_rows reference;
    run_scene(&scene, DEA_ENGINE_AUTO, 1e-11, 400, &reference);
    assert_int_equal(reference.status, DEA_OK);
    assert_string_equal(reference.result.stats_run.mode, "linear");
    int port = find_signal(&reference, "left.port_voltage");
    for (double accuracy = 1e-7; accuracy > 0.5e-10; accuracy *= 0.1) {
        struct coupled_rows rows;
        run_scene(&scene, DEA_ENGINE_AUTO, accuracy, 400, &rows);
        if (rows.status != DEA_OK)
            fail_msg("A = %g: %s", accuracy, rows.error.text);
        assert_int_equal(rows.count, reference.count);
        for (size_t n = 0; n < rows.count; n++) {
            double here = rows.values[n * rows.columns + (size_t)port];
            double off = fabs(here - reference.values[n * reference.columns + (size_t)port]) / 2000.0;
            if (!(off < 10.0 * accuracy))
                fail_msg("A = %g: t = %.9g s: the port voltage is off by %.2g", accuracy, rows.times[n], off);
        }
        free_rows(&rows);
    }
    free_rows(&reference);
    dea_scene_clear(&scene);
}

/* A measured waveform of thousands of points, longer than the lines ngspice lists: taken in to its end, or not at all.
 */
static int judge_long_waveform(const char *name, const char *before, const char *after, const char *mode) {
    enum { POINTS = 3000 };
    char *text = malloc(POINTS * 32 + 256), *end = text;
    assert_non_null(text);
    end += sprintf(end, "%s PWL(", before);
    for (int i = 0; i < POINTS; i++)
        end += sprintf(end, "%s%.9g %.9g", i % 8 == 7 ? "\n+ " : " ", 20e-3 * i / POINTS,
                       1000.0 + 800.0 * sin(2.0 * M_PI * 70.0 * 20e-3 * i / POINTS));
    sprintf(end, ")\n%s\nR1 s left 1Meg\nR2 right 0 1k\n", after);
    struct linear_case one = {name, text, ""};
    int wrong = judge_case(&one, mode);
    free(text);
    return wrong;
}

static void test_long_waveform(void **state) {
    (void)state;
    assert_int_equal(judge_long_waveform("long", "V1 s 0", "", "linear"), 0);
    assert_int_equal(judge_long_waveform("long inside", ".subckt src a b\nV1 a b", ".ends\nXs s 0 src", "cosim"), 0);
}

/* ---- random netlists ---- */

/* A small generator of its own (Marsaglia's xorshift): the same netlists everywhere. */
static double draw(uint64_t *seed, double low, double high) {
    *seed ^= *seed << 13;
    *seed ^= *seed >> 7;
    *seed ^= *seed << 17;
    return low + (high - low) * (double)(*seed >> 11) / 9007199254740992.0;
}

/* Spread over decades. */
static double draw_decade(uint64_t *seed, double low, double high) {
    return exp(draw(seed, log(low), log(high)));
}

static int pick(uint64_t *seed, int count) {
    return (int)draw(seed, 0.0, count);
}

enum { NODES = 5 };

static int write_source(uint64_t *seed, char *text, size_t size) {
    double high = draw(seed, 500.0, 2500.0), at = draw(seed, 0.2e-3, 4e-3), ramp = draw_decade(seed, 1e-5, 1e-3);
    double frequency = draw(seed, 20.0, 400.0), low = draw(seed, 0.0, 500.0);
    switch (pick(seed, 4)) {
    case 0:
        return snprintf(text, size, "V1 s 0 PULSE(%.6g %.6g %.6g %.6g %.6g 4m 9m)\n", low, high, at, ramp, ramp);
    case 1:
        return snprintf(text, size, "V1 s 0 SIN(%.6g %.6g %.6g %.6g 10 30)\n", high, low, frequency, at);
    case 2:
        return snprintf(text, size, "V1 s 0 PWL(0 %.6g %.6g %.6g %.6g %.6g 9m %.6g 10m %.6g) r=0\n", low, at, low,
                        at + ramp, high, high, low);
    default:
        return snprintf(text, size, "V1 s 0 EXP(%.6g %.6g %.6g 0.5m 9m %.6g)\n", low, high, at, ramp);
    }
}

/* One element between random nodes, everything damped: an unstable circuit proves nothing. */
static int write_random_element(uint64_t *seed, int i, char *text, size_t size) {
    int a = pick(seed, NODES), b = pick(seed, NODES), c = pick(seed, NODES);
    if (a == b)
        b = -1;
    char far[16] = "0";
    if (b >= 0)
        snprintf(far, sizeof far, "n%d", b);
    switch (pick(seed, 9)) {
    case 0:
        return snprintf(text, size, "R%d n%d %s %.6g m=%d\n", i, a, far, draw_decade(seed, 1e5, 1e8),
                        1 + pick(seed, 2));
    case 1:
        return snprintf(text, size, "C%d n%d %s %.6g\n", i, a, far, draw_decade(seed, 1e-11, 1e-9));
    case 2:
        return snprintf(text, size, "L%d n%d i%d %.6g\nRl%d i%d %s %.6g\n", i, a, i, draw_decade(seed, 0.1, 50.0), i, i,
                        far, draw_decade(seed, 1e5, 1e7));
    case 3:
        return snprintf(text, size,
                        "L%d n%d i%d %.6g\nRl%d i%d %s 500k\nLk%d k%d 0 %.6g\nRk%d k%d 0 %.6g\nK%d L%d Lk%d 0.7\n", i,
                        a, i, draw_decade(seed, 0.1, 50.0), i, i, far, i, i, draw_decade(seed, 0.1, 50.0), i, i,
                        draw_decade(seed, 1e3, 1e6), i, i, i);
    case 4:
        return snprintf(text, size, "I%d 0 n%d SIN(0 %.6g %.6g)\n", i, a, draw_decade(seed, 1e-7, 1e-5),
                        draw(seed, 20.0, 300.0));
    case 5:
        return snprintf(text, size, "E%d e%d 0 n%d 0 %.6g\nRe%d e%d n%d %.6g\n", i, i, c, draw(seed, -0.5, 0.5), i, i,
                        a, draw_decade(seed, 1e6, 1e8));
    case 6:
        return snprintf(text, size, "G%d 0 n%d n%d 0 %.6g\n", i, a, c, draw(seed, -5e-8, 5e-8));
    case 7:
        return snprintf(text, size, "F%d 0 n%d V1 %.6g\n", i, a, draw(seed, -0.2, 0.2));
    default:
        return snprintf(text, size, "H%d h%d 0 V1 %.6g\nRh%d h%d n%d 1Meg\n", i, i, draw(seed, -1e5, 1e5), i, i, a);
    }
}

static void write_random_netlist(uint64_t seed, char *text, size_t size) {
    size_t used = (size_t)write_source(&seed, text, size);
    int elements = 3 + pick(&seed, 8);
    /* every node hangs on the source, through a chain of resistors */
    used += (size_t)snprintf(text + used, size - used, "Rs s n0 %.6g\n", draw_decade(&seed, 1e5, 3e6));
    for (int n = 1; n < NODES; n++)
        used += (size_t)snprintf(text + used, size - used, "Rc%d n%d n%d %.6g\n", n, n - 1, n,
                                 draw_decade(&seed, 1e4, 1e7));
    for (int i = 0; i < elements; i++)
        used += (size_t)write_random_element(&seed, i, text + used, size - used);
    int second = pick(&seed, NODES);
    used +=
        (size_t)snprintf(text + used, size - used, "Rleft n%d left 100\nRright n%d right %.6g\nRdown right 0 1Meg\n",
                         NODES - 1, second, draw_decade(&seed, 1e5, 1e8));
}

static void test_random_netlists(void **state) {
    (void)state;
    int wrong = 0;
    for (uint64_t seed = 1; seed <= 40; seed++) {
        char text[4096], name[32];
        write_random_netlist(seed * 0x9E3779B97F4A7C15u, text, sizeof text);
        snprintf(name, sizeof name, "random %d", (int)seed);
        struct linear_case one = {name, text, ""};
        int bad = judge_case(&one, "linear");
        if (bad)
            print_message("%s\n", text);
        wrong += bad;
    }
    assert_int_equal(wrong, 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_understood, set_up_folder, tear_down_folder),
        cmocka_unit_test_setup_teardown(test_refused, set_up_folder, tear_down_folder),
        cmocka_unit_test_setup_teardown(test_tight_accuracy, set_up_folder, tear_down_folder),
        cmocka_unit_test_setup_teardown(test_long_waveform, set_up_folder, tear_down_folder),
        cmocka_unit_test_setup_teardown(test_random_netlists, set_up_folder, tear_down_folder),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
