/* What udunits2 answers for the units scenes are written in, so that most runs need not read its database: that takes
 * 4 ms, as long as a short run. tests/unit/test_known_units.c holds each answer against udunits2. */
#ifndef DEASIM_BASE_KNOWN_UNITS_H
#define DEASIM_BASE_KNOWN_UNITS_H

#include <stddef.h>

struct known_unit {
    const char *text, *si_unit;
    double scale; /* in si_unit */
};

extern const struct known_unit known_units[];
extern const size_t known_unit_count;

/* si_unit NULL: the SI unit of whatever it is. NULL when the pair is not among them, which says nothing about the unit.
 */
const struct known_unit *find_known_unit(const char *text, const char *si_unit);

#endif
