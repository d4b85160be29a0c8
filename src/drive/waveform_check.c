/* What a waveform must be before anything else may use it. */
#include "drive/drive_internal.h"

#include <math.h>

/* Bounds far outside any use that keep every later product finite. */
#define LARGEST_LEVEL 1e30     /* V or N */
#define LARGEST_TIME 1e15      /* s */
#define LARGEST_FREQUENCY 1e15 /* Hz; decay in 1/s */
#define SHORTEST_TIME 1e-15    /* s; anything shorter but 0 is a slip of the unit */

static const char *const kind_names[DEA_WAVE_COUNT] = {"dc", "pulse", "pwl", "sine", "chirp", "trapezoid"};

struct parameter {
    const char *name;
    double value;
};

static enum dea_status check_levels(const char *kind, const struct parameter *parameters, size_t count,
                                    struct dea_error *error) {
    for (size_t i = 0; i < count; i++)
        if (!(fabs(parameters[i].value) <= LARGEST_LEVEL))
            return dea_fail(error, DEA_ERR_INPUT, "%s: %s is %g; a finite number up to %g is needed", kind,
                            parameters[i].name, parameters[i].value, LARGEST_LEVEL);
    return DEA_OK;
}

static enum dea_status check_times(const char *kind, const struct parameter *parameters, size_t count,
                                   struct dea_error *error) {
    for (size_t i = 0; i < count; i++) {
        double value = parameters[i].value;
        if (!(value >= 0 && value <= LARGEST_TIME))
            return dea_fail(error, DEA_ERR_INPUT, "%s: %s is %g s; a time from 0 to %g s is needed", kind,
                            parameters[i].name, value, LARGEST_TIME);
        if (value > 0 && value < SHORTEST_TIME)
            return dea_fail(error, DEA_ERR_INPUT, "%s: %s is %g s; the shortest time apart from 0 is 1 fs", kind,
                            parameters[i].name, value);
    }
    return DEA_OK;
}

static enum dea_status check_rates(const char *kind, const char *unit, const struct parameter *parameters, size_t count,
                                   struct dea_error *error) {
    for (size_t i = 0; i < count; i++)
        if (!(parameters[i].value >= 0 && parameters[i].value <= LARGEST_FREQUENCY))
            return dea_fail(error, DEA_ERR_INPUT, "%s: %s is %g %s; a number from 0 to %g %s is needed", kind,
                            parameters[i].name, parameters[i].value, unit, LARGEST_FREQUENCY, unit);
    return DEA_OK;
}

/* Pulse and trapezoid share all but what follows the fall. */
static enum dea_status check_pulse(const struct dea_waveform *w, struct dea_error *error) {
    const char *kind = kind_names[w->kind];
    bool trapezoid = w->kind == DEA_WAVE_TRAPEZOID;
    bool repeats = trapezoid ? w->repeat : w->period != 0;
    bool step = isinf(w->width) && w->width > 0 && !repeats;
    const struct parameter levels[] = {{"low", w->low}, {"high", w->high}};
    const struct parameter times[] = {
        {"delay", w->delay},
        {"rise", w->rise},
        {"fall", w->fall},
        {"width", step ? 0 : w->width},
        {trapezoid ? "gap" : "period", !trapezoid  ? w->period
                                       : w->repeat ? w->gap
                                                   : 0},
    };
    DEA_TRY(check_levels(kind, levels, sizeof levels / sizeof levels[0], error));
    DEA_TRY(check_times(kind, times, sizeof times / sizeof times[0], error));

    double active = w->rise + w->width + w->fall;
    if (active == 0)
        return dea_fail(error, DEA_ERR_INPUT, "%s: rise, width and fall are all 0, so it never leaves low", kind);
    if (!trapezoid && repeats && active > w->period * (1 + 1e-12))
        return dea_fail(error, DEA_ERR_INPUT, "%s: period %g s is shorter than rise + width + fall = %g s", kind,
                        w->period, active);
    return DEA_OK;
}

