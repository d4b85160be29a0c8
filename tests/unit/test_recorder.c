/* The recorder where the disk says no: folders, stale files, size limits, a full disk. */
#include "output_support.h"

#include <hdf5.h>
#include <sched.h>
#include <sys/mount.h>
#include <sys/wait.h>

#define ALL_FORMATS (DEA_FORMAT_CSV | DEA_FORMAT_RAW | DEA_FORMAT_HDF5)

static const struct dea_signal signals[] = {{"x", "m"}, {"left.voltage", "V"}};

static enum dea_status open_recorder(const char *folder, unsigned formats, struct dea_recorder **recorder,
                                     struct dea_error *error) {
    *error = (struct dea_error){0};
    return dea_recorder_open(folder, formats, "test", signals, 2, recorder, error);
}

static void folders_are_made(void **state) {
    (void)state;
    char folder[SCRATCH_LENGTH];
    make_scratch(folder);
    const char *deep = path_in(folder, "a/b//c/");
    struct dea_recorder *recorder;
    struct dea_error error;
    assert_int_equal(open_recorder(deep, ALL_FORMATS, &recorder, &error), DEA_OK);
    assert_int_equal(dea_recorder_close(recorder, &error), DEA_OK);
    assert_true(exists(path_in(folder, "a/b/c/result.csv")) && exists(path_in(folder, "a/b/c/result.raw")) &&
                exists(path_in(folder, "a/b/c/result.h5")));
    remove_scratch(folder);
}

static void impossible_folders_are_named(void **state) {
    (void)state;
    char folder[SCRATCH_LENGTH], expected[256];
    make_scratch(folder);
    write_whole(path_in(folder, "file"), "");
    struct dea_recorder *recorder;
    struct dea_error error;

    assert_int_equal(open_recorder(path_in(folder, "file/out"), ALL_FORMATS, &recorder, &error), DEA_ERR_INPUT);
    snprintf(expected, sizeof expected, "%s/file/out: the result folder cannot be made: Not a directory", folder);
    assert_string_equal(error.text, expected);

    assert_int_equal(open_recorder(path_in(folder, "file"), ALL_FORMATS, &recorder, &error), DEA_ERR_INPUT);
    snprintf(expected, sizeof expected, "%s/file: the result folder cannot be made: Not a directory", folder);
    assert_string_equal(error.text, expected);

    assert_int_equal(open_recorder("", ALL_FORMATS, &recorder, &error), DEA_ERR_INPUT);
    assert_string_equal(error.text, "a result folder needs a name; . is this one");
    assert_null(recorder);
    remove_scratch(folder);
}

/* Root may write anywhere, so the attempt is made as nobody. */
static void folder_without_permission_is_refused(void **state) {
    (void)state;
    char folder[SCRATCH_LENGTH];
    make_scratch(folder);
    assert_int_equal(chmod(folder, 0555), 0);
    pid_t child = fork();
    assert_true(child >= 0);
    if (child == 0) {
        if (geteuid() == 0 && setresuid(65534, 65534, 65534) != 0)
            _exit(2);
        struct dea_recorder *recorder;
        struct dea_error error;
        enum dea_status status = open_recorder(folder, DEA_FORMAT_CSV, &recorder, &error);
        char expected[256];
        snprintf(expected, sizeof expected, "%s/result.csv: cannot be written: Permission denied", folder);
        _exit(status == DEA_ERR_INPUT && strcmp(error.text, expected) == 0 ? 0 : 1);
    }
    int status;
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_int_equal(status, 0);
    assert_int_equal(chmod(folder, 0755), 0);
    remove_scratch(folder);
}

static void earlier_results_are_removed(void **state) {
    (void)state;
    char folder[SCRATCH_LENGTH];
    make_scratch(folder);
    static const char *const stale[] = {"result.raw", "result.h5", "result.png", "summary.json"};
    for (size_t i = 0; i < 4; i++)
        write_whole(path_in(folder, stale[i]), "old");
    write_whole(path_in(folder, "notes.txt"), "mine");
    struct dea_recorder *recorder;
    struct dea_error error;
    assert_int_equal(open_recorder(folder, DEA_FORMAT_CSV, &recorder, &error), DEA_OK);
    assert_int_equal(dea_recorder_close(recorder, &error), DEA_OK);
    for (size_t i = 0; i < 4; i++)
        assert_false(exists(path_in(folder, stale[i])));
    assert_true(exists(path_in(folder, "notes.txt")) && exists(path_in(folder, "result.csv")));
    remove_scratch(folder);
}

