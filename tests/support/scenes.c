/* Named and random scenes, filled by hand. */
#include "scenes.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const char *const test_scene_names[SCENE_COUNT] = {
    [SCENE_RC_STEP] = "RC step",
    [SCENE_RC_UNDAMPED] = "RC step, undamped",
    [SCENE_SINE] = "sine with bias",
    [SCENE_ANTIPHASE] = "antiphase",
    [SCENE_VISCOUS] = "massless viscous",
    [SCENE_ALGEBRAIC] = "massless algebraic",
    [SCENE_RAMP] = "ideal ramp",
    [SCENE_STIFF_BRANCH] = "stiff branch 1e-6 s",
    [SCENE_VHB] = "VHB, three branches",
    [SCENE_SLACK] = "slack in and out",
    [SCENE_SLACK_ACTIVE] = "driven zone slack",
    [SCENE_STOPS] = "end stops",
    [SCENE_AMPLIFIER] = "amplifier",
    [SCENE_SLEW] = "slew limit alone",
    [SCENE_LEAKAGE] = "leakage",
    [SCENE_LOAD] = "load waveform",
    [SCENE_SMALL] = "10 V",
    [SCENE_ATTENUATED] = "attenuated",
    [SCENE_RINGING] = "200 cycles",
    [SCENE_FRESH] = "fresh branches",
    [SCENE_PULSES] = "pulse train",
};

struct dea_waveform dc_wave(double level) {
    return (struct dea_waveform){.kind = DEA_WAVE_DC, .level = level};
}

struct dea_waveform step_wave(double low, double high, double rise) {
    return (struct dea_waveform){.kind = DEA_WAVE_PULSE, .low = low, .high = high, .rise = rise, .width = INFINITY};
}

struct dea_waveform sine_wave(double offset, double amplitude, double frequency) {
    return (struct dea_waveform){
        .kind = DEA_WAVE_SINE, .offset = offset, .amplitude = amplitude, .frequency = frequency};
}

void drive_zone(struct test_scene *s, int zone, struct dea_waveform waveform, double resistance) {
    s->scene.sources[zone] = (struct dea_source){.present = true, .waveform = waveform, .resistance = resistance};
}

void add_branch(struct test_scene *s, enum dea_branch_kind kind, double mu, double tau, double jm) {
    struct dea_material *material = &s->device.device.material;
    if (material->branch_count == TEST_BRANCHES)
        abort();
    s->branches[material->branch_count++] = (struct dea_branch){.kind = kind, .mu = mu, .tau = tau, .jm = jm};
    material->branches = s->branches;
}

void prepare_scene(struct test_scene *s) {
    struct dea_error error;
    if (dea_device_prepare(&s->device.device, &error) != DEA_OK) {
        fprintf(stderr, "a test's own device is not possible: %s\n", error.text);
        abort();
    }
}

void build_design_c(struct test_scene *s) {
    static char path[] = "scene", title[] = "test";
    memset(s, 0, sizeof *s);
    s->scene = (struct dea_scene){.path = path, .title = title, .devices = &s->device, .device_count = 1, .stop = 0.12};
    s->scene.has_transient = true;
    s->scene.accuracy = 1e-4;
    for (int i = 0; i < DEA_EVENT_COUNT; i++)
        s->scene.policies[i] = DEA_POLICY_WARN;
    struct dea_device *device = &s->device.device;
    device->width = 30e-3;
    device->thickness = 33e-6;
    device->prestretch[0] = device->prestretch[1] = 1.2;
    device->material.elastic = (struct dea_law){.kind = DEA_GENT, .mu = 0.365e6, .jm = 16.6};
    device->material.dielectric =
        (struct dea_dielectric){.permittivity = 2.5, .breakdown = 100e6, .conductivity_field = INFINITY};
    device->material.density = 1120.0;
    for (int k = 0; k < DEA_ZONES; k++)
        device->zones[k] = (struct dea_zone){.present = true, .electroded = true, .length = 4e-3};
    device->platform_mass = 0.428e-3;
    device->membrane_mass = device->slack = true;
    snprintf(s->device.name, sizeof s->device.name, "DEA");
    prepare_scene(s);
}

