/* Native waveforms as exact pieces between corners. Pulses, trapezoids and points all become one table of corners. */
#include "deasim/waveform.h"

#include <math.h>
#include <stdlib.h>

#define SHAPE_CORNERS 5
#define RESOLVED_PERIODS 1e15 /* more periods than this cannot be counted in a double */

static const double two_pi = 6.283185307179586476925286766559;

/* Corners joined by straight lines. Corner i of period k lies at origin + (k period + times[i]). */
struct shape {
    double origin;       /* s */
    double period;       /* s; 0: a single run through the corners */
    const double *times; /* s, non-decreasing */
    const double *values;
    size_t count;
    double own_times[SHAPE_CORNERS], own_values[SHAPE_CORNERS]; /* storage of pulse and trapezoid */
};

/* A corner that differs from the end of the period by rounding alone lies on it. */
static double snap_to_period(double time, double period) {
    return fabs(period - time) <= 1e-12 * period ? period : time;
}

/* The five corners of a pulse; the last is the end of the period, where the next one begins. */
static void shape_from_pulse(const struct dea_waveform *w, double period, struct shape *shape) {
    double top = w->rise + w->width;
    const double times[SHAPE_CORNERS] = {0, w->rise, top, top + w->fall, period};
    const double values[SHAPE_CORNERS] = {w->low, w->high, w->high, w->low, w->low};
    for (size_t i = 0; i < SHAPE_CORNERS; i++) {
        shape->own_times[i] = period > 0 ? snap_to_period(times[i], period) : times[i];
        shape->own_values[i] = values[i];
    }
    shape->origin = w->delay;
    shape->period = period;
    shape->times = shape->own_times;
    shape->values = shape->own_values;
    shape->count = period > 0 ? SHAPE_CORNERS : SHAPE_CORNERS - 1;
}

static void shape_from_waveform(const struct dea_waveform *w, struct shape *shape) {
    switch (w->kind) {
    case DEA_WAVE_PULSE:
        shape_from_pulse(w, w->period, shape);
        break;
    case DEA_WAVE_TRAPEZOID:
        shape_from_pulse(w, w->repeat ? w->rise + w->width + w->fall + w->gap : 0, shape);
        break;
    default:
        shape->origin = 0;
        shape->times = w->times;
        shape->values = w->values;
        shape->count = w->point_count;
        shape->period = w->repeat ? w->times[w->point_count - 1] - w->times[0] : 0;
        break;
    }
}

/* Time of a corner. A corner at the end of a period is the first of the next by the same arithmetic, and rounding never
 * puts another one past it, so that equal corners are equal numbers and the order of corners holds. */
static double corner_time(const struct shape *shape, double k, size_t i) {
    if (shape->period == 0)
        return shape->origin + shape->times[i];
    double next = shape->origin + ((k + 1) * shape->period + shape->times[0]);
    if (shape->times[i] == shape->times[shape->count - 1])
        return next;
    return fmin(shape->origin + (k * shape->period + shape->times[i]), next);
}

/* The period that holds t, counted from 0; false when a double at t does not resolve the period. */
static bool find_period(const struct shape *shape, double t, double *k) {
    double first = corner_time(shape, 0, 0);
    double spacing = nextafter(t, INFINITY) - t;
    if (shape->period < 8 * spacing || t - first > RESOLVED_PERIODS * shape->period)
        return false;
    double index = floor((t - first) / shape->period);

    /* The quotient is off by one at most; the corners themselves decide. */
    if (index > 0 && corner_time(shape, index, 0) > t)
        index--;
    else if (corner_time(shape, index + 1, 0) <= t)
        index++;
    *k = index;
    return true;
}

/* Last corner of period k that is not after t; the caller knows that the first one is not. */
static size_t find_corner(const struct shape *shape, double k, double t) {
    size_t low = 0, high = shape->count;
    while (high - low > 1) {
        size_t middle = low + (high - low) / 2;
        if (corner_time(shape, k, middle) <= t)
            low = middle;
        else
            high = middle;
    }
    return low;
}

static void set_level(struct dea_piece *piece, double start, double end, double value) {
    *piece = (struct dea_piece){.kind = DEA_PIECE_LINE, .start = start, .end = end, .value = value};
}

static void shape_piece(const struct shape *shape, double t, struct dea_piece *piece) {
    double first = corner_time(shape, 0, 0);
    if (t < first) {
        set_level(piece, fmin(t, 0), first, shape->values[0]);
        return;
    }
    double k = 0;
    if (shape->period > 0 && !find_period(shape, t, &k)) {
        set_level(piece, t, INFINITY, shape->values[0]);
        return;
    }
    size_t i = find_corner(shape, k, t);
    if (i == shape->count - 1) {
        set_level(piece, corner_time(shape, k, i), INFINITY, shape->values[i]);
        return;
    }

    /* The slope takes the length as rounded, so that the line ends on the next value. */
    double start = corner_time(shape, k, i), end = corner_time(shape, k, i + 1);
    set_level(piece, start, end, shape->values[i]);
    if (shape->values[i + 1] != shape->values[i])
        piece->slope = (shape->values[i + 1] - shape->values[i]) / (end - start);
}

