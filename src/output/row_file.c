/* A result file that only ever holds whole rows: what did not fit on the disk is cut back to the last whole one. */
#include "output_internal.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define BUFFER_BYTES ((size_t)1 << 18)

bool dea_row_file_open(struct dea_row_file *file, const char *path, size_t largest_row, size_t row_bytes) {
    *file = (struct dea_row_file){.descriptor = -1, .row_bytes = row_bytes};
    file->capacity = BUFFER_BYTES > 2 * largest_row ? BUFFER_BYTES : 2 * largest_row;
    file->buffer = malloc(file->capacity);
    if (file->buffer == NULL)
        return false;
    file->descriptor = open(path, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
    if (file->descriptor < 0) {
        free(file->buffer);
        file->buffer = NULL;
        return false;
    }
    return true;
}

char *dea_row_file_reserve(struct dea_row_file *file, size_t bytes) {
    if (file->trouble != 0)
        return NULL;
    if (file->capacity - file->used < bytes && !dea_row_file_flush(file))
        return NULL;
    return file->buffer + file->used;
}

/* Writes all it can; returns the bytes written, errno tells why they are fewer. */
static size_t write_fully(int descriptor, const char *data, size_t bytes, int64_t offset) {
    size_t done = 0;
    while (done < bytes) {
        ssize_t count = pwrite(descriptor, data + done, bytes - done, (off_t)(offset + (int64_t)done));
        if (count < 0 && errno == EINTR)
            continue;
        if (count <= 0) {
            if (count == 0)
                errno = ENOSPC;
            break;
        }
        done += (size_t)count;
    }
    return done;
}

/* Bytes and number of the whole rows at the start of `data`. */
static size_t whole_rows(const struct dea_row_file *file, const char *data, size_t bytes, uint64_t *rows) {
    if (file->row_bytes > 0) {
        *rows = bytes / file->row_bytes;
        return *rows * file->row_bytes;
    }
    size_t whole = 0;
    *rows = 0;
    for (const char *end; (end = memchr(data + whole, '\n', bytes - whole)) != NULL; ++*rows)
        whole = (size_t)(end - data) + 1;
    return whole;
}

bool dea_row_file_flush(struct dea_row_file *file) {
    if (file->trouble != 0)
        return false;
    size_t done = write_fully(file->descriptor, file->buffer, file->used, file->size);
    if (done < file->used)
        file->trouble = errno;
    uint64_t rows;
    size_t whole = whole_rows(file, file->buffer, done, &rows);
    file->rows += rows;
    file->size += (int64_t)whole;
    file->used = 0;
    if (file->trouble == 0)
        return true;
    /* A torn last row must not stay behind. If even that is refused, the first trouble is what matters. */
    if (ftruncate(file->descriptor, (off_t)file->size) != 0 && errno == EIO)
        file->trouble = EIO;
    return false;
}

bool dea_row_file_patch(struct dea_row_file *file, const void *data, size_t bytes, int64_t offset) {
    if (write_fully(file->descriptor, data, bytes, offset) == bytes)
        return true;
    if (file->trouble == 0)
        file->trouble = errno;
    return false;
}

bool dea_row_file_close(struct dea_row_file *file) {
    if (file->descriptor >= 0) {
        dea_row_file_flush(file);
        /* Some file systems report a full disk only here. */
        if (close(file->descriptor) != 0 && file->trouble == 0)
            file->trouble = errno;
        file->descriptor = -1;
    }
    free(file->buffer);
    file->buffer = NULL;
    return file->trouble == 0;
}
