/* summary.json: the contract's keys, exact numbers, any text, and the file itself. */
#include "summary_support.h"

#include <cJSON.h>

static cJSON *summarise(const struct sample_run *run) {
    char *text = dea_summary_json(&run->scene, &run->result);
    assert_non_null(text);
    cJSON *root = cJSON_Parse(text);
    assert_non_null(root);
    free(text);
    return root;
}

/* "signals.x.max" style look-up; names with dots are given as separate arguments. */
static const cJSON *get(const cJSON *object, const char *first, const char *second, const char *third) {
    const cJSON *found = cJSON_GetObjectItemCaseSensitive(object, first);
    if (second != NULL)
        found = cJSON_GetObjectItemCaseSensitive(found, second);
    if (third != NULL)
        found = cJSON_GetObjectItemCaseSensitive(found, third);
    if (found == NULL)
        fail_msg("no %s %s %s", first, second != NULL ? second : "", third != NULL ? third : "");
    return found;
}

static double number(const cJSON *object, const char *first, const char *second, const char *third) {
    const cJSON *found = get(object, first, second, third);
    assert_true(cJSON_IsNumber(found));
    return found->valuedouble;
}

static void contract_keys_hold_the_result(void **state) {
    (void)state;
    struct sample_run run;
    fill_sample(&run);
    cJSON *root = summarise(&run);
    assert_string_equal(get(root, "scene", NULL, NULL)->valuestring, "scenes/pulse.yaml");
    assert_string_equal(get(root, "title", NULL, NULL)->valuestring, "Half-bridge");
    assert_string_equal(get(root, "status", NULL, NULL)->valuestring, "stopped");
    assert_string_equal(get(root, "reason", NULL, NULL)->valuestring, "breakdown in left");
    assert_true(number(root, "t_end", NULL, NULL) == 0.4);
    assert_true(number(root, "signals", "x", "min") == -1.23e-5);
    assert_true(number(root, "signals", "x", "max") == 4.2512e-4);
    assert_true(number(root, "signals", "x", "t_max") == 0.0123);
    assert_true(number(root, "signals", "x", "t_min") == 0.2);
    assert_true(number(root, "signals", "left.voltage", "final") == 1.0 / 3.0); /* to the last bit */
    assert_true(cJSON_IsNull(get(root, "signals", "left.true_field", "final")));
    assert_true(number(root, "measures", "tr_left", NULL) == 1.5e-3);
    assert_true(cJSON_IsNull(get(root, "measures", "tf_left", NULL)));
    static const char *const energy[] = {"in", "stored", "dissipated", "imbalance", "exchanged", "branch", "damping"};
    static const double energies[] = {1.25e-4, 1e-4, 2.5e-5, 1.5e-6, 3e-4, 2e-5, 5e-6};
    for (size_t i = 0; i < sizeof energies / sizeof energies[0]; i++)
        assert_true(number(root, "energy", energy[i], NULL) == energies[i]);
    assert_true(number(root, "coupling", "error", NULL) == 3.2e-5);
    assert_true(number(root, "coupling", "redone", NULL) == 0);
    static const char *const stats[] = {
        "circuit_points", "circuit_rejected", "circuit_iterations", "plant_steps", "residuals", "jacobians", "wall_s"};
    static const double counts[] = {1234, 5, 4321, 678, 2000, 40, 1.25};
    for (size_t i = 0; i < sizeof counts / sizeof counts[0]; i++)
        assert_true(number(root, "stats", stats[i], NULL) == counts[i]);
    assert_string_equal(get(root, "stats", "mode", NULL)->valuestring, "cosim");
    cJSON_Delete(root);
    dea_result_clear(&run.result);
}

static void events_name_time_type_and_zone(void **state) {
    (void)state;
    struct sample_run run;
    fill_sample(&run);
    cJSON *root = summarise(&run);
    const cJSON *events = get(root, "events", NULL, NULL);
    assert_int_equal(cJSON_GetArraySize(events), 2);
    const cJSON *first = cJSON_GetArrayItem(events, 0), *second = cJSON_GetArrayItem(events, 1);
    assert_true(number(first, "t", NULL, NULL) == 0.0123);
    assert_string_equal(get(first, "type", NULL, NULL)->valuestring, "breakdown");
    assert_string_equal(get(first, "zone", NULL, NULL)->valuestring, "left");
    assert_string_equal(get(second, "type", NULL, NULL)->valuestring, "stop");
    assert_string_equal(get(second, "zone", NULL, NULL)->valuestring, "platform");
    assert_true(cJSON_IsTrue(get(second, "cleared", NULL, NULL)));
    cJSON_Delete(root);
    dea_result_clear(&run.result);
}

