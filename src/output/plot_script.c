/* The gnuplot script of a picture: panels under one another over a shared time axis, data included. */
#include "plot_internal.h"

#include <math.h>
#include <string.h>

#define WIDTH 1000       /* pixels */
#define FRAME_HEIGHT 232 /* pixels of a panel's frame */
#define HEAD 46          /* pixels above everything: title, and the outcome below it */
#define FOOT 58          /* pixels below the last panel: tics and time label */
#define KEY_LINE 17      /* pixels of a line of a key */
#define KEY_COLUMNS 4
#define KEY_MARGIN 17   /* pixels above and below a key */
#define WORD_WIDTH 0.02 /* of the time axis: what a word written upwards takes */
#define SHOWN_LIMIT 4.0 /* a limit is drawn when the panel grows less than that by it */
#define SMALL_SIDE 0.25 /* fields of the other sign below this part of the larger ones get no limit of their own */

/* Okabe and Ito, "Color Universal Design" (2008): told apart by colour-blind readers too. */
static const char *const palettes[][6] = {
    {"0072B2", "D55E00", "009E73", "CC79A7", "E69F00", "56B4E9"}, /* zones */
    {"222222", "009E73", "CC79A7", "E69F00", "56B4E9", "0072B2"}, /* devices */
    {"222222", "009E73", "D55E00", "CC79A7", "E69F00", "56B4E9"}, /* energies: in, stored, dissipated, imbalance */
};

static const char *colour_of(const struct dea_panel_curve *curve) {
    return palettes[curve->palette][curve->colour % 6];
}

/* A gnuplot string: single quotes switch every escape off but the doubled quote itself. */
static void write_string(const char *text, FILE *script) {
    fputc('\'', script);
    for (const char *c = text; *c != '\0'; c++) {
        if (*c == '\'')
            fputc('\'', script);
        fputc((unsigned char)*c < 0x20 || *c == 0x7f ? ' ' : *c, script);
    }
    fputc('\'', script);
}

static const struct dea_curve *find_curve(const struct dea_table *table, size_t column) {
    for (size_t i = 0; i < table->curve_count; i++)
        if (table->curves[i].column == column)
            return &table->curves[i];
    return NULL;
}

/* ---- data ---- */

struct scales {
    double time, value; /* factors from SI */
};

static void write_point(double time, double value, const struct scales *scales, FILE *script) {
    fprintf(script, "%.9g %.7g\n", time * scales->time, value * scales->value);
}

/* Both extremes of each bucket in the order of time; an empty line interrupts the curve where numbers are missing. */
static void write_data(const struct dea_table *table, const struct dea_curve *curve, const struct scales *scales,
                       FILE *script) {
    fprintf(script, "$column%zu << END_OF_DATA\n", curve->column);
    if (curve->any)
        write_point(curve->t_first, curve->first, scales, script);
    for (size_t i = 0; i < table->bucket_count; i++) {
        const struct dea_bucket *bucket = &curve->buckets[i];
        if (bucket->low > bucket->high) {
            fputc('\n', script);
            continue;
        }
        bool low_first = bucket->t_low <= bucket->t_high;
        write_point(low_first ? bucket->t_low : bucket->t_high, low_first ? bucket->low : bucket->high, scales, script);
        if (bucket->t_low != bucket->t_high)
            write_point(low_first ? bucket->t_high : bucket->t_low, low_first ? bucket->high : bucket->low, scales,
                        script);
    }
    if (curve->any)
        write_point(curve->t_last, curve->last, scales, script);
    fputs("END_OF_DATA\n", script);
}

/* ---- one panel ---- */

struct range {
    double low, high; /* SI */
};

static struct range range_of(const struct dea_table *table, const struct dea_panel *panel) {
    struct range range = {INFINITY, -INFINITY};
    for (int i = 0; i < panel->curve_count; i++) {
        const struct dea_curve *curve = find_curve(table, panel->curves[i].column);
        for (size_t k = 0; curve->any && k < table->bucket_count; k++) {
            range.low = fmin(range.low, curve->buckets[k].low);
            range.high = fmax(range.high, curve->buckets[k].high);
        }
    }
    return range.low > range.high ? (struct range){0.0, 0.0} : range;
}

/* A margin above and below; something to see also where all values are one. */
static struct range widen(struct range range) {
    double margin = 0.06 * (range.high - range.low);
    if (margin <= 1e-9 * fmax(fabs(range.low), fabs(range.high)))
        margin = range.high == 0.0 ? 1.0 : 0.1 * fabs(range.high);
    return (struct range){range.low - margin, range.high + margin};
}

/* The lowest constant breakdown field among the panel's curves. */
static bool limit_of(const struct dea_panel *panel, const struct dea_table *table, const struct dea_caption *caption,
                     double *limit) {
    *limit = INFINITY;
    if (strcmp(panel->unit, "V/m") != 0)
        return false;
    for (int i = 0; i < panel->curve_count; i++)
        for (int k = 0; k < caption->limit_count; k++)
            if (strcmp(table->columns[panel->curves[i].column].name, caption->limits[k].signal) == 0)
                *limit = fmin(*limit, caption->limits[k].value);
    return isfinite(*limit) && *limit > 0.0;
}

