/* Streams rows to the result files of a run and answers for what is in them. */
#include "deasim/new_file.h"
#include "output_internal.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#define FLUSH_INTERVAL 1 /* s between flushes: what an interrupted run may lose */

static const struct dea_writer_class *const writer_classes[] = {&dea_csv_writer, &dea_raw_writer, &dea_hdf5_writer};
enum { WRITER_CLASSES = sizeof writer_classes / sizeof writer_classes[0] };

/* All a folder may hold of an earlier run; its log belongs to the caller. */
static const char *const stale_files[] = {"result.csv", "result.raw", "result.h5", "result.png", "summary.json"};

struct dea_recorder {
    struct dea_writer *writers[WRITER_CLASSES]; /* owned; writer_count of them */
    size_t writer_count;
    time_t flushed; /* s, coarse monotonic clock */
    bool failed;    /* a write has failed: nothing more is written */
};

void dea_header_text(const char *text, char *copy, size_t limit) {
    size_t length = 0;
    for (; text[length] != '\0' && length + 1 < limit; length++)
        copy[length] = (unsigned char)text[length] < 0x20 || text[length] == 0x7f ? ' ' : text[length];
    copy[length] = '\0';
}

enum dea_status dea_directory_make(const char *directory, struct dea_error *error) {
    if (directory[0] == '\0')
        return dea_fail(error, DEA_ERR_INPUT, "a result folder needs a name; . is this one");
    char *path = strdup(directory);
    if (path == NULL)
        return dea_fail(error, DEA_ERR_MEMORY, "out of memory for the path %s", directory);
    /* Every prefix that ends before a slash, then the whole. What exists already is judged at the end. */
    int trouble = 0;
    for (char *slash = path + 1; trouble == 0 && *slash != '\0'; slash++) {
        if (*slash != '/')
            continue;
        *slash = '\0';
        if (mkdir(path, 0777) != 0 && errno != EEXIST)
            trouble = errno;
        *slash = '/';
    }
    struct stat status;
    if (trouble == 0 && mkdir(path, 0777) != 0 && errno != EEXIST)
        trouble = errno;
    if (trouble == 0 && stat(path, &status) != 0)
        trouble = errno;
    if (trouble == 0 && !S_ISDIR(status.st_mode))
        trouble = ENOTDIR;
    free(path);
    if (trouble != 0)
        return dea_fail(error, DEA_ERR_INPUT, "%s: the result folder cannot be made: %s", directory, strerror(trouble));
    return DEA_OK;
}

static enum dea_status join_path(const char *directory, const char *name, char **path, struct dea_error *error) {
    if (asprintf(path, "%s/%s", directory, name) >= 0)
        return DEA_OK;
    *path = NULL;
    return dea_fail(error, DEA_ERR_MEMORY, "out of memory for the path %s/%s", directory, name);
}

/* Files of an earlier run would pass for this one's. */
static enum dea_status remove_stale(const char *directory, struct dea_error *error) {
    for (size_t i = 0; i < sizeof stale_files / sizeof stale_files[0]; i++) {
        char *path;
        DEA_TRY(join_path(directory, stale_files[i], &path, error));
        enum dea_status status = dea_new_file_check(path, error);
        if (status == DEA_OK && unlink(path) != 0 && errno != ENOENT)
            status = dea_fail(error, DEA_ERR_INPUT, "%s: the file of an earlier run cannot be replaced: %s", path,
                              strerror(errno));
        free(path);
        DEA_TRY(status);
    }
    return DEA_OK;
}

static enum dea_status open_writer(struct dea_recorder *recorder, const struct dea_writer_class *class,
                                   const char *directory, const char *title, const struct dea_signal *signals,
                                   size_t signal_count, struct dea_error *error) {
    char *path;
    DEA_TRY(join_path(directory, class->file_name, &path, error));
    struct dea_error why = {0};
    struct dea_writer *writer = class->open(path, title, signals, signal_count, &why);
    if (writer == NULL) {
        free(path);
        return dea_fail(error, why.status, "%s", why.text);
    }
    writer->class = class;
    writer->path = path;
    recorder->writers[recorder->writer_count++] = writer;
    return DEA_OK;
}

