/* A coupled run: its state, and how its start and its course meet. */
#ifndef DEASIM_COSIM_COSIM_INTERNAL_H
#define DEASIM_COSIM_COSIM_INTERNAL_H

#include "cosim/cosim.h"
#include "cosim/coupled.h"

struct cosim {
    const struct dea_scene *scene;
    const struct dea_netlist *netlist;
    const struct dea_run_options *options;
    const struct cosim_control *control;
    struct dea_channel *channel;
    struct dea_engine *engine;
    struct dea_engine_callbacks callbacks;
    struct dea_deck deck, rest_deck; /* the latter: for a closer operating point */
    struct dea_deck_options deck_options, rest_options;
    struct dea_circuit_device *circuit_devices; /* per scene device */
    struct coupled *devices;                    /* per instance */
    struct observed *observed;
    int count;
    struct observer *observer;
    struct dea_result *result;
    double stop;
    /* start */
    bool resting;          /* looking for the common operating point */
    double *rest_voltages; /* DEA_ZONES per instance: film voltages the devices rest at */
    double rest_change;    /* largest relative change of the last round */
    double rest_agreed;    /* relative: the round that changes less runs on */
    /* exchange */
    double horizon, exchanged_at, reached, slowest; /* s */
    bool rests;                                     /* swings that are small enough are left out */
    enum dea_status status;                         /* of a callback that cannot fail */
    struct dea_error failure;
};

/* ---- cosim.c ---- */
/* First row, and what is beyond a limit from the start. */
enum dea_status cosim_begin_observing(struct cosim *run, struct dea_error *error);

/* ---- rest.c ---- */
/* Puts the devices where the scene has them start, at run->rest_voltages. */
enum dea_status cosim_rest_devices(struct cosim *run, struct dea_error *error);
/* At the circuit's first point: run->resting becomes false where its film voltages are those the devices rest at, and
 * the run goes on. They are kept for the next round otherwise. */
enum dea_status cosim_judge_rest(struct cosim *run, const struct dea_circuit_point *point, struct dea_error *error);
/* Finds the operating point of circuit and devices and runs the transient from there. */
enum dea_status cosim_run_from_rest(struct cosim *run, struct dea_error *error);

#endif
