/* result.csv: one header row "name [unit]", then rows of twelve significant digits in SI. */
#include "output_internal.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

struct csv_writer {
    struct dea_writer base;
    struct dea_row_file file;
    size_t signal_count;
    size_t largest_row; /* bytes */
};

/* Longest header cell: name and unit with every character a doubled quote, blank, brackets, quotes, comma. */
#define HEADER_CELL (2 * sizeof(struct dea_signal) + 8)

/* Quoted only where the name itself needs it (RFC 4180). */
static size_t write_header_cell(const struct dea_signal *signal, char *out) {
    char plain[sizeof(struct dea_signal) + 8], clean[sizeof plain];
    size_t length = 0;
    snprintf(plain, sizeof plain, "%s [%s]", signal->name, signal->unit);
    dea_header_text(plain, clean, sizeof clean);
    bool quoted = strpbrk(clean, ",\"") != NULL;
    if (quoted)
        out[length++] = '"';
    for (const char *in = clean; *in != '\0'; in++) {
        if (*in == '"')
            out[length++] = '"';
        out[length++] = *in;
    }
    if (quoted)
        out[length++] = '"';
    return length;
}

static bool write_header(struct csv_writer *writer, const struct dea_signal *signals) {
    size_t room = 16 + writer->signal_count * HEADER_CELL;
    char *header = malloc(room);
    if (header == NULL)
        return false;
    memcpy(header, "time [s]", 8);
    size_t length = 8;
    for (size_t i = 0; i < writer->signal_count; i++) {
        header[length++] = ',';
        length += write_header_cell(&signals[i], header + length);
    }
    header[length++] = '\n';
    bool good = dea_row_file_patch(&writer->file, header, length, 0);
    writer->file.size = (int64_t)length;
    if (!good)
        errno = writer->file.trouble;
    free(header);
    return good;
}

static struct dea_writer *csv_open(const char *path, const char *title, const struct dea_signal *signals, size_t count,
                                   struct dea_error *error) {
    (void)title;
    struct csv_writer *writer = calloc(1, sizeof *writer);
    if (writer == NULL) {
        dea_fail(error, DEA_ERR_MEMORY, "out of memory for %s", path);
        return NULL;
    }
    writer->signal_count = count;
    writer->largest_row = (count + 1) * (DEA_NUMBER_LENGTH + 1);
    bool opened = dea_row_file_open(&writer->file, path, writer->largest_row, 0);
    if (opened && write_header(writer, signals))
        return &writer->base;
    dea_fail(error, opened ? DEA_ERR_OUTPUT : DEA_ERR_INPUT, "%s: cannot be written: %s", path, strerror(errno));
    if (opened)
        dea_row_file_close(&writer->file);
    free(writer);
    return NULL;
}

/* Copies the file's counters to where the recorder looks. */
static bool settle(struct csv_writer *writer, bool good) {
    writer->base.safe_rows = writer->file.rows;
    writer->base.trouble = writer->file.trouble;
    return good;
}

static bool csv_append(struct dea_writer *base, double time, const double *values) {
    struct csv_writer *writer = (struct csv_writer *)base;
    char *row = dea_row_file_reserve(&writer->file, writer->largest_row);
    if (row == NULL)
        return settle(writer, false);
    char *out = row + dea_number_write(time, row);
    for (size_t i = 0; i < writer->signal_count; i++) {
        *out++ = ',';
        out += dea_number_write(values[i], out);
    }
    *out++ = '\n';
    writer->file.used += (size_t)(out - row);
    return true;
}

static bool csv_flush(struct dea_writer *base) {
    struct csv_writer *writer = (struct csv_writer *)base;
    return settle(writer, dea_row_file_flush(&writer->file));
}

static bool csv_close(struct dea_writer *base) {
    struct csv_writer *writer = (struct csv_writer *)base;
    return settle(writer, dea_row_file_close(&writer->file));
}

const struct dea_writer_class dea_csv_writer = {DEA_FORMAT_CSV, "result.csv", csv_open,
                                                csv_append,     csv_flush,    csv_close};
