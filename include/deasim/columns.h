/* Measured or prescribed data: a CSV file of two columns with units in its header, "name [unit], name [unit]". Lines
 * that begin with # are comments. */
#ifndef DEASIM_COLUMNS_H
#define DEASIM_COLUMNS_H

#include "deasim/status.h"

#include <stdbool.h>
#include <stddef.h>

/* What a column must be. */
struct dea_column_wish {
    const char *word;        /* what it is called in messages */
    bool named;              /* its header must carry this very name */
    const char *si_units[2]; /* it must convert to the first or, when given, to the second */
};

struct dea_columns {
    double *values[2]; /* owned, SI */
    size_t count;      /* rows */
    int unit_index[2]; /* which of the wished units */
    char names[2][64]; /* as in the header, cut when longer */
};

/* Looks at row i, the last one read; its message is put behind "file:line: ". */
typedef enum dea_status (*dea_row_check)(void *context, const struct dea_columns *columns, size_t i,
                                         struct dea_error *error);

/* Reads a file strictly; `check` may be NULL. DEA_ERR_INPUT with file:line on a missing or foreign unit, a missing
 * cell, a number that is none or not finite, a blank line between rows, a line that is too long, bytes that are no
 * text. */
enum dea_status dea_columns_read(const char *path, const struct dea_column_wish wishes[2], dea_row_check check,
                                 void *context, struct dea_columns *columns, struct dea_error *error);

void dea_columns_clear(struct dea_columns *columns);

#endif
