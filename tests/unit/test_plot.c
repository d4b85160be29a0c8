/* Pictures of runs with the real gnuplot, and with programs in its place that fail. */
#include "output_support.h"

#include <sys/wait.h>

static const char run_csv[] =
    "time [s],x [m],left.voltage [V],left.port_voltage [V],left.true_field [V/m],energy.in [J]\n"
    "0,0,0,0,0,0\n0.001,1e-4,nan,3300,5e7,1e-5\n0.002,4e-4,3300,3300,9e7,3e-5\n";
static const char run_summary[] =
    "{\"title\": \"It's `touch pwned` $(touch pwned)\\nquit\", \"status\": \"stopped\", \"reason\": \"breakdown\","
    " \"limits\": {\"left.true_field\": 1e8}, \"events\": [{\"t\": 0.0015, \"type\": \"breakdown\", \"zone\": "
    "\"left\"}]}";

static void make_run(char folder[SCRATCH_LENGTH], const char *csv, const char *summary) {
    make_scratch(folder);
    if (csv != NULL)
        write_whole(path_in(folder, "result.csv"), csv);
    if (summary != NULL)
        write_whole(path_in(folder, "summary.json"), summary);
}

/* Width and height from the PNG's header (IHDR). */
static void assert_png(const char *path, unsigned width, unsigned height) {
    size_t length = 0;
    char *png = read_whole(path, &length);
    assert_non_null(png);
    assert_true(length > 1000);
    const unsigned char *bytes = (const unsigned char *)png;
    assert_memory_equal(bytes, "\x89PNG\r\n\x1a\n", 8);
    assert_int_equal(bytes[16] << 24 | bytes[17] << 16 | bytes[18] << 8 | bytes[19], width);
    assert_int_equal(bytes[20] << 24 | bytes[21] << 16 | bytes[22] << 8 | bytes[23], height);
    free(png);
}

static void picture_is_drawn(void **state) {
    (void)state;
    char folder[SCRATCH_LENGTH], expected[256];
    make_run(folder, run_csv, run_summary);
    char *path;
    struct dea_error error = {0};
    if (dea_plot_run(folder, &path, &error) != DEA_OK)
        fail_msg("%s", error.text);
    snprintf(expected, sizeof expected, "%s/result.png", folder);
    assert_string_equal(path, expected);
    /* Title and foot 104, four frames of 232, gaps of 17, three of them with a line of a key. */
    assert_png(path, 1000, 104 + 4 * 232 + 4 * 17 + 3 * 17);
    assert_false(exists(path_in(folder, "result.png.part")));
    free(path);
    remove_scratch(folder);
}

static void odd_results_are_drawn_too(void **state) {
    (void)state;
    static const char *const results[] = {
        "time [s],x [m]\n0,1e-3\n",                                  /* one row */
        "time [s],x [m]\n0,nan\n1,nan\n",                            /* no number */
        "time [s],x [m]\n0,5\n1,5\n",                                /* one value */
        "time [s],x [m]\n0,1e99\n1,-1e99\n",                         /* beyond all prefixes */
        "time [s],x [m]\n0,1e-300\n1,2e-300\n",                      /* below them */
        "time [s],x [m]\n3,1\n2,2\n",                                /* time running back */
        "time [s],\"x'; system('touch pwned'); ' [m]\"\n0,1\n1,2\n", /* a name that wants to be a command */
        "time [s],x [END_OF_DATA']\n0,1\n1,2\n",                     /* a unit likewise */
    };
    for (size_t i = 0; i < sizeof results / sizeof results[0]; i++) {
        char folder[SCRATCH_LENGTH];
        make_run(folder, results[i],
                 i % 2 == 0 ? "{\"status\": 3, \"limits\": [1], \"events\": {\"t\": 1}}" : "no JSON");
        char *path;
        struct dea_error error = {0};
        if (dea_plot_run(folder, &path, &error) != DEA_OK)
            fail_msg("%s: %s", results[i], error.text);
        assert_true(exists(path));
        free(path);
        remove_scratch(folder);
    }
    assert_false(exists("pwned"));
}

