/* The list of pairs. */
#include "skipped.h"

#include "cosim/cosim.h"
#include "cosim/native.h"
#include "coupled_cases.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const char *const skipped_ways[] = {[SKIPPED_CIRCUIT] = "linear circuit",
                                    [SKIPPED_POINTS] = "circuit points",
                                    [SKIPPED_REST] = "rest",
                                    [SKIPPED_SIGNALS] = "signals",
                                    [SKIPPED_STATES] = "states"};

#define C_S5 "{" TWO_ZONES "}"
#define MODELS SOURCE_ROOT "/models/"
#define NETLIST(name) "{netlist: " SOURCE_ROOT "/netlists/" name ".cir}"
#define HERE "{netlist: lean.cir}"
#define STEP "{waveform: {type: pulse, low: 0 V, high: 2500 V, delay: 1 ms, rise: 100 us, width: 1 s}"
#define BEHIND_1M "{left: " STEP ", resistance: 1 MOhm}}"
#define SOFT(rest) "{base: " MODELS "materials/sylgard186_elastic.yaml" rest "}"

#define HALF_BRIDGE(later)                                                                                             \
    "t\n.include \"hv_opto.lib\"\nVrail rail0 0 3000\nRrail rail0 rail 100k\nCrail rail 0 10n\n"                       \
    "Vup up0 0 PWL(0 0 4m 0 4.01m 5" later ")\nRup up0 upa 180\nXup upa 0 rail mid HV_OPTO\nRbleed mid 0 500Meg\n"     \
    "Rarc mid left 220k\nCcable left 0 100p\nRbond right 0 1k\nXdea left 0 right 0 pos DEA\n.end\n"
#define RELAY                                                                                                          \
    "t\nVs s 0 3000\nRc s sw 10Meg\nVcoil coil 0 PULSE(0 5 5m 10u 10u 40m 1e9)\nS1 sw left coil 0 reed\n"              \
    ".model reed SW(VT=2.5 VH=0.5 RON=1k ROFF=1e15)\nCcable left 0 100p\nRl left 0 275G\nRb right 0 1k\n"              \
    "Xdea left 0 right 0 pos DEA\n.end\n"

static const struct skipped pairs[] = {
    {SKIPPED_CIRCUIT, "rc_step", C_S5, NULL, NETLIST("rc_step"), NULL, NULL, 120e-3, 1e-4, 0},
    {SKIPPED_CIRCUIT, "rc_ladder", C_S5, NULL, NETLIST("rc_ladder"), NULL, NULL, 160e-3, 1e-4, 0},
    {SKIPPED_CIRCUIT, "rlc", C_S5, NULL, NETLIST("rlc"), NULL, NULL, 30e-3, 1e-4, 0},
    {SKIPPED_CIRCUIT, "two_side_sine", C_S5, NULL, NETLIST("rc_two_side_sine"), NULL, NULL, 240e-3, 1e-4, 0},

    {SKIPPED_POINTS, "cockcroft_walton", C_S5, NULL, NETLIST("cockcroft_walton"), NULL, NULL, 4e-3, 1e-3, 8},
    {SKIPPED_POINTS, "flyback_open", C_S5, NULL, NETLIST("flyback_open"), NULL, NULL, 0.3e-3, 1e-3, 20},
    {SKIPPED_POINTS, "chopped_20_khz", C_S5, NULL, HERE, NULL,
     "t\nVg g 0 PULSE(0 5 0 100n 100n 20u 50u)\nS1 s a g 0 sx\n.model sx SW(VT=2.5 VH=0.5 RON=10k ROFF=1G)\n"
     "Vs s 0 3000\nRa a left 200k\nRb left 0 2Meg\nRc right 0 1k\nXdea left 0 right 0 pos DEA\n.end\n",
     20e-3, 1e-4, 4},

    {SKIPPED_REST, "half_bridge_3_s", C_S5, NULL, HERE, NULL, HALF_BRIDGE(""), 3.0, 1e-4, 2},
    {SKIPPED_REST, "half_bridge_10_s", C_S5, NULL, HERE, NULL, HALF_BRIDGE(""), 10.0, 1e-4, 4},
    {SKIPPED_REST, "half_bridge_coarse", C_S5, NULL, HERE, NULL, HALF_BRIDGE(""), 10.0, 1e-3, 4},
    {SKIPPED_REST, "half_bridge_wakes", C_S5, NULL, HERE, NULL, HALF_BRIDGE(" 8 5 8.001 0"), 10.0, 1e-4, 2},
    {SKIPPED_REST, "relay_hold_10_s", C_S5, NULL, HERE, NULL, RELAY, 10.0, 1e-4, 6},

    {SKIPPED_SIGNALS, "native", C_S5, NULL, BEHIND_1M, NULL, NULL, 0.1, 1e-4, 0},
    {SKIPPED_SIGNALS, "linear", C_S5, NULL, NETLIST("rc_step"), NULL, NULL, 0.1, 1e-4, 0},
    {SKIPPED_SIGNALS, "relay", C_S5, NULL, HERE, NULL, RELAY, 0.1, 1e-4, 0},

    {SKIPPED_STATES, "no_branches", "{" ELASTIC "}",
     "{" ELASTIC ", material: " SOFT(", branches: [{kind: foo, mu: 10 Pa, tau: 10 us}]") "}", BEHIND_1M, NULL, NULL,
     0.05, 1e-5, 4},
    {SKIPPED_STATES, "no_mass",
     "{" ELASTIC ", options: {membrane_mass: false}, platform: {mass: 0 kg, damping: 0.2 N s/m}}",
     "{" ELASTIC ", options: {membrane_mass: false}, platform: {mass: 1e-12 kg, damping: 0.2 N s/m}}", BEHIND_1M, NULL,
     NULL, 0.05, 1e-5, 1},
    {SKIPPED_STATES, "no_damping_either", "{" ELASTIC ", options: {membrane_mass: false}, platform: {mass: 0 kg}}",
     "{" ELASTIC ", options: {membrane_mass: false}, platform: {mass: 0 kg, damping: 1e-9 N s/m}}", BEHIND_1M, NULL,
     NULL, 0.05, 1e-5, 0},
    {SKIPPED_STATES, "one_electrode", "{" TWO_ZONES ", zones: {right: {electrode: null}}}", C_S5, BEHIND_1M,
     "{left: " STEP ", resistance: 1 MOhm}, right: {waveform: {type: dc, level: 0 V}, resistance: 1 Ohm}}", NULL, 0.05,
     1e-5, 1},
    {SKIPPED_STATES, "ideal_source", C_S5, NULL, "{left: " STEP "}}", "{left: " STEP ", resistance: 1 mOhm}}", NULL,
     0.05, 1e-5, 1},
    {SKIPPED_STATES, "no_amplifier", C_S5, NULL, BEHIND_1M,
     "{left: " STEP ", resistance: 1 MOhm, amplifier: {bandwidth: 1 GHz}}}", NULL, 0.05, 1e-5, 1},
    {SKIPPED_STATES, "no_slack", "{" TWO_ZONES ", options: {slack: false}}", C_S5, BEHIND_1M, NULL, NULL, 0.05, 1e-5,
     0},
    {SKIPPED_STATES, "no_leakage", C_S5,
     "{" TWO_ZONES ", material: {base: " MODELS "materials/sylgard186.yaml, dielectric: {conductivity: 1e-25 S/m}}}",
     BEHIND_1M, NULL, NULL, 0.05, 1e-5, 0},
    {SKIPPED_STATES, "no_stops", C_S5, "{" TWO_ZONES ", platform: {stops: [-3 mm, 3 mm]}}", BEHIND_1M, NULL, NULL, 0.05,
     1e-5, 0},
};

