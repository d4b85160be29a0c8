/* The engine with the port model against exact solutions, and the traps of ngspice's synchronisation interface. */
#include "base/isolate.h"
#include "circuit/engine.h"
#include "loaded_text.h"
#include "memory.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#define C_REST 80.5e-12 /* F */

struct samples {
    double (*capacitance)(double t);
    double offset; /* C */
    double resistance;
    double stretch;
    double position;
    int count, stop_after;
    enum dea_status stop_with;
    double time[20000], voltage[20000], film[20000], charge[20000], current[20000], node[20000];
    double longest_request; /* for before_step, s; 0: none */
    double largest_step;
    char messages[8192];
};

static double constant_capacitance(double t) {
    (void)t;
    return C_REST;
}

static double moving_capacitance(double t) {
    return C_REST * (1.0 + 0.3 * sin(2.0 * M_PI * 180.0 * t));
}

/* Jumps at 5 ms; right limit there, left limit just before: what the coupling has to give. */
static double jumping_capacitance(double t) {
    return t < 5e-3 ? C_REST : 1.5 * C_REST;
}

static double give(void *context, int instance, int port, enum dea_external which, double t) {
    const struct samples *samples = context;
    (void)instance;
    switch (which) {
    case DEA_EXTERNAL_CAPACITANCE:
        return samples->capacitance(t);
    case DEA_EXTERNAL_OFFSET:
        return samples->offset;
    case DEA_EXTERNAL_RESISTANCE:
        return samples->resistance;
    case DEA_EXTERNAL_STRETCH:
        return samples->stretch;
    default:
        assert_int_equal(port, -1);
        return samples->position;
    }
}

static void limit_step(void *context, double t, double *delta) {
    const struct samples *samples = context;
    (void)t;
    if (samples->longest_request > 0.0 && *delta > samples->longest_request)
        *delta = samples->longest_request;
}

static enum dea_status keep(void *context, const struct dea_circuit_point *point, struct dea_error *error) {
    struct samples *samples = context;
    int i = samples->count < 20000 ? samples->count++ : 19999;
    if (i > 0 && point->time - samples->time[i - 1] > samples->largest_step)
        samples->largest_step = point->time - samples->time[i - 1];
    samples->time[i] = point->time;
    samples->voltage[i] = point->ports[0].port_voltage;
    samples->film[i] = point->ports[0].film_voltage;
    samples->charge[i] = point->ports[0].charge;
    samples->current[i] = point->ports[0].current;
    samples->node[i] = point->nodes[0];
    if (samples->stop_after > 0 && samples->count >= samples->stop_after)
        return samples->stop_with == DEA_STOPPED ? DEA_STOPPED
                                                 : dea_fail(error, samples->stop_with, "stopped by the test");
    return DEA_OK;
}

static void collect(void *context, enum dea_message_kind kind, const char *text) {
    struct samples *samples = context;
    static const char letters[] = "NWE";
    size_t used = strlen(samples->messages);
    snprintf(samples->messages + used, sizeof samples->messages - used, "%c %s\n", letters[kind], text);
}

/* ---- one run ---- */

struct scene {
    const char *netlist;
    struct dea_port port;
    struct dea_deck_options options;
    double breakpoint; /* s; 0: none */
};

static struct samples *new_samples(void) {
    struct samples *samples = calloc(1, sizeof *samples);
    assert_non_null(samples);
    samples->capacitance = constant_capacitance;
    samples->position = 0.25e-3;
    samples->stretch = 1.2;
    return samples;
}

