/* Independent sources of a linear circuit: ngspice's functions of time as waveforms of our own. */
#include "circuit/linear_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A source is a sum of at most so many waveforms. */
enum { MAX_PARTS = 3, FIRST_WORD = 3 };
#define MAX_UNROLLED 100000 /* points of a repeated piecewise linear source */

/* ---- one line ---- */

/* All words from here on are numbers, from `least` to `most` of them; what is not given is 0. */
static bool numbers(const struct reader *reader, int from, double *values, int least, int most) {
    int count = reader->word_count - from;
    if (count < least || count > most)
        return false;
    for (int i = 0; i < count; i++)
        if (!dea_spice_number(reader->words[from + i], &values[i]) || !isfinite(values[i]))
            return false;
    return true;
}

/* PULSE(v1 v2 td tr tf pw per) with ngspice's defaults. */
static int read_pulse(const struct reader *reader, int from, struct dea_waveform *w) {
    double v[7] = {0};
    if (!numbers(reader, from, v, 2, 7))
        return 0;
    for (int i = 2; i < 7; i++)
        if (v[i] < 0.0)
            return 0;
    *w = (struct dea_waveform){.kind = DEA_WAVE_PULSE, .low = v[0], .high = v[1], .delay = v[2], .period = v[6]};
    w->rise = v[3] > 0.0 ? v[3] : reader->step;
    w->fall = v[4] > 0.0 ? v[4] : reader->step;
    w->width = v[5] > 0.0 ? v[5] : reader->stop;
    return 1;
}

/* SIN(vo va freq td theta phase) */
static int read_sine(const struct reader *reader, int from, struct dea_waveform *w) {
    double v[6] = {0};
    if (!numbers(reader, from, v, 2, 6))
        return 0;
    *w = (struct dea_waveform){.kind = DEA_WAVE_SINE,
                               .offset = v[0],
                               .amplitude = v[1],
                               .delay = v[3],
                               .decay = v[4],
                               .phase = v[5] * M_PI / 180.0};
    w->frequency = v[2] != 0.0 ? v[2] : 1.0 / reader->stop;
    return 1;
}

/* EXP(v1 v2 td1 tau1 td2 tau2): two decays, as sines that do not turn; delays of 0 are not given. */
static int read_exponential(const struct reader *reader, int from, struct dea_waveform *w) {
    double v[6] = {0};
    if (!numbers(reader, from, v, 2, 6))
        return 0;
    double start[2], tau[2];
    start[0] = v[2] != 0.0 ? v[2] : reader->step;
    tau[0] = v[3] != 0.0 ? v[3] : reader->step;
    start[1] = v[4] != 0.0 ? v[4] : start[0] + reader->step;
    tau[1] = v[5] != 0.0 ? v[5] : reader->step;
    if (!(start[0] >= 0.0) || !(start[1] >= start[0]) || !(tau[0] > 0.0) || !(tau[1] > 0.0))
        return 0;
    const double offset[] = {v[1], v[0] - v[1]};
    for (int i = 0; i < 2; i++)
        w[i] = (struct dea_waveform){.kind = DEA_WAVE_SINE,
                                     .offset = offset[i],
                                     .amplitude = i == 0 ? v[0] - v[1] : v[1] - v[0],
                                     .delay = start[i],
                                     .decay = 1.0 / tau[i],
                                     .phase = 0.5 * M_PI};
    return 2;
}

/* AM(va vo mf fc td): va (vo + sin(2 pi mf t)) sin(2 pi fc t) is the carrier and two side bands. */
static int read_modulated(const struct reader *reader, int from, struct dea_waveform *w) {
    double v[5] = {0};
    if (!numbers(reader, from, v, 4, 5) || !(v[2] > 0.0) || !(v[3] > v[2]))
        return 0;
    const double frequency[] = {v[3], v[3] - v[2], v[3] + v[2]};
    const double amplitude[] = {v[0] * v[1], 0.5 * v[0], -0.5 * v[0]};
    for (int i = 0; i < 3; i++)
        w[i] = (struct dea_waveform){.kind = DEA_WAVE_SINE,
                                     .amplitude = amplitude[i],
                                     .frequency = frequency[i],
                                     .delay = v[4],
                                     .phase = i == 0 ? 0.0 : 0.5 * M_PI};
    return 3;
}

/* ---- piecewise linear ---- */

static bool take_points(const struct reader *reader, int from, int count, struct dea_waveform *w) {
    w->times = calloc(w->point_count, sizeof *w->times);
    w->values = calloc(w->point_count, sizeof *w->values);
    if (w->times == NULL || w->values == NULL)
        return false;
    for (int i = 0; i < count; i++)
        if (!dea_spice_number(reader->words[from + i], i % 2 == 0 ? &w->times[i / 2] : &w->values[i / 2]))
            return false;
    return true;
}

/* What lies between times[first] and the last one again and again, until the end of the run. */
static bool unroll(const struct reader *reader, size_t first, struct dea_waveform *w) {
    size_t last = w->point_count - 1, added = last - first;
    double period = w->times[last] - w->times[first];
    double periods = ceil((reader->stop - w->times[last]) / period);
    if (!(period > 0.0) || !(periods * (double)(added + 1) < MAX_UNROLLED))
        return false;
    if (periods <= 0.0)
        return true;
    size_t room = w->point_count + (size_t)periods * (added + 1);
    double *times = realloc(w->times, room * sizeof *times);
    if (times != NULL)
        w->times = times;
    double *values = realloc(w->values, room * sizeof *values);
    if (values != NULL)
        w->values = values;
    if (times == NULL || values == NULL)
        return false;
    bool jump = values[last] != values[first];
    for (int n = 1; n <= (int)periods; n++)
        for (size_t i = jump ? first : first + 1; i <= last; i++) {
            times[w->point_count] = times[i] + n * period;
            values[w->point_count++] = values[i];
        }
    return true;
}

