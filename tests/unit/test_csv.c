/* result.csv: header and rows. */
#include "output_support.h"

#include <math.h>

static void header_and_rows_are_exact(void **state) {
    (void)state;
    char folder[SCRATCH_LENGTH];
    make_scratch(folder);
    static const struct dea_signal signals[] = {{"x", "m"}, {"left.voltage", "V"}, {"left.stretch", "1"}};
    struct dea_recorder *recorder;
    struct dea_error error = {0};
    assert_int_equal(dea_recorder_open(folder, DEA_FORMAT_CSV, "ignored", signals, 3, &recorder, &error), DEA_OK);
    assert_int_equal(dea_recorder_append(recorder, 0.0, (double[]){0.0, 3300.0, 1.2}, &error), DEA_OK);
    assert_int_equal(dea_recorder_append(recorder, 1e-4, (double[]){-4.2e-4, 1.0 / 3.0, NAN}, &error), DEA_OK);
    assert_int_equal(dea_recorder_close(recorder, &error), DEA_OK);

    char *text = read_whole(path_in(folder, "result.csv"), NULL);
    assert_string_equal(text, "time [s],x [m],left.voltage [V],left.stretch [1]\n"
                              "0,0,3300,1.2\n"
                              "0.0001,-0.00042,0.333333333333,nan\n");
    assert_false(exists(path_in(folder, "result.raw")));
    free(text);
    remove_scratch(folder);
}

static void awkward_names_are_quoted(void **state) {
    (void)state;
    char folder[SCRATCH_LENGTH];
    make_scratch(folder);
    static const struct dea_signal signals[] = {{"v(a,b)", "V"}, {"say \"x\"\n", "1"}};
    struct dea_recorder *recorder;
    assert_int_equal(dea_recorder_open(folder, DEA_FORMAT_CSV, NULL, signals, 2, &recorder, NULL), DEA_OK);
    assert_int_equal(dea_recorder_close(recorder, NULL), DEA_OK);
    char *text = read_whole(path_in(folder, "result.csv"), NULL);
    assert_string_equal(text, "time [s],\"v(a,b) [V]\",\"say \"\"x\"\"  [1]\"\n");
    free(text);
    remove_scratch(folder);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(header_and_rows_are_exact),
        cmocka_unit_test(awkward_names_are_quoted),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
