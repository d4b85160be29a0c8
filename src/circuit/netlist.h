/* A user's netlist, read, vetted and searched for what the coupling needs. Nothing in it is executed, ever.
 * ngspice netlists can run shell commands and touch files: only lines known to be harmless reach the engine. */
#ifndef DEASIM_CIRCUIT_NETLIST_H
#define DEASIM_CIRCUIT_NETLIST_H

#include "deasim/device.h"

#include <stddef.h>

#define DEA_PORT_PINS (2 * DEA_ZONES + 1) /* p n per electroded zone, then pos */

/* A simulated device as the netlist calls it: `Xdea left 0 right 0 pos DEA`. */
struct dea_netlist_device {
    const char *name;          /* subcircuit name, compared without case */
    int electrodes;            /* electroded zones, 1 or 2 */
    const char *zone_names[2]; /* names of the electroded zones in pin order, for messages */
};

struct dea_netlist_options {
    bool trusted; /* files outside the netlist's folder may be read; .control blocks are skipped instead of refused */
    const struct dea_netlist_device *devices;
    int device_count;
};

/* One logical line: continuations joined, comments and CR removed. Comment lines, and what belongs to our own analysis
 * (.tran, .save, .print, ...), are not passed to the engine. */
struct dea_netlist_line {
    char *text;  /* owned */
    int file;    /* index into files */
    int line;    /* first physical line, from 1 */
    bool passed; /* goes into the deck */
};

/* `.ic v(node)=value` with a plain number. */
struct dea_netlist_initial {
    char *node;   /* lower case; owned */
    double value; /* V */
};

/* One simulated device: one flattened subcircuit call. A call inside a user's .subckt counts once per use of that
 * subcircuit. */
struct dea_netlist_instance {
    int device;                 /* index into options.devices */
    char *path;                 /* flattened name as ngspice spells it, lower case: "xdea", "xarm.xdea"; owned */
    char *nodes[DEA_PORT_PINS]; /* flattened node names in pin order, lower case, "0" for ground; owned, NULL after the
                                   last */
    int line;                   /* index into lines: the call */
};

/* `.tran tstep tstop [tstart [tmax]] [uic]`. Times in s. */
struct dea_netlist_tran {
    bool present;
    bool numeric; /* false: written with parameters or expressions, the numbers below are then 0 */
    double step, stop, start, max_step;
    bool uic;
    int line; /* index into lines */
};

struct dea_netlist {
    char *folder; /* real path of the main file's folder, owned */
    char **files; /* owned; the main file first, as given, then includes */
    int file_count;
    struct dea_netlist_line *lines; /* owned; line 0 is the title */
    int line_count;
    struct dea_netlist_tran tran;
    struct dea_netlist_instance *instances; /* owned, in file order */
    int instance_count;
    char **measures; /* owned; names of the .measure tran lines, lower case, in file order */
    int measure_count;
    struct dea_netlist_initial *initials; /* owned */
    int initial_count;
    bool has_event_parts; /* A devices: code models, not linear elements */
    char **warnings;      /* owned; "file:line: what was left out" */
    int warning_count;
};

/* Reads and vets a netlist with its .include and .lib files. DEA_ERR_INPUT with "file:line: ...". The caller clears it,
 * also after a failure. */
enum dea_status dea_netlist_read(const char *path, const struct dea_netlist_options *options,
                                 struct dea_netlist *netlist, struct dea_error *error);

void dea_netlist_clear(struct dea_netlist *netlist);

/* File name of a logical line; *line its number there. */
const char *dea_netlist_place(const struct dea_netlist *netlist, int index, int *line);

/* Number with SPICE suffix (T G Meg K mil m u n p f a; M is milli; trailing letters ignored) in *value; false when it
 * is none. */
bool dea_spice_number(const char *text, double *value);

#endif
