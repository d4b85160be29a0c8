/* Many devices in one netlist, many scenes in one process, many points in one run: cost and memory do not grow faster
 * than the number. */
#include "coupled_capture.h"
#include "coupled_cases.h"
#include "deasim/run.h"
#include "memory.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cmocka.h>

/* ---- many devices ---- */

#define ACCURACY 1e-3

enum { SAMPLES = 50, MANY = 16 };

/* Every device behind its own resistor and diode, on one source. */
static void run_devices(int count, struct coupled_rows *rows) {
    struct dea_scene scene;
    FILE *file = fopen("many.cir", "w");
    assert_non_null(file);
    fputs("many\nVs s 0 PULSE(0 2500 1m 1m 1m 6m)\n.model dd D(is=1e-12 n=2 rs=10 cjo=1p bv=10k)\n", file);
    for (int i = 0; i < count; i++)
        fprintf(file, "R%d s a%d 1meg\nD%d a%d l%d dd\nRl%d l%d 0 50meg\nRr%d r%d 0 1k\nXd%d l%d 0 r%d 0 pos%d DEA\n",
                i, i, i, i, i, i, i, i, i, i, i, i, i);
    fputs(".end\n", file);
    assert_int_equal(fclose(file), 0);
    make_scene("{" TWO_ZONES "}", "many.cir", 20e-3, SILENT_EVENTS, &scene);
    run_scene(&scene, DEA_ENGINE_AUTO, ACCURACY, SAMPLES, rows);
    if (rows->status != DEA_OK)
        fail_msg("%d devices: %s", count, rows->error.text);
    assert_string_equal(rows->result.stats_run.mode, "cosim");
    assert_int_equal(rows->count, SAMPLES + 1);
    dea_scene_clear(&scene);
}

/* Alike devices move alike, as one alone does; each costs what one alone costs, however many others there are. */
static void test_alike_devices(void **state) {
    (void)state;
    struct coupled_rows one, many;
    run_devices(1, &one);
    run_devices(MANY, &many);
    assert_int_equal(many.columns, MANY * one.columns);
    const char *const names[] = {"x", "left.port_voltage", "left.charge"};
    for (size_t n = 0; n < sizeof names / sizeof names[0]; n++) {
        size_t c = (size_t)find_signal(&one, names[n]);
        double largest = 0.0;
        for (size_t r = 0; r < one.count; r++)
            largest = fmax(largest, fabs(one.values[r * one.columns + c]));
        assert_true(largest > 0.0);
        for (size_t r = 0; r < many.count * MANY; r++) /* each device of each row */
            assert_true(fabs(many.values[r * one.columns + c] - one.values[r / MANY * one.columns + c]) <=
                        0.2 * ACCURACY * largest);
    }
    const struct dea_run_stats *alone = &one.result.stats_run, *together = &many.result.stats_run;
    assert_true(together->circuit_points <= 1.2 * (double)alone->circuit_points);
    assert_true(together->plant_steps <= 1.2 * MANY * (double)alone->plant_steps);
    assert_true(together->residuals <= 1.2 * MANY * (double)alone->residuals);
    assert_true(together->jacobians <= 1.2 * MANY * (double)alone->jacobians);
    free_rows(&one);
    free_rows(&many);
}

/* ---- many scenes ---- */

enum { SCENES = 200, SETTLED = 20, ROOM = 2 << 20 }; /* the latter: bytes */

static void write_netlist(int number, const char *part) {
    FILE *file = fopen("scene.cir", "w");
    assert_non_null(file);
    fprintf(file,
            "scene %d\nVs s 0 PULSE(0 %d 0.1m 0.1m 0.1m 1m)\nRs s a %dk\n%s\nRb left 0 100meg\nRr right 0 1k\n"
            "Xdea left 0 right 0 pos DEA\n.measure tran top max v(left)\n.model dd D(is=1e-12 n=2 rs=10)\n.end\n",
            number, 1000 + 3 * number, 100 + number, part);
    assert_int_equal(fclose(file), 0);
}

static const char *const modes[] = {"native", "linear", "cosim", "cosim"};

