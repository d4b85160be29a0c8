/* Samples, extremes and events of a run. */
#include "cosim/observer.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define MAX_EVENTS 1000    /* kept in the list; the rest is counted */
#define ROWS_AT_A_TIME 256 /* of one step, where nothing but the plant fills a row */

/* The last two step ends of a signal, to find a peak between steps. */
struct history {
    double t[2], value[2];
};

/* Where a zone's electrical signals are in the list of all signals; ABSENT for a passive zone. */
struct port_columns {
    int voltage, port_voltage, charge, current, true_field, stretch;
};

enum { ABSENT = -1, PORT_VALUES = 4 };

struct observer {
    const struct dea_scene *scene;
    const struct dea_run_options *options;
    const struct observed *observed;
    int plant_count;
    struct row_sink sink;
    struct dea_result *result;
    struct dea_signal *signals; /* all of them */
    int *first;                 /* first signal of each plant, plant_count + 1 entries */
    struct port_columns *ports; /* DEA_ZONES per plant */
    bool *foreign;              /* signals whose extremes come from a circuit, not from the plant */
    unsigned *groups;           /* per signal: the group it is worked out with */
    unsigned *row_groups;       /* per plant: those that rows need */
    double *values, *row;       /* all signals; those written */
    struct history *histories;
    int *history_length; /* step ends since the last jump, at most 2, per plant */
    size_t *written;     /* indices of the signals in the files */
    size_t written_count;
    struct dea_signal *written_signals;
    double sample, stop;
    double last_row; /* s, time of the last row */
    /* rows in the making: sample times next_sample * sample, (next_sample + 1) * sample, ... */
    long next_sample;
    long *reached;                    /* per plant: first sample it has not filled */
    double *pending;                  /* pending_rows times all signals */
    double *pending_ports;            /* pending_rows times ports times PORT_VALUES; NAN: none */
    size_t pending_rows, filled_rows; /* room; rows anything has been put into */
    bool warned[DEA_EVENT_COUNT];
    /* while events are booked */
    int device, short_zone;
    unsigned short_zones;
    double event_time;
    enum dea_policy wanted;
};

/* ---- opening ---- */

static int find_column(const struct observer *o, int device, int zone, const char *name) {
    char wanted[96];
    snprintf(wanted, sizeof wanted, "%s.%s", dea_zone_names[zone], name);
    for (int i = o->first[device]; i < o->first[device + 1]; i++) {
        const char *full = o->signals[i].name;
        size_t length = strlen(full), tail = strlen(wanted);
        if (length >= tail && strcmp(full + length - tail, wanted) == 0)
            return i;
    }
    return ABSENT;
}

