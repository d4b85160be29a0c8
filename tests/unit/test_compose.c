/* Base files, files named by files, and overrides. */
#include "deasim/scene.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "scene_files.h"

static enum dea_status read_device_text(const char *text, const struct dea_override *overrides, size_t count,
                                        struct dea_device *device, struct dea_error *error) {
    write_text("derived.yaml", text);
    return dea_device_read("derived.yaml", overrides, count, device, error);
}

static void read_good(const char *text, struct dea_device *device) {
    struct dea_error error = {0};
    if (read_device_text(text, NULL, 0, device, &error) != DEA_OK)
        fail_msg("%s", error.text);
}

static void base_keys_hold_until_overridden(void **state) {
    (void)state;
    struct dea_device device;
    read_good("base: device.yaml\ngeometry: {width: 20 mm}\nzones: {left: {length: 5 mm}}\n", &device);
    assert_true(fabs(device.width - 20e-3) < 1e-15);
    assert_true(fabs(device.thickness - 33e-6) < 1e-18);
    assert_true(fabs(device.zones[0].length - 5e-3) < 1e-15);
    assert_true(device.zones[0].electroded);
    assert_true(device.zones[1].present);
    assert_string_equal(device.name, "derived");
    dea_device_clear(&device);
}

static void null_removes_a_key_of_the_base(void **state) {
    (void)state;
    struct dea_device device;
    read_good("base: device.yaml\nzones: {right: null}\nplatform: {stops: ~}\n", &device);
    assert_false(device.zones[1].present);
    assert_false(device.has_stops);
    assert_true(device.platform_mass > 0);
    dea_device_clear(&device);
}

static void another_law_replaces_the_whole_mapping(void **state) {
    (void)state;
    struct dea_device device;
    /* law.yaml is material.yaml with another law; jm of the Gent law does not leak into it */
    read_good("base: device.yaml\nmaterial: law.yaml\n", &device);
    assert_int_equal(device.material.elastic.kind, DEA_NEO_HOOKEAN);
    assert_true(device.material.elastic.mu == 1e6);
    assert_int_equal(device.material.branch_count, 1);
    dea_device_clear(&device);
    /* the same law is changed key by key */
    read_good("base: device.yaml\nmaterial: {elastic: {mu: 0.5 MPa}, branches: []}\n", &device);
    assert_int_equal(device.material.elastic.kind, DEA_GENT);
    assert_true(device.material.elastic.mu == 0.5e6);
    assert_true(device.material.elastic.jm == 16.6);
    assert_int_equal(device.material.branch_count, 0);
    dea_device_clear(&device);
    /* a mapping with a base of its own does not mix with the inherited one */
    read_good("base: device.yaml\nmaterial: {base: material.yaml, density: 1000}\n", &device);
    assert_true(device.material.density == 1000);
    dea_device_clear(&device);
}

static void paths_are_relative_to_the_file_that_names_them(void **state) {
    (void)state;
    struct dea_device device;
    assert_int_equal(mkdir("below", 0700), 0);
    write_text("below/inner.yaml", "base: ../device.yaml\ngeometry: {thickness: 20 um}\n");
    read_good("base: below/inner.yaml\n", &device);
    assert_true(fabs(device.thickness - 20e-6) < 1e-18);
    dea_device_clear(&device);

    struct dea_error error = {0};
    write_text("below/inner.yaml", "base: device.yaml\n");
    assert_int_equal(read_device_text("base: below/inner.yaml\n", NULL, 0, &device, &error), DEA_ERR_INPUT);
    assert_non_null(strstr(error.text, "below/inner.yaml:1:7: base: cannot read below/device.yaml: No such file"));
}

