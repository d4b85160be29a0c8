/* Scenes from texts, runs into memory. */
#include "coupled_capture.h"

#include "cosim/cosim.h"
#include "cosim/native.h"
#include "cosim/supervise.h"
#include "coupled_cases.h"
#include "relative_difference.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* ---- folders and scenes ---- */

void enter_folder(struct test_folder *folder) {
    snprintf(folder->path, sizeof folder->path, "/tmp/deasim-test-XXXXXX");
    if (getcwd(folder->back, sizeof folder->back) == NULL || mkdtemp(folder->path) == NULL || chdir(folder->path) != 0)
        abort();
}

void leave_folder(const struct test_folder *folder) {
    char command[96];
    snprintf(command, sizeof command, "rm -r '%s'", folder->path);
    if (chdir(folder->back) != 0 || system(command) != 0)
        abort();
}

int set_up_folder(void **state) {
    static struct test_folder folder;
    enter_folder(&folder);
    *state = &folder;
    return 0;
}

int tear_down_folder(void **state) {
    leave_folder(*state);
    return 0;
}

void make_scene(const char *device, const char *netlist, double stop, const char *extra, struct dea_scene *scene) {
    FILE *file = fopen("scene.yaml", "w");
    if (file == NULL)
        abort();
    fprintf(file, "title: Test\n%s%s\ndrive: {netlist: %s}\n", device[0] == '{' ? "device: " : "", device, netlist);
    if (stop > 0.0)
        fprintf(file, "transient: {stop: %.17g s}\n", stop);
    fprintf(file, "%s\n", extra);
    struct dea_error error;
    if (fclose(file) != 0)
        abort();
    if (dea_scene_read("scene.yaml", NULL, 0, scene, &error) != DEA_OK) {
        fprintf(stderr, "%s\n", error.text);
        abort();
    }
}

void make_circuit_scene(const char *device, const struct drive_circuit *circuit, const char *extra,
                        struct dea_scene *scene) {
    FILE *file = fopen("circuit.cir", "w"); /* the scene wants the file to be there */
    if (file == NULL || fclose(file) != 0)
        abort();
    make_scene(device, "circuit.cir", circuit->stop, extra, scene);
    write_circuit("circuit.cir", circuit, &scene->devices[0].device);
}

void make_listed_scene(const struct coupled_scene *listed, struct dea_scene *scene) {
    char extra[512];
    FILE *file = fopen("listed.cir", "w");
    if (file == NULL || fputs(listed->netlist, file) == EOF || fclose(file) != 0)
        abort();
    snprintf(extra, sizeof extra, "%s\n%s", SILENT_EVENTS, listed->extra);
    make_scene(listed->device, "listed.cir", listed->stop, extra, scene);
}

/* ---- runs ---- */

static enum dea_status open_rows(void *context, const struct dea_signal *signals, size_t count,
                                 struct dea_error *error) {
    struct coupled_rows *rows = context;
    (void)error;
    free(rows->signals);
    rows->signals = malloc(count * sizeof *signals);
    if (rows->signals == NULL)
        abort();
    memcpy(rows->signals, signals, count * sizeof *signals);
    rows->columns = count;
    rows->count = 0;
    return DEA_OK;
}

static enum dea_status keep_row(void *context, double t, const double *values, size_t count, struct dea_error *error) {
    struct coupled_rows *rows = context;
    (void)error;
    if ((rows->count & (rows->count - 1)) == 0) {
        size_t room = rows->count > 0 ? 2 * rows->count : 1;
        rows->times = realloc(rows->times, room * sizeof *rows->times);
        rows->values = realloc(rows->values, room * count * sizeof *rows->values);
        if (rows->times == NULL || rows->values == NULL)
            abort();
    }
    rows->times[rows->count] = t;
    memcpy(rows->values + rows->count * count, values, count * sizeof *values);
    rows->count++;
    return DEA_OK;
}

