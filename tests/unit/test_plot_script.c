/* The gnuplot script: data as written, limits in and out of sight, strings that stay strings. */
#include "output/plot_internal.h"
#include "output_support.h"

#include <math.h>

/* Script of a result with the given caption; free it. */
static char *script_of(const char *csv, const struct dea_caption *caption) {
    char folder[SCRATCH_LENGTH];
    make_scratch(folder);
    write_whole(path_in(folder, "result.csv"), csv);
    struct dea_table table;
    struct dea_panel panels[DEA_PANELS];
    struct dea_error error;
    assert_int_equal(dea_table_open(folder, &table, &error), DEA_OK);
    int count = dea_panels_choose(&table, panels);
    assert_int_equal(count, 1);
    static const size_t columns[] = {1, 2};
    assert_int_equal(dea_table_read(&table, columns, (size_t)panels[0].curve_count, &error), DEA_OK);
    char *text = NULL;
    size_t length = 0;
    FILE *script = open_memstream(&text, &length);
    dea_plot_script(&table, panels, count, caption, script);
    fclose(script);
    dea_table_clear(&table);
    remove_scratch(folder);
    return text;
}

static void data_are_scaled_and_gaps_stay(void **state) {
    (void)state;
    static const struct dea_caption caption = {.title = "t"};
    char *script = script_of("time [s],left.voltage [V]\n0,0\n0.001,nan\n0.002,3300\n0.004,1650\n", &caption);
    assert_non_null(strstr(script, "$column1 << END_OF_DATA\n0 0\n0 0\n\n2 3.3\n4 1.65\n4 1.65\nEND_OF_DATA\n"));
    assert_non_null(strstr(script, "set xrange [0:4]\n"));
    assert_non_null(strstr(script, "'Voltage [kV]'"));
    assert_non_null(strstr(script, "set xlabel 'Time [ms]'\n"));
    assert_non_null(strstr(script, "set yrange [-0.198:3.498]\n")); /* 6 % of margin */
    free(script);
}

static void port_voltage_lies_below(void **state) {
    (void)state;
    static const struct dea_caption caption = {.title = "t"};
    char *script = script_of("time [s],left.voltage [V],left.port_voltage [V]\n0,1,2\n1,2,3\n", &caption);
    const char *port = strstr(script, "plot $column2 using 1:2 with lines lw 4.5"),
               *film = strstr(script, "$column1 using");
    assert_non_null(port);
    assert_true(film > port);
    free(script);
}

static void limit_is_drawn_or_mentioned(void **state) {
    (void)state;
    struct dea_caption caption = {.title = "t", .limits = {{"left.true_field", 1e8}}, .limit_count = 1};
    const char *csv = "time [s],left.true_field [V/m]\n0,0\n1,9e7\n";
    char *script = script_of(csv, &caption);
    assert_non_null(strstr(script, "limit = 100\n"));
    assert_non_null(strstr(script, "limit with lines"));
    assert_non_null(strstr(script, "title 'breakdown 100 V/µm'"));
    assert_non_null(strstr(script, "set yrange [-6:106]\n"));
    free(script);
    caption.limits[0].value = 1e9;
    script = script_of(csv, &caption);
    assert_non_null(strstr(script, "NaN with lines"));
    assert_non_null(strstr(script, "title 'breakdown 1000 V/µm, off scale'"));
    assert_non_null(strstr(script, "set yrange [-5.4:95.4]\n"));
    free(script);
    snprintf(caption.limits[0].signal, sizeof caption.limits[0].signal, "right.true_field");
    script = script_of(csv, &caption);
    assert_null(strstr(script, "breakdown"));
    free(script);
}

/* A film breaks down at either polarity: the limit is drawn where the fields are. */
static void limit_follows_the_sign(void **state) {
    (void)state;
    static const struct dea_caption caption = {.title = "t", .limits = {{"left.true_field", 1e8}}, .limit_count = 1};
    char *script = script_of("time [s],left.true_field [V/m]\n0,-9e7\n1,8e7\n", &caption);
    assert_non_null(strstr(script, "     limit with lines"));
    assert_non_null(strstr(script, "     -limit with lines lw 1.5 dt (10,6) lc rgb '#B00020' notitle"));
    assert_non_null(strstr(script, "set yrange [-112:112]\n"));
    free(script);
    script = script_of("time [s],left.true_field [V/m]\n0,-9e7\n1,0\n", &caption);
    assert_null(strstr(script, "     limit with lines"));
    assert_non_null(
        strstr(script, "     -limit with lines lw 1.5 dt (10,6) lc rgb '#B00020' title 'breakdown 100 V/µm'"));
    assert_non_null(strstr(script, "set yrange [-106:6]\n"));
    free(script);
    script = script_of("time [s],left.true_field [V/m]\n0,-1e7\n1,9e7\n", &caption);
    assert_null(strstr(script, "-limit"));
    free(script);
}

static void strings_cannot_become_commands(void **state) {
    (void)state;
    static const struct dea_caption caption = {
        .title = "it's\n`x`", .outcome = "'; quit", .events = {{0.5, "left'\nbreakdown"}}, .event_count = 1};
    char *script = script_of("time [s],a'b [K]\n0,1\n1,2\n", &caption);
    assert_non_null(strstr(script, "set label 1 'it''s `x`' at"));
    assert_non_null(strstr(script, "set label 2 '''; quit' at"));
    assert_non_null(strstr(script, "'left'' breakdown' at first 0.5,"));
    assert_non_null(strstr(script, "title 'a''b'"));
    free(script);
}

/* Same kind again: a line without a word. Close by: a word further up, then none. */
static void words_of_events_keep_apart(void **state) {
    (void)state;
    static const struct dea_caption caption = {
        .title = "t",
        .events = {{0.2, "left slack"}, {0.3, "left slack"}, {0.5, "a"}, {0.505, "b"}, {0.51, "c"}, {0.99, "d"}},
        .event_count = 6};
    char *script = script_of("time [s],x [m]\n0,1\n1,2\n", &caption);
    assert_non_null(strstr(script, "set arrow 2 from first 0.3, graph 0 to first 0.3, graph 1 nohead"));
    assert_non_null(strstr(script, "set label 10 'left slack' at first 0.2, graph 0.1 left rotate by 90 offset 1.1,0"));
    assert_null(strstr(script, "at first 0.3,"));
    assert_non_null(strstr(script, "'a' at first 0.5, graph 0.1 "));
    assert_non_null(strstr(script, "'b' at first 0.505, graph 0.5 "));
    assert_null(strstr(script, "'c'"));
    assert_non_null(strstr(script, "'d' at first 0.99, graph 0.1 left rotate by 90 offset -1.1,0"));
    free(script);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(data_are_scaled_and_gaps_stay), cmocka_unit_test(port_voltage_lies_below),
        cmocka_unit_test(limit_is_drawn_or_mentioned),   cmocka_unit_test(strings_cannot_become_commands),
        cmocka_unit_test(words_of_events_keep_apart),    cmocka_unit_test(limit_follows_the_sign),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