static void missing_results_are_named(void **state) {
    (void)state;
    char folder[SCRATCH_LENGTH], expected[256];
    make_run(folder, NULL, NULL);
    char *path;
    struct dea_error error;
    assert_int_equal(dea_plot_run(folder, &path, &error), DEA_ERR_INPUT);
    snprintf(expected, sizeof expected, "%s/result.csv: there is no result to draw: No such file or directory", folder);
    assert_string_equal(error.text, expected);
    assert_null(path);
    write_whole(path_in(folder, "result.csv"), "time [s]\n0\n");
    assert_int_equal(dea_plot_run(folder, &path, &error), DEA_ERR_INPUT);
    snprintf(expected, sizeof expected, "%s/result.csv: there is no signal to draw, only time", folder);
    assert_string_equal(error.text, expected);
    remove_scratch(folder);
}

/* Runs with another PATH, in a child so that this process keeps its own; the message must be the expected one. */
static void assert_failure_with_path(const char *folder, const char *search_path, const char *expected) {
    pid_t child = fork();
    assert_true(child >= 0);
    if (child == 0) {
        char *path;
        struct dea_error error = {0};
        setenv("PATH", search_path, 1);
        enum dea_status status = dea_plot_run(folder, &path, &error);
        bool good = status == DEA_ERR_OUTPUT && path == NULL && strcmp(error.text, expected) == 0;
        if (!good)
            fprintf(stderr, "got: %s\n", error.text);
        _exit(good ? 0 : 1);
    }
    int outcome;
    assert_int_equal(waitpid(child, &outcome, 0), child);
    assert_int_equal(outcome, 0);
}

static void absent_gnuplot_is_said(void **state) {
    (void)state;
    char folder[SCRATCH_LENGTH];
    make_run(folder, run_csv, run_summary);
    assert_failure_with_path(folder, folder,
                             "gnuplot is not installed (or not on PATH); on Debian: apt install gnuplot-nox");
    assert_false(exists(path_in(folder, "result.png")) || exists(path_in(folder, "result.png.part")));
    remove_scratch(folder);
}

/* A shell script in place of gnuplot. */
static void put_gnuplot(const char *folder, const char *text) {
    write_whole(path_in(folder, "gnuplot"), text);
    assert_int_equal(chmod(path_in(folder, "gnuplot"), 0755), 0);
}

static void failing_gnuplot_keeps_the_old_picture(void **state) {
    (void)state;
    char folder[SCRATCH_LENGTH], expected[256];
    make_run(folder, run_csv, run_summary);
    write_whole(path_in(folder, "result.png"), "old");
    put_gnuplot(folder, "#!/bin/sh\necho junk\nprintf 'set terminal\\n    ^\\nunknown terminal\\n\\n' >&2\nexit 3\n");
    assert_failure_with_path(folder, folder, "gnuplot failed: unknown terminal");

    /* Half a PNG, and no complaint: a full disk. */
    put_gnuplot(folder, "#!/bin/sh\nprintf '\\211PNG\\r\\n\\032\\n and not much more'\n");
    snprintf(expected, sizeof expected, "%s/result.png: gnuplot wrote no whole picture (is the disk full?)", folder);
    assert_failure_with_path(folder, folder, expected);
    char *old = read_whole(path_in(folder, "result.png"), NULL);
    assert_string_equal(old, "old");
    assert_false(exists(path_in(folder, "result.png.part")));
    free(old);
    remove_scratch(folder);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(picture_is_drawn),
        cmocka_unit_test(odd_results_are_drawn_too),
        cmocka_unit_test(missing_results_are_named),
        cmocka_unit_test(absent_gnuplot_is_said),
        cmocka_unit_test(failing_gnuplot_keeps_the_old_picture),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
