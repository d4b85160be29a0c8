/* Shared inside the output room: fast numbers, files written in whole rows, and the table of formats behind the
 * recorder. */
#ifndef DEASIM_OUTPUT_INTERNAL_H
#define DEASIM_OUTPUT_INTERNAL_H

#include "deasim/result.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* ---- numbers ---- */

#define DEA_NUMBER_LENGTH 20 /* most characters dea_number_write produces: sign, 12 digits, point, e-308 */

/* Writes what printf's "%.12g" would, without a terminating zero and about ten times as fast; "nan" without a sign.
 * Returns the number of characters, at most DEA_NUMBER_LENGTH. */
int dea_number_write(double value, char *text);

/* Reads one plain decimal number up to the first character that is not part of it, to within 1e-15 relative: quick, for
 * files of millions of rows. Also "nan" and "inf". Returns the end, or NULL when there is no number. */
const char *dea_number_read(const char *text, const char *end, double *value);

/* ---- a file that only ever holds whole rows ---- */

struct dea_row_file {
    int descriptor;   /* -1 when closed */
    char *buffer;     /* owned */
    size_t used;      /* bytes waiting in the buffer, always whole rows */
    size_t capacity;  /* bytes */
    size_t row_bytes; /* bytes of a binary row; 0: text, a row ends with a newline */
    int64_t size;     /* bytes in the file that are good */
    uint64_t rows;    /* rows in the file that are good */
    int trouble;      /* errno of the first failure; 0 none. Later writes do nothing. */
};

/* Creates or truncates the file. false: see errno. */
bool dea_row_file_open(struct dea_row_file *file, const char *path, size_t largest_row, size_t row_bytes);

/* Makes room for one row and returns where to put it; NULL after trouble. The caller adds what it wrote to `used`. */
char *dea_row_file_reserve(struct dea_row_file *file, size_t bytes);

/* Hands the buffer to the system. When not all of it fits, the file is cut back to its last whole row. */
bool dea_row_file_flush(struct dea_row_file *file);

/* Writes `bytes` at the start of the file, outside the row count (headers and their patches). */
bool dea_row_file_patch(struct dea_row_file *file, const void *data, size_t bytes, int64_t offset);

/* Closes and frees; the counters stay readable. false: trouble. */
bool dea_row_file_close(struct dea_row_file *file);

/* ---- formats ---- */

/* What every writer starts with. */
struct dea_writer {
    const struct dea_writer_class *class;
    char *path;         /* owned by the recorder */
    uint64_t safe_rows; /* rows known to be readable from the file */
    int trouble;        /* errno of the first failure; 0 none */
};

/* One format. Functions that return bool set writer->trouble on false; safe_rows is up to date after each. */
struct dea_writer_class {
    unsigned format; /* of enum dea_format */
    const char *file_name;
    struct dea_writer *(*open)(const char *path, const char *title, const struct dea_signal *signals, size_t count,
                               struct dea_error *error); /* NULL: error is filled */
    bool (*append)(struct dea_writer *writer, double time, const double *values);
    bool (*flush)(struct dea_writer *writer);
    bool (*close)(struct dea_writer *writer); /* flushes and closes; the memory itself is freed by the recorder */
};

extern const struct dea_writer_class dea_csv_writer, dea_raw_writer, dea_hdf5_writer;

/* Copies text for a header: control characters become blanks, at most `limit` bytes with the closing zero. */
void dea_header_text(const char *text, char *copy, size_t limit);

/* ---- words of a summary ---- */

/* "done", "stopped" or "failed". */
const char *dea_outcome_text(enum dea_status status);

/* "left", "right" or "platform". */
const char *dea_event_zone(const struct dea_event *event);

#endif