/* Points where a line would have no length. */
static void write_curve(const struct dea_table *table, const struct dea_panel_curve *curve, const char *separator,
                        FILE *script) {
    bool any = find_curve(table, curve->column)->any;
    fprintf(script, "%s$column%zu using 1:2 with %s lw %s dt %d lc rgb '#%s%s' ", separator, curve->column,
            table->rows == 1 ? "points pt 7" : "lines", curve->broad ? "4.5" : "1.5", curve->dashed ? 2 : 1,
            curve->broad ? "A0" : "", colour_of(curve));
    if (curve->label[0] == '\0' && any) {
        fputs("notitle", script);
        return;
    }
    char title[sizeof curve->label + 16];
    snprintf(title, sizeof title, "%s%s%s", curve->label, any || curve->label[0] == '\0' ? "" : " ",
             any ? "" : "(no numbers)");
    fputs("title ", script);
    write_string(title, script);
}

/* Where a limit is drawn: at its value, where fields are negative also at its opposite. */
struct limit_lines {
    double value; /* SI; 0: no limit */
    bool above, below;
};

/* Broad pale curves first, so that the others lie on top; then the limit. */
static void write_plot_command(const struct dea_table *table, const struct dea_panel *panel,
                               const struct limit_lines *limit, FILE *script) {
    const char *separator = "plot ";
    for (int pass = 0; pass < 2; pass++)
        for (int i = 0; i < panel->curve_count; i++) {
            if (panel->curves[i].broad != (pass == 0))
                continue;
            write_curve(table, &panel->curves[i], separator, script);
            separator = ", \\\n     ";
        }
    bool shown = limit->above || limit->below;
    if (limit->value > 0.0)
        fprintf(script, "%s%s with lines lw 1.5 dt (10,6) lc rgb '#B00020' title 'breakdown %.4g V/µm%s'", separator,
                limit->above   ? "limit"
                : limit->below ? "-limit"
                               : "NaN",
                limit->value * 1e-6, shown ? "" : ", off scale");
    if (limit->above && limit->below)
        fprintf(script, "%s-limit with lines lw 1.5 dt (10,6) lc rgb '#B00020' notitle", separator);
    if (panel->left_out > 0)
        fprintf(script, "%sNaN with lines lc rgb '#FFFFFF' title 'and %d more'", separator, panel->left_out);
    fputc('\n', script);
}

static void write_panel(const struct dea_table *table, const struct dea_panel *panel, const struct dea_caption *caption,
                        double time_factor, FILE *script) {
    struct range range = range_of(table, panel);
    double limit, factor;
    struct limit_lines lines = {.value = 0.0};
    struct range shown = range;
    if (limit_of(panel, table, caption, &limit)) {
        bool negative = -range.low > SMALL_SIDE * fmax(range.high, 0.0),
             positive = range.high > SMALL_SIDE * -range.low;
        lines.value = limit;
        lines.above = (positive || !negative) && limit <= SHOWN_LIMIT * range.high;
        lines.below = negative && limit <= SHOWN_LIMIT * -range.low;
        if (lines.above)
            shown.high = fmax(shown.high, limit);
        if (lines.below)
            shown.low = fmin(shown.low, -limit);
    }
    shown = widen(shown);

    char unit[32];
    dea_plot_unit(panel->unit, fmax(fabs(range.low), fabs(range.high)), unit, sizeof unit, &factor);
    struct scales scales = {time_factor, factor};
    for (int i = 0; i < panel->curve_count; i++)
        write_data(table, find_curve(table, panel->curves[i].column), &scales, script);
    char axis[96];
    snprintf(axis, sizeof axis, unit[0] != '\0' ? "%s [%s]" : "%s", panel->axis, unit);
    fputs("set label 3 ", script);
    write_string(axis, script);
    fputs(" at screen 0.03, graph 0.5 center rotate by 90 noenhanced\n", script);
    fprintf(script, "set yrange [%.9g:%.9g]\n", shown.low * factor, shown.high * factor);
    if (lines.above || lines.below)
        fprintf(script, "limit = %.9g\n", lines.value * factor);
    write_plot_command(table, panel, &lines, script);
}

/* ---- the page ---- */

/* Pixels from the frame above to the frame of this panel: its key, if any. */
static int gap_above(const struct dea_panel *panel, const struct dea_table *table, const struct dea_caption *caption) {
    double limit;
    int entries = panel->left_out > 0;
    for (int i = 0; i < panel->curve_count; i++)
        entries += panel->curves[i].label[0] != '\0' || !find_curve(table, panel->curves[i].column)->any;
    entries += limit_of(panel, table, caption, &limit);
    return KEY_MARGIN + KEY_LINE * ((entries + KEY_COLUMNS - 1) / KEY_COLUMNS);
}

