/* Table, CSV and JSON of `deasim static`. */
#include "cli/static_print.h"

#include "cli/json.h"

#include <math.h>
#include <stdio.h>

#define SI_TO_KV 1e-3
#define SI_TO_MICRO 1e6
#define SI_TO_MEGA 1e-6
#define SI_TO_MILLI 1e3
#define SI_TO_PICO 1e12

/* ---- table ---- */

static const char *const limit_sentences[DEA_LIMIT_COUNT] = {
    [DEA_LIMIT_NONE] = "none: the device does not fail statically",
    [DEA_LIMIT_BREAKDOWN] = "dielectric breakdown",
    [DEA_LIMIT_SLACK1] = "loss of tension along the motion (slack1)",
    [DEA_LIMIT_SLACK2] = "loss of tension across the motion (slack2)",
    [DEA_LIMIT_LAW] = "limit of the elastic law (gent)",
    [DEA_LIMIT_PRESTRETCH] = "before any voltage",
    [DEA_LIMIT_INSTABILITY] = "electromechanical instability, the voltage turns over",
    [DEA_LIMIT_SUPPLY] = "the supply's largest voltage",
};

static void print_table_head(const struct dea_device *device) {
    printf("%9s %10s", "", "");
    for (int k = 0; k < DEA_ZONES; k++) {
        if (!device->zones[k].present)
            continue;
        bool electroded = device->zones[k].electroded, last = k == DEA_ZONES - 1;
        printf("  | %-*s", last ? 0 : electroded ? 53 : 34, k == 0 ? "left" : electroded ? "right" : "right (passive)");
    }
    printf("\n%9s %10s", "V [kV]", "x [um]");
    for (int k = 0; k < DEA_ZONES; k++) {
        if (!device->zones[k].present)
            continue;
        printf("  | %8s", "lam1");
        if (device->zones[k].electroded)
            printf(" %8s %9s", "E[V/um]", "C[pF]");
        printf(" %8s %8s %7s", "s1[MPa]", "s2[MPa]", "T[mN]");
    }
    putchar('\n');
}

static void print_table_row(const struct dea_device *device, const struct static_row *row) {
    if (!row->solved) {
        printf("%9.4f %10s  | no equilibrium\n", row->voltage * SI_TO_KV, "-");
        return;
    }
    printf("%9.4f %10.3f", row->voltage * SI_TO_KV, row->point.x * SI_TO_MICRO);
    bool slack = false;
    for (int k = 0; k < DEA_ZONES; k++) {
        const struct dea_static_zone *zone = &row->point.zones[k];
        if (!device->zones[k].present)
            continue;
        printf("  | %8.5f", zone->stretch);
        if (device->zones[k].electroded)
            printf(" %8.3f %9.3f", zone->true_field * SI_TO_MEGA, zone->capacitance * SI_TO_PICO);
        printf(" %8.5f %8.5f %7.1f", zone->stress1 * SI_TO_MEGA, zone->stress2 * SI_TO_MEGA,
               zone->tension * SI_TO_MILLI);
        slack = slack || zone->slack;
    }
    printf("%s%s%s\n", row->beyond ? "  beyond" : "", slack ? "  slack" : "", row->point.stable ? "" : "  unstable");
}

void static_print_table(const struct static_answer *answer) {
    const struct dea_device *device = answer->device;
    printf("%s: t0 %g um, prestretch %g x %g", answer->path, device->thickness * SI_TO_MICRO, device->prestretch[0],
           device->prestretch[1]);
    if (answer->right_voltage != 0.0)
        printf(", right zone at %g kV", answer->right_voltage * SI_TO_KV);
    printf("\n\n");
    print_table_head(device);
    for (int i = 0; i < answer->count; i++)
        print_table_row(device, &answer->rows[i]);

    const struct dea_limit *limit = &answer->limit;
    printf("\nFirst failure of the left drive: %s\n", limit_sentences[limit->mode]);
    if (!isnan(limit->voltage))
        printf("  at %.4f kV, x %.3f um, stretch lam1/lp1 %.6f, true field %.3f V/um\n", limit->voltage * SI_TO_KV,
               limit->x * SI_TO_MICRO, limit->stretch, limit->true_field * SI_TO_MEGA);
    const char *why;
    if (limit->mode == DEA_LIMIT_PRESTRETCH && dea_prestretch_fails(device, &why))
        printf("  %s\n", why);
}

