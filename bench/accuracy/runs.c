/* Runs of the program, and of the independent one, each in a process of its own. */
#include "accuracy.h"
#include "process.h"
#include "text.h"

#include "deasim/scene.h"
#include "independent.h"

#include <cjson/cJSON.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static double number(const cJSON *root, const char *group, const char *name) {
    const cJSON *item = cJSON_GetObjectItemCaseSensitive(cJSON_GetObjectItemCaseSensitive(root, group), name);
    return cJSON_IsNumber(item) ? item->valuedouble : NAN;
}

static void read_summary(const char *path, struct run *run) {
    char *text = read_text(path);
    cJSON *root = text != NULL ? cJSON_Parse(text) : NULL;
    const char *mode =
        cJSON_GetStringValue(cJSON_GetObjectItemCaseSensitive(cJSON_GetObjectItemCaseSensitive(root, "stats"), "mode"));
    snprintf(run->mode, sizeof run->mode, "%s", mode != NULL ? mode : "");
    run->imbalance = number(root, "energy", "imbalance");
    run->steps = number(root, "stats", "plant_steps");
    const cJSON *event;
    cJSON_ArrayForEach(event, cJSON_GetObjectItemCaseSensitive(root, "events")) {
        const char *type = cJSON_GetStringValue(cJSON_GetObjectItemCaseSensitive(event, "type"));
        run->impacts += type != NULL && strcmp(type, "stop") == 0;
    }
    cJSON_Delete(root);
    free(text);
}

static void name_problem(struct run *run, const struct process_result *result) {
    if (result->timed_out)
        snprintf(run->problem, sizeof run->problem, "took too long");
    else if (result->message[0] != '\0')
        snprintf(run->problem, sizeof run->problem, "exit %d: %.*s", result->code, (int)strcspn(result->message, ","),
                 result->message);
    else
        snprintf(run->problem, sizeof run->problem, "exit %d", result->code);
}

void run_scene(const char *program, const char *scene, const char *engine, double accuracy, double sample,
               const char *folder, double limit, struct run *run) {
    char json[PATH_ROOM], promise[32], spacing[64], out[PATH_ROOM], raw[PATH_ROOM + 16];
    *run = (struct run){0};
    snprintf(out, sizeof out, "%s/run", folder);
    snprintf(raw, sizeof raw, "%s/result.raw", out);
    snprintf(json, sizeof json, "%s/run.json", folder);
    snprintf(promise, sizeof promise, "%g", accuracy);
    snprintf(spacing, sizeof spacing, "output.sample=%.17g", sample);
    const char *list[] = {program,
                          "run",
                          scene,
                          "-o",
                          out,
                          "--accuracy",
                          promise,
                          "--quiet",
                          "--json",
                          "--engine",
                          engine,
                          "--set",
                          "output.formats=[raw]",
                          "--set",
                          "output.signals=null",
                          sample > 0.0 ? "--set" : NULL,
                          spacing,
                          NULL};
    char *arguments[sizeof list / sizeof list[0]];
    for (size_t i = 0; i < sizeof list / sizeof list[0]; i++)
        arguments[i] = list[i] != NULL ? strdup(list[i]) : NULL;
    (void)unlink(raw);
    struct process_result result = process_run(arguments, json, limit);
    run->seconds = result.wall;
    for (size_t i = 0; i < sizeof list / sizeof list[0]; i++)
        free(arguments[i]);
    run->good = result.good && rows_read(out, &run->rows);
    if (result.good)
        read_summary(json, run);
    if (!run->good)
        name_problem(run, &result);
}

void run_clear(struct run *run) {
    rows_clear(&run->rows);
}

/* ---- the independent program ---- */

/* The independent program takes steps up to a sample: it would miss an event that comes and goes within one. */
#define FINER 5

struct independent_job {
    const char *scene, *path; /* read, written */
    size_t samples;
};

/* In the child: the trace as a table of doubles. Samples and columns are the parent's. */
static int write_independent(void *context) {
    const struct independent_job *job = context;
    struct dea_scene scene = {0};
    struct dea_error error;
    struct independent_trace trace = {0};
    if (dea_scene_read(job->scene, NULL, 0, &scene, &error) != DEA_OK ||
        scene.policies[DEA_EVENT_BREAKDOWN] == DEA_POLICY_SHORT ||
        !independent_run(&scene, 1e-13, FINER * job->samples, &trace) || trace.count != FINER * job->samples + 1)
        return 1; /* shorts of punctured films are not in the independent program */
    FILE *file = fopen(job->path, "wb");
    bool good = file != NULL;
    const double *columns[] = {trace.x, trace.port[0], trace.port[1]};
    for (int i = 0; good && i < 3; i++)
        for (size_t j = 0; good && j < trace.count; j += FINER)
            good = fwrite(columns[i] + j, sizeof(double), 1, file) == 1;
    return file == NULL || fclose(file) != 0 || !good;
}

bool run_independent(const char *scene, double stop, size_t samples, const char *folder, double limit,
                     const struct rows *like, struct rows *rows) {
    char path[PATH_ROOM + 16];
    snprintf(path, sizeof path, "%s/independent", folder);
    memset(rows, 0, sizeof *rows);
    if (!process_call(write_independent, &(struct independent_job){scene, path, samples}, limit).good)
        return false;
    size_t count = samples + 1;
    double *values = malloc(3 * count * sizeof *values);
    FILE *file = fopen(path, "rb");
    bool good = values != NULL && file != NULL && fread(values, sizeof *values, 3 * count, file) == 3 * count;
    if (file != NULL)
        fclose(file);
    (void)unlink(path);
    *rows = (struct rows){.columns = like->columns, .count = count};
    rows->time = malloc(count * sizeof *rows->time);
    good = good && rows->time != NULL;
    for (size_t i = 0; good && i < count; i++)
        rows->time[i] = (double)i * stop / (double)samples;
    for (int c = 0; good && c < like->columns; c++) {
        rows->is_port[c] = like->is_port[c];
        rows->device[c] = 0;
        rows->signals[c] = malloc(count * sizeof **rows->signals);
        good = rows->signals[c] != NULL;
        if (good)
            memcpy(rows->signals[c], values + (like->is_port[c] ? 1 + like->zone[c] : 0) * count,
                   count * sizeof *values);
    }
    free(values);
    if (!good)
        rows_clear(rows);
    return good;
}
