/* Files that appear only when they are whole, and nothing replaced that is no file. */
#include "deasim/new_file.h"
#include "output_support.h"

static void write_new(const char *path, const char *text) {
    struct dea_new_file made;
    struct dea_error error;
    assert_int_equal(dea_new_file_open(path, &made, &error), DEA_OK);
    assert_int_equal(fputs(text, made.file) >= 0, 1);
    assert_int_equal(dea_new_file_finish(&made, DEA_OK, &error), DEA_OK);
}

static void assert_holds(const char *path, const char *text) {
    char *found = read_whole(path, NULL);
    assert_non_null(found);
    assert_string_equal(found, text);
    free(found);
}

static void appears_whole(void **state) {
    (void)state;
    char folder[SCRATCH_LENGTH];
    make_scratch(folder);
    const char *path = path_in(folder, "f");
    struct dea_new_file made;
    struct dea_error error;
    write_whole(path_in(folder, "f.part"), "of a program that was killed");
    assert_int_equal(dea_new_file_open(path, &made, &error), DEA_OK);
    fputs("first", made.file);
    assert_false(exists(path));
    assert_int_equal(dea_new_file_finish(&made, DEA_OK, &error), DEA_OK);
    assert_holds(path, "first");
    assert_false(exists(path_in(folder, "f.part")));

    /* given up: the old one stays, the failure is passed on */
    assert_int_equal(dea_new_file_open(path, &made, &error), DEA_OK);
    fputs("second", made.file);
    assert_int_equal(dea_new_file_finish(&made, DEA_ERR_SOLVER, &error), DEA_ERR_SOLVER);
    assert_holds(path, "first");
    assert_false(exists(path_in(folder, "f.part")));
    assert_int_equal(dea_new_file_try(path, &error), DEA_OK);
    assert_holds(path, "first");
    assert_false(exists(path_in(folder, "f.part")));
    remove_scratch(folder);
}

static void links_are_followed(void **state) {
    (void)state;
    char folder[SCRATCH_LENGTH];
    make_scratch(folder);
    write_whole(path_in(folder, "target"), "old");
    assert_int_equal(symlink("target", path_in(folder, "link")), 0);
    write_new(path_in(folder, "link"), "new");
    assert_holds(path_in(folder, "target"), "new");
    struct stat found;
    assert_int_equal(lstat(path_in(folder, "link"), &found), 0);
    assert_true(S_ISLNK(found.st_mode));
    /* the mode is that of any new file */
    mode_t mask = umask(027);
    write_new(path_in(folder, "private"), "");
    umask(mask);
    assert_int_equal(stat(path_in(folder, "private"), &found), 0);
    assert_int_equal(found.st_mode & 0777, 0640);
    remove_scratch(folder);
}

static void assert_refused(const char *path, const char *says) {
    struct dea_new_file made;
    struct dea_error error;
    char expected[600];
    snprintf(expected, sizeof expected, "%s: %s", path, says);
    assert_int_equal(dea_new_file_open(path, &made, &error), DEA_ERR_INPUT);
    assert_string_equal(error.text, expected);
    assert_null(made.file);
    assert_int_equal(dea_new_file_try(path, &error), DEA_ERR_INPUT);
}

static void only_files_are_replaced(void **state) {
    (void)state;
    char folder[SCRATCH_LENGTH];
    make_scratch(folder);
    struct dea_error error;
    assert_int_equal(mkdir(path_in(folder, "d"), 0777), 0);
    assert_int_equal(mkfifo(path_in(folder, "p"), 0666), 0);
    assert_int_equal(symlink("/dev/null", path_in(folder, "n")), 0);
    assert_refused(path_in(folder, "d"), "there is a directory, which is not replaced by a file");
    assert_refused(path_in(folder, "p"), "there is a pipe, which is not replaced by a file");
    assert_refused(path_in(folder, "n"), "there is a device, which is not replaced by a file");
    assert_refused("/dev/null", "there is a device, which is not replaced by a file");
    assert_int_equal(dea_new_file_check("/dev/null", &error), DEA_ERR_INPUT);
    assert_int_equal(dea_new_file_check(path_in(folder, "none"), &error), DEA_OK);
    assert_int_equal(dea_new_file_check(path_in(folder, "n"), &error), DEA_OK); /* the link itself can go */
    /* nor what stands where the part would be */
    assert_int_equal(mkdir(path_in(folder, "f.part"), 0777), 0);
    assert_int_equal(dea_new_file_try(path_in(folder, "f"), &error), DEA_ERR_INPUT);
    assert_non_null(strstr(error.text, "f.part: there is a directory"));
    assert_refused(path_in(folder, "none/f"), "cannot be written: No such file or directory");
    assert_int_equal(dea_new_file_try("", &error), DEA_ERR_INPUT);
    assert_string_equal(error.text, "a file without a name cannot be written");
    struct stat found;
    assert_int_equal(stat("/dev/null", &found), 0);
    assert_true(S_ISCHR(found.st_mode));
    remove_scratch(folder);
}

static void protected_file_stays(void **state) {
    (void)state;
    char folder[SCRATCH_LENGTH];
    make_scratch(folder);
    const char *path = path_in(folder, "f");
    write_whole(path, "mine");
    assert_int_equal(chmod(path, 0444), 0);
    if (geteuid() != 0) /* nothing is protected from root */
        assert_refused(path, "cannot be written: Permission denied");
    assert_holds(path, "mine");
    remove_scratch(folder);
}

static void full_disk_leaves_the_old_one(void **state) {
    (void)state;
    char folder[SCRATCH_LENGTH], expected[600];
    make_scratch(folder);
    const char *path = path_in(folder, "f");
    write_new(path, "old");
    struct dea_new_file made;
    struct dea_error error;
    assert_int_equal(dea_new_file_open(path, &made, &error), DEA_OK);
    struct rlimit before = limit_files(100);
    for (int i = 0; i < 10000; i++)
        fputs("more than fits\n", made.file);
    enum dea_status status = dea_new_file_finish(&made, DEA_OK, &error);
    release_files(before);
    assert_int_equal(status, DEA_ERR_OUTPUT);
    snprintf(expected, sizeof expected, "%s: cannot be written: File too large", path);
    assert_string_equal(error.text, expected);
    assert_holds(path, "old");
    assert_false(exists(path_in(folder, "f.part")));
    remove_scratch(folder);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(appears_whole),
        cmocka_unit_test(links_are_followed),
        cmocka_unit_test(only_files_are_replaced),
        cmocka_unit_test(protected_file_stays),
        cmocka_unit_test(full_disk_leaves_the_old_one),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
