#include "deasim/quantity.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

/* Runs first: once the unit database has been read it is kept. */
static void names_a_missing_unit_database(void **state) {
    (void)state;
    struct dea_error error = {0};
    double value;
    setenv("UDUNITS2_XML_PATH", "/nonexistent/units.xml", 1);
    assert_int_equal(dea_quantity_parse("5 mV", "V", &value, &error), DEA_ERR_INPUT);
    unsetenv("UDUNITS2_XML_PATH");
    assert_string_equal(error.text, "the unit database /nonexistent/units.xml cannot be read (is the package "
                                    "libudunits2-data installed, and UDUNITS2_XML_PATH unset or right?)");
    assert_int_equal(dea_quantity_parse("5 V", "V", &value, &error), DEA_OK);
}

static void reads_field_units(void **state) {
    (void)state;
    static const struct {
        const char *text, *unit;
        double value;
    } cases[] = {
        {"33 um", "m", 33e-6},
        {"33um", "m", 33e-6},
        {"33 \u00b5m", "m", 33e-6},
        {"33 \u03bcm", "m", 33e-6},
        {"30 mm", "m", 30e-3},
        {"-3 mm", "m", -3e-3},
        {"+.5 m", "m", 0.5},
        {"3.3 kV", "V", 3300},
        {"3300 V", "V", 3300},
        {"3300", "V", 3300},
        {"4e3", "V", 4000},
        {"1e-3 kV", "V", 1},
        {"100 V/um", "V/m", 100e6},
        {"100 MV/m", "V/m", 100e6},
        {"100 kV/mm", "V/m", 100e6},
        {"100 V/\u00b5m", "V/m", 100e6},
        {"0.365 MPa", "Pa", 0.365e6},
        {"15.36 kPa", "Pa", 15360},
        {"1 GOhm", "Ohm", 1e9},
        {"1 MOhm", "Ohm", 1e6},
        {"2 kOhm", "Ohm", 2e3},
        {"7 Ohm", "Ohm", 7},
        {"7 \u03a9", "Ohm", 7},
        {"50 kOhm/sq", "Ohm/sq", 50e3},
        {"50 kOhm", "Ohm/sq", 50e3},
        {"5 mA", "A", 5e-3},
        {"5 uA", "A", 5e-6},
        {"0.428 g", "kg", 0.428e-3},
        {"428 mg", "kg", 428e-6},
        {"1120 kg/m^3", "kg/m^3", 1120},
        {"1.12 g/cm^3", "kg/m^3", 1120},
        {"1120 kg/m\u00b3", "kg/m^3", 1120},
        {"2 N s/m", "N s/m", 2},
        {"2 N*s/m", "N s/m", 2},
        {"2 kg/s", "N s/m", 2},
        {"50 Hz", "Hz", 50},
        {"50 1/s", "Hz", 50},
        {"2 kHz", "Hz", 2000},
        {"400 ms", "s", 0.4},
        {"0.1ms", "s", 0.1e-3},
        {"10 us", "s", 10e-6},
        {"10 ns", "s", 10e-9},
        {"2 min", "s", 120},
        {"1 h", "s", 3600},
        {"1e-12 S/m", "S/m", 1e-12},
        {"15 V/us", "V/s", 15e6},
        {"1e12 Ohm m", "Ohm m", 1e12},
        {"50 %", "1", 0.5},
        {"1.2", "1", 1.2},
        {"180 deg", "rad", 3.14159265358979323846},
        {"1 rad", "rad", 1},
        {" 5 V \n", "V", 5},
        {"5 mm", NULL, 5e-3},
        {"5 kV", NULL, 5000},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct dea_error error = {0};
        double value = NAN;
        enum dea_status status = dea_quantity_parse(cases[i].text, cases[i].unit, &value, &error);
        if (status != DEA_OK || !(fabs(value - cases[i].value) <= 2e-16 * fabs(cases[i].value)))
            fail_msg("'%s': status %d, value %.17g, expected %.17g, %s", cases[i].text, (int)status, value,
                     cases[i].value, error.text);
    }
}

