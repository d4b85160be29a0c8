/* Waveforms from CSV files: two columns with their units in the header, read strictly. */
#include "deasim/quantity.h"
#include "drive/drive_internal.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>

#define LINE_LENGTH_MAX 1024
#define ROWS_MAX 10000000

struct reader {
    FILE *file;
    const char *path;
    const char *value_unit;         /* SI unit wanted of the second column */
    long line;                      /* of `text`, from 1 */
    char text[LINE_LENGTH_MAX + 1]; /* the line without its end */
    bool ended;                     /* no line was left */
    double time_scale, value_scale; /* SI per unit of the file */
    size_t capacity;                /* points allocated in the waveform */
};

/* ---- lines ---- */

/* Reads the next line, or sets `ended`. */
static enum dea_status read_line(struct reader *reader, struct dea_error *error) {
    size_t length = 0;
    int c = getc(reader->file);
    reader->line++;
    reader->ended = c == EOF;
    for (; c != EOF && c != '\n'; c = getc(reader->file)) {
        if (c == '\r') {
            int next = getc(reader->file);
            if (next == '\n')
                break;
            if (next != EOF)
                ungetc(next, reader->file);
        }
        if ((c < ' ' && c != '\t') || c == 127)
            return dea_fail(error, DEA_ERR_INPUT, "%s:%ld: not a text file: it holds the byte 0x%02x", reader->path,
                            reader->line, (unsigned)c);
        if (length == LINE_LENGTH_MAX)
            return dea_fail(error, DEA_ERR_INPUT, "%s:%ld: line longer than %d characters", reader->path, reader->line,
                            LINE_LENGTH_MAX);
        reader->text[length++] = (char)c;
    }
    reader->text[length] = '\0';
    if (ferror(reader->file))
        return dea_fail(error, DEA_ERR_INPUT, "%s: cannot be read: %s", reader->path, strerror(errno));
    return DEA_OK;
}

/* Text without blanks around it; cuts the given string. */
static char *trim(char *text) {
    text += strspn(text, " \t");
    size_t length = strlen(text);
    while (length > 0 && (text[length - 1] == ' ' || text[length - 1] == '\t'))
        length--;
    text[length] = '\0';
    return text;
}

/* Reads up to the next line that is no comment. `blank` receives the line number of the last blank line passed, or 0.
 */
static enum dea_status next_row(struct reader *reader, long *blank, struct dea_error *error) {
    *blank = 0;
    for (;;) {
        DEA_TRY(read_line(reader, error));
        const char *text = trim(reader->text);
        if (*text == '\0' && !reader->ended)
            *blank = reader->line;
        else if (*text != '#' || reader->ended)
            return DEA_OK;
    }
}

/* Cuts the line at its one comma. */
static enum dea_status split_row(struct reader *reader, char **time, char **value, struct dea_error *error) {
    int cells = 1;
    for (const char *p = reader->text; *p != '\0'; p++)
        cells += *p == ',';
    if (cells != 2)
        return dea_fail(error, DEA_ERR_INPUT, "%s:%ld: %d cell%s; two are needed, time and value, with a comma between",
                        reader->path, reader->line, cells, cells == 1 ? "" : "s");
    char *comma = strchr(reader->text, ',');
    *comma = '\0';
    *time = trim(reader->text);
    *value = trim(comma + 1);
    return DEA_OK;
}

/* ---- header ---- */

/* Takes "name [unit]" apart and gives the SI value of one unit. */
static enum dea_status parse_column(const struct reader *reader, char *cell, const char *si_unit, const char **name,
                                    double *scale, struct dea_error *error) {
    size_t length = strlen(cell);
    char *bracket = strchr(cell, '[');
    if (bracket == NULL || bracket == cell || cell[length - 1] != ']' || strchr(bracket + 1, '[') != NULL)
        return dea_fail(error, DEA_ERR_INPUT, "%s:%ld: column '%.60s' lacks its unit; write it as \"name [unit]\"",
                        reader->path, reader->line, cell);
    cell[length - 1] = '\0';
    *bracket = '\0';
    *name = trim(cell);

    /* An empty unit would leave a bare 1, which is SI already. */
    char one_unit[LINE_LENGTH_MAX + 3];
    const char *unit = trim(bracket + 1);
    struct dea_error cause;
    if (*unit == '\0')
        return dea_fail(error, DEA_ERR_INPUT, "%s:%ld: column '%.60s' has empty brackets; its unit is needed",
                        reader->path, reader->line, *name);
    snprintf(one_unit, sizeof one_unit, "1 %s", unit);
    if (dea_quantity_parse(one_unit, si_unit, scale, &cause) != DEA_OK)
        return dea_fail(error, DEA_ERR_INPUT, "%s:%ld: column '%.60s': %s", reader->path, reader->line, *name,
                        cause.text);
    return DEA_OK;
}