static enum dea_status run_with(struct dea_engine *engine, const struct scene *scene, struct samples *samples,
                                struct dea_engine_measure *measure, struct dea_engine_stats *stats,
                                struct dea_error *error) {
    struct loaded_text loaded;
    const char *nodes[] = {"pos"};
    struct dea_deck_options options = scene->options;
    options.nodes = nodes;
    options.node_count = 1;
    const struct dea_engine_callbacks callbacks = {
        .context = samples, .port_value = give, .before_step = limit_step, .accepted = keep, .message = collect};
    error->text[0] = '\0';
    enum dea_status status = load_text(engine, scene->netlist, &scene->port, &options, &callbacks, &loaded, error);
    if (status == DEA_OK && scene->breakpoint > 0.0)
        status = dea_engine_add_breakpoint(engine, scene->breakpoint, error);
    if (status == DEA_OK)
        status = dea_engine_run(engine, error);
    int count;
    const struct dea_engine_measure *measures = dea_engine_measures(engine, &count);
    if (measure != NULL && count > 0)
        *measure = measures[0];
    if (stats != NULL)
        dea_engine_stats(engine, stats);
    clear_text(&loaded);
    return status;
}

static enum dea_status run(const struct scene *scene, struct samples *samples, struct dea_engine_measure *measure,
                           struct dea_engine_stats *stats, struct dea_error *error) {
    struct dea_engine *engine;
    if (dea_engine_open(&engine, error) != DEA_OK)
        fail_msg("%s", error->text);
    enum dea_status status = run_with(engine, scene, samples, measure, stats, error);
    dea_engine_close(engine);
    return status;
}

#define RAMP "Vin in 0 pulse(0 3300 1m 100u 100u 1 2)\n"
static const struct dea_port plain_port = {.rest_capacitance = C_REST, .conductivity_field = INFINITY};

/* Exact answer of R C to the ramp of RAMP. */
static double exact_ramp(double t, double tau) {
    const double slope = 3300.0 / 100e-6;
    if (t < 1e-3)
        return 0.0;
    double in_ramp = fmin(t, 1.1e-3) - 1e-3;
    double at_end = slope * (in_ramp - tau * (1.0 - exp(-in_ramp / tau)));
    return t <= 1.1e-3 ? at_end : 3300.0 + (at_end - 3300.0) * exp(-(t - 1.1e-3) / tau);
}

static double worst_ramp_error(const struct samples *samples, const double *values, double tau) {
    double worst = 0.0;
    for (int i = 0; i < samples->count; i++)
        worst = fmax(worst, fabs(values[i] - exact_ramp(samples->time[i], tau)) / 3300.0);
    return worst;
}

/* ---- tests ---- */

/* A film whose second pin is not at ground, but far from it, does as one against ground. */
static void test_lifted_film_does_as_a_grounded_one(void **state) {
    (void)state;
    static const char *const netlists[] = {"t\n" RAMP "R1 in p 1meg\nXdea p 0 pos DEA\n",
                                           "t\nVin in n pulse(0 3300 1m 100u 100u 1 2)\nR1 in p 1meg\n"
                                           "Vn n 0 -1500\nXdea p n pos DEA\n"};
    for (int resistance = 0; resistance < 2; resistance++) {
        double charge[2], voltage[2], film[2];
        for (int lifted = 0; lifted < 2; lifted++) {
            struct samples *samples = new_samples();
            struct dea_error error;
            struct scene scene = {netlists[lifted],
                                  plain_port,
                                  {.stop = 2e-3, .step = 1e-6, .max_step = 5e-6, .reltol = 1e-6, .trtol = 1.0},
                                  0.0};
            scene.port.resistance = resistance * 1e6;
            scene.port.conductivity = 1e-9;
            scene.port.conductivity_field = 50e6;
            scene.port.leakage_area = 1e-4;
            scene.port.leakage_thickness = 40e-6;
            if (run(&scene, samples, NULL, NULL, &error) != DEA_OK)
                fail_msg("%s", error.text);
            int last = samples->count - 1;
            charge[lifted] = samples->charge[last];
            voltage[lifted] = samples->voltage[last];
            film[lifted] = samples->film[last];
            free(samples);
        }
        assert_true(charge[0] > 1e-9 && 3300.0 - voltage[0] > 1.0);
        assert_true(resistance == 0 || voltage[0] - film[0] > 1.0);
        assert_true(fabs(charge[1] - charge[0]) < 1e-5 * charge[0]);
        assert_true(fabs(voltage[1] - voltage[0]) < 1e-5 * voltage[0]);
        assert_true(fabs(film[1] - film[0]) < 1e-5 * film[0]);
    }
}