static void refuses_what_is_not_meant(void **state) {
    (void)state;
    static const struct {
        const char *text, *unit, *message;
    } cases[] = {
        {"3300 mm", "V", "unit 'mm' is not that of a voltage; allowed: mV, V, kV"},
        {"1 M", "Ohm", "'M' alone is not a unit (a SPICE suffix is not read here); allowed: Ohm, kOhm, MOhm, GOhm"},
        {"1Meg", "Ohm", "'Meg' alone is not a unit (a SPICE suffix is not read here); allowed: Ohm, kOhm, MOhm, GOhm"},
        {"1 k", "Ohm", "'k' alone is not a unit (a SPICE suffix is not read here); allowed: Ohm, kOhm, MOhm, GOhm"},
        {"10 m", "s", "unit 'm' is not that of a time; allowed: ns, us, ms, s, min, h"},
        {"10 mS", "s", "unit 'mS' is not that of a time; allowed: ns, us, ms, s, min, h"},
        {"10 F", "m", "unit 'F' is not that of a length; allowed: um, mm, m"},
        {"10 u", "m", "unit 'u' is not that of a length; allowed: um, mm, m"},
        {"3.3 KV", "V", "unknown unit 'KV'; did you mean 'kV'? allowed: mV, V, kV"},
        {"1 Ns/m", "N s/m", "unknown unit 'Ns/m'; did you mean 'N s/m'? allowed: N s/m, mN s/m, kg/s"},
        {"10 ms", "Hz", "unit 'ms' is not that of a frequency; allowed: mHz, Hz, kHz, MHz"},
        {"60 rpm", "Hz", "unit 'rpm' is not that of a frequency; allowed: mHz, Hz, kHz, MHz"},
        {"10 rad", "1", "unit 'rad' is not that of a number; allowed: no unit, or %"},
        {"3 300 V", "V", "unknown unit '300 V'; allowed: mV, V, kV"},
        {"5 2 V", "V", "unknown unit '2 V'; allowed: mV, V, kV"},
        {"3,3 kV", "V", "'3,3 kV': ',' is not allowed in a number; use a decimal point"},
        {"3_300 V", "V", "'3_300 V': '_' is not allowed in a number; use a decimal point"},
        {"1.2.3 V", "V", "unknown unit '.3 V'; allowed: mV, V, kV"},
        {"5 V @ 3", "V", "unknown unit 'V @ 3'; allowed: mV, V, kV"},
        {"5 V from 3", "V", "unknown unit 'V from 3'; allowed: mV, V, kV"},
        {"5 s since 2000", "s", "unknown unit 's since 2000'; allowed: ns, us, ms, s, min, h"},
        {"5 lg(re 1 V)", "V", "unknown unit 'lg(re 1 V)'; allowed: mV, V, kV"},
        {"5 V)", "V", "unknown unit 'V)'; allowed: mV, V, kV"},
        {"5 V^0.5", "V", "unknown unit 'V^0.5'; allowed: mV, V, kV"},
        {"5 V 3", "V", "unknown unit 'V 3'; allowed: mV, V, kV"},
        {"5 V^", "V", "unknown unit 'V^'; allowed: mV, V, kV"},
        {"5 /V", "V", "unknown unit '/V'; allowed: mV, V, kV"},
        {"5 V/", "V", "unknown unit 'V/'; allowed: mV, V, kV"},
        {"5 V; rm", "V", "unknown unit 'V; rm'; allowed: mV, V, kV"},
        {"5 \xff\xfe", "V", "unknown unit '\xff\xfe'; allowed: mV, V, kV"},
        {"nan", "V", "'nan' is not a finite number"},
        {"-inf V", "V", "'-inf V' is not a finite number"},
        {"Infinity", "V", "'Infinity' is not a finite number"},
        {".inf", "V", "'.inf' is not a number with a unit"},
        {"1e999 V", "V", "'1e999 V' is too large a number"},
        {"1e308 kV", "V", "'1e308 kV' is too large a number"},
        {"0x10 V", "V", "'0x10 V' is not a number with a unit"},
        {"V", "V", "'V' is not a number with a unit"},
        {"--5 V", "V", "'--5 V' is not a number with a unit"},
        {"", "V", "a number is missing"},
        {"   ", "V", "a number is missing"},
        {".", "V", "'.' is not a number with a unit"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct dea_error error = {0};
        double value = 42;
        enum dea_status status = dea_quantity_parse(cases[i].text, cases[i].unit, &value, &error);
        if (status != DEA_ERR_INPUT || value != 42 || strcmp(error.text, cases[i].message) != 0)
            fail_msg("'%s': status %d, value %g\n got      %s\n expected %s", cases[i].text, (int)status, value,
                     error.text, cases[i].message);
    }
}

static void refuses_endless_text(void **state) {
    (void)state;
    char text[5000];
    struct dea_error error;
    double value;
    memset(text, '9', sizeof text);
    text[sizeof text - 1] = '\0';
    assert_int_equal(dea_quantity_parse(text, "V", &value, &error), DEA_ERR_INPUT);
    memset(text + 1, 'V', 200);
    text[201] = '\0';
    assert_int_equal(dea_quantity_parse(text, "V", &value, &error), DEA_ERR_INPUT);
    assert_non_null(strstr(error.text, "unknown unit 'VVVV"));
}

static void prints_readable_prefixes(void **state) {
    (void)state;
    static const struct {
        double value;
        const char *unit, *text;
    } cases[] = {
        {0.0033, "m", "3.3 mm"},
        {33e-6, "m", "33 um"},
        {30, "m", "30 m"},
        {100e6, "V/m", "100 MV/m"},
        {0.428e-3, "kg", "428 mg"},
        {1, "kg", "1 kg"},
        {1120, "kg/m^3", "1120 kg/m^3"},
        {4000, "s", "4000 s"},
        {0.4, "s", "400 ms"},
        {1.2, "1", "1.2"},
        {1e-9, "1", "1e-09"},
        {0, "V", "0 V"},
        {-3300, "V", "-3.3 kV"},
        {0.99999e-3, "m", "1 mm"},
        {1e30, "V", "1e+30 V"},
        {INFINITY, "V", "inf V"},
        {80.5e-12, "F", "80.5 pF"},
        {50e3, "Ohm/sq", "50 kOhm/sq"},
        {2, "1/s", "2 1/s"},
        {1e-25, "S/m", "1e-25 S/m"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        char buffer[64];
        assert_string_equal(dea_quantity_format(cases[i].value, cases[i].unit, buffer, sizeof buffer), cases[i].text);
    }
    char tiny[4];
    assert_string_equal(dea_quantity_format(0.0033, "m", tiny, sizeof tiny), "3.3");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(names_a_missing_unit_database), cmocka_unit_test(reads_field_units),
        cmocka_unit_test(refuses_what_is_not_meant),     cmocka_unit_test(refuses_endless_text),
        cmocka_unit_test(prints_readable_prefixes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
