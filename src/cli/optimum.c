/* deasim optimum: the design that moves its platform farthest. */
#include "cli/arguments.h"
#include "cli/cli.h"
#include "cli/design_options.h"
#include "cli/optimum_print.h"
#include "cli/range.h"

#include "deasim/quantity.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
    OPTION_FREE = 256,
    OPTION_PURE_SHEAR,
    OPTION_BOTH_WAYS,
    OPTION_TENSION,
    OPTION_COMPARE,
    OPTION_OVER,
    OPTION_DYNAMIC,
    OPTION_JSON
};

static const char usage[] =
    "usage: deasim optimum [DEVICE] [--free PARAMETERS] [options]\n"
    "\n"
    "Finds the design with the largest displacement relative to the length of both membranes, before its first\n"
    "failure. Starts from the device file DEVICE, or from the paper's design (Sylgard 186, t0 25 um, lp2 2, r_a 0.5).\n"
    "\n"
    "      --free LIST        what may be chosen: any of r_a, lp1, lp2, t0, with a range if wanted, for example\n"
    "                         r_a,lp1=0.9:1.2; \"none\" evaluates the given design. Default: r_a,lp1\n"
    "      --set P=VALUE      r_a, lp1, lp2, E_bd, Jm, mu, eps_r or t0; may be repeated\n"
    "      --pure-shear       lp1 = 1, not free: one dimension is kept while prestretching\n"
    "      --both-ways        electrodes on both membranes, driven in turn; the whole stroke counts\n"
    "      --dead-load        a constant force instead of the passive membrane\n"
    "      --min-tension S    stress along the motion that must be left, for example 50 kPa\n"
    "      --max-voltage V    the supply ends there (with t0 free: the thickest film it can drive to the end)\n"
    "      --over P=A:B:N     repeats everything over a parameter, one line each\n"
    "      --compare          adds the dead load and the bidirectional device, each at its own optimum\n"
    "      --dynamic          adds what a voltage step and a ramp of one natural period do to it, and the largest\n"
    "                         voltages that can be switched on so (platform and branches from DEVICE, or the paper's\n"
    "                         4 + 4 mm by 30 mm with 0.428 g and no branches)\n"
    "      --json             one JSON object, SI units\n"
    "  -h, --help             this text\n"
    "\n"
    "examples: deasim optimum --compare\n"
    "          deasim optimum --free lp1,lp2 --over Jm=5:30:6\n";

struct optimum_options {
    struct cli_design_options design;
    struct dea_optimum_task task;
    const char *free_list, *over;
    struct dea_device device; /* the film's surroundings, for --dynamic */
    bool pure_shear, compare, dynamic, json;
    double least_tension;
};

/* One entry of --free: "lp1" or "lp1=0.9:1.2". */
static enum dea_status free_key(char *entry, struct dea_optimum_task *task, struct dea_error *error) {
    char *equals = strchr(entry, '=');
    enum dea_design_key key;
    if (equals != NULL)
        *equals = '\0';
    DEA_TRY(cli_find_design_key("--free", entry, &key, error));
    task->keys[key].free = true;
    if (equals == NULL)
        return DEA_OK;
    struct dea_range range;
    DEA_TRY(cli_parse_design_span("--free", key, equals + 1, &range, error));
    task->keys[key].ranged = true;
    task->keys[key].low = range.first;
    task->keys[key].high = range.last;
    return DEA_OK;
}

static enum dea_status parse_free(const char *list, struct dea_optimum_task *task, struct dea_error *error) {
    char copy[512];
    if (strcmp(list, "none") == 0)
        return DEA_OK;
    if (snprintf(copy, sizeof copy, "%s", list) >= (int)sizeof copy)
        return dea_fail(error, DEA_ERR_INPUT, "--free: the list is too long");
    char *rest = copy;
    for (char *entry; (entry = strsep(&rest, ",")) != NULL;)
        DEA_TRY(free_key(entry, task, error));
    return DEA_OK;
}

static enum dea_status parse_tension(const char *text, double *tension, struct dea_error *error) {
    struct dea_error inner;
    if (dea_quantity_parse(text, "Pa", tension, &inner) != DEA_OK)
        return dea_fail(error, DEA_ERR_INPUT, "--min-tension: %s", inner.text);
    if (!(*tension >= 0.0))
        return dea_fail(error, DEA_ERR_INPUT, "--min-tension %s: must not be negative", text);
    return DEA_OK;
}

static enum dea_status take_option(int letter, void *context, struct dea_error *error) {
    struct optimum_options *options = context;
    switch (letter) {
    case OPTION_FREE:
        options->free_list = optarg;
        return DEA_OK;
    case OPTION_PURE_SHEAR:
        options->pure_shear = true;
        return DEA_OK;
    case OPTION_BOTH_WAYS:
        options->task.both_ways = true;
        return DEA_OK;
    case OPTION_TENSION:
        return parse_tension(optarg, &options->least_tension, error);
    case OPTION_COMPARE:
        options->compare = true;
        return DEA_OK;
    case OPTION_DYNAMIC:
        options->dynamic = true;
        return DEA_OK;
    case OPTION_OVER:
        options->over = optarg;
        return DEA_OK;
    case OPTION_JSON:
        options->json = true;
        return DEA_OK;
    default:
        return cli_parse_design_option(letter, &options->design, error);
    }
}

