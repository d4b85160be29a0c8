/* result.h5 through the HDF5 library itself. */
#include "output_support.h"

#include <hdf5.h>
#include <signal.h>
#include <sys/wait.h>

static const struct dea_signal signals[] = {{"x", "m"}, {"left.voltage", "V"}, {"a/b", "1"}};

static void append_rows(struct dea_recorder *recorder, int from, int to) {
    for (int i = from; i < to; i++)
        assert_int_equal(dea_recorder_append(recorder, i * 1e-3, (double[]){i, i * 0.5, -i}, NULL), DEA_OK);
}

/* Reads a whole column (malloc'd) and checks its unit. */
static double *read_column(hid_t file, const char *name, const char *unit, hsize_t *rows) {
    hid_t dataset = H5Dopen2(file, name, H5P_DEFAULT);
    assert_true(dataset >= 0);
    hid_t space = H5Dget_space(dataset);
    assert_int_equal(H5Sget_simple_extent_dims(space, rows, NULL), 1);
    double *values = calloc(*rows + 1, sizeof *values);
    assert_non_null(values);
    assert_true(H5Dread(dataset, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values) >= 0);
    hid_t attribute = H5Aopen(dataset, "unit", H5P_DEFAULT);
    hid_t type = H5Aget_type(attribute);
    char text[32] = "";
    assert_true(H5Tget_size(type) < sizeof text && H5Aread(attribute, type, text) >= 0);
    assert_string_equal(text, unit);
    H5Tclose(type);
    H5Aclose(attribute);
    H5Sclose(space);
    H5Dclose(dataset);
    return values;
}

static void check_file(const char *path, int rows) {
    hid_t file = H5Fopen(path, H5F_ACC_RDONLY, H5P_DEFAULT);
    assert_true(file >= 0);
    static const struct {
        const char *name, *unit;
        double slope;
    } columns[] = {{"time", "s", 1e-3}, {"x", "m", 1}, {"left.voltage", "V", 0.5}, {"a_b", "1", -1}};
    for (size_t i = 0; i < sizeof columns / sizeof columns[0]; i++) {
        hsize_t count;
        double *values = read_column(file, columns[i].name, columns[i].unit, &count);
        assert_int_equal(count, rows);
        for (int k = 0; k < rows; k++)
            assert_true(values[k] == k * columns[i].slope);
        free(values);
    }
    assert_true(H5Fclose(file) >= 0);
}

/* Looks at a file that is still open for writing as another program would: through a copy. */
static void check_snapshot(const char *folder, int rows) {
    char command[256];
    snprintf(command, sizeof command, "cp '%s/result.h5' '%s/copy.h5'", folder, folder);
    assert_int_equal(system(command), 0);
    check_file(path_in(folder, "copy.h5"), rows);
}

static void every_row_comes_back(void **state) {
    (void)state;
    char folder[SCRATCH_LENGTH];
    make_scratch(folder);
    struct dea_recorder *recorder;
    assert_int_equal(dea_recorder_open(folder, DEA_FORMAT_HDF5, "title", signals, 3, &recorder, NULL), DEA_OK);
    /* Flushes that leave chunks half full, then chunks crossed in one go. */
    append_rows(recorder, 0, 10);
    assert_int_equal(dea_recorder_flush(recorder, NULL), DEA_OK);
    check_snapshot(folder, 10);
    append_rows(recorder, 10, 5000);
    assert_int_equal(dea_recorder_flush(recorder, NULL), DEA_OK);
    append_rows(recorder, 5000, 20001);
    assert_int_equal(dea_recorder_close(recorder, NULL), DEA_OK);
    check_file(path_in(folder, "result.h5"), 20001);
    remove_scratch(folder);
}

/* A run that is killed: the rows of the last flush are there, the later ones are not. */
static void killed_run_is_readable(void **state) {
    (void)state;
    char folder[SCRATCH_LENGTH];
    make_scratch(folder);
    pid_t child = fork();
    assert_true(child >= 0);
    if (child == 0) {
        struct dea_recorder *recorder;
        if (dea_recorder_open(folder, DEA_FORMAT_HDF5, "title", signals, 3, &recorder, NULL) != DEA_OK)
            _exit(1);
        append_rows(recorder, 0, 6000);
        if (dea_recorder_flush(recorder, NULL) != DEA_OK)
            _exit(1);
        append_rows(recorder, 6000, 6100);
        kill(getpid(), SIGKILL);
    }
    int status;
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_true(WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL);
    check_file(path_in(folder, "result.h5"), 6000);
    remove_scratch(folder);
}

static void two_signals_of_one_name_are_refused(void **state) {
    (void)state;
    char folder[SCRATCH_LENGTH], expected[256];
    make_scratch(folder);
    static const struct dea_signal twins[] = {{"x", "m"}, {"x", "m"}};
    struct dea_recorder *recorder;
    struct dea_error error = {0};
    assert_int_equal(dea_recorder_open(folder, DEA_FORMAT_HDF5, "", twins, 2, &recorder, &error), DEA_ERR_OUTPUT);
    snprintf(expected, sizeof expected,
             "%s/result.h5: cannot be written: refused by the HDF5 library (two signals of one name?)", folder);
    assert_string_equal(error.text, expected);
    assert_null(recorder);
    remove_scratch(folder);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_row_comes_back),
        cmocka_unit_test(killed_run_is_readable),
        cmocka_unit_test(two_signals_of_one_name_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