static void test_fixed_capacitor_follows_the_exact_solution(void **state) {
    (void)state;
    struct samples *samples = new_samples();
    struct dea_error error;
    struct dea_engine_measure measure = {.failed = true};
    struct scene scene = {"title\n" RAMP "R1 in p 1meg\nXdea p 0 pos DEA\n.measure tran peak max v(p)\n",
                          plain_port,
                          {.stop = 5e-3, .step = 1e-6, .max_step = 5e-6, .reltol = 1e-6, .trtol = 1.0},
                          0.0};
    if (run(&scene, samples, &measure, NULL, &error) != DEA_OK)
        fail_msg("%s", error.text);
    assert_true(worst_ramp_error(samples, samples->voltage, 1e6 * C_REST) < 5e-5);
    for (int i = 0; i < samples->count; i++) {
        assert_true(fabs(samples->charge[i] - C_REST * samples->voltage[i]) < 1e-12);
        assert_true(fabs(samples->node[i] - 0.25) < 1e-12); /* 0.25 mm reads 0.25 V */
        assert_true(samples->film[i] == samples->voltage[i]);
    }
    assert_true(samples->time[0] == 0.0);
    assert_true(samples->time[samples->count - 1] == 5e-3);
    assert_string_equal(measure.name, "peak");
    assert_false(measure.failed);
    assert_true(fabs(measure.value - 3300.0) < 0.01);
    free(samples);
}

static void test_electrode_resistance_is_in_series(void **state) {
    (void)state;
    for (int external = 0; external < 2; external++) {
        struct samples *samples = new_samples();
        struct dea_error error;
        samples->resistance = 1e6;
        struct scene scene = {"title\n" RAMP "R1 in p 1k\nXdea p 0 pos DEA\n",
                              plain_port,
                              {.stop = 5e-3, .step = 1e-6, .max_step = 5e-6, .reltol = 1e-6, .trtol = 1.0},
                              0.0};
        scene.port.resistance = external ? 2.5e5 : 1e6; /* at rest; the external number is what counts */
        scene.port.resistance_external = external;
        if (run(&scene, samples, NULL, NULL, &error) != DEA_OK)
            fail_msg("%s", error.text);
        assert_true(worst_ramp_error(samples, samples->film, 1.001e6 * C_REST) < 5e-5);
        int last = samples->count - 1;
        assert_true(fabs(samples->voltage[last] - samples->film[last]) < 0.01);
        free(samples);
    }
}

static void test_moving_capacitor_keeps_its_charge(void **state) {
    (void)state;
    struct samples *samples = new_samples();
    struct dea_error error;
    samples->capacitance = moving_capacitance;
    samples->offset = -200.0 * C_REST;
    /* charged to 3.3 kV through a switch that opens at 0.2 ms: from then on the node is isolated */
    struct scene scene = {"title\nVin in 0 3300\nVg g 0 pulse(1 0 0.2m 1u 1u 1 2)\nS1 in p g 0 sw\n"
                          ".model sw sw(vt=.5 vh=.1 ron=1k roff=1e18)\nXdea p 0 pos DEA\n.options gmin=1e-20\n",
                          plain_port,
                          {.stop = 20e-3, .step = 20e-6, .max_step = 20e-6, .reltol = 1e-4, .trtol = 1.0},
                          0.0};
    scene.port.offset = true;
    if (run(&scene, samples, NULL, NULL, &error) != DEA_OK)
        fail_msg("%s", error.text);
    double first = 0.0, drift = 0.0, mismatch = 0.0, lowest = 1e9, highest = 0.0;
    for (int i = 0; i < samples->count; i++) {
        double t = samples->time[i], v = samples->voltage[i];
        double charge = moving_capacitance(t) * v + samples->offset;
        mismatch = fmax(mismatch, fabs(charge / samples->charge[i] - 1.0));
        if (t < 0.3e-3)
            continue;
        first = first > 0.0 ? first : samples->charge[i];
        drift = fmax(drift, fabs(samples->charge[i] / first - 1.0));
        lowest = fmin(lowest, v);
        highest = fmax(highest, v);
    }
    assert_true(drift < 1e-9);    /* the charge stays */
    assert_true(mismatch < 1e-4); /* the voltage follows it within reltol: ngspice reports its last but one iterate */
    assert_true(highest / lowest > 1.3); /* while the voltage breathes */
    free(samples);
}