/* ---- CSV ---- */

void static_print_csv(const struct static_answer *answer) {
    const struct dea_device *device = answer->device;
    printf("voltage [V],x [m]");
    for (int k = 0; k < DEA_ZONES; k++) {
        const char *name = dea_zone_names[k];
        if (device->zones[k].present)
            printf(",%s.stretch [1],%s.true_field [V/m],%s.stress1 [Pa],%s.stress2 [Pa],%s.tension [N],"
                   "%s.capacitance [F]",
                   name, name, name, name, name, name);
    }
    printf(",stable [1],beyond [1]\n");
    for (int i = 0; i < answer->count; i++) {
        const struct static_row *row = &answer->rows[i];
        printf("%.17g,%.17g", row->voltage, row->solved ? row->point.x : NAN);
        for (int k = 0; k < DEA_ZONES; k++) {
            const struct dea_static_zone *zone = &row->point.zones[k];
            if (device->zones[k].present && row->solved)
                printf(",%.17g,%.17g,%.17g,%.17g,%.17g,%.17g", zone->stretch, zone->true_field, zone->stress1,
                       zone->stress2, zone->tension, zone->capacitance);
            else if (device->zones[k].present)
                printf(",nan,nan,nan,nan,nan,nan");
        }
        printf(",%d,%d\n", row->solved && row->point.stable, row->beyond);
    }
}

/* ---- JSON ---- */

static bool add_zone(cJSON *zones, int zone, const struct dea_static_zone *values) {
    cJSON *object = cJSON_AddObjectToObject(zones, dea_zone_names[zone]);
    return object != NULL && cli_json_number(object, "stretch", values->stretch) &&
           cli_json_number(object, "true_field", values->true_field) &&
           cli_json_number(object, "stress1", values->stress1) && cli_json_number(object, "stress2", values->stress2) &&
           cli_json_number(object, "tension", values->tension) &&
           cli_json_number(object, "capacitance", values->capacitance);
}

static bool add_row(cJSON *points, const struct dea_device *device, const struct static_row *row) {
    cJSON *object = cJSON_CreateObject();
    if (object == NULL || !cJSON_AddItemToArray(points, object))
        return false;
    if (!cli_json_number(object, "voltage", row->voltage) ||
        !cli_json_number(object, "x", row->solved ? row->point.x : NAN))
        return false;
    if (row->solved) {
        cJSON *zones = cJSON_AddObjectToObject(object, "zones");
        if (zones == NULL)
            return false;
        for (int k = 0; k < DEA_ZONES; k++)
            if (device->zones[k].present && !add_zone(zones, k, &row->point.zones[k]))
                return false;
    } else if (cJSON_AddNullToObject(object, "zones") == NULL) {
        return false;
    }
    return cJSON_AddBoolToObject(object, "stable", row->solved && row->point.stable) != NULL &&
           cJSON_AddBoolToObject(object, "beyond", row->beyond) != NULL;
}

static bool fill_json(cJSON *root, const struct static_answer *answer) {
    cJSON *points = cJSON_AddArrayToObject(root, "points");
    if (points == NULL)
        return false;
    for (int i = 0; i < answer->count; i++)
        if (!add_row(points, answer->device, &answer->rows[i]))
            return false;
    const struct dea_limit *limit = &answer->limit;
    cJSON *object = cJSON_AddObjectToObject(root, "limit");
    return object != NULL && cJSON_AddStringToObject(object, "mode", dea_limit_names[limit->mode]) != NULL &&
           cli_json_number(object, "voltage", limit->voltage) && cli_json_number(object, "x", limit->x) &&
           cli_json_number(object, "stretch", limit->stretch) &&
           cli_json_number(object, "true_field", limit->true_field);
}

enum dea_status static_print_json(const struct static_answer *answer, struct dea_error *error) {
    cJSON *root = cJSON_CreateObject();
    return cli_json_print(root, root != NULL && fill_json(root, answer), error);
}
