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
    /* Before `delay` every waveform holds its value at `delay` (SPICE); frequencies in Hz.
     * dc: level. pulse (SPICE order): low, high, delay, rise, fall, width, period >= rise + width + fall; period 0 is a
     * single pulse, and a single pulse of width INFINITY is a step. rise or fall 0 is a jump.
     * trapezoid: low, high, delay, rise, width (flat), fall, gap: the pulse whose period is rise + width + fall + gap
     * (time at low between two). It repeats when `repeat`; otherwise it is a single one and gap is not read. sine:
     * offset + amplitude exp(-decay tau) sin(phase + 2 pi frequency tau), tau = t - delay; phase in rad, decay in 1/s.
     * chirp: offset, amplitude, phase; frequency -> frequency_end, linear in time over `duration` from delay, the phase
     * running on without a break, then held at frequency_end. */
    double level, low, high, delay, rise, fall, width, period, gap;
    double offset, amplitude, frequency, phase, decay;
    double frequency_end, duration;
    /* pwl: owned arrays of equal length, times non-decreasing; two equal times are a jump; the first value holds before
     * the first time, the last one after the last time. With `repeat` what lies between the first and the last time is
     * repeated for ever. */
    double *times, *values;
    size_t point_count;
    bool repeat;
};

/* One smooth piece of a waveform, valid from `start` to `end` (INFINITY: for ever). Cheap to evaluate, also at and a
 * little past both ends, so that both limits at a corner can be had: the right one is exact, the left one to rounding.
 */
struct dea_piece {
    enum { DEA_PIECE_LINE, DEA_PIECE_SINE, DEA_PIECE_CHIRP } kind;
    double start, end;   /* s */
    double value, slope; /* line: value + slope (t - start) */
    /* sine and chirp: offset + amplitude exp(-decay tau) sin(phase + omega tau + sweep tau^2 / 2), tau = t - start */
    double offset, amplitude, omega, phase, decay, sweep;
};

/* Checks a waveform filled by hand or by the reader; the message names the kind and the parameter. Every other function
 * here wants a waveform that passed. Refused with DEA_ERR_INPUT: numbers that are not finite or absurdly large, times
 * below 0 or between 0 and 1 fs, frequencies and durations of 0, growing sines, periods shorter than what they hold. */
enum dea_status dea_waveform_check(const struct dea_waveform *waveform, struct dea_error *error);

/* The piece that holds just after time t (>= 0): start <= t < end. Its `end` is the next corner (jump or kink) after t,
 * and the piece asked for at that very number starts there. Periods are counted with integers, never accumulated.
 * Pieces of zero length (rise 0, or too short to be told apart in a double at this t) are skipped, which makes them
 * jumps. Where a double no longer resolves the period at all, the value at its start is held for ever. */
void dea_waveform_piece(const struct dea_waveform *waveform, double t, struct dea_piece *piece);

/* Value of a piece at t, and its time derivative in *rate (may be NULL). */
double dea_piece_value(const struct dea_piece *piece, double t, double *rate);

/* Right-limit value at t (left limits come from the piece before). */
double dea_waveform_value(const struct dea_waveform *waveform, double t);

/* Largest |value| the waveform can take, for scales; a bound for sines and chirps, exact for the others. */
double dea_waveform_peak(const struct dea_waveform *waveform);

/* How many periods the waveform runs through from 0 to `stop` (s), at the highest frequency of a chirp; 0 when it does
 * not repeat. */
double dea_waveform_periods(const struct dea_waveform *waveform, double stop);

/* Reads a CSV waveform: header "time [unit], value [unit]" (any name for the value), then rows of two numbers. Lines
 * that start with # are comments. Fills a pwl waveform in SI; two rows of equal time are a jump. Messages name
 * file:line. Refused: missing unit, unit that does not convert to s or to value_unit, fewer than two rows, times that
 * go back or are below 0, a third row of the same time, missing cells, blank lines between rows, non-finite numbers,
 * what is not text. `value_unit` is "V" or "N". On failure *waveform is cleared. */
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
