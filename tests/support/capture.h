/* Runs a scene as the program does, reads its rows back, and measures how far apart two runs are. */
#ifndef DEASIM_TEST_CAPTURE_H
#define DEASIM_TEST_CAPTURE_H

#include "deasim/run.h"

#include "independent.h"

struct capture {
    enum dea_status status;
    struct dea_error error;
    struct dea_result result;
    size_t rows, columns; /* time and the signals */
    double *values;       /* row after row */
};

/* `samples` rows follow the first. */
void capture_run(const struct dea_scene *scene, double accuracy, size_t samples, struct capture *capture);
void capture_free(struct capture *capture);

/* Column of a signal ("x", "left.port_voltage"), or -1. */
int capture_column(const struct capture *capture, const char *name);
const struct dea_signal_stats *capture_stats(const struct capture *capture, const char *name);

/* Relative L2 difference in time of x and of each port voltage against a reference, the largest of them. NAN when rows
 * are missing. `port` receives the largest of the ports (may be NULL). */
double capture_error(const struct capture *capture, const struct independent_trace *reference, double *port);

/* The same against another capture. */
double capture_difference(const struct capture *capture, const struct capture *reference, double *port);

#endif
