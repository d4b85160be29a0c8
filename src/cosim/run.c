/* Chooses how a scene is run and rounds off the result. */
#include "deasim/run.h"

#include "cosim/cosim.h"
#include "cosim/native.h"
#include "cosim/supervise.h"

#include <stdio.h>
#include <string.h>

/* What a run refuses before it looks at a netlist. */
static enum dea_status check_start(const struct dea_scene *scene, enum dea_engine_choice engine,
                                   struct dea_error *error) {
    if (scene->netlist != NULL && engine == DEA_ENGINE_NATIVE)
        return dea_fail(error, DEA_ERR_INPUT,
                        "%s: --engine native runs native sources only, and this scene has a netlist", scene->path);
    if (scene->netlist == NULL && engine == DEA_ENGINE_NGSPICE)
        return dea_fail(error, DEA_ERR_INPUT, "%s: --engine ngspice runs a netlist, and this scene has native sources",
                        scene->path);
    for (int d = 0; d < scene->device_count; d++) {
        const char *why;
        if (dea_prestretch_fails(&scene->devices[d].device, &why))
            return dea_fail(error, DEA_ERR_INPUT, "%s: device %s cannot be run: %s", scene->path,
                            scene->devices[d].name, why);
    }
    return DEA_OK;
}

enum dea_status dea_check_scene(const struct dea_scene *scene, const struct dea_run_options *options,
                                struct dea_error *error) {
    DEA_TRY(check_start(scene, options->engine, error));
    if (scene->netlist == NULL)
        return DEA_OK;
    struct dea_netlist netlist = {0};
    double stop;
    enum dea_status status = cosim_read_netlist(scene, options->trust_netlist, options->report, &netlist, error);
    if (status == DEA_OK)
        status = cosim_choose_stop(scene, &netlist, &stop, error);
    dea_netlist_clear(&netlist);
    return status;
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
    struct dea_recorder *stale = sink->recorder; /* of a run that is being repeated */
    sink->recorder = NULL;
    DEA_TRY(dea_recorder_close(stale, error));
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
    enum dea_status status = check_start(scene, options->engine, error);
    struct file_sink files = {.scene = scene, .options = options};
    struct row_sink sink = {.context = &files, .open = open_files, .row = write_row};
    if (status == DEA_OK)
        status = scene->netlist != NULL ? run_supervised(scene, options, &sink, result, error)
                                        : run_native(scene, NULL, options, &sink, result, error);
    enum dea_status closed = dea_recorder_close(files.recorder, status >= 0 ? error : NULL);
    if (closed != DEA_OK && status >= 0)
        status = closed;
    result->status = status;
    if (status >= 0 && result->sensitivity >= DEA_SENSITIVE)
        dea_report_warn(options->report,
                        "the motion multiplies small errors %.3g times (films that go slack, end stops, lost "
                        "stiffness): the result may miss the accuracy asked for; compare with a run at --accuracy %.1g",
                        result->sensitivity, 0.1 * scene->accuracy);
    if (status < 0)
        snprintf(result->reason, sizeof result->reason, "%s", error->text);
    result->stats_run.wall_s = dea_clock() - started;
    return status;
}
