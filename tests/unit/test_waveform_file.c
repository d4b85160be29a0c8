/* Waveform files: what is read, and the exact words for what is refused. */
#include "deasim/waveform.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

/* A folder of its own, entered, so that messages carry short names. */
static int enter_folder(void **state) {
    static char folder[] = "waveform_file_XXXXXX";
    *state = folder;
    return mkdtemp(folder) == NULL ? -1 : chdir(folder);
}

static int leave_folder(void **state) {
    unlink("w.csv");
    return chdir("..") != 0 ? -1 : rmdir(*state);
}

static void write_bytes(const void *bytes, size_t length) {
    FILE *file = fopen("w.csv", "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(bytes, 1, length, file), length);
    assert_int_equal(fclose(file), 0);
}

static void reads(const char *text, const char *unit, size_t count, const double *times, const double *values) {
    struct dea_waveform w;
    struct dea_error error;
    write_bytes(text, strlen(text));
    if (dea_waveform_read_csv("w.csv", unit, &w, &error) != DEA_OK)
        fail_msg("%s", error.text);
    assert_int_equal(w.kind, DEA_WAVE_PWL);
    assert_int_equal(w.point_count, count);
    for (size_t i = 0; i < count; i++)
        if (w.times[i] != times[i] || w.values[i] != values[i])
            fail_msg("point %zu is %.17g, %.17g", i, w.times[i], w.values[i]);
    assert_int_equal(dea_waveform_check(&w, &error), DEA_OK);
    dea_waveform_clear(&w);
}

static void refuses_bytes(const void *bytes, size_t length, const char *message) {
    struct dea_waveform w;
    struct dea_error error;
    write_bytes(bytes, length);
    assert_int_equal(dea_waveform_read_csv("w.csv", "V", &w, &error), DEA_ERR_INPUT);
    assert_string_equal(error.text, message);
    assert_null(w.times);
    assert_null(w.values);
    assert_int_equal(w.point_count, 0);
}

static void refuses(const char *text, const char *message) {
    refuses_bytes(text, strlen(text), message);
}

static void test_units_are_exact(void **state) {
    (void)state;
    const double times[] = {0, 0.1e-3, 33e-3, 1}, values[] = {0, 3.3e3, -1.5e3, 4e3};
    reads("time [ms], value [kV]\n0,0\n0.1,3.3\n33,-1.5\n1e3,+4\n", "V", 4, times, values);
    const double us_times[] = {3e-6, 33e-6}, forces[] = {0.001, 0.007};
    reads("time [us], load [mN]\n3,1\n33,7\n", "N", 2, us_times, forces);
    const double minutes[] = {0, 90}, volts[] = {1, 2};
    reads("Time [min],drive [V]\n0,1\n1.5,2\n", "V", 2, minutes, volts);
}

static void test_lenient_about_looks(void **state) {
    (void)state;
    const double times[] = {0, 1e-6}, values[] = {5, 6};
    reads("\xef\xbb\xbf# scope export\r\n\r\ntime [\xc2\xb5s],\tvalue [V]\r\n# first\r\n 0 ,\t5\r\n1,6\r\n\r\n\n", "V",
          2, times, values);
    reads("time [us], value [V]\n0,5\n1,6", "V", 2, times, values);
}

/* Two equal times are a jump; what lies before the first row holds its value. */
static void test_jump_and_late_start(void **state) {
    (void)state;
    struct dea_waveform w;
    struct dea_error error;
    const char *text = "time [s], value [V]\n1,10\n2,20\n2,50\n3,60\n";
    write_bytes(text, strlen(text));
    assert_int_equal(dea_waveform_read_csv("w.csv", "V", &w, &error), DEA_OK);
    assert_true(dea_waveform_value(&w, 0) == 10);
    assert_true(dea_waveform_value(&w, 1.5) == 15);
    assert_true(dea_waveform_value(&w, 2) == 50);
    assert_true(dea_waveform_value(&w, 9) == 60);
    dea_waveform_clear(&w);
}

static void test_many_rows(void **state) {
    (void)state;
    FILE *file = fopen("w.csv", "w");
    assert_non_null(file);
    fputs("time [us], value [V]\n", file);
    for (int i = 0; i < 100000; i++)
        fprintf(file, "%d,%d\n", i, i % 7);
    assert_int_equal(fclose(file), 0);
    struct dea_waveform w;
    struct dea_error error;
    assert_int_equal(dea_waveform_read_csv("w.csv", "V", &w, &error), DEA_OK);
    assert_int_equal(w.point_count, 100000);
    assert_true(w.times[99999] == 99999e-6 && w.values[99999] == 99999 % 7);
    dea_waveform_clear(&w);
}

static void test_header_refusals(void **state) {
    (void)state;
    refuses("", "w.csv: empty; a header \"time [unit], value [unit]\" is needed");
    refuses("0,1\n1,2\n", "w.csv:1: column '0' lacks its unit; write it as \"name [unit]\"");
    refuses("time, value [V]\n", "w.csv:1: column 'time' lacks its unit; write it as \"name [unit]\"");
    refuses("time [s], value\n", "w.csv:1: column 'value' lacks its unit; write it as \"name [unit]\"");
    refuses("time [s], value []\n", "w.csv:1: column 'value' has empty brackets; its unit is needed");
    refuses("time [s], [V]\n", "w.csv:1: column '[V]' lacks its unit; write it as \"name [unit]\"");
    refuses("time [s]; value [V]\n", "w.csv:1: 1 cell; two are needed, time and value, with a comma between");
    refuses("time [s], a [V], b [V]\n", "w.csv:1: 3 cells; two are needed, time and value, with a comma between");
    refuses("x [s], value [V]\n", "w.csv:1: the first column is 'x'; it must be \"time [unit]\"");
    refuses("time [V], value [V]\n", "w.csv:1: column 'time': unit 'V' is not that of a time; allowed: ns, us, ms, s, "
                                     "min, h");
    refuses("# note\ntime [s], value [mN]\n",
            "w.csv:2: column 'value': unit 'mN' is not that of a voltage; allowed: mV, "
            "V, kV");
    refuses("time [s], value [furlong/x]\n", "w.csv:1: column 'value': unknown unit 'furlong/x'; allowed: mV, V, kV");
}

static void test_row_refusals(void **state) {
    (void)state;
#define HEADER "time [ms], value [V]\n"
    refuses(HEADER, "w.csv: 0 rows; at least two are needed");
    refuses(HEADER "0,1\n", "w.csv: 1 row; at least two are needed");
    refuses(HEADER "0,1\n1,\n", "w.csv:3: the value is missing");
    refuses(HEADER "0,1\n ,2\n", "w.csv:3: the time is missing");
    refuses(HEADER "0,1\n1\n", "w.csv:3: 1 cell; two are needed, time and value, with a comma between");
    refuses(HEADER "0,1\n1,2,3\n", "w.csv:3: 3 cells; two are needed, time and value, with a comma between");
    refuses(HEADER "0,1\n\n1,2\n", "w.csv:3: blank line between rows");
    refuses(HEADER "\n0,1\n1,2\n", "w.csv:2: blank line between rows");
    refuses(HEADER "0,1\n1,nan\n", "w.csv:3: the value 'nan' is not a finite decimal number");
    refuses(HEADER "0,1\n1,-inf\n", "w.csv:3: the value '-inf' is not a finite decimal number");
    refuses(HEADER "0,1\n1,1e999\n", "w.csv:3: the value '1e999' is not a finite decimal number");
    refuses(HEADER "0,1\n1,0x10\n", "w.csv:3: the value '0x10' is not a finite decimal number");
    refuses(HEADER "0,1\n1,3 kV\n", "w.csv:3: the value '3 kV' is not a finite decimal number");
    refuses(HEADER "0,1\n1e,3\n", "w.csv:3: the time '1e' is not a finite decimal number");
    refuses(HEADER "0,1\n2,1\n1,2\n", "w.csv:4: time of point 3, 0.001 s, goes back behind 0.002 s");
    refuses(HEADER "-1,1\n2,1\n", "w.csv:2: time of point 1 is -0.001 s; a time from 0 to 1e+15 s is needed");
    refuses(HEADER "0,1\n2,1\n2,3\n2,4\n", "w.csv:5: points 2, 3 and 4 have the same time 0.002 s; two make a jump");
    refuses(HEADER "0,1\n1,1e31\n", "w.csv:3: value of point 2 is 1e+31; a finite number up to 1e+30 is needed");
    refuses(HEADER "0,1\n1e-14,1\n", "w.csv:3: points 1 and 2 are less than 1 fs apart");
}

static void test_garbage(void **state) {
    (void)state;
    refuses_bytes("time [s], value [V]\n0,1\n\0,2\n", 27, "w.csv:3: not a text file: it holds the byte 0x00");
    refuses("\177ELF", "w.csv:1: not a text file: it holds the byte 0x7f");
    refuses("time [s], value [V]\r0,1\r", "w.csv:1: not a text file: it holds the byte 0x0d");

    char line[3000];
    memset(line, '1', sizeof line);
    refuses_bytes(line, sizeof line, "w.csv:1: line longer than 1024 characters");

    struct dea_waveform w;
    struct dea_error error;
    assert_int_equal(dea_waveform_read_csv("missing.csv", "V", &w, &error), DEA_ERR_INPUT);
    assert_string_equal(error.text, "missing.csv: cannot be opened: No such file or directory");
    assert_int_equal(dea_waveform_read_csv(".", "V", &w, &error), DEA_ERR_INPUT);
    assert_string_equal(error.text, ".: not a regular file");
    assert_int_equal(dea_waveform_read_csv("/dev/zero", "V", &w, &error), DEA_ERR_INPUT);
    assert_string_equal(error.text, "/dev/zero: not a regular file");
}

/* Random damage to a good file: read or refused with the file's name, never a crash and never a bad waveform. */
static void test_damaged_files(void **state) {
    (void)state;
    const char good[] = "\xef\xbb\xbf# c\ntime [ms], value [kV]\n0,1\n1,2.5e0\n1,-3\r\n2.5,+4\n\n";
    uint64_t seed = 88172645463325252u;
    int accepted = 0;
    for (int round = 0; round < 800; round++) {
        char bytes[sizeof good];
        size_t length = sizeof good - 1;
        memcpy(bytes, good, sizeof good);
        for (int hit = 0; hit < 1 + round % 3; hit++) {
            seed ^= seed << 13;
            seed ^= seed >> 7;
            seed ^= seed << 17;
            bytes[(seed >> 16) % length] = (seed & 1) != 0 ? (char)(seed >> 40) : good[(seed >> 32) % length];
        }
        if (round % 5 == 0)
            length = (seed >> 20) % length;
        write_bytes(bytes, length);
        struct dea_waveform w;
        struct dea_error error;
        if (dea_waveform_read_csv("w.csv", "V", &w, &error) == DEA_OK) {
            accepted++;
            assert_int_equal(dea_waveform_check(&w, &error), DEA_OK);
        } else {
            assert_memory_equal(error.text, "w.csv:", 6);
        }
        dea_waveform_clear(&w);
    }
    assert_in_range(accepted, 20, 780);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_units_are_exact),
        cmocka_unit_test(test_lenient_about_looks),
        cmocka_unit_test(test_jump_and_late_start),
        cmocka_unit_test(test_many_rows),
        cmocka_unit_test(test_header_refusals),
        cmocka_unit_test(test_row_refusals),
        cmocka_unit_test(test_garbage),
        cmocka_unit_test(test_damaged_files),
    };
    return cmocka_run_group_tests(tests, enter_folder, leave_folder);
}
