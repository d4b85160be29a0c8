/* Lines on a design map: contours of the values and the ridge between failure modes, both by marching squares. */
#include "deasim/map.h"

#include <math.h>
#include <stdlib.h>

#define BISECTIONS 40 /* of a grid edge, when the ridge is located on it */

struct place {
    double x, y;
};

static enum dea_status append(struct dea_map_lines *lines, struct place from, struct place to,
                              struct dea_error *error) {
    if (lines->count == lines->room) {
        size_t room = lines->room == 0 ? 256 : 2 * lines->room;
        struct dea_map_segment *segments = realloc(lines->segments, room * sizeof *segments);
        if (segments == NULL)
            return dea_fail(error, DEA_ERR_MEMORY, "out of memory for the lines of a map");
        lines->segments = segments;
        lines->room = room;
    }
    lines->segments[lines->count++] = (struct dea_map_segment){{from.x, to.x}, {from.y, to.y}};
    return DEA_OK;
}

void dea_map_lines_clear(struct dea_map_lines *lines) {
    free(lines->segments);
    *lines = (struct dea_map_lines){0};
}

static size_t grid_index(const struct dea_map *map, int column, int row) {
    return (size_t)row * (size_t)map->x.count + (size_t)column;
}

static struct place grid_place(const struct dea_map *map, int column, int row) {
    return (struct place){dea_map_axis_value(&map->x, column), dea_map_axis_value(&map->y, row)};
}

/* Corners of a cell counter-clockwise; edge k joins corner k and k + 1. */
static const int corner_columns[4] = {0, 1, 1, 0}, corner_rows[4] = {0, 0, 1, 1};

/* Where a line crosses the edge from a corner (index a) to another (b); false when it does not. */
typedef bool (*crossing)(const struct dea_map *map, const void *context, size_t a, size_t b, struct place from,
                         struct place to, struct place *where);

/* Joins the crossings of one cell: two make a segment, three meet in the middle, four make two segments. */
static enum dea_status join_cell(const struct place *found, int count, struct dea_map_lines *lines,
                                 struct dea_error *error) {
    if (count == 3) {
        struct place middle = {(found[0].x + found[1].x + found[2].x) / 3.0,
                               (found[0].y + found[1].y + found[2].y) / 3.0};
        for (int i = 0; i < 3; i++)
            DEA_TRY(append(lines, found[i], middle, error));
        return DEA_OK;
    }
    for (int i = 0; i + 1 < count; i += 2)
        DEA_TRY(append(lines, found[i], found[i + 1], error));
    return DEA_OK;
}

static enum dea_status trace(const struct dea_map *map, crossing cross, const void *context,
                             struct dea_map_lines *lines, struct dea_error *error) {
    for (int row = 0; row + 1 < map->y.count; row++)
        for (int column = 0; column + 1 < map->x.count; column++) {
            struct place found[4];
            int count = 0;
            for (int k = 0; k < 4; k++) {
                int c0 = column + corner_columns[k], r0 = row + corner_rows[k];
                int c1 = column + corner_columns[(k + 1) % 4], r1 = row + corner_rows[(k + 1) % 4];
                if (cross(map, context, grid_index(map, c0, r0), grid_index(map, c1, r1), grid_place(map, c0, r0),
                          grid_place(map, c1, r1), &found[count]))
                    count++;
            }
            DEA_TRY(join_cell(found, count, lines, error));
        }
    return DEA_OK;
}

/* ---- contours ---- */

static bool cross_level(const struct dea_map *map, const void *context, size_t a, size_t b, struct place from,
                        struct place to, struct place *where) {
    double level = *(const double *)context, va = map->values[a], vb = map->values[b];
    if (isnan(va) || isnan(vb) || (va < level) == (vb < level))
        return false;
    double share = (level - va) / (vb - va);
    *where = (struct place){from.x + share * (to.x - from.x), from.y + share * (to.y - from.y)};
    return true;
}

enum dea_status dea_map_trace_level(const struct dea_map *map, double level, struct dea_map_lines *lines,
                                    struct dea_error *error) {
    return trace(map, cross_level, &level, lines, error);
}

/* ---- ridge ---- */

static enum dea_limit_mode mode_at(const struct dea_map *map, struct place place) {
    struct dea_design design = map->base;
    struct dea_design_end end;
    if (dea_design_set(&design, map->x.key, place.x, NULL) != DEA_OK ||
        dea_design_set(&design, map->y.key, place.y, NULL) != DEA_OK || dea_design_limit(&design, &end, NULL) != DEA_OK)
        return DEA_LIMIT_NONE;
    return end.mode;
}

static bool cross_ridge(const struct dea_map *map, const void *context, size_t a, size_t b, struct place from,
                        struct place to, struct place *where) {
    (void)context;
    enum dea_limit_mode mode = (enum dea_limit_mode)map->modes[a];
    if (map->modes[a] == map->modes[b] || mode == DEA_LIMIT_PRESTRETCH || map->modes[b] == DEA_LIMIT_PRESTRETCH)
        return false;
    double low = 0.0, high = 1.0;
    for (int i = 0; i < BISECTIONS; i++) {
        double share = 0.5 * (low + high);
        *where = (struct place){from.x + share * (to.x - from.x), from.y + share * (to.y - from.y)};
        if (mode_at(map, *where) == mode)
            low = share;
        else
            high = share;
    }
    return true;
}

enum dea_status dea_map_trace_ridge(const struct dea_map *map, struct dea_map_lines *lines, struct dea_error *error) {
    return trace(map, cross_ridge, NULL, lines, error);
}
