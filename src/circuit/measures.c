/* Follows a run for its .measure lines. */
#include "circuit/measures_internal.h"

#include "circuit/netlist_internal.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

struct dea_measures {
    struct measure *all; /* owned */
    int count, row_length;
    struct dea_engine_measure *results; /* owned */
};

/* A step being followed. */
struct step {
    double from, to; /* s */
    const double *rows;
    int row_length;
};

static double time_at(const struct step *step, double u) {
    return u == CURVE_END ? step->to : step->from + (step->to - step->from) * u / CURVE_END;
}

/* The part of the step that lies in a window; false where there is none. */
static bool cut_window(const struct step *step, double from, double to, double *low, double *high) {
    double rate = CURVE_END / (step->to - step->from);
    *low = fmin(fmax((from - step->from) * rate, 0.0), CURVE_END);
    *high = fmin(fmax((to - step->from) * rate, 0.0), CURVE_END);
    return from <= step->to && to >= step->from && *low <= *high;
}

/* ---- moments ---- */

/* The signal's next value at a place: has it passed zero, upwards or downwards? Resting at zero is no passage. */
static bool passes(struct moment *moment, double value) {
    bool rise = moment->side < 0 && (value > 0.0 || (value == 0.0 && moment->before < 0.0));
    bool fall = moment->side > 0 && (value < 0.0 || (value == 0.0 && moment->before > 0.0));
    if (rise || fall)
        moment->side = rise ? 1 : -1;
    return (rise && moment->edge != EDGE_FALL) || (fall && moment->edge != EDGE_RISE);
}

/* True when the moment was found anew, at *place. */
static bool follow_moment(struct moment *moment, const struct step *step, double *place) {
    double low, high, places[CURVE_POINTS];
    bool finished = moment->found && moment->number != LAST_PASSAGE, anew = false;
    if (moment->given || finished || !cut_window(step, moment->from, moment->to, &low, &high))
        return false;
    struct curve curve;
    curve_fit(&curve, &moment->signal, step->rows, step->row_length);
    int count = curve_places(&curve, low, high, places);
    for (int i = 0; i < count; i++) {
        double value = curve_at(&curve, places[i]);
        if (!moment->begun) {
            moment->begun = true;
            moment->side = value < 0.0 ? -1 : 1;
        } else if (passes(moment, value) && (++moment->passages == moment->number || moment->number == LAST_PASSAGE)) {
            /* at the first place it passed since the step before, in a jump */
            *place = i == 0 ? places[0] : curve_zero(&curve, places[i - 1], places[i]);
            moment->time = time_at(step, *place);
            moment->found = anew = true;
        }
        moment->before = value;
        if (moment->found && moment->number != LAST_PASSAGE)
            break;
    }
    return anew;
}

/* ---- signals ---- */

static void note_extremes(struct measure *measure, const struct step *step, const struct curve *curve, double low,
                          double high) {
    double places[CURVE_POINTS];
    int count = curve_places(curve, low, high, places);
    for (int i = 0; i < count; i++) {
        double value = curve_at(curve, places[i]);
        if (!measure->begun || value > measure->most) {
            measure->most = value;
            measure->most_at = time_at(step, places[i]);
        }
        if (!measure->begun || value < measure->least) {
            measure->least = value;
            measure->least_at = time_at(step, places[i]);
        }
        measure->begun = true;
    }
}

static void follow_statistic(struct measure *measure, const struct step *step) {
    double low, high, pace = (step->to - step->from) / CURVE_END;
    if (!cut_window(step, measure->from, measure->to, &low, &high))
        return;
    struct curve curve;
    curve_fit(&curve, &measure->signal, step->rows, step->row_length);
    if (measure->kind == MEASURE_MEAN || measure->kind == MEASURE_INTEGRAL)
        measure->sum += pace * curve_integral(&curve, low, high);
    else if (measure->kind == MEASURE_RMS)
        measure->sum += pace * curve_square_integral(&curve, low, high);
    else
        note_extremes(measure, step, &curve, low, high);
    measure->covered += pace * (high - low);
}

static void find_value(struct measure *measure, const struct step *step, double place) {
    struct curve curve;
    curve_fit(&curve, &measure->signal, step->rows, step->row_length);
    measure->value = curve_at(&curve, place);
}

static void follow(struct measure *measure, const struct step *step) {
    double place, high, at = measure->moment.time;
    switch (measure->kind) {
    case MEASURE_FIND_AT:
        if (!measure->moment.found && cut_window(step, at, at, &place, &high)) {
            find_value(measure, step, place);
            measure->moment.found = true;
        }
        break;
    case MEASURE_WHEN:
    case MEASURE_FIND_WHEN:
        if (follow_moment(&measure->moment, step, &place) && measure->kind == MEASURE_FIND_WHEN)
            find_value(measure, step, place);
        break;
    case MEASURE_DELAY:
        follow_moment(&measure->moment, step, &place);
        follow_moment(&measure->targ, step, &place);
        break;
    default:
        follow_statistic(measure, step);
    }
}

