/* Results read back, and how far they are from a reference. */
#include "work_precision.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

void trace_clear(struct trace *trace) {
    free(trace->time);
    for (int i = 0; i < MAX_SIGNALS; i++)
        free(trace->signals[i]);
    memset(trace, 0, sizeof *trace);
}

static bool trace_allocate(struct trace *trace, size_t count, int signal_count) {
    *trace = (struct trace){.count = count, .signal_count = signal_count};
    trace->time = calloc(count + 1, sizeof *trace->time);
    bool good = trace->time != NULL;
    for (int i = 0; i < signal_count; i++) {
        trace->signals[i] = calloc(count + 1, sizeof *trace->signals[i]);
        good = good && trace->signals[i] != NULL;
    }
    if (!good)
        trace_clear(trace);
    return good;
}

/* ---- raw files ---- */

/* Reads the header up to "Binary:"; columns[i] is where name i is found. */
static bool read_header(FILE *file, const char *const *names, int count, int *variables, size_t *points, int *columns) {
    char line[512], name[256];
    *variables = 0;
    *points = 0;
    for (int i = 0; i < count; i++)
        columns[i] = -1;
    while (fgets(line, sizeof line, file) != NULL) {
        int index;
        if (strncmp(line, "Binary:", 7) == 0) {
            for (int i = 0; i < count; i++)
                if (columns[i] < 1 || columns[i] >= *variables)
                    return false;
            return *variables > 0 && *points > 1;
        }
        if (sscanf(line, "No. Variables: %d", variables) == 1 || sscanf(line, "No. Points: %zu", points) == 1)
            continue;
        if (sscanf(line, " %d %255s", &index, name) == 2)
            for (int i = 0; i < count; i++)
                if (strcasecmp(name, names[i]) == 0)
                    columns[i] = index;
    }
    return false;
}

bool trace_read_raw(const char *path, const char *const *names, int count, double scale, struct trace *trace) {
    memset(trace, 0, sizeof *trace);
    FILE *file = fopen(path, "rb");
    if (file == NULL)
        return false;
    int variables, columns[MAX_SIGNALS];
    size_t points, filled = 0;
    double *row = NULL;
    if (read_header(file, names, count, &variables, &points, columns) && trace_allocate(trace, points, count))
        row = malloc((size_t)variables * sizeof *row);
    while (row != NULL && filled < points && fread(row, sizeof *row, (size_t)variables, file) == (size_t)variables) {
        trace->time[filled] = row[0];
        for (int i = 0; i < count; i++)
            trace->signals[i][filled] = row[columns[i]] * (i == 0 ? scale : 1.0);
        filled++;
    }
    free(row);
    fclose(file);
    trace->count = filled;
    if (filled < 2)
        trace_clear(trace);
    return filled >= 2;
}

/* ---- tables ---- */

bool trace_read_table(const char *path, int count, struct trace *trace) {
    memset(trace, 0, sizeof *trace);
    FILE *file = fopen(path, "r");
    if (file == NULL)
        return false;
    size_t lines = 0;
    for (int c; (c = fgetc(file)) != EOF;)
        lines += c == '\n';
    rewind(file);
    if (!trace_allocate(trace, lines, count)) {
        fclose(file);
        return false;
    }
    size_t filled = 0;
    while (filled < lines && fscanf(file, "%lf", &trace->time[filled]) == 1) {
        bool whole = true;
        for (int i = 0; i < count; i++)
            whole = fscanf(file, "%lf", &trace->signals[i][filled]) == 1 && whole;
        if (!whole)
            break;
        filled++;
    }
    fclose(file);
    trace->count = filled;
    if (filled < 2)
        trace_clear(trace);
    return filled >= 2;
}

/* ---- errors ---- */

/* Value at t by the cubic through four neighbours; `at` remembers the place. At a sample, that sample. */
static double interpolate(const struct trace *trace, const double *values, double t, size_t *at) {
    const double *time = trace->time;
    size_t last = trace->count - 1, i = *at;
    while (i + 1 < last && time[i + 1] <= t)
        i++;
    *at = i;
    double h = time[i + 1] - time[i], near = 1e-7 * h;
    if (fabs(t - time[i]) <= near)
        return values[i];
    if (fabs(t - time[i + 1]) <= near)
        return values[i + 1];
    if (i == 0 || i + 2 > last)
        return values[i] + (t - time[i]) / h * (values[i + 1] - values[i]);
    double sum = 0.0;
    for (size_t a = i - 1; a <= i + 2; a++) {
        double weight = 1.0;
        for (size_t b = i - 1; b <= i + 2; b++)
            if (b != a)
                weight *= (t - time[b]) / (time[a] - time[b]);
        sum += weight * values[a];
    }
    return sum;
}

/* Integrals over time of (signal - reference)^2 and reference^2 by trapezoids over the trace's own points. */
static void integrate_squares(const struct trace *trace, const struct trace *reference, int signal, double *difference,
                              double *size) {
    double d0 = 0.0, r0 = 0.0;
    size_t at = 0;
    *difference = *size = 0.0;
    for (size_t n = 0; n < trace->count; n++) {
        double r = interpolate(reference, reference->signals[signal], trace->time[n], &at);
        double d = trace->signals[signal][n] - r;
        if (n > 0) {
            double h = trace->time[n] - trace->time[n - 1];
            *difference += 0.5 * h * (d * d + d0 * d0);
            *size += 0.5 * h * (r * r + r0 * r0);
        }
        d0 = d;
        r0 = r;
    }
}

struct trace_error trace_compare(const struct trace *trace, const struct trace *reference) {
    struct trace_error error = {NAN, NAN};
    if (trace->count < 2 || trace->time[trace->count - 1] < 0.999 * reference->time[reference->count - 1])
        return error; /* it did not reach the end */
    double difference, size, largest = 0.0, worst = 0.0;
    integrate_squares(trace, reference, 0, &difference, &size);
    error.x = sqrt(difference / size);
    for (int i = 1; i < trace->signal_count; i++) {
        integrate_squares(trace, reference, i, &difference, &size);
        largest = fmax(largest, size);
        worst = fmax(worst, difference);
    }
    error.ports = sqrt(worst / largest);
    return error;
}
