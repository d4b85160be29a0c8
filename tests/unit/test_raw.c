/* result.raw, judged by the ngspice program: load, print, measure, wrdata. */
#include "output_support.h"

#include <math.h>

#define ROWS 1001

static const struct dea_signal signals[] = {
    {"x", "m"}, {"left.voltage", "V"}, {"DEB.left.current", "A"}, {"left.true field", "V/m"}};

static void values_at(int row, double values[4]) {
    double t = row * 1e-5;
    values[0] = 4.25e-4 * sin(300 * t);
    values[1] = 3300 * t / 0.01;
    values[2] = -1e-6 * row;
    values[3] = 1e8 / 3.0;
}

static void record(const char *folder, const char *title) {
    struct dea_recorder *recorder;
    struct dea_error error = {0};
    assert_int_equal(dea_recorder_open(folder, DEA_FORMAT_RAW, title, signals, 4, &recorder, &error), DEA_OK);
    for (int i = 0; i < ROWS; i++) {
        double values[4];
        values_at(i, values);
        assert_int_equal(dea_recorder_append(recorder, i * 1e-5, values, &error), DEA_OK);
    }
    assert_int_equal(dea_recorder_close(recorder, &error), DEA_OK);
}

/* Runs ngspice in the folder on a control script and returns what it printed. */
static char *run_ngspice(const char *folder, const char *commands) {
    char deck[4096], command[256];
    snprintf(deck, sizeof deck, "* read a result\n.control\nset numdgt=15\nload result.raw\n%squit\n.endc\n.end\n",
             commands);
    write_whole(path_in(folder, "read.sp"), deck);
    snprintf(command, sizeof command, "cd '%s' && ngspice -b -n read.sp >printed.txt 2>&1", folder);
    assert_int_equal(system(command), 0);
    char *printed = read_whole(path_in(folder, "printed.txt"), NULL);
    assert_non_null(printed);
    return printed;
}

/* The number behind "name = " in ngspice's output. */
static double printed_value(const char *printed, const char *name) {
    const char *line = printed;
    size_t length = strlen(name);
    while (line != NULL && strncmp(line, name, length) != 0) {
        line = strchr(line, '\n');
        line = line != NULL ? line + 1 : NULL;
    }
    if (line == NULL)
        fail_msg("ngspice printed no %s:\n%s", name, printed);
    line += length + strspn(line + length, " =");
    return strtod(line, NULL);
}

static void assert_close(double value, double expected) {
    if (!(fabs(value - expected) <= 1e-12 * fabs(expected)))
        fail_msg("%.17g is not %.17g", value, expected);
}

static void ngspice_prints_and_measures_the_numbers(void **state) {
    (void)state;
    char folder[SCRATCH_LENGTH];
    make_scratch(folder);
    record(folder, "Two devices, 50% \"duty\"\nand a second line");
    char *printed = run_ngspice(folder, "display\n"
                                        "print x[500]\nprint left.voltage[500]\nprint v(left.voltage)[250]\n"
                                        "print deb.left.current[1000]\nprint left.true_field[0]\n"
                                        "print 2*left.voltage[500]+left.voltage[250]\nprint length(time)\n"
                                        "meas tran top max v(left.voltage)\nmeas tran half when left.voltage=1650\n"
                                        "meas tran mid find x at=5e-3\n");
    double values[4];
    values_at(500, values);
    assert_close(printed_value(printed, "x[500]"), values[0]);
    assert_close(printed_value(printed, "left.voltage[500]"), 1650);
    assert_close(printed_value(printed, "v(left.voltage)[250]"), 825);
    assert_close(printed_value(printed, "deb.left.current[1000]"), -1e-3);
    assert_close(printed_value(printed, "left.true_field[0]"), 1e8 / 3.0);
    assert_close(printed_value(printed, "2*left.voltage[500]+left.voltage[250]"), 4125);
    assert_close(printed_value(printed, "length(time)"), ROWS);
    assert_close(printed_value(printed, "top "), 3300);
    assert_close(printed_value(printed, "half "), 5e-3);
    assert_true(fabs(printed_value(printed, "mid ") - values[0]) < 1e-9);
    assert_non_null(strstr(printed, "Two devices, 50% \"duty\" and a second line"));
    assert_non_null(strstr(printed, "left.voltage        : voltage, real, 1001 long"));
    assert_non_null(strstr(printed, "DEB.left.current    : current, real, 1001 long"));
    assert_non_null(strstr(printed, "x                   : notype, real, 1001 long"));
    free(printed);
    remove_scratch(folder);
}

static void ngspice_plots_and_writes_every_row(void **state) {
    (void)state;
    char folder[SCRATCH_LENGTH];
    make_scratch(folder);
    record(folder, "plot");
    free(run_ngspice(folder, "set hcopydevtype=svg\nhardcopy picture.svg left.voltage x*1e6\nwrdata table.txt x\n"));
    assert_true(exists(path_in(folder, "picture.svg")));
    FILE *table = fopen(path_in(folder, "table.txt"), "r");
    assert_non_null(table);
    for (int i = 0; i < ROWS; i++) {
        double time, x, values[4];
        assert_int_equal(fscanf(table, "%lf %lf", &time, &x), 2);
        values_at(i, values);
        assert_true(fabs(time - i * 1e-5) <= 1e-14 && fabs(x - values[0]) <= 1e-12 * fabs(values[0]));
    }
    fclose(table);
    remove_scratch(folder);
}

static void count_is_right_after_every_flush(void **state) {
    (void)state;
    char folder[SCRATCH_LENGTH];
    make_scratch(folder);
    struct dea_recorder *recorder;
    assert_int_equal(dea_recorder_open(folder, DEA_FORMAT_RAW, "flush", signals, 4, &recorder, NULL), DEA_OK);
    for (int i = 1; i <= 3; i++) {
        double values[4];
        values_at(i, values);
        assert_int_equal(dea_recorder_append(recorder, i, values, NULL), DEA_OK);
        assert_int_equal(dea_recorder_flush(recorder, NULL), DEA_OK);
        size_t length = 0;
        char *raw = read_whole(path_in(folder, "result.raw"), &length), expected[64];
        snprintf(expected, sizeof expected, "No. Points: %-15d\n", i);
        assert_non_null(strstr(raw, expected));
        const char *data = strstr(raw, "Binary:\n") + 8;
        assert_int_equal(length - (size_t)(data - raw), (size_t)i * 5 * sizeof(double));
        double last[5];
        memcpy(last, raw + length - sizeof last, sizeof last);
        assert_true(last[0] == i && last[1] == values[0] && last[4] == values[3]);
        free(raw);
    }
    assert_int_equal(dea_recorder_close(recorder, NULL), DEA_OK);
    remove_scratch(folder);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(ngspice_prints_and_measures_the_numbers),
        cmocka_unit_test(ngspice_plots_and_writes_every_row),
        cmocka_unit_test(count_is_right_after_every_flush),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