void dea_measures_follow(struct dea_measures *measures, double from, double to, const double *rows) {
    const struct step step = {.from = from, .to = to, .rows = rows, .row_length = measures->row_length};
    for (int i = 0; i < measures->count; i++)
        follow(&measures->all[i], &step);
}

/* ---- results ---- */

/* NAN: failed. */
static double conclude(const struct measure *measure) {
    switch (measure->kind) {
    case MEASURE_MAX:
        return measure->begun ? measure->most : NAN;
    case MEASURE_MIN:
        return measure->begun ? measure->least : NAN;
    case MEASURE_PEAK_TO_PEAK:
        return measure->begun ? measure->most - measure->least : NAN;
    case MEASURE_MAX_AT:
        return measure->begun ? measure->most_at : NAN;
    case MEASURE_MIN_AT:
        return measure->begun ? measure->least_at : NAN;
    case MEASURE_MEAN:
        return measure->sum / measure->covered;
    case MEASURE_RMS:
        return sqrt(measure->sum / measure->covered);
    case MEASURE_INTEGRAL:
        return measure->covered > 0.0 ? measure->sum : NAN;
    case MEASURE_WHEN:
        return measure->moment.found ? measure->moment.time : NAN;
    case MEASURE_FIND_AT:
    case MEASURE_FIND_WHEN:
        return measure->moment.found ? measure->value : NAN;
    case MEASURE_DELAY:
        return (measure->moment.found || measure->moment.given) && (measure->targ.found || measure->targ.given)
                   ? measure->targ.time - measure->moment.time
                   : NAN;
    }
    return NAN;
}

const struct dea_engine_measure *dea_measures_results(struct dea_measures *measures, int *count) {
    for (int i = 0; i < measures->count; i++) {
        double value = conclude(&measures->all[i]);
        measures->results[i].failed = !isfinite(value);
        measures->results[i].value = measures->results[i].failed ? 0.0 : value;
    }
    *count = measures->count;
    return measures->results;
}

/* ---- reading ---- */

/* ".measure tran name ..." in lower case; the next measure. False: not understood. */
static bool read_line(struct dea_measures *measures, const char *line, const struct row_names *names) {
    const char *rest = line;
    char word[DEA_TOKEN_MAX];
    struct dea_engine_measure *result = &measures->results[measures->count];
    for (int i = 0; i < 3; i++) /* the card, the analysis, the name */
        if (!dea_netlist_token(&rest, word) || (i == 1 && strcmp(word, "tran") != 0))
            return false;
    if (snprintf(result->name, sizeof result->name, "%s", word) >= (int)sizeof result->name)
        return false;
    char *text = strdup(rest);
    if (text == NULL)
        return false; /* ngspice will find out as well */
    for (char *c = text; *c != '\0'; c++)
        *c = (char)tolower((unsigned char)*c);
    bool good = measure_read(&measures->all[measures->count++], text, names);
    free(text);
    return good;
}

enum dea_status dea_measures_read(const struct dea_netlist *netlist, const char *const *names, int count,
                                  struct dea_measures **measures, struct dea_error *error) {
    const struct row_names row_names = {.names = names, .count = count};
    struct dea_measures *made = calloc(1, sizeof *made);
    *measures = NULL;
    if (made != NULL) {
        made->row_length = count;
        made->all = calloc((size_t)netlist->measure_count + 1, sizeof *made->all);
        made->results = calloc((size_t)netlist->measure_count + 1, sizeof *made->results);
    }
    if (made == NULL || made->all == NULL || made->results == NULL) {
        dea_measures_destroy(made);
        return dea_fail(error, DEA_ERR_MEMORY, "out of memory for %d measures", netlist->measure_count);
    }
    bool good = true;
    for (int i = 1; i < netlist->line_count && good; i++)
        if (netlist->lines[i].passed && strncasecmp(netlist->lines[i].text, ".meas", 5) == 0)
            good = made->count < netlist->measure_count && read_line(made, netlist->lines[i].text, &row_names);
    if (good && made->count == netlist->measure_count)
        *measures = made;
    else
        dea_measures_destroy(made);
    return DEA_OK;
}

void dea_measures_destroy(struct dea_measures *measures) {
    if (measures == NULL)
        return;
    free(measures->all);
    free(measures->results);
    free(measures);
}