static void test_leakage_follows_its_law(void **state) {
    (void)state;
    struct samples *samples = new_samples();
    struct dea_error error;
    const double thickness = 33e-6, lp1 = 1.2, area = 30e-3 * 4e-3, s0 = 1e-12, e_b = 50e6, lam = 1.3;
    samples->stretch = lam;
    struct scene scene = {"title\nVin in 0 3300\nR1 in p 1g\nXdea p 0 pos DEA\n",
                          plain_port,
                          {.stop = 10.0, .step = 1e-3, .max_step = 0.1},
                          0.0};
    scene.port.conductivity = s0;
    scene.port.conductivity_field = e_b;
    scene.port.leakage_area = area / lp1;
    scene.port.leakage_thickness = thickness * lp1;
    if (run(&scene, samples, NULL, NULL, &error) != DEA_OK)
        fail_msg("%s", error.text);
    double v = samples->voltage[samples->count - 1], field = v * lam / (thickness * lp1);
    double leak = s0 * exp(field / e_b) * field * area * lam / lp1;
    assert_true(3300.0 - v > 10.0); /* it leaks at all */
    assert_true(fabs((3300.0 - v) / 1e9 - leak) < 2e-3 * leak);
    free(samples);
}

/* Voltage after a jump of C at 5 ms: charge is kept, then it recharges. With a breakpoint a step ends there; the left
 * limit of C at it belongs to that step. */
static void test_breakpoint_and_left_limit(void **state) {
    (void)state;
    for (int with = 0; with < 2; with++) {
        struct samples *samples = new_samples();
        struct dea_error error;
        samples->capacitance = jumping_capacitance;
        struct scene scene = {"title\nVin in 0 3000\nR1 in p 100meg\nXdea p 0 pos DEA\n",
                              plain_port,
                              {.stop = 10e-3, .step = 100e-6, .max_step = 100e-6, .reltol = 1e-5, .trtol = 1.0},
                              with ? 5e-3 : 0.0};
        if (run(&scene, samples, NULL, NULL, &error) != DEA_OK)
            fail_msg("%s", error.text);
        double worst = 0.0;
        bool landed = false;
        for (int i = 0; i < samples->count; i++) {
            double t = samples->time[i];
            landed = landed || fabs(t - 5e-3) < 1e-12;
            if (t < 5.2e-3)
                continue;
            double exact = 3000.0 - 1000.0 * exp(-(t - 5e-3) / (1e8 * 1.5 * C_REST));
            worst = fmax(worst, fabs(samples->voltage[i] - exact) / 3000.0);
        }
        assert_int_equal(landed, with);
        assert_true(worst < 2e-4);
        free(samples);
    }
}

static void test_steps_can_be_shortened(void **state) {
    (void)state;
    struct samples *samples = new_samples();
    struct dea_error error;
    struct scene scene = {
        "title\n" RAMP "R1 in p 1meg\nXdea p 0 pos DEA\n", plain_port, {.stop = 5e-3, .max_step = 1e-3}, 0.0};
    samples->longest_request = 7e-6;
    if (run(&scene, samples, NULL, NULL, &error) != DEA_OK)
        fail_msg("%s", error.text);
    assert_true(samples->largest_step <= 7.001e-6);
    assert_true(samples->count > 700);
    assert_true(samples->time[samples->count - 1] == 5e-3);
    free(samples);
}

