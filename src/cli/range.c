/* "value" or "first:last:count" on the command line. */
#include "cli/range.h"

#include "deasim/quantity.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#define MAX_POINTS 1000000

static enum dea_status parse_count(const char *name, const char *text, int *count, struct dea_error *error) {
    char *end;
    errno = 0;
    long value = strtol(text, &end, 10);
    if (errno != 0 || end == text || *end != '\0' || value < 2 || value > MAX_POINTS)
        return dea_fail(error, DEA_ERR_INPUT, "%s: \"%s\" is not a number of points; 2 to %d are allowed", name, text,
                        MAX_POINTS);
    *count = (int)value;
    return DEA_OK;
}

static enum dea_status parse_value(const char *name, const char *text, const char *si_unit, double *value,
                                   struct dea_error *error) {
    struct dea_error inner;
    if (dea_quantity_parse(text, si_unit, value, &inner) != DEA_OK)
        return dea_fail(error, DEA_ERR_INPUT, "%s: %s", name, inner.text);
    return DEA_OK;
}

enum dea_status dea_range_parse(const char *name, const char *text, const char *si_unit, struct dea_range *range,
                                struct dea_error *error) {
    char parts[3][64];
    int count = 0;
    for (const char *from = text;; count++) {
        size_t length = strcspn(from, ":");
        if (count == 3 || length >= sizeof parts[0])
            return dea_fail(error, DEA_ERR_INPUT, "%s: \"%s\" is neither a value nor first:last:count", name, text);
        memcpy(parts[count], from, length);
        parts[count][length] = '\0';
        if (from[length] == '\0')
            break;
        from += length + 1;
    }
    DEA_TRY(parse_value(name, parts[0], si_unit, &range->first, error));
    range->last = range->first;
    range->count = 1;
    if (count == 0)
        return DEA_OK;
    if (count == 1)
        return dea_fail(error, DEA_ERR_INPUT, "%s: \"%s\" lacks the number of points, first:last:count", name, text);
    DEA_TRY(parse_value(name, parts[1], si_unit, &range->last, error));
    return parse_count(name, parts[2], &range->count, error);
}

double dea_range_value(const struct dea_range *range, int index) {
    if (index == 0)
        return range->first;
    if (index == range->count - 1)
        return range->last;
    double share = (double)index / (range->count - 1);
    return range->first * (1.0 - share) + range->last * share;
}