/* The placeholder branches of the Sylgard preset. */
static void add_sylgard_branches(struct test_scene *s) {
    double mu = s->device.device.material.elastic.mu;
    add_branch(s, DEA_BRANCH_FOO, 0.08 * mu, 2e-3, INFINITY);
    add_branch(s, DEA_BRANCH_FOO, 0.06 * mu, 0.2, INFINITY);
}

static void build_massless(struct test_scene *s, double damping) {
    s->device.device.platform_mass = 0.0;
    s->device.device.membrane_mass = false;
    s->device.device.damping = damping;
}

static void build_vhb(struct test_scene *s) {
    struct dea_device *device = &s->device.device;
    device->material.elastic = (struct dea_law){.kind = DEA_ARRUDA_BOYCE, .mu = 15.36e3, .locking_stretch = 5.99};
    device->material.dielectric.permittivity = 4.8;
    device->material.dielectric.breakdown = 51e6;
    device->material.dielectric.breakdown_reference = 1e-3;
    device->material.dielectric.breakdown_thickness_exponent = 0.25;
    device->material.dielectric.breakdown_stretch_exponent = 0.63;
    device->material.density = 1000.0;
    device->prestretch[0] = device->prestretch[1] = 3.0;
    device->thickness = 1e-3 / 9.0;
    device->damping = 0.05;
    add_branch(s, DEA_BRANCH_FOO, 26.06e3, 0.6074, INFINITY);
    add_branch(s, DEA_BRANCH_FOO, 26.53e3, 6.56, INFINITY);
    add_branch(s, DEA_BRANCH_FOO, 10.83e3, 61.25, INFINITY);
    drive_zone(s, 0,
               (struct dea_waveform){
                   .kind = DEA_WAVE_TRAPEZOID, .low = 0, .high = 3000, .delay = 0.5, .rise = 2, .width = 5, .fall = 2},
               1e8);
    s->scene.stop = 20.0;
}

static void build_slack(struct test_scene *s, bool active) {
    struct dea_device *device = &s->device.device;
    device->prestretch[0] = 0.86;
    device->prestretch[1] = 1.7;
    add_sylgard_branches(s);
    device->material.dielectric.breakdown = INFINITY;
    if (active) { /* an electroded zone pushed together by a load while its voltage takes the tension away */
        drive_zone(s, 0, dc_wave(1000), 1e6);
        drive_zone(s, 1, sine_wave(2400, 600, 35), 1e6);
    } else {
        drive_zone(s, 0, sine_wave(1700, 1700, 35), 1e6);
    }
}

/* Pole a plant gives an amplifier that only names its slew rate (layout.c), Hz. */
#define SLEW_POLE (20.0 * 1.5e6 / 3300.0 / (2.0 * M_PI))

static void build_amplifier(struct test_scene *s, double bandwidth, double current_limit) {
    add_sylgard_branches(s);
    drive_zone(s, 0,
               (struct dea_waveform){.kind = DEA_WAVE_PULSE,
                                     .low = 0,
                                     .high = 3300,
                                     .delay = 2e-3,
                                     .rise = 1e-4,
                                     .fall = 1e-4,
                                     .width = 20e-3,
                                     .period = 50e-3},
               0.0);
    s->scene.sources[0].amplified = true;
    s->scene.sources[0].amplifier = (struct dea_amplifier){
        .slew_rate = 1.5e6, .current_limit = current_limit, .bandwidth = bandwidth, .output_resistance = 1e5};
}

static void build_leakage(struct test_scene *s) {
    struct dea_device *device = &s->device.device;
    device->material.dielectric.conductivity = 1e-12;
    device->material.dielectric.conductivity_field = 30e6;
    device->zones[0].sheet_resistance = 50e3;
    device->zones[1].sheet_resistance = 50e3;
    device->zones[1].feed = DEA_FEED_NARROW_END;
    add_sylgard_branches(s);
    drive_zone(s, 0, step_wave(0, 3300, 1e-3), 1e7);
    drive_zone(s, 1, dc_wave(500), 1e7);
}

