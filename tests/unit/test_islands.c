/* What hangs together with ground, whatever the order of joining. */
#include "circuit/islands.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

static void test_ground_is_found(void **state) {
    (void)state;
    struct dea_islands islands = {0};
    assert_true(dea_islands_join(&islands, 3, 1));
    assert_true(dea_islands_join(&islands, 4, 2));
    assert_false(dea_islands_grounded(&islands, 0)); /* never joined */
    assert_false(dea_islands_grounded(&islands, 1));
    assert_false(dea_islands_grounded(&islands, 9)); /* never heard of */
    assert_true(dea_islands_join(&islands, 1, -1));
    assert_true(dea_islands_grounded(&islands, 3));
    assert_false(dea_islands_grounded(&islands, 4));
    assert_true(dea_islands_join(&islands, 2, 3));
    assert_true(dea_islands_grounded(&islands, 4));
    assert_true(dea_islands_join(&islands, -1, -1));
    assert_int_equal(dea_islands_find_floating(&islands, 5), 0);
    assert_true(dea_islands_join(&islands, -1, 0));
    assert_int_equal(dea_islands_find_floating(&islands, 5), -1);
    assert_int_equal(dea_islands_find_floating(&islands, 6), 5);
    dea_islands_clear(&islands);
}

/* A long ladder from either end, grounded last. */
static void test_long_ladders(void **state) {
    (void)state;
    enum { RUNGS = 20000 };
    for (int backwards = 0; backwards < 2; backwards++) {
        struct dea_islands islands = {0};
        for (int i = 0; i < RUNGS; i++) {
            int node = backwards ? RUNGS - 1 - i : i;
            assert_true(dea_islands_join(&islands, node, node + 1));
        }
        assert_false(dea_islands_grounded(&islands, RUNGS));
        assert_true(dea_islands_join(&islands, RUNGS / 2, -1));
        assert_true(dea_islands_grounded(&islands, 0));
        assert_true(dea_islands_grounded(&islands, RUNGS));
        dea_islands_clear(&islands);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_ground_is_found),
        cmocka_unit_test(test_long_ladders),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