/* ---- files that stop growing ---- */

static long count_csv_rows(const char *folder) {
    char *text = read_whole(path_in(folder, "result.csv"), NULL);
    assert_non_null(text);
    long lines = 0;
    for (const char *c = text; (c = strchr(c, '\n')) != NULL; c++)
        lines++;
    assert_true(text[strlen(text) - 1] == '\n'); /* no torn row */
    free(text);
    return lines - 1;
}

static long count_raw_rows(const char *folder) {
    size_t length = 0;
    char *raw = read_whole(path_in(folder, "result.raw"), &length);
    assert_non_null(raw);
    long points = strtol(strstr(raw, "No. Points: ") + 12, NULL, 10);
    assert_int_equal(length - (size_t)(strstr(raw, "Binary:\n") + 8 - raw), (size_t)points * 3 * sizeof(double));
    free(raw);
    return points;
}

static long count_hdf5_rows(const char *folder) {
    hid_t file = H5Fopen(path_in(folder, "result.h5"), H5F_ACC_RDONLY, H5P_DEFAULT);
    assert_true(file >= 0);
    static const char *const names[] = {"time", "x", "left.voltage"};
    hsize_t rows[3];
    for (int i = 0; i < 3; i++) {
        hid_t dataset = H5Dopen2(file, names[i], H5P_DEFAULT), space = H5Dget_space(dataset);
        assert_int_equal(H5Sget_simple_extent_dims(space, &rows[i], NULL), 1);
        double *values = calloc(rows[i] + 1, sizeof *values);
        assert_true(H5Dread(dataset, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values) >= 0);
        for (hsize_t k = 0; k < rows[i]; k++)
            assert_true(values[k] == (double)k + i);
        free(values);
        H5Sclose(space);
        H5Dclose(dataset);
    }
    assert_true(rows[0] == rows[1] && rows[1] == rows[2]);
    H5Fclose(file);
    return (long)rows[0];
}

/* Appends until refused (at most `most` rows); the message must tell the truth about the rows of the file. */
static void fill_until_refused(const char *folder, unsigned format, const char *name, const char *why,
                               long (*count_rows)(const char *), long most) {
    struct dea_recorder *recorder;
    struct dea_error error, closing = {0};
    assert_int_equal(open_recorder(folder, format, &recorder, &error), DEA_OK);
    enum dea_status status = DEA_OK;
    for (long i = 0; i < most && status == DEA_OK; i++)
        status = dea_recorder_append(recorder, (double)i, (double[]){(double)i + 1, (double)i + 2}, &error);
    if (status == DEA_OK)
        status = dea_recorder_flush(recorder, &error);
    assert_int_equal(status, DEA_ERR_OUTPUT);
    /* Refused for good, with the same words, also on closing. */
    assert_int_equal(dea_recorder_append(recorder, 1e9, (double[]){0, 0}, &closing), DEA_ERR_OUTPUT);
    assert_string_equal(closing.text, error.text);
    assert_int_equal(dea_recorder_close(recorder, &closing), DEA_ERR_OUTPUT);
    assert_string_equal(closing.text, error.text);
    long rows = count_rows(folder);
    char expected[512];
    snprintf(expected, sizeof expected, "%s/%s is incomplete: %s; its first %ld rows are good", folder, name, why,
             rows);
    assert_string_equal(error.text, expected);
    assert_true(rows > 1000);
}

static const struct {
    unsigned format;
    const char *name;
    long (*count_rows)(const char *);
} formats[] = {{DEA_FORMAT_CSV, "result.csv", count_csv_rows},
               {DEA_FORMAT_RAW, "result.raw", count_raw_rows},
               {DEA_FORMAT_HDF5, "result.h5", count_hdf5_rows}};

static void size_limit_leaves_whole_rows(void **state) {
    (void)state;
    for (size_t i = 0; i < 3; i++) {
        char folder[SCRATCH_LENGTH];
        make_scratch(folder);
        struct rlimit before = limit_files(1000003); /* not a whole number of rows */
        fill_until_refused(folder, formats[i].format, formats[i].name, "File too large", formats[i].count_rows,
                           1000000);
        release_files(before);
        remove_scratch(folder);
    }
}