static void build_drive(struct test_scene *s, enum test_scene_name name) {
    struct dea_device *device = &s->device.device;
    double mu = device->material.elastic.mu;
    switch (name) {
    case SCENE_RC_STEP:
    case SCENE_SMALL:
        add_branch(s, DEA_BRANCH_NETWORK, 0.08 * mu, 2e-3, INFINITY);
        drive_zone(s, 0, step_wave(0, name == SCENE_SMALL ? 10 : 3300, 0), 1e6);
        break;
    case SCENE_RC_UNDAMPED:
        drive_zone(s, 0, step_wave(0, 3300, 0), 1e6);
        break;
    case SCENE_SINE:
        add_sylgard_branches(s);
        drive_zone(s, 0, sine_wave(1650, 1650, 60), 1e5);
        break;
    case SCENE_ANTIPHASE:
        add_sylgard_branches(s);
        drive_zone(s, 0, sine_wave(2000, 1200, 45), 1e6);
        drive_zone(s, 1, sine_wave(2000, -1200, 45), 1e6);
        break;
    case SCENE_VISCOUS:
        build_massless(s, 0.5);
        drive_zone(s, 0, step_wave(0, 3300, 0), 1e6);
        s->scene.stop = 0.02;
        break;
    case SCENE_ALGEBRAIC:
        build_massless(s, 0.0);
        drive_zone(s, 0, sine_wave(1650, 1650, 200), 1e6);
        s->scene.stop = 0.02;
        break;
    case SCENE_RAMP:
        add_sylgard_branches(s);
        drive_zone(s, 0, step_wave(0, 3300, 5e-3), 0);
        break;
    case SCENE_STIFF_BRANCH:
        add_branch(s, DEA_BRANCH_FOO, 0.1 * mu, 1e-6, INFINITY);
        add_branch(s, DEA_BRANCH_FOO, 0.1 * mu, 1e-3, 30.0);
        drive_zone(s, 0, step_wave(0, 3300, 0), 1e6);
        s->scene.stop = 0.03;
        break;
    default:
        break;
    }
}

static void build_other(struct test_scene *s, enum test_scene_name name) {
    struct dea_device *device = &s->device.device;
    switch (name) {
    case SCENE_STOPS:
        add_sylgard_branches(s);
        device->has_stops = true;
        device->stops[0] = -0.2e-3;
        device->stops[1] = 0.45e-3;
        device->stop_loss = 2.0;
        drive_zone(s, 0, step_wave(0, 3300, 0), 1e6);
        break;
    case SCENE_LOAD:
        add_sylgard_branches(s);
        drive_zone(s, 0, dc_wave(2500), 1e6);
        s->scene.has_load_waveform = true;
        s->scene.load = sine_wave(0.02, 0.05, 70);
        break;
    case SCENE_ATTENUATED: /* the film sees 1 % of the source in this time */
        drive_zone(s, 0, step_wave(0, 3300, 0), 1e9);
        s->scene.stop = 1e-3;
        break;
    case SCENE_RINGING:
        drive_zone(s, 0, step_wave(0, 3300, 0), 1e5);
        s->scene.stop = 200.0 / 180.0;
        break;
    case SCENE_FRESH:
        add_branch(s, DEA_BRANCH_FOO, 0.3 * device->material.elastic.mu, 5e-3, 40.0);
        add_branch(s, DEA_BRANCH_NETWORK, 0.2 * device->material.elastic.mu, 50e-3, INFINITY);
        s->scene.start = DEA_START_FRESH;
        drive_zone(s, 1, step_wave(0, 2500, 1e-3), 1e6);
        break;
    case SCENE_PULSES:
        add_sylgard_branches(s);
        drive_zone(
            s, 0,
            (struct dea_waveform){
                .kind = DEA_WAVE_PULSE, .high = 3000, .rise = 2e-4, .fall = 2e-4, .width = 1.3e-3, .period = 3e-3},
            3e5);
        break;
    default:
        build_drive(s, name);
        break;
    }
}

void build_scene(struct test_scene *s, enum test_scene_name name) {
    build_design_c(s);
    if (name == SCENE_VHB)
        build_vhb(s);
    else if (name == SCENE_SLACK || name == SCENE_SLACK_ACTIVE)
        build_slack(s, name == SCENE_SLACK_ACTIVE);
    else if (name == SCENE_AMPLIFIER || name == SCENE_SLEW)
        build_amplifier(s, name == SCENE_SLEW ? SLEW_POLE : 5e3, name == SCENE_SLEW ? INFINITY : 1e-4);
    else if (name == SCENE_LEAKAGE)
        build_leakage(s);
    else
        build_other(s, name);
    prepare_scene(s);
}

