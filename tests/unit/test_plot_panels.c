/* Which signals a picture shows. */
#include "output/plot_internal.h"
#include "output_support.h"

#include <math.h>

static int choose(const struct dea_signal *signals, size_t count, struct dea_panel panels[DEA_PANELS]) {
    struct dea_signal columns[64] = {{"time", "s"}};
    assert_true(count < 64);
    memcpy(columns + 1, signals, count * sizeof *signals);
    const struct dea_table table = {.columns = columns, .column_count = count + 1};
    return dea_panels_choose(&table, panels);
}

static const struct dea_signal whole_run[] = {{"x", "m"},
                                              {"v", "m/s"},
                                              {"left.voltage", "V"},
                                              {"left.port_voltage", "V"},
                                              {"left.current", "A"},
                                              {"left.true_field", "V/m"},
                                              {"right.voltage", "V"},
                                              {"right.port_voltage", "V"},
                                              {"right.current", "A"},
                                              {"right.true_field", "V/m"},
                                              {"energy.in", "J"},
                                              {"energy.stored", "J"},
                                              {"energy.dissipated", "J"},
                                              {"energy.imbalance", "J"}};

static void whole_run_has_the_four_main_panels(void **state) {
    (void)state;
    struct dea_panel panels[DEA_PANELS];
    assert_int_equal(choose(whole_run, 14, panels), 4);
    static const char *const axes[] = {"Voltage", "Displacement", "True field", "Energy"};
    static const int counts[] = {4, 1, 2, 4};
    for (int i = 0; i < 4; i++) {
        assert_string_equal(panels[i].axis, axes[i]);
        assert_int_equal(panels[i].curve_count, counts[i]);
    }
    const struct dea_panel_curve *voltages = panels[0].curves, *fields = panels[2].curves;
    assert_string_equal(voltages[0].label, "left");
    assert_string_equal(voltages[1].label, "left port");
    assert_true(voltages[1].broad && !voltages[0].broad);
    assert_int_equal(voltages[0].column, 3);
    assert_string_equal(panels[1].curves[0].label, "");
    assert_string_equal(panels[3].curves[2].label, "dissipated");
    /* A zone keeps its colour, port and film, in every panel. */
    assert_int_equal(voltages[0].colour, voltages[1].colour);
    assert_int_equal(voltages[0].colour, fields[0].colour);
    assert_int_equal(voltages[2].colour, fields[1].colour);
    assert_int_not_equal(fields[0].colour, fields[1].colour);
}

static void current_stands_in_for_energy(void **state) {
    (void)state;
    struct dea_panel panels[DEA_PANELS];
    assert_int_equal(choose(whole_run, 10, panels), 4);
    assert_string_equal(panels[3].axis, "Current");
    assert_string_equal(panels[3].curves[1].label, "right");
}

static void devices_are_told_apart(void **state) {
    (void)state;
    static const struct dea_signal signals[] = {
        {"DEA.x", "m"},         {"DEB.x", "m"},         {"DEA.left.voltage", "V"}, {"DEB.left.voltage", "V"},
        {"DEB.energy.in", "J"}, {"DEA.energy.in", "J"}, {"DEA.energy.stored", "J"}};
    struct dea_panel panels[DEA_PANELS];
    assert_int_equal(choose(signals, 7, panels), 3);
    assert_string_equal(panels[0].curves[1].label, "DEB.left");
    assert_string_equal(panels[1].curves[0].label, "DEA");
    assert_string_equal(panels[1].curves[1].label, "DEB");
    assert_int_not_equal(panels[1].curves[0].colour, panels[1].curves[1].colour);
    const struct dea_panel_curve *energies = panels[2].curves;
    assert_string_equal(energies[0].label, "DEB in");
    assert_int_equal(energies[0].colour, energies[1].colour); /* the same energy, told apart by the dash */
    assert_true(energies[0].dashed && !energies[1].dashed);
    assert_true(energies[1].broad && !energies[2].broad);
}

static void unknown_signals_are_drawn_by_unit(void **state) {
    (void)state;
    static const struct dea_signal signals[] = {{"v(out)", "V"},           {"i(r1)", "A"}, {"v(in)", "V"}, {"max", "1"},
                                                {"energy.imbalance", "1"}, {"a", "K"},     {"b", "K"}};
    struct dea_panel panels[DEA_PANELS];
    assert_int_equal(choose(signals, 7, panels), 4);
    static const char *const units[] = {"V", "A", "1", "K"};
    static const int counts[] = {2, 1, 2, 2};
    for (int i = 0; i < 4; i++) {
        assert_string_equal(panels[i].unit, units[i]);
        assert_int_equal(panels[i].curve_count, counts[i]);
    }
    assert_string_equal(panels[0].curves[1].label, "v(in)");
    assert_int_equal(choose(signals, 0, panels), 0);
}

static void crowds_are_cut_and_counted(void **state) {
    (void)state;
    struct dea_signal signals[40];
    for (int i = 0; i < 40; i++) {
        signals[i] = (struct dea_signal){.unit = "V"};
        snprintf(signals[i].name, sizeof signals[i].name, "a_rather_long_device_name_%d.left.voltage", i);
    }
    struct dea_panel panels[DEA_PANELS];
    assert_int_equal(choose(signals, 40, panels), 1);
    assert_int_equal(panels[0].curve_count, DEA_PANEL_CURVES);
    assert_int_equal(panels[0].left_out, 40 - DEA_PANEL_CURVES);
    assert_string_equal(panels[0].curves[0].label, "a_rather_long_device_nam...");
}

static void units_suit_the_values(void **state) {
    (void)state;
    static const struct {
        const char *si;
        double largest;
        const char *unit;
        double factor;
    } cases[] = {{"V", 3300, "kV", 1e-3},    {"m", 4.2e-4, "µm", 1e6}, {"m", 1e-3, "mm", 1e3},
                 {"V/m", 1e5, "V/µm", 1e-6}, {"J", 3e-5, "µJ", 1e6},   {"s", 0.4, "ms", 1e3},
                 {"s", 4000, "s", 1},        {"1", 1e-6, "", 1},       {"K", 1e6, "K", 1},
                 {"V", 0, "V", 1},           {"F", 1e-20, "fF", 1e15}, {"V", 1e12, "GV", 1e-9}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        char unit[32];
        double factor;
        dea_plot_unit(cases[i].si, cases[i].largest, unit, sizeof unit, &factor);
        assert_string_equal(unit, cases[i].unit);
        assert_true(fabs(factor / cases[i].factor - 1) < 1e-12);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(whole_run_has_the_four_main_panels),
        cmocka_unit_test(current_stands_in_for_energy),
        cmocka_unit_test(devices_are_told_apart),
        cmocka_unit_test(unknown_signals_are_drawn_by_unit),
        cmocka_unit_test(crowds_are_cut_and_counted),
        cmocka_unit_test(units_suit_the_values),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
