/* Parts of the observer: opening, events and closing (observer.c), rows and extremes (observer_rows.c). */
#ifndef DEASIM_COSIM_OBSERVER_INTERNAL_H
#define DEASIM_COSIM_OBSERVER_INTERNAL_H

#include "cosim/observer.h"

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

/* One row to the sink; values are those of all signals. */
enum dea_status observer_send_row(struct observer *observer, double t, const double *values, struct dea_error *error);

#endif
