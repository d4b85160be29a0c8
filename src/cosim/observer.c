/* Opens and closes the observer of a run, and books events. */
#include "cosim/observer_internal.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define MAX_EVENTS 1000 /* kept in the list; the rest is counted */

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

/* ---- events and interrupts ---- */

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

enum dea_status observer_check_interrupt(const struct observer *o, double t, struct dea_error *error) {
    const volatile sig_atomic_t *interrupt = o->options->interrupt;
    if (interrupt == NULL || *interrupt == 0)
        return DEA_OK;
    return dea_fail(error, DEA_ERR_INTERRUPTED, "t = %.9g s: interrupted by SIG%s", t, sigabbrev_np(*interrupt));
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
        status = observer_send_row(o, t, o->values, error);
    enum dea_status balanced = gather_energy(o, status == DEA_OK ? error : NULL);
    if (status == DEA_OK && !failed)
        status = balanced;
    if (balanced != DEA_OK)
        o->result->energy.imbalance = NAN;
    for (int d = 0; d < o->plant_count; d++) {
        struct dea_run_stats one, *all = &o->result->stats_run;
        dea_plant_stats(o->observed[d].plant, &one);
        o->result->sensitivity = fmax(o->result->sensitivity, dea_plant_sensitivity(o->observed[d].plant));
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
