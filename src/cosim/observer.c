/* Samples, extremes and events of a run. */
#include "cosim/observer.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define MAX_EVENTS 1000 /* kept in the list; the rest is counted */

/* The last two step ends of a signal, to find a peak between steps. */
struct history {
    double t[2], value[2];
};

struct observer {
    const struct dea_scene *scene;
    const struct dea_run_options *options;
    struct dea_plant *const *plants;
    int plant_count;
    struct dea_result *result;
    struct dea_signal *signals; /* all of them */
    double *values, *row;       /* all signals; those written */
    struct history *histories;
    int history_length; /* step ends since the last jump, at most 2 */
    size_t *written;    /* indices of the signals in the files */
    size_t written_count;
    struct dea_signal *written_signals;
    struct dea_recorder *recorder;
    double sample, stop;
    long next_sample; /* sample times are next_sample * sample */
    double last_row;  /* s, time of the last row */
    bool warned[DEA_EVENT_COUNT];
    /* while events are booked */
    int device, short_zone;
    double event_time;
    enum dea_policy wanted;
};

/* ---- opening ---- */

static size_t count_signals(const struct observer *o) {
    size_t count = 0;
    for (int d = 0; d < o->plant_count; d++)
        count += (size_t)dea_plant_signal_count(o->plants[d]);
    return count;
}

static void name_signals(struct observer *o) {
    size_t at = 0;
    for (int d = 0; d < o->plant_count; d++) {
        for (int i = 0; i < dea_plant_signal_count(o->plants[d]); i++, at++) {
            dea_plant_signal(o->plants[d], i, &o->signals[at]);
            if (o->plant_count > 1) { /* "DEB.left.voltage" */
                struct dea_signal plain = o->signals[at];
                snprintf(o->signals[at].name, sizeof o->signals[at].name, "%.31s.%.63s", o->scene->devices[d].name,
                         plain.name);
            }
        }
    }
}

/* The scene's list picks signals by name, or by a trailing part such as "x" of every device. */
static enum dea_status choose_signals(struct observer *o, struct dea_error *error) {
    size_t count = o->result->signal_count;
    for (size_t w = 0; w < o->scene->signal_count; w++) {
        const char *wanted = o->scene->signals[w];
        bool found = false;
        for (size_t i = 0; i < count; i++) {
            if (strcmp(o->signals[i].name, wanted) == 0) {
                o->written[o->written_count++] = i;
                found = true;
                break;
            }
        }
        if (!found)
            return dea_fail(error, DEA_ERR_INPUT,
                            "%s: output.signals: no signal \"%s\" in this scene; it has x, v, left.voltage and so on "
                            "as listed in the summary",
                            o->scene->path, wanted);
    }
    if (o->scene->signals == NULL)
        for (size_t i = 0; i < count; i++)
            o->written[o->written_count++] = i;
    for (size_t w = 0; w < o->written_count; w++)
        o->written_signals[w] = o->signals[o->written[w]];
    return DEA_OK;
}

static enum dea_status allocate(struct observer *o, struct dea_error *error) {
    size_t count = o->result->signal_count = count_signals(o), room = count + o->scene->signal_count;
    o->signals = calloc(count, sizeof *o->signals);
    o->values = calloc(count, sizeof *o->values);
    o->row = calloc(room, sizeof *o->row);
    o->histories = calloc(count, sizeof *o->histories);
    o->written = calloc(room, sizeof *o->written);
    o->written_signals = calloc(room, sizeof *o->written_signals);
    o->result->stats = calloc(count, sizeof *o->result->stats);
    o->result->events = calloc(MAX_EVENTS, sizeof *o->result->events);
    if (o->signals == NULL || o->values == NULL || o->row == NULL || o->histories == NULL || o->written == NULL ||
        o->written_signals == NULL || o->result->stats == NULL || o->result->events == NULL)
        return dea_fail(error, DEA_ERR_MEMORY, "out of memory for %zu signals", count);
    o->result->signals = o->signals;
    for (size_t i = 0; i < count; i++)
        o->result->stats[i] = (struct dea_signal_stats){.min = INFINITY, .max = -INFINITY};
    return DEA_OK;
}

static void free_observer(struct observer *o) {
    free(o->values);
    free(o->row);
    free(o->histories);
    free(o->written);
    free(o->written_signals);
    free(o);
}

