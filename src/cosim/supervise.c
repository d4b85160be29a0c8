/* Parent and child of a coupled run: rows and the result travel through the channel. */
#include "cosim/supervise.h"

#include "cosim/cosim.h"
#include "cosim/linear.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define SILENCE_LIMIT 300.0     /* s without any progress before the child counts as hung */
#define MAX_RELAXED 4           /* repeats with looser circuit tolerances */
#define CHECKPOINT_INTERVAL 0.5 /* s between two partial results, what is left after a crash */

enum message { MESSAGE_OPEN = 1, MESSAGE_ROW, MESSAGE_RESULT };

/* ---- the child ---- */

struct child {
    const struct dea_scene *scene;
    const struct dea_netlist *netlist;
    const struct dea_run_options *options;
    struct cosim_control control;
    FILE *terminal; /* the user's, while stderr goes to the log */
    struct dea_channel *channel;
    struct dea_result result;
    double *row;    /* time and values */
    double checked; /* s, clock of the last partial result */
};

static void put(char **at, const void *data, size_t size) {
    if (size > 0)
        memcpy(*at, data, size);
    *at += size;
}

/* The result's plain fields, then its signals, stats, events and measures. */
static enum dea_status send_result(struct child *child) {
    const struct dea_result *r = &child->result;
    size_t signals = r->signal_count * sizeof *r->signals, stats = r->signal_count * sizeof *r->stats;
    size_t events = r->event_count * sizeof *r->events, measures = r->measure_count * sizeof *r->measures;
    size_t size = sizeof *r + signals + stats + events + measures;
    char *message = malloc(size), *at = message;
    if (message == NULL)
        return DEA_ERR_MEMORY;
    put(&at, r, sizeof *r);
    put(&at, r->signals, signals);
    put(&at, r->stats, stats);
    put(&at, r->events, events);
    put(&at, r->measures, measures);
    enum dea_status status = dea_channel_send(child->channel, MESSAGE_RESULT, message, size);
    free(message);
    return status;
}

static enum dea_status send_open(void *context, const struct dea_signal *signals, size_t count,
                                 struct dea_error *error) {
    struct child *child = context;
    child->row = malloc((count + 1) * sizeof *child->row);
    if (child->row == NULL)
        return dea_fail(error, DEA_ERR_MEMORY, "out of memory for %zu signals", count);
    if (dea_channel_send(child->channel, MESSAGE_OPEN, signals, count * sizeof *signals) != DEA_OK)
        return dea_fail(error, DEA_ERR_OUTPUT, "nobody receives the results");
    return DEA_OK;
}

static enum dea_status send_row(void *context, double t, const double *values, size_t count, struct dea_error *error) {
    struct child *child = context;
    child->row[0] = t;
    memcpy(child->row + 1, values, count * sizeof *values);
    enum dea_status status =
        dea_channel_send(child->channel, MESSAGE_ROW, child->row, (count + 1) * sizeof *child->row);
    double now = dea_clock();
    if (status == DEA_OK && now - child->checked > CHECKPOINT_INTERVAL) {
        child->checked = now;
        child->result.t_end = t;
        status = send_result(child);
    }
    if (status == DEA_OK && dea_channel_stop_requested(child->channel))
        return dea_fail(error, DEA_ERR_INTERRUPTED, "t = %.9g s: interrupted", t);
    return status == DEA_OK ? DEA_OK : dea_fail(error, DEA_ERR_OUTPUT, "nobody receives the results");
}

static enum dea_status run_child(struct dea_channel *channel, void *context, struct dea_error *error) {
    struct child *child = context;
    child->channel = channel;
    child->checked = dea_clock();
    child->options->report->terminal = child->terminal;
    struct row_sink sink = {.context = child, .open = send_open, .row = send_row};
    bool done = false;
    enum dea_status status =
        child->control.relaxed == 0
            ? run_linear(child->scene, child->netlist, true, child->options, &sink, &child->result, &done, error)
            : DEA_OK;
    if (status == DEA_OK && !done)
        status = cosim_run(child->scene, child->netlist, child->options, &child->control, &sink, channel,
                           &child->result, error);
    if (child->result.signal_count > 0 && send_result(child) != DEA_OK && status >= 0)
        status = dea_fail(error, DEA_ERR_OUTPUT, "nobody receives the results");
    dea_result_clear(&child->result);
    free(child->row);
    return status;
}

/* ---- the parent ---- */

struct parent {
    const struct row_sink *sink;
    struct dea_result *result;
    struct dea_error refusal; /* of a row, by the sink: there are no more rows, but the result is wanted */
};

/* Next array of a message; NULL when it is empty or memory is short. */
static void *take(const char **at, size_t count, size_t size, bool *good) {
    if (count == 0)
        return NULL;
    void *copy = malloc(count * size);
    if (copy == NULL) {
        *good = false;
        return NULL;
    }
    memcpy(copy, *at, count * size);
    *at += count * size;
    return copy;
}

