/* Watches a run: samples for the files, extremes over the whole run, events and what the scene wants done about them.
 * Devices may advance one after the other; a row is written once all of them have passed its time. */
#ifndef DEASIM_COSIM_OBSERVER_H
#define DEASIM_COSIM_OBSERVER_H

#include "deasim/plant.h"
#include "deasim/run.h"

struct observer;

/* A punctured film conducts like a carbonised channel; only that it is small against any drive resistance matters. */
#define SHORT_RESISTANCE 1e3 /* Ohm */

/* Where rows go: a recorder, or the pipe to the process that has one. */
struct row_sink {
    void *context;
    enum dea_status (*open)(void *context, const struct dea_signal *signals, size_t count, struct dea_error *error);
    enum dea_status (*row)(void *context, double t, const double *values, size_t count, struct dea_error *error);
};

/* One device in time. */
struct observed {
    struct dea_plant *plant;
    const struct dea_device *device;
    const char *name; /* goes before its signals, "DEB.left.voltage"; NULL: nothing, a single device */
    bool coupled;     /* a circuit beside the plant knows the electrical values better: observer_note_port */
};

/* `observed` must outlive the observer. Fills result->signals, stats, events; all owned by the result. */
enum dea_status observer_open(const struct dea_scene *scene, const struct dea_run_options *options, double stop,
                              const struct observed *observed, int count, const struct row_sink *sink,
                              struct dea_result *result, struct observer **observer, struct dea_error *error);

/* Opens the sink and sends the first row, at the plants' start: a run that never starts leaves no files. */
enum dea_status observer_start(struct observer *observer, struct dea_error *error);

/* After a step of one plant from `from` to `to`: its extremes, and its part of the rows in (from, to]. */
enum dea_status observer_follow(struct observer *observer, int device, double from, double to, struct dea_error *error);

/* All plants have reached t: writes the rows up to there. */
enum dea_status observer_write(struct observer *observer, double t, struct dea_error *error);

/* A jump of the inputs: extremes do not interpolate across it. */
void observer_break(struct observer *observer);

/* The state one plant starts from at t after such a jump; rows keep what was before it, extremes take in both. */
enum dea_status observer_resume(struct observer *observer, int device, double t, struct dea_error *error);

/* DEA_ERR_INTERRUPTED with a message when the run is to end. */
enum dea_status observer_check_interrupt(const struct observer *observer, double t, struct dea_error *error);

/* Electrical values of a port as the circuit has them; they replace the plant's own, whose charge may be smoothed. */
struct port_values {
    double voltage, port_voltage; /* V */
    double charge;                /* C */
    double current;               /* A */
};
/* Extremes of a port at a circuit point, with the film's present stretch for the field. */
void observer_note_port(struct observer *observer, int device, int zone, double t, double stretch,
                        const struct port_values *values);
/* Rows are at sample * interval, sample = 1, 2, ...: the first one not yet written, and a port's values for a row still
 * to come. */
long observer_next_sample(const struct observer *observer);
double observer_sample_interval(const struct observer *observer);
enum dea_status observer_sample_port(struct observer *observer, int device, int zone, long sample,
                                     const struct port_values *values, struct dea_error *error);

/* Books the events one plant met at time t: at roots of its last step, or those that hold now. Returns the strongest
 * policy asked for (DEA_POLICY_IGNORE: nothing to do); *zone is where for DEA_POLICY_SHORT. */
enum dea_policy observer_roots(struct observer *observer, int device, double t, int *zone);
enum dea_policy observer_conditions(struct observer *observer, int device, double t, int *zone);

/* All zones (bit 1 << zone) that the last booking wants shorted; twins break down together. */
unsigned observer_short_zones(const struct observer *observer);

/* Last row at t (unless just written), energies and statistics of the plants gathered into the result. Frees the
 * observer; NULL is fine. `failed` tells that the plants' state at t may be outside the model and is not sampled. */
enum dea_status observer_close(struct observer *observer, double t, bool failed, struct dea_error *error);

#endif