enum dea_status observer_open(const struct dea_scene *scene, const struct dea_run_options *options, double stop,
                              struct dea_plant *const *plants, int plant_count, struct dea_result *result,
                              struct observer **observer, struct dea_error *error) {
    *observer = NULL;
    struct observer *o = calloc(1, sizeof *o);
    if (o == NULL)
        return dea_fail(error, DEA_ERR_MEMORY, "out of memory");
    *o = (struct observer){.scene = scene,
                           .options = options,
                           .plants = plants,
                           .plant_count = plant_count,
                           .result = result,
                           .stop = stop,
                           .last_row = -INFINITY};
    o->sample = scene->sample > 0.0 ? scene->sample : stop / 1000.0;
    enum dea_status status = allocate(o, error);
    if (status == DEA_OK) {
        name_signals(o);
        status = choose_signals(o, error);
    }
    if (status == DEA_OK && options->directory != NULL)
        status = dea_recorder_open(options->directory, scene->formats, scene->title, o->written_signals,
                                   o->written_count, &o->recorder, error);
    if (status != DEA_OK) {
        free_observer(o);
        return status;
    }
    *observer = o;
    return DEA_OK;
}

/* ---- samples and extremes ---- */

static enum dea_status read_signals(struct observer *o, double t, struct dea_error *error) {
    size_t at = 0;
    for (int d = 0; d < o->plant_count; d++) {
        DEA_TRY(dea_plant_signals(o->plants[d], t, o->values + at, error));
        at += (size_t)dea_plant_signal_count(o->plants[d]);
    }
    return DEA_OK;
}

static void note_extreme(struct dea_signal_stats *stats, double t, double value) {
    if (value > stats->max) {
        stats->max = value;
        stats->t_max = t;
    }
    if (value < stats->min) {
        stats->min = value;
        stats->t_min = t;
    }
}

/* A peak between steps: the vertex of the parabola through three step ends, where the middle one stands out and the
 * steps are alike. */
static void note_vertex(struct dea_signal_stats *stats, const struct history *h, double t, double value) {
    double a = h->value[1] - h->value[0], b = value - h->value[1];
    double da = h->t[1] - h->t[0], db = t - h->t[1];
    if (a * b >= 0.0 || da > 3.0 * db || db > 3.0 * da)
        return;
    double slope_a = a / da, slope_b = b / db, curvature = (slope_b - slope_a) / (da + db);
    double middle = (slope_a * db + slope_b * da) / (da + db), tau = -middle / (2.0 * curvature);
    note_extreme(stats, h->t[1] + tau, h->value[1] + 0.5 * middle * tau);
}

static void note_step_end(struct observer *o, double t) {
    for (size_t i = 0; i < o->result->signal_count; i++) {
        struct dea_signal_stats *stats = &o->result->stats[i];
        struct history *h = &o->histories[i];
        note_extreme(stats, t, o->values[i]);
        if (o->history_length == 2)
            note_vertex(stats, h, t, o->values[i]);
        stats->final = o->values[i];
        h->t[0] = h->t[1];
        h->value[0] = h->value[1];
        h->t[1] = t;
        h->value[1] = o->values[i];
    }
    if (o->history_length < 2)
        o->history_length++;
}

static enum dea_status write_row(struct observer *o, double t, struct dea_error *error) {
    o->last_row = t;
    if (o->recorder == NULL)
        return DEA_OK;
    for (size_t w = 0; w < o->written_count; w++)
        o->row[w] = o->values[o->written[w]];
    return dea_recorder_append(o->recorder, t, o->row, error);
}

enum dea_status observer_start(struct observer *o, struct dea_error *error) {
    DEA_TRY(read_signals(o, 0.0, error));
    note_step_end(o, 0.0);
    o->next_sample = 1;
    return write_row(o, 0.0, error);
}

enum dea_status observer_follow(struct observer *o, double from, double to, struct dea_error *error) {
    (void)from;
    for (double t = (double)o->next_sample * o->sample; t <= to; t = (double)o->next_sample * o->sample) {
        DEA_TRY(read_signals(o, t, error));
        for (size_t i = 0; i < o->result->signal_count; i++)
            note_extreme(&o->result->stats[i], t, o->values[i]);
        DEA_TRY(write_row(o, t, error));
        o->next_sample++;
    }
    DEA_TRY(read_signals(o, to, error));
    note_step_end(o, to);
    dea_report_progress(o->options->report, to, o->stop);
    return DEA_OK;
}

