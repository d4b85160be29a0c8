/* Every row of the reference table of the static model, through the library. Its header says where it comes from and
 * the units; it carries ten digits, so 1e-8 is asked, relative to the value or to a scale where the value is zero. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "deasim/design.h"

#define TOLERANCE 1e-8
#define WIDTH 30e-3

struct row {
    int id;
    char kind[8], mode[16];
    double mu, jm, permittivity, breakdown, lp1, lp2, ratio, thickness, length; /* SI */
    double voltage, field, lam_active, lam_passive, stretch, d;
    double stress[2][2]; /* [zone][direction], Pa */
    double capacitance;  /* per width, F/m */
    double stretch_max, d_max, voltage_max, field_max;
};

static bool parse_row(char *line, struct row *row) {
    double v[32];
    char *text[32];
    int count = 0;
    for (char *cell = strtok(line, ",\n"); cell != NULL && count < 32; cell = strtok(NULL, ",\n"), count++) {
        text[count] = cell;
        v[count] = strtod(cell, NULL);
    }
    if (count != 28 || v[0] == 0.0)
        return false;
    *row = (struct row){.id = (int)v[0],
                        .mu = v[2] * 1e6,
                        .jm = v[3],
                        .permittivity = v[4],
                        .breakdown = v[5] * 1e6,
                        .lp1 = v[6],
                        .lp2 = v[7],
                        .ratio = v[8],
                        .thickness = v[9] * 1e-6,
                        .length = v[10] * 1e-3,
                        .voltage = v[11],
                        .field = v[12] * 1e6,
                        .lam_active = v[13],
                        .lam_passive = v[14],
                        .stretch = v[15],
                        .d = v[16],
                        .stress = {{v[17] * 1e6, v[18] * 1e6}, {v[19] * 1e6, v[20] * 1e6}},
                        .capacitance = v[21] * 1e-9,
                        .stretch_max = v[23],
                        .d_max = v[24],
                        .voltage_max = v[25],
                        .field_max = v[26] * 1e6};
    snprintf(row->kind, sizeof row->kind, "%s", text[1]);
    snprintf(row->mode, sizeof row->mode, "%s", text[22]);
    return true;
}

static struct dea_device build_device(const struct row *row) {
    struct dea_device device = {.width = WIDTH, .thickness = row->thickness, .prestretch = {row->lp1, row->lp2}};
    device.material.elastic = (struct dea_law){.kind = DEA_GENT, .mu = row->mu, .jm = row->jm};
    device.material.dielectric =
        (struct dea_dielectric){.permittivity = row->permittivity, .breakdown = row->breakdown};
    device.material.density = 1120.0;
    device.zones[0] = (struct dea_zone){.present = true, .electroded = true, .length = row->ratio * row->length};
    device.zones[1] = (struct dea_zone){.present = true, .length = (1.0 - row->ratio) * row->length};
    assert_int_equal(dea_device_prepare(&device, NULL), DEA_OK);
    return device;
}

static void near(const struct row *row, const char *what, double ours, double expected, double scale) {
    if (fabs(ours - expected) <= TOLERANCE * fmax(fabs(expected), scale))
        return;
    print_error("row %d, %s: %.12g, expected %.12g\n", row->id, what, ours, expected);
    fail();
}

static void check_point(const struct row *row, const struct dea_static_point *point) {
    double active = row->ratio * row->length;
    near(row, "l1a", point->zones[0].stretch, row->lam_active, 0.0);
    near(row, "l1p", point->zones[1].stretch, row->lam_passive, 0.0);
    near(row, "d", point->x / row->length, row->d, 1e-3);
    near(row, "actuation stretch", 1.0 + point->x / active, row->stretch, 0.0);
    near(row, "field", point->zones[0].true_field, row->field, 1e6);
    for (int zone = 0; zone < 2; zone++) {
        double at_rest = fmax(fabs(row->stress[zone][0]), fabs(row->stress[zone][1]));
        near(row, "stress1", point->zones[zone].stress1, row->stress[zone][0], at_rest);
        near(row, "stress2", point->zones[zone].stress2, row->stress[zone][1], at_rest);
    }
    near(row, "capacitance", point->zones[0].capacitance / WIDTH, row->capacitance, 0.0);
    assert_true(point->stable);
}

static void check_row(const struct row *row) {
    static const struct {
        const char *name;
        enum dea_limit_mode mode;
    } modes[] = {{"BD", DEA_LIMIT_BREAKDOWN},
                 {"LT1", DEA_LIMIT_SLACK1},
                 {"LT2", DEA_LIMIT_SLACK2},
                 {"PRE_LT1", DEA_LIMIT_PRESTRETCH},
                 {"PRE_RUPT", DEA_LIMIT_PRESTRETCH}};
    struct dea_device device = build_device(row);
    struct dea_limit limit;
    assert_int_equal(dea_static_limit(&device, 0.0, &limit, NULL), DEA_OK);
    bool known = false;
    for (size_t i = 0; i < sizeof modes / sizeof modes[0]; i++)
        if (strcmp(row->mode, modes[i].name) == 0) {
            assert_int_equal(limit.mode, modes[i].mode);
            known = true;
        }
    assert_true(known);

    struct dea_static_point point;
    double voltages[DEA_ZONES] = {row->voltage, 0.0};
    if (limit.mode == DEA_LIMIT_PRESTRETCH) {
        assert_true(isnan(limit.voltage) && isnan(limit.x) && isnan(limit.stretch) && isnan(limit.true_field));
        device.slack = false;
        if (strcmp(row->mode, "PRE_RUPT") == 0)
            assert_int_equal(dea_static_solve(&device, voltages, &point, NULL), DEA_ERR_SOLVER);
        else {
            assert_int_equal(dea_static_solve(&device, voltages, &point, NULL), DEA_OK);
            check_point(row, &point);
        }
        return;
    }
    near(row, "largest stretch", limit.stretch, row->stretch_max, 0.0);
    near(row, "largest d", limit.x / row->length, row->d_max, 0.0);
    near(row, "largest voltage", limit.voltage, row->voltage_max, 0.0);
    near(row, "largest field", limit.true_field, row->field_max, 0.0);

    /* the state: with the regime of slack and without, by voltage and by field */
    if (strcmp(row->kind, "MAX") == 0)
        voltages[0] = limit.voltage;
    for (int slack = 0; slack < 2; slack++) {
        device.slack = slack == 1;
        assert_int_equal(dea_static_solve(&device, voltages, &point, NULL), DEA_OK);
        check_point(row, &point);
        double field = point.zones[0].true_field;
        assert_int_equal(dea_static_solve_field(&device, field, 0.0, &point, NULL), DEA_OK);
        check_point(row, &point);
        near(row, "voltage of a field", point.zones[0].voltage, voltages[0], 0.0);
    }
}

static void every_reference_row_is_reproduced(void **state) {
    (void)state;
    FILE *file = fopen(TEST_DATA "/static.csv", "r");
    assert_non_null(file);
    char line[1024];
    int rows = 0;
    while (fgets(line, sizeof line, file) != NULL) {
        struct row row;
        if (line[0] == '#' || !parse_row(line, &row))
            continue;
        check_row(&row);
        rows++;
    }
    fclose(file);
    assert_int_equal(rows, 116);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_reference_row_is_reproduced),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
