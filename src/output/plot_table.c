/* Reads result.csv of any length in one pass into buckets that keep the extremes. */
#include "plot_internal.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define BLOCK ((size_t)1 << 20) /* bytes read at once, also the longest row */
#define LARGEST 1e100           /* beyond it a value is taken as missing: no axis can show it */

struct line_reader {
    int descriptor;
    char *block; /* owned, BLOCK bytes */
    size_t begin, end;
    uint64_t line; /* number of the line last returned */
    bool finished;
};

enum line_result { LINE, LINE_NONE, LINE_TROUBLE, LINE_LONG };

/* Next complete line; what follows the last newline is not one. */
static enum line_result next_line(struct line_reader *reader, const char **line, const char **line_end) {
    for (;;) {
        char *start = reader->block + reader->begin;
        char *stop = memchr(start, '\n', reader->end - reader->begin);
        if (stop != NULL) {
            reader->begin = (size_t)(stop - reader->block) + 1;
            reader->line++;
            *line = start;
            *line_end = stop > start && stop[-1] == '\r' ? stop - 1 : stop;
            return LINE;
        }
        if (reader->finished)
            return LINE_NONE;
        memmove(reader->block, start, reader->end - reader->begin);
        reader->end -= reader->begin;
        reader->begin = 0;
        if (reader->end == BLOCK)
            return LINE_LONG;
        ssize_t count = read(reader->descriptor, reader->block + reader->end, BLOCK - reader->end);
        if (count < 0 && errno != EINTR)
            return LINE_TROUBLE;
        reader->finished = count == 0;
        reader->end += count > 0 ? (size_t)count : 0;
    }
}

static enum dea_status open_reader(const char *path, struct line_reader *reader, struct dea_error *error) {
    *reader = (struct line_reader){.descriptor = open(path, O_RDONLY | O_CLOEXEC)};
    if (reader->descriptor < 0)
        return dea_fail(error, DEA_ERR_INPUT, "%s: there is no result to draw: %s", path, strerror(errno));
    reader->block = malloc(BLOCK);
    if (reader->block != NULL)
        return DEA_OK;
    close(reader->descriptor);
    return dea_fail(error, DEA_ERR_MEMORY, "out of memory for %s", path);
}

static void close_reader(struct line_reader *reader) {
    close(reader->descriptor);
    free(reader->block);
}

static enum dea_status fail_line(const char *path, const struct line_reader *reader, enum line_result result,
                                 struct dea_error *error) {
    if (result == LINE_LONG)
        return dea_fail(error, DEA_ERR_INPUT, "%s:%llu: a row longer than 1 MB", path,
                        (unsigned long long)reader->line + 1);
    return dea_fail(error, DEA_ERR_INPUT, "%s: cannot be read: %s", path, strerror(errno));
}

/* ---- header ---- */

/* One cell, with or without quotes, into text; returns where the next begins, NULL after the last. */
static const char *read_cell(const char *in, const char *end, char *text, size_t size) {
    size_t length = 0;
    bool quoted = in < end && *in == '"';
    for (in += quoted; in < end; in++) {
        if (quoted && *in == '"') {
            if (in + 1 < end && in[1] == '"')
                in++;
            else {
                quoted = false;
                continue;
            }
        } else if (!quoted && *in == ',')
            break;
        if (length + 1 < size)
            text[length++] = *in;
    }
    text[length] = '\0';
    return in < end ? in + 1 : NULL;
}

/* "left.voltage [V]" into name and unit. */
static void split_heading(char *heading, struct dea_signal *signal) {
    size_t length = strlen(heading);
    char *bracket = strrchr(heading, '[');
    *signal = (struct dea_signal){.unit = "1"};
    if (bracket != NULL && length > 0 && heading[length - 1] == ']') {
        heading[length - 1] = '\0';
        snprintf(signal->unit, sizeof signal->unit, "%.*s", (int)sizeof signal->unit - 1, bracket + 1);
        while (bracket > heading && bracket[-1] == ' ')
            bracket--;
        *bracket = '\0';
    }
    snprintf(signal->name, sizeof signal->name, "%.*s", (int)sizeof signal->name - 1, heading);
}

static enum dea_status read_header(struct dea_table *table, const char *line, const char *end,
                                   struct dea_error *error) {
    size_t commas = 0;
    for (const char *c = line; c < end; c++)
        commas += *c == ',';
    table->columns = calloc(commas + 1, sizeof *table->columns);
    if (table->columns == NULL)
        return dea_fail(error, DEA_ERR_MEMORY, "out of memory for %s", table->path);
    for (const char *cell = line; cell != NULL; table->column_count++) {
        char heading[sizeof(struct dea_signal) + 8];
        cell = read_cell(cell, end, heading, sizeof heading);
        split_heading(heading, &table->columns[table->column_count]);
    }
    if (strcmp(table->columns[0].name, "time") != 0)
        return dea_fail(error, DEA_ERR_INPUT, "%s:1: the first column must be time", table->path);
    return DEA_OK;
}

