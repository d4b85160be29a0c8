/* Drive circuits simple enough to be written down twice: as a netlist for the program, and as equations that an
 * integrator of its own solves together with the device. The equations come from the model alone: taut films, Gent law,
 * Foo branches with neo-Hookean springs; nothing is shared with src/. */
#ifndef DEASIM_TEST_CIRCUITS_H
#define DEASIM_TEST_CIRCUITS_H

#include "deasim/scene.h"

enum { LEAD_POINTS = 12 };

/* From a source to one electrode: source - R - L - [node with C, R] x sections - electrode with C and R to ground. */
struct lead {
    int points; /* of a piecewise linear source; 0: the sine */
    double t[LEAD_POINTS], u[LEAD_POINTS];
    double offset, amplitude, frequency; /* V, V, Hz: offset + amplitude sin(2 pi f t) */
    double resistance, inductance;       /* Ohm, H; 0: not there */
    int sections;
    double section_c, section_r;
    double shunt_c, shunt_r; /* F, Ohm; 0: not there */
    double opens_at, open_r; /* s, Ohm: a relay in series with `resistance`; 0: none. Its coil takes 1 us */
};

struct drive_circuit {
    struct lead leads[DEA_ZONES];
    double stop; /* s */
};

/* A lead from a dc source, and one from a step. */
struct lead dc_lead(double volts, double resistance);
struct lead step_lead(double volts, double at, double rise, double resistance);
struct lead sine_lead(double offset, double amplitude, double frequency, double resistance);

/* The netlist; nodes p0 and p1 are the electrodes, left and right. Electrodes a device does not have are left out. */
void write_circuit(const char *path, const struct drive_circuit *circuit, const struct dea_device *device);

/* The same as native sources of a scene, where the leads are sources with resistance. */
void set_native_sources(struct dea_scene *scene, const struct drive_circuit *circuit);

struct coupled_trace {
    size_t count; /* samples, at i stop / (count - 1) */
    double *x, *port[DEA_ZONES];
    long steps;
};

/* Solves circuit and device as one system, by Dormand and Prince's pair of order 5(4). False when it does not get
 * through. The caller frees. */
bool solve_circuit(const struct drive_circuit *circuit, const struct dea_device *device, double tolerance,
                   size_t samples, struct coupled_trace *trace);
void free_trace(struct coupled_trace *trace);

#endif