static void test_stop_is_exact_and_measures_survive(void **state) {
    (void)state;
    struct samples *samples = new_samples();
    struct dea_error error;
    struct dea_engine_measure measure = {.failed = true};
    struct dea_engine_stats stats;
    samples->stop_after = 100;
    samples->stop_with = DEA_STOPPED;
    struct scene scene = {"title\nVin in 0 sin(0 10 1k)\nR1 in p 1k\nXdea p 0 pos DEA\n.measure tran peak max v(in)\n",
                          plain_port,
                          {.stop = 1.0, .step = 1e-5, .max_step = 1e-5},
                          0.0};
    assert_int_equal(run(&scene, samples, &measure, &stats, &error), DEA_STOPPED);
    assert_int_equal(samples->count, 100);
    assert_int_equal(stats.points, 100);
    assert_false(measure.failed);
    assert_true(fabs(measure.value - 10.0) < 0.01);

    samples->count = 0;
    samples->stop_with = DEA_ERR_INTERRUPTED;
    assert_int_equal(run(&scene, samples, NULL, NULL, &error), DEA_ERR_INTERRUPTED);
    assert_string_equal(error.text, "stopped by the test");
    free(samples);
}

static void test_uic_starts_from_the_given_charge(void **state) {
    (void)state;
    struct samples *samples = new_samples();
    struct dea_error error;
    struct scene scene = {"title\nR1 p 0 1meg\n.ic v(p)=1000\nXdea p 0 pos DEA\n",
                          plain_port,
                          {.stop = 2e-4, .step = 1e-7, .max_step = 1e-6, .uic = true, .reltol = 1e-6, .trtol = 1.0},
                          0.0};
    scene.port.initial_charge = 1000.0 * C_REST;
    if (run(&scene, samples, NULL, NULL, &error) != DEA_OK)
        fail_msg("%s", error.text);
    assert_true(samples->time[0] > 0.0);
    for (int i = 0; i < samples->count; i++)
        assert_true(fabs(samples->voltage[i] - 1000.0 * exp(-samples->time[i] / (1e6 * C_REST))) < 0.5);
    free(samples);
}

/* Some refusals end with ngspice asking to exit: it is then unusable, but only in the child. */
static enum dea_status run_in_child(struct dea_channel *channel, void *context, struct dea_error *error) {
    (void)channel;
    struct samples *samples = new_samples();
    enum dea_status status = run(context, samples, NULL, NULL, error);
    free(samples);
    return status;
}

