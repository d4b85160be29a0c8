/* 1M and 1F: read as SPICE does, with a word of warning where that can hardly be meant. */
#include "netlist_support.h"

/* What is warned of in a netlist of one line below the title; "" for nothing. */
static void expect_warning(const char *line, const char *says) {
    struct dea_netlist netlist;
    struct dea_error error;
    if (read_netlist(line, &netlist, &error) != DEA_OK)
        fail_msg("%s: %s", line, error.text);
    assert_int_equal(netlist.warning_count, says[0] != '\0');
    if (says[0] != '\0' && strstr(netlist.warnings[0], says) == NULL)
        fail_msg("%s: \"%s\" instead of \"%s\"", line, netlist.warnings[0], says);
    dea_netlist_clear(&netlist);
}

static void test_hardly_meant(void **state) {
    (void)state;
    expect_warning("R1 a 0 1M", ":2: 1M is 1 milliohm: M is milli in SPICE, Meg is a million");
    expect_warning("r1 a 0 4.7MOhm tc=0", ":2: 4.7MOhm is 4.7 milliohm");
    expect_warning("C1 a 0 1F", ":2: 1F is 1 femtofarad: F behind a number is femto in SPICE");
}

static void test_well_meant(void **state) {
    (void)state;
    static const char *const good[] = {"R1 a 0 1Meg", "R1 a 0 1MEG", "R1 a 0 1m",   "R1 a 0 2mil",   "R1 M 0 1k",
                                       "C1 a 0 10pF", "C1 a 0 1f",   "C1 a F 1n",   "R1 a 0 {1M*2}", "L1 a 0 1M",
                                       "R1 a 0 r=1",  "R1 a 0 1e6",  "R1 a 0 model"};
    for (size_t i = 0; i < sizeof good / sizeof good[0]; i++)
        expect_warning(good[i], "");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_hardly_meant),
        cmocka_unit_test(test_well_meant),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
