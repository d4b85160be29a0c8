/* A scene and a result with every part filled, for the tests of the summary. */
#ifndef SUMMARY_SUPPORT_H
#define SUMMARY_SUPPORT_H

#include "output_support.h"

#include <math.h>

struct sample_run {
    struct dea_scene scene;
    struct dea_scene_device devices[2];
    char path[64], title[64];
    struct dea_signal signals[3];
    struct dea_result result;
};

static inline void *sample_copy(const void *values, size_t bytes) {
    void *copy = malloc(bytes);
    assert_non_null(copy);
    return memcpy(copy, values, bytes);
}

static inline void fill_sample(struct sample_run *run) {
    *run = (struct sample_run){.path = "scenes/pulse.yaml",
                               .title = "Half-bridge",
                               .signals = {{"x", "m"}, {"left.voltage", "V"}, {"left.true_field", "V/m"}}};
    for (int i = 0; i < 2; i++) {
        snprintf(run->devices[i].name, sizeof run->devices[i].name, "DE%c", 'A' + i);
        run->devices[i].device.material.dielectric.breakdown = 1e8;
        run->devices[i].device.zones[0] = (struct dea_zone){.present = true, .electroded = true};
        run->devices[i].device.zones[1] = (struct dea_zone){.present = true};
    }
    run->scene = (struct dea_scene){.path = run->path, .title = run->title, .devices = run->devices, .device_count = 1};

    static const struct dea_signal_stats stats[] = {
        {-1.23e-5, 4.2512e-4, 3.1e-6, 0.2, 0.0123}, {0, 3300, 1.0 / 3.0, 0, 0.001}, {0, 9.96e7, NAN, 0, 0.0123}};
    static const struct dea_event events[] = {{0.0123, DEA_EVENT_BREAKDOWN, 0, 0, false},
                                              {0.02, DEA_EVENT_STOP, 0, -1, true}};
    static const struct dea_netlist_measure measures[] = {{"tr_left", 1.5e-3, false}, {"tf_left", 0, true}};
    run->result = (struct dea_result){.status = DEA_STOPPED,
                                      .reason = "breakdown in left",
                                      .t_end = 0.4,
                                      .signals = sample_copy(run->signals, sizeof run->signals),
                                      .stats = sample_copy(stats, sizeof stats),
                                      .signal_count = 3,
                                      .events = sample_copy(events, sizeof events),
                                      .event_count = 2,
                                      .energy = {.in = 1.25e-4,
                                                 .electrical = 1.2e-4,
                                                 .load = 5e-6,
                                                 .stored = 1e-4,
                                                 .dissipated = 2.5e-5,
                                                 .branch = 2e-5,
                                                 .damping = 5e-6,
                                                 .exchanged = 3e-4,
                                                 .imbalance = 1.5e-6},
                                      .coupling_error = 3.2e-5,
                                      .measures = sample_copy(measures, sizeof measures),
                                      .measure_count = 2,
                                      .stats_run = {1234, 5, 4321, 678, 3, 2000, 40, 1500, 6, 1.25, "cosim"}};
}

#endif
