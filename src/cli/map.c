/* deasim map: a design map over two parameters, as CSV and PNG. */
#include "cli/arguments.h"
#include "cli/cli.h"
#include "cli/design_options.h"
#include "cli/range.h"

#include "deasim/map.h"
#include "deasim/new_file.h"
#include "deasim/result.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { OPTION_X = 256, OPTION_Y, OPTION_OF, OPTION_THREADS, OPTION_NO_PICTURE };

#define DEFAULT_COUNT 201
#define MAX_COUNT 20000
#define MAX_DESIGNS 100000000L

static const char usage[] =
    "usage: deasim map [DEVICE] --x PARAMETER=FIRST:LAST --y PARAMETER=FIRST:LAST [options]\n"
    "\n"
    "Maps what a design reaches before its first failure over any two of r_a, lp1, lp2, E_bd, Jm, mu, eps_r, t0.\n"
    "The other parameters come from the device file DEVICE, or without one from the paper's design: Sylgard 186,\n"
    "mu 0.365 MPa, Jm 16.6, eps_r 2.5, E_bd 100 V/um, t0 25 um, lp1 1, lp2 2, r_a 0.5.\n"
    "\n"
    "      --x P=A:B          parameter and range along x, for example r_a=0:1 or \"E_bd=50 V/um:150 V/um\"\n"
    "      --y P=A:B          same along y\n"
    "      --of QUANTITY      displacement (default), stretch, voltage, stress1, stress2 or mode\n"
    "      --set P=VALUE      another parameter of the design; may be repeated\n"
    "      --dead-load        a constant force instead of the passive membrane\n"
    "      --max-voltage V    the supply ends there\n"
    "  -n, --designs NXxNY    designs along x and y (default 201x201)\n"
    "  -o, --output DIR       folder for map.csv, map.png and map.gnuplot (default: map)\n"
    "      --no-picture       write no map.png\n"
    "      --threads N        default: one per processor; the numbers do not depend on it\n"
    "  -h, --help             this text\n"
    "\n"
    "example: deasim map --x r_a=0:1 --y lp1=0.7:1.8 --set lp2=2 --of displacement -o fig5b\n";

struct map_options {
    struct cli_design_options design;
    const char *texts[2]; /* --x and --y as given */
    const char *directory;
    struct dea_map map;
    int threads;
    bool no_picture;
};

/* "lp1=0.7:1.8" */
static enum dea_status parse_axis(const char *option, const char *text, struct dea_map_axis *axis,
                                  struct dea_error *error) {
    const char *equals = text != NULL ? strchr(text, '=') : NULL;
    char name[32];
    if (equals == NULL || (size_t)(equals - text) >= sizeof name)
        return dea_fail(error, DEA_ERR_INPUT, "give %s PARAMETER=FIRST:LAST, for example %s lp1=0.7:1.8", option,
                        option);
    snprintf(name, sizeof name, "%.*s", (int)(equals - text), text);
    DEA_TRY(cli_find_design_key(option, name, &axis->key, error));
    struct dea_range range;
    DEA_TRY(cli_parse_design_span(option, axis->key, equals + 1, &range, error));
    if (!(range.last > range.first))
        return dea_fail(error, DEA_ERR_INPUT, "%s %s: the range must grow", option, text);
    axis->first = range.first;
    axis->last = range.last;
    return DEA_OK;
}

static enum dea_status parse_counts(const char *text, struct dea_map *map, struct dea_error *error) {
    char *end;
    long nx = strtol(text, &end, 10), ny = nx;
    if (end != text && (*end == 'x' || *end == 'X')) {
        const char *second = end + 1;
        ny = strtol(second, &end, 10);
        if (end == second)
            end = "?";
    }
    if (end == text || *end != '\0' || nx < 2 || ny < 2 || nx > MAX_COUNT || ny > MAX_COUNT || nx * ny > MAX_DESIGNS)
        return dea_fail(error, DEA_ERR_INPUT, "-n %s: write NXxNY, each from 2 to %d, for example 201x201", text,
                        MAX_COUNT);
    map->x.count = (int)nx;
    map->y.count = (int)ny;
    return DEA_OK;
}

static enum dea_status parse_threads(const char *text, int *threads, struct dea_error *error) {
    char *end;
    long value = strtol(text, &end, 10);
    if (end == text || *end != '\0' || value < 1 || value > 64)
        return dea_fail(error, DEA_ERR_INPUT, "--threads %s: 1 to 64 are allowed", text);
    *threads = (int)value;
    return DEA_OK;
}