/* A file system of 1 MB in a private mount namespace; needs root. */
static bool mount_small_disk(const char *folder) {
    return unshare(CLONE_NEWNS) == 0 && mount("none", "/", NULL, MS_REC | MS_PRIVATE, NULL) == 0 &&
           mount("small", folder, "tmpfs", 0, "size=1M") == 0;
}

static void full_disk_leaves_whole_rows(void **state) {
    (void)state;
    char folder[SCRATCH_LENGTH];
    make_scratch(folder);
    bool mounted = mount_small_disk(folder);
    if (mounted) {
        for (size_t i = 0; i < 3; i++)
            fill_until_refused(folder, formats[i].format, formats[i].name, "No space left on device",
                               formats[i].count_rows, 1000000);
        assert_int_equal(umount(folder), 0);
    }
    remove_scratch(folder);
    if (!mounted)
        skip();
}

static void every_incomplete_file_is_listed(void **state) {
    (void)state;
    char folder[SCRATCH_LENGTH], expected[512];
    make_scratch(folder);
    struct dea_recorder *recorder;
    struct dea_error error;
    assert_int_equal(open_recorder(folder, DEA_FORMAT_CSV | DEA_FORMAT_RAW, &recorder, &error), DEA_OK);
    for (int i = 0; i < 50; i++)
        assert_int_equal(dea_recorder_append(recorder, i, (double[]){1.0 / 3.0, -2.0 / 3.0}, &error), DEA_OK);
    struct rlimit before = limit_files(512);
    enum dea_status status = dea_recorder_close(recorder, &error);
    release_files(before);
    assert_int_equal(status, DEA_ERR_OUTPUT);
    long csv = count_csv_rows(folder), raw = count_raw_rows(folder);
    snprintf(expected, sizeof expected,
             "%s/result.csv is incomplete: File too large; its first %ld rows are good; "
             "%s/result.raw is incomplete: File too large; its first %ld rows are good",
             folder, csv, folder, raw);
    assert_string_equal(error.text, expected);
    assert_true(csv > 0 && csv < 50 && raw > 0 && raw < 50);
    remove_scratch(folder);
}

/* The file that fails first does not hide that another is full as well. */
static void failing_append_tells_of_all_files(void **state) {
    (void)state;
    char folder[SCRATCH_LENGTH], expected[512];
    make_scratch(folder);
    struct dea_recorder *recorder;
    struct dea_error error, closing;
    assert_int_equal(open_recorder(folder, DEA_FORMAT_CSV | DEA_FORMAT_RAW, &recorder, &error), DEA_OK);
    struct rlimit before = limit_files(2000);
    enum dea_status status = DEA_OK;
    for (int i = 0; i < 100000 && status == DEA_OK; i++)
        status = dea_recorder_append(recorder, i, (double[]){1.0 / 3.0, -2.0 / 3.0}, &error);
    enum dea_status closed = dea_recorder_close(recorder, &closing);
    release_files(before);
    assert_int_equal(status, DEA_ERR_OUTPUT);
    assert_int_equal(closed, DEA_ERR_OUTPUT);
    snprintf(expected, sizeof expected,
             "%s/result.csv is incomplete: File too large; its first %ld rows are good; "
             "%s/result.raw is incomplete: File too large; its first %ld rows are good",
             folder, count_csv_rows(folder), folder, count_raw_rows(folder));
    assert_string_equal(error.text, expected);
    assert_string_equal(closing.text, expected);
    remove_scratch(folder);
}

static void closing_nothing_is_fine(void **state) {
    (void)state;
    assert_int_equal(dea_recorder_close(NULL, NULL), DEA_OK);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(folders_are_made),
        cmocka_unit_test(impossible_folders_are_named),
        cmocka_unit_test(folder_without_permission_is_refused),
        cmocka_unit_test(earlier_results_are_removed),
        cmocka_unit_test(size_limit_leaves_whole_rows),
        cmocka_unit_test(full_disk_leaves_whole_rows),
        cmocka_unit_test(every_incomplete_file_is_listed),
        cmocka_unit_test(failing_append_tells_of_all_files),
        cmocka_unit_test(closing_nothing_is_fine),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
