/* A design map as map.csv, and as map.png drawn by gnuplot from a script that stays beside it. */
#include "deasim/map.h"

#include "deasim/gnuplot.h"
#include "deasim/new_file.h"
#include "deasim/result.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define CONTOURS 10
#define MAX_PATH 4096

/* How a quantity is labelled on the picture. */
static const struct {
    const char *label, *si_unit, *unit;
    double factor;
} quantities[DEA_MAP_QUANTITY_COUNT] = {
    [DEA_MAP_DISPLACEMENT] = {"largest displacement / total length d", "1", "", 1.0},
    [DEA_MAP_STRETCH] = {"largest actuation stretch", "1", "", 1.0},
    [DEA_MAP_VOLTAGE] = {"voltage at the first failure", "V", "kV", 1e-3},
    [DEA_MAP_STRESS1] = {"stress along the motion at the first failure", "Pa", "MPa", 1e-6},
    [DEA_MAP_STRESS2] = {"stress across the motion at the first failure", "Pa", "MPa", 1e-6},
    [DEA_MAP_MODE] = {"failure mode", "1", "", 1.0},
};

static enum dea_status join_path(const char *directory, const char *name, char path[MAX_PATH],
                                 struct dea_error *error) {
    if (snprintf(path, MAX_PATH, "%s/%s", directory, name) >= MAX_PATH)
        return dea_fail(error, DEA_ERR_INPUT, "the folder name is too long");
    return DEA_OK;
}

static enum dea_status open_file(const char *directory, const char *name, struct dea_new_file *made,
                                 struct dea_error *error) {
    char path[MAX_PATH];
    DEA_TRY(join_path(directory, name, path, error));
    DEA_TRY(dea_directory_make(directory, error));
    return dea_new_file_open(path, made, error);
}

enum dea_status dea_map_write_csv(const struct dea_map *map, const char *directory, struct dea_error *error) {
    struct dea_new_file made;
    DEA_TRY(open_file(directory, "map.csv", &made, error));
    fprintf(made.file, "%s [%s],%s [%s],%s [%s],mode\n", dea_design_keys[map->x.key].name,
            dea_design_keys[map->x.key].si_unit, dea_design_keys[map->y.key].name, dea_design_keys[map->y.key].si_unit,
            dea_map_quantity_name(map->quantity), quantities[map->quantity].si_unit);
    for (int row = 0; row < map->y.count; row++) {
        double y = dea_map_axis_value(&map->y, row);
        for (int column = 0; column < map->x.count; column++) {
            size_t at = (size_t)row * (size_t)map->x.count + (size_t)column;
            fprintf(made.file, "%.12g,%.12g,%.12g,%s\n", dea_map_axis_value(&map->x, column), y, map->values[at],
                    dea_limit_names[map->modes[at]]);
        }
    }
    return dea_new_file_finish(&made, DEA_OK, error);
}

/* ---- picture ---- */

/* Text between single quotes of gnuplot, which doubles a quote inside. */
static void write_quoted(FILE *file, const char *text) {
    fputc('\'', file);
    for (; *text != '\0'; text++) {
        if (*text == '\'')
            fputc('\'', file);
        fputc(*text, file);
    }
    fputc('\'', file);
}

static void write_lines(FILE *file, const char *name, const struct dea_map *map, const struct dea_map_lines *lines) {
    double fx = dea_design_keys[map->x.key].factor, fy = dea_design_keys[map->y.key].factor;
    fprintf(file, "$%s << EOD\n", name);
    for (size_t i = 0; i < lines->count; i++)
        fprintf(file, "%.9g,%.9g\n%.9g,%.9g\n\n", lines->segments[i].x[0] * fx, lines->segments[i].y[0] * fy,
                lines->segments[i].x[1] * fx, lines->segments[i].y[1] * fy);
    fprintf(file, "EOD\n");
}

/* Distance of contour levels: 1, 2 or 5 times a power of ten. */
static double choose_spacing(double range) {
    double power = pow(10.0, floor(log10(range / CONTOURS))), step = range / CONTOURS / power;
    return power * (step <= 1.0 ? 1.0 : step <= 2.0 ? 2.0 : step <= 5.0 ? 5.0 : 10.0);
}