enum dea_status dea_table_open(const char *directory, struct dea_table *table, struct dea_error *error) {
    *table = (struct dea_table){.stride = 1};
    if (asprintf(&table->path, "%s/result.csv", directory) < 0) {
        table->path = NULL;
        return dea_fail(error, DEA_ERR_MEMORY, "out of memory for the path %s/result.csv", directory);
    }
    struct line_reader reader;
    DEA_TRY(open_reader(table->path, &reader, error));
    const char *line, *end;
    enum line_result result = next_line(&reader, &line, &end);
    enum dea_status status = result == LINE ? read_header(table, line, end, error)
                             : result == LINE_NONE
                                 ? dea_fail(error, DEA_ERR_INPUT, "%s: the file is empty", table->path)
                                 : fail_line(table->path, &reader, result, error);
    close_reader(&reader);
    return status;
}

/* ---- rows ---- */

static void start_bucket(struct dea_table *table) {
    for (size_t i = 0; i < table->curve_count; i++)
        table->curves[i].buckets[table->bucket_count] = (struct dea_bucket){.low = INFINITY, .high = -INFINITY};
    table->bucket_count++;
}

/* All buckets are full: two become one, and each takes twice the rows from now on. */
static void merge_buckets(struct dea_table *table) {
    for (size_t i = 0; i < table->curve_count; i++) {
        struct dea_bucket *buckets = table->curves[i].buckets;
        for (size_t k = 0; k < DEA_BUCKETS / 2; k++) {
            struct dea_bucket merged = buckets[2 * k], second = buckets[2 * k + 1];
            if (second.low < merged.low)
                merged.low = second.low, merged.t_low = second.t_low;
            if (second.high > merged.high)
                merged.high = second.high, merged.t_high = second.t_high;
            buckets[k] = merged;
        }
    }
    table->bucket_count = DEA_BUCKETS / 2;
    table->stride *= 2;
}

static void add_value(struct dea_curve *curve, size_t bucket, double time, double value) {
    if (!(fabs(value) < LARGEST))
        return;
    struct dea_bucket *extremes = &curve->buckets[bucket];
    if (value < extremes->low)
        extremes->low = value, extremes->t_low = time;
    if (value > extremes->high)
        extremes->high = value, extremes->t_high = time;
    if (!curve->any)
        curve->t_first = time, curve->first = value;
    curve->any = true;
    curve->t_last = time;
    curve->last = value;
}

static enum dea_status add_row(struct dea_table *table, uint64_t line_number, const char *line, const char *end,
                               struct dea_error *error) {
    double time;
    const char *in = dea_number_read(line, end, &time);
    if (in == NULL || (in < end && *in != ',') || !isfinite(time))
        return dea_fail(error, DEA_ERR_INPUT, "%s:%llu: the time is not a number", table->path,
                        (unsigned long long)line_number);
    if (table->rows % table->stride == 0) {
        if (table->bucket_count == DEA_BUCKETS)
            merge_buckets(table);
        start_bucket(table);
    }
    size_t column = 0;
    for (size_t i = 0; i < table->curve_count; i++) {
        for (; in != NULL && column < table->curves[i].column; column++) {
            in = memchr(in, ',', (size_t)(end - in));
            in = in != NULL ? in + 1 : NULL;
        }
        if (in == NULL)
            return dea_fail(error, DEA_ERR_INPUT, "%s:%llu: the row has %zu columns, the header %zu", table->path,
                            (unsigned long long)line_number, column, table->column_count);
        double value;
        const char *stop = dea_number_read(in, end, &value);
        if (stop == NULL || (stop < end && *stop != ','))
            return dea_fail(error, DEA_ERR_INPUT, "%s:%llu: %s is not a number", table->path,
                            (unsigned long long)line_number, table->columns[column].name);
        in = stop;
        add_value(&table->curves[i], table->bucket_count - 1, time, value);
    }
    if (table->rows == 0)
        table->t_first = time;
    table->t_last = time;
    table->rows++;
    return DEA_OK;
}

static enum dea_status read_rows(struct dea_table *table, struct line_reader *reader, struct dea_error *error) {
    const char *line, *end;
    enum line_result result = next_line(reader, &line, &end); /* the header again */
    while (result == LINE && (result = next_line(reader, &line, &end)) == LINE)
        DEA_TRY(add_row(table, reader->line, line, end, error));
    if (result != LINE_NONE)
        return fail_line(table->path, reader, result, error);
    if (table->rows == 0)
        return dea_fail(error, DEA_ERR_INPUT, "%s: the result holds no rows", table->path);
    return DEA_OK;
}

enum dea_status dea_table_read(struct dea_table *table, const size_t *columns, size_t count, struct dea_error *error) {
    table->curves = calloc(count + 1, sizeof *table->curves);
    table->curve_count = 0;
    bool good = table->curves != NULL;
    for (size_t i = 0; i < count && good; i++) {
        table->curves[i].column = columns[i];
        table->curves[i].buckets = calloc(DEA_BUCKETS, sizeof *table->curves[i].buckets);
        good = table->curves[i].buckets != NULL;
        table->curve_count++;
    }
    if (!good)
        return dea_fail(error, DEA_ERR_MEMORY, "out of memory for %s", table->path);
    struct line_reader reader;
    DEA_TRY(open_reader(table->path, &reader, error));
    enum dea_status status = read_rows(table, &reader, error);
    close_reader(&reader);
    return status;
}

void dea_table_clear(struct dea_table *table) {
    for (size_t i = 0; i < table->curve_count; i++)
        free(table->curves[i].buckets);
    free(table->curves);
    free(table->columns);
    free(table->path);
    *table = (struct dea_table){0};
}
