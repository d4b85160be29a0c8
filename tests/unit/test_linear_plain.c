/* Netlists listed without ngspice: only those in which every line says what it means. */
#include "circuit/linear.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#define CALL "Xdea left 0 right 0 pos DEA"

/* A title, a source, the device and one line more; the listing where that is plain. */
static bool list(const char *line, struct dea_listing *listing) {
    char texts[4][128] = {"a title", "V1 left 0 PULSE(0 1k 1m)", CALL}, path[] = "xdea";
    struct dea_netlist_line lines[4];
    struct dea_netlist_instance instance = {.path = path, .line = 2};
    snprintf(texts[3], sizeof texts[3], "%s", line);
    for (int i = 0; i < 4; i++)
        lines[i] = (struct dea_netlist_line){.text = texts[i], .passed = true};
    const struct dea_netlist netlist = {.lines = lines, .line_count = 4, .instances = &instance, .instance_count = 1};
    bool plain = false;
    struct dea_error error;
    assert_int_equal(dea_linear_list(&netlist, listing, &plain, &error), DEA_OK);
    return plain;
}

static void test_plain(void **state) {
    (void)state;
    static const char *const lines[] = {"R1 left right 1Meg",
                                        "R1 left right 1k tc1=1m temp = 30 m=2",
                                        "C1 left 0 ic=5 c=1n",
                                        "E1 out 0 (left,0) 2",
                                        "V2 right 0 DC 1 AC 1 SIN(0 1 50)",
                                        "V2 right 0 PWL(0 0 1m 1) r=0 td=1m",
                                        ".ic v(left)=500",
                                        ".options reltol=1e-4",
                                        ".tran 1u 1m"};
    for (size_t i = 0; i < sizeof lines / sizeof lines[0]; i++) {
        struct dea_listing listing;
        if (!list(lines[i], &listing))
            fail_msg("not plain: %s", lines[i]);
        assert_int_equal(listing.count, 3); /* without the device's call */
        assert_string_equal(listing.lines[1], "V1 left 0 PULSE(0 1k 1m)");
        assert_string_equal(listing.lines[2], lines[i]);
        dea_listing_clear(&listing);
    }
}

static void test_parameters_are_put_in(void **state) {
    (void)state;
    struct dea_listing listing;
    assert_true(list("R1 left right {2*1k}", &listing));
    assert_string_equal(listing.lines[2], "R1 left right 2000");
    dea_listing_clear(&listing);
    assert_true(list(".param ra=1k", &listing)); /* and not listed */
    assert_int_equal(listing.count, 2);
    dea_listing_clear(&listing);
}

static void test_measures_are_not_listed(void **state) {
    (void)state;
    struct dea_listing listing;
    assert_true(list(".measure tran m max par('v(left)*2')", &listing));
    assert_int_equal(listing.count, 2);
    dea_listing_clear(&listing);
}

static void test_in_doubt(void **state) {
    (void)state;
    static const char *const lines[] = {"R1 left right {ra}",   "R1 left right r='1k**2'",
                                        "R1 left right \"1k\"", "R1 left right 2*3",
                                        "R1 = left right 1k",   "V2 right 0 = PULSE(0 1 1m)",
                                        "V2 right 0 DC=1",      "V2 ac right 0 5",
                                        "v1 right 0 5", /* a second one */
                                        "R1.a left right 1k",   "D1 left 0 DX",
                                        "B1 left 0 v=1",        "Xarm left 0 arm",
                                        ".param ra={rb}",       ".subckt arm a b",
                                        ".model DX D",          ".temp 77",
                                        ".global left",         ".ic v(left)={x}"};
    for (size_t i = 0; i < sizeof lines / sizeof lines[0]; i++) {
        struct dea_listing listing;
        if (list(lines[i], &listing))
            fail_msg("plain: %s", lines[i]);
        dea_listing_clear(&listing);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_plain), cmocka_unit_test(test_parameters_are_put_in),
                                       cmocka_unit_test(test_measures_are_not_listed), cmocka_unit_test(test_in_doubt)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