/* A scene unlike those before it: native sources, a linear netlist, one with a diode, one that runs into an event. */
static void write_scene(int number) {
    FILE *file = fopen("scene.yaml", "w");
    assert_non_null(file);
    fprintf(file, "title: Scene %d\ndevice: {base: %s}\ntransient: {stop: %g ms, accuracy: 1e-3}\n", number,
            SOURCE_ROOT "/models/planar_c_s5.yaml", 2.0 + 0.005 * number);
    fprintf(file, "output: {formats: [csv, raw, hdf5]}\nevents: {breakdown: %s, slack: warn}\n",
            number % 4 == 3 ? "stop" : "warn");
    if (number % 4 == 0)
        fprintf(file, "drive: {left: {waveform: {type: sine, offset: 1 kV, amplitude: %d V, frequency: 1 kHz}}}\n",
                500 + number);
    else
        fputs("drive: {netlist: scene.cir}\n", file);
    assert_int_equal(fclose(file), 0);
    if (number % 4 == 1)
        write_netlist(number, "Ra a left 1k");
    else
        write_netlist(number, "Da a left dd");
}

static void run_one(int number) {
    struct dea_scene scene;
    struct dea_result result;
    struct dea_error error;
    struct dea_report silent = {0};
    struct dea_run_options options = {.report = &silent, .directory = "."};
    write_scene(number);
    if (dea_scene_read("scene.yaml", NULL, 0, &scene, &error) != DEA_OK)
        fail_msg("scene %d: %s", number, error.text);
    if (dea_run_scene(&scene, &options, &result, &error) < 0)
        fail_msg("scene %d: %s", number, error.text);
    assert_string_equal(result.stats_run.mode, modes[number % 4]);
    dea_result_clear(&result);
    dea_scene_clear(&scene);
    struct dea_override bad = {"transient.stop", "-1"}; /* and what is refused leaves nothing either */
    assert_int_equal(dea_scene_read("scene.yaml", &bad, 1, &scene, &error), DEA_ERR_INPUT);
    dea_scene_clear(&scene);
}

static void test_scenes_in_a_row(void **state) {
    (void)state;
    long settled = 0;
    for (int number = 0; number < SCENES; number++) {
        run_one(number);
        if (number == SETTLED - 1)
            settled = resident_bytes();
    }
    long grown = resident_bytes() - settled;
#ifndef __SANITIZE_ADDRESS__ /* it keeps freed memory for a while; it finds leaks itself */
    if (grown > ROOM)
        fail_msg("%ld kB more after %d scenes than after %d", grown / 1024, SCENES, SETTLED);
#endif
    print_message("%ld kB after %d scenes, %ld kB more after %d\n", settled / 1024, SETTLED, grown / 1024, SCENES);
}

/* ---- many points ---- */

/* Largest resident set of the children so far, bytes, after a run of this many circuit points. */
static long run_points(int points) {
    struct coupled_rows rows;
    struct dea_scene scene;
    FILE *file = fopen("points.cir", "w");
    assert_non_null(file);
    fprintf(file,
            "points\nVs s 0 SIN(1000 500 1k)\nRs s a 100k\nD1 a l dd\nRl l 0 20meg\nRr r 0 1k\nXdea l 0 r 0 pos DEA\n"
            ".model dd D(is=1e-12 n=2 rs=10 bv=10k)\n.tran 1u %du 0 1u\n.end\n",
            points);
    assert_int_equal(fclose(file), 0);
    make_scene("{" TWO_ZONES "}", "points.cir", points * 1e-6, SILENT_EVENTS, &scene);
    run_scene(&scene, DEA_ENGINE_AUTO, 1e-3, 100, &rows);
    if (rows.status != DEA_OK)
        fail_msg("%d points: %s", points, rows.error.text);
    assert_true(rows.result.stats_run.circuit_points >= points);
    free_rows(&rows);
    dea_scene_clear(&scene);
    struct rusage usage;
    assert_int_equal(getrusage(RUSAGE_CHILDREN, &usage), 0);
    return usage.ru_maxrss * 1024;
}

/* ngspice keeping them would take 65 bytes each. */
static void test_points_are_forgotten(void **state) {
    (void)state;
    long few = run_points(10000), grown = run_points(200000) - few;
#ifndef __SANITIZE_ADDRESS__
    if (grown > ROOM)
        fail_msg("%ld kB more for 200000 points than for 10000", grown / 1024);
#endif
    print_message("%ld kB for 10000 points, %ld kB more for 200000\n", few / 1024, grown / 1024);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_alike_devices, set_up_folder, tear_down_folder),
        cmocka_unit_test_setup_teardown(test_scenes_in_a_row, set_up_folder, tear_down_folder),
        cmocka_unit_test_setup_teardown(test_points_are_forgotten, set_up_folder, tear_down_folder),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
