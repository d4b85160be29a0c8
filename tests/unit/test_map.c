/* Design maps: the same bits with any number of threads, the optima of the paper's figures, ridge, contours, files. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "deasim/map.h"

static void assert_close(double ours, double expected, double tolerance) {
    if (fabs(ours - expected) > tolerance) {
        print_error("%.12g, expected %.12g\n", ours, expected);
        fail();
    }
}

/* Figure 5 of Rosset et al.: r_a and lp1 at lp2 = 2. */
static struct dea_map figure5(enum dea_map_quantity quantity, int count) {
    struct dea_map map = {.base = dea_design_of_paper(),
                          .x = {DEA_KEY_ACTIVE_RATIO, 0.0, 1.0, count},
                          .y = {DEA_KEY_PRESTRETCH1, 0.6, 1.8, count},
                          .quantity = quantity};
    return map;
}

static void threads_do_not_change_a_bit(void **state) {
    (void)state;
    struct dea_map one = figure5(DEA_MAP_VOLTAGE, 37), three = one;
    assert_int_equal(dea_map_fill(&one, 1, NULL), DEA_OK);
    assert_int_equal(dea_map_fill(&three, 3, NULL), DEA_OK);
    assert_memory_equal(one.values, three.values, 37 * 37 * sizeof(double));
    assert_memory_equal(one.modes, three.modes, 37 * 37);
    dea_map_clear(&one);
    dea_map_clear(&three);
}

static struct dea_map_best find_best(struct dea_map *map) {
    struct dea_map_best best;
    assert_int_equal(dea_map_fill(map, 2, NULL), DEA_OK);
    assert_int_equal(dea_map_find_best(map, &best, NULL), DEA_OK);
    assert_true(best.found);
    dea_map_clear(map);
    return best;
}

/* The exact optima; the paper reads 1.28, then 0.065 at (0.46, 0.88), then 0.068 at (0.76, 2.48) on a flat top. */
static void optima_of_the_figures(void **state) {
    (void)state;
    struct dea_map map = figure5(DEA_MAP_STRETCH, 41);
    struct dea_map_best best = find_best(&map);
    assert_close(best.value, 1.294930, 5e-7);
    assert_close(best.x, 0.0, 1e-6);
    assert_close(best.y, 0.776521, 5e-7);

    map = figure5(DEA_MAP_DISPLACEMENT, 41);
    best = find_best(&map);
    assert_close(best.value, 0.0645243, 5e-8);
    assert_close(best.x, 0.467738, 1e-6);
    assert_close(best.y, 0.883642, 1e-6);
    assert_int_equal(best.mode, DEA_LIMIT_BREAKDOWN);

    map = figure5(DEA_MAP_DISPLACEMENT, 41);
    map.x = (struct dea_map_axis){DEA_KEY_PRESTRETCH1, 0.5, 2.5, 41};
    map.y = (struct dea_map_axis){DEA_KEY_PRESTRETCH2, 0.6, 4.6, 41};
    best = find_best(&map);
    assert_close(best.value, 0.0684287, 5e-8);
    assert_close(best.x, 0.791969, 1e-6);
    assert_close(best.y, 2.556039, 1e-6);
}

/* On the ridge both failures meet: without breakdown the design would reach exactly E_bd at loss of tension. */
static void ridge_is_where_two_failures_meet(void **state) {
    (void)state;
    struct dea_map map = figure5(DEA_MAP_DISPLACEMENT, 21);
    struct dea_map_lines ridge = {0};
    assert_int_equal(dea_map_fill(&map, 1, NULL), DEA_OK);
    assert_int_equal(dea_map_trace_ridge(&map, &ridge, NULL), DEA_OK);
    assert_true(ridge.count >= 20);
    for (size_t i = 0; i < ridge.count; i++) {
        struct dea_design design = map.base;
        struct dea_design_end end;
        design.active_ratio = ridge.segments[i].x[0];
        design.prestretch[0] = ridge.segments[i].y[0];
        design.dielectric.breakdown = INFINITY;
        assert_int_equal(dea_design_limit(&design, &end, NULL), DEA_OK);
        assert_int_equal(end.mode, DEA_LIMIT_SLACK1);
        assert_close(end.true_field, 100e6, 10.0);
    }
    dea_map_lines_clear(&ridge);
    dea_map_clear(&map);
}

