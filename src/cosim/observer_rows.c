/* Rows and extremes of a run: step ends, samples in between, and what a circuit knows better. */
#include "cosim/observer_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define ROWS_AT_A_TIME 256 /* of one step, where nothing but the plant fills a row */

/* ---- extremes ---- */

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

/* ---- rows ---- */

enum dea_status observer_send_row(struct observer *o, double t, const double *values, struct dea_error *error) {
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
    return observer_send_row(o, 0.0, o->values, error);
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
        DEA_TRY(observer_send_row(o, at, values, error));
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
