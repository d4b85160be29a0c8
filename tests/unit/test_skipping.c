/* What a run skips because the scene does not need it, each with the same run that does not skip: results agree, work
 * is spared. docs/skipping.md tells what is skipped and why. */
#include "coupled_capture.h"
#include "coupled_cases.h"

#include "cosim/cosim.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define DEVICE "device: {" TWO_ZONES "}"
#define OPTO SOURCE_ROOT "/netlists/parts/hv_opto.lib"

static int enter(void **state) {
    static struct test_folder folder;
    enter_folder(&folder);
    *state = &folder;
    return 0;
}

static int leave(void **state) {
    leave_folder(*state);
    return 0;
}

static void copy_part(const char *path, const char *name) {
    char command[4200];
    snprintf(command, sizeof command, "cp '%s' '%s'", path, name);
    assert_int_equal(system(command), 0);
}

static void make(const char *name, const char *device, const char *netlist, double stop, struct dea_scene *scene) {
    struct coupled_scene listed = {name, device, netlist, stop, ""};
    make_listed_scene(&listed, scene);
}

static void assert_good(const struct coupled_rows *rows) {
    if (rows->status != DEA_OK)
        fail_msg("%s", rows->error.text);
}

static void assert_agree(const char *name, const struct coupled_rows *rows, const struct coupled_rows *reference,
                         double tolerance) {
    struct coupled_error difference = compare_rows(rows, reference);
    if (!(difference.x <= tolerance && difference.port <= tolerance))
        fail_msg("%s: differs by %.2e in x, %.2e at a port", name, difference.x, difference.port);
}

/* ---- rest ---- */

/* One edge of a half bridge at 4 ms, and what `later` adds to it. */
#define HALF_BRIDGE(later)                                                                                             \
    "t\n.include \"hv_opto.lib\"\nVrail rail0 0 3000\nRrail rail0 rail 100k\nCrail rail 0 10n\n"                       \
    "Vup up0 0 PWL(0 0 4m 0 4.01m 5" later ")\nRup up0 upa 180\nXup upa 0 rail mid HV_OPTO\nRbleed mid 0 500Meg\n"     \
    "Rarc mid left 220k\nCcable left 0 100p\nRbond right 0 1k\nXdea left 0 right 0 pos DEA\n.end\n"

static const struct cosim_control resting = {0}, restless = {.restless = true};

/* The same run, resting and not, agree; a tenth of the accuracy says who is right. */
static void judge_rest(const char *name, const char *netlist, double stop, double accuracy, long points, long steps) {
    struct dea_scene scene;
    struct coupled_rows with, without, fine;
    make(name, DEVICE, netlist, stop, &scene);
    run_with_control(&scene, accuracy, &resting, 2000, &with);
    run_with_control(&scene, accuracy, &restless, 2000, &without);
    run_with_control(&scene, 0.1 * accuracy, &resting, 2000, &fine);
    assert_good(&with);
    assert_good(&without);
    assert_good(&fine);
    assert_agree(name, &with, &without, accuracy);
    assert_agree(name, &with, &fine, accuracy);
    assert_true(with.result.energy.imbalance <= accuracy && with.result.coupling_error <= accuracy);
    const struct dea_run_stats *a = &with.result.stats_run, *b = &without.result.stats_run;
    if (!(a->circuit_points <= points && a->plant_steps <= steps && b->plant_steps >= 2 * a->plant_steps))
        fail_msg("%s: %ld points and %ld steps, restless %ld and %ld", name, a->circuit_points, a->plant_steps,
                 b->circuit_points, b->plant_steps);
    free_rows(&with);
    free_rows(&without);
    free_rows(&fine);
    dea_scene_clear(&scene);
}

/* Counts as they are, and a fifth on top for other compilers; they hardly grow with the length of the hold. */
static void test_circuit_at_rest(void **state) {
    (void)state;
    copy_part(OPTO, "hv_opto.lib");
    judge_rest("hold 3 s", HALF_BRIDGE(""), 3.0, 1e-4, 4400, 8600);
    judge_rest("hold 10 s", HALF_BRIDGE(""), 10.0, 1e-4, 4400, 8600);
    judge_rest("hold 10 s, coarse", HALF_BRIDGE(""), 10.0, 1e-3, 1600, 5000);
    judge_rest("wakes", HALF_BRIDGE(" 8 5 8.001 0"), 10.0, 1e-4, 6500, 13500);
}

/* An hour on leakage: as one problem, and beside ngspice. */
static void test_hours_of_leakage(void **state) {
    (void)state;
    static const char netlist[] = "t\nVs s 0 PULSE(0 3000 5m 10u 10u 1e6 2e6)\nRc s left 10Meg\nCc left 0 100p\n"
                                  "Rl left 0 100G\nRb right 0 1k\nXdea left 0 right 0 pos DEA\n.end\n";
    struct dea_scene scene;
    struct coupled_rows linear, coupled;
    make("hour", DEVICE, netlist, 3600.0, &scene);
    run_scene(&scene, DEA_ENGINE_AUTO, 1e-4, 1000, &linear);
    run_scene(&scene, DEA_ENGINE_NGSPICE, 1e-4, 1000, &coupled);
    assert_good(&linear);
    assert_good(&coupled);
    assert_string_equal(linear.result.stats_run.mode, "linear");
    assert_true(linear.result.stats_run.plant_steps <= 2600);
    assert_agree("hour", &coupled, &linear, 1e-4);
    /* ngspice's own step control goes no further than sqrt(trtol) s where nothing flows */
    assert_true(coupled.result.stats_run.circuit_points <= 75000);
    assert_true(coupled.result.stats_run.plant_steps <= 5500);
    free_rows(&linear);
    free_rows(&coupled);
    dea_scene_clear(&scene);
}

/* A small swing that nothing damps is no rest. */
static void test_small_swing_is_followed(void **state) {
    (void)state;
    static const char netlist[] = "t\nVs s 0 PWL(0 500 1m 500 1.01m 510)\nRs s left 1meg\nRb right 0 1k\n"
                                  "Xdea left 0 right 0 pos DEA\n.end\n";
    struct dea_scene scene;
    struct coupled_rows with, linear;
    make("swing", "device: {" ELASTIC "}", netlist, 0.2, &scene);
    run_with_control(&scene, 1e-4, &resting, 2000, &with);
    run_scene(&scene, DEA_ENGINE_AUTO, 1e-5, 2000, &linear);
    assert_good(&with);
    assert_good(&linear);
    assert_agree("swing", &with, &linear, 1e-4);
    free_rows(&with);
    free_rows(&linear);
    dea_scene_clear(&scene);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_circuit_at_rest, enter, leave),
        cmocka_unit_test_setup_teardown(test_hours_of_leakage, enter, leave),
        cmocka_unit_test_setup_teardown(test_small_swing_is_followed, enter, leave),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