void run_scene(const struct dea_scene *scene, enum dea_engine_choice engine, double accuracy, size_t samples,
               struct coupled_rows *rows) {
    struct dea_scene copy = *scene;
    memset(rows, 0, sizeof *rows);
    copy.accuracy = accuracy;
    copy.sample = scene->stop / (double)samples;
    struct dea_report silent = {0};
    struct dea_run_options options = {.report = &silent, .engine = engine};
    struct row_sink sink = {.context = rows, .open = open_rows, .row = keep_row};
    double started = dea_clock();
    rows->status = scene->netlist != NULL ? run_supervised(&copy, &options, &sink, &rows->result, &rows->error)
                                          : run_native(&copy, NULL, &options, &sink, &rows->result, &rows->error);
    rows->result.stats_run.wall_s = dea_clock() - started;
}

void run_with_control(const struct dea_scene *scene, double accuracy, const struct cosim_control *control,
                      size_t samples, struct coupled_rows *rows) {
    struct dea_scene copy = *scene;
    memset(rows, 0, sizeof *rows);
    copy.accuracy = accuracy;
    copy.sample = scene->stop / (double)samples;
    struct dea_report silent = {0};
    struct dea_run_options options = {.report = &silent};
    struct row_sink sink = {.context = rows, .open = open_rows, .row = keep_row};
    struct dea_netlist netlist = {0};
    double started = dea_clock();
    rows->status = cosim_read_netlist(&copy, false, NULL, &netlist, &rows->error);
    if (rows->status == DEA_OK)
        rows->status = cosim_run(&copy, &netlist, &options, control, &sink, NULL, &rows->result, &rows->error);
    dea_netlist_clear(&netlist);
    rows->result.stats_run.wall_s = dea_clock() - started;
}

void run_with_horizon(const struct dea_scene *scene, double accuracy, double horizon, size_t samples,
                      struct coupled_rows *rows) {
    run_with_control(scene, accuracy, &(struct cosim_control){.horizon = horizon}, samples, rows);
}

void free_rows(struct coupled_rows *rows) {
    dea_result_clear(&rows->result);
    free(rows->signals);
    free(rows->times);
    free(rows->values);
    memset(rows, 0, sizeof *rows);
}

int find_signal(const struct coupled_rows *rows, const char *name) {
    for (size_t i = 0; i < rows->columns; i++)
        if (strcmp(rows->signals[i].name, name) == 0)
            return (int)i;
    return -1;
}

/* ---- differences ---- */

static double difference(const struct coupled_rows *rows, int column, const double *reference, size_t stride) {
    return relative_difference(rows->values + column, rows->columns, reference, stride, rows->count);
}

static const char *const port_names[DEA_ZONES] = {"left.port_voltage", "right.port_voltage"};

struct coupled_error compare_with_trace(const struct coupled_rows *rows, const struct coupled_trace *trace) {
    if (rows->count != trace->count)
        return (struct coupled_error){NAN, NAN};
    struct coupled_error error = {difference(rows, find_signal(rows, "x"), trace->x, 1), 0.0};
    for (int k = 0; k < DEA_ZONES; k++)
        if (find_signal(rows, port_names[k]) >= 0)
            error.port = fmax(error.port, difference(rows, find_signal(rows, port_names[k]), trace->port[k], 1));
    return error;
}

struct coupled_error compare_rows(const struct coupled_rows *rows, const struct coupled_rows *reference) {
    if (rows->count != reference->count || rows->columns != reference->columns)
        return (struct coupled_error){NAN, NAN};
    struct coupled_error error = {0.0, 0.0};
    for (size_t i = 0; i < rows->columns; i++) {
        const char *name = rows->signals[i].name, *dot = strrchr(name, '.');
        bool position = strcmp(dot != NULL ? dot + 1 : name, "x") == 0;
        if (!position && (dot == NULL || strcmp(dot, ".port_voltage") != 0))
            continue;
        double one = difference(rows, (int)i, reference->values + i, reference->columns);
        if (position)
            error.x = fmax(error.x, one);
        else
            error.port = fmax(error.port, one);
    }
    return error;
}
