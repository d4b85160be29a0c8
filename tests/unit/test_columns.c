/* Two-column files: units, names, row checks. Odd looks and damaged files are tested with the waveforms, which use the
 * same reader. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

#include "deasim/columns.h"

static const struct dea_column_wish wishes[2] = {{"time", true, {"s", NULL}}, {"stress or strain", false, {"Pa", "1"}}};

static char path[] = "test_columns_XXXXXX";

static void write_file(const char *text) {
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    assert_true(fputs(text, file) >= 0);
    assert_int_equal(fclose(file), 0);
}

static enum dea_status refuse_large(void *context, const struct dea_columns *columns, size_t i,
                                    struct dea_error *error) {
    const double *limit = context;
    return columns->values[1][i] > *limit ? dea_fail(error, DEA_ERR_INPUT, "%g is too large", columns->values[1][i])
                                          : DEA_OK;
}

static void units_choose_what_a_column_is(void **state) {
    (void)state;
    struct dea_columns columns;
    write_file("# a remark\ntime [ms], pull [MPa]\n1,2\n3,4\n");
    assert_int_equal(dea_columns_read(path, wishes, NULL, NULL, &columns, NULL), DEA_OK);
    assert_int_equal(columns.count, 2);
    assert_true(columns.values[0][1] == 3e-3 && columns.values[1][1] == 4e6);
    assert_int_equal(columns.unit_index[1], 0);
    assert_string_equal(columns.names[1], "pull");
    dea_columns_clear(&columns);
    write_file("time [s],strain [1]\n1,0.5\n");
    assert_int_equal(dea_columns_read(path, wishes, NULL, NULL, &columns, NULL), DEA_OK);
    assert_int_equal(columns.unit_index[1], 1);
    assert_true(columns.values[1][0] == 0.5);
    dea_columns_clear(&columns);
}

static void refuse(const char *text, const char *message) {
    struct dea_columns columns;
    struct dea_error error;
    char expected[256];
    double limit = 10.0;
    write_file(text);
    assert_int_equal(dea_columns_read(path, wishes, refuse_large, &limit, &columns, &error), DEA_ERR_INPUT);
    snprintf(expected, sizeof expected, "%s%s", path, message);
    assert_string_equal(error.text, expected);
    assert_null(columns.values[0]);
}

static void refusals_name_the_line(void **state) {
    (void)state;
    refuse("", ": empty; a header \"time [unit], stress or strain [unit]\" is needed");
    refuse("when [s],strain [1]\n1,1\n", ":1: the first column is 'when'; it must be \"time [unit]\"");
    refuse("stretch [1],stress [Pa]\n1,1\n", ":1: the first column is 'stretch'; it must be \"time [unit]\"");
    refuse("time [1],strain [1]\n1,1\n", ":1: column 'time': unknown unit '1'; allowed: ns, us, ms, s, min, h");
    refuse("time [s],strain [1]\n1\n", ":2: 1 cell; two are needed, time and stress or strain, with a comma between");
    refuse("time [s],strain [1]\n1,\n", ":2: the stress or strain is missing");
    refuse("time [s],strain [1]\n1,2\n2,11\n", ":3: 11 is too large");
}

int main(void) {
    int file = mkstemp(path);
    if (file < 0)
        return 1;
    close(file);
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(units_choose_what_a_column_is),
        cmocka_unit_test(refusals_name_the_line),
    };
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    unlink(path);
    return failed;
}