static enum dea_status finish_options(int argc, char **argv, struct optimum_options *options, struct dea_error *error) {
    struct dea_optimum_task *task = &options->task;
    DEA_TRY(cli_finish_design(argc, argv, &options->design, &task->base, &options->device, error));
    task->base.least_tension = options->least_tension;
    const char *usual = task->base.dead_load ? "lp1" : task->both_ways ? "lp1" : "r_a,lp1";
    DEA_TRY(parse_free(options->free_list != NULL ? options->free_list : usual, task, error));
    if (options->pure_shear) {
        if (options->free_list != NULL && task->keys[DEA_KEY_PRESTRETCH1].free)
            return dea_fail(error, DEA_ERR_INPUT, "with --pure-shear lp1 is 1 and cannot be free");
        task->keys[DEA_KEY_PRESTRETCH1].free = false;
        task->base.prestretch[0] = 1.0;
    }
    if (options->over != NULL && (options->compare || options->dynamic))
        return dea_fail(error, DEA_ERR_INPUT, "--over goes neither with --compare nor with --dynamic");
    return DEA_OK;
}

static enum dea_status parse_options(int argc, char **argv, struct optimum_options *options, struct dea_error *error) {
    static const struct option known[] = {CLI_DESIGN_LONG_OPTIONS,
                                          {"free", required_argument, NULL, OPTION_FREE},
                                          {"pure-shear", no_argument, NULL, OPTION_PURE_SHEAR},
                                          {"both-ways", no_argument, NULL, OPTION_BOTH_WAYS},
                                          {"min-tension", required_argument, NULL, OPTION_TENSION},
                                          {"compare", no_argument, NULL, OPTION_COMPARE},
                                          {"dynamic", no_argument, NULL, OPTION_DYNAMIC},
                                          {"over", required_argument, NULL, OPTION_OVER},
                                          {"json", no_argument, NULL, OPTION_JSON},
                                          {"help", no_argument, NULL, 'h'},
                                          {NULL, 0, NULL, 0}};
    DEA_TRY(cli_walk_options(argc, argv, usage, known, take_option, options, error));
    return finish_options(argc, argv, options, error);
}

/* ---- answers ---- */

static enum dea_status answer_over(const struct optimum_options *options, struct dea_error *error) {
    const char *equals = strchr(options->over, '=');
    char name[32];
    if (equals == NULL || (size_t)(equals - options->over) >= sizeof name)
        return dea_fail(error, DEA_ERR_INPUT, "--over %s: write PARAMETER=FIRST:LAST:POINTS, for example Jm=5:30:6",
                        options->over);
    snprintf(name, sizeof name, "%.*s", (int)(equals - options->over), options->over);
    struct optimum_sweep sweep;
    DEA_TRY(cli_find_design_key("--over", name, &sweep.key, error));
    if (options->task.keys[sweep.key].free)
        return dea_fail(error, DEA_ERR_INPUT, "--over %s: it cannot be free as well", name);
    DEA_TRY(cli_parse_design_range("--over", sweep.key, equals + 1, &sweep.range, error));
    sweep.optima = calloc((size_t)sweep.range.count, sizeof *sweep.optima);
    if (sweep.optima == NULL)
        return dea_fail(error, DEA_ERR_MEMORY, "out of memory for %d designs", sweep.range.count);
    enum dea_status status = DEA_OK;
    struct dea_optimum_task task = options->task;
    for (int i = 0; i < sweep.range.count && status == DEA_OK; i++) {
        status = dea_design_set(&task.base, sweep.key, dea_range_value(&sweep.range, i), error);
        if (status == DEA_OK)
            status = dea_optimum_find(&task, &sweep.optima[i], error);
    }
    if (status == DEA_OK && options->json)
        status = optimum_print_sweep_json(&sweep, error);
    else if (status == DEA_OK)
        optimum_print_sweep(&options->task, &sweep);
    free(sweep.optima);
    return status;
}

/* The same films under a dead load and driven both ways (r_a 0.5), each with its own best lp1 and, if free, lp2. */
static enum dea_status compare(const struct dea_optimum_task *task, struct optimum_comparison *comparison,
                               struct dea_error *error) {
    struct dea_optimum_task other = *task;
    other.keys[DEA_KEY_ACTIVE_RATIO].free = false;
    other.both_ways = false;
    other.base.dead_load = true;
    DEA_TRY(dea_optimum_find(&other, &comparison->dead_load, error));
    other.base.dead_load = false;
    other.both_ways = true;
    other.base.active_ratio = 0.5;
    DEA_TRY(dea_optimum_find(&other, &comparison->both_ways, error));
    return DEA_OK;
}

static enum dea_status answer_one(const struct optimum_options *options, struct dea_error *error) {
    struct dea_optimum optimum;
    struct optimum_comparison comparison;
    struct optimum_dynamics dynamics;
    if (options->compare && (options->task.base.dead_load || options->task.both_ways))
        return dea_fail(error, DEA_ERR_INPUT, "--compare starts from the one-way device with a passive membrane");
    DEA_TRY(dea_optimum_find(&options->task, &optimum, error));
    if (options->compare)
        DEA_TRY(compare(&options->task, &comparison, error));
    if (options->dynamic)
        DEA_TRY(optimum_switch_on(&optimum, &options->device, &dynamics, error));
    const struct optimum_comparison *compared = options->compare ? &comparison : NULL;
    const struct optimum_dynamics *switched = options->dynamic ? &dynamics : NULL;
    if (options->json)
        return optimum_print_json(&optimum, compared, switched, error);
    optimum_print(&options->task, &optimum, compared, switched);
    return DEA_OK;
}

int cli_optimum(int argc, char **argv) {
    struct optimum_options options = {0};
    struct dea_error error = {0};
    enum dea_status status = parse_options(argc, argv, &options, &error);
    if (status == DEA_OK)
        status = options.over != NULL ? answer_over(&options, &error) : answer_one(&options, &error);
    dea_device_clear(&options.device);
    return cli_end("optimum", status, &error);
}