static void name_signals(struct observer *o) {
    for (int d = 0; d < o->plant_count; d++) {
        for (int i = 0; i < dea_plant_signal_count(o->observed[d].plant); i++) {
            struct dea_signal plain, *signal = &o->signals[o->first[d] + i];
            dea_plant_signal(o->observed[d].plant, i, &plain);
            *signal = plain;
            o->groups[o->first[d] + i] = dea_plant_signal_group(o->observed[d].plant, i);
            if (o->observed[d].name != NULL) /* "DEB.left.voltage" */
                snprintf(signal->name, sizeof signal->name, "%.31s.%.63s", o->observed[d].name, plain.name);
        }
        for (int k = 0; k < DEA_ZONES; k++) {
            struct port_columns *columns = &o->ports[d * DEA_ZONES + k];
            *columns = (struct port_columns){find_column(o, d, k, "voltage"),    find_column(o, d, k, "port_voltage"),
                                             find_column(o, d, k, "charge"),     find_column(o, d, k, "current"),
                                             find_column(o, d, k, "true_field"), find_column(o, d, k, "stretch")};
            const int electrical[] = {columns->voltage, columns->port_voltage, columns->charge, columns->current,
                                      columns->true_field};
            for (size_t e = 0; e < sizeof electrical / sizeof electrical[0]; e++)
                if (electrical[e] != ABSENT)
                    o->foreign[electrical[e]] = o->observed[d].coupled;
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
    for (int d = 0; d < o->plant_count; d++)
        for (size_t w = 0; w < o->written_count; w++)
            if ((int)o->written[w] >= o->first[d] && (int)o->written[w] < o->first[d + 1])
                o->row_groups[d] |= o->groups[o->written[w]];
    return DEA_OK;
}

static enum dea_status allocate(struct observer *o, struct dea_error *error) {
    size_t plants = (size_t)o->plant_count, count = 0;
    o->first = calloc(plants + 1, sizeof *o->first);
    if (o->first == NULL)
        return dea_fail(error, DEA_ERR_MEMORY, "out of memory for %zu devices", plants);
    for (size_t d = 0; d < plants; d++) {
        count += (size_t)dea_plant_signal_count(o->observed[d].plant);
        o->first[d + 1] = (int)count;
    }
    size_t room = count + o->scene->signal_count;
    o->result->signal_count = count;
    o->signals = calloc(count, sizeof *o->signals);
    o->ports = calloc(plants * DEA_ZONES, sizeof *o->ports);
    o->foreign = calloc(count, sizeof *o->foreign);
    o->groups = calloc(count, sizeof *o->groups);
    o->row_groups = calloc(plants, sizeof *o->row_groups);
    o->values = calloc(count, sizeof *o->values);
    o->row = calloc(room, sizeof *o->row);
    o->histories = calloc(count, sizeof *o->histories);
    o->history_length = calloc(plants, sizeof *o->history_length);
    o->reached = calloc(plants, sizeof *o->reached);
    o->written = calloc(room, sizeof *o->written);
    o->written_signals = calloc(room, sizeof *o->written_signals);
    o->result->signals = o->signals;
    o->result->stats = calloc(count, sizeof *o->result->stats);
    o->result->events = calloc(MAX_EVENTS, sizeof *o->result->events);
    if (o->signals == NULL || o->ports == NULL || o->foreign == NULL || o->groups == NULL || o->row_groups == NULL ||
        o->values == NULL || o->row == NULL || o->histories == NULL || o->history_length == NULL ||
        o->reached == NULL || o->written == NULL || o->written_signals == NULL || o->result->stats == NULL ||
        o->result->events == NULL)
        return dea_fail(error, DEA_ERR_MEMORY, "out of memory for %zu signals", count);
    for (size_t i = 0; i < count; i++)
        o->result->stats[i] = (struct dea_signal_stats){.min = INFINITY, .max = -INFINITY};
    return DEA_OK;
}

static void free_observer(struct observer *o) {
    free(o->first);
    free(o->ports);
    free(o->foreign);
    free(o->groups);
    free(o->row_groups);
    free(o->values);
    free(o->row);
    free(o->histories);
    free(o->history_length);
    free(o->reached);
    free(o->written);
    free(o->written_signals);
    free(o->pending);
    free(o->pending_ports);
    free(o);
}

enum dea_status observer_open(const struct dea_scene *scene, const struct dea_run_options *options, double stop,
                              const struct observed *observed, int count, const struct row_sink *sink,
                              struct dea_result *result, struct observer **observer, struct dea_error *error) {
    *observer = NULL;
    struct observer *o = calloc(1, sizeof *o);
    if (o == NULL)
        return dea_fail(error, DEA_ERR_MEMORY, "out of memory");
    *o = (struct observer){.scene = scene,
                           .options = options,
                           .observed = observed,
                           .plant_count = count,
                           .sink = *sink,
                           .result = result,
                           .stop = stop,
                           .last_row = -INFINITY};
    o->sample = scene->sample > 0.0 ? scene->sample : stop / 1000.0;
    enum dea_status status = allocate(o, error);
    if (status == DEA_OK) {
        name_signals(o);
        status = choose_signals(o, error);
    }
    if (status != DEA_OK) {
        free_observer(o);
        return status;
    }
    *observer = o;
    return DEA_OK;
}

/* ---- samples and extremes ---- */

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

static void note_step_end(struct observer *o, int device, double t) {
    for (int i = o->first[device]; i < o->first[device + 1]; i++) {
        struct dea_signal_stats *stats = &o->result->stats[i];
        struct history *h = &o->histories[i];
        if (o->foreign[i])
            continue;
        note_extreme(stats, t, o->values[i]);
        if (o->history_length[device] == 2)
            note_vertex(stats, h, t, o->values[i]);
        stats->final = o->values[i];
        h->t[0] = h->t[1];
        h->value[0] = h->value[1];
        h->t[1] = t;
        h->value[1] = o->values[i];
    }
    if (o->history_length[device] < 2)
        o->history_length[device]++;
}

static enum dea_status send_row(struct observer *o, double t, const double *values, struct dea_error *error) {
    o->last_row = t;
    for (size_t w = 0; w < o->written_count; w++)
        o->row[w] = values[o->written[w]];
    return o->sink.row(o->sink.context, t, o->row, o->written_count, error);
}

enum dea_status observer_start(struct observer *o, struct dea_error *error) {
    DEA_TRY(o->sink.open(o->sink.context, o->written_signals, o->written_count, error));
    for (int d = 0; d < o->plant_count; d++) {
        DEA_TRY(dea_plant_signals(o->observed[d].plant, 0.0, DEA_SIGNALS_ALL, o->values + o->first[d], error));
        note_step_end(o, d, 0.0);
        o->reached[d] = 1;
    }
    o->next_sample = 1;
    return send_row(o, 0.0, o->values, error);
}

/* Room for the row of a sample; grows by doubling, so hardly ever. */
static enum dea_status reserve_rows(struct observer *o, long sample, struct dea_error *error) {
    size_t needed = (size_t)(sample - o->next_sample) + 1, count = o->result->signal_count;
    size_t ports = (size_t)o->plant_count * DEA_ZONES * PORT_VALUES;
    o->filled_rows = needed > o->filled_rows ? needed : o->filled_rows;
    if (needed <= o->pending_rows)
        return DEA_OK;
    size_t rows = o->pending_rows > 0 ? o->pending_rows : 8;
    while (rows < needed)
        rows *= 2;
    double *pending = realloc(o->pending, rows * count * sizeof *pending);
    if (pending == NULL)
        return dea_fail(error, DEA_ERR_MEMORY, "out of memory for %zu rows between two steps", rows);
    o->pending = pending;
    double *pending_ports = realloc(o->pending_ports, rows * ports * sizeof *pending_ports);
    if (pending_ports == NULL)
        return dea_fail(error, DEA_ERR_MEMORY, "out of memory for %zu rows between two steps", rows);
    o->pending_ports = pending_ports;
    for (size_t i = o->pending_rows * ports; i < rows * ports; i++)
        pending_ports[i] = NAN;
    o->pending_rows = rows;
    return DEA_OK;
}

enum dea_status observer_follow(struct observer *o, int device, double from, double to, struct dea_error *error) {
    (void)from;
    bool alone = o->plant_count == 1 && !o->observed[0].coupled;
    for (double t = (double)o->reached[device] * o->sample; t <= to; t = (double)o->reached[device] * o->sample) {
        if (alone && o->reached[device] - o->next_sample >= ROWS_AT_A_TIME) { /* a step may hold millions of rows */
            DEA_TRY(observer_write(o, (double)(o->reached[device] - 1) * o->sample, error));
            DEA_TRY(observer_check_interrupt(o, t, error));
        }
        DEA_TRY(reserve_rows(o, o->reached[device], error));
        double *row = o->pending + (size_t)(o->reached[device] - o->next_sample) * o->result->signal_count;
        unsigned wanted = o->row_groups[device];
        if (wanted != 0)
            DEA_TRY(dea_plant_signals(o->observed[device].plant, t, wanted, row + o->first[device], error));
        for (int i = o->first[device]; i < o->first[device + 1]; i++)
            if (!o->foreign[i] && wanted & o->groups[i])
                note_extreme(&o->result->stats[i], t, row[i]);
        o->reached[device]++;
    }
    DEA_TRY(dea_plant_signals(o->observed[device].plant, to, DEA_SIGNALS_ALL, o->values + o->first[device], error));
    note_step_end(o, device, to);
    return DEA_OK;
}

/* The circuit's own values take the place of the plant's. */
static void put_port(const struct observer *o, int device, int zone, const double *port, double *values) {
    const struct port_columns *columns = &o->ports[device * DEA_ZONES + zone];
    if (columns->voltage == ABSENT || isnan(port[0]))
        return;
    values[columns->voltage] = port[0];
    values[columns->port_voltage] = port[1];
    values[columns->charge] = port[2];
    values[columns->current] = port[3];
    values[columns->true_field] = dea_zone_field(o->observed[device].device, port[0], values[columns->stretch]);
}

enum dea_status observer_write(struct observer *o, double t, struct dea_error *error) {
    size_t count = o->result->signal_count, ports = (size_t)o->plant_count * DEA_ZONES * PORT_VALUES, rows = 0;
    for (double at = (double)o->next_sample * o->sample; at <= t;
         at = (double)(o->next_sample + (long)rows) * o->sample) {
        double *values = o->pending + rows * count;
        for (int p = 0; p < o->plant_count * DEA_ZONES; p++)
            put_port(o, p / DEA_ZONES, p % DEA_ZONES, o->pending_ports + rows * ports + (size_t)p * PORT_VALUES,
                     values);
        DEA_TRY(send_row(o, at, values, error));
        rows++;
    }
    if (rows > 0) { /* what is left moves to the front */
        size_t left = o->filled_rows - rows;
        memmove(o->pending, o->pending + rows * count, left * count * sizeof *o->pending);
        memmove(o->pending_ports, o->pending_ports + rows * ports, left * ports * sizeof *o->pending_ports);
        for (size_t i = left * ports; i < o->filled_rows * ports; i++)
            o->pending_ports[i] = NAN;
        o->filled_rows = left;
        o->next_sample += (long)rows;
    }
    dea_report_progress(o->options->report, t, o->stop);
    return DEA_OK;
}

void observer_break(struct observer *o) {
    memset(o->history_length, 0, (size_t)o->plant_count * sizeof *o->history_length);
}

enum dea_status observer_resume(struct observer *o, int device, double t, struct dea_error *error) {
    DEA_TRY(dea_plant_signals(o->observed[device].plant, t, DEA_SIGNALS_ALL, o->values + o->first[device], error));
    note_step_end(o, device, t);
    return DEA_OK;
}

enum dea_status observer_check_interrupt(const struct observer *o, double t, struct dea_error *error) {
    const volatile sig_atomic_t *interrupt = o->options->interrupt;
    if (interrupt == NULL || *interrupt == 0)
        return DEA_OK;
    return dea_fail(error, DEA_ERR_INTERRUPTED, "t = %.9g s: interrupted by %s", t,
                    *interrupt == SIGTERM ? "SIGTERM" : "SIGINT");
}

/* ---- ports of a circuit ---- */

void observer_note_port(struct observer *o, int device, int zone, double t, double stretch,
                        const struct port_values *values) {
    const struct port_columns *columns = &o->ports[device * DEA_ZONES + zone];
    struct dea_signal_stats *stats = o->result->stats;
    double field = dea_zone_field(o->observed[device].device, values->voltage, stretch);
    const int index[] = {columns->voltage, columns->port_voltage, columns->charge, columns->current,
                         columns->true_field};
    const double value[] = {values->voltage, values->port_voltage, values->charge, values->current, field};
    for (size_t i = 0; i < sizeof index / sizeof index[0]; i++) {
        if (index[i] == ABSENT)
            continue;
        note_extreme(&stats[index[i]], t, value[i]);
        stats[index[i]].final = value[i];
    }
}

long observer_next_sample(const struct observer *o) {
    return o->next_sample;
}

double observer_sample_interval(const struct observer *o) {
    return o->sample;
}

enum dea_status observer_sample_port(struct observer *o, int device, int zone, long sample,
                                     const struct port_values *values, struct dea_error *error) {
    DEA_TRY(reserve_rows(o, sample, error));
    size_t ports = (size_t)o->plant_count * DEA_ZONES, port = (size_t)device * DEA_ZONES + (size_t)zone;
    double *slot = o->pending_ports + ((size_t)(sample - o->next_sample) * ports + port) * PORT_VALUES;
    slot[0] = values->voltage;
    slot[1] = values->port_voltage;
    slot[2] = values->charge;
    slot[3] = values->current;
    return DEA_OK;
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
    if (policy == DEA_POLICY_SHORT) {
        o->short_zone = zone;
        o->short_zones |= 1u << zone;
    }
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
    o->short_zones = 0;
}

enum dea_policy observer_roots(struct observer *o, int device, double t, int *zone) {
    begin_booking(o, device, t);
    dea_plant_roots(o->observed[device].plant, book_event, o);
    *zone = o->short_zone;
    return o->wanted;
}

enum dea_policy observer_conditions(struct observer *o, int device, double t, int *zone) {
    begin_booking(o, device, t);
    dea_plant_conditions(o->observed[device].plant, book_event, o);
    *zone = o->short_zone;
    return o->wanted;
}

unsigned observer_short_zones(const struct observer *o) {
    return o->short_zones;
}

/* ---- closing ---- */

static enum dea_status gather_energy(struct observer *o, struct dea_error *error) {
    struct dea_energy *sum = &o->result->energy;
    for (int d = 0; d < o->plant_count; d++) {
        struct dea_energy e;
        DEA_TRY(dea_plant_energy(o->observed[d].plant, &e, error));
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
    if (!failed && o->last_row < t - 1e-9 * o->sample) /* o->values are those of the last step end */
        status = send_row(o, t, o->values, error);
    enum dea_status balanced = gather_energy(o, status == DEA_OK ? error : NULL);
    if (status == DEA_OK && !failed)
        status = balanced;
    if (balanced != DEA_OK)
        o->result->energy.imbalance = NAN;
    for (int d = 0; d < o->plant_count; d++) {
        struct dea_run_stats one, *all = &o->result->stats_run;
        dea_plant_stats(o->observed[d].plant, &one);
        all->plant_steps += one.plant_steps;
        all->plant_rejected += one.plant_rejected;
        all->residuals += one.residuals;
        all->jacobians += one.jacobians;
        all->newton_iterations += one.newton_iterations;
        all->restarts += one.restarts;
    }
    free_observer(o);
    return status;
}
