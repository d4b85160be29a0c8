/* The summary a person reads, letter by letter. */
#include "summary_support.h"

static char *print_summary(const struct sample_run *run) {
    char *text = NULL;
    size_t length = 0;
    FILE *file = open_memstream(&text, &length);
    assert_non_null(file);
    dea_summary_print(&run->scene, &run->result, file);
    fclose(file);
    return text;
}

static void everything_is_on_one_page(void **state) {
    (void)state;
    struct sample_run run;
    fill_sample(&run);
    char *text = print_summary(&run);
    assert_string_equal(text, "Half-bridge: stopped at 400 ms (cosim, 1.25 s of computing)\n"
                              "  breakdown in left\n"
                              "\n"
                              "  signal                min        max     final   max at\n"
                              "  x                -12.3 um   425.1 um    3.1 um  12.3 ms\n"
                              "  left.voltage          0 V     3.3 kV  333.3 mV     1 ms\n"
                              "  left.true_field    0 V/um  99.6 V/um         -  12.3 ms\n"
                              "\n"
                              "  measure  value\n"
                              "  tr_left  0.0015\n"
                              "  tf_left  failed\n"
                              "\n"
                              "  events    2\n"
                              "         12.3 ms  left breakdown\n"
                              "           20 ms  platform stop over\n"
                              "\n"
                              "  energy    in              125 uJ  (electrical 120 uJ, load 5 uJ)\n"
                              "            stored          100 uJ\n"
                              "            dissipated       25 uJ  (branches 20 uJ, damping 5 uJ)\n"
                              "            imbalance      1.5e-06  of 300 uJ exchanged\n"
                              "  coupling  error          3.2e-05\n"
                              "  circuit   1234 points, 5 rejected\n"
                              "  device    678 steps, 2000 residuals, 40 Jacobians, 6 restarts\n");
    free(text);
    dea_result_clear(&run.result);
}

static void rounding_dust_is_shown_as_zero(void **state) {
    (void)state;
    struct sample_run run;
    fill_sample(&run);
    run.result.stats[1] = (struct dea_signal_stats){.min = -7e-8, .max = 3300, .final = -4e-6};
    char *text = print_summary(&run);
    assert_non_null(strstr(text, "  left.voltage          0 V     3.3 kV   -4 uV      0 s\n"));
    free(text);
    dea_result_clear(&run.result);
}

static void loosened_tolerances_are_told(void **state) {
    (void)state;
    struct sample_run run;
    fill_sample(&run);
    run.result.relaxed = 2;
    char *text = print_summary(&run);
    assert_non_null(strstr(text, "3.2e-05  (circuit tolerances loosened: accuracy not as asked)\n"));
    free(text);
    dea_result_clear(&run.result);
}

static void sensitive_motions_are_told(void **state) {
    (void)state;
    struct sample_run run;
    fill_sample(&run);
    run.result.sensitivity = 3.9;
    char *text = print_summary(&run);
    assert_null(strstr(text, "errors"));
    free(text);
    run.result.sensitivity = 123.4;
    text = print_summary(&run);
    assert_non_null(strstr(text, "\n  errors    grow 123 times with the motion (accuracy may not be as asked)\n"));
    free(text);
    dea_result_clear(&run.result);
}

static void native_run_has_no_coupling(void **state) {
    (void)state;
    struct sample_run run;
    fill_sample(&run);
    run.result.stats_run.circuit_points = 0;
    run.result.status = DEA_OK;
    run.result.reason[0] = '\0';
    run.result.event_count = 0;
    run.title[0] = '\0';
    char *text = print_summary(&run);
    assert_null(strstr(text, "coupling"));
    assert_null(strstr(text, "circuit"));
    assert_non_null(strstr(text, "imbalance"));
    assert_non_null(strstr(text, "\n  events    none\n"));
    assert_ptr_equal(strstr(text, "scenes/pulse.yaml: done at 400 ms"), text);
    free(text);
    dea_result_clear(&run.result);
}

static void long_event_lists_are_cut(void **state) {
    (void)state;
    struct sample_run run;
    fill_sample(&run);
    free(run.result.events);
    run.result.events = calloc(12, sizeof *run.result.events);
    assert_non_null(run.result.events);
    for (int i = 0; i < 12; i++)
        run.result.events[i] = (struct dea_event){.time = i, .kind = DEA_EVENT_SLACK, .device = i % 2, .zone = 1};
    run.result.event_count = 12;
    run.result.event_dropped = 30;
    run.scene.device_count = 2;
    char *text = print_summary(&run);
    assert_non_null(strstr(text, "\n  events    42, the first 10:\n             0 s  DEA.right slack\n"
                                 "             1 s  DEB.right slack\n"));
    assert_non_null(strstr(text, "  9 s  DEB.right slack\n"));
    assert_null(strstr(text, "  10 s  "));
    free(text);
    dea_result_clear(&run.result);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(everything_is_on_one_page),    cmocka_unit_test(rounding_dust_is_shown_as_zero),
        cmocka_unit_test(loosened_tolerances_are_told), cmocka_unit_test(native_run_has_no_coupling),
        cmocka_unit_test(long_event_lists_are_cut),     cmocka_unit_test(sensitive_motions_are_told),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
