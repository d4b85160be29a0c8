/* Parts of the engine: running (engine.c), what ngspice is told at its start (settings.c), failures (verdict.c),
 * external numbers and samples (ports.c), what ngspice says (messages.c). */
#ifndef DEASIM_CIRCUIT_ENGINE_INTERNAL_H
#define DEASIM_CIRCUIT_ENGINE_INTERNAL_H

#include "circuit/deck_internal.h"
#include "circuit/engine.h"
#include "circuit/switches.h"

#define XSPICE /* Debian builds the library with code models; the header hides their functions otherwise */
#include <ngspice/sharedspice.h>

#define DEA_STEPS_KEPT 10    /* for the diagnosis of a collapse */
#define DEA_COMPLAINTS_MAX 6 /* errors kept for the message */

enum dea_step_verdict { DEA_STEP_ACCEPTED, DEA_STEP_REJECTED };

struct dea_step_record {
    double time, delta; /* s; time at the end of the step */
    enum dea_step_verdict verdict;
};

/* What ngspice has complained about since the load. */
struct dea_complaints {
    char *texts[DEA_COMPLAINTS_MAX]; /* owned */
    int count;
    int place;           /* index into netlist lines, -1: not known */
    int expect_detail;   /* lines to come that belong to the error before */
    bool exit_requested; /* ControlledExit: ngspice is unusable from now on */
    bool aborted;        /* the transient ended early */
    bool model_missing;  /* a code model that is not known */
    bool misread;        /* ngspice took the circuit but not a value in it: bad input, found late */
    bool searching;      /* for the trouble behind a failed start: errors are no news, only `worst` counts */
    bool searched, search_failed;
    bool measuring;            /* between "Measurements for ..." and the end of the run */
    char worst[128];           /* unknown ngspice names as the trouble */
    char singular[128];        /* node of the last singular matrix */
    char measure_trouble[160]; /* said before the .measure line it is about */
    char last_words[160];      /* last line that was no error, for a failure nothing else explains */
};

/* One EXTERNAL source. */
struct dea_external_source {
    char *name;           /* as ngspice spells it: "v.xdea.vc0"; owned */
    const char *asked_as; /* ngspice's own pointer to that name, once seen */
    int instance, port;
    enum dea_external which;
    int next;             /* index of the source ngspice asked for after this one */
    double scale;         /* ngspice sees value * scale */
    double told_at, told; /* s; what it has seen */
};

/* Where in ngspice's vector list a value of the sample comes from; -1: ground. */
struct dea_port_vectors {
    int p, n, film, current, charge;
    double charge_unit; /* C */
};

struct dea_engine {
    const struct dea_netlist *netlist;
    const struct dea_deck *deck;
    const struct dea_circuit_device *devices;
    const struct dea_deck_options *options;
    const struct dea_engine_callbacks *callbacks;
    struct dea_error callback_error;
    struct dea_error *run_error; /* of the run in progress: callback_error, or NULL */

    struct dea_external_source *sources; /* owned */
    int source_count, last_source;       /* the latter: asked last */
    struct dea_port_vectors *vectors;    /* owned, DEA_ZONES per instance */
    int *node_vectors;                   /* owned, -1: ground */
    bool vectors_known;
    int time_vector;
    struct dea_port_sample *samples; /* owned, DEA_ZONES per instance */
    double *node_values;             /* owned */

    double *breakpoints; /* owned, s */
    int breakpoint_count;

    bool running, stop_sent;
    enum dea_status verdict;       /* of the callbacks: DEA_OK while going on */
    double floor;                  /* shortest step we ask for, s */
    double longest, last_step;     /* s: ngspice's largest step, and the last it accepted */
    struct dea_switches *switches; /* owned; NULL: none */
    struct dea_step_record steps[DEA_STEPS_KEPT];
    long step_count;     /* candidates so far */
    long tiny_steps;     /* candidates in a row below the collapse limit */
    double window_start; /* time when the current window of candidates began, s */
    long window_first;
    int search_steps; /* candidates a search for trouble may still take */
    struct dea_engine_stats stats;

    struct dea_complaints complaints;
    struct dea_listing *listing;         /* being read back; NULL otherwise */
    bool listing_cut;                    /* a line of it was lost: out of memory */
    struct dea_engine_measure *measures; /* owned */
    int measure_count;
};

/* ---- engine.c ---- */
#define DEA_COMMAND_MAX 4000 /* bytes of a command */
int dea_engine_command(const char *text);

/* ---- settings.c ---- */
void dea_engine_settle(void);
/* Loads the code models that lie beside the library a function belongs to. Once is enough for a process; a circuit that
 * needs none is not held up by them: in every iteration ngspice goes through the kinds of parts it knows many times,
 * and two of three come from code models (8 % of a converter's run). */
enum dea_status dea_engine_add_code_models(void *function, struct dea_error *error);

/* ---- verdict.c ---- */
/* What an early end of the transient means, as a status with its message. */
enum dea_status dea_engine_judge_failure(struct dea_engine *engine, struct dea_error *error);

/* ---- ports.c ---- */
enum dea_status dea_engine_prepare_ports(struct dea_engine *engine, struct dea_error *error);
void dea_engine_clear_ports(struct dea_engine *engine);
double dea_engine_external_value(struct dea_engine *engine, const char *name, double t);
/* An external number of one time is asked for once between two steps: from the next on it may be another. */
void dea_engine_forget_values(struct dea_engine *engine);
/* Finds the wanted vectors in ngspice's list; DEA_ERR_INPUT names a node that does not exist. */
enum dea_status dea_engine_map_vectors(struct dea_engine *engine, const vecvaluesall *values, struct dea_error *error);
/* Index of a node's or branch's vector; -1: ground, -2: not there. */
int dea_engine_find_vector(const vecvaluesall *values, const char *name);
void dea_engine_fill_samples(struct dea_engine *engine, const vecvaluesall *values);

/* ---- messages.c ---- */
/* Takes one line of ngspice's output. */
void dea_engine_hear(struct dea_engine *engine, const char *line);
void dea_engine_clear_complaints(struct dea_engine *engine);
/* Points the complaint at the line of a node or element named as ngspice does: "left", "xarm.mid", "l1#branch",
 * `node "b"`; at none when it is not found. */
void dea_engine_place_complaint(struct dea_engine *engine, const char *name);
/* Fails with `what`, the collected errors and `tail` (may be NULL), "file:line: " in front where known. */
enum dea_status dea_engine_complain(const struct dea_engine *engine, enum dea_status status, const char *what,
                                    const char *tail, struct dea_error *error);
/* Appends the last steps to a message. */
void dea_engine_describe_steps(const struct dea_engine *engine, char *text, size_t size);

#endif