static enum dea_status take_option(int letter, void *context, struct dea_error *error) {
    struct map_options *options = context;
    switch (letter) {
    case OPTION_X:
        options->texts[0] = optarg;
        return DEA_OK;
    case OPTION_Y:
        options->texts[1] = optarg;
        return DEA_OK;
    case OPTION_OF:
        options->map.quantity = dea_map_quantity_find(optarg);
        if (options->map.quantity == DEA_MAP_QUANTITY_COUNT)
            return dea_fail(error, DEA_ERR_INPUT,
                            "--of %s: displacement, stretch, voltage, stress1, stress2 and mode are allowed", optarg);
        return DEA_OK;
    case OPTION_THREADS:
        return parse_threads(optarg, &options->threads, error);
    case OPTION_NO_PICTURE:
        options->no_picture = true;
        return DEA_OK;
    case 'n':
        return parse_counts(optarg, &options->map, error);
    case 'o':
        options->directory = optarg;
        return DEA_OK;
    default:
        return cli_parse_design_option(letter, &options->design, error);
    }
}

static enum dea_status parse_options(int argc, char **argv, struct map_options *options, struct dea_error *error) {
    static const struct option known[] = {CLI_DESIGN_LONG_OPTIONS,
                                          {"x", required_argument, NULL, OPTION_X},
                                          {"y", required_argument, NULL, OPTION_Y},
                                          {"of", required_argument, NULL, OPTION_OF},
                                          {"threads", required_argument, NULL, OPTION_THREADS},
                                          {"no-picture", no_argument, NULL, OPTION_NO_PICTURE},
                                          {"designs", required_argument, NULL, 'n'},
                                          {"output", required_argument, NULL, 'o'},
                                          {"help", no_argument, NULL, 'h'},
                                          {NULL, 0, NULL, 0}};
    options->directory = "map";
    options->map.x.count = options->map.y.count = DEFAULT_COUNT;
    DEA_TRY(cli_walk_options(argc, argv, usage, known, take_option, options, error));
    DEA_TRY(cli_finish_design(argc, argv, &options->design, &options->map.base, NULL, error));
    DEA_TRY(parse_axis("--x", options->texts[0], &options->map.x, error));
    return parse_axis("--y", options->texts[1], &options->map.y, error);
}

/* Best design and the share of each failure mode. */
static void print_summary(const struct map_options *options, const struct dea_map_best *best) {
    const struct dea_map *map = &options->map;
    const struct dea_design_key_info *x = &dea_design_keys[map->x.key], *y = &dea_design_keys[map->y.key];
    if (best->found && map->quantity != DEA_MAP_MODE)
        printf("largest %s %.9g at %s = %.9g%s%s, %s = %.9g%s%s (%s)\n", dea_map_quantity_name(map->quantity),
               best->value, x->name, best->x * x->factor, x->unit[0] ? " " : "", x->unit, y->name, best->y * y->factor,
               y->unit[0] ? " " : "", y->unit, dea_limit_names[best->mode]);
    long counts[DEA_LIMIT_COUNT] = {0}, all = (long)map->x.count * map->y.count;
    for (long i = 0; i < all; i++)
        counts[map->modes[i]]++;
    printf("%ld designs:", all);
    for (int mode = 0, first = 1; mode < DEA_LIMIT_COUNT; mode++)
        if (counts[mode] > 0) {
            printf("%s %s %.1f %%", first ? "" : ",", dea_limit_names[mode],
                   100.0 * (double)counts[mode] / (double)all);
            first = 0;
        }
    printf("\n%s/map.csv%s", options->directory, options->no_picture ? "\n" : "");
    if (!options->no_picture)
        printf(" %s/map.png\n", options->directory);
}

/* Before hours of work: can its files be written? */
static enum dea_status try_files(const struct map_options *options, struct dea_error *error) {
    static const char *const names[] = {"map.csv", "map.gnuplot", "map.png"};
    DEA_TRY(dea_directory_make(options->directory, error));
    for (int i = 0; i < (options->no_picture ? 1 : 3); i++) {
        char path[4096];
        if (snprintf(path, sizeof path, "%s/%s", options->directory, names[i]) >= (int)sizeof path)
            return dea_fail(error, DEA_ERR_INPUT, "the folder name is too long");
        DEA_TRY(dea_new_file_try(path, error));
    }
    return DEA_OK;
}

static enum dea_status run(struct map_options *options, struct dea_error *error) {
    struct dea_map_best best;
    DEA_TRY(try_files(options, error));
    DEA_TRY(dea_map_fill(&options->map, options->threads, error));
    DEA_TRY(dea_map_find_best(&options->map, &best, error));
    DEA_TRY(dea_map_write_csv(&options->map, options->directory, error));
    if (!options->no_picture)
        DEA_TRY(dea_map_draw(&options->map, &best, options->directory, error));
    print_summary(options, &best);
    return DEA_OK;
}

int cli_map(int argc, char **argv) {
    struct map_options options = {0};
    struct dea_error error = {0};
    enum dea_status status = parse_options(argc, argv, &options, &error);
    if (status == DEA_OK)
        status = run(&options, &error);
    dea_map_clear(&options.map);
    return cli_end("map", status, &error);
}