/* Sine, or chirp with its held tail. Before delay the value at delay. */
static void sine_piece(const struct dea_waveform *w, double t, struct dea_piece *piece) {
    bool chirp = w->kind == DEA_WAVE_CHIRP;
    if (t < w->delay) {
        set_level(piece, fmin(t, 0), w->delay, w->offset + w->amplitude * sin(w->phase));
        return;
    }
    *piece = (struct dea_piece){.kind = chirp ? DEA_PIECE_CHIRP : DEA_PIECE_SINE,
                                .start = w->delay,
                                .end = chirp ? w->delay + w->duration : INFINITY,
                                .offset = w->offset,
                                .amplitude = w->amplitude,
                                .omega = two_pi * w->frequency,
                                .phase = w->phase,
                                .decay = chirp ? 0 : w->decay,
                                .sweep = chirp ? two_pi * (w->frequency_end - w->frequency) / w->duration : 0};
    if (t < piece->end)
        return;

    /* Past the sweep the phase runs on from the number the sweep ended with. */
    double swept = piece->end - piece->start;
    piece->phase += piece->omega * swept + piece->sweep * swept * swept / 2;
    piece->kind = DEA_PIECE_SINE;
    piece->start = piece->end;
    piece->end = INFINITY;
    piece->omega = two_pi * w->frequency_end;
    piece->sweep = 0;
}

void dea_waveform_piece(const struct dea_waveform *waveform, double t, struct dea_piece *piece) {
    struct shape shape;
    switch (waveform->kind) {
    case DEA_WAVE_SINE:
    case DEA_WAVE_CHIRP:
        sine_piece(waveform, t, piece);
        return;
    case DEA_WAVE_PULSE:
    case DEA_WAVE_TRAPEZOID:
    case DEA_WAVE_PWL:
        shape_from_waveform(waveform, &shape);
        shape_piece(&shape, t, piece);
        return;
    default:
        set_level(piece, fmin(t, 0), INFINITY, waveform->level);
        return;
    }
}

double dea_piece_value(const struct dea_piece *piece, double t, double *rate) {
    double tau = t - piece->start;
    if (piece->kind == DEA_PIECE_LINE) {
        if (rate != NULL)
            *rate = piece->slope;
        return piece->value + piece->slope * tau;
    }
    double angle = piece->phase + (piece->omega * tau + piece->sweep * tau * tau / 2);
    double envelope = piece->decay == 0 ? piece->amplitude : piece->amplitude * exp(-piece->decay * tau);
    double swing = envelope * sin(angle);
    if (rate != NULL)
        *rate = envelope * cos(angle) * (piece->omega + piece->sweep * tau) - piece->decay * swing;
    return piece->offset + swing;
}

double dea_waveform_value(const struct dea_waveform *waveform, double t) {
    struct dea_piece piece;
    dea_waveform_piece(waveform, t, &piece);
    return dea_piece_value(&piece, t, NULL);
}

double dea_waveform_peak(const struct dea_waveform *waveform) {
    double peak = 0;
    switch (waveform->kind) {
    case DEA_WAVE_SINE:
    case DEA_WAVE_CHIRP:
        return fabs(waveform->offset) + fabs(waveform->amplitude);
    case DEA_WAVE_PULSE:
    case DEA_WAVE_TRAPEZOID:
        return fmax(fabs(waveform->low), fabs(waveform->high));
    case DEA_WAVE_PWL:
        for (size_t i = 0; i < waveform->point_count; i++)
            peak = fmax(peak, fabs(waveform->values[i]));
        return peak;
    default:
        return fabs(waveform->level);
    }
}

double dea_waveform_periods(const struct dea_waveform *waveform, double stop) {
    if (waveform->kind == DEA_WAVE_DC)
        return 0;
    if (waveform->kind == DEA_WAVE_SINE)
        return fmax(stop - waveform->delay, 0) * waveform->frequency;
    if (waveform->kind == DEA_WAVE_CHIRP)
        return fmax(stop - waveform->delay, 0) * fmax(waveform->frequency, waveform->frequency_end);
    struct shape shape;
    shape_from_waveform(waveform, &shape);
    return shape.period > 0 ? fmax(stop - corner_time(&shape, 0, 0), 0) / shape.period : 0;
}

void dea_waveform_clear(struct dea_waveform *waveform) {
    free(waveform->times);
    free(waveform->values);
    *waveform = (struct dea_waveform){.kind = DEA_WAVE_DC};
}