static void limits_are_those_of_driven_zones(void **state) {
    (void)state;
    struct sample_run run;
    fill_sample(&run);
    cJSON *root = summarise(&run);
    assert_int_equal(cJSON_GetArraySize(get(root, "limits", NULL, NULL)), 1);
    assert_true(number(root, "limits", "left.true_field", NULL) == 1e8);
    cJSON_Delete(root);

    run.scene.device_count = 2;
    run.devices[1].device.material.dielectric.breakdown_stretch_exponent = 1.0; /* no constant to draw */
    root = summarise(&run);
    assert_int_equal(cJSON_GetArraySize(get(root, "limits", NULL, NULL)), 1);
    assert_true(number(root, "limits", "DEA.left.true_field", NULL) == 1e8);
    cJSON_Delete(root);
    dea_result_clear(&run.result);
}

static void outcomes_have_three_words(void **state) {
    (void)state;
    struct sample_run run;
    fill_sample(&run);
    static const struct {
        enum dea_status status;
        const char *word;
    } cases[] = {
        {DEA_OK, "done"}, {DEA_STOPPED, "stopped"}, {DEA_ERR_SOLVER, "failed"}, {DEA_ERR_INTERRUPTED, "failed"}};
    for (size_t i = 0; i < 4; i++) {
        run.result.status = cases[i].status;
        cJSON *root = summarise(&run);
        assert_string_equal(get(root, "status", NULL, NULL)->valuestring, cases[i].word);
        cJSON_Delete(root);
    }
    dea_result_clear(&run.result);
}

static void any_bytes_make_valid_json(void **state) {
    (void)state;
    struct sample_run run;
    fill_sample(&run);
    strcpy(run.path, "\xe4\"quoted\"\n\\\xc3\xa4\xe2\x82\xac\xed\xa0\x80\xf0\x9f\x98\x80\xff\xc3");
    cJSON *root = summarise(&run);
    assert_string_equal(get(root, "scene", NULL, NULL)->valuestring,
                        "?\"quoted\"\n\\\xc3\xa4\xe2\x82\xac???\xf0\x9f\x98\x80??");
    cJSON_Delete(root);
    dea_result_clear(&run.result);
}

static void empty_result_has_every_key(void **state) {
    (void)state;
    struct dea_scene scene = {0};
    struct dea_result result = {0};
    char *text = dea_summary_json(&scene, &result);
    cJSON *root = cJSON_Parse(text);
    static const char *const keys[] = {"scene",  "status", "t_end",    "signals", "measures",
                                       "events", "energy", "coupling", "stats",   "sensitivity"};
    for (size_t i = 0; i < sizeof keys / sizeof keys[0]; i++)
        get(root, keys[i], NULL, NULL);
    cJSON_Delete(root);
    free(text);
}

static void file_is_replaced_or_left_alone(void **state) {
    (void)state;
    struct sample_run run;
    fill_sample(&run);
    char folder[SCRATCH_LENGTH], expected[256];
    make_scratch(folder);
    struct dea_error error = {0};
    assert_int_equal(dea_summary_write(folder, &run.scene, &run.result, &error), DEA_OK);
    char *first = read_whole(path_in(folder, "summary.json"), NULL), *text = dea_summary_json(&run.scene, &run.result);
    assert_memory_equal(first, text, strlen(text));
    assert_false(exists(path_in(folder, "summary.json.part")));

    /* A disk that takes no more: the old file stays, nothing half-written beside it. */
    run.result.t_end = 0.5;
    struct rlimit before = limit_files(100);
    enum dea_status status = dea_summary_write(folder, &run.scene, &run.result, &error);
    release_files(before);
    assert_int_equal(status, DEA_ERR_OUTPUT);
    snprintf(expected, sizeof expected, "%s/summary.json: cannot be written: File too large", folder);
    assert_string_equal(error.text, expected);
    char *second = read_whole(path_in(folder, "summary.json"), NULL);
    assert_string_equal(first, second);
    assert_false(exists(path_in(folder, "summary.json.part")));

    assert_int_equal(dea_summary_write("no/such/folder", &run.scene, &run.result, &error), DEA_ERR_OUTPUT);
    assert_string_equal(error.text, "no/such/folder/summary.json: cannot be written: No such file or directory");
    free(first);
    free(second);
    free(text);
    remove_scratch(folder);
    dea_result_clear(&run.result);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(contract_keys_hold_the_result),    cmocka_unit_test(events_name_time_type_and_zone),
        cmocka_unit_test(limits_are_those_of_driven_zones), cmocka_unit_test(outcomes_have_three_words),
        cmocka_unit_test(any_bytes_make_valid_json),        cmocka_unit_test(empty_result_has_every_key),
        cmocka_unit_test(file_is_replaced_or_left_alone),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
