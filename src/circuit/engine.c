/* Runs libngspice: start, load, transient with callbacks, verdict. */
#include "circuit/engine_internal.h"

#include "base/library.h"
#include "circuit/netlist_internal.h"

#include <errno.h>
#include <fcntl.h>
#include <locale.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define STALL_WINDOW 100000 /* candidates that must bring the run forward ... */
#define STALL_SHARE 1e-6    /* ... by this share of its length */
#define TINY_WINDOW 5000    /* candidates in a row, all shorter than ... */
#define TINY_SHARE 1e-11    /* ... this share of the run, are a collapse */

#define STEP_MARGIN 0.9 /* of the step ngspice proposes, where that is between these parts of the last one */
#define LEAST_RATIO 0.5
#define LARGEST_RATIO 1.9
/* Of a rejected step, at least, for the next attempt: right after a corner ngspice's estimate may send it down a
 * hundredfold, to where it measures rounding only and every step is too long. */
#define LEAST_CUT 0.1

/* The engine ngspice's callbacks serve. ngspice itself is one per process, and so is this. */
static struct dea_engine *current_engine;
static bool library_started, library_dead, code_models_added;

/* libngspice, loaded when the first circuit needs it; its functions by their names without ngSpice_. */
static struct {
    __typeof__(ngSpice_Init) *init;
    __typeof__(ngSpice_Init_Sync) *init_sync;
    __typeof__(ngSpice_Command) *command;
    __typeof__(ngSpice_Circ) *circ;
    __typeof__(ngSpice_SetBkpt) *set_breakpoint;
    __typeof__(ngCM_Input_Path) *input_path;
} spice;

enum dea_status dea_engine_preload(struct dea_error *error) {
    const struct dea_library_function functions[] = {{"ngSpice_Init", &spice.init},
                                                     {"ngSpice_Init_Sync", &spice.init_sync},
                                                     {"ngSpice_Command", &spice.command},
                                                     {"ngSpice_Circ", &spice.circ},
                                                     {"ngSpice_SetBkpt", &spice.set_breakpoint},
                                                     {"ngCM_Input_Path", &spice.input_path}};
    return dea_library_load("libngspice.so.0", "libngspice0", functions, sizeof functions / sizeof functions[0], error);
}

/* ---- steps ---- */

static void record_step(struct dea_engine *engine, double time, double delta, enum dea_step_verdict verdict) {
    engine->steps[engine->step_count++ % DEA_STEPS_KEPT] = (struct dea_step_record){time, delta, verdict};
}

/* Ends the run at the point ngspice is at: a stop condition that is always true, the only way its interface offers. */
static void stop_run(struct dea_engine *engine, enum dea_status verdict) {
    if (engine->verdict == DEA_OK)
        engine->verdict = verdict;
    if (engine->stop_sent)
        return;
    engine->stop_sent = true;
    dea_engine_command("stop when time > -1");
}

/* A run that does not get on is ended, also when every single step converges. */
static void check_progress(struct dea_engine *engine, double time, double delta) {
    bool tiny = delta < TINY_SHARE * engine->options->stop;
    if (!tiny)
        engine->tiny_steps = 0;
    else
        engine->tiny_steps++;
    bool stalled = false;
    if (engine->step_count - engine->window_first >= STALL_WINDOW) {
        stalled = time - engine->window_start < STALL_SHARE * engine->options->stop;
        engine->window_first = engine->step_count;
        engine->window_start = time;
    }
    if ((stalled || engine->tiny_steps >= TINY_WINDOW) && engine->verdict == DEA_OK) {
        char steps[900];
        dea_engine_describe_steps(engine, steps, sizeof steps);
        stop_run(engine, dea_fail(engine->run_error, DEA_ERR_SOLVER, "%s: the run is not advancing past t = %.9g s; %s",
                                  engine->netlist->files[0], time, steps));
    }
}

/* ---- ngspice's callbacks ---- */

static int hear_line(char *line, int id, void *context) {
    (void)id;
    (void)context;
    if (current_engine != NULL)
        dea_engine_hear(current_engine, line);
    return 0;
}

static int note_exit(int code, NG_BOOL immediate, NG_BOOL quit, int id, void *context) {
    (void)code;
    (void)immediate;
    (void)quit;
    (void)id;
    (void)context;
    library_dead = true;
    if (current_engine != NULL)
        current_engine->complaints.exit_requested = true;
    return 0;
}

static int give_value(double *value, double t, char *name, int id, void *context) {
    (void)id;
    (void)context;
    *value = current_engine != NULL ? dea_engine_external_value(current_engine, name, t) : 0.0;
    return 0;
}

/* ngspice takes the very step its truncation estimate allows; where the solution bends more in the next one it rejects
 * that: one in six. Steps that grow fast, that a corner or a limit has cut, or the longest ones keep their length: a
 * corner must be met, not approached. */
