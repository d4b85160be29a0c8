/* Waveforms from CSV files: time and value with their units in the header. */
#include "deasim/columns.h"
#include "drive/drive_internal.h"

/* The rows so far as a waveform; the check of a point looks at the one before it too. */
static enum dea_status check_row(void *context, const struct dea_columns *columns, size_t i, struct dea_error *error) {
    struct dea_waveform *waveform = context;
    waveform->times = columns->values[0];
    waveform->values = columns->values[1];
    waveform->point_count = columns->count;
    return dea_waveform_check_point(waveform, i, error);
}

enum dea_status dea_waveform_read_csv(const char *path, const char *value_unit, struct dea_waveform *waveform,
                                      struct dea_error *error) {
    const struct dea_column_wish wishes[2] = {{"time", true, {"s", NULL}}, {"value", false, {value_unit, NULL}}};
    struct dea_waveform read = {.kind = DEA_WAVE_PWL};
    struct dea_columns columns;
    *waveform = (struct dea_waveform){.kind = DEA_WAVE_PWL};
    DEA_TRY(dea_columns_read(path, wishes, check_row, &read, &columns, error));
    if (columns.count < 2) {
        dea_fail(error, DEA_ERR_INPUT, "%s: %zu row%s; at least two are needed", path, columns.count,
                 columns.count == 1 ? "" : "s");
        dea_columns_clear(&columns);
        return DEA_ERR_INPUT;
    }
    *waveform = read; /* which now owns the columns */
    return DEA_OK;
}
