/* A scene: devices, what drives them, how long, how accurate, what to watch, what to write, what to expect.
 * Read from YAML into checked structs in SI; every message names file:line:column and the key. */
#ifndef DEASIM_SCENE_H
#define DEASIM_SCENE_H

#include "deasim/device.h"
#include "deasim/waveform.h"

#include <stddef.h>

/* A native source on one electrode. An electrode that `drive` does not name is grounded: present, dc 0 V, resistance 0.
 * Without `drive: {}` or more, a scene with electrodes is refused, so that nothing is grounded by oversight. */
struct dea_source {
    bool present;
    struct dea_waveform waveform; /* V */
    double resistance;            /* series resistance, Ohm; 0 is an ideal source */
    bool amplified;
    struct dea_amplifier amplifier; /* only when amplified */
};

enum dea_policy { DEA_POLICY_IGNORE, DEA_POLICY_WARN, DEA_POLICY_STOP, DEA_POLICY_SHORT };

/* physics.md section 8; the order is that of the failure table there. */
enum dea_event_kind {
    DEA_EVENT_BREAKDOWN,
    DEA_EVENT_SLACK,     /* direction 1 */
    DEA_EVENT_STRESS2,   /* stress2 < 0: clamped width lost */
    DEA_EVENT_LIMIT,     /* elastic law near its limit, margin < 1e-3 */
    DEA_EVENT_STABILITY, /* d2 E_total / dx2 <= 0 at the given voltages */
    DEA_EVENT_STOP,      /* end stop hit */
    DEA_EVENT_COUNT
};

extern const char
    *const dea_event_names[DEA_EVENT_COUNT]; /* "breakdown", "slack", "stress2", "limit", "stability", "stop" */

enum dea_measure { DEA_MEASURE_MIN, DEA_MEASURE_MAX, DEA_MEASURE_FINAL, DEA_MEASURE_T_MAX, DEA_MEASURE_NETLIST };

/* One line of `expect`: a signal's measure, or a netlist .measure by name, between bounds. */
struct dea_expectation {
    char signal[96]; /* "x", "left.voltage", ...; empty for a netlist measure */
    enum dea_measure measure;
    char name[96];       /* name of the netlist .measure, or as written, for messages */
    double above, below; /* SI; -INFINITY / INFINITY when not given */
    char file[256];      /* where it was written */
    int line;
};

struct dea_scene_device {
    char name[64];            /* subcircuit name in the netlist; "DEA" for the single device of a scene */
    struct dea_device device; /* prepared */
};

enum dea_start { DEA_START_EQUILIBRIUM, DEA_START_FRESH };

enum dea_format { DEA_FORMAT_CSV = 1, DEA_FORMAT_RAW = 2, DEA_FORMAT_HDF5 = 4 };

struct dea_scene {
    char *path;                       /* as given; owned */
    char *title;                      /* owned */
    struct dea_scene_device *devices; /* owned */
    int device_count;
    /* drive: netlist path (resolved against the scene's folder), or native sources of the single device */
    char *netlist; /* owned; NULL for native */
    struct dea_source sources[DEA_ZONES];
    bool has_load_waveform;
    struct dea_waveform load; /* N, added to the device's constant load */
    /* transient */
    bool has_transient; /* false: take .tran of the netlist */
    double stop;        /* s */
    double accuracy;    /* A; default 1e-4 */
    double max_step;    /* s, 0: none */
    /* initial */
    enum dea_start start;
    bool has_initial_x, has_initial_v;
    double initial_x, initial_v;               /* m, m/s */
    enum dea_policy policies[DEA_EVENT_COUNT]; /* default: warn */
    /* output */
    double sample;    /* s; 0: stop / 1000 */
    unsigned formats; /* of enum dea_format; default csv */
    char **signals;   /* owned list of names to write; NULL: all */
    size_t signal_count;
    struct dea_expectation *expectations; /* owned */
    size_t expectation_count;
};

/* One `--set key=value`: a dotted key ("transient.accuracy", "device.geometry.width", list entries by number as in
 * "expect.0.above") and its YAML value. It applies after all files are put together, in the order given; null removes
 * the key; a path in it is relative to the working folder. */
struct dea_override {
    const char *key, *value;
};

/* Reads a scene file with its device, material and waveform files. The caller clears it, also after a failure.
 * DEA_ERR_INPUT with "file:line:column: key: what is wrong; what is allowed", then the line and a caret on lines of
 * their own. Any scene, device or material, file or inline mapping, may start from another file by `base: path`: its
 * own keys win, mappings merge key by key (one with another law, kind or type replaces the base's), lists are replaced,
 * null removes a key of the base. Paths are relative to the file they stand in. Every quantity may be written {value:
 * .., source: ..}, every mapping may hold the texts `source` and `notes`. */
enum dea_status dea_scene_read(const char *path, const struct dea_override *overrides, size_t override_count,
                               struct dea_scene *scene, struct dea_error *error);

/* Reads a device file alone (for `deasim static`), prepared. `overrides` keys are relative to the device. The caller
 * clears it, also after a failure. A prestretch that has failed already is not refused: see dea_prestretch_fails. */
enum dea_status dea_device_read(const char *path, const struct dea_override *overrides, size_t override_count,
                                struct dea_device *device, struct dea_error *error);

void dea_scene_clear(struct dea_scene *scene);

#endif