/* ---- random scenes ---- */

/* xorshift (Marsaglia 2003): the same numbers on every machine. */
static double draw(unsigned long long *state) {
    *state ^= *state << 13;
    *state ^= *state >> 7;
    *state ^= *state << 17;
    return (double)(*state >> 11) / 9007199254740992.0;
}

static double draw_between(unsigned long long *state, double low, double high) {
    return low + (high - low) * draw(state);
}

static double draw_log(unsigned long long *state, double low, double high) {
    return low * pow(high / low, draw(state));
}

static struct dea_waveform draw_wave(struct test_scene *s, int slot, unsigned long long *state, double peak) {
    double stop = s->scene.stop;
    switch ((int)(6.0 * draw(state))) {
    case 0:
        return dc_wave(peak * draw(state));
    case 1:
        return step_wave(0, peak, draw(state) < 0.4 ? 0.0 : draw_log(state, 1e-4, 0.3) * stop);
    case 2:
        return sine_wave(0.5 * peak, 0.5 * peak * draw(state), draw_between(state, 0.5, 12.0) / stop);
    case 3:
        return (struct dea_waveform){.kind = DEA_WAVE_CHIRP,
                                     .offset = 0.5 * peak,
                                     .amplitude = 0.5 * peak,
                                     .frequency = 1.0 / stop,
                                     .frequency_end = draw_between(state, 2.0, 12.0) / stop,
                                     .duration = 0.8 * stop};
    case 4: {
        double period = stop / (1.0 + floor(6.0 * draw(state))), edge = 0.1 * period * draw(state);
        return (struct dea_waveform){.kind = DEA_WAVE_PULSE,
                                     .high = peak,
                                     .delay = 0.1 * period,
                                     .rise = edge,
                                     .fall = edge,
                                     .width = 0.4 * period,
                                     .period = period};
    }
    default: {
        int n = 3 + (int)(8.0 * draw(state));
        for (int i = 0; i < n; i++) {
            s->times[slot][i] = stop * i / n;
            s->values[slot][i] = peak * draw(state);
        }
        return (struct dea_waveform){
            .kind = DEA_WAVE_PWL, .times = s->times[slot], .values = s->values[slot], .point_count = (size_t)n};
    }
    }
}

static void draw_material(struct dea_material *material, unsigned long long *state) {
    double mu = draw_log(state, 0.05e6, 1e6);
    switch ((int)(5.0 * draw(state))) {
    case 1:
        material->elastic = (struct dea_law){.kind = DEA_NEO_HOOKEAN, .mu = mu};
        break;
    case 2:
        material->elastic =
            (struct dea_law){.kind = DEA_YEOH, .yeoh_terms = 3, .yeoh = {0.5 * mu, -0.04 * mu, 0.015 * mu}};
        break;
    case 3:
        material->elastic = (struct dea_law){
            .kind = DEA_OGDEN, .ogden_terms = 2, .ogden_mu = {0.8 * mu, -0.1 * mu}, .ogden_alpha = {1.9, -2.4}};
        break;
    case 4:
        material->elastic =
            (struct dea_law){.kind = DEA_ARRUDA_BOYCE, .mu = mu, .locking_stretch = draw_between(state, 2.5, 7.0)};
        break;
    default:
        material->elastic = (struct dea_law){.kind = DEA_GENT, .mu = mu, .jm = draw_between(state, 8.0, 100.0)};
        break;
    }
    material->dielectric.permittivity = draw_between(state, 2.3, 5.0);
    if (draw(state) < 0.3)
        material->dielectric.permittivity_slope = -0.1 * material->dielectric.permittivity;
    material->dielectric.breakdown = INFINITY;
    if (draw(state) < 0.3) {
        material->dielectric.conductivity = draw_log(state, 1e-13, 1e-10);
        material->dielectric.conductivity_field = draw(state) < 0.5 ? INFINITY : 4e7;
    }
}

