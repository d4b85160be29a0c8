/* The design that `map` and `optimum` start from. */
#include "cli/design_options.h"

#include "deasim/quantity.h"
#include "deasim/scene.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum dea_status cli_find_design_key(const char *option, const char *name, enum dea_design_key *key,
                                    struct dea_error *error) {
    *key = dea_design_key_find(name);
    if (*key == DEA_KEY_COUNT)
        return dea_fail(error, DEA_ERR_INPUT,
                        "%s: unknown parameter \"%s\"; r_a, lp1, lp2, E_bd, Jm, mu, eps_r and t0 are allowed", option,
                        name);
    return DEA_OK;
}

enum dea_status cli_check_design_value(const char *option, enum dea_design_key key, double value,
                                       struct dea_error *error) {
    /* those of device and material files */
    static const struct {
        double least, most;
    } ranges[DEA_KEY_COUNT] = {
        [DEA_KEY_ACTIVE_RATIO] = {0.0, INFINITY},
        [DEA_KEY_PRESTRETCH1] = {0.05, 20.0},
        [DEA_KEY_PRESTRETCH2] = {0.05, 20.0},
        [DEA_KEY_BREAKDOWN] = {1e5, 1e11},
        [DEA_KEY_JM] = {1e-3, 1e9},
        [DEA_KEY_MODULUS] = {100.0, 1e9},
        [DEA_KEY_PERMITTIVITY] = {0.1, 1e5},
        [DEA_KEY_THICKNESS] = {1e-8, 1e-2},
    };
    if (!(value > 0.0) || (value >= ranges[key].least && value <= ranges[key].most))
        return DEA_OK;
    const struct dea_design_key_info *info = &dea_design_keys[key];
    return dea_fail(error, DEA_ERR_INPUT, "%s %s: %g%s%s is outside %g .. %g; is the unit right?", option, info->name,
                    value * info->factor, info->unit[0] != '\0' ? " " : "", info->unit,
                    ranges[key].least * info->factor, ranges[key].most * info->factor);
}

enum dea_status cli_parse_design_range(const char *option, enum dea_design_key key, const char *text,
                                       struct dea_range *range, struct dea_error *error) {
    char label[64];
    snprintf(label, sizeof label, "%s %s", option, dea_design_keys[key].name);
    DEA_TRY(dea_range_parse(label, text, dea_design_keys[key].si_unit, range, error));
    DEA_TRY(cli_check_design_value(option, key, range->first, error));
    return cli_check_design_value(option, key, range->last, error);
}

enum dea_status cli_parse_design_span(const char *option, enum dea_design_key key, const char *text,
                                      struct dea_range *range, struct dea_error *error) {
    char counted[200];
    const char *colon = strchr(text, ':');
    if (colon == NULL || strchr(colon + 1, ':') != NULL || strlen(text) + 3 > sizeof counted)
        return dea_fail(error, DEA_ERR_INPUT, "%s %s=%s: write %s=FIRST:LAST", option, dea_design_keys[key].name, text,
                        dea_design_keys[key].name);
    snprintf(counted, sizeof counted, "%s:2", text);
    return cli_parse_design_range(option, key, counted, range, error);
}

static enum dea_status parse_set(const char *text, struct cli_design_options *options, struct dea_error *error) {
    const char *equals = strchr(text, '=');
    char name[32];
    if (equals == NULL || (size_t)(equals - text) >= sizeof name)
        return dea_fail(error, DEA_ERR_INPUT, "--set %s: write parameter=value, for example --set lp2=2", text);
    if (options->set_count == CLI_DESIGN_MAX_SETS)
        return dea_fail(error, DEA_ERR_INPUT, "--set: more than %d parameters", CLI_DESIGN_MAX_SETS);
    snprintf(name, sizeof name, "%.*s", (int)(equals - text), text);
    enum dea_design_key key;
    double value;
    struct dea_error inner;
    DEA_TRY(cli_find_design_key("--set", name, &key, error));
    if (dea_quantity_parse(equals + 1, dea_design_keys[key].si_unit, &value, &inner) != DEA_OK)
        return dea_fail(error, DEA_ERR_INPUT, "--set %s: %s", name, inner.text);
    DEA_TRY(cli_check_design_value("--set", key, value, error));
    options->sets[options->set_count].key = key;
    options->sets[options->set_count++].value = value;
    return DEA_OK;
}

static enum dea_status parse_max_voltage(const char *text, double *voltage, struct dea_error *error) {
    struct dea_error inner;
    if (dea_quantity_parse(text, "V", voltage, &inner) != DEA_OK)
        return dea_fail(error, DEA_ERR_INPUT, "--max-voltage: %s", inner.text);
    if (!(*voltage > 0.0))
        return dea_fail(error, DEA_ERR_INPUT, "--max-voltage %s: must be positive", text);
    return DEA_OK;
}

enum dea_status cli_parse_design_option(int letter, struct cli_design_options *options, struct dea_error *error) {
    switch (letter) {
    case CLI_DESIGN_SET:
        return parse_set(optarg, options, error);
    case CLI_DESIGN_DEAD_LOAD:
        options->dead_load = true;
        return DEA_OK;
    case CLI_DESIGN_MAX_VOLTAGE:
        return parse_max_voltage(optarg, &options->max_voltage, error);
    default:
        return dea_fail(error, DEA_ERR_INTERNAL, "option %d has no meaning", letter);
    }
}

/* The device measured in the paper: 4 mm + 4 mm by 30 mm, PMMA platform of 0.428 g. */
static enum dea_status make_paper_device(const struct dea_design *design, struct dea_device *device,
                                         struct dea_error *error) {
    DEA_TRY(dea_design_to_device(design, 30e-3, 8e-3, false, device, error));
    device->platform_mass = 0.428e-3;
    device->material.density = 1120.0;
    device->membrane_mass = true;
    return dea_device_prepare(device, error);
}

static enum dea_status read_design(const char *path, struct dea_design *design, struct dea_device *device,
                                   struct dea_error *error) {
    DEA_TRY(dea_device_read(path, NULL, 0, device, error));
    return dea_design_from_device(device, design, error);
}

enum dea_status cli_finish_design(int argc, char **argv, const struct cli_design_options *options,
                                  struct dea_design *design, struct dea_device *device, struct dea_error *error) {
    struct dea_device own = {0};
    struct dea_device *target = device != NULL ? device : &own;
    if (optind + 1 < argc)
        return dea_fail(error, DEA_ERR_INPUT, "\"%s\" is one argument too many", argv[optind + 1]);
    *design = dea_design_of_paper();
    enum dea_status status =
        optind < argc ? read_design(argv[optind], design, target, error) : make_paper_device(design, target, error);
    dea_device_clear(&own);
    DEA_TRY(status);
    for (int i = 0; i < options->set_count; i++)
        DEA_TRY(dea_design_set(design, options->sets[i].key, options->sets[i].value, error));
    design->dead_load = design->dead_load || options->dead_load;
    if (options->max_voltage > 0.0)
        design->max_voltage = options->max_voltage;
    struct dea_design_end end;
    return dea_design_limit(design, &end, error);
}
