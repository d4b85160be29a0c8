/* Filling a design map and finding its best design. */
#include "deasim/map.h"

#include "design/search_library.h"

#include <math.h>
#include <pthread.h>
#include <stdlib.h>
#include <strings.h>
#include <unistd.h>

#define MAX_THREADS 64
#define REFINEMENT 1e-10 /* relative to an axis */
#define MAX_REFINEMENTS 2000

static const char *const quantity_names[DEA_MAP_QUANTITY_COUNT] = {"displacement", "stretch", "voltage",
                                                                   "stress1",      "stress2", "mode"};

const char *dea_map_quantity_name(enum dea_map_quantity quantity) {
    return quantity < DEA_MAP_QUANTITY_COUNT ? quantity_names[quantity] : "unknown";
}

enum dea_map_quantity dea_map_quantity_find(const char *name) {
    for (int i = 0; i < DEA_MAP_QUANTITY_COUNT; i++)
        if (strcasecmp(name, quantity_names[i]) == 0)
            return (enum dea_map_quantity)i;
    return DEA_MAP_QUANTITY_COUNT;
}

double dea_map_axis_value(const struct dea_map_axis *axis, int index) {
    if (index == axis->count - 1)
        return axis->last;
    double share = (double)index / (axis->count - 1);
    return axis->first * (1.0 - share) + axis->last * share;
}

static double pick(enum dea_map_quantity quantity, const struct dea_design_end *end) {
    if (end->mode == DEA_LIMIT_PRESTRETCH)
        return NAN;
    switch (quantity) {
    case DEA_MAP_DISPLACEMENT:
        return end->displacement;
    case DEA_MAP_STRETCH:
        return end->stretch;
    case DEA_MAP_VOLTAGE:
        return end->voltage;
    case DEA_MAP_STRESS1:
        return end->stress1;
    case DEA_MAP_STRESS2:
        return end->stress2;
    default:
        return (double)end->mode;
    }
}

/* ---- filling: thread k takes rows k, k + threads, ...; every point stands alone, so the bits do not depend on it ----
 */

struct worker {
    const struct dea_map *map;
    int first_row, stride;
    enum dea_status status;
    struct dea_error error;
};

static enum dea_status fill_row(const struct dea_map *map, int row, struct dea_error *error) {
    struct dea_design design = map->base;
    DEA_TRY(dea_design_set(&design, map->y.key, dea_map_axis_value(&map->y, row), error));
    for (int column = 0; column < map->x.count; column++) {
        struct dea_design_end end;
        DEA_TRY(dea_design_set(&design, map->x.key, dea_map_axis_value(&map->x, column), error));
        DEA_TRY(dea_design_limit(&design, &end, error));
        size_t at = (size_t)row * (size_t)map->x.count + (size_t)column;
        map->values[at] = pick(map->quantity, &end);
        map->modes[at] = (unsigned char)end.mode;
    }
    return DEA_OK;
}

static void *work(void *argument) {
    struct worker *worker = argument;
    worker->status = DEA_OK;
    for (int row = worker->first_row; row < worker->map->y.count && worker->status == DEA_OK; row += worker->stride)
        worker->status = fill_row(worker->map, row, &worker->error);
    return NULL;
}

static int choose_threads(int asked, int rows) {
    long online = asked > 0 ? asked : sysconf(_SC_NPROCESSORS_ONLN);
    long most = rows < MAX_THREADS ? rows : MAX_THREADS;
    return (int)(online < 1 ? 1 : online > most ? most : online);
}

static enum dea_status fill_all(const struct dea_map *map, int threads, struct dea_error *error) {
    struct worker workers[MAX_THREADS];
    pthread_t handles[MAX_THREADS];
    bool started[MAX_THREADS] = {false};
    for (int k = 0; k < threads; k++)
        workers[k] = (struct worker){.map = map, .first_row = k, .stride = threads};
    for (int k = 1; k < threads; k++)
        started[k] = pthread_create(&handles[k], NULL, work, &workers[k]) == 0;
    /* this thread does its own share and that of any thread the system refused */
    for (int k = 0; k < threads; k++)
        if (!started[k])
            work(&workers[k]);
    enum dea_status status = DEA_OK;
    for (int k = 0; k < threads; k++) {
        if (started[k])
            pthread_join(handles[k], NULL);
        if (status == DEA_OK && workers[k].status != DEA_OK)
            status = dea_fail(error, workers[k].status, "%s", workers[k].error.text);
    }
    return status;
}

/* Axes that leave what is physical show it at a corner; found here, the message does not depend on the threads. */
static enum dea_status check_corners(const struct dea_map *map, struct dea_error *error) {
    for (int corner = 0; corner < 4; corner++) {
        struct dea_design design = map->base;
        struct dea_design_end end;
        DEA_TRY(dea_design_set(&design, map->x.key, corner % 2 == 0 ? map->x.first : map->x.last, error));
        DEA_TRY(dea_design_set(&design, map->y.key, corner / 2 == 0 ? map->y.first : map->y.last, error));
        DEA_TRY(dea_design_limit(&design, &end, error));
    }
    return DEA_OK;
}

