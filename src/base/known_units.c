/* The units scenes are written in. */
#include "base/known_units.h"

#include <string.h>

const struct known_unit known_units[] = {
    {"m", "m", 1},         {"mm", "m", 1e-3},     {"um", "m", 1e-6},       {"s", "s", 1},         {"ms", "s", 1e-3},
    {"us", "s", 1e-6},     {"ns", "s", 1e-9},     {"V", "V", 1},           {"kV", "V", 1e3},      {"V/um", "V/m", 1e6},
    {"MV/m", "V/m", 1e6},  {"V/m", "V/m", 1},     {"Pa", "Pa", 1},         {"kPa", "Pa", 1e3},    {"MPa", "Pa", 1e6},
    {"g", "kg", 1e-3},     {"kg", "kg", 1},       {"kg/m^3", "kg/m^3", 1}, {"Ohm", "Ohm", 1},     {"kOhm", "Ohm", 1e3},
    {"MOhm", "Ohm", 1e6},  {"GOhm", "Ohm", 1e9},  {"nA", "A", 1e-9},       {"uA", "A", 1e-6},     {"mA", "A", 1e-3},
    {"A", "A", 1},         {"pF", "F", 1e-12},    {"nF", "F", 1e-9},       {"nC", "C", 1e-9},     {"uJ", "J", 1e-6},
    {"mJ", "J", 1e-3},     {"N", "N", 1},         {"mN", "N", 1e-3},       {"N s/m", "N s/m", 1}, {"S/m", "S/m", 1},
    {"nS/m", "S/m", 1e-9}, {"V/us", "V/s", 1e6},  {"V/ms", "V/s", 1e3},    {"Hz", "Hz", 1},       {"kHz", "Hz", 1e3},
    {"m/s", "m/s", 1},     {"mm/s", "m/s", 1e-3}, {"%", "1", 1e-2},
};

const size_t known_unit_count = sizeof known_units / sizeof known_units[0];

const struct known_unit *find_known_unit(const char *text, const char *si_unit) {
    for (size_t i = 0; i < known_unit_count; i++)
        if (strcmp(known_units[i].text, text) == 0 && (si_unit == NULL || strcmp(known_units[i].si_unit, si_unit) == 0))
            return &known_units[i];
    return NULL;
}