static void write_page(const struct dea_caption *caption, int height, FILE *script) {
    fprintf(script,
            "set terminal pngcairo size %d,%d font 'DejaVu Sans,10' noenhanced\n"
            "set encoding utf8\n"
            "set multiplot\n"
            "set border 31 lw 0.8 lc rgb '#888888'\n"
            "set grid xtics ytics lt 1 lw 0.6 lc rgb '#E2E2E2'\n"
            "set tics scale 0.6 textcolor rgb '#222222'\n"
            "set format '%%g'\nset minussign\n"
            "set key at graph 1.0, screen 0.5 right bottom horizontal Left reverse maxcols %d samplen 2 width 1\n"
            "set lmargin at screen 0.1\nset rmargin at screen 0.97\n",
            WIDTH, height, KEY_COLUMNS);
    fputs("set label 1 ", script);
    write_string(caption->title, script);
    fprintf(script, " at screen 0.1, screen %.6f left noenhanced font 'DejaVu Sans,14'\n", 1.0 - 22.0 / height);
    if (caption->outcome[0] == '\0')
        return;
    fputs("set label 2 ", script);
    write_string(caption->outcome, script);
    fprintf(script, " at screen 0.1, screen %.6f left noenhanced textcolor rgb '#B00020'\n", 1.0 - 44.0 / height);
}

/* Where a word stands beside its line in the first panel, so that words do not cover one another. */
struct word_place {
    double time; /* s; -INFINITY: none yet */
    int level;   /* 0: foot of the panel, 1: its middle */
};

/* The first event of each kind and zone gets a word, below or above the one next to it; without room it goes without.
 */
static bool place_word(const struct dea_caption *caption, int event, double span, struct word_place *last) {
    for (int i = 0; i < event; i++)
        if (strcmp(caption->events[i].text, caption->events[event].text) == 0)
            return false;
    bool near = fabs(caption->events[event].time - last->time) < WORD_WIDTH * span;
    if (near && last->level == 1)
        return false;
    *last = (struct word_place){near ? last->time : caption->events[event].time, near ? 1 : 0};
    return true;
}

/* A dotted line through all panels, and words on the first. */
static void write_events(const struct dea_table *table, const struct dea_caption *caption, double time_factor,
                         FILE *script) {
    double span = table->t_last - table->t_first;
    struct word_place last = {-INFINITY, 0};
    for (int i = 0; i < caption->event_count; i++) {
        double time = caption->events[i].time;
        fprintf(script,
                "set arrow %d from first %.9g, graph 0 to first %.9g, graph 1 nohead dt (2,4) lc rgb '#777777'\n",
                i + 1, time * time_factor, time * time_factor);
        if (!place_word(caption, i, span, &last))
            continue;
        fprintf(script, "set label %d ", 10 + i);
        write_string(caption->events[i].text, script);
        bool at_edge = time > table->t_last - WORD_WIDTH * span; /* no room to the right of the line */
        fprintf(script,
                " at first %.9g, graph %g left rotate by 90 offset %g,0 noenhanced font 'DejaVu Sans,8' "
                "textcolor rgb '#555555'\n",
                time * time_factor, last.level == 0 ? 0.1 : 0.5, at_edge ? -1.1 : 1.1);
    }
}

void dea_plot_script(const struct dea_table *table, const struct dea_panel *panels, int panel_count,
                     const struct dea_caption *caption, FILE *script) {
    int height = HEAD + FOOT + panel_count * FRAME_HEIGHT;
    for (int i = 0; i < panel_count; i++)
        height += gap_above(&panels[i], table, caption);
    write_page(caption, height, script);

    char unit[32];
    double time_factor;
    dea_plot_unit("s", fmax(fabs(table->t_first), fabs(table->t_last)), unit, sizeof unit, &time_factor);
    struct range times = {table->t_first, table->t_last};
    if (!(times.high > times.low))
        times = widen((struct range){times.low, times.low});
    fprintf(script, "set xrange [%.12g:%.12g]\nset format x ''\n", times.low * time_factor, times.high * time_factor);
    write_events(table, caption, time_factor, script);

    int top = HEAD; /* pixels from the upper edge */
    for (int i = 0; i < panel_count; i++) {
        top += gap_above(&panels[i], table, caption);
        fprintf(script, "set tmargin at screen %.6f\nset bmargin at screen %.6f\n", 1.0 - (double)top / height,
                1.0 - (double)(top + FRAME_HEIGHT) / height);
        fprintf(script, "set key at graph 1.0, screen %.6f\n", 1.0 - (double)(top - 5) / height);
        if (i == panel_count - 1)
            fprintf(script, "set format x '%%g'\nset xlabel 'Time [%s]'\n", unit);
        write_panel(table, &panels[i], caption, time_factor, script);
        fputs("unset label\n", script); /* of the page and of the events: once is enough */
        top += FRAME_HEIGHT;
    }
    fputs("unset multiplot\n", script);
}
