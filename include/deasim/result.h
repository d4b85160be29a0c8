/* What a run produces: sampled signals, extremes, events, energy balance, statistics; and the files they go to. */
#ifndef DEASIM_RESULT_H
#define DEASIM_RESULT_H

#include "deasim/scene.h"

#include <stdio.h>

struct dea_signal {
    char name[96]; /* "x", "left.voltage", "DEB.right.charge", ... */
    char unit[16]; /* SI: "m", "m/s", "V", "C", "A", "F", "V/m", "1", "N", "Pa" */
};

/* Extremes over the whole run, not only at the samples. */
struct dea_signal_stats {
    double min, max, final;
    double t_min, t_max; /* s */
};

struct dea_event {
    double time; /* s */
    enum dea_event_kind kind;
    int device;   /* index into the scene's devices */
    int zone;     /* DEA_ZONES index, -1 for the platform */
    bool cleared; /* false: the limit was crossed; true: the device came back from it */
};

/* Energy audit, J. in = stored + dissipated + imbalance * exchanged (signed). */
struct dea_energy {
    double in;               /* electrical work of the sources plus work of the load */
    double electrical, load; /* its two parts */
    double stored;           /* change of stored energy */
    double dissipated;
    double branch, damping, resistive, leakage, stop; /* parts of dissipated */
    double exchanged;                                 /* total energy moved in and out, the denominator */
    double imbalance;                                 /* |in - stored - dissipated| / exchanged */
};

struct dea_run_stats {
    long circuit_points, circuit_rejected, circuit_iterations;
    long plant_steps, plant_rejected, residuals, jacobians, newton_iterations, restarts;
    double wall_s;
    char mode[16]; /* static, native, linear, cosim */
};

/* From this sensitivity on a run says that its accuracy may not be as asked: see docs/accuracy.md. */
#define DEA_SENSITIVE 4.0

struct dea_netlist_measure {
    char name[96];
    double value;
    bool failed;
};

struct dea_result {
    enum dea_status
        status; /* DEA_OK done, DEA_STOPPED by an event, negative failed; files and numbers are valid up to t_end */
    char reason[2048];              /* why it ended early or failed; empty when done */
    double t_end;                   /* s */
    struct dea_signal *signals;     /* owned, signal_count entries */
    struct dea_signal_stats *stats; /* owned, same order */
    size_t signal_count;
    struct dea_event *events;          /* owned, in time order */
    size_t event_count, event_dropped; /* dropped: beyond the list's limit, only counted */
    struct dea_energy energy;
    double coupling_error; /* relative difference of port work on both sides; 0 without a circuit */
    double sensitivity;    /* how many times the motion multiplied small errors, of the worst device; a mere swing: 1 */
    struct dea_netlist_measure *measures; /* owned */
    size_t measure_count;
    int relaxed;          /* how often the circuit's tolerances had to be loosened to get through; 0: never */
    bool circuit_gave_up; /* failed in the circuit's own time steps, not in a device */
    struct dea_run_stats stats_run;
};

/* ---- recorder: streams samples to result files ---- */

struct dea_recorder;

/* Makes a result folder and its parents; fine when it is there. DEA_ERR_INPUT when it cannot be made. */
enum dea_status dea_directory_make(const char *directory, struct dea_error *error);

/* Opens DIR/result.csv, result.raw, result.h5 as asked by `formats` (enum dea_format bits), creating DIR and its
 * parents. Result, picture and summary files of an earlier run in DIR are removed first, so nothing there passes for
 * this run's. Files are written under their final name with the rows so far always readable after a flush; raw's point
 * count is patched on flush and close. DEA_ERR_INPUT when the folder cannot be made or written. `title` (may be NULL)
 * goes into raw and HDF5 headers. `signals` is read here only. A program that may meet a file size limit ignores
 * SIGXFSZ, else the limit ends it. */
enum dea_status dea_recorder_open(const char *directory, unsigned formats, const char *title,
                                  const struct dea_signal *signals, size_t signal_count, struct dea_recorder **recorder,
                                  struct dea_error *error);

/* Appends one row (time in s, signal_count values in SI). No allocation; flushes about once a second of wall time.
 * DEA_ERR_OUTPUT when the disk is full or similar: the message names each incomplete file and how many of its rows are
 * good; every file still ends with a whole row. Nothing is written after that. */
enum dea_status dea_recorder_append(struct dea_recorder *recorder, double time, const double *values,
                                    struct dea_error *error);

/* Makes every row so far readable from outside, also if the program is killed afterwards. Same failures as append. */
enum dea_status dea_recorder_flush(struct dea_recorder *recorder, struct dea_error *error);

/* Flushes, patches counts, closes, frees; NULL is fine. On a write error says in the message which file is incomplete.
 */
enum dea_status dea_recorder_close(struct dea_recorder *recorder, struct dea_error *error);

/* ---- summary ---- */

/* Serialises the contract's JSON object (design: one object, keys scene ... stats). Returned text is malloc'd; NULL
 * when out of memory. */
char *dea_summary_json(const struct dea_scene *scene, const struct dea_result *result);

/* Writes the JSON to DIR/summary.json, atomically (temporary file, then rename). */
enum dea_status dea_summary_write(const char *directory, const struct dea_scene *scene, const struct dea_result *result,
                                  struct dea_error *error);

/* Prints the summary a person reads: status, extremes in field units, events, energy and coupling error, statistics. */
void dea_summary_print(const struct dea_scene *scene, const struct dea_result *result, FILE *file);

/* Frees what the result owns. */
void dea_result_clear(struct dea_result *result);

/* ---- pictures ---- */

/* Draws DIR/result.csv as DIR/result.png with gnuplot: voltages, displacement, true field against its limit, energy.
 * *png_path (malloc'd) names the file. DEA_ERR_INPUT when there is no result, DEA_ERR_OUTPUT when gnuplot fails. */
enum dea_status dea_plot_run(const char *directory, char **png_path, struct dea_error *error);

#endif
