/* deasim's own curves, and the reference. */
#include "text.h"
#include "work_precision.h"

#include "deasim/run.h"

#include <cjson/cJSON.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define REFERENCE_ROWS 240000
#define ERROR_ROWS 20000 /* a divisor of the above: no interpolation between rows of deasim */
#define TIMED_ROWS 2000

/* ---- what the scene has ---- */

bool deasim_prepare(struct bench *bench) {
    static const char *const ports[DEA_ZONES] = {"left.port_voltage", "right.port_voltage"};
    static const char *const nodes[DEA_ZONES] = {"v(left)", "v(right)"};
    struct dea_scene scene = {0};
    struct dea_error error;
    if (dea_scene_read(bench->entry->scene, NULL, 0, &scene, &error) != DEA_OK) {
        fprintf(stderr, "%s\n", error.text);
        dea_scene_clear(&scene);
        return false;
    }
    bench->names[0] = "x";
    bench->nodes[0] = "v(pos)";
    bench->signal_count = 1;
    for (int k = 0; k < DEA_ZONES; k++) {
        if (!scene.devices[0].device.zones[k].present || !scene.devices[0].device.zones[k].electroded)
            continue;
        bench->names[bench->signal_count] = ports[k];
        bench->nodes[bench->signal_count++] = nodes[k];
    }
    bench->stop = scene.stop;
    bool good = scene.has_transient && scene.stop > 0.0;
    if (!good)
        fprintf(stderr, "%s: a benchmark scene needs transient.stop\n", bench->entry->scene);
    dea_scene_clear(&scene);
    return good;
}

/* ---- a run ---- */

static double number_of(const cJSON *object, const char *key) {
    const cJSON *item = cJSON_GetObjectItemCaseSensitive(object, key);
    return cJSON_IsNumber(item) ? item->valuedouble : NAN;
}

void deasim_read_output(struct point *point) {
    char *text = read_text(point->output);
    cJSON *root = text != NULL ? cJSON_Parse(text) : NULL;
    const cJSON *stats = cJSON_GetObjectItemCaseSensitive(root, "stats");
    point->own = fmin(point->own, number_of(stats, "wall_s"));
    point->points = number_of(stats, "circuit_points");
    point->iterations = number_of(stats, "circuit_iterations");
    point->work = number_of(stats, "residuals");
    point->relaxed = number_of(cJSON_GetObjectItemCaseSensitive(root, "coupling"), "relaxed");
    cJSON_Delete(root);
    free(text);
}

/* Command line of a run into `folder`. The caller's buffers hold what is made here. */
struct command {
    const char *arguments[MAX_ARGUMENTS];
    char accuracy[32], sample[64], stop[64], signals[128];
};

static void make_command(struct command *command, const struct bench *bench, const char *scene, const char *engine,
                         const char *folder, double accuracy, double stop, int rows) {
    snprintf(command->stop, sizeof command->stop, "transient.stop=%.17g", stop);
    snprintf(command->accuracy, sizeof command->accuracy, "%g", accuracy);
    snprintf(command->sample, sizeof command->sample, "output.sample=%.17g", stop / rows);
    int used = snprintf(command->signals, sizeof command->signals, "output.signals=[");
    for (int i = 0; i < bench->signal_count; i++)
        used += snprintf(command->signals + used, sizeof command->signals - (size_t)used, "%s%s", i > 0 ? "," : "",
                         bench->names[i]);
    snprintf(command->signals + used, sizeof command->signals - (size_t)used, "]");
    const char *arguments[] = {
        bench->program,         "run",     scene,           "-o",       folder,           "--accuracy",
        command->accuracy,      "--quiet", "--json",        "--engine", engine,           "--set",
        "output.formats=[raw]", "--set",   command->sample, "--set",    command->signals, "--set",
        command->stop,          NULL};
    memcpy(command->arguments, arguments, sizeof arguments);
}

static bool run_once(const struct bench *bench, const char *scene, const char *engine, const char *name,
                     double accuracy, int rows, double limit, struct trace *trace, struct process_result *result) {
    char folder[PATH_ROOM], raw[PATH_ROOM + 16], json[PATH_ROOM + 16];
    snprintf(folder, sizeof folder, "%s/%s", bench->folder, name);
    snprintf(raw, sizeof raw, "%s/result.raw", folder);
    snprintf(json, sizeof json, "%s.json", folder);
    struct command command;
    make_command(&command, bench, scene, engine, folder, accuracy, bench->stop, rows);
    char *arguments[MAX_ARGUMENTS] = {0};
    for (int i = 0; command.arguments[i] != NULL; i++)
        arguments[i] = strdup(command.arguments[i]);
    *result = process_run(arguments, json, limit);
    for (int i = 0; arguments[i] != NULL; i++)
        free(arguments[i]);
    return result->good && trace_read_raw(raw, bench->names, bench->signal_count, 1.0, trace);
}

