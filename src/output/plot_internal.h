/* Inside the picture part of the output room: a thinned table, panels of it, and the gnuplot script that draws them. */
#ifndef DEASIM_PLOT_INTERNAL_H
#define DEASIM_PLOT_INTERNAL_H

#include "output_internal.h"

/* ---- the table: result.csv, thinned in one pass so that peaks stay ---- */

#define DEA_BUCKETS 2048 /* even; at least twice the pixels across a panel */

/* Extremes of a few consecutive rows of one column; low > high when no row held a number. */
struct dea_bucket {
    double low, high;     /* SI */
    double t_low, t_high; /* s */
};

struct dea_curve {
    size_t column;              /* in the file */
    struct dea_bucket *buckets; /* owned, DEA_BUCKETS */
    double t_first, first;      /* first and last number, s and SI */
    double t_last, last;
    bool any; /* a number was found */
};

struct dea_table {
    char *path;                 /* owned */
    struct dea_signal *columns; /* owned; [0] is time */
    size_t column_count;
    struct dea_curve *curves; /* owned; the columns asked for, sorted by column */
    size_t curve_count;
    size_t bucket_count;    /* buckets in use */
    uint64_t rows, stride;  /* rows of the file, rows per bucket */
    double t_first, t_last; /* s */
};

/* Reads the header of DIR/result.csv. */
enum dea_status dea_table_open(const char *directory, struct dea_table *table, struct dea_error *error);

/* Reads the whole file and keeps the columns asked for (ascending). A last row cut short by an interrupted run is left
 * out. */
enum dea_status dea_table_read(struct dea_table *table, const size_t *columns, size_t count, struct dea_error *error);

void dea_table_clear(struct dea_table *table);

/* ---- panels ---- */

#define DEA_PANELS 4
#define DEA_PANEL_CURVES 16

/* What a summary adds to the picture. */
struct dea_caption {
    char title[256];
    char outcome[256]; /* empty when the run was done */
    struct {
        char signal[96];
        double value; /* V/m */
    } limits[DEA_PANEL_CURVES];
    int limit_count;
    struct {
        double time; /* s */
        char text[64];
    } events[DEA_PANEL_CURVES];
    int event_count;
};

struct dea_panel_curve {
    size_t column;       /* in the file */
    char label[96];      /* in the key; may be empty */
    int palette, colour; /* a row of the palettes and a place in it */
    bool broad;          /* drawn broad and pale, below the others */
    bool dashed;
};

struct dea_panel {
    const char *axis; /* words of the y axis */
    char unit[16];    /* SI */
    struct dea_panel_curve curves[DEA_PANEL_CURVES];
    int curve_count, left_out;
};

/* Sorts the columns into at most DEA_PANELS panels; returns their number. */
int dea_panels_choose(const struct dea_table *table, struct dea_panel panels[DEA_PANELS]);

/* Unit with a prefix that suits values up to `largest`: "V", 3300 -> "kV", *factor = 1e-3. */
void dea_plot_unit(const char *si_unit, double largest, char *unit, size_t size, double *factor);

/* ---- script ---- */

/* Writes the gnuplot commands that put a PNG on gnuplot's standard output. */
void dea_plot_script(const struct dea_table *table, const struct dea_panel *panels, int panel_count,
                     const struct dea_caption *caption, FILE *script);

#endif
