/* Values of one quantity given on the command line: one value, or start:stop:count. */
#ifndef DEASIM_CLI_RANGE_H
#define DEASIM_CLI_RANGE_H

#include "deasim/status.h"

struct dea_range {
    double first, last; /* SI */
    int count;          /* points, both ends included; 1: only `first` */
};

/* Parses "3.3 kV" or "0:4kV:41". `name` opens the messages. */
enum dea_status dea_range_parse(const char *name, const char *text, const char *si_unit, struct dea_range *range,
                                struct dea_error *error);

/* The index-th value; the ends are exact. */
double dea_range_value(const struct dea_range *range, int index);

#endif
