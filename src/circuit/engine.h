/* libngspice as a transient engine with callbacks. ngspice keeps global state: one engine per process (run it in a
 * child process, base/isolate.h). The only room that includes sharedspice.h. */
#ifndef DEASIM_CIRCUIT_ENGINE_H
#define DEASIM_CIRCUIT_ENGINE_H

#include "circuit/deck.h"

/* One port at an accepted point. ngspice reports the iterate its elements were last evaluated at: voltages carry the
 * leftover of Newton's iteration (up to reltol, in practice second order in the step), the charge is the exact integral
 * of the current. */
struct dea_port_sample {
    double port_voltage; /* between the pins, V */
    double film_voltage; /* across the film, V; the same without R_e */
    double charge;       /* Q on the film, C: ngspice's own state */
    double current;      /* dQ/dt as ngspice's integration formula sees it, A; leakage not included */
};

/* An accepted point. ports holds DEA_ZONES entries per instance: ports[instance * DEA_ZONES + port]. */
struct dea_circuit_point {
    double time; /* s */
    const struct dea_port_sample *ports;
    const double *nodes; /* voltages of dea_deck_options.nodes, V */
};

enum dea_message_kind { DEA_MESSAGE_NOTE, DEA_MESSAGE_WARNING, DEA_MESSAGE_ERROR };

/* All callbacks run inside dea_engine_run, in its thread. Optional ones may be NULL. */
struct dea_engine_callbacks {
    void *context;
    /* Value of an external number at time t, SI. Asked once in the iterations of one step at one time. `port` counts
     * electroded zones. */
    double (*port_value)(void *context, int instance, int port, enum dea_external which, double t);
    /* Before the step from t to t + *delta; may shorten *delta, a longer one is ignored. Optional. */
    void (*before_step)(void *context, double t, double *delta);
    /* An accepted point; first t = 0 (not with uic). DEA_OK goes on, DEA_STOPPED ends the run here in order, a negative
     * status ends it as failed (*error filled by the callback). */
    enum dea_status (*accepted)(void *context, const struct dea_circuit_point *point, struct dea_error *error);
    /* A classified message of ngspice, with "file:line: " in front where the line is known. Optional. */
    void (*message)(void *context, enum dea_message_kind kind, const char *text);
};

struct dea_engine_measure {
    char name[96];
    double value;
    bool failed;
};

struct dea_engine_stats {
    long points;     /* accepted */
    long rejected;   /* by ngspice: truncation error or no convergence */
    long iterations; /* of Newton's method: how often ngspice asked for one and the same external number */
    double shortest; /* accepted step, s */
    double reached;  /* last accepted time, s */
};

struct dea_engine;

/* The loaded circuit as ngspice sees it: subcircuits flattened, numbers put in, one element a line, lower case. */
struct dea_listing {
    char **lines; /* owned */
    int count;
};

/* Loads libngspice without starting it: what a process does once before it forks several that open an engine.
 * DEA_ERR_INTERNAL when it is not installed. */
enum dea_status dea_engine_preload(struct dea_error *error);

/* Starts ngspice in this process: C number locale, nobody's .spiceinit or spinit; code models come with a netlist that
 * needs them.
 * DEA_ERR_SOLVER when the library is unusable, DEA_ERR_INTERNAL when an engine exists already. */
enum dea_status dea_engine_open(struct dea_engine **engine, struct dea_error *error);

/* Loads a deck, replacing the one before; netlist and deck must outlive the run. DEA_ERR_INPUT with the first error's
 * file:line. */
enum dea_status dea_engine_load(struct dea_engine *engine, const struct dea_netlist *netlist,
                                const struct dea_deck *deck, const struct dea_circuit_device *devices,
                                const struct dea_deck_options *options, const struct dea_engine_callbacks *callbacks,
                                struct dea_error *error);

/* Reads the loaded circuit back. The caller clears the listing, also after a failure. */
enum dea_status dea_engine_list(struct dea_engine *engine, struct dea_listing *listing, struct dea_error *error);
void dea_listing_clear(struct dea_listing *listing);

/* Points where external numbers jump: ngspice will land on them. After load, before run. */
enum dea_status dea_engine_add_breakpoint(struct dea_engine *engine, double t, struct dea_error *error);

/* Film charge (C) a port of an instance starts from, where the deck's own is not meant. With uic, after load, before
 * run.
 */
void dea_engine_start_charge(struct dea_engine *engine, int instance, int port, double charge);

/* Where a failure's message begins to list steps. */
#define DEA_LAST_STEPS "last steps (t, dt):"

/* Runs to the end. DEA_OK at the end, DEA_STOPPED when a callback stopped it, DEA_ERR_INPUT when ngspice refuses the
 * circuit, DEA_ERR_SOLVER when it gives up (message: why, where, worst node, last steps). */
enum dea_status dea_engine_run(struct dea_engine *engine, struct dea_error *error);

/* Evaluates the netlist's .measure lines on a raw file of the circuit's unknowns instead of a run of its own.
 * dea_engine_measures has the results. */
enum dea_status dea_engine_measure_file(struct dea_engine *engine, const char *raw_path, struct dea_error *error);

/* Results of the .measure lines after a run; owned by the engine until the next load. */
const struct dea_engine_measure *dea_engine_measures(const struct dea_engine *engine, int *count);
void dea_engine_stats(const struct dea_engine *engine, struct dea_engine_stats *stats);

/* Unloads the circuit and frees. ngspice itself stays in the process; another open is allowed unless ngspice asked to
 * exit. */
void dea_engine_close(struct dea_engine *engine);

#endif
