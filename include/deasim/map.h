/* Design maps: a quantity of the failing design over two of its parameters, with its failure modes; as CSV and PNG. */
#ifndef DEASIM_MAP_H
#define DEASIM_MAP_H

#include "deasim/study.h"

#include <stddef.h>

enum dea_map_quantity {
    DEA_MAP_DISPLACEMENT, /* d, relative to the total length */
    DEA_MAP_STRETCH,      /* lam1/lp1 of the active part */
    DEA_MAP_VOLTAGE,      /* V */
    DEA_MAP_STRESS1,      /* of the active part at the end, Pa */
    DEA_MAP_STRESS2,      /* Pa */
    DEA_MAP_MODE,         /* enum dea_limit_mode */
    DEA_MAP_QUANTITY_COUNT
};

/* "displacement", "stretch", "voltage", "stress1", "stress2", "mode" and back; DEA_MAP_QUANTITY_COUNT when unknown. */
const char *dea_map_quantity_name(enum dea_map_quantity quantity);
enum dea_map_quantity dea_map_quantity_find(const char *name);

struct dea_map_axis {
    enum dea_design_key key;
    double first, last; /* SI */
    int count;          /* >= 2 */
};

struct dea_map {
    struct dea_design base;
    struct dea_map_axis x, y;
    enum dea_map_quantity quantity;
    double *values;       /* owned; row by row, x fastest; NAN where the prestretch has failed */
    unsigned char *modes; /* owned; enum dea_limit_mode */
};

/* A piece of a line on the map, in SI along both axes. */
struct dea_map_segment {
    double x[2], y[2];
};

struct dea_map_lines {
    struct dea_map_segment *segments; /* owned */
    size_t count, room;
};

/* The best design of a map. */
struct dea_map_best {
    bool found; /* false: every design fails by prestretch */
    double x, y, value;
    enum dea_limit_mode mode;
};

/* Evaluates every design. Any number of threads gives the same bits; 0 means one per processor. DEA_ERR_INPUT when an
 * axis leaves what is physical. */
enum dea_status dea_map_fill(struct dea_map *map, int threads, struct dea_error *error);

/* Largest value, refined between the grid points. */
enum dea_status dea_map_find_best(const struct dea_map *map, struct dea_map_best *best, struct dea_error *error);

/* The line along which the failure mode changes, located by bisection on the edges of the grid. */
enum dea_status dea_map_trace_ridge(const struct dea_map *map, struct dea_map_lines *lines, struct dea_error *error);

/* A contour line of the values. */
enum dea_status dea_map_trace_level(const struct dea_map *map, double level, struct dea_map_lines *lines,
                                    struct dea_error *error);

/* Writes DIR/map.csv (SI, "name [unit]" header). */
enum dea_status dea_map_write_csv(const struct dea_map *map, const char *directory, struct dea_error *error);

/* Writes DIR/map.gnuplot and runs it: DIR/map.png, a heat map of map.csv with contour lines, the ridge in white, failed
 * prestretch in grey and a cross on the best design. DEA_ERR_OUTPUT when gnuplot cannot draw it. */
enum dea_status dea_map_draw(const struct dea_map *map, const struct dea_map_best *best, const char *directory,
                             struct dea_error *error);

double dea_map_axis_value(const struct dea_map_axis *axis, int index);

void dea_map_clear(struct dea_map *map);
void dea_map_lines_clear(struct dea_map_lines *lines);

#endif