/* A label in the middle of a level's longest-looking stretch: its segment nearest to the middle of the map. */
static void write_label(FILE *file, const struct dea_map *map, const struct dea_map_lines *lines, double level) {
    double fx = dea_design_keys[map->x.key].factor, fy = dea_design_keys[map->y.key].factor;
    double nearest = INFINITY, x = 0.0, y = 0.0;
    for (size_t i = 0; i < lines->count; i++) {
        const struct dea_map_segment *s = &lines->segments[i];
        double across = (s->x[0] - map->x.first) / (map->x.last - map->x.first) - 0.5;
        double along = (s->y[0] - map->y.first) / (map->y.last - map->y.first) - 0.5;
        double distance = across * across + along * along;
        if (distance < nearest) {
            nearest = distance;
            x = s->x[0];
            y = s->y[0];
        }
    }
    if (isfinite(nearest))
        fprintf(file, "set label '%g' at %.9g,%.9g center front font ',9' textcolor '#202020'\n", level, x * fx,
                y * fy);
}

/* Writes the contours as one data block with their labels, and the colour range. */
static enum dea_status write_contours(FILE *file, const struct dea_map *map, bool *drawn, struct dea_error *error) {
    double least = INFINITY, largest = -INFINITY, factor = quantities[map->quantity].factor;
    for (size_t i = 0; i < (size_t)map->x.count * (size_t)map->y.count; i++)
        if (!isnan(map->values[i])) {
            least = fmin(least, map->values[i] * factor);
            largest = fmax(largest, map->values[i] * factor);
        }
    struct dea_map_lines all = {0};
    enum dea_status status = DEA_OK;
    if (largest - least > 1e-12 * fabs(largest)) {
        double spacing = choose_spacing(largest - least);
        fprintf(file, "set cbrange [%.9g:%.9g]\n", least, largest);
        for (double n = ceil(least / spacing); n * spacing < largest && status == DEA_OK; n += 1.0) {
            size_t before = all.count;
            status = dea_map_trace_level(map, n * spacing / factor, &all, error);
            struct dea_map_lines level = {all.segments + before, all.count - before, 0};
            if (level.count > 0)
                write_label(file, map, &level, n * spacing);
        }
    }
    *drawn = all.count > 0;
    write_lines(file, "contours", map, &all);
    dea_map_lines_clear(&all);
    return status;
}

static const char *const mode_colours[DEA_LIMIT_COUNT] = {
    [DEA_LIMIT_NONE] = "#ffffff",        [DEA_LIMIT_BREAKDOWN] = "#d95f02", [DEA_LIMIT_SLACK1] = "#7fb3d5",
    [DEA_LIMIT_SLACK2] = "#1f78b4",      [DEA_LIMIT_LAW] = "#8e44ad",       [DEA_LIMIT_PRESTRETCH] = "#a0a0a0",
    [DEA_LIMIT_INSTABILITY] = "#c0392b", [DEA_LIMIT_SUPPLY] = "#f1c40f",
};

/* One colour per mode; as many colours as modes, so that each whole number hits its own. */
static void write_mode_palette(FILE *file) {
    fprintf(file, "set palette maxcolors %d defined (", DEA_LIMIT_COUNT);
    for (int mode = 0; mode < DEA_LIMIT_COUNT; mode++)
        fprintf(file, "%s%d '%s'", mode > 0 ? ", " : "", mode, mode_colours[mode]);
    fprintf(file, ")\nset cbrange [0:%d]\nunset colorbox\nset key outside right top Left reverse\n",
            DEA_LIMIT_COUNT - 1);
}

/* Entries of the key for the modes that occur. */
static void write_mode_key(FILE *file, const struct dea_map *map) {
    bool present[DEA_LIMIT_COUNT] = {false};
    for (size_t i = 0; i < (size_t)map->x.count * (size_t)map->y.count; i++)
        present[map->modes[i]] = true;
    for (int mode = 0; mode < DEA_LIMIT_COUNT; mode++)
        if (present[mode])
            fprintf(file, ", \\\n     NaN with points pointtype 5 pointsize 2 linecolor rgb '%s' title '%s'",
                    mode_colours[mode], dea_limit_names[mode]);
}