void observer_break(struct observer *o) {
    o->history_length = 0;
}

/* ---- events ---- */

static void book_event(void *context, enum dea_event_kind kind, int zone, bool cleared) {
    struct observer *o = context;
    struct dea_result *result = o->result;
    enum dea_policy policy = o->scene->policies[kind];
    if (policy == DEA_POLICY_IGNORE)
        return;
    if (result->event_count < MAX_EVENTS)
        result->events[result->event_count++] = (struct dea_event){
            .time = o->event_time, .kind = kind, .device = o->device, .zone = zone, .cleared = cleared};
    else
        result->event_dropped++;
    if (cleared)
        return;
    if (!o->warned[kind])
        dea_report_warn(o->options->report, "t = %.6g s: %s%s%s", o->event_time, dea_event_names[kind],
                        zone >= 0 ? " in zone " : "", zone >= 0 ? dea_zone_names[zone] : "");
    o->warned[kind] = true;
    if (policy == DEA_POLICY_SHORT)
        o->short_zone = zone;
    if (policy == DEA_POLICY_STOP)
        snprintf(result->reason, sizeof result->reason, "t = %.9g s: %s%s%s", o->event_time, dea_event_names[kind],
                 zone >= 0 ? " in zone " : "", zone >= 0 ? dea_zone_names[zone] : "");
    /* stop outweighs short outweighs warn */
    if (policy == DEA_POLICY_STOP || (policy == DEA_POLICY_SHORT && o->wanted != DEA_POLICY_STOP))
        o->wanted = policy;
}

static void begin_booking(struct observer *o, int device, double t) {
    o->device = device;
    o->event_time = t;
    o->wanted = DEA_POLICY_IGNORE;
    o->short_zone = -1;
}

enum dea_policy observer_roots(struct observer *o, int device, double t, int *zone) {
    begin_booking(o, device, t);
    dea_plant_roots(o->plants[device], book_event, o);
    *zone = o->short_zone;
    return o->wanted;
}

enum dea_policy observer_conditions(struct observer *o, int device, double t, int *zone) {
    begin_booking(o, device, t);
    dea_plant_conditions(o->plants[device], book_event, o);
    *zone = o->short_zone;
    return o->wanted;
}

/* ---- closing ---- */

static enum dea_status gather_energy(struct observer *o, struct dea_error *error) {
    struct dea_energy *sum = &o->result->energy;
    for (int d = 0; d < o->plant_count; d++) {
        struct dea_energy e;
        DEA_TRY(dea_plant_energy(o->plants[d], &e, error));
        sum->in += e.in;
        sum->electrical += e.electrical;
        sum->load += e.load;
        sum->stored += e.stored;
        sum->dissipated += e.dissipated;
        sum->branch += e.branch;
        sum->damping += e.damping;
        sum->resistive += e.resistive;
        sum->leakage += e.leakage;
        sum->stop += e.stop;
        sum->exchanged += e.exchanged;
        sum->imbalance = fmax(sum->imbalance, e.imbalance);
    }
    return DEA_OK;
}

enum dea_status observer_close(struct observer *o, double t, bool failed, struct dea_error *error) {
    if (o == NULL)
        return DEA_OK;
    enum dea_status status = DEA_OK;
    o->result->t_end = t;
    if (!failed && o->last_row < t - 1e-9 * o->sample) {
        status = read_signals(o, t, error);
        if (status == DEA_OK)
            status = write_row(o, t, error);
    }
    enum dea_status balanced = gather_energy(o, status == DEA_OK ? error : NULL);
    if (status == DEA_OK && !failed)
        status = balanced;
    if (balanced != DEA_OK)
        o->result->energy.imbalance = NAN;
    for (int d = 0; d < o->plant_count; d++) {
        struct dea_run_stats one, *all = &o->result->stats_run;
        dea_plant_stats(o->plants[d], &one);
        all->plant_steps += one.plant_steps;
        all->plant_rejected += one.plant_rejected;
        all->residuals += one.residuals;
        all->jacobians += one.jacobians;
        all->newton_iterations += one.newton_iterations;
        all->restarts += one.restarts;
    }
    enum dea_status closed = dea_recorder_close(o->recorder, status == DEA_OK ? error : NULL);
    free_observer(o);
    return status != DEA_OK ? status : closed;
}
