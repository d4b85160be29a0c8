/* Runs a scene with a netlist and keeps its rows in memory; compares them with a reference or another run. */
#ifndef DEASIM_TEST_COUPLED_CAPTURE_H
#define DEASIM_TEST_COUPLED_CAPTURE_H

#include "circuits.h"
#include "coupled_scenes.h"
#include "deasim/run.h"

/* A folder of its own, entered by `enter_folder` and removed with all in it by `leave_folder`. */
struct test_folder {
    char path[64], back[4096];
};
void enter_folder(struct test_folder *folder);
void leave_folder(const struct test_folder *folder);
/* The same around a test of cmocka. */
int set_up_folder(void **state);
int tear_down_folder(void **state);

/* Scene from a device's YAML (a mapping, one line) and a netlist in the present folder. Aborts with the message when it
 * is refused. `extra` are further lines of the scene, "" for none. */
void make_scene(const char *device, const char *netlist, double stop, const char *extra, struct dea_scene *scene);

/* The same for a drive circuit, which is written to circuit.cir. */
void make_circuit_scene(const char *device, const struct drive_circuit *circuit, const char *extra,
                        struct dea_scene *scene);

/* The same for one of the scenes of coupled_scenes.h; events are not watched. */
void make_listed_scene(const struct coupled_scene *listed, struct dea_scene *scene);

struct coupled_rows {
    enum dea_status status;
    struct dea_error error;
    struct dea_result result;
    struct dea_signal *signals;
    size_t columns, count; /* without time */
    double *times, *values;
};

/* Runs a scene as dea_run_scene does, `samples` rows after the first, at this accuracy. */
void run_scene(const struct dea_scene *scene, enum dea_engine_choice engine, double accuracy, size_t samples,
               struct coupled_rows *rows);
/* The same in this process, with the coupling steered; see cosim/cosim.h. */
struct cosim_control;
void run_with_control(const struct dea_scene *scene, double accuracy, const struct cosim_control *control,
                      size_t samples, struct coupled_rows *rows);
/* With an exchange every `horizon` (s). */
void run_with_horizon(const struct dea_scene *scene, double accuracy, double horizon, size_t samples,
                      struct coupled_rows *rows);
void free_rows(struct coupled_rows *rows);

/* Column of a signal, or -1. */
int find_signal(const struct coupled_rows *rows, const char *name);

/* Relative L2 difference in time of x, and the larger one of both port voltages. NAN when rows are missing. */
struct coupled_error {
    double x, port;
};
struct coupled_error compare_with_trace(const struct coupled_rows *rows, const struct coupled_trace *trace);
struct coupled_error compare_rows(const struct coupled_rows *rows, const struct coupled_rows *reference);

#endif