static enum dea_status read_header(struct reader *reader, struct dea_error *error) {
    static const unsigned char byte_order_mark[] = {0xef, 0xbb, 0xbf};
    for (size_t i = 0; i < sizeof byte_order_mark; i++) {
        int c = getc(reader->file);
        if (c != byte_order_mark[i]) {
            rewind(reader->file);
            break;
        }
    }
    long blank;
    DEA_TRY(next_row(reader, &blank, error));
    if (reader->ended)
        return dea_fail(error, DEA_ERR_INPUT, "%s: empty; a header \"time [unit], value [unit]\" is needed",
                        reader->path);
    char *time_cell, *value_cell;
    const char *time_name, *value_name;
    DEA_TRY(split_row(reader, &time_cell, &value_cell, error));
    DEA_TRY(parse_column(reader, time_cell, "s", &time_name, &reader->time_scale, error));
    DEA_TRY(parse_column(reader, value_cell, reader->value_unit, &value_name, &reader->value_scale, error));
    if (strcasecmp(time_name, "time") != 0)
        return dea_fail(error, DEA_ERR_INPUT, "%s:%ld: the first column is '%.60s'; it must be \"time [unit]\"",
                        reader->path, reader->line, time_name);
    return DEA_OK;
}

/* ---- rows ---- */

/* value times scale; a division where the scale is 1/10^n, so that 33 us is exactly 33e-6 s. */
static double scaled(double value, double scale) {
    double inverse = nearbyint(1 / scale);
    return scale < 1 && fabs(scale * inverse - 1) < 4e-16 ? value / inverse : value * scale;
}

/* A plain decimal number; units belong in the header. */
static enum dea_status parse_cell(const struct reader *reader, const char *cell, const char *what, double scale,
                                  double *value, struct dea_error *error) {
    struct dea_error cause;
    double number;
    if (*cell == '\0')
        return dea_fail(error, DEA_ERR_INPUT, "%s:%ld: the %s is missing", reader->path, reader->line, what);
    if (cell[strspn(cell, "0123456789+-.eE")] != '\0' || dea_quantity_parse(cell, "1", &number, &cause) != DEA_OK)
        return dea_fail(error, DEA_ERR_INPUT, "%s:%ld: the %s '%.40s' is not a finite decimal number", reader->path,
                        reader->line, what, cell);
    *value = scaled(number, scale);
    return DEA_OK;
}

static enum dea_status grow_points(struct reader *reader, struct dea_waveform *waveform, struct dea_error *error) {
    size_t capacity = reader->capacity == 0 ? 256 : 2 * reader->capacity;
    double *times = realloc(waveform->times, capacity * sizeof *times);
    if (times != NULL)
        waveform->times = times;
    double *values = times == NULL ? NULL : realloc(waveform->values, capacity * sizeof *values);
    if (values == NULL)
        return dea_fail(error, DEA_ERR_MEMORY, "%s:%ld: out of memory", reader->path, reader->line);
    waveform->values = values;
    reader->capacity = capacity;
    return DEA_OK;
}

static enum dea_status read_rows(struct reader *reader, struct dea_waveform *waveform, struct dea_error *error) {
    for (;;) {
        char *time_cell, *value_cell;
        long blank;
        DEA_TRY(next_row(reader, &blank, error));
        if (reader->ended)
            return DEA_OK;
        if (blank > 0)
            return dea_fail(error, DEA_ERR_INPUT, "%s:%ld: blank line between rows", reader->path, blank);
        size_t i = waveform->point_count;
        if (i == ROWS_MAX)
            return dea_fail(error, DEA_ERR_INPUT, "%s:%ld: more than %d rows", reader->path, reader->line, ROWS_MAX);
        if (i == reader->capacity)
            DEA_TRY(grow_points(reader, waveform, error));
        DEA_TRY(split_row(reader, &time_cell, &value_cell, error));
        DEA_TRY(parse_cell(reader, time_cell, "time", reader->time_scale, &waveform->times[i], error));
        DEA_TRY(parse_cell(reader, value_cell, "value", reader->value_scale, &waveform->values[i], error));
        waveform->point_count++;
        struct dea_error cause;
        if (dea_waveform_check_point(waveform, i, &cause) != DEA_OK)
            return dea_fail(error, DEA_ERR_INPUT, "%s:%ld: %s", reader->path, reader->line, cause.text);
    }
}

static enum dea_status read_all(struct reader *reader, struct dea_waveform *waveform, struct dea_error *error) {
    DEA_TRY(read_header(reader, error));
    DEA_TRY(read_rows(reader, waveform, error));
    if (waveform->point_count < 2)
        return dea_fail(error, DEA_ERR_INPUT, "%s: %zu row%s; at least two are needed", reader->path,
                        waveform->point_count, waveform->point_count == 1 ? "" : "s");
    return DEA_OK;
}

enum dea_status dea_waveform_read_csv(const char *path, const char *value_unit, struct dea_waveform *waveform,
                                      struct dea_error *error) {
    struct reader reader = {.path = path, .value_unit = value_unit};
    struct stat info;
    *waveform = (struct dea_waveform){.kind = DEA_WAVE_PWL};

    /* A pipe or a device could keep the reader waiting for ever. */
    if (stat(path, &info) == 0 && !S_ISREG(info.st_mode))
        return dea_fail(error, DEA_ERR_INPUT, "%s: not a regular file", path);
    reader.file = fopen(path, "rb");
    if (reader.file == NULL)
        return dea_fail(error, DEA_ERR_INPUT, "%s: cannot be opened: %s", path, strerror(errno));
    enum dea_status status = read_all(&reader, waveform, error);
    fclose(reader.file);
    if (status != DEA_OK)
        dea_waveform_clear(waveform);
    return status;
}