static void says_the_chain_of_a_circle(void **state) {
    (void)state;
    struct dea_device device;
    struct dea_error error = {0};
    assert_int_equal(dea_device_read("a.yaml", NULL, 0, &device, &error), DEA_ERR_INPUT);
    assert_non_null(strstr(error.text, "b.yaml:1:7: base: circular reference: a.yaml -> b.yaml -> a.yaml\n"));
    /* another spelling of the same file, and a symbolic link, do not hide it */
    write_text("c.yaml", "base: ./link.yaml\n");
    assert_int_equal(symlink("c.yaml", "link.yaml"), 0);
    assert_int_equal(dea_device_read("./c.yaml", NULL, 0, &device, &error), DEA_ERR_INPUT);
    assert_non_null(strstr(error.text, "c.yaml:1:7: base: circular reference: ./c.yaml -> ././link.yaml\n"));
}

static void limits_chains(void **state) {
    (void)state;
    struct dea_device device;
    struct dea_error error = {0};
    for (int i = 0; i < 40; i++) {
        char name[32], text[64];
        snprintf(name, sizeof name, "chain%d.yaml", i);
        snprintf(text, sizeof text, "base: chain%d.yaml\n", i + 1);
        write_text(name, text);
    }
    assert_int_equal(dea_device_read("chain0.yaml", NULL, 0, &device, &error), DEA_ERR_INPUT);
    assert_non_null(strstr(error.text, "chain31.yaml:1:7: base: more than 32 files name each other: chain0.yaml -> "));
}

static void overrides_apply_in_order(void **state) {
    (void)state;
    struct dea_scene scene;
    struct dea_error error = {0};
    const struct dea_override overrides[] = {
        {"transient.stop", "1 s"},
        {"transient.stop", "2 s"},
        {"device.geometry.width", "20 mm"},
        {"device.material.branches.0.tau", "5 ms"},
        {"drive.left.waveform", "{type: dc, level: 1 kV}"},
        {"events.limit", "ignore"},
        {"initial", "fresh"},
        {"device.platform.stops", "null"},
        {"expect", "[]"},
    };
    if (dea_scene_read("scene.yaml", overrides, sizeof overrides / sizeof overrides[0], &scene, &error) != DEA_OK)
        fail_msg("%s", error.text);
    assert_true(scene.stop == 2);
    assert_true(scene.devices[0].device.width == 20e-3);
    assert_true(scene.devices[0].device.material.branches[0].tau == 5e-3);
    assert_true(scene.sources[0].waveform.level == 1000);
    assert_true(scene.sources[0].resistance == 1e6);
    assert_int_equal(scene.policies[DEA_EVENT_LIMIT], DEA_POLICY_IGNORE);
    assert_int_equal(scene.start, DEA_START_FRESH);
    assert_false(scene.devices[0].device.has_stops);
    assert_int_equal(scene.expectation_count, 0);
    dea_scene_clear(&scene);
}

/* Taking away what a scene does not have changes nothing, on the way there either; a key that no scene has is a
 * mistake. */
static void null_removes_what_is_not_there(void **state) {
    (void)state;
    struct dea_scene scene;
    struct dea_error error = {0};
    const struct dea_override overrides[] = {
        {"output.signals", "null"},
        {"initial.x", "null"},
        {"load", "~"},
        {"device.zones.left.notes", "null"},
        {"drive.right.resistance", "null"},
        {"transient.max_step", "null"},
    };
    if (dea_scene_read("scene.yaml", overrides, sizeof overrides / sizeof overrides[0], &scene, &error) != DEA_OK)
        fail_msg("%s", error.text);
    assert_null(scene.signals);
    assert_false(scene.has_initial_x);
    assert_true(scene.stop == 0.4 && scene.sample == 0.1e-3);
    dea_scene_clear(&scene);

    const struct dea_override mistaken[] = {{"output.singals", "null"}};
    assert_int_equal(dea_scene_read("scene.yaml", mistaken, 1, &scene, &error), DEA_ERR_INPUT);
    assert_non_null(strstr(error.text, "unknown key 'singals'; did you mean 'signals'?"));
    dea_scene_clear(&scene);
    const struct dea_override twice[] = {{"transient.stop", "null"}, {"transient.stop", "null"}};
    assert_int_equal(dea_scene_read("scene.yaml", twice, 2, &scene, &error), DEA_ERR_INPUT);
    assert_non_null(strstr(error.text, "the key 'stop' is missing"));
    dea_scene_clear(&scene);
}

