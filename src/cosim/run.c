/* Chooses how a scene is run and rounds off the result. */
#include "deasim/run.h"

#include "cosim/native.h"

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

enum dea_status dea_run_scene(const struct dea_scene *scene, const struct dea_run_options *options,
                              struct dea_result *result, struct dea_error *error) {
    memset(result, 0, sizeof *result);
    double started = dea_clock();
    enum dea_status status = check_start(scene, error);
    if (status == DEA_OK)
        status = run_native(scene, options, result, error);
    result->status = status;
    if (status < 0)
        snprintf(result->reason, sizeof result->reason, "%s", error->text);
    result->stats_run.wall_s = dea_clock() - started;
    return status;
}