static enum dea_status check_sine(const struct dea_waveform *w, struct dea_error *error) {
    const char *kind = kind_names[w->kind];
    const struct parameter levels[] = {{"offset", w->offset}, {"amplitude", w->amplitude}, {"phase", w->phase}};
    const struct parameter times[] = {{"delay", w->delay}};
    const struct parameter frequencies[] = {{"frequency", w->frequency}};
    const struct parameter decays[] = {{"decay", w->decay}};
    DEA_TRY(check_levels(kind, levels, sizeof levels / sizeof levels[0], error));
    DEA_TRY(check_times(kind, times, sizeof times / sizeof times[0], error));
    DEA_TRY(check_rates(kind, "Hz", frequencies, 1, error));
    if (w->kind == DEA_WAVE_SINE) {
        if (w->frequency == 0)
            return dea_fail(error, DEA_ERR_INPUT, "sine: frequency is 0; a frequency above 0 Hz is needed");
        return check_rates(kind, "1/s", decays, 1, error);
    }

    const struct parameter end_frequencies[] = {{"frequency_end", w->frequency_end}};
    const struct parameter durations[] = {{"duration", w->duration}};
    DEA_TRY(check_rates(kind, "Hz", end_frequencies, 1, error));
    DEA_TRY(check_times(kind, durations, 1, error));
    if (w->duration == 0)
        return dea_fail(error, DEA_ERR_INPUT, "chirp: duration is 0; a time above 0 s is needed");
    if (w->frequency == 0 && w->frequency_end == 0)
        return dea_fail(error, DEA_ERR_INPUT, "chirp: frequency and frequency_end are both 0");
    return DEA_OK;
}

enum dea_status dea_waveform_check_point(const struct dea_waveform *w, size_t i, struct dea_error *error) {
    const double *times = w->times;
    if (!(times[i] >= 0 && times[i] <= LARGEST_TIME))
        return dea_fail(error, DEA_ERR_INPUT, "time of point %zu is %g s; a time from 0 to %g s is needed", i + 1,
                        times[i], LARGEST_TIME);
    if (!(fabs(w->values[i]) <= LARGEST_LEVEL))
        return dea_fail(error, DEA_ERR_INPUT, "value of point %zu is %g; a finite number up to %g is needed", i + 1,
                        w->values[i], LARGEST_LEVEL);
    if (i == 0)
        return DEA_OK;
    if (times[i] < times[i - 1])
        return dea_fail(error, DEA_ERR_INPUT, "time of point %zu, %g s, goes back behind %g s", i + 1, times[i],
                        times[i - 1]);
    if (times[i] > times[i - 1] && times[i] - times[i - 1] < SHORTEST_TIME)
        return dea_fail(error, DEA_ERR_INPUT, "points %zu and %zu are less than 1 fs apart", i, i + 1);
    if (i > 1 && times[i] == times[i - 2])
        return dea_fail(error, DEA_ERR_INPUT, "points %zu, %zu and %zu have the same time %g s; two make a jump", i - 1,
                        i, i + 1, times[i]);
    return DEA_OK;
}

static enum dea_status check_points(const struct dea_waveform *w, struct dea_error *error) {
    if (w->point_count == 0 || w->times == NULL || w->values == NULL)
        return dea_fail(error, DEA_ERR_INPUT, "pwl: it has no points");
    for (size_t i = 0; i < w->point_count; i++) {
        struct dea_error cause;
        if (dea_waveform_check_point(w, i, &cause) != DEA_OK)
            return dea_fail(error, DEA_ERR_INPUT, "pwl: %s", cause.text);
    }
    if (w->repeat && !(w->times[w->point_count - 1] > w->times[0]))
        return dea_fail(error, DEA_ERR_INPUT, "pwl: to repeat, its last point must be later than its first");
    return DEA_OK;
}

enum dea_status dea_waveform_check(const struct dea_waveform *waveform, struct dea_error *error) {
    const struct parameter level[] = {{"level", waveform->level}};
    switch (waveform->kind) {
    case DEA_WAVE_DC:
        return check_levels("dc", level, 1, error);
    case DEA_WAVE_PULSE:
    case DEA_WAVE_TRAPEZOID:
        return check_pulse(waveform, error);
    case DEA_WAVE_SINE:
    case DEA_WAVE_CHIRP:
        return check_sine(waveform, error);
    case DEA_WAVE_PWL:
        return check_points(waveform, error);
    default:
        return dea_fail(error, DEA_ERR_INTERNAL, "waveform of unknown kind %d", (int)waveform->kind);
    }
}
