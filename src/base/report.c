/* Words on the terminal and in the log. */
#include "deasim/report.h"

#include "deasim/quantity.h"

#include <math.h>
#include <stdarg.h>
#include <string.h>
#include <time.h>

#define REDRAW_INTERVAL 0.1 /* s */
#define BAR_CELLS 24        /* characters between the brackets */
#define LONGEST_LINE 4096   /* bytes; what is longer is cut */

double dea_clock(void) {
    struct timespec now;
    if (clock_gettime(CLOCK_MONOTONIC, &now) != 0)
        return 0.0;
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static void wipe_bar(struct dea_report *report) {
    if (report->bar_width == 0)
        return;
    fprintf(report->terminal, "\r%*s\r", report->bar_width, "");
    report->bar_width = 0;
}

static void write_line(FILE *file, const char *prefix, const char *text) {
    fprintf(file, "%s%s\n", prefix, text);
    fflush(file);
}

void dea_report_warn(struct dea_report *report, const char *format, ...) {
    char text[LONGEST_LINE];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    if (report->terminal != NULL) {
        wipe_bar(report);
        write_line(report->terminal, "warning: ", text);
    }
    if (report->log != NULL)
        write_line(report->log, "warning: ", text);
}

void dea_report_detail(struct dea_report *report, const char *format, ...) {
    bool shown = report->terminal != NULL && report->verbose;
    if (!shown && report->log == NULL)
        return;
    char text[LONGEST_LINE];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    if (shown) {
        wipe_bar(report);
        write_line(report->terminal, "", text);
    }
    if (report->log != NULL)
        write_line(report->log, "", text);
}

void dea_report_begin(struct dea_report *report) {
    report->started = dea_clock();
    report->drawn = report->started;
    report->bar_width = 0;
}

/* Seconds as people say them: "8 s", "3 min 20 s", "2 h 5 min". */
static void format_duration(double seconds, char *buffer, size_t size) {
    if (!(seconds < 1e9)) {
        snprintf(buffer, size, "long");
        return;
    }
    long whole = lround(seconds);
    if (whole < 60)
        snprintf(buffer, size, "%ld s", whole);
    else if (whole < 3600)
        snprintf(buffer, size, "%ld min %ld s", whole / 60, whole % 60);
    else
        snprintf(buffer, size, "%ld h %ld min", whole / 3600, whole % 3600 / 60);
}

static void draw_bar(struct dea_report *report, double fraction, double time, double stop) {
    char cells[BAR_CELLS + 1], reached[32], whole[32], left[32], line[160];
    int filled = (int)(fraction * BAR_CELLS);
    memset(cells, ' ', BAR_CELLS);
    memset(cells, '=', (size_t)filled);
    if (filled < BAR_CELLS)
        cells[filled] = '>';
    cells[BAR_CELLS] = '\0';
    format_duration((report->drawn - report->started) * (1.0 - fraction) / fraction, left, sizeof left);
    int width = snprintf(line, sizeof line, "[%s] %3d %%  %s of %s, %s left", cells, (int)(100.0 * fraction),
                         dea_quantity_format(time, "s", reached, sizeof reached),
                         dea_quantity_format(stop, "s", whole, sizeof whole), left);
    /* Blanks cover what a longer bar before left behind. */
    int covered = report->bar_width > width ? report->bar_width - width : 0;
    fprintf(report->terminal, "\r%s%*s", line, covered, "");
    fflush(report->terminal);
    report->bar_width = width + covered;
}

void dea_report_progress(struct dea_report *report, double time, double stop) {
    if (report->terminal == NULL || !report->progress)
        return;
    double now = dea_clock();
    if (now - report->drawn < REDRAW_INTERVAL)
        return;
    report->drawn = now;
    double fraction = time / stop;
    if (!(fraction > 0.0)) /* nothing done yet, or no end known */
        return;
    draw_bar(report, fraction < 1.0 ? fraction : 1.0, time, stop);
}

void dea_report_end(struct dea_report *report) {
    if (report->terminal == NULL)
        return;
    wipe_bar(report);
    fflush(report->terminal);
}
