/* Chooses how a scene is run and rounds off the result. */
#include "deasim/run.h"

#include "cosim/native.h"
#include "cosim/supervise.h"

#include <stdio.h>
#include <string.h>

static enum dea_status check_start(const struct dea_scene *scene, struct dea_error *error) {
    for (int d = 0; d < scene->device_count; d++) {
        const char *why;
        if (dea_prestretch_fails(&scene->devices[d].device, &why))
            return dea_fail(error, DEA_ERR_INPUT, "%s: device %s cannot be run: %s", scene->path,
                            scene->devices[d].name, why);
    }
    return DEA_OK;
}

/* ---- rows to the result files ---- */

struct file_sink {
    const struct dea_scene *scene;
    const struct dea_run_options *options;
    struct dea_recorder *recorder; /* NULL without a directory */
};

static enum dea_status open_files(void *context, const struct dea_signal *signals, size_t count,
                                  struct dea_error *error) {
    struct file_sink *sink = context;
    if (sink->options->directory == NULL)
        return DEA_OK;
    return dea_recorder_open(sink->options->directory, sink->scene->formats, sink->scene->title, signals, count,
                             &sink->recorder, error);
}

static enum dea_status write_row(void *context, double t, const double *values, size_t count, struct dea_error *error) {
    struct file_sink *sink = context;
    (void)count;
    return sink->recorder != NULL ? dea_recorder_append(sink->recorder, t, values, error) : DEA_OK;
}

/* ---- the run ---- */

enum dea_status dea_run_scene(const struct dea_scene *scene, const struct dea_run_options *options,
                              struct dea_result *result, struct dea_error *error) {
    memset(result, 0, sizeof *result);
    double started = dea_clock();
    enum dea_status status = check_start(scene, error);
    struct file_sink files = {.scene = scene, .options = options};
    struct row_sink sink = {.context = &files, .open = open_files, .row = write_row};
    if (status == DEA_OK)
        status = scene->netlist != NULL ? run_supervised(scene, options, &sink, result, error)
                                        : run_native(scene, options, &sink, result, error);
    enum dea_status closed = dea_recorder_close(files.recorder, status >= 0 ? error : NULL);
    if (closed != DEA_OK && status >= 0)
        status = closed;
    result->status = status;
    if (status < 0)
        snprintf(result->reason, sizeof result->reason, "%s", error->text);
    result->stats_run.wall_s = dea_clock() - started;
    return status;
}
