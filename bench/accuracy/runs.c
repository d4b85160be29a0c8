/* Runs of the program, and of the independent one, each in a process of its own with an alarm. */
#include "accuracy.h"
#include "text.h"

#include "deasim/scene.h"
#include "independent.h"

#include <cjson/cJSON.h>
#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* Exit code of a child, -signal when killed. */
static int wait_for(pid_t child) {
    int status = 0;
    if (child < 0)
        return 127;
    while (waitpid(child, &status, 0) < 0)
        if (errno != EINTR)
            return 127;
    return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
}

/* In the child: stdout and stderr into files, then the program. The alarm outlives exec. */
static void become(char *const *arguments, const char *out, const char *words, double limit) {
    int to = open(out, O_WRONLY | O_CREAT | O_TRUNC, 0644), error = open(words, O_WRONLY | O_CREAT | O_TRUNC, 0644);
    if (to < 0 || error < 0 || dup2(to, STDOUT_FILENO) < 0 || dup2(error, STDERR_FILENO) < 0)
        _exit(127);
    alarm((unsigned)ceil(limit));
    execv(arguments[0], arguments);
    _exit(127);
}

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

static void name_problem(struct run *run, int code, const char *words) {
    char *text = read_text(words);
    if (code == -SIGALRM)
        snprintf(run->problem, sizeof run->problem, "took too long");
    else if (text != NULL && text[0] != '\0')
        snprintf(run->problem, sizeof run->problem, "exit %d: %.*s", code, (int)strcspn(text, "\n,"), text);
    else
        snprintf(run->problem, sizeof run->problem, "exit %d", code);
    free(text);
}

void run_scene(const char *program, const char *scene, const char *engine, double accuracy, double sample, bool every,
               const char *folder, double limit, struct run *run) {
    char json[PATH_ROOM], words[PATH_ROOM], promise[32], spacing[64], out[PATH_ROOM], raw[PATH_ROOM + 16];
    *run = (struct run){0};
    snprintf(out, sizeof out, "%s/run", folder);
    snprintf(raw, sizeof raw, "%s/result.raw", out);
    snprintf(json, sizeof json, "%s/run.json", folder);
    snprintf(words, sizeof words, "%s/run.err", folder);
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
                          every ? "output.signals=null" : "output.formats=[raw]",
                          sample > 0.0 ? "--set" : NULL,
                          spacing,
                          NULL};
    char *arguments[sizeof list / sizeof list[0]];
    for (size_t i = 0; i < sizeof list / sizeof list[0]; i++)
        arguments[i] = list[i] != NULL ? strdup(list[i]) : NULL;
    (void)unlink(raw);
    double started = now();
    pid_t child = fork();
    if (child == 0)
        become(arguments, json, words, limit);
    int code = wait_for(child);
    run->seconds = now() - started;
    for (size_t i = 0; i < sizeof list / sizeof list[0]; i++)
        free(arguments[i]);
    run->good = code == 0 && rows_read(out, &run->rows);
    if (code == 0)
        read_summary(json, run);
    if (!run->good)
        name_problem(run, code, words);
}

void run_clear(struct run *run) {
    rows_clear(&run->rows);
}

/* ---- the independent program ---- */

/* The independent program takes steps up to a sample: it would miss an event that comes and goes within one. */
#define FINER 5

/* In the child: the trace as a table of doubles. Samples and columns are the parent's. */
static int write_independent(const char *path, const char *name, size_t samples) {
    struct dea_scene scene = {0};
    struct dea_error error;
    struct independent_trace trace = {0};
    if (dea_scene_read(name, NULL, 0, &scene, &error) != DEA_OK ||
        scene.policies[DEA_EVENT_BREAKDOWN] == DEA_POLICY_SHORT ||
        !independent_run(&scene, 1e-13, FINER * samples, &trace) || trace.count != FINER * samples + 1)
        return 1; /* shorts of punctured films are not in the independent program */
    FILE *file = fopen(path, "wb");
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
    pid_t child = fork();
    if (child == 0) {
        alarm((unsigned)ceil(limit));
        _exit(write_independent(path, scene, samples));
    }
    if (wait_for(child) != 0)
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