static double keep_margin(const struct dea_engine *engine, double delta) {
    bool free = delta > LEAST_RATIO * engine->last_step && delta < LARGEST_RATIO * engine->last_step &&
                delta < STEP_MARGIN * engine->longest;
    return free ? STEP_MARGIN * delta : delta;
}

static int steer_step(double time, double *delta, double old_delta, int redo, int id, int location, void *context) {
    (void)id;
    (void)context;
    struct dea_engine *engine = current_engine;
    if (engine != NULL && engine->complaints.searching && --engine->search_steps == 0) {
        engine->complaints.search_failed = true;
        stop_run(engine, DEA_ERR_SOLVER);
    }
    if (engine == NULL || !engine->running)
        return 0;
    if (location == 0) { /* before the step from time to time + *delta */
        dea_engine_forget_values(engine);
        if (engine->verdict != DEA_OK)
            return 0;
        const struct dea_engine_callbacks *callbacks = engine->callbacks;
        double wanted = *delta;
        if (callbacks->before_step != NULL)
            callbacks->before_step(callbacks->context, time, &wanted);
        if (engine->switches != NULL)
            wanted = fmin(wanted, dea_switches_limit(engine->switches, fmin(wanted, *delta), engine->options->stop));
        wanted = fmin(wanted, keep_margin(engine, *delta));
        if (wanted < *delta)
            *delta = fmax(wanted, fmin(*delta, engine->floor));
        return 0;
    }
    if (redo) { /* rejected; time is back at the start of the step */
        engine->stats.rejected++;
        record_step(engine, time + old_delta, old_delta, DEA_STEP_REJECTED);
        check_progress(engine, time, old_delta);
        *delta = fmax(*delta, LEAST_CUT * old_delta);
        return 0;
    }
    record_step(engine, time, old_delta, DEA_STEP_ACCEPTED);
    engine->last_step = old_delta;
    check_progress(engine, time, old_delta);
    if (engine->stats.points > 1 && (engine->stats.shortest == 0.0 || old_delta < engine->stats.shortest))
        engine->stats.shortest = old_delta;
    return 0;
}

static int take_point(pvecvaluesall values, int count, int id, void *context) {
    (void)count;
    (void)id;
    (void)context;
    struct dea_engine *engine = current_engine;
    if (engine == NULL || !engine->running || engine->verdict != DEA_OK)
        return 0;
    enum dea_status status = DEA_OK;
    if (!engine->vectors_known)
        status = dea_engine_map_vectors(engine, values, engine->run_error);
    if (status == DEA_OK) {
        double time = values->vecsa[engine->time_vector]->creal, stop = engine->options->stop;
        if (fabs(time - stop) < 1e-10 * dea_deck_longest_step(engine->options)) /* ngspice may end a little early */
            time = stop;
        dea_engine_fill_samples(engine, values);
        if (engine->switches != NULL)
            dea_switches_follow(engine->switches, time, values);
        engine->stats.points++;
        engine->stats.reached = time;
        struct dea_circuit_point point = {.time = time, .ports = engine->samples, .nodes = engine->node_values};
        const struct dea_engine_callbacks *callbacks = engine->callbacks;
        if (callbacks->accepted != NULL)
            status = callbacks->accepted(callbacks->context, &point, engine->run_error);
    }
    if (status != DEA_OK)
        stop_run(engine, status);
    return 0;
}

static int ignore_vectors(pvecinfoall info, int id, void *context) {
    (void)info;
    (void)id;
    (void)context;
    return 0;
}

/* ---- start ---- */

int dea_engine_command(const char *text) {
    char buffer[DEA_COMMAND_MAX];
    snprintf(buffer, sizeof buffer, "%s", text);
    return spice.command(buffer);
}