static void an_override_may_name_a_file(void **state) {
    (void)state;
    struct dea_scene scene;
    struct dea_error error = {0};
    const struct dea_override overrides[] = {{"device.material", "law.yaml"}, {"device.material.density", "1000"}};
    if (dea_scene_read("scene.yaml", overrides, 2, &scene, &error) != DEA_OK)
        fail_msg("%s", error.text);
    assert_int_equal(scene.devices[0].device.material.elastic.kind, DEA_NEO_HOOKEAN);
    assert_true(scene.devices[0].device.material.density == 1000);
    dea_scene_clear(&scene);
}

static void messages_name_the_override(void **state) {
    (void)state;
    static const struct {
        struct dea_override override;
        const char *message;
    } cases[] = {
        {{"transient.stop", "-1 s"},
         "--set transient.stop=-1 s: transient.stop: -1 s is not positive; allowed: 1 ns .. 1e+08 s"},
        {{"transient.stopp", "1 s"},
         "--set transient.stopp=1 s: transient: unknown key 'stopp'; did you mean 'stop'? allowed: stop, accuracy, "
         "max_step"},
        {{"tranzient.stop", "1 s"},
         "--set tranzient.stop=1 s: unknown key 'tranzient'; did you mean 'transient'? allowed: title, device, "
         "devices, "
         "drive, load, transient, initial, events, output, expect"},
        {{"title.x", "1"}, "--set title.x=1: 'title' is 'Test', not a mapping with a key 'x'"},
        {{"device.geometry.width", "20"},
         "--set device.geometry.width=20: geometry.width: 20 m is outside 1 um .. 1 m; is the unit missing?"},
        {{"device.material.branches.7.tau", "1 s"},
         "--set device.material.branches.7.tau=1 s: '7' is not an entry of the list, which has 1"},
        {{"a..b", "1"}, "--set a..b=1: the key has an empty part"},
        {{"", "1"}, "--set =1: the key has an empty part"},
        {{"device", "nowhere.yaml"},
         "--set device=nowhere.yaml: device: cannot read nowhere.yaml: No such file or directory"},
        {{"device.base", "device.yaml"}, NULL}, /* a base given late fills what the device lacks: nothing */
        {{"transient.stop", "[1"},
         "--set transient.stop=[1: not valid YAML: while parsing a flow sequence from line 1, did not find expected "
         "',' or ']'"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct dea_scene scene;
        struct dea_error error = {0};
        enum dea_status status = dea_scene_read("scene.yaml", &cases[i].override, 1, &scene, &error);
        dea_scene_clear(&scene);
        assert_int_equal(status, cases[i].message == NULL ? DEA_OK : DEA_ERR_INPUT);
        if (cases[i].message != NULL)
            assert_string_equal(error.text, cases[i].message);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(base_keys_hold_until_overridden),
        cmocka_unit_test(null_removes_a_key_of_the_base),
        cmocka_unit_test(null_removes_what_is_not_there),
        cmocka_unit_test(another_law_replaces_the_whole_mapping),
        cmocka_unit_test(paths_are_relative_to_the_file_that_names_them),
        cmocka_unit_test(says_the_chain_of_a_circle),
        cmocka_unit_test(limits_chains),
        cmocka_unit_test(overrides_apply_in_order),
        cmocka_unit_test(an_override_may_name_a_file),
        cmocka_unit_test(messages_name_the_override),
    };
    return cmocka_run_group_tests(tests, enter_scene_folder, leave_scene_folder);
}