const struct skipped *list_skipped(size_t *count) {
    *count = sizeof pairs / sizeof pairs[0];
    return pairs;
}

/* ---- runs ---- */

static void write_text(const char *path, const char *text) {
    FILE *file = fopen(path, "w");
    if (file == NULL || fputs(text, file) == EOF || fclose(file) != 0)
        abort();
}

static void read_pair(const struct skipped *pair, bool lean, struct dea_scene *scene) {
    char text[8192];
    if (pair->netlist != NULL) {
        write_text("lean.cir", pair->netlist);
        if (system("cp '" SOURCE_ROOT "/netlists/parts/hv_opto.lib' .") != 0)
            abort();
    }
    snprintf(text, sizeof text, "title: Pair\ndevice: %s\ndrive: %s\ntransient: {stop: %.17g s}\n" SILENT_EVENTS "\n%s",
             lean || pair->full == NULL ? pair->device : pair->full,
             lean || pair->other == NULL ? pair->drive : pair->other, pair->stop,
             lean && pair->way == SKIPPED_SIGNALS ? "output: {signals: [x, left.port_voltage]}\n" : "");
    write_text("pair.yaml", text);
    struct dea_error error;
    if (dea_scene_read("pair.yaml", NULL, 0, scene, &error) != DEA_OK) {
        fprintf(stderr, "%s: %s\n", pair->name, error.text);
        abort();
    }
}

void run_skipped(const struct skipped *pair, bool lean, size_t samples, struct coupled_rows *rows) {
    struct dea_scene scene;
    const struct cosim_control control = {.pointwise = !lean && pair->way == SKIPPED_POINTS,
                                          .restless = !lean && pair->way == SKIPPED_REST};
    read_pair(pair, lean, &scene);
    if (pair->way == SKIPPED_POINTS || pair->way == SKIPPED_REST)
        run_with_control(&scene, pair->accuracy, &control, samples, rows);
    else
        run_scene(&scene, !lean && pair->way == SKIPPED_CIRCUIT ? DEA_ENGINE_NGSPICE : DEA_ENGINE_AUTO, pair->accuracy,
                  samples, rows);
    dea_scene_clear(&scene);
}

static enum dea_status ignore_signals(void *context, const struct dea_signal *signals, size_t count,
                                      struct dea_error *error) {
    (void)context, (void)signals, (void)count, (void)error;
    return DEA_OK;
}

static enum dea_status ignore_row(void *context, double t, const double *values, size_t count,
                                  struct dea_error *error) {
    (void)context, (void)t, (void)values, (void)count, (void)error;
    return DEA_OK;
}

int count_states(const struct skipped *pair, bool lean) {
    struct dea_scene scene;
    read_pair(pair, lean, &scene);
    struct dea_report report = {.log = tmpfile()};
    struct dea_run_options options = {.report = &report};
    struct row_sink sink = {.open = ignore_signals, .row = ignore_row};
    struct dea_result result = {0};
    struct dea_error error;
    if (report.log == NULL || run_native(&scene, NULL, &options, &sink, &result, &error) != DEA_OK)
        abort();
    int count = 0;
    char line[1024] = "";
    rewind(report.log);
    while (fgets(line, sizeof line, report.log) != NULL && strncmp(line, "states:", 7) != 0)
        ;
    strtok(line, " \n");
    for (const char *word = strtok(NULL, " \n"); word != NULL; word = strtok(NULL, " \n"))
        if (word[0] != '|' && strchr(word, ':') == NULL)
            count++;
    fclose(report.log);
    dea_result_clear(&result);
    dea_scene_clear(&scene);
    return count;
}