/* Netlists ngspice refuses or cannot solve: status and what the message must say. */
static void test_failures_are_explained(void **state) {
    (void)state;
    static const struct {
        const char *netlist;
        enum dea_status status;
        const char *says[3];
    } cases[] = {
        {"t\nV1 p 0 1\nR1 p q 1k bla=3\nXdea p 0 pos DEA\n",
         DEA_ERR_INPUT,
         {":3: ", "unknown parameter (bla)", "r1 p q 1k bla=3"}},
        {"t\nV1 p 0 1\nXdea p 0 pos DEA\nD1 p 0 nomodel\n",
         DEA_ERR_INPUT,
         {":4: ", "can't find model 'nomodel'", NULL}},
        {"t\nV1 p 0 1\nXdea p 0 pos DEA\nX2 p 0 nosub\n", DEA_ERR_INPUT, {":4: ", "unknown subckt", "nosub"}},
        {"t\nV1 p 0 1\nXdea p 0 pos DEA\nR1 p 0\n+ 1k\nR1 p 0 2k\n",
         DEA_ERR_INPUT,
         {":6: ", "device already exists", NULL}},
        {"t\nV1 p 0 1\nXdea p 0 pos DEA\nB1 q 0 V=V(p)/\n", DEA_ERR_INPUT, {":4: ", "syntax error", NULL}},
        {"t\nI1 0 p 1m\nC1 p 0 1n\nXdea p 0 pos DEA\n",
         DEA_ERR_SOLVER,
         {":2: ", "no operating point at t = 0", "singular at p: a node without DC path"}},
        {"t\nV1 p 0 1\nV2 p 0 2\nXdea p 0 pos DEA\n",
         DEA_ERR_SOLVER,
         {":2: ", "singular at v1#branch", "in a loop, whose current nothing determines"}},
        {"t\nV1 p 0 1\nXdea p 0 pos DEA\n.subckt s a\nL1 b 0 1\nL2 b 0 1\nV1 b 0 1\nR1 a 0 1\n.ends\nX1 p s\n",
         DEA_ERR_SOLVER,
         {":10: ", "singular at l.x1.l", "in a loop"}},
        {"t\nV1 p 0 1\nXdea p 0 pos DEA\nB1 b 0 V=V(b)>0.5 ? 0 : 1\nR1 b 0 1k\n",
         DEA_ERR_SOLVER,
         {":4: ", "no operating point at t = 0, trouble with node \"b\"", NULL}},
        {"t\nV1 p 0 1\nXdea p 0 pos DEA\nB1 b 0 V=V(c)>0.5 ? 0 : 1\nR1 b c 1k\nC1 c 0 1m\n",
         DEA_ERR_SOLVER,
         {"no operating point at t = 0 (from zero it does start: .tran with uic, or .nodeset)", NULL, NULL}},
        {"t\nV1 p 0 1\nXdea p 0 pos DEA\nL1 p 0 1\nK1 L1 L2 0.5\n",
         DEA_ERR_INPUT,
         {":5: ", "ngspice refuses the circuit", "coupling to non-existant inductor"}},
        {"t\nV1 p 0 1\nXdea p 0 pos DEA\n.subckt two a b\nR1 a b 1\n.ends\nX1 p two\n",
         DEA_ERR_INPUT,
         {":7: ", "Too few parameters for subcircuit type", NULL}},
        {"t\nV1 p 0 1\nXdea p 0 pos DEA\nR1 p 0 {foo*2}\n", DEA_ERR_INPUT, {":4: ", "Undefined parameter [foo]", NULL}},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct dea_error error;
        struct scene scene = {cases[i].netlist, plain_port, {.stop = 1e-3}, 0.0};
        enum dea_status status = dea_isolate_run(run_in_child, &scene, NULL, NULL, NULL, &error);
        for (int k = 0; k < 3 && cases[i].says[k] != NULL; k++)
            if (status != cases[i].status || strstr(error.text, cases[i].says[k]) == NULL)
                fail_msg("case %zu: expected \"%s\", got %d \"%s\"", i, cases[i].says[k], status, error.text);
    }
}

static void count_message(void *context, enum dea_message_kind kind, const char *text) {
    (void)kind;
    (void)text;
    ++*(int *)context;
}

/* Callbacks need to live as long as load and run: closing talks to nobody. */
static enum dea_status close_after_refusal(struct dea_channel *channel, void *context, struct dea_error *error) {
    (void)channel;
    (void)context;
    static const char text[] = "t\nV1 p 0 1\nXdea p 0 pos DEA\nE1 p 0 p 2\n";
    const struct dea_netlist_device names = {"DEA", 1, {"left", NULL}};
    const struct dea_netlist_options netlist_options = {.devices = &names, .device_count = 1};
    const struct dea_circuit_device device = {.name = "DEA", .port_count = 1, .ports = {plain_port}};
    const struct dea_deck_options options = {.stop = 1e-3};
    int heard = 0, heard_in_load;
    const struct dea_engine_callbacks callbacks = {.context = &heard, .port_value = give, .message = count_message};
    struct dea_netlist netlist;
    struct dea_deck deck;
    struct dea_engine *engine;
    FILE *file = fopen("engine-refused.cir", "w");
    assert_non_null(file);
    fputs(text, file);
    fclose(file);
    assert_int_equal(dea_netlist_read("engine-refused.cir", &netlist_options, &netlist, error), DEA_OK);
    unlink("engine-refused.cir");
    assert_int_equal(dea_deck_build(&netlist, &device, &options, &deck, error), DEA_OK);
    assert_int_equal(dea_engine_open(&engine, error), DEA_OK);
    assert_int_equal(dea_engine_load(engine, &netlist, &deck, &device, &options, &callbacks, error), DEA_ERR_INPUT);
    heard_in_load = heard;
    dea_engine_close(engine);
    dea_deck_clear(&deck);
    dea_netlist_clear(&netlist);
    return heard_in_load > 0 && heard == heard_in_load
               ? DEA_OK
               : dea_fail(error, DEA_ERR_INTERNAL, "%d messages, %d in the load", heard, heard_in_load);
}