/* ---- reference ---- */

/* Rows close enough for interpolation, a multiple of ERROR_ROWS: at most 1.7 us apart, where a scene's edges take 10 us
 * and more. */
static int count_reference_rows(const struct bench *bench) {
    return REFERENCE_ROWS * (int)ceil(bench->stop / 0.401);
}

/* The most accurate run that succeeds: of the native twin where there is one, which shares nothing with ngspice. The
 * doubt is the difference to the run at ten times that. */
bool deasim_reference(struct bench *bench) {
    const struct scene_entry *entry = bench->entry;
    const char *scene = entry->twin != NULL ? entry->twin : entry->scene;
    struct process_result result;
    double accuracy = entry->reference * (bench->quick && entry->reference > 1e-10 ? 10.0 : 1.0);
    double limit = bench->quick ? 15.0 : 120.0;
    for (; accuracy < 1e-3; accuracy *= 10.0)
        if (run_once(bench, scene, "auto", "reference", accuracy, count_reference_rows(bench), limit, &bench->reference,
                     &result))
            break;
    if (bench->reference.count == 0) {
        fprintf(stderr, "%s: no reference\n", entry->name);
        return false;
    }
    bench->reference_accuracy = accuracy;
    struct trace second = {0};
    if (run_once(bench, scene, "auto", "second", 10.0 * accuracy, ERROR_ROWS, limit, &second, &result)) {
        struct trace_error error = trace_compare(&second, &bench->reference);
        bench->reference_doubt = fmax(error.x, error.ports);
    }
    trace_clear(&second);
    return true;
}

/* ---- curves ---- */

#define COST_PER_DECADE 3.2 /* a second-order circuit's steps per decade of accuracy */
#define LOOSEST 1.0         /* decades: the loosest accuracy a scene may ask for is 0.1 */
#define HALVES_END 3.99     /* points every half decade up to here */
#define START_STOP 1e-7     /* span of a run that is nothing but its start, in spans of the scene ... */
#define LEAST_STOP 1e-9     /* ... and in s: the shortest that deasim takes */

static bool add_curve_point(struct bench *bench, const char *scene, const char *curve, const char *engine,
                            double accuracy, double *cpu) {
    char name[64], folder[PATH_ROOM];
    struct point *point = bench_add_point(bench, curve, "A=%g", accuracy);
    if (COST_PER_DECADE * *cpu > 1.5 * bench->limit) {
        point_fail(point, "left out: would take more than %g s", bench->limit);
        return false;
    }
    snprintf(name, sizeof name, "%s-%g", engine, accuracy);
    snprintf(folder, sizeof folder, "%s/%s-timed", bench->folder, name);
    struct trace trace = {0};
    struct process_result result;
    bool good = run_once(bench, scene, engine, name, accuracy, ERROR_ROWS, 2.0 * bench->limit, &trace, &result);
    *cpu = result.cpu;
    if (!good) {
        point_blame(point, &result);
        return !result.timed_out;
    }
    if (bench->reference.count > 0)
        point->error = trace_compare(&trace, &bench->reference);
    trace_clear(&trace);
    struct command command;
    make_command(&command, bench, scene, engine, folder, accuracy, fmax(START_STOP * bench->stop, LEAST_STOP), 1);
    bench_set_start(bench, curve, command.arguments, INFINITY);
    make_command(&command, bench, scene, engine, folder, accuracy, bench->stop, TIMED_ROWS);
    point_set_command(point, command.arguments);
    snprintf(point->output, sizeof point->output, "%.900s/%s.json", bench->folder, name);
    point->chosen = true;
    return true;
}

void deasim_curve(struct bench *bench, const char *scene, const char *curve, const char *engine) {
    double last = bench->entry->tightest, cpu = 0.0;
    if (bench->quick && last > bench->entry->loosest + 1.0)
        last -= 1.0;
    /* half decades where the errors are that the tables look up, from the loosest accuracy a scene may ask for */
    for (double exponent = LOOSEST; exponent <= last + 0.01; exponent += exponent < HALVES_END ? 0.5 : 1.0)
        if (!add_curve_point(bench, scene, curve, engine, pow(10.0, -exponent), &cpu))
            return;
}
