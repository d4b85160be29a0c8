/* Rows come back through the raw file: full doubles, written by the recorder as for any user. */
#include "capture.h"

#include "relative_difference.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static void read_rows(struct capture *capture, const char *path) {
    FILE *file = fopen(path, "rb");
    char line[512];
    unsigned long points = 0;
    if (file == NULL)
        return;
    while (fgets(line, sizeof line, file) != NULL && strcmp(line, "Binary:\n") != 0)
        if (strncmp(line, "No. Points:", 11) == 0)
            points = strtoul(line + 11, NULL, 10);
    capture->columns = capture->result.signal_count + 1;
    capture->values = malloc((points * capture->columns + 1) * sizeof *capture->values);
    if (capture->values != NULL &&
        fread(capture->values, sizeof(double), points * capture->columns, file) == points * capture->columns)
        capture->rows = points;
    fclose(file);
}

void capture_run(const struct dea_scene *scene, double accuracy, size_t samples, struct capture *capture) {
    struct dea_scene copy = *scene;
    char directory[] = "/tmp/deasim-capture-XXXXXX", path[64];
    memset(capture, 0, sizeof *capture);
    copy.accuracy = accuracy;
    copy.formats = DEA_FORMAT_RAW;
    copy.sample = scene->stop / (double)samples;
    if (mkdtemp(directory) == NULL) {
        perror(directory);
        abort();
    }
    struct dea_report silent = {0};
    struct dea_run_options options = {.directory = directory, .report = &silent};
    capture->status = dea_run_scene(&copy, &options, &capture->result, &capture->error);
    snprintf(path, sizeof path, "%s/result.raw", directory);
    read_rows(capture, path);
    unlink(path);
    rmdir(directory);
}

void capture_free(struct capture *capture) {
    dea_result_clear(&capture->result);
    free(capture->values);
    memset(capture, 0, sizeof *capture);
}

static int signal_index(const struct capture *capture, const char *name) {
    for (size_t i = 0; i < capture->result.signal_count; i++)
        if (strcmp(capture->result.signals[i].name, name) == 0)
            return (int)i;
    return -1;
}

int capture_column(const struct capture *capture, const char *name) {
    int index = signal_index(capture, name);
    return index < 0 ? -1 : index + 1;
}

const struct dea_signal_stats *capture_stats(const struct capture *capture, const char *name) {
    int index = signal_index(capture, name);
    return index < 0 ? NULL : &capture->result.stats[index];
}

/* Difference of a column against values `stride` apart. */
static double column_error(const struct capture *capture, int column, const double *reference, size_t stride) {
    return relative_difference(capture->values + column, capture->columns, reference, stride, capture->rows);
}

static const char *const port_names[DEA_ZONES] = {"left.port_voltage", "right.port_voltage"};

double capture_error(const struct capture *capture, const struct independent_trace *reference, double *port) {
    if (capture->rows != reference->count)
        return NAN;
    double ports = 0.0;
    for (int k = 0; k < DEA_ZONES; k++) {
        int column = capture_column(capture, port_names[k]);
        if (column >= 0)
            ports = fmax(ports, column_error(capture, column, reference->port[k], 1));
    }
    if (port != NULL)
        *port = ports;
    return fmax(ports, column_error(capture, capture_column(capture, "x"), reference->x, 1));
}

double capture_difference(const struct capture *capture, const struct capture *reference, double *port) {
    if (capture->rows != reference->rows || capture->columns != reference->columns)
        return NAN;
    double ports = 0.0;
    for (int k = 0; k < DEA_ZONES; k++) {
        int column = capture_column(capture, port_names[k]);
        if (column >= 0)
            ports = fmax(ports, column_error(capture, column, reference->values + column, reference->columns));
    }
    if (port != NULL)
        *port = ports;
    int x = capture_column(capture, "x");
    return fmax(ports, column_error(capture, x, reference->values + x, reference->columns));
}