static void test_closing_talks_to_nobody(void **state) {
    (void)state;
    struct dea_error error;
    if (dea_isolate_run(close_after_refusal, NULL, NULL, NULL, NULL, &error) != DEA_OK)
        fail_msg("%s", error.text);
}

/* V(b) has no solution once V(p) is above its threshold. */
static void test_collapse_is_diagnosed(void **state) {
    (void)state;
    struct samples *samples = new_samples();
    struct dea_error error;
    struct scene scene = {"t\nV1 in 0 pulse(0 2 0 1u 1u 1 2)\nR1 in p 1k\nC1 p 0 1u\nB2 b 0 V=V(p)>1 ? (V(b)>0.5 ? 0 : "
                          "1) : 0\nR2 b 0 1k\nXdea p 0 pos DEA\n",
                          plain_port,
                          {.stop = 10e-3},
                          0.0};
    assert_int_equal(run(&scene, samples, NULL, NULL, &error), DEA_ERR_SOLVER);
    assert_non_null(strstr(error.text, "the circuit gave up at t = 0.0006"));
    assert_non_null(strstr(error.text, "last steps (t, dt): "));
    assert_non_null(strstr(error.text, "rejected by ngspice"));
    assert_non_null(strstr(error.text, "Timestep too small"));
    assert_non_null(strstr(error.text, "trouble with node \"b\""));
    assert_true(samples->count > 10); /* what was computed has been delivered */
    free(samples);
}

/* Every step converges, but the run would never end. */
static void test_crawling_run_is_ended(void **state) {
    (void)state;
    struct samples *samples = new_samples();
    struct dea_error error;
    samples->longest_request = 1e-15;
    struct scene scene = {"t\n" RAMP "R1 in p 1meg\nXdea p 0 pos DEA\n", plain_port, {.stop = 10e-3}, 0.0};
    assert_int_equal(run(&scene, samples, NULL, NULL, &error), DEA_ERR_SOLVER);
    assert_non_null(strstr(error.text, "the run is not advancing past t = "));
    assert_non_null(strstr(error.text, "accepted"));
    free(samples);
}

/* Code models come with the first netlist that asks for one; ngspice makes a POLY one of them. */
static void test_poly_works(void **state) {
    (void)state;
    struct samples *samples = new_samples();
    struct dea_error error;
    struct dea_engine_measure measure = {.failed = true};
    struct scene scene = {"t\nV1 p 0 PWL(0 0 1m 500)\nE1 b 0 POLY(1) p 0 1 0 4u\nR2 b 0 1k\nXdea p 0 pos DEA\n"
                          ".measure tran top max v(b)\n",
                          plain_port,
                          {.stop = 2e-3, .max_step = 1e-5},
                          0.0};
    enum dea_status status = run(&scene, samples, &measure, NULL, &error);
    if (status != DEA_OK)
        fail_msg("%s\n%s", error.text, samples->messages);
    assert_false(measure.failed);
    assert_true(fabs(measure.value - 2.0) < 1e-3);
    free(samples);
}

