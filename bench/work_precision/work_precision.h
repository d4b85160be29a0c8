/* Run time against error of deasim and its competitors. A scene has curves (one per program and way of solving), a
 * curve has points (one per setting), a point has an error against the scene's reference and wall times. */
#ifndef DEASIM_BENCH_WORK_PRECISION_H
#define DEASIM_BENCH_WORK_PRECISION_H

#include "process.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

enum { MAX_SIGNALS = 3, MAX_ROUNDS = 15, MAX_ARGUMENTS = 24, MAX_STARTS = 8, PATH_ROOM = 1024 };

/* ---- traces: results read back ---- */

/* Signals over time. The first one is the displacement, the others are port voltages. */
struct trace {
    size_t count;
    int signal_count;
    double *time;                 /* s, owned */
    double *signals[MAX_SIGNALS]; /* m and V, owned */
};

/* Reads a SPICE raw file (binary, real) by vector names, or a table of numbers whose columns are time and the signals.
 * `scale` turns the first signal into m. False with a word on stderr. */
bool trace_read_raw(const char *path, const char *const *names, int count, double scale, struct trace *trace);
bool trace_read_table(const char *path, int count, struct trace *trace);
void trace_clear(struct trace *trace);

/* Relative L2-in-time error of x, and the largest of the port voltages; the latter relative to the largest port. */
struct trace_error {
    double x, ports;
};
struct trace_error trace_compare(const struct trace *trace, const struct trace *reference);

/* ---- points ---- */

struct point {
    char curve[32], setting[80];
    char problem[200];              /* empty: all well */
    char *arguments[MAX_ARGUMENTS]; /* of the timed command, owned; none for points timed elsewhere */
    char output[PATH_ROOM];         /* where its stdout goes; empty: nowhere */
    struct trace_error error;
    double own;               /* s, the least solve time the program itself reports; NAN: none */
    double walls[MAX_ROUNDS]; /* s */
    int wall_count;
    double cpu;                      /* s, the least of the rounds; of the first run until then */
    double relaxed;                  /* how often deasim loosened the circuit's tolerances */
    double points, iterations, work; /* accepted circuit points, Newton iterations, residual or right-hand side calls */
    bool chosen;                     /* is timed: on its curve's front */
};

/* What a program takes to start: its command with next to nothing to solve. */
struct start {
    char curve[32];
    char *arguments[MAX_ARGUMENTS]; /* owned; none where a script tells */
    double least;                   /* s */
};

struct scene_entry {
    const char *name, *title;
    const char *scene;   /* YAML, from the top of the tree */
    const char *twin;    /* the same with native sources, and the reference; NULL: none */
    bool circuit;        /* the scene has a netlist */
    bool linear;         /* ... that deasim solves without ngspice */
    bool ode;            /* small enough for the scripts */
    bool exports;        /* plain ngspice can run it */
    bool overhead;       /* the electronics alone are timed as well */
    bool only_overhead;  /* ... and nothing else */
    double longest_step; /* s, of the coarsest ngspice run */
    double reference;    /* accuracy of the reference */
    double loosest;      /* exponent range of the accuracies */
    double tightest;
    double share; /* of a campaign's time, in shares of an ordinary scene; 0: 1 */
};

extern const struct scene_entry scene_entries[];
extern const size_t scene_entry_count;

/* A scene being measured. */
struct bench {
    const char *program, *folder; /* deasim; scratch files */
    const struct scene_entry *entry;
    double limit;         /* s of processor time for one run */
    double began, budget; /* s, of this scene */
    int rounds;           /* at most */
    bool quick;
    char problem[PATH_ROOM + 32];   /* of the scripts, JSON */
    double stop;                    /* s */
    const char *names[MAX_SIGNALS]; /* deasim's signals */
    const char *nodes[MAX_SIGNALS]; /* ngspice's vectors */
    int signal_count;
    struct trace reference;
    double reference_accuracy;
    double reference_doubt;  /* difference to the run at ten times that; NAN: none */
    double reference_second; /* difference to the tightest run of scipy; NAN: none */
    int grid_left_out;       /* settings of ngspice there was no time for */
    struct point *points;    /* owned */
    size_t point_count;
    struct start starts[MAX_STARTS];
    int start_count;
};

/* New point of a curve; its memory moves with the next one. */
struct point *bench_add_point(struct bench *bench, const char *curve, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
void point_set_command(struct point *point, const char *const *arguments);
void point_fail(struct point *point, const char *format, ...) __attribute__((format(printf, 2, 3)));
/* Counters and solve time out of a run's output: the summary of deasim, the account of ngspice. */
void bench_set_start(struct bench *bench, const char *curve, const char *const *arguments, double least);
/* Seconds of solving: the least times of the process and of its start, one less the other, but no less than what such a
 * difference resolves; NAN where the start took longer, as it may in a disturbed pass. What a script tells of itself is
 * solving alone. */
#define SMALLEST_DIFFERENCE 2e-4
double point_solve(const struct bench *bench, const struct point *point);
/* Least and median seconds of the process, with the start of a script's interpreter. */
double point_whole(const struct bench *bench, const struct point *point);
double point_whole_median(const struct bench *bench, const struct point *point);
bool is_script(const char *curve);
/* A stage of a scene's measurement gets a share (0 to 1) of the scene's time from now on. */
double bench_deadline(const struct bench *bench, double share);
bool is_late(double deadline);
void deasim_read_output(struct point *point);
void ngspice_read_output(struct point *point);
double point_error(const struct point *point);
double point_median(const struct point *point);
double point_least(const struct point *point);

/* ---- curves ---- */

bool deasim_prepare(struct bench *bench); /* signals and end time */
bool deasim_reference(struct bench *bench);
void deasim_curve(struct bench *bench, const char *scene, const char *curve, const char *engine);
void ngspice_curve(struct bench *bench);
void fixed_exchange_curve(struct bench *bench);
/* ngspice alone on the electronics with plain capacitors in the device's place, at the tolerances of a run of deasim.
 */
void fixed_capacitor_curve(struct bench *bench);
void script_curves(struct bench *bench);
/* Whether a curve's process timed out, in a word for a point's problem; else what it said. */
void point_blame(struct point *point, const struct process_result *result);

/* Marks the points worth timing of one curve: those no other beats in error and time of the first run. */
void choose_front(struct bench *bench, const char *curve);

/* ---- results ---- */

enum time_kind { TIME_WHOLE, TIME_SOLVING };

/* Least seconds a curve needs for an error, by straight lines between its points on log axes; the fastest point where
 * all are better; NAN where none is good enough. */
double curve_time(const struct bench *bench, const char *curve, double error, enum time_kind kind);
double curve_least_error(const struct bench *bench, const char *curve);
bool has_curve(const struct bench *bench, const char *curve);
/* deasim's own way for the scene: what `deasim run` takes. */
const char *own_curve(const struct bench *bench);

void write_rows(const struct bench *bench, FILE *file);     /* CSV with its head */
void write_section(const struct bench *bench, FILE *file);  /* tables of one scene */
void write_summary(const struct bench *bench, FILE *file);  /* its row among the scenes */
void write_overhead(const struct bench *bench, FILE *file); /* rows: coupled against the electronics alone */

#endif
