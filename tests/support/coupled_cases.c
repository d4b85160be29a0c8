/* The list of cases. */
#include "coupled_cases.h"

#include <string.h>

static struct lead rlc_lead(void) {
    struct lead lead = step_lead(2000.0, 1e-3, 1e-6, 10500.0);
    lead.inductance = 0.1;
    lead.shunt_c = 50e-12;
    lead.shunt_r = 1e9;
    return lead;
}

static struct lead soft_rlc_lead(void) {
    struct lead lead = step_lead(2000.0, 1e-3, 1e-4, 2e6);
    lead.inductance = 1000.0;
    lead.shunt_c = 50e-12;
    return lead;
}

static struct lead ladder_lead(double volts) {
    struct lead lead = {.points = 4,
                        .t = {5e-3, 11e-3, 81e-3, 87e-3},
                        .u = {0.0, volts, volts, 0.0},
                        .resistance = 400e3,
                        .sections = 4,
                        .section_c = 40e-12,
                        .section_r = 400e3,
                        .shunt_c = 40e-12};
    return lead;
}

static struct lead hold_lead(void) {
    struct lead lead = step_lead(3000.0, 5e-3, 1e-5, 10e6);
    lead.opens_at = 45e-3;
    lead.open_r = 1e13;
    lead.shunt_c = 100e-12;
    lead.shunt_r = 8.8e9;
    return lead;
}

static struct lead pulses_lead(double volts, double resistance) {
    struct lead lead = {.points = 8,
                        .t = {1e-3, 1.1e-3, 11e-3, 11.1e-3, 21e-3, 21.1e-3, 31e-3, 31.1e-3},
                        .u = {0.0, volts, volts, 0.3 * volts, 0.3 * volts, -volts, -volts, 0.0},
                        .resistance = resistance};
    return lead;
}

static struct lead ramp_lead(double from, double to, double length, double resistance) {
    return (struct lead){.points = 2, .t = {0.0, length}, .u = {from, to}, .resistance = resistance};
}

static struct coupled_case cases[40];
static size_t case_count;

static void add(const char *name, const char *device, struct lead left, struct lead right, double stop, bool native) {
    cases[case_count++] = (struct coupled_case){name, device, {{left, right}, stop}, native};
}

static void fill_cases(void) {
    struct lead idle = dc_lead(0.0, 1e6), resistive = step_lead(2500.0, 1e-3, 1e-5, 1e6), leaky;
    add("rc_step", "{" TWO_ZONES "}", step_lead(3300.0, 1e-3, 1e-5, 1e6), idle, 0.12, true);
    add("rc_step_elastic", "{" ELASTIC "}", step_lead(3300.0, 1e-3, 1e-5, 1e6), idle, 0.12, true);
    add("two_side_sine", "{" TWO_ZONES "}", sine_lead(2000.0, 800.0, 25.0, 1e6), sine_lead(2000.0, -800.0, 25.0, 1e6),
        0.24, true);
    add("ladder", "{" TWO_ZONES "}", ladder_lead(2500.0), idle, 0.16, false);
    add("rlc", "{" TWO_ZONES "}", rlc_lead(), dc_lead(0.0, 1e3), 0.03, false);
    add("rlc_soft", "{" TWO_ZONES "}", soft_rlc_lead(), idle, 0.06, false);
    add("hold", "{" TWO_ZONES "}", hold_lead(), dc_lead(0.0, 1e3), 0.4, false);
    leaky = step_lead(3000.0, 1e-3, 1e-4, 1e8);
    add("film_leak",
        "{" TWO_ZONES ", material: {base: " SOURCE_ROOT
        "/models/materials/sylgard186.yaml, dielectric: {conductivity: 3e-9 S/m, conductivity_field: 60 V/um}}}",
        leaky, idle, 0.2, false);
    add("massless_ramp", "{" ELASTIC ", " NO_MASS "}", ramp_lead(0.0, 3300.0, 2e-3, 1e6), idle, 5e-3, true);
    add("massless_bias", "{" ELASTIC ", " NO_MASS "}", ramp_lead(0.0, 3300.0, 2e-3, 1e6), dc_lead(4000.0, 1e6), 5e-3,
        true);
    add("massless_viscous",
        "{" ELASTIC ", options: {membrane_mass: false}, platform: {mass: 0 kg, damping: 0.2 N s/m}}",
        step_lead(3000.0, 1e-3, 1e-5, 1e6), idle, 10e-3, true);
    add("massless_branches", "{" TWO_ZONES ", " NO_MASS "}", step_lead(3000.0, 1e-3, 1e-4, 1e7), idle, 50e-3, true);
    /* held out */
    add("r_1k", "{" TWO_ZONES "}", step_lead(2500.0, 1e-3, 1e-4, 1e3), dc_lead(0.0, 1e3), 0.03, true);
    add("r_100k", "{" TWO_ZONES "}", step_lead(2500.0, 1e-3, 1e-4, 1e5), idle, 0.06, true);
    add("r_10M", "{" TWO_ZONES "}", step_lead(2500.0, 1e-3, 1e-4, 1e7), idle, 0.06, true);
    add("r_100M", "{" TWO_ZONES "}", step_lead(2500.0, 1e-3, 1e-4, 1e8), idle, 0.2, true);
    add("r_1G", "{" TWO_ZONES "}", step_lead(2500.0, 1e-3, 1e-4, 1e9), idle, 0.5, true);
    add("v_100", "{" TWO_ZONES "}", step_lead(100.0, 1e-3, 1e-5, 1e6), idle, 0.06, true);
    add("v_500_sine", "{" TWO_ZONES "}", sine_lead(0.0, 500.0, 40.0, 1e7), idle, 0.1, true);
    add("resonance", "{" TWO_ZONES "}", sine_lead(1500.0, 200.0, 170.0, 1e6), idle, 0.15, true);
    add("both_bias", "{" TWO_ZONES "}", pulses_lead(3300.0, 3e6), dc_lead(3500.0, 1e7), 0.06, true);
    add("reversal", "{" ELASTIC "}", pulses_lead(2800.0, 1e6), pulses_lead(-1500.0, 2e7), 0.06, true);
    add("fast_sine", "{" TWO_ZONES "}", sine_lead(1500.0, 1000.0, 2000.0, 1e6), idle, 0.03, true);
    add("r_electrode", "{base: " SOURCE_ROOT "/models/planar_carbon_electrodes.yaml}", resistive, idle, 0.06, true);
}

const struct coupled_case *list_cases(size_t *count) {
    if (case_count == 0)
        fill_cases();
    *count = case_count;
    return cases;
}

const struct coupled_case *find_case(const char *name) {
    size_t count;
    const struct coupled_case *all = list_cases(&count);
    for (size_t i = 0; i < count; i++)
        if (strcmp(all[i].name, name) == 0)
            return &all[i];
    return NULL;
}
