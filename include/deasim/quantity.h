/* Numbers with units, as written in scene files and on the command line. */
#ifndef DEASIM_QUANTITY_H
#define DEASIM_QUANTITY_H

#include "deasim/status.h"

/* Parses text such as "3300 V", "0.1ms", "100 V/um", "4e3" into SI. `si_unit` is what the caller expects ("V", "s",
 * "m", "V/m", "Pa", "kg", "kg/m^3", "Ohm", "Ohm/sq", "N s/m", "rad", "1" for dimensionless); NULL accepts any dimension
 * and gives its SI base value. A bare number is already SI. Refused with DEA_ERR_INPUT, *value untouched: a unit that
 * is unknown or of another dimension, trailing text, nan, inf, overflow. Safe from several threads, whatever the
 * locale. */
enum dea_status dea_quantity_parse(const char *text, const char *si_unit, double *value, struct dea_error *error);

/* Names the dimension of a unit, for messages: "m" -> "a length"; "a quantity" when unknown or NULL. */
const char *dea_quantity_kind(const char *si_unit);

/* Writes a value with a readable prefix and four digits, for messages: 0.0033, "m" -> "3.3 mm". Returns buffer. */
const char *dea_quantity_format(double value, const char *si_unit, char *buffer, int size);

#endif
