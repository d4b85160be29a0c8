/* Words on the terminal and in the log: progress bar, warnings, verbose lines. Quiet by default in the library. */
#ifndef DEASIM_REPORT_H
#define DEASIM_REPORT_H

#include <stdbool.h>
#include <stdio.h>

/* Where words go; passed down, never global. A zeroed struct is silent. */
struct dea_report {
    FILE *terminal; /* stderr, or NULL when quiet */
    FILE *log;      /* DIR/log.txt, or NULL */
    bool verbose;   /* verbose lines also to the terminal */
    bool progress;  /* draw a progress bar (the terminal is one) */
    double started; /* s, monotonic; set by dea_report_begin */
    double drawn;   /* s, monotonic, of the last bar */
    int bar_width;  /* characters of the last bar, to wipe it */
};

/* One line, printf style. Warnings go to terminal and log; details to the log, and to the terminal when verbose. */
void dea_report_warn(struct dea_report *report, const char *format, ...) __attribute__((format(printf, 2, 3)));
void dea_report_detail(struct dea_report *report, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* Progress of a run; `progress` redraws at most ten times a second and costs one clock read otherwise. Shows percent,
 * simulated time, time left. `end` wipes the bar. */
void dea_report_begin(struct dea_report *report);
void dea_report_progress(struct dea_report *report, double time, double stop);
void dea_report_end(struct dea_report *report);

/* Monotonic wall clock, s. */
double dea_clock(void);

#endif