static enum dea_status receive_result(struct dea_result *result, const char *data, size_t size,
                                      struct dea_error *error) {
    if (size < sizeof *result)
        return dea_fail(error, DEA_ERR_INTERNAL, "a result message is too short");
    dea_result_clear(result);
    memcpy(result, data, sizeof *result);
    const char *at = data + sizeof *result;
    bool good = true;
    result->signals = take(&at, result->signal_count, sizeof *result->signals, &good);
    result->stats = take(&at, result->signal_count, sizeof *result->stats, &good);
    result->events = take(&at, result->event_count, sizeof *result->events, &good);
    result->measures = take(&at, result->measure_count, sizeof *result->measures, &good);
    return good ? DEA_OK : dea_fail(error, DEA_ERR_MEMORY, "out of memory for the result");
}

static enum dea_status receive(void *context, uint32_t type, const void *data, size_t size, struct dea_error *error) {
    struct parent *parent = context;
    const double *row = data;
    struct dea_error *refusal = &parent->refusal;
    switch ((enum message)type) {
    case MESSAGE_OPEN:
        return parent->sink->open(parent->sink->context, data, size / sizeof(struct dea_signal), error);
    case MESSAGE_ROW:
        if (refusal->status == DEA_OK)
            refusal->status =
                parent->sink->row(parent->sink->context, row[0], row + 1, size / sizeof *row - 1, refusal);
        return refusal->status == DEA_OK ? DEA_OK : DEA_STOPPED;
    case MESSAGE_RESULT:
        return receive_result(parent->result, data, size, error);
    }
    return dea_fail(error, DEA_ERR_INTERNAL, "unknown message %u", (unsigned)type);
}

/* The user's terminal, kept while the child's stderr goes to the log. */
static FILE *keep_terminal(const struct dea_report *report) {
    if (report->terminal == NULL)
        return NULL;
    fflush(report->terminal);
    int copy = dup(fileno(report->terminal));
    FILE *terminal = copy >= 0 ? fdopen(copy, "w") : NULL;
    if (terminal != NULL)
        setvbuf(terminal, NULL, _IONBF, 0);
    else if (copy >= 0)
        close(copy);
    return terminal;
}

/* The run in a child process, again with looser tolerances where the circuit gives up. */
static enum dea_status run_in_child(const struct dea_scene *scene, const struct dea_netlist *netlist,
                                    const struct dea_run_options *options, const struct row_sink *sink,
                                    struct dea_result *result, struct dea_error *error) {
    DEA_TRY(dea_engine_preload(error)); /* here, so that a process of many runs does it once */
    char log[4096] = "";
    if (options->directory != NULL)
        snprintf(log, sizeof log, "%s/log.txt", options->directory);
    struct child child = {
        .scene = scene, .netlist = netlist, .options = options, .terminal = keep_terminal(options->report)};
    struct parent parent = {.sink = sink, .result = result};
    struct dea_isolate_limits limits = {.wall_s = options->time_limit,
                                        .silence_s = SILENCE_LIMIT,
                                        .log_path = log[0] != '\0' ? log : NULL,
                                        .stop = options->interrupt};
    enum dea_status status;
    for (;; child.control.relaxed++) {
        fflush(NULL); /* the child must not write buffers twice */
        status = dea_isolate_run(run_child, &child, &limits, receive, &parent, error);
        if (parent.refusal.status != DEA_OK)
            status = dea_fail(error, parent.refusal.status, "%s", parent.refusal.text);
        if (status != DEA_ERR_SOLVER || !result->circuit_gave_up || child.control.relaxed == MAX_RELAXED)
            break;
        const char *steps = strstr(error->text, "; " DEA_LAST_STEPS); /* are told when it gives up for good */
        dea_report_warn(options->report, "%.*s\nrepeating the run with looser tolerances in the circuit",
                        steps != NULL ? (int)(steps - error->text) : -1, error->text);
        dea_result_clear(result);
    }
    if (status == DEA_ERR_INTERRUPTED && options->interrupt != NULL && *options->interrupt != 0) {
        const struct dea_error told = *error; /* the child does not know by whom */
        status = dea_fail(error, DEA_ERR_INTERRUPTED, "%s by SIG%s", told.text, sigabbrev_np(*options->interrupt));
    }
    if (child.control.relaxed > 0 && status >= 0)
        dea_report_warn(options->report,
                        "the circuit's tolerances were loosened %d times to get through: the result may miss the "
                        "accuracy asked for; compare with a run at another --accuracy",
                        child.control.relaxed);
    if (child.terminal != NULL)
        fclose(child.terminal);
    return status;
}

enum dea_status run_supervised(const struct dea_scene *scene, const struct dea_run_options *options,
                               const struct row_sink *sink, struct dea_result *result, struct dea_error *error) {
    struct dea_netlist netlist = {0};
    bool done = false;
    enum dea_status status = cosim_read_netlist(scene, options->trust_netlist, options->report, &netlist, error);
    if (status == DEA_OK && options->time_limit <= 0.0) /* only a child can be ended by the clock */
        status = run_linear(scene, &netlist, false, options, sink, result, &done, error);
    if (status == DEA_OK && !done)
        status = run_in_child(scene, &netlist, options, sink, result, error);
    dea_netlist_clear(&netlist);
    return status;
}
