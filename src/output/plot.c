/* The picture of a run: reads the result and its summary, has gnuplot draw, keeps the PNG. */
#include "plot_internal.h"

#include "deasim/gnuplot.h"

#include <cJSON.h>
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#define LARGEST_SUMMARY ((size_t)1 << 26) /* bytes */

/* ---- what the summary says ---- */

static cJSON *read_summary(const char *directory) {
    char *path;
    if (asprintf(&path, "%s/summary.json", directory) < 0)
        return NULL;
    FILE *file = fopen(path, "re");
    free(path);
    if (file == NULL)
        return NULL;
    struct stat status;
    cJSON *summary = NULL;
    if (fstat(fileno(file), &status) == 0 && S_ISREG(status.st_mode) && (size_t)status.st_size < LARGEST_SUMMARY) {
        char *text = malloc((size_t)status.st_size + 1);
        if (text != NULL) {
            size_t length = fread(text, 1, (size_t)status.st_size, file);
            summary = cJSON_ParseWithLength(text, length);
        }
        free(text);
    }
    fclose(file);
    return summary;
}

static const char *text_of(const cJSON *object, const char *key) {
    const char *text = cJSON_GetStringValue(cJSON_GetObjectItemCaseSensitive(object, key));
    return text != NULL ? text : "";
}

static void read_limits(const cJSON *summary, struct dea_caption *caption) {
    const cJSON *limit;
    cJSON_ArrayForEach(limit, cJSON_GetObjectItemCaseSensitive(summary, "limits")) {
        if (caption->limit_count == DEA_PANEL_CURVES || limit->string == NULL || !cJSON_IsNumber(limit) ||
            !isfinite(limit->valuedouble))
            continue;
        int k = caption->limit_count++;
        dea_header_text(limit->string, caption->limits[k].signal, sizeof caption->limits[k].signal);
        caption->limits[k].value = limit->valuedouble;
    }
}

/* The first few; what came back from a limit is not marked. */
static void read_events(const cJSON *summary, struct dea_caption *caption) {
    const cJSON *event;
    cJSON_ArrayForEach(event, cJSON_GetObjectItemCaseSensitive(summary, "events")) {
        const cJSON *time = cJSON_GetObjectItemCaseSensitive(event, "t");
        if (caption->event_count == DEA_PANEL_CURVES || !cJSON_IsNumber(time) || !isfinite(time->valuedouble) ||
            cJSON_IsTrue(cJSON_GetObjectItemCaseSensitive(event, "cleared")))
            continue;
        int k = caption->event_count++;
        caption->events[k].time = time->valuedouble;
        snprintf(caption->events[k].text, sizeof caption->events[k].text, "%.32s %.24s", text_of(event, "zone"),
                 text_of(event, "type"));
    }
}

/* Title and outcome; the folder's name where there is no summary, as after an interrupted run. */
static void read_caption(const char *directory, struct dea_caption *caption) {
    *caption = (struct dea_caption){.title = ""};
    cJSON *summary = read_summary(directory);
    const char *title = text_of(summary, "title");
    if (title[0] == '\0')
        title = text_of(summary, "scene");
    dea_header_text(title[0] != '\0' ? title : directory, caption->title, sizeof caption->title);
    const char *status = text_of(summary, "status"), *reason = text_of(summary, "reason");
    if (summary == NULL)
        snprintf(caption->outcome, sizeof caption->outcome, "no summary: the run may have been interrupted");
    else if (strcmp(status, "done") != 0 && status[0] != '\0')
        snprintf(caption->outcome, sizeof caption->outcome, "%.20s%s%.120s", status, reason[0] != '\0' ? ": " : "",
                 reason);
    read_limits(summary, caption);
    read_events(summary, caption);
    cJSON_Delete(summary);
}

/* ---- the run ---- */

static int compare_columns(const void *left, const void *right) {
    size_t a = *(const size_t *)left, b = *(const size_t *)right;
    return (a > b) - (a < b);
}

static enum dea_status read_panels(struct dea_table *table, struct dea_panel *panels, int *count,
                                   struct dea_error *error) {
    *count = dea_panels_choose(table, panels);
    if (*count == 0)
        return dea_fail(error, DEA_ERR_INPUT, "%s: there is no signal to draw, only time", table->path);
    size_t columns[DEA_PANELS * DEA_PANEL_CURVES] = {0}, used = 0;
    for (int i = 0; i < *count; i++)
        for (int k = 0; k < panels[i].curve_count; k++)
            columns[used++] = panels[i].curves[k].column;
    qsort(columns, used, sizeof columns[0], compare_columns);
    return dea_table_read(table, columns, used, error);
}

static enum dea_status draw_table(const struct dea_table *table, const struct dea_panel *panels, int count,
                                  const char *directory, const char *path, struct dea_error *error) {
    struct dea_caption caption;
    read_caption(directory, &caption);
    FILE *script = tmpfile();
    if (script == NULL)
        return dea_fail(error, DEA_ERR_OUTPUT, "no temporary file for gnuplot: %s", strerror(errno));
    dea_plot_script(table, panels, count, &caption, script);
    enum dea_status status;
    if (fflush(script) != 0 || fseek(script, 0, SEEK_SET) != 0)
        status = dea_fail(error, DEA_ERR_OUTPUT, "no room for gnuplot's script: %s", strerror(errno));
    else
        status = dea_gnuplot_draw(script, path, error);
    fclose(script);
    return status;
}

enum dea_status dea_plot_run(const char *directory, char **png_path, struct dea_error *error) {
    struct dea_table table;
    struct dea_panel panels[DEA_PANELS];
    int count;
    *png_path = NULL;
    if (directory[0] == '\0')
        return dea_fail(error, DEA_ERR_INPUT, "a result folder needs a name; . is this one");
    char *path;
    if (asprintf(&path, "%s/result.png", directory) < 0)
        return dea_fail(error, DEA_ERR_MEMORY, "out of memory for the path %s/result.png", directory);
    enum dea_status status = dea_table_open(directory, &table, error);
    if (status == DEA_OK)
        status = read_panels(&table, panels, &count, error);
    if (status == DEA_OK)
        status = draw_table(&table, panels, count, directory, path, error);
    dea_table_clear(&table);
    if (status == DEA_OK)
        *png_path = path;
    else
        free(path);
    return status;
}
