/* Native drive waveforms and the amplifier in front of an electrode. Values are in the unit of what is driven
 * (V for sources, N for a load), times in s. */
#ifndef DEASIM_WAVEFORM_H
#define DEASIM_WAVEFORM_H

#include "deasim/status.h"

#include <stdbool.h>
#include <stddef.h>

enum dea_waveform_kind {
    DEA_WAVE_DC,
    DEA_WAVE_PULSE,
    DEA_WAVE_PWL, /* also a file, read into points */
    DEA_WAVE_SINE,
    DEA_WAVE_CHIRP,
    DEA_WAVE_TRAPEZOID,
    DEA_WAVE_COUNT
};

struct dea_waveform {
    enum dea_waveform_kind kind;
    /* dc: level. pulse (SPICE order): low, high, delay, rise, fall, width, period (0: a single pulse).
     * trapezoid: low, high, delay, rise, width (flat), fall, gap (time at low between two), repeated when period() > 0
     * sine: offset, amplitude, frequency, delay, phase (rad), decay (1/s); before delay the value at delay (SPICE).
     * chirp: offset, amplitude, frequency -> frequency_end over duration from delay, then held at frequency_end. */
    double level, low, high, delay, rise, fall, width, period;
    double offset, amplitude, frequency, phase, decay;
    double frequency_end, duration;
    /* pwl: owned arrays of equal length, times non-decreasing; two equal times are a jump; held after the last point,
     * repeated from the first when `repeat`. */
    double *times, *values;
    size_t point_count;
    bool repeat;
};

/* One smooth piece of a waveform, valid from `start` to `end` (INFINITY: for ever). Cheap to evaluate, also at and a
 * little past both ends, so that left and right limits at a corner are exact. */
struct dea_piece {
    enum { DEA_PIECE_LINE, DEA_PIECE_SINE, DEA_PIECE_CHIRP } kind;
    double start, end;   /* s */
    double value, slope; /* line: value + slope (t - start) */
    double offset, amplitude, omega, phase, decay,
        sweep; /* sine: offset + amplitude exp(-decay tau) sin(phase + omega tau + sweep tau^2 / 2), tau = t - start */
};

/* Checks a waveform filled by hand or by the reader; message names the parameter. All times >= 0, finite numbers, ...
 */
enum dea_status dea_waveform_check(const struct dea_waveform *waveform, struct dea_error *error);

/* The piece that holds just after time t. Its `end` is the next corner (jump or kink) after t. Periods are counted with
 * integers, never accumulated. Pieces of zero length (rise 0) are skipped, which makes them jumps. */
void dea_waveform_piece(const struct dea_waveform *waveform, double t, struct dea_piece *piece);

/* Value of a piece at t, and its time derivative in *rate (may be NULL). */
double dea_piece_value(const struct dea_piece *piece, double t, double *rate);

/* Right-limit value at t (left limits come from the piece before). */
double dea_waveform_value(const struct dea_waveform *waveform, double t);

/* Largest |value| the waveform can take, for scales. */
double dea_waveform_peak(const struct dea_waveform *waveform);

/* Reads a CSV waveform: header "time [unit], value [unit]" then rows. Fills a pwl waveform in SI. Messages name
 * file:line. Refused: missing unit, unit that does not convert to s or to value_unit, fewer than two rows, times that
 * go back, missing cells, non-finite numbers. `value_unit` is "V" or "N". */
enum dea_status dea_waveform_read_csv(const char *path, const char *value_unit, struct dea_waveform *waveform,
                                      struct dea_error *error);

/* Frees the points and clears. */
void dea_waveform_clear(struct dea_waveform *waveform);

/* High-voltage amplifier between waveform and electrode: slew limit and one pole act on the commanded voltage, current
 * limit and output resistance on the output. A field that is 0 (output_resistance) or INFINITY (others) is absent. */
struct dea_amplifier {
    double slew_rate;         /* V/s */
    double current_limit;     /* A */
    double bandwidth;         /* Hz, -3 dB */
    double output_resistance; /* Ohm */
};

#endif