/* The system's code models are there, and find files beside the netlist. */
static void test_code_models_work(void **state) {
    (void)state;
    struct samples *samples = new_samples();
    struct dea_error error;
    struct dea_engine_measure measure = {.failed = true};
    FILE *file = fopen("engine-wave.txt", "w");
    assert_non_null(file);
    fputs("0 0\n1e-3 500\n2e-3 500\n", file);
    fclose(file);
    struct scene scene = {
        "t\nA1 %v([src]) wave\n.model wave filesource (file=\"engine-wave.txt\" amploffset=[0] amplscale=[1])\n"
        "R1 src p 1k\nA2 p b gain3\n.model gain3 gain(gain=3)\nR2 b 0 1k\nXdea p 0 pos DEA\n"
        ".measure tran top max par('v(b)/500')\n",
        plain_port,
        {.stop = 2e-3, .max_step = 1e-5},
        0.0};
    enum dea_status status = run(&scene, samples, &measure, NULL, &error);
    unlink("engine-wave.txt");
    if (status != DEA_OK)
        fail_msg("%s\n%s", error.text, samples->messages);
    assert_true(fabs(samples->voltage[samples->count - 1] - 500.0) < 0.1);
    assert_false(measure.failed);
    assert_true(fabs(measure.value - 3.0) < 1e-3);
    free(samples);
}

/* Different circuits one after the other in one process; ngspice's results do not pile up. */
static void test_repeated_runs(void **state) {
    (void)state;
    struct samples *samples = new_samples();
    struct dea_error error;
    struct dea_engine *engine;
    long after_warmup = 0;
    assert_int_equal(dea_engine_open(&engine, &error), DEA_OK);
    for (int i = 0; i < 300; i++) {
        char text[256];
        snprintf(text, sizeof text, "t\nV1 in 0 %d\nR%d in p 1meg\n%s.measure tran peak max v(p)\nXdea p 0 pos DEA\n",
                 i + 1, i, i % 2 == 0 ? "" : "R1x p 0 1meg\n");
        struct scene scene = {text, plain_port, {.stop = 1e-3, .max_step = 1e-6}, 0.0};
        struct dea_engine_measure measure = {.failed = true};
        samples->count = 0;
        if (run_with(engine, &scene, samples, &measure, NULL, &error) != DEA_OK)
            fail_msg("run %d: %s", i, error.text);
        double expected = i % 2 == 0 ? i + 1 : 0.5 * (i + 1);
        assert_true(fabs(measure.value - expected) < 1e-4 * expected);
        assert_true(samples->count > 900 && samples->count < 1500);
        samples->messages[0] = '\0';
        if (i == 50)
            after_warmup = resident_bytes() / 1024;
    }
    dea_engine_close(engine);
    print_message("250 runs of 1000 points: %ld kB more\n", resident_bytes() / 1024 - after_warmup);
#ifndef __SANITIZE_ADDRESS__
    assert_true(resident_bytes() / 1024 - after_warmup < 4096); /* kept results alone would be 10 MB */
#endif
    free(samples);
}

static const char poison[] = "shell touch engine-poison\n";

/* An init file in the current folder, which ngspice would run. */
static int leave_poison(void **state) {
    (void)state;
    FILE *file = fopen(".spiceinit", "w");
    if (file == NULL || fputs(poison, file) < 0)
        return -1;
    return fclose(file);
}

static int check_poison(void **state) {
    (void)state;
    unlink(".spiceinit");
    bool ran = access("engine-poison", F_OK) == 0;
    unlink("engine-poison");
    return ran ? -1 : 0;
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_lifted_film_does_as_a_grounded_one),
        cmocka_unit_test(test_fixed_capacitor_follows_the_exact_solution),
        cmocka_unit_test(test_electrode_resistance_is_in_series),
        cmocka_unit_test(test_moving_capacitor_keeps_its_charge),
        cmocka_unit_test(test_leakage_follows_its_law),
        cmocka_unit_test(test_breakpoint_and_left_limit),
        cmocka_unit_test(test_steps_can_be_shortened),
        cmocka_unit_test(test_stop_is_exact_and_measures_survive),
        cmocka_unit_test(test_uic_starts_from_the_given_charge),
        cmocka_unit_test(test_collapse_is_diagnosed),
        cmocka_unit_test(test_crawling_run_is_ended),
        cmocka_unit_test(test_poly_works),
        cmocka_unit_test(test_code_models_work),
        cmocka_unit_test(test_repeated_runs),
        cmocka_unit_test(test_failures_are_explained),
        cmocka_unit_test(test_closing_talks_to_nobody),
    };
    return cmocka_run_group_tests(tests, leave_poison, check_poison);
}