static enum dea_status make_empty_file(const char *name, const char *folder, struct dea_error *error) {
    int file = open(name, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
    if (file < 0)
        return dea_fail(error, DEA_ERR_SOLVER, "cannot write into %s: %s", folder, strerror(errno));
    close(file);
    return DEA_OK;
}

/* Initialises ngspice from a folder of its own that holds an empty .spiceinit: ngspice runs the one of the current
 * folder, or else the one of the home folder. And an empty spinit: the system's loads all code models. */
static enum dea_status start_in_folder(const char *folder, struct dea_error *error) {
    enum dea_status status = make_empty_file(".spiceinit", folder, error);
    if (status == DEA_OK)
        status = make_empty_file("spinit", folder, error);
    int failed = 0;
    if (status == DEA_OK) {
        setenv("SPICE_SCRIPTS", folder, 1);
        failed = spice.init(hear_line, NULL, note_exit, take_point, ignore_vectors, NULL, NULL);
        unsetenv("SPICE_SCRIPTS");
    }
    unlink(".spiceinit");
    unlink("spinit");
    DEA_TRY(status);
    if (failed || library_dead)
        return dea_fail(error, DEA_ERR_SOLVER, "libngspice does not start");
    return DEA_OK;
}

static enum dea_status start_library(struct dea_error *error) {
    /* nothing of the environment may divert ngspice's files */
    static const char *const variables[] = {"SPICE_LIB_DIR", "SPICE_SCRIPTS", "SPICE_PATH", "SPICE_ASCIIRAWFILE",
                                            "NGSPICE_INPUT_DIR"};
    for (size_t i = 0; i < sizeof variables / sizeof variables[0]; i++)
        unsetenv(variables[i]);
    setlocale(LC_NUMERIC, "C");
    const char *base = getenv("TMPDIR");
    char folder[4096];
    snprintf(folder, sizeof folder, "%s/deasim-XXXXXX", base != NULL && base[0] == '/' ? base : "/tmp");
    if (mkdtemp(folder) == NULL)
        return dea_fail(error, DEA_ERR_SOLVER, "cannot make a folder %s: %s", folder, strerror(errno));
    int back = open(".", O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    enum dea_status status = DEA_OK;
    if (back < 0 || chdir(folder) != 0)
        status = dea_fail(error, DEA_ERR_SOLVER, "cannot change folder: %s", strerror(errno));
    if (status == DEA_OK)
        status = start_in_folder(folder, error);
    if (back >= 0) {
        if (fchdir(back) != 0 && status == DEA_OK)
            status = dea_fail(error, DEA_ERR_SOLVER, "cannot change folder back: %s", strerror(errno));
        close(back);
    }
    rmdir(folder);
    DEA_TRY(status);
    int identity = 0;
    spice.init_sync(give_value, give_value, steer_step, &identity, NULL);
    dea_engine_settle();
    library_started = true;
    return DEA_OK;
}

enum dea_status dea_engine_open(struct dea_engine **engine, struct dea_error *error) {
    *engine = NULL;
    if (current_engine != NULL)
        return dea_fail(error, DEA_ERR_INTERNAL, "a circuit engine exists already in this process");
    if (library_dead)
        return dea_fail(error, DEA_ERR_SOLVER, "ngspice has asked to exit and cannot be used again in this process");
    struct dea_engine *made = calloc(1, sizeof *made);
    if (made == NULL)
        return dea_fail(error, DEA_ERR_MEMORY, "out of memory for the circuit engine");
    if (!library_started) {
        enum dea_status status = dea_engine_preload(error);
        if (status == DEA_OK)
            status = start_library(error);
        if (status != DEA_OK) {
            free(made);
            return status;
        }
    }
    made->complaints.place = -1;
    current_engine = made;
    *engine = made;
    return DEA_OK;
}

/* ---- load ---- */

/* Removes the circuit, its results and stop conditions. ngspice talks meanwhile, but those who listened to the run need
 * not be there any more. */
static void forget_circuit(struct dea_engine *engine) {
    current_engine = NULL;
    dea_engine_command("destroy all");
    dea_engine_command("delete all");
    dea_engine_command("remcirc");
    current_engine = engine;
}

static void unload(struct dea_engine *engine) {
    if (engine->netlist != NULL && !library_dead)
        forget_circuit(engine);
    dea_engine_clear_ports(engine);
    dea_engine_clear_complaints(engine);
    dea_switches_destroy(engine->switches);
    free(engine->measures);
    free(engine->breakpoints);
    engine->switches = NULL;
    engine->measures = NULL;
    engine->breakpoints = NULL;
    engine->measure_count = engine->breakpoint_count = 0;
    engine->netlist = NULL;
}

static enum dea_status add_code_models(struct dea_error *error) {
    if (code_models_added)
        return DEA_OK;
    void *function;
    memcpy(&function, &spice.circ, sizeof function); /* POSIX: both kinds of pointer are alike */
    DEA_TRY(dea_engine_add_code_models(function, error));
    code_models_added = true;
    return DEA_OK;
}

static bool load_circuit(struct dea_engine *engine) {
    int failed = spice.circ(engine->deck->lines);
    return !failed && engine->complaints.count == 0 && !engine->complaints.exit_requested;
}

enum dea_status dea_engine_load(struct dea_engine *engine, const struct dea_netlist *netlist,
                                const struct dea_deck *deck, const struct dea_circuit_device *devices,
                                const struct dea_deck_options *options, const struct dea_engine_callbacks *callbacks,
                                struct dea_error *error) {
    unload(engine);
    engine->netlist = netlist;
    engine->deck = deck;
    engine->devices = devices;
    engine->options = options;
    engine->callbacks = callbacks;
    DEA_TRY(dea_engine_prepare_ports(engine, error));
    engine->measures = calloc((size_t)netlist->measure_count + 1, sizeof *engine->measures);
    if (engine->measures == NULL)
        return dea_fail(error, DEA_ERR_MEMORY, "out of memory for the circuit");
    engine->measure_count = netlist->measure_count;
    for (int i = 0; i < netlist->measure_count; i++) {
        snprintf(engine->measures[i].name, sizeof engine->measures[i].name, "%s", netlist->measures[i]);
        engine->measures[i].failed = true;
    }
    if (netlist->has_event_parts)
        DEA_TRY(add_code_models(error));
    spice.input_path(netlist->folder);
    bool loaded = load_circuit(engine);
    if (!loaded && engine->complaints.model_missing && !code_models_added) {
        DEA_TRY(add_code_models(error));
        forget_circuit(engine);
        dea_engine_clear_complaints(engine);
        loaded = load_circuit(engine);
    }
    if (!loaded)
        return dea_engine_complain(engine, DEA_ERR_INPUT, "ngspice refuses the circuit", NULL, error);
    return dea_switches_find(engine, &engine->switches, error);
}

enum dea_status dea_engine_list(struct dea_engine *engine, struct dea_listing *listing, struct dea_error *error) {
    *listing = (struct dea_listing){0};
    engine->listing = listing;
    engine->listing_cut = false;
    int failed = dea_engine_command("listing expand");
    engine->listing = NULL;
    if (engine->listing_cut)
        return dea_fail(error, DEA_ERR_MEMORY, "out of memory for the circuit");
    if (failed != 0 || listing->count == 0)
        return dea_fail(error, DEA_ERR_SOLVER, "ngspice does not list the circuit");
    return DEA_OK;
}

void dea_listing_clear(struct dea_listing *listing) {
    for (int i = 0; i < listing->count; i++)
        free(listing->lines[i]);
    free(listing->lines);
    *listing = (struct dea_listing){0};
}

enum dea_status dea_engine_add_breakpoint(struct dea_engine *engine, double t, struct dea_error *error) {
    if (!(t > 0.0) || !(t < engine->options->stop))
        return DEA_OK; /* both ends are points anyway */
    double *grown = dea_grow(engine->breakpoints, engine->breakpoint_count, sizeof *grown);
    if (grown == NULL)
        return dea_fail(error, DEA_ERR_MEMORY, "out of memory for breakpoints");
    engine->breakpoints = grown;
    engine->breakpoints[engine->breakpoint_count++] = t;
    return DEA_OK;
}

void dea_engine_start_charge(struct dea_engine *engine, int instance, int port, double charge) {
    const struct dea_netlist_instance *called = &engine->netlist->instances[instance];
    char text[256];
    snprintf(text, sizeof text, "alter @c.%s.cq%d[ic] = %.17g", called->path, port,
             charge / dea_port_charge_unit(&engine->devices[called->device].ports[port]));
    dea_engine_command(text);
}

/* ---- run ---- */

enum dea_status dea_engine_run(struct dea_engine *engine, struct dea_error *error) {
    if (engine->netlist == NULL || library_dead)
        return dea_fail(error, DEA_ERR_INTERNAL, "no circuit is loaded");
    engine->callback_error = (struct dea_error){.status = DEA_OK};
    engine->run_error = &engine->callback_error;
    engine->verdict = DEA_OK;
    engine->stop_sent = false;
    engine->step_count = engine->window_first = engine->tiny_steps = 0;
    engine->window_start = 0.0;
    engine->longest = dea_deck_longest_step(engine->options);
    engine->last_step = 0.0;
    engine->floor = 1e-10 * engine->longest; /* ten times what ngspice itself goes down to */
    engine->stats = (struct dea_engine_stats){0};
    for (int i = 0; i < engine->breakpoint_count; i++)
        if (!spice.set_breakpoint(engine->breakpoints[i]))
            return dea_fail(error, DEA_ERR_SOLVER, "ngspice refuses a breakpoint at t = %.9g s",
                            engine->breakpoints[i]);
    engine->running = true;
    dea_engine_command("run");
    engine->running = false;
    engine->run_error = NULL;
    if (engine->verdict != DEA_OK) {
        if (error != NULL)
            *error = engine->callback_error;
        return engine->verdict;
    }
    if (engine->complaints.aborted || engine->complaints.exit_requested ||
        engine->stats.reached < engine->options->stop)
        return dea_engine_judge_failure(engine, error);
    return DEA_OK;
}

const struct dea_engine_measure *dea_engine_measures(const struct dea_engine *engine, int *count) {
    *count = engine->measure_count;
    return engine->measures;
}

void dea_engine_stats(const struct dea_engine *engine, struct dea_engine_stats *stats) {
    *stats = engine->stats;
}

void dea_engine_close(struct dea_engine *engine) {
    if (engine == NULL)
        return;
    unload(engine);
    current_engine = NULL;
    free(engine);
}