static void write_axis(FILE *file, char name, const struct dea_map_axis *axis) {
    const struct dea_design_key_info *key = &dea_design_keys[axis->key];
    double half = 0.5 * (axis->last - axis->first) / (axis->count - 1);
    fprintf(file, "set %clabel '%s%s%s%s'\nset %crange [%.12g:%.12g]\n", name, key->label, key->unit[0] ? " [" : "",
            key->unit, key->unit[0] ? "]" : "", name, (axis->first - half) * key->factor,
            (axis->last + half) * key->factor);
}

static enum dea_status write_script(FILE *file, const struct dea_map *map, const struct dea_map_best *best,
                                    const char *directory, struct dea_error *error) {
    const struct dea_design_key_info *x = &dea_design_keys[map->x.key], *y = &dea_design_keys[map->y.key];
    /* the picture goes to gnuplot's standard output */
    fprintf(file, "set terminal pngcairo size 1000,760 font 'sans,12'\nset encoding utf8\nset datafile separator "
                  "','\nset termoption noenhanced\nunset key\n"
                  "set object 1 rectangle from graph 0,0 to graph 1,1 fillcolor '#a0a0a0' fillstyle solid behind\n"
                  "set palette defined (0 '#30123b', 0.13 '#4145ab', 0.25 '#4675ed', 0.38 '#1bcfd4', 0.5 '#61fc6c', "
                  "0.63 '#d1e834', 0.75 '#fe9b2d', 0.88 '#d93806', 1 '#7a0403')\n"
                  "set tics out nomirror\n");
    write_axis(file, 'x', &map->x);
    write_axis(file, 'y', &map->y);
    const char *unit = quantities[map->quantity].unit;
    fprintf(file, "set cblabel '%s%s%s%s'\n", quantities[map->quantity].label, unit[0] ? " [" : "", unit,
            unit[0] ? "]" : "");

    bool has_contours = false, has_ridge;
    if (map->quantity == DEA_MAP_MODE)
        write_mode_palette(file);
    else
        DEA_TRY(write_contours(file, map, &has_contours, error));
    struct dea_map_lines ridge = {0};
    enum dea_status status = dea_map_trace_ridge(map, &ridge, error);
    has_ridge = ridge.count > 0;
    write_lines(file, "ridge", map, &ridge);
    dea_map_lines_clear(&ridge);
    DEA_TRY(status);

    fprintf(file, "plot ");
    char path[MAX_PATH];
    DEA_TRY(join_path(directory, "map.csv", path, error));
    write_quoted(file, path);
    fprintf(file, " skip 1 using ($1*%g):($2*%g):($3*%g) with image notitle", x->factor, y->factor,
            quantities[map->quantity].factor);
    if (has_contours)
        fprintf(file, ", \\\n     $contours using 1:2 with lines linecolor '#404040' linewidth 0.6 notitle");
    if (has_ridge)
        fprintf(file, ", \\\n     $ridge using 1:2 with lines linecolor 'white' linewidth 2.5 notitle");
    if (map->quantity == DEA_MAP_MODE)
        write_mode_key(file, map);
    else if (best->found)
        fprintf(file,
                ", \\\n     '+' using (%.12g):(%.12g) every ::0::0 with points pointtype 2 pointsize 2.2 linewidth 3 "
                "linecolor 'white' notitle",
                best->x * x->factor, best->y * y->factor);
    fputc('\n', file);
    return DEA_OK;
}

enum dea_status dea_map_draw(const struct dea_map *map, const struct dea_map_best *best, const char *directory,
                             struct dea_error *error) {
    struct dea_new_file made;
    char script[MAX_PATH], picture[MAX_PATH];
    DEA_TRY(join_path(directory, "map.gnuplot", script, error));
    DEA_TRY(join_path(directory, "map.png", picture, error));
    DEA_TRY(open_file(directory, "map.gnuplot", &made, error));
    DEA_TRY(dea_new_file_finish(&made, write_script(made.file, map, best, directory, error), error));
    return dea_gnuplot_draw_file(script, picture, error);
}