static void contours_follow_a_level(void **state) {
    (void)state;
    struct dea_map map = figure5(DEA_MAP_DISPLACEMENT, 201);
    struct dea_map_lines lines = {0};
    assert_int_equal(dea_map_fill(&map, 2, NULL), DEA_OK);
    assert_int_equal(dea_map_trace_level(&map, 0.05, &lines, NULL), DEA_OK);
    assert_true(lines.count > 100);
    for (size_t i = 0; i < lines.count; i++) {
        struct dea_design design = map.base;
        struct dea_design_end end;
        design.active_ratio = lines.segments[i].x[0];
        design.prestretch[0] = lines.segments[i].y[0];
        assert_int_equal(dea_design_limit(&design, &end, NULL), DEA_OK);
        assert_close(end.displacement, 0.05, 1.5e-3); /* linear between grid points, steep below the ridge */
    }
    dea_map_lines_clear(&lines);
    dea_map_clear(&map);
}

static void unphysical_axes_are_refused(void **state) {
    (void)state;
    struct dea_error error;
    struct dea_map map = figure5(DEA_MAP_STRETCH, 5);
    map.x.last = 1.2;
    assert_int_equal(dea_map_fill(&map, 2, &error), DEA_ERR_INPUT);
    assert_string_equal(error.text, "r_a = 1.2 is not possible; it must be between 0 and 1");
    dea_map_clear(&map);
    map.x.key = map.y.key;
    assert_int_equal(dea_map_fill(&map, 2, &error), DEA_ERR_INPUT);
    assert_string_equal(error.text, "both axes are lp1");
    map.x.key = DEA_KEY_JM;
    map.base.elastic.kind = DEA_NEO_HOOKEAN;
    assert_int_equal(dea_map_fill(&map, 2, &error), DEA_ERR_INPUT);
    assert_string_equal(error.text, "a neo_hookean film has no parameter Jm");
    dea_map_clear(&map);
}

static void files_are_written(void **state) {
    (void)state;
    char folder[] = "test_map_XXXXXX", path[64], line[128];
    assert_non_null(mkdtemp(folder));
    for (int quantity = 0; quantity < DEA_MAP_QUANTITY_COUNT; quantity++) {
        struct dea_map map = figure5((enum dea_map_quantity)quantity, 11);
        struct dea_map_best best;
        assert_int_equal(dea_map_fill(&map, 1, NULL), DEA_OK);
        assert_int_equal(dea_map_find_best(&map, &best, NULL), DEA_OK);
        assert_int_equal(dea_map_write_csv(&map, folder, NULL), DEA_OK);
        assert_int_equal(dea_map_draw(&map, &best, folder, NULL), DEA_OK);
        dea_map_clear(&map);

        snprintf(path, sizeof path, "%s/map.csv", folder);
        FILE *file = fopen(path, "r");
        assert_non_null(file);
        int rows = 0;
        assert_non_null(fgets(line, sizeof line, file));
        if (quantity == DEA_MAP_STRESS1)
            assert_string_equal(line, "r_a [1],lp1 [1],stress1 [Pa],mode\n");
        while (fgets(line, sizeof line, file) != NULL)
            rows++;
        fclose(file);
        assert_int_equal(rows, 121);

        snprintf(path, sizeof path, "%s/map.png", folder);
        file = fopen(path, "rb");
        assert_non_null(file);
        assert_int_equal(fread(line, 1, 4, file), 4);
        assert_memory_equal(line, "\x89PNG", 4);
        fclose(file);
    }
    const char *const names[] = {"map.csv", "map.png", "map.gnuplot"};
    for (int i = 0; i < 3; i++) {
        snprintf(path, sizeof path, "%s/%s", folder, names[i]);
        assert_int_equal(remove(path), 0);
    }
    assert_int_equal(rmdir(folder), 0);

    struct dea_error error;
    struct dea_map map = figure5(DEA_MAP_STRETCH, 3);
    assert_int_equal(dea_map_fill(&map, 1, NULL), DEA_OK);
    assert_int_equal(dea_map_write_csv(&map, "/dev/null/x", &error), DEA_ERR_INPUT);
    dea_map_clear(&map);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(threads_do_not_change_a_bit),      cmocka_unit_test(optima_of_the_figures),
        cmocka_unit_test(ridge_is_where_two_failures_meet), cmocka_unit_test(contours_follow_a_level),
        cmocka_unit_test(unphysical_axes_are_refused),      cmocka_unit_test(files_are_written),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
