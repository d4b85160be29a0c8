/* deasim fit: elastic laws from pull tests, branches from relaxation or creep. */
#include "cli/arguments.h"
#include "cli/cli.h"
#include "cli/fit_print.h"

#include "deasim/quantity.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
    OPTION_LAW = 256,
    OPTION_TERMS,
    OPTION_UNIAXIAL,
    OPTION_LAM2,
    OPTION_START,
    OPTION_STRESS,
    OPTION_BRANCHES,
    OPTION_COUNT,
    OPTION_MU,
    OPTION_JSON
};

static const char usage[] =
    "usage: deasim fit PULL-TEST.csv [options]\n"
    "       deasim fit --branches STEP.csv [options]\n"
    "\n"
    "Fits an elastic law to a pull test (columns \"stretch [1], stress [unit]\"), or relaxation branches to a step "
    "test\n"
    "(columns \"time [unit], stress [unit]\" after a step of stretch; \"time [unit], strain [1]\" or \"stretch [1]\" "
    "after a\n"
    "step of stress). Prints the parameters with 95 % confidence intervals and the lines for a material file.\n"
    "\n"
    "      --law LAW          gent (default), neo_hookean, yeoh, ogden, arruda_boyce\n"
    "      --terms N          of yeoh (default 3) or ogden (default 1)\n"
    "      --lam2 X           pure shear, the clamps hold this stretch across (default 1)\n"
    "      --start X          stretch along the pull where the column reads 1 (default 1); \"free\" is lam2^-1/2, a "
    "film\n"
    "                         that could contract while it was stretched across\n"
    "      --uniaxial         uniaxial tension instead of pure shear\n"
    "      --stress BASIS     force over the section of the film: nominal (unstretched, default), clamped (where the\n"
    "                         column reads 1), true (as pulled)\n"
    "      --branches         the file is a step test\n"
    "      --count N          branches, 1 to 5 (default: as many as the data carry)\n"
    "      --mu MU            equilibrium modulus, to write branch moduli instead of ratios\n"
    "  -o, --output DIR       fit.csv, fit.gnuplot and fit.png there\n"
    "      --json             one JSON object, SI units\n"
    "  -h, --help             this text\n"
    "\n"
    "example: deasim fit pull.csv --lam2 2 --start free -o fit\n";

struct fit_options {
    const char *path, *directory;
    struct dea_pull_test test;
    enum dea_law_kind law;
    int terms, count;
    double mu;
    bool start_free, branches, json;
};

static enum dea_status parse_number(const char *option, const char *text, const char *si_unit, double *value,
                                    struct dea_error *error) {
    struct dea_error inner;
    if (dea_quantity_parse(text, si_unit, value, &inner) != DEA_OK)
        return dea_fail(error, DEA_ERR_INPUT, "%s: %s", option, inner.text);
    if (!(*value > 0.0))
        return dea_fail(error, DEA_ERR_INPUT, "%s %s: must be positive", option, text);
    return DEA_OK;
}

static enum dea_status parse_small(const char *option, const char *text, int most, int *value,
                                   struct dea_error *error) {
    char *end;
    long number = strtol(text, &end, 10);
    if (end == text || *end != '\0' || number < 1 || number > most)
        return dea_fail(error, DEA_ERR_INPUT, "%s %s: 1 to %d are allowed", option, text, most);
    *value = (int)number;
    return DEA_OK;
}

static enum dea_status parse_basis(const char *text, enum dea_stress_basis *basis, struct dea_error *error) {
    static const char *const names[] = {"nominal", "clamped", "true"};
    for (int i = 0; i < 3; i++)
        if (strcmp(text, names[i]) == 0) {
            *basis = (enum dea_stress_basis)i;
            return DEA_OK;
        }
    return dea_fail(error, DEA_ERR_INPUT, "--stress %s: nominal, clamped and true are allowed", text);
}

static enum dea_status parse_law(const char *text, enum dea_law_kind *law, struct dea_error *error) {
    *law = dea_law_from_name(text);
    if (*law == DEA_LAW_COUNT)
        return dea_fail(error, DEA_ERR_INPUT, "--law %s: gent, neo_hookean, yeoh, ogden and arruda_boyce are allowed",
                        text);
    return DEA_OK;
}

