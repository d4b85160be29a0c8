/* Results read back from raw files, and how far two runs are apart. */
#include "accuracy.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

void rows_clear(struct rows *rows) {
    free(rows->time);
    for (int i = 0; i < MAX_COLUMNS; i++)
        free(rows->signals[i]);
    memset(rows, 0, sizeof *rows);
}

static bool ends_with(const char *text, const char *end) {
    size_t length = strlen(text), tail = strlen(end);
    return length >= tail && strcasecmp(text + length - tail, end) == 0;
}

/* Takes the columns wanted; a device's displacement comes before its ports. */
static bool read_header(FILE *file, struct rows *rows, int *places, int *variables, size_t *points) {
    char line[512], name[256];
    int index, device = -1;
    *variables = 0;
    *points = 0;
    while (fgets(line, sizeof line, file) != NULL) {
        if (strncmp(line, "Binary:", 7) == 0)
            return *variables > 0 && *points > 1 && rows->columns > 0;
        if (sscanf(line, "No. Variables: %d", variables) == 1 || sscanf(line, "No. Points: %zu", points) == 1)
            continue;
        if (sscanf(line, " %d %255s", &index, name) != 2 || rows->columns == MAX_COLUMNS)
            continue;
        bool x = strcasecmp(name, "x") == 0 || ends_with(name, ".x"), port = ends_with(name, "port_voltage");
        if (!x && !port)
            continue;
        device += x;
        rows->is_port[rows->columns] = port;
        rows->device[rows->columns] = device;
        rows->zone[rows->columns] = ends_with(name, "right.port_voltage");
        places[rows->columns++] = index;
    }
    return false;
}

bool rows_read(const char *folder, struct rows *rows) {
    char path[PATH_ROOM + 16];
    memset(rows, 0, sizeof *rows);
    snprintf(path, sizeof path, "%s/result.raw", folder);
    FILE *file = fopen(path, "rb");
    if (file == NULL)
        return false;
    int places[MAX_COLUMNS], variables;
    size_t points;
    double *row = NULL;
    bool good = read_header(file, rows, places, &variables, &points);
    if (good) {
        row = malloc((size_t)variables * sizeof *row);
        rows->time = malloc(points * sizeof *rows->time);
        good = row != NULL && rows->time != NULL;
    }
    for (int i = 0; good && i < rows->columns; i++) {
        rows->signals[i] = malloc(points * sizeof **rows->signals);
        good = rows->signals[i] != NULL && places[i] < variables;
    }
    while (good && rows->count < points && fread(row, sizeof *row, (size_t)variables, file) == (size_t)variables) {
        rows->time[rows->count] = row[0];
        for (int i = 0; i < rows->columns; i++)
            rows->signals[i][rows->count] = row[places[i]];
        rows->count++;
    }
    free(row);
    fclose(file);
    if (!good || rows->count < 2)
        rows_clear(rows);
    return rows->count >= 2;
}

/* Sums of squares of a column over common times. */
static size_t add_squares(const struct rows *rows, const struct rows *reference, int column, double *difference,
                          double *size) {
    size_t common = 0;
    *difference = *size = 0.0;
    for (size_t i = 0, j = 0; i < rows->count && j < reference->count;) {
        double gap = rows->time[i] - reference->time[j], near = 1e-9 * fabs(reference->time[j]);
        if (gap > near) {
            j++;
        } else if (gap < -near) {
            i++;
        } else {
            double r = reference->signals[column][j], d = rows->signals[column][i] - r;
            *difference += d * d;
            *size += r * r;
            common++;
            i++;
            j++;
        }
    }
    return common;
}

/* A signal of a smaller root mean square is not there: a hundredth of an atom's size, and what moves it. */
#define RESOLVED_LENGTH 1e-12 /* m */
#define RESOLVED_VOLTAGE 1e-9 /* V */

struct delivered rows_compare(const struct rows *rows, const struct rows *reference) {
    struct delivered delivered = {NAN, NAN};
    double difference[MAX_COLUMNS], size[MAX_COLUMNS], largest[MAX_COLUMNS] = {0.0};
    double samples[MAX_COLUMNS];
    if (rows->columns != reference->columns)
        return delivered;
    for (int i = 0; i < rows->columns; i++) {
        samples[i] = (double)add_squares(rows, reference, i, &difference[i], &size[i]);
        if (samples[i] < 0.9 * (double)rows->count)
            return delivered;
        if (rows->is_port[i])
            largest[rows->device[i]] = fmax(largest[rows->device[i]], size[i]);
    }
    delivered.x = delivered.ports = 0.0;
    for (int i = 0; i < rows->columns; i++) {
        double whole = rows->is_port[i] ? largest[rows->device[i]] : size[i];
        double resolved = rows->is_port[i] ? RESOLVED_VOLTAGE : RESOLVED_LENGTH;
        double error = size[i] > resolved * resolved * samples[i] ? sqrt(difference[i] / whole) : 0.0;
        double *worst = rows->is_port[i] ? &delivered.ports : &delivered.x;
        *worst = fmax(*worst, error);
    }
    return delivered;
}
