/* Switching a design on in time: the plant on an ideal source, no circuit. */
#include "cli/optimum_dynamic.h"

#include "deasim/run.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define PERIODS 3.0 /* simulated after the rise; without damping the first overshoot is the largest */
#define ACCURACY 1e-6
#define SAFE_TOLERANCE 1e-4 /* of the static voltage */

/* A run that is not written. Its events are watched for when they are wanted. */
static enum dea_status simulate(const struct dea_device *device, double voltage, double rise, double stop,
                                enum dea_policy policy, struct dea_result *result, struct dea_error *error) {
    char path[] = "design";
    struct dea_scene_device devices[1] = {{.name = "DEA", .device = *device}};
    struct dea_scene scene = {.path = path,
                              .title = path,
                              .devices = devices,
                              .device_count = 1,
                              .has_transient = true,
                              .stop = stop,
                              .accuracy = ACCURACY};
    scene.sources[0] = (struct dea_source){
        .present = true, .waveform = {.kind = DEA_WAVE_PULSE, .high = voltage, .rise = rise, .width = 2.0 * stop}};
    for (int kind = 0; kind < DEA_EVENT_COUNT; kind++)
        scene.policies[kind] = policy;
    struct dea_report silent = {0};
    struct dea_run_options options = {.report = &silent, .engine = DEA_ENGINE_NATIVE};
    enum dea_status status = dea_run_scene(&scene, &options, result, error);
    return status == DEA_STOPPED ? DEA_OK : status;
}

static const struct dea_signal_stats *find_signal(const struct dea_result *result, const char *name) {
    for (size_t i = 0; i < result->signal_count; i++)
        if (strcmp(result->signals[i].name, name) == 0)
            return &result->stats[i];
    return NULL;
}

/* First event that counts as a failure of the membrane; NULL for none. */
static const struct dea_event *find_failure(const struct dea_result *result) {
    for (size_t i = 0; i < result->event_count; i++) {
        enum dea_event_kind kind = result->events[i].kind;
        if (!result->events[i].cleared &&
            (kind == DEA_EVENT_BREAKDOWN || kind == DEA_EVENT_SLACK || kind == DEA_EVENT_STRESS2))
            return &result->events[i];
    }
    return NULL;
}

/* What a run came to at its worst. */
struct extremes {
    double x, field, strength; /* m, V/m, V/m */
    double tension, stress2;   /* N, Pa */
};

static enum dea_status read_extremes(const struct dea_device *device, const struct dea_result *result,
                                     struct extremes *worst, struct dea_error *error) {
    const struct dea_signal_stats *x = find_signal(result, "x"), *field = find_signal(result, "left.true_field");
    const struct dea_signal_stats *left = find_signal(result, "left.tension");
    const struct dea_signal_stats *right = find_signal(result, "right.tension");
    const struct dea_signal_stats *stress2 = find_signal(result, "left.stress2");
    if (x == NULL || field == NULL || left == NULL || right == NULL || stress2 == NULL)
        return dea_fail(error, DEA_ERR_INTERNAL, "a signal of the run is missing");
    /* at constant voltage the field is largest where the film is longest */
    double stretch = dea_zone_stretch(device, 0, x->max);
    worst->x = x->max;
    worst->field = field->max;
    worst->strength =
        dea_breakdown_field(&device->material.dielectric, device->thickness * device->prestretch[0] / stretch, stretch,
                            device->prestretch[1]);
    worst->tension = fmin(left->min, right->min);
    worst->stress2 = stress2->min;
    return DEA_OK;
}

/* Largest voltage up to `most` without a failure, by bisection. Extremes judge it: an event that is only grazed, as
 * here it must be in the end, is no well-posed question to a root finder. */
static enum dea_status find_safe_voltage(const struct dea_device *device, double most, double rise, double stop,
                                         double *safe, struct dea_error *error) {
    double low = 0.0, high = most;
    while (high - low > SAFE_TOLERANCE * most) {
        double middle = 0.5 * (low + high);
        struct dea_result result = {0};
        struct extremes worst = {0};
        enum dea_status status = simulate(device, middle, rise, stop, DEA_POLICY_IGNORE, &result, error);
        if (status == DEA_OK)
            status = read_extremes(device, &result, &worst, error);
        dea_result_clear(&result);
        DEA_TRY(status);
        if (worst.field >= worst.strength || worst.tension <= 0.0 || worst.stress2 < 0.0)
            high = middle;
        else
            low = middle;
    }
    *safe = low;
    return DEA_OK;
}

static enum dea_status switch_on(const struct dea_device *device, const struct dea_design_end *end, double period,
                                 double rise, struct optimum_transient *transient, struct dea_error *error) {
    double stop = rise + PERIODS * period;
    *transient = (struct optimum_transient){.rise = rise,
                                            .voltage = end->voltage,
                                            .first_failure = "none",
                                            .first_time = NAN,
                                            .safe_voltage = end->voltage};
    struct dea_result result = {0};
    struct extremes worst = {0};
    enum dea_status status = simulate(device, end->voltage, rise, stop, DEA_POLICY_WARN, &result, error);
    if (status == DEA_OK)
        status = read_extremes(device, &result, &worst, error);
    const struct dea_event *failure = status == DEA_OK ? find_failure(&result) : NULL;
    if (failure != NULL) {
        transient->first_failure = dea_event_names[failure->kind];
        transient->first_time = failure->time;
    }
    dea_result_clear(&result);
    DEA_TRY(status);
    transient->peak_ratio = worst.x / (end->displacement * (device->zones[0].length + device->zones[1].length));
    transient->peak_field = worst.field;
    transient->breakdown_ratio = isfinite(worst.strength) ? worst.field / worst.strength : NAN;
    transient->least_tension = worst.tension;
    transient->least_stress2 = worst.stress2;
    if (isnan(transient->first_time))
        return DEA_OK;
    return find_safe_voltage(device, end->voltage, rise, stop, &transient->safe_voltage, error);
}

enum dea_status optimum_switch_on(const struct dea_optimum *optimum, const struct dea_device *body,
                                  struct optimum_dynamics *dynamics, struct dea_error *error) {
    struct dea_device device;
    if (optimum->design.dead_load)
        return dea_fail(error, DEA_ERR_INPUT, "a dead load has no natural frequency to switch on against");
    double length = body->zones[0].length + body->zones[1].length;
    DEA_TRY(dea_design_to_device(&optimum->design, body->width, length, false, &device, error));
    device.platform_mass = body->platform_mass;
    device.damping = body->damping;
    device.membrane_mass = body->membrane_mass;
    device.material = body->material; /* branches and density; the law is that of the design */
    device.material.elastic = optimum->design.elastic;
    device.material.dielectric = optimum->design.dielectric;
    DEA_TRY(dea_device_prepare(&device, error));
    if (!(device.effective_mass > 0.0 && device.stiffness > 0.0))
        return dea_fail(error, DEA_ERR_INPUT, "without a mass there is nothing to overshoot");
    dynamics->period = 2.0 * acos(-1.0) * sqrt(device.effective_mass / device.stiffness);
    DEA_TRY(switch_on(&device, &optimum->end, dynamics->period, 0.0, &dynamics->step, error));
    return switch_on(&device, &optimum->end, dynamics->period, dynamics->period, &dynamics->ramp, error);
}