enum dea_status dea_map_fill(struct dea_map *map, int threads, struct dea_error *error) {
    if (map->x.key == map->y.key)
        return dea_fail(error, DEA_ERR_INPUT, "both axes are %s", dea_design_keys[map->x.key].name);
    if (map->x.count < 2 || map->y.count < 2)
        return dea_fail(error, DEA_ERR_INPUT, "a map needs at least two points along each axis");
    DEA_TRY(check_corners(map, error));
    size_t count = (size_t)map->x.count * (size_t)map->y.count;
    map->values = calloc(count, sizeof *map->values);
    map->modes = calloc(count, sizeof *map->modes);
    if (map->values == NULL || map->modes == NULL)
        return dea_fail(error, DEA_ERR_MEMORY, "out of memory for %d x %d designs", map->x.count, map->y.count);
    return fill_all(map, choose_threads(threads, map->y.count), error);
}

/* ---- the best design ---- */

struct climb {
    struct dea_design design;
    const struct dea_map *map;
    struct search_library nlopt;
};

/* Value at a place given in units of the axes, 0 to 1. A failed prestretch is worse than anything. */
static double climb_value(unsigned n, const double *place, double *gradient, void *context) {
    struct climb *climb = context;
    const struct dea_map *map = climb->map;
    struct dea_design_end end;
    (void)n;
    (void)gradient;
    double x = map->x.first + place[0] * (map->x.last - map->x.first);
    double y = map->y.first + place[1] * (map->y.last - map->y.first);
    if (dea_design_set(&climb->design, map->x.key, x, NULL) != DEA_OK ||
        dea_design_set(&climb->design, map->y.key, y, NULL) != DEA_OK ||
        dea_design_limit(&climb->design, &end, NULL) != DEA_OK)
        return -HUGE_VAL;
    double value = pick(map->quantity, &end);
    return isnan(value) ? -HUGE_VAL : value;
}

/* Subplex from the best grid point: the value has a kink along the ridge, where gradients mislead. */
static bool climb_from(struct climb *climb, double place[2], double *value) {
    const struct search_library *nlopt = &climb->nlopt;
    nlopt_opt search = nlopt->create(NLOPT_LN_SBPLX, 2);
    if (search == NULL)
        return false;
    double step[2] = {1.0 / (climb->map->x.count - 1), 1.0 / (climb->map->y.count - 1)};
    for (int i = 0; i < 2; i++) /* start off the edge, where the simplex would be flat */
        place[i] = fmin(fmax(place[i], 1e-9), 1.0 - 1e-9);
    bool good = nlopt->set_max_objective(search, climb_value, climb) > 0 && nlopt->set_lower_bounds1(search, 0.0) > 0 &&
                nlopt->set_upper_bounds1(search, 1.0) > 0 && nlopt->set_initial_step(search, step) > 0 &&
                nlopt->set_xtol_abs1(search, REFINEMENT) > 0 && nlopt->set_maxeval(search, MAX_REFINEMENTS) > 0;
    /* a search that stops on rounding has arrived as well */
    nlopt_result result = good ? nlopt->optimize(search, place, value) : NLOPT_FAILURE;
    nlopt->destroy(search);
    return result > 0 || result == NLOPT_ROUNDOFF_LIMITED;
}

enum dea_status dea_map_find_best(const struct dea_map *map, struct dea_map_best *best, struct dea_error *error) {
    *best = (struct dea_map_best){.found = false, .x = NAN, .y = NAN, .value = NAN};
    size_t count = (size_t)map->x.count * (size_t)map->y.count, at = 0;
    for (size_t i = 0; i < count; i++)
        if (!isnan(map->values[i]) && !(best->found && map->values[i] <= best->value)) {
            best->found = true;
            best->value = map->values[i];
            at = i;
        }
    if (!best->found)
        return DEA_OK;
    int column = (int)(at % (size_t)map->x.count), row = (int)(at / (size_t)map->x.count);
    best->x = dea_map_axis_value(&map->x, column);
    best->y = dea_map_axis_value(&map->y, row);
    best->mode = (enum dea_limit_mode)map->modes[at];
    if (map->quantity == DEA_MAP_MODE)
        return DEA_OK;

    struct climb climb = {.design = map->base, .map = map};
    DEA_TRY(search_library_load(&climb.nlopt, error));
    double place[2] = {(double)column / (map->x.count - 1), (double)row / (map->y.count - 1)}, value;
    if (!climb_from(&climb, place, &value))
        return dea_fail(error, DEA_ERR_SOLVER, "the best design could not be refined");
    if (value > best->value) {
        struct dea_design_end end;
        best->value = value;
        best->x = map->x.first + place[0] * (map->x.last - map->x.first);
        best->y = map->y.first + place[1] * (map->y.last - map->y.first);
        climb_value(2, place, NULL, &climb);
        DEA_TRY(dea_design_limit(&climb.design, &end, error));
        best->mode = end.mode;
    }
    return DEA_OK;
}

void dea_map_clear(struct dea_map *map) {
    free(map->values);
    free(map->modes);
    map->values = NULL;
    map->modes = NULL;
}
