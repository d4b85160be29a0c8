/* Expectations against results. */
#include "deasim/expect.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

static bool find_value(const struct dea_expectation *e, const struct dea_result *result, double *value) {
    if (e->measure == DEA_MEASURE_NETLIST) {
        for (size_t i = 0; i < result->measure_count; i++) {
            if (strcasecmp(result->measures[i].name, e->name) == 0) {
                *value = result->measures[i].value;
                return !result->measures[i].failed;
            }
        }
        return false;
    }
    for (size_t i = 0; i < result->signal_count; i++) {
        if (strcmp(result->signals[i].name, e->signal) != 0)
            continue;
        const struct dea_signal_stats *stats = &result->stats[i];
        *value = e->measure == DEA_MEASURE_MIN     ? stats->min
                 : e->measure == DEA_MEASURE_MAX   ? stats->max
                 : e->measure == DEA_MEASURE_FINAL ? stats->final
                                                   : stats->t_max;
        return true;
    }
    return false;
}

bool dea_expectation_met(const struct dea_expectation *e, const struct dea_result *result, char *text, int size) {
    double value = NAN;
    const char *dot = e->signal[0] != '\0' ? " " : "";
    if (!find_value(e, result, &value)) {
        snprintf(text, (size_t)size, "%s:%d: %s%s%s: the run has no such value", e->file, e->line, e->signal, dot,
                 e->name);
        return false;
    }
    bool met = value >= e->above && value <= e->below;
    snprintf(text, (size_t)size, "%s:%d: %s%s%s = %.9g, expected above %.9g and below %.9g: %s", e->file, e->line,
             e->signal, dot, e->name, value, e->above, e->below, met ? "met" : "not met");
    return met;
}
