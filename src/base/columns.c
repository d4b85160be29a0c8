/* Two columns of a CSV file with their units in the header, read strictly. */
#include "deasim/columns.h"
#include "deasim/quantity.h"

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
    const struct dea_column_wish *wishes;
    long line;                      /* of `text`, from 1 */
    char text[LINE_LENGTH_MAX + 1]; /* the line without its end */
    bool ended;                     /* no line was left */
    double scales[2];               /* SI per unit of the file */
    size_t capacity;                /* rows allocated in the columns */
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
static enum dea_status split_row(struct reader *reader, char *parts[2], struct dea_error *error) {
    int cells = 1;
    for (const char *p = reader->text; *p != '\0'; p++)
        cells += *p == ',';
    if (cells != 2)
        return dea_fail(error, DEA_ERR_INPUT, "%s:%ld: %d cell%s; two are needed, %s and %s, with a comma between",
                        reader->path, reader->line, cells, cells == 1 ? "" : "s", reader->wishes[0].word,
                        reader->wishes[1].word);
    char *comma = strchr(reader->text, ',');
    *comma = '\0';
    parts[0] = trim(reader->text);
    parts[1] = trim(comma + 1);
    return DEA_OK;
}

/* ---- header ---- */

/* Takes "name [unit]" apart and gives the SI value of one unit and which of the wished units it converts to. */
static enum dea_status parse_column(const struct reader *reader, char *cell, const struct dea_column_wish *wish,
                                    const char **name, int *unit_index, double *scale, struct dea_error *error) {
    size_t length = strlen(cell);
    char *bracket = strchr(cell, '[');
    if (bracket == NULL || bracket == cell || cell[length - 1] != ']' || strchr(bracket + 1, '[') != NULL)
        return dea_fail(error, DEA_ERR_INPUT, "%s:%ld: column '%.60s' lacks its unit; write it as \"name [unit]\"",
                        reader->path, reader->line, cell);
    cell[length - 1] = '\0';
    *bracket = '\0';
    *name = trim(cell);
    if (wish->named && strcasecmp(*name, wish->word) != 0)
        return dea_fail(error, DEA_ERR_INPUT, "%s:%ld: the %s column is '%.60s'; it must be \"%s [unit]\"",
                        reader->path, reader->line, wish == reader->wishes ? "first" : "second", *name, wish->word);

    /* An empty unit would leave a bare 1, which is SI already. */
    char one_unit[LINE_LENGTH_MAX + 3];
    const char *unit = trim(bracket + 1);
    struct dea_error cause;
    if (*unit == '\0')
        return dea_fail(error, DEA_ERR_INPUT, "%s:%ld: column '%.60s' has empty brackets; its unit is needed",
                        reader->path, reader->line, *name);
    snprintf(one_unit, sizeof one_unit, "1 %s", unit);
    for (*unit_index = 1; *unit_index >= 0; --*unit_index) {
        const char *wanted = wish->si_units[*unit_index];
        *scale = 1.0;
        if (wanted != NULL && strcmp(wanted, "1") == 0 && strcmp(unit, "1") == 0) /* a number without dimension */
            return DEA_OK;
        if (wanted != NULL && dea_quantity_parse(one_unit, wanted, scale, &cause) == DEA_OK)
            return DEA_OK;
    }
    return dea_fail(error, DEA_ERR_INPUT, "%s:%ld: column '%.60s': %s", reader->path, reader->line, *name, cause.text);
}

static enum dea_status read_header(struct reader *reader, struct dea_columns *columns, struct dea_error *error) {
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
        return dea_fail(error, DEA_ERR_INPUT, "%s: empty; a header \"%s [unit], %s [unit]\" is needed", reader->path,
                        reader->wishes[0].word, reader->wishes[1].word);
    char *cells[2];
    const char *names[2];
    DEA_TRY(split_row(reader, cells, error));
    for (int k = 0; k < 2; k++)
        DEA_TRY(parse_column(reader, cells[k], &reader->wishes[k], &names[k], &columns->unit_index[k],
                             &reader->scales[k], error));
    for (int k = 0; k < 2; k++)
        snprintf(columns->names[k], sizeof columns->names[k], "%s", names[k]);
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

static enum dea_status grow_columns(struct reader *reader, struct dea_columns *columns, struct dea_error *error) {
    size_t capacity = reader->capacity == 0 ? 256 : 2 * reader->capacity;
    for (int k = 0; k < 2; k++) {
        double *values = realloc(columns->values[k], capacity * sizeof *values);
        if (values == NULL)
            return dea_fail(error, DEA_ERR_MEMORY, "%s:%ld: out of memory", reader->path, reader->line);
        columns->values[k] = values;
    }
    reader->capacity = capacity;
    return DEA_OK;
}

static enum dea_status read_rows(struct reader *reader, dea_row_check check, void *context, struct dea_columns *columns,
                                 struct dea_error *error) {
    for (;;) {
        char *cells[2];
        long blank;
        DEA_TRY(next_row(reader, &blank, error));
        if (reader->ended)
            return DEA_OK;
        if (blank > 0)
            return dea_fail(error, DEA_ERR_INPUT, "%s:%ld: blank line between rows", reader->path, blank);
        size_t i = columns->count;
        if (i == ROWS_MAX)
            return dea_fail(error, DEA_ERR_INPUT, "%s:%ld: more than %d rows", reader->path, reader->line, ROWS_MAX);
        if (i == reader->capacity)
            DEA_TRY(grow_columns(reader, columns, error));
        DEA_TRY(split_row(reader, cells, error));
        for (int k = 0; k < 2; k++)
            DEA_TRY(
                parse_cell(reader, cells[k], reader->wishes[k].word, reader->scales[k], &columns->values[k][i], error));
        columns->count++;
        struct dea_error cause;
        if (check != NULL && check(context, columns, i, &cause) != DEA_OK)
            return dea_fail(error, DEA_ERR_INPUT, "%s:%ld: %s", reader->path, reader->line, cause.text);
    }
}

enum dea_status dea_columns_read(const char *path, const struct dea_column_wish wishes[2], dea_row_check check,
                                 void *context, struct dea_columns *columns, struct dea_error *error) {
    struct reader reader = {.path = path, .wishes = wishes};
    struct stat info;
    *columns = (struct dea_columns){0};

    /* A pipe or a device could keep the reader waiting for ever. */
    if (stat(path, &info) == 0 && !S_ISREG(info.st_mode))
        return dea_fail(error, DEA_ERR_INPUT, "%s: not a regular file", path);
    reader.file = fopen(path, "rb");
    if (reader.file == NULL)
        return dea_fail(error, DEA_ERR_INPUT, "%s: cannot be opened: %s", path, strerror(errno));
    enum dea_status status = read_header(&reader, columns, error);
    if (status == DEA_OK)
        status = read_rows(&reader, check, context, columns, error);
    fclose(reader.file);
    if (status != DEA_OK)
        dea_columns_clear(columns);
    return status;
}

void dea_columns_clear(struct dea_columns *columns) {
    for (int k = 0; k < 2; k++)
        free(columns->values[k]);
    *columns = (struct dea_columns){0};
}
