/* result.raw: ngspice's binary raw file, one plot of doubles in the machine's byte order.
 *
 * Layout after ngspice 39, src/frontend/rawfile.c. Names are those of the CSV file: ngspice takes names with dots as
 * they are, so `print left.voltage`, `plot v(left.voltage) v(right.voltage)` and `meas tran m max v(left.voltage)` work
 * after `load`. (A current is `left.current`; ngspice reads i(name) as a branch current.) */
#include "output_internal.h"

#include <ctype.h>
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#define POINTS_WIDTH 15 /* characters of the point count, padded with blanks and patched in place */
#define TITLE_LIMIT 200 /* bytes; ngspice reads header lines into 512 */

struct raw_writer {
    struct dea_writer base;
    struct dea_row_file file;
    size_t signal_count;
    int64_t points_offset; /* where the point count stands in the header */
};

/* The words of ngspice's type table (src/frontend/typesdef.c) that fit. */
static const char *type_of_unit(const char *unit) {
    if (strcmp(unit, "V") == 0)
        return "voltage";
    if (strcmp(unit, "A") == 0)
        return "current";
    return "notype";
}

/* A name is one word in a raw file. */
static void write_name(const struct dea_signal *signal, FILE *header) {
    for (const char *in = signal->name; *in != '\0'; in++)
        fputc(isspace((unsigned char)*in) || iscntrl((unsigned char)*in) ? '_' : *in, header);
}

static bool write_header(struct raw_writer *writer, const char *title, const struct dea_signal *signals) {
    char *text = NULL, date[64] = "", clean[TITLE_LIMIT];
    size_t length = 0;
    FILE *header = open_memstream(&text, &length);
    if (header == NULL)
        return false;
    time_t now = time(NULL);
    struct tm local;
    if (localtime_r(&now, &local) != NULL)
        strftime(date, sizeof date, "%a %b %e %H:%M:%S %Y", &local);
    dea_header_text(title, clean, sizeof clean);
    fprintf(header, "Title: %s\nDate: %s\nPlotname: Transient Analysis\nFlags: real\n", clean, date);
    fprintf(header, "No. Variables: %zu\nNo. Points: ", writer->signal_count + 1);
    writer->points_offset = ftell(header);
    fprintf(header, "%-*d\nVariables:\n\t0\ttime\ttime\n", POINTS_WIDTH, 0);
    for (size_t i = 0; i < writer->signal_count; i++) {
        fprintf(header, "\t%zu\t", i + 1);
        write_name(&signals[i], header);
        fprintf(header, "\t%s\n", type_of_unit(signals[i].unit));
    }
    fputs("Binary:\n", header);
    bool good = !ferror(header);
    good = fclose(header) == 0 && good && dea_row_file_patch(&writer->file, text, length, 0);
    writer->file.size = (int64_t)length;
    if (writer->file.trouble != 0)
        errno = writer->file.trouble;
    free(text);
    return good;
}

static struct dea_writer *raw_open(const char *path, const char *title, const struct dea_signal *signals, size_t count,
                                   struct dea_error *error) {
    struct raw_writer *writer = calloc(1, sizeof *writer);
    if (writer == NULL) {
        dea_fail(error, DEA_ERR_MEMORY, "out of memory for %s", path);
        return NULL;
    }
    writer->signal_count = count;
    size_t row_bytes = (count + 1) * sizeof(double);
    bool opened = dea_row_file_open(&writer->file, path, row_bytes, row_bytes);
    if (opened && write_header(writer, title, signals))
        return &writer->base;
    dea_fail(error, opened ? DEA_ERR_OUTPUT : DEA_ERR_INPUT, "%s: cannot be written: %s", path, strerror(errno));
    if (opened)
        dea_row_file_close(&writer->file);
    free(writer);
    return NULL;
}

/* Patches the point count to the rows that are in the file; the count is written over existing bytes, so a full disk
 * allows it. */
static bool settle(struct raw_writer *writer, bool good) {
    char points[POINTS_WIDTH + 1];
    int width = snprintf(points, sizeof points, "%-*llu", POINTS_WIDTH, (unsigned long long)writer->file.rows);
    good =
        width == POINTS_WIDTH && dea_row_file_patch(&writer->file, points, POINTS_WIDTH, writer->points_offset) && good;
    writer->base.safe_rows = writer->file.rows;
    writer->base.trouble = writer->file.trouble;
    return good;
}

static bool raw_append(struct dea_writer *base, double time, const double *values) {
    struct raw_writer *writer = (struct raw_writer *)base;
    size_t row_bytes = writer->file.row_bytes;
    char *row = dea_row_file_reserve(&writer->file, row_bytes);
    if (row == NULL)
        return settle(writer, false);
    memcpy(row, &time, sizeof time);
    memcpy(row + sizeof time, values, row_bytes - sizeof time);
    writer->file.used += row_bytes;
    return true;
}

static bool raw_flush(struct dea_writer *base) {
    struct raw_writer *writer = (struct raw_writer *)base;
    return settle(writer, dea_row_file_flush(&writer->file));
}

static bool raw_close(struct dea_writer *base) {
    struct raw_writer *writer = (struct raw_writer *)base;
    raw_flush(base);
    bool good = dea_row_file_close(&writer->file);
    writer->base.trouble = writer->file.trouble;
    return good;
}

const struct dea_writer_class dea_raw_writer = {DEA_FORMAT_RAW, "result.raw", raw_open,
                                                raw_append,     raw_flush,    raw_close};