/* PWL(t1 v1 ...) r=from td=delay */
static int read_points(const struct reader *reader, int from, struct dea_waveform *w) {
    double repeat = -1.0, delay = 0.0, ignored;
    int count = 0;
    while (from + count < reader->word_count && dea_spice_number(reader->words[from + count], &ignored))
        count++;
    for (int i = from + count; i < reader->word_count; i += 2) {
        const char *name = reader->words[i];
        double *number = strcmp(name, "r") == 0 ? &repeat : strcmp(name, "td") == 0 ? &delay : NULL;
        if (number == NULL || i + 1 == reader->word_count || !dea_spice_number(reader->words[i + 1], number))
            return 0;
    }
    if (count < 2 || count % 2 != 0 || delay < 0.0)
        return 0;
    *w = (struct dea_waveform){.kind = DEA_WAVE_PWL, .point_count = (size_t)count / 2};
    bool good = take_points(reader, from, count, w);
    size_t first = 0;
    if (good && repeat != -1.0) {
        while (first < w->point_count && w->times[first] != repeat)
            first++;
        good = first + 1 < w->point_count;
    }
    for (size_t i = 0; good && i < w->point_count; i++)
        w->times[i] += delay;
    if (good && repeat != -1.0)
        good = unroll(reader, first, w);
    if (!good)
        dea_waveform_clear(w);
    return good ? 1 : 0;
}

/* ---- all functions ---- */

/* Behind the value: "ac [magnitude [phase]]" concerns small signals only. */
static int skip_small_signal(const struct reader *reader, int word) {
    double ignored;
    if (word == reader->word_count || strcmp(reader->words[word], "ac") != 0)
        return word;
    word++;
    for (int i = 0; i < 2 && word < reader->word_count && dea_spice_number(reader->words[word], &ignored); i++)
        word++;
    return word;
}

/* "[dc] value", then a function: what follows the nodes of a source. Returns how many waveforms it is the sum of; 0:
 * not understood. */
static int read_waveforms(const struct reader *reader, struct dea_waveform *w) {
    double level = 0.0;
    int word = FIRST_WORD;
    if (word < reader->word_count && strcmp(reader->words[word], "dc") == 0)
        word++;
    if (word < reader->word_count && dea_spice_number(reader->words[word], &level))
        word++;
    word = skip_small_signal(reader, word);
    w[0] = (struct dea_waveform){.kind = DEA_WAVE_DC, .level = level};
    if (word == reader->word_count)
        return 1;
    const struct {
        const char *name;
        int (*read)(const struct reader *reader, int from, struct dea_waveform *w);
    } functions[] = {{"pulse", read_pulse},
                     {"sin", read_sine},
                     {"exp", read_exponential},
                     {"am", read_modulated},
                     {"pwl", read_points}};
    for (size_t i = 0; i < sizeof functions / sizeof functions[0]; i++)
        if (strcmp(reader->words[word], functions[i].name) == 0)
            return functions[i].read(reader, word + 1, w);
    return 0;
}

static void multiply(struct dea_waveform *w, double factor) {
    double *const values[] = {&w->level, &w->low, &w->high, &w->offset, &w->amplitude};
    for (size_t i = 0; i < sizeof values / sizeof values[0]; i++)
        *values[i] *= factor;
    for (size_t i = 0; i < w->point_count; i++)
        w->values[i] *= factor;
}

static enum dea_status add_part(struct reader *reader, int row, int other_row, struct dea_waveform *waveform) {
    struct dea_network *network = reader->network;
    struct dea_network_source *sources = dea_grow(network->sources, (int)network->source_count, sizeof *sources);
    if (sources == NULL)
        return dea_fail(reader->error, DEA_ERR_MEMORY, "out of memory for the circuit's sources");
    network->sources = sources;
    sources[network->source_count++] = (struct dea_network_source){row, other_row, *waveform};
    *waveform = (struct dea_waveform){.kind = DEA_WAVE_DC}; /* its points are the network's now */
    return DEA_OK;
}

enum dea_status dea_linear_add_source(struct reader *reader, int row, int other_row, double multiplier) {
    struct dea_waveform parts[MAX_PARTS];
    struct dea_error ignored;
    int count = read_waveforms(reader, parts);
    double peak = 0.0;
    reader->linear = count > 0;
    for (int i = 0; i < count; i++) { /* what a waveform refuses, ngspice has its own ideas of */
        bool decay = parts[i].kind == DEA_WAVE_SINE && parts[i].frequency == 0.0;
        reader->linear = reader->linear && (decay || dea_waveform_check(&parts[i], &ignored) == DEA_OK);
        if (reader->linear) {
            multiply(&parts[i], multiplier);
            peak += dea_waveform_peak(&parts[i]);
        }
    }
    if (reader->linear && row >= BRANCH)
        reader->network->peak = fmax(reader->network->peak, peak);
    enum dea_status status = DEA_OK;
    for (int i = 0; i < count; i++) {
        if (reader->linear && status == DEA_OK)
            status = add_part(reader, row, other_row, &parts[i]);
        dea_waveform_clear(&parts[i]);
    }
    return status;
}