static enum dea_status take_option(int letter, void *context, struct dea_error *error) {
    struct fit_options *options = context;
    switch (letter) {
    case OPTION_LAW:
        return parse_law(optarg, &options->law, error);
    case OPTION_TERMS:
        return parse_small("--terms", optarg, 3, &options->terms, error);
    case OPTION_UNIAXIAL:
        options->test.kind = DEA_PULL_UNIAXIAL;
        return DEA_OK;
    case OPTION_LAM2:
        return parse_number("--lam2", optarg, "1", &options->test.lam2, error);
    case OPTION_START:
        options->start_free = strcmp(optarg, "free") == 0;
        return options->start_free ? DEA_OK : parse_number("--start", optarg, "1", &options->test.start, error);
    case OPTION_STRESS:
        return parse_basis(optarg, &options->test.basis, error);
    case OPTION_BRANCHES:
        options->branches = true;
        return DEA_OK;
    case OPTION_COUNT:
        return parse_small("--count", optarg, DEA_FIT_BRANCHES, &options->count, error);
    case OPTION_MU:
        return parse_number("--mu", optarg, "Pa", &options->mu, error);
    case OPTION_JSON:
        options->json = true;
        return DEA_OK;
    case 'o':
        options->directory = optarg;
        return DEA_OK;
    default:
        return dea_fail(error, DEA_ERR_INTERNAL, "option %d is not taken", letter);
    }
}

static enum dea_status parse_options(int argc, char **argv, struct fit_options *options, struct dea_error *error) {
    static const struct option known[] = {{"law", required_argument, NULL, OPTION_LAW},
                                          {"terms", required_argument, NULL, OPTION_TERMS},
                                          {"uniaxial", no_argument, NULL, OPTION_UNIAXIAL},
                                          {"lam2", required_argument, NULL, OPTION_LAM2},
                                          {"start", required_argument, NULL, OPTION_START},
                                          {"stress", required_argument, NULL, OPTION_STRESS},
                                          {"branches", no_argument, NULL, OPTION_BRANCHES},
                                          {"count", required_argument, NULL, OPTION_COUNT},
                                          {"mu", required_argument, NULL, OPTION_MU},
                                          {"json", no_argument, NULL, OPTION_JSON},
                                          {"output", required_argument, NULL, 'o'},
                                          {"help", no_argument, NULL, 'h'},
                                          {NULL, 0, NULL, 0}};
    *options = (struct fit_options){.test = {.lam2 = 1.0, .start = 1.0}, .law = DEA_GENT};
    DEA_TRY(cli_walk_options(argc, argv, usage, known, take_option, options, error));
    if (optind + 1 != argc)
        return dea_fail(error, DEA_ERR_INPUT, "give one CSV file, see deasim fit --help");
    options->path = argv[optind];
    if (options->start_free)
        options->test.start = 1.0 / sqrt(options->test.lam2);
    if (options->terms == 0)
        options->terms = options->law == DEA_YEOH ? DEA_MAX_YEOH_TERMS : 1;
    return DEA_OK;
}

static enum dea_status fit_pull(const struct fit_options *options, struct fit_answer *answer, struct dea_error *error) {
    answer->test = options->test;
    DEA_TRY(dea_pull_test_read(options->path, &answer->data, error));
    return dea_fit_law(&options->test, &answer->data, options->law, options->terms, &answer->law, &answer->fit, error);
}

static enum dea_status fit_step(const struct fit_options *options, struct fit_answer *answer, struct dea_error *error) {
    enum dea_step_kind kind;
    answer->branches = true;
    answer->mu = options->mu;
    DEA_TRY(dea_step_test_read(options->path, &kind, &answer->data, error));
    return dea_fit_branches(kind, &answer->data, options->count, &answer->model, &answer->fit, error);
}

static enum dea_status run(const struct fit_options *options, struct dea_error *error) {
    struct fit_answer answer = {.path = options->path};
    enum dea_status status = options->branches ? fit_step(options, &answer, error) : fit_pull(options, &answer, error);
    if (status == DEA_OK && options->directory != NULL)
        status = fit_draw(&answer, options->directory, error);
    if (status == DEA_OK && options->json)
        status = fit_print_json(&answer, error);
    else if (status == DEA_OK)
        fit_print(&answer);
    dea_columns_clear(&answer.data);
    return status;
}

int cli_fit(int argc, char **argv) {
    struct fit_options options;
    struct dea_error error = {0};
    enum dea_status status = parse_options(argc, argv, &options, &error);
    if (status == DEA_OK)
        status = run(&options, &error);
    return cli_end("fit", status, &error);
}
