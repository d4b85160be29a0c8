/* Good scenes, devices and materials: every value arrives in SI, every default is the documented one. */
#include "deasim/scene.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "scene_files.h"

#define assert_close(value, expected)                                                                                  \
    do {                                                                                                               \
        double value_ = (value), expected_ = (expected);                                                               \
        if (!(fabs(value_ - expected_) <= 1e-15 * fabs(expected_)))                                                    \
            fail_msg("%s is %.17g, expected %.17g", #value, value_, expected_);                                        \
    } while (0)

static void read_good_scene(const char *text, struct dea_scene *scene) {
    struct dea_error error = {0};
    write_text("good.yaml", text);
    if (dea_scene_read("good.yaml", NULL, 0, scene, &error) != DEA_OK)
        fail_msg("%s", error.text);
}

static void read_good_device(const char *text, struct dea_device *device) {
    struct dea_error error = {0};
    write_text("good.yaml", text);
    if (dea_device_read("good.yaml", NULL, 0, device, &error) != DEA_OK)
        fail_msg("%s", error.text);
}

#define NATIVE "device: device.yaml\ntransient: {stop: 1 s}\n"
#define FILM "geometry: {width: 30 mm, thickness: 33 um, prestretch: [1.2, 1.3]}\n"
#define RUBBER "elastic: {law: gent, mu: 0.365 MPa, jm: 16.6}, density: 1120, dielectric: {permittivity: 2.5}"

static void reads_the_example(void **state) {
    (void)state;
    struct dea_scene scene;
    read_good_scene(original_text("scene.yaml"), &scene);
    assert_string_equal(scene.path, "good.yaml");
    assert_string_equal(scene.title, "Test");
    assert_int_equal(scene.device_count, 1);
    assert_string_equal(scene.devices[0].name, "DEA");
    assert_null(scene.netlist);
    assert_true(scene.sources[0].present);
    assert_int_equal(scene.sources[0].waveform.kind, DEA_WAVE_DC);
    assert_close(scene.sources[0].waveform.level, 3300);
    assert_close(scene.sources[0].resistance, 1e6);
    assert_false(scene.sources[0].amplified);
    assert_false(scene.sources[1].present);
    assert_true(scene.has_transient);
    assert_close(scene.stop, 0.4);
    assert_close(scene.accuracy, 1e-4);
    assert_true(scene.max_step == 0);
    assert_int_equal(scene.start, DEA_START_EQUILIBRIUM);
    assert_false(scene.has_initial_x || scene.has_initial_v || scene.has_load_waveform);
    assert_int_equal(scene.policies[DEA_EVENT_BREAKDOWN], DEA_POLICY_STOP);
    assert_int_equal(scene.policies[DEA_EVENT_SLACK], DEA_POLICY_WARN);
    assert_int_equal(scene.policies[DEA_EVENT_STOP], DEA_POLICY_WARN);
    assert_close(scene.sample, 1e-4);
    assert_int_equal(scene.formats, DEA_FORMAT_CSV | DEA_FORMAT_RAW);
    assert_null(scene.signals);
    assert_int_equal(scene.expectation_count, 1);
    assert_string_equal(scene.expectations[0].signal, "x");
    assert_string_equal(scene.expectations[0].name, "max");
    assert_int_equal(scene.expectations[0].measure, DEA_MEASURE_MAX);
    assert_close(scene.expectations[0].above, 0.4e-3);
    assert_close(scene.expectations[0].below, 0.46e-3);
    assert_string_equal(scene.expectations[0].file, "good.yaml");
    assert_int_equal(scene.expectations[0].line, 9);
    dea_scene_clear(&scene);
}

static void reads_the_device(void **state) {
    (void)state;
    struct dea_device device;
    struct dea_error error = {0};
    assert_int_equal(dea_device_read("device.yaml", NULL, 0, &device, &error), DEA_OK);
    assert_string_equal(device.name, "device");
    assert_close(device.width, 30e-3);
    assert_close(device.thickness, 33e-6);
    assert_close(device.prestretch[0], 1.2);
    assert_close(device.prestretch[1], 1.2);
    assert_true(device.zones[0].present && device.zones[0].electroded);
    assert_true(device.zones[1].present && !device.zones[1].electroded);
    assert_close(device.zones[0].length, 4e-3);
    assert_close(device.platform_mass, 0.428e-3);
    assert_true(device.has_stops);
    assert_close(device.stops[0], -3e-3);
    assert_close(device.stops[1], 3e-3);
    assert_true(device.stop_stiffness > 0); /* prepared */
    assert_true(device.zones[0].rest_capacitance > 0);
    assert_true(device.membrane_mass && device.slack);
    assert_string_equal(device.material.name, "material");
    assert_int_equal(device.material.elastic.kind, DEA_GENT);
    assert_close(device.material.elastic.mu, 0.365e6);
    assert_close(device.material.elastic.jm, 16.6);
    assert_int_equal(device.material.branch_count, 1);
    assert_int_equal(device.material.branches[0].kind, DEA_BRANCH_FOO);
    assert_close(device.material.branches[0].mu, 29.2e3);
    assert_close(device.material.branches[0].tau, 2e-3);
    assert_true(isinf(device.material.branches[0].jm));
    assert_close(device.material.dielectric.permittivity, 2.5);
    assert_close(device.material.dielectric.breakdown, 100e6);
    assert_true(isinf(device.material.dielectric.conductivity_field));
    assert_close(device.material.density, 1120);
    dea_device_clear(&device);
}

static void reads_every_device_key(void **state) {
    (void)state;
    struct dea_device device;
    read_good_device(
        "name: Full\nsource: a paper\nnotes: [one, two]\n" FILM "material: {" RUBBER ", branches: []}\n"
        "zones:\n"
        "  left: {length: {value: 4 mm, source: drawing}, electrode: {sheet_resistance: 50 kOhm/sq, feed: "
        "narrow_end}}\n"
        "  right: {length: 5 mm, electrode: {resistance: 1 MOhm}}\n"
        "platform: {mass: 0 g, damping: 1 mN s/m, load: -2 mN, stops: [-1 mm, 2 mm], stop_stiffness: 5 N/mm, "
        "stop_loss: 3 s/m}\n"
        "options: {membrane_mass: no, slack: False}\n",
        &device);
    assert_string_equal(device.name, "Full");
    assert_string_equal(device.material.name, "");
    assert_close(device.zones[0].sheet_resistance, 50e3);
    assert_int_equal(device.zones[0].feed, DEA_FEED_NARROW_END);
    assert_close(device.zones[1].electrode_resistance, 1e6);
    assert_close(device.zones[1].length, 5e-3);
    assert_close(device.damping, 1e-3);
    assert_close(device.load, -2e-3);
    assert_close(device.stop_stiffness, 5e3);
    assert_close(device.stop_loss, 3);
    assert_false(device.membrane_mass || device.slack);
    assert_int_equal(device.material.branch_count, 0);
    assert_true(isinf(device.material.dielectric.breakdown));
    dea_device_clear(&device);
}

static void reads_every_law(void **state) {
    (void)state;
    static const struct {
        const char *elastic;
        struct dea_law law;
    } cases[] = {
        {"{law: neo_hookean, mu: 1 MPa}", {.kind = DEA_NEO_HOOKEAN, .mu = 1e6}},
        {"{law: yeoh, c10: 180.7 kPa, c20: -16.7 kPa, c30: 6.6 kPa}",
         {.kind = DEA_YEOH, .yeoh_terms = 3, .yeoh = {180.7e3, -16.7e3, 6.6e3}}},
        {"{law: yeoh, c10: 180.7 kPa}", {.kind = DEA_YEOH, .yeoh_terms = 1, .yeoh = {180.7e3}}},
        {"{law: ogden, terms: [{mu: 0.6 MPa, alpha: 1.3}, {mu: -10 kPa, alpha: -2}]}",
         {.kind = DEA_OGDEN, .ogden_terms = 2, .ogden_mu = {0.6e6, -10e3}, .ogden_alpha = {1.3, -2}}},
        {"{law: arruda_boyce, mu: 15.36 kPa, locking_stretch: 5.99}",
         {.kind = DEA_ARRUDA_BOYCE, .mu = 15360, .locking_stretch = 5.99}},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct dea_device device;
        char text[1024];
        snprintf(text, sizeof text,
                 FILM "zones: {left: {length: 4 mm}}\nmaterial: {elastic: %s, density: 1000, "
                      "dielectric: {permittivity: 3}}\n",
                 cases[i].elastic);
        read_good_device(text, &device);
        const struct dea_law *law = &device.material.elastic, *expected = &cases[i].law;
        assert_int_equal(law->kind, expected->kind);
        assert_close(law->mu, expected->mu);
        assert_close(law->locking_stretch, expected->locking_stretch);
        assert_int_equal(law->yeoh_terms, expected->yeoh_terms);
        assert_int_equal(law->ogden_terms, expected->ogden_terms);
        for (int k = 0; k < 3; k++) {
            assert_close(law->yeoh[k], expected->yeoh[k]);
            assert_close(law->ogden_mu[k], expected->ogden_mu[k]);
            assert_close(law->ogden_alpha[k], expected->ogden_alpha[k]);
        }
        assert_false(device.zones[1].present);
        dea_device_clear(&device);
    }
}

static void reads_a_breakdown_law_and_field_dependent_leakage(void **state) {
    (void)state;
    struct dea_device device;
    read_good_device(FILM
                     "zones: {right: {length: 4 mm}}\nmaterial:\n  elastic: {law: gent, mu: 1 MPa, jm: 20}\n"
                     "  branches: [{kind: network, mu: 26 kPa, tau: 0.6 s}, {kind: foo, mu: 1 kPa, tau: 1 h, jm: 30}]\n"
                     "  density: 1 g/cm^3\n  dielectric:\n    permittivity: 2.76\n    permittivity_slope: -0.28\n"
                     "    breakdown: {coefficient: 51 MV/m, reference_thickness: 1 mm, thickness_exponent: 0.25, "
                     "stretch_exponent: 0.63}\n    conductivity: 1e-12 S/m\n    conductivity_field: 20 V/um\n",
                     &device);
    const struct dea_dielectric *dielectric = &device.material.dielectric;
    assert_close(dielectric->permittivity_slope, -0.28);
    assert_close(dielectric->breakdown, 51e6);
    assert_close(dielectric->breakdown_reference, 1e-3);
    assert_close(dielectric->breakdown_thickness_exponent, 0.25);
    assert_close(dielectric->breakdown_stretch_exponent, 0.63);
    assert_close(dielectric->conductivity, 1e-12);
    assert_close(dielectric->conductivity_field, 20e6);
    assert_close(device.material.density, 1000);
    assert_int_equal(device.material.branches[0].kind, DEA_BRANCH_NETWORK);
    assert_close(device.material.branches[1].tau, 3600);
    assert_close(device.material.branches[1].jm, 30);
    dea_device_clear(&device);
}

static void reads_every_waveform(void **state) {
    (void)state;
    struct dea_scene scene;
    const struct dea_waveform *w;
    write_text("wave.csv", "time [ms], voltage [kV]\n0, 0\n1, 1\n");

    read_good_scene(NATIVE "drive: {left: {waveform: {type: pulse, low: 10 V, high: 3.3 kV, delay: 1 ms, rise: 100 us, "
                           "fall: 200 us, width: 58.9 ms, period: 1 s}}}",
                    &scene);
    w = &scene.sources[0].waveform;
    assert_int_equal(w->kind, DEA_WAVE_PULSE);
    assert_close(w->low, 10);
    assert_close(w->high, 3300);
    assert_close(w->delay, 1e-3);
    assert_close(w->rise, 1e-4);
    assert_close(w->fall, 2e-4);
    assert_close(w->width, 58.9e-3);
    assert_close(w->period, 1);
    dea_scene_clear(&scene);

    read_good_scene(NATIVE "drive: {left: {waveform: {type: pulse, high: 1 kV}}}", &scene);
    assert_close(dea_waveform_value(&scene.sources[0].waveform, 1e6), 1000); /* a step that stays */
    dea_scene_clear(&scene);

    read_good_scene(NATIVE "drive: {left: {waveform: {type: trapezoid, high: 1 kV, rise: 1 ms, flat: 2 ms, fall: 3 ms, "
                           "period: 10 ms}}}",
                    &scene);
    w = &scene.sources[0].waveform;
    assert_int_equal(w->kind, DEA_WAVE_TRAPEZOID);
    assert_true(w->repeat);
    assert_true(fabs(w->gap - 4e-3) < 1e-15);
    assert_true(fabs(dea_waveform_value(w, 12e-3) - 1000) < 1e-9);
    dea_scene_clear(&scene);

    read_good_scene(NATIVE "drive: {left: {waveform: {type: pwl, points: [[0, 0 V], [1 ms, 1 kV], [2 ms, 0]], "
                           "repeat: true}}}",
                    &scene);
    w = &scene.sources[0].waveform;
    assert_int_equal(w->kind, DEA_WAVE_PWL);
    assert_int_equal(w->point_count, 3);
    assert_close(w->times[1], 1e-3);
    assert_close(w->values[1], 1000);
    assert_true(w->repeat);
    dea_scene_clear(&scene);

    read_good_scene(NATIVE "drive: {left: {waveform: {type: sine, offset: 2 kV, amplitude: 1 kV, frequency: 50 Hz, "
                           "delay: 1 ms, phase: 90 deg, decay: 2 1/s}}}",
                    &scene);
    w = &scene.sources[0].waveform;
    assert_int_equal(w->kind, DEA_WAVE_SINE);
    assert_close(w->offset, 2000);
    assert_close(w->amplitude, 1000);
    assert_close(w->frequency, 50);
    assert_true(fabs(w->phase - acos(0)) < 1e-15);
    assert_close(w->decay, 2);
    dea_scene_clear(&scene);

    read_good_scene(NATIVE "drive: {left: {waveform: {type: chirp, offset: 2 kV, amplitude: 100 V, from: 1 Hz, "
                           "to: 1 kHz, duration: 5 s, delay: 1 s}}}",
                    &scene);
    w = &scene.sources[0].waveform;
    assert_int_equal(w->kind, DEA_WAVE_CHIRP);
    assert_close(w->frequency, 1);
    assert_close(w->frequency_end, 1000);
    assert_close(w->duration, 5);
    assert_close(w->delay, 1);
    dea_scene_clear(&scene);

    read_good_scene(NATIVE "drive: {left: {waveform: {type: file, path: wave.csv, repeat: yes}}}", &scene);
    w = &scene.sources[0].waveform;
    assert_int_equal(w->kind, DEA_WAVE_PWL);
    assert_int_equal(w->point_count, 2);
    assert_close(w->values[1], 1000);
    assert_true(w->repeat);
    dea_scene_clear(&scene);
}

static void reads_amplifier_load_and_initial_state(void **state) {
    (void)state;
    struct dea_scene scene;
    read_good_scene(NATIVE
                    "drive:\n  left:\n    waveform: {type: dc, level: 1 kV}\n    amplifier: {slew_rate: 15 V/us, "
                    "current_limit: 1 mA, output_resistance: 2 kOhm}\n"
                    "load: {waveform: {type: sine, amplitude: 1 mN, frequency: 10 Hz}}\n"
                    "initial: {x: 0.1 mm, v: -2 mm/s}\n",
                    &scene);
    assert_true(scene.sources[0].amplified);
    assert_close(scene.sources[0].amplifier.slew_rate, 15e6);
    assert_close(scene.sources[0].amplifier.current_limit, 1e-3);
    assert_true(isinf(scene.sources[0].amplifier.bandwidth));
    assert_close(scene.sources[0].amplifier.output_resistance, 2000);
    assert_true(scene.has_load_waveform);
    assert_close(scene.load.amplitude, 1e-3);
    assert_true(scene.has_initial_x && scene.has_initial_v);
    assert_close(scene.initial_x, 1e-4);
    assert_close(scene.initial_v, -2e-3);
    dea_scene_clear(&scene);

    read_good_scene(NATIVE "drive: {}\ninitial: fresh\nload: {type: dc, level: 1 mN}\n", &scene);
    assert_int_equal(scene.start, DEA_START_FRESH);
    assert_close(scene.load.level, 1e-3);
    assert_string_equal(scene.title, "good"); /* called after its file */
    dea_scene_clear(&scene);
}

static void grounds_electrodes_without_a_source(void **state) {
    (void)state;
    struct dea_scene scene;
    read_good_scene("device: {base: device.yaml, zones: {right: {electrode: {}}}}\ntransient: {stop: 1 s}\n"
                    "drive: {left: {waveform: {type: dc, level: 1 kV}}}\n",
                    &scene);
    assert_true(scene.devices[0].device.zones[1].electroded);
    assert_true(scene.sources[1].present);
    assert_int_equal(scene.sources[1].waveform.kind, DEA_WAVE_DC);
    assert_true(scene.sources[1].waveform.level == 0 && scene.sources[1].resistance == 0);
    dea_scene_clear(&scene);
}

static void reads_several_devices_and_netlist_measures(void **state) {
    (void)state;
    struct dea_scene scene;
    read_good_scene("devices: {DEA: device.yaml, DEB: device.yaml}\ndrive: {netlist: drive.cir}\n"
                    "transient: {accuracy: 1e-5, max_step: 1 ms}\n"
                    "output: {formats: [hdf5], signals: [DEB.left.charge, DEA.x]}\n"
                    "expect:\n  - {measure: tr_left, below: 2 ms}\n"
                    "  - {signal: DEB.left.true_field, measure: t_max, above: 1 ms}\n"
                    "  - {signal: DEA.energy.imbalance, measure: max, below: 1 nJ}\n",
                    &scene);
    assert_int_equal(scene.device_count, 2);
    assert_string_equal(scene.devices[1].name, "DEB");
    assert_string_equal(scene.netlist, "drive.cir");
    assert_false(scene.has_transient); /* .tran of the netlist */
    assert_close(scene.accuracy, 1e-5);
    assert_close(scene.max_step, 1e-3);
    assert_int_equal(scene.formats, DEA_FORMAT_HDF5);
    assert_int_equal(scene.signal_count, 2);
    assert_string_equal(scene.signals[0], "DEB.left.charge");
    assert_int_equal(scene.expectations[0].measure, DEA_MEASURE_NETLIST);
    assert_string_equal(scene.expectations[0].name, "tr_left");
    assert_string_equal(scene.expectations[0].signal, "");
    assert_close(scene.expectations[0].below, 2e-3);
    assert_true(isinf(scene.expectations[0].above));
    assert_int_equal(scene.expectations[1].measure, DEA_MEASURE_T_MAX);
    assert_close(scene.expectations[1].above, 1e-3);
    assert_close(scene.expectations[2].below, 1e-9);
    dea_scene_clear(&scene);
}

static void reads_every_event_policy(void **state) {
    (void)state;
    struct dea_scene scene;
    read_good_scene(NATIVE "drive: {}\nevents: {breakdown: short, slack: ignore, stress2: stop, limit: warn, "
                           "stability: ignore, stop: stop}\n",
                    &scene);
    static const enum dea_policy expected[DEA_EVENT_COUNT] = {DEA_POLICY_SHORT, DEA_POLICY_IGNORE, DEA_POLICY_STOP,
                                                              DEA_POLICY_WARN,  DEA_POLICY_IGNORE, DEA_POLICY_STOP};
    for (int i = 0; i < DEA_EVENT_COUNT; i++)
        assert_int_equal(scene.policies[i], expected[i]);
    dea_scene_clear(&scene);
}

/* D <= 0 at the prestretch is a static limit, not bad input. */
static void accepts_a_prestretch_beyond_the_law(void **state) {
    (void)state;
    struct dea_device device;
    read_good_device("geometry: {width: 30 mm, thickness: 33 um, prestretch: [5, 5]}\nmaterial: material.yaml\n"
                     "zones: {left: {length: 4 mm, electrode: {}}}\n",
                     &device);
    assert_true(dea_prestretch_fails(&device, NULL));
    dea_device_clear(&device);
}

/* Source: physics notes on design C (its C0, k0) and the material table. */
static void reads_the_presets(void **state) {
    (void)state;
    static const struct {
        const char *file;
        double capacitance, stiffness;
        int electrodes, branches;
    } cases[] = {
        {"planar_c_s5", 80.5e-12, 554.07, 2, 2},
        {"planar_c_elastic", 80.5e-12, 554.07, 2, 0},
        {"planar_unidirectional", 80.5e-12, 554.07, 1, 2},
        {"planar_carbon_electrodes", 80.5e-12, 554.07, 2, 2},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct dea_device device;
        struct dea_error error = {0};
        char path[512];
        snprintf(path, sizeof path, "%s/models/%s.yaml", SOURCE_ROOT, cases[i].file);
        if (dea_device_read(path, NULL, 0, &device, &error) != DEA_OK)
            fail_msg("%s", error.text);
        assert_true(fabs(device.zones[0].rest_capacitance - cases[i].capacitance) < 0.05e-12);
        assert_true(fabs(device.stiffness - cases[i].stiffness) < 0.005);
        assert_int_equal(device.zones[0].electroded + device.zones[1].electroded, cases[i].electrodes);
        assert_int_equal(device.material.branch_count, cases[i].branches);
        dea_device_clear(&device);
    }
}

static void reads_the_preset_materials(void **state) {
    (void)state;
    static const struct {
        const char *file, *name;
        enum dea_law_kind law;
        int branches;
    } cases[] = {
        {"sylgard186", "Sylgard 186", DEA_GENT, 2},
        {"sylgard186_elastic", "Sylgard 186, elastic", DEA_GENT, 0},
        {"vhb4910", "VHB 4910", DEA_ARRUDA_BOYCE, 3},
        {"elastosil2030", "Elastosil 2030", DEA_YEOH, 0},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        char text[1024];
        struct dea_device device;
        snprintf(text, sizeof text, FILM "zones: {left: {length: 4 mm}}\nmaterial: %s/models/materials/%s.yaml\n",
                 SOURCE_ROOT, cases[i].file);
        read_good_device(text, &device);
        assert_string_equal(device.material.name, cases[i].name);
        assert_int_equal(device.material.elastic.kind, cases[i].law);
        assert_int_equal(device.material.branch_count, cases[i].branches);
        dea_device_clear(&device);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(reads_the_example),
        cmocka_unit_test(reads_the_device),
        cmocka_unit_test(reads_every_device_key),
        cmocka_unit_test(reads_every_law),
        cmocka_unit_test(reads_a_breakdown_law_and_field_dependent_leakage),
        cmocka_unit_test(reads_every_waveform),
        cmocka_unit_test(reads_amplifier_load_and_initial_state),
        cmocka_unit_test(grounds_electrodes_without_a_source),
        cmocka_unit_test(reads_several_devices_and_netlist_measures),
        cmocka_unit_test(reads_every_event_policy),
        cmocka_unit_test(accepts_a_prestretch_beyond_the_law),
        cmocka_unit_test(reads_the_presets),
        cmocka_unit_test(reads_the_preset_materials),
    };
    return cmocka_run_group_tests(tests, enter_scene_folder, leave_scene_folder);
}