static void draw_dynamics(struct test_scene *s, unsigned long long *state) {
    struct dea_device *device = &s->device.device;
    double kind = draw(state);
    if (kind < 0.1)
        build_massless(s, 0.0);
    else if (kind < 0.25)
        build_massless(s, draw_log(state, 0.02, 5.0));
    else
        device->platform_mass = draw_log(state, 0.05e-3, 3e-3);
    if (kind > 0.6)
        device->damping = draw_log(state, 1e-3, 1.0);
    int branches = (int)(4.0 * draw(state));
    for (int b = 0; b < branches; b++) {
        double mu = dea_law_modulus(&device->material.elastic) * draw_log(state, 0.02, 1.5);
        double tau = s->scene.stop * draw_log(state, 1e-3, 10.0);
        bool foo = draw(state) < 0.6;
        add_branch(s, foo ? DEA_BRANCH_FOO : DEA_BRANCH_NETWORK, mu, tau,
                   foo && draw(state) < 0.4 ? draw_between(state, 5.0, 50.0) : INFINITY);
    }
}

void build_random_scene(struct test_scene *s, unsigned seed) {
    unsigned long long number = 0x9e3779b97f4a7c15ull * (seed + 1u), *state = &number;
    for (int i = 0; i < 8; i++)
        draw(state);
    build_design_c(s);
    struct dea_device *device = &s->device.device;
    device->prestretch[0] = draw_between(state, 0.95, 1.6);
    device->prestretch[1] = draw_between(state, 1.2, 2.2);
    device->thickness = draw_log(state, 10e-6, 100e-6);
    device->zones[0].length = draw_between(state, 1e-3, 10e-3);
    device->zones[1].length = draw_between(state, 1e-3, 10e-3);
    draw_material(&device->material, state);
    prepare_scene(s);
    double period = 2.0 * M_PI * sqrt(device->effective_mass / device->stiffness);
    s->scene.stop = period * draw_log(state, 1.0, 40.0);
    draw_dynamics(s, state);

    /* voltages in terms of the field that rivals the modulus */
    double modulus = dea_law_modulus(&device->material.elastic);
    double yield = device->thickness * sqrt(modulus / (device->material.dielectric.permittivity * 8.854e-12));
    double capacitance = device->zones[0].rest_capacitance;
    for (int k = 0; k < DEA_ZONES; k++) {
        if (k == 1 && draw(state) < 0.4) {
            device->zones[1].electroded = draw(state) < 0.5;
            continue;
        }
        double peak = yield * draw_log(state, 0.05, 0.6);
        double resistance = draw(state) < 0.25 ? 0.0 : s->scene.stop * draw_log(state, 1e-5, 0.3) / capacitance;
        drive_zone(s, k, draw_wave(s, k, state, peak), resistance);
        if (resistance > 0.0 && draw(state) < 0.2)
            device->zones[k].sheet_resistance = resistance;
        if (resistance > 0.0 && draw(state) < 0.2) {
            s->scene.sources[k].amplified = true;
            s->scene.sources[k].amplifier = (struct dea_amplifier){
                .slew_rate = draw(state) < 0.5 ? INFINITY : 30.0 * peak / s->scene.stop,
                .bandwidth = draw_log(state, 20.0, 2000.0) / s->scene.stop,
                .current_limit = draw(state) < 0.5 ? INFINITY : 20.0 * peak * capacitance / s->scene.stop};
        }
    }
    if (draw(state) < 0.15) {
        s->scene.has_load_waveform = true;
        s->scene.load = draw_wave(s, 2, state, 0.1 * device->stiffness * device->zones[0].length);
    }
    if (draw(state) < 0.1)
        device->load = 0.05 * device->stiffness * device->zones[0].length;
    prepare_scene(s);
}

void read_tree_scene(const char *path_from_top, struct dea_scene *scene) {
    char path[1024];
    struct dea_error error;
    *scene = (struct dea_scene){0};
    snprintf(path, sizeof path, "%s/%s", SOURCE_ROOT, path_from_top);
    if (dea_scene_read(path, NULL, 0, scene, &error) != DEA_OK) {
        fprintf(stderr, "%s\n", error.text);
        abort();
    }
}
