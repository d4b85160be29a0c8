/* Reading result.csv for a picture: thinning keeps peaks, mistakes are named. */
#include "output/plot_internal.h"
#include "output_support.h"

#include <math.h>

static enum dea_status read_csv(const char *folder, const char *text, struct dea_table *table,
                                struct dea_error *error) {
    write_whole(path_in(folder, "result.csv"), text);
    *error = (struct dea_error){0};
    enum dea_status status = dea_table_open(folder, table, error);
    static const size_t columns[] = {1, 2};
    return status == DEA_OK ? dea_table_read(table, columns, 2, error) : status;
}

static void short_files_are_kept_row_by_row(void **state) {
    (void)state;
    char folder[SCRATCH_LENGTH];
    make_scratch(folder);
    struct dea_table table;
    struct dea_error error;
    assert_int_equal(read_csv(folder,
                              "time [s],x [m],\"v(a,\"\"b\"\") [V]\",n\r\n0,1,-5,0\r\n0.5,nan,7,0\r\n1,3,1e200,0\r\n0.",
                              &table, &error),
                     DEA_OK);
    assert_int_equal(table.column_count, 4);
    assert_string_equal(table.columns[0].name, "time");
    assert_string_equal(table.columns[2].name, "v(a,\"b\")");
    assert_string_equal(table.columns[2].unit, "V");
    assert_string_equal(table.columns[3].unit, "1");
    /* The torn last row is not there. */
    assert_int_equal(table.rows, 3);
    assert_int_equal(table.bucket_count, 3);
    assert_true(table.t_first == 0 && table.t_last == 1);
    const struct dea_curve *x = &table.curves[0], *v = &table.curves[1];
    assert_true(x->buckets[0].low == 1 && x->buckets[0].high == 1);
    assert_true(x->buckets[1].low > x->buckets[1].high); /* nothing there */
    assert_true(x->any && x->first == 1 && x->last == 3 && x->t_last == 1);
    assert_true(v->buckets[1].high == 7 && v->last == 7 && v->t_last == 0.5); /* 1e200 counts as missing */
    dea_table_clear(&table);
    remove_scratch(folder);
}

/* A hundred thousand rows with two single-row peaks. */
static void peaks_survive_thinning(void **state) {
    (void)state;
    char folder[SCRATCH_LENGTH];
    make_scratch(folder);
    enum { ROWS = 100000, UP = 31237, DOWN = 77778 };
    FILE *file = fopen(path_in(folder, "result.csv"), "w");
    assert_non_null(file);
    fputs("time [s],x [m],v [m/s]\n", file);
    for (int i = 0; i < ROWS; i++)
        fprintf(file, "%d,%g,%d\n", i, i == UP ? 1e3 : i == DOWN ? -1e3 : sin(i), i);
    fclose(file);
    struct dea_table table;
    struct dea_error error;
    assert_int_equal(dea_table_open(folder, &table, &error), DEA_OK);
    static const size_t columns[] = {1, 2};
    assert_int_equal(dea_table_read(&table, columns, 2, &error), DEA_OK);
    assert_int_equal(table.rows, ROWS);
    assert_int_equal(table.stride, 64);
    assert_int_equal(table.bucket_count, (ROWS + 63) / 64);
    for (size_t k = 0; k < table.bucket_count; k++) {
        const struct dea_bucket *x = &table.curves[0].buckets[k], *v = &table.curves[1].buckets[k];
        assert_true(x->high == (k == UP / 64 ? 1e3 : x->high) && x->low == (k == DOWN / 64 ? -1e3 : x->low));
        assert_true(k == UP / 64 ? x->t_high == UP : x->high <= 1);
        assert_true(k == DOWN / 64 ? x->t_low == DOWN : x->low >= -1);
        double last = fmin(64.0 * (double)k + 63, ROWS - 1);
        assert_true(v->low == 64.0 * (double)k && v->high == last && v->t_low == v->low && v->t_high == v->high);
    }
    dea_table_clear(&table);
    remove_scratch(folder);
}

static void mistakes_are_named(void **state) {
    (void)state;
    char folder[SCRATCH_LENGTH];
    make_scratch(folder);
    static const struct {
        const char *text, *message;
    } cases[] = {
        {"", ": the file is empty"},
        {"time [s],x [m],v [m/s]", ": the file is empty"},
        {"t,x [m],v [m/s]\n", ":1: the first column must be time"},
        {"time [s],x [m],v [m/s]\n", ": the result holds no rows"},
        {"time [s],x [m],v [m/s]\n0,1,2\nabc,1,2\n", ":3: the time is not a number"},
        {"time [s],x [m],v [m/s]\ninf,1,2\n", ":2: the time is not a number"},
        {"time [s],x [m],v [m/s]\n0,1,2\n1,2\n", ":3: the row has 2 columns, the header 3"},
        {"time [s],x [m],v [m/s]\n0\n", ":2: the row has 1 columns, the header 3"},
        {"time [s],x [m],v [m/s]\n0,1,\n", ":2: v is not a number"},
        {"time [s],x [m],v [m/s]\n0,1;5,2\n", ":2: x is not a number"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct dea_table table;
        struct dea_error error;
        char expected[256];
        assert_int_equal(read_csv(folder, cases[i].text, &table, &error), DEA_ERR_INPUT);
        snprintf(expected, sizeof expected, "%s/result.csv%s", folder, cases[i].message);
        assert_string_equal(error.text, expected);
        dea_table_clear(&table);
    }
    remove_scratch(folder);
}

static void endless_line_is_refused(void **state) {
    (void)state;
    char folder[SCRATCH_LENGTH], expected[256];
    make_scratch(folder);
    char *text = malloc(3000001);
    assert_non_null(text);
    memset(text, '1', 3000000);
    text[3000000] = '\0';
    struct dea_table table;
    struct dea_error error;
    assert_int_equal(read_csv(folder, text, &table, &error), DEA_ERR_INPUT);
    snprintf(expected, sizeof expected, "%s/result.csv:1: a row longer than 1 MB", folder);
    assert_string_equal(error.text, expected);
    dea_table_clear(&table);
    free(text);
    remove_scratch(folder);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(short_files_are_kept_row_by_row),
        cmocka_unit_test(peaks_survive_thinning),
        cmocka_unit_test(mistakes_are_named),
        cmocka_unit_test(endless_line_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