static time_t coarse_clock(void) {
    struct timespec now;
    return clock_gettime(CLOCK_MONOTONIC_COARSE, &now) == 0 ? now.tv_sec : 0;
}

enum dea_status dea_recorder_open(const char *directory, unsigned formats, const char *title,
                                  const struct dea_signal *signals, size_t signal_count, struct dea_recorder **recorder,
                                  struct dea_error *error) {
    *recorder = NULL;
    DEA_TRY(dea_directory_make(directory, error));
    DEA_TRY(remove_stale(directory, error));
    struct dea_recorder *opened = calloc(1, sizeof *opened);
    if (opened == NULL)
        return dea_fail(error, DEA_ERR_MEMORY, "out of memory for the results of %s", directory);
    opened->flushed = coarse_clock();
    for (size_t i = 0; i < WRITER_CLASSES; i++) {
        if ((formats & writer_classes[i]->format) == 0)
            continue;
        enum dea_status status =
            open_writer(opened, writer_classes[i], directory, title != NULL ? title : "", signals, signal_count, error);
        if (status != DEA_OK) {
            dea_recorder_close(opened, NULL);
            return status;
        }
    }
    *recorder = opened;
    return DEA_OK;
}

/* Names every incomplete file and the rows that can be trusted. */
static enum dea_status report_trouble(const struct dea_recorder *recorder, struct dea_error *error) {
    char text[1800] = "";
    size_t length = 0;
    for (size_t i = 0; i < recorder->writer_count; i++) {
        const struct dea_writer *writer = recorder->writers[i];
        if (writer->trouble == 0)
            continue;
        int added = snprintf(text + length, sizeof text - length,
                             "%s%s is incomplete: %s; its first %llu rows are good", length > 0 ? "; " : "",
                             writer->path, strerror(writer->trouble), (unsigned long long)writer->safe_rows);
        length += added > 0 && (size_t)added < sizeof text - length ? (size_t)added : 0;
    }
    return dea_fail(error, DEA_ERR_OUTPUT, "%s", text);
}

enum dea_status dea_recorder_flush(struct dea_recorder *recorder, struct dea_error *error) {
    bool good = !recorder->failed;
    for (size_t i = 0; i < recorder->writer_count; i++)
        good = recorder->writers[i]->class->flush(recorder->writers[i]) && good;
    recorder->flushed = coarse_clock();
    recorder->failed = !good;
    return good ? DEA_OK : report_trouble(recorder, error);
}

enum dea_status dea_recorder_append(struct dea_recorder *recorder, double time, const double *values,
                                    struct dea_error *error) {
    if (recorder->failed)
        return report_trouble(recorder, error);
    for (size_t i = 0; i < recorder->writer_count; i++)
        if (!recorder->writers[i]->class->append(recorder->writers[i], time, values))
            recorder->failed = true;
    /* After a failure the other files are flushed too, so that the message tells of all of them. */
    if (recorder->failed || coarse_clock() - recorder->flushed >= FLUSH_INTERVAL)
        return dea_recorder_flush(recorder, error);
    return DEA_OK;
}

enum dea_status dea_recorder_close(struct dea_recorder *recorder, struct dea_error *error) {
    if (recorder == NULL)
        return DEA_OK;
    bool good = !recorder->failed;
    for (size_t i = 0; i < recorder->writer_count; i++)
        good = recorder->writers[i]->class->close(recorder->writers[i]) && good;
    enum dea_status status = good ? DEA_OK : report_trouble(recorder, error);
    for (size_t i = 0; i < recorder->writer_count; i++) {
        free(recorder->writers[i]->path);
        free(recorder->writers[i]);
    }
    free(recorder);
    return status;
}
