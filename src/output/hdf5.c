/* result.h5: one chunked, extendible data set per signal plus "time", each with its unit as an attribute.
 *
 * Rows wait in memory and go to the file in batches, each followed by a flush, so the file is readable between batches
 * whatever happens to the program. The HDF5 library cannot recover from a full disk (the file stays damaged and open);
 * so room for a batch is asked of the system first, and a batch that would not fit is not begun. */
#include "output_internal.h"

#include <errno.h>
#include <fcntl.h>
#include <hdf5.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#define CHUNK_ROWS 1024            /* rows of a chunk: 8 kB, so that a short run makes a small file */
#define BATCH_ROWS 4096            /* rows written at once, a whole number of chunks */
#define METADATA_SLACK (64 * 1024) /* bytes a batch may add besides its data: indices, headers */
#define METADATA_PER_SIGNAL 4096   /* bytes, the same for every data set */

struct hdf5_writer {
    struct dea_writer base;
    hid_t file, memory_space; /* HDF5 handles, negative when closed */
    hid_t *datasets;          /* column_count, time first; owned */
    double *batch;            /* column_count blocks of BATCH_ROWS; owned */
    size_t column_count;      /* signals and time */
    hsize_t batch_rows;       /* rows waiting */
    hsize_t file_rows;        /* rows in the file */
    int descriptor;           /* the same file, for asking room */
};

/* ---- room on the disk ---- */

/* For file systems without reservations: writes zeros behind the end and takes them back. 0, or the errno met. */
static int try_room(int descriptor, off_t end, int64_t bytes) {
    static const char zeros[65536];
    int trouble = 0;
    for (int64_t done = 0; done < bytes && trouble == 0;) {
        int64_t left = bytes - done;
        size_t part = left < (int64_t)sizeof zeros ? (size_t)left : sizeof zeros;
        ssize_t count = pwrite(descriptor, zeros, part, end + (off_t)done);
        if (count > 0)
            done += count;
        else if (count == 0 || errno != EINTR)
            trouble = count == 0 ? ENOSPC : errno;
    }
    if (ftruncate(descriptor, end) != 0 && trouble == 0)
        trouble = errno;
    return trouble;
}

/* Makes sure `bytes` more fit behind the end of the file. 0, or the errno a write would meet. */
static int ask_room(int descriptor, int64_t bytes) {
    struct stat status;
    if (fstat(descriptor, &status) != 0)
        return errno;
    struct rlimit limit;
    if (getrlimit(RLIMIT_FSIZE, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY &&
        (uint64_t)status.st_size + (uint64_t)bytes > (uint64_t)limit.rlim_cur)
        return EFBIG;
    if (fallocate(descriptor, FALLOC_FL_KEEP_SIZE, status.st_size, (off_t)bytes) == 0)
        return 0;
    if (errno != EOPNOTSUPP && errno != ENOSYS)
        return errno;
    return try_room(descriptor, status.st_size, bytes);
}

/* Gives back what was reserved beyond the end. A failure costs disk blocks until the file is next written, no data. */
static void release_room(int descriptor) {
    struct stat status;
    if (fstat(descriptor, &status) == 0 && ftruncate(descriptor, status.st_size) != 0)
        errno = 0;
}

static int64_t room_of_rows(const struct hdf5_writer *writer, size_t rows) {
    return METADATA_SLACK + (int64_t)writer->column_count * (METADATA_PER_SIGNAL + (int64_t)(rows * sizeof(double)));
}

/* ---- creating ---- */

static bool write_text_attribute(hid_t object, const char *name, const char *text) {
    hid_t type = H5Tcopy(H5T_C_S1), space = H5Screate(H5S_SCALAR), attribute = H5I_INVALID_HID;
    bool good = H5Tset_size(type, strlen(text) + 1) >= 0 && H5Tset_cset(type, H5T_CSET_UTF8) >= 0;
    if (good)
        attribute = H5Acreate2(object, name, type, space, H5P_DEFAULT, H5P_DEFAULT);
    good = attribute >= 0 && H5Awrite(attribute, type, text) >= 0;
    if (attribute >= 0)
        H5Aclose(attribute);
    H5Sclose(space);
    H5Tclose(type);
    return good;
}

/* An empty, extendible column. Names keep their dots; a slash would open a group, so it becomes '_'. */
static hid_t create_dataset(hid_t file, const char *name, const char *unit) {
    char clean[sizeof((struct dea_signal *)NULL)->name];
    dea_header_text(name, clean, sizeof clean);
    for (char *c = clean; (c = strchr(c, '/')) != NULL;)
        *c = '_';
    hsize_t size = 0, limit = H5S_UNLIMITED, chunk = CHUNK_ROWS;
    hid_t space = H5Screate_simple(1, &size, &limit);
    hid_t properties = H5Pcreate(H5P_DATASET_CREATE);
    hid_t dataset = H5I_INVALID_HID;
    if (space >= 0 && H5Pset_chunk(properties, 1, &chunk) >= 0)
        dataset = H5Dcreate2(file, clean, H5T_IEEE_F64LE, space, H5P_DEFAULT, properties, H5P_DEFAULT);
    if (dataset >= 0 && !write_text_attribute(dataset, "unit", unit)) {
        H5Dclose(dataset);
        dataset = H5I_INVALID_HID;
    }
    H5Pclose(properties);
    H5Sclose(space);
    return dataset;
}

static void close_handles(struct hdf5_writer *writer) {
    for (size_t i = 0; i < writer->column_count; i++)
        if (writer->datasets[i] >= 0)
            H5Dclose(writer->datasets[i]);
    if (writer->memory_space >= 0)
        H5Sclose(writer->memory_space);
    if (writer->file >= 0 && H5Fclose(writer->file) < 0 && writer->base.trouble == 0)
        writer->base.trouble = EIO;
    writer->file = writer->memory_space = H5I_INVALID_HID;
    if (writer->descriptor >= 0) {
        release_room(writer->descriptor);
        if (close(writer->descriptor) != 0 && writer->base.trouble == 0)
            writer->base.trouble = errno;
    }
    writer->descriptor = -1;
    free(writer->datasets);
    free(writer->batch);
    writer->datasets = NULL;
    writer->batch = NULL;
    writer->column_count = 0;
}

/* Locks are left out, so a result can be looked at while the run goes on. */
static bool create_file(struct hdf5_writer *writer, const char *path, const char *title,
                        const struct dea_signal *signals) {
    hid_t access = H5Pcreate(H5P_FILE_ACCESS);
    if (H5Pset_file_locking(access, false, true) >= 0)
        writer->file = H5Fcreate(path, H5F_ACC_TRUNC, H5P_DEFAULT, access);
    H5Pclose(access);
    hsize_t batch = BATCH_ROWS;
    writer->memory_space = H5Screate_simple(1, &batch, NULL);
    if (writer->file < 0 || writer->memory_space < 0 || !write_text_attribute(writer->file, "title", title))
        return false;
    for (size_t i = 0; i < writer->column_count; i++) {
        const char *name = i == 0 ? "time" : signals[i - 1].name, *unit = i == 0 ? "s" : signals[i - 1].unit;
        writer->datasets[i] = create_dataset(writer->file, name, unit);
        if (writer->datasets[i] < 0)
            return false;
    }
    return H5Fflush(writer->file, H5F_SCOPE_LOCAL) >= 0;
}

static struct dea_writer *hdf5_open(const char *path, const char *title, const struct dea_signal *signals, size_t count,
                                    struct dea_error *error) {
    struct hdf5_writer *writer = calloc(1, sizeof *writer);
    hid_t *datasets = calloc(count + 1, sizeof *datasets);
    double *batch = calloc(count + 1, BATCH_ROWS * sizeof *batch);
    if (writer == NULL || datasets == NULL || batch == NULL) {
        free(writer);
        free(datasets);
        free(batch);
        dea_fail(error, DEA_ERR_MEMORY, "out of memory for %s", path);
        return NULL;
    }
    *writer = (struct hdf5_writer){.file = H5I_INVALID_HID,
                                   .memory_space = H5I_INVALID_HID,
                                   .datasets = datasets,
                                   .batch = batch,
                                   .column_count = count + 1};
    for (size_t i = 0; i < count + 1; i++)
        datasets[i] = H5I_INVALID_HID;

    writer->descriptor = open(path, O_RDWR | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
    int trouble = writer->descriptor < 0 ? errno : ask_room(writer->descriptor, room_of_rows(writer, 0));
    bool good = trouble == 0;
    if (good) {
        H5E_BEGIN_TRY {
            good = create_file(writer, path, title, signals);
        }
        H5E_END_TRY
    }
    if (good)
        return &writer->base;
    dea_fail(error, writer->descriptor < 0 ? DEA_ERR_INPUT : DEA_ERR_OUTPUT, "%s: cannot be written: %s", path,
             trouble != 0 ? strerror(trouble) : "refused by the HDF5 library (two signals of one name?)");
    H5E_BEGIN_TRY {
        close_handles(writer);
    }
    H5E_END_TRY
    free(writer);
    return NULL;
}

/* ---- writing ---- */

static bool write_column(struct hdf5_writer *writer, size_t column, hsize_t rows) {
    hid_t dataset = writer->datasets[column];
    hsize_t size = writer->file_rows + rows, zero = 0;
    if (H5Dset_extent(dataset, &size) < 0)
        return false;
    hid_t space = H5Dget_space(dataset);
    bool good = H5Sselect_hyperslab(space, H5S_SELECT_SET, &writer->file_rows, NULL, &rows, NULL) >= 0 &&
                H5Sselect_hyperslab(writer->memory_space, H5S_SELECT_SET, &zero, NULL, &rows, NULL) >= 0 &&
                H5Dwrite(dataset, H5T_NATIVE_DOUBLE, writer->memory_space, space, H5P_DEFAULT,
                         writer->batch + column * BATCH_ROWS) >= 0;
    H5Sclose(space);
    return good;
}

static bool write_batch(struct hdf5_writer *writer) {
    bool good = true;
    for (size_t i = 0; i < writer->column_count && good; i++)
        good = write_column(writer, i, writer->batch_rows);
    return good && H5Fflush(writer->file, H5F_SCOPE_LOCAL) >= 0;
}

static bool hdf5_flush(struct dea_writer *base) {
    struct hdf5_writer *writer = (struct hdf5_writer *)base;
    if (base->trouble != 0)
        return false;
    if (writer->batch_rows == 0)
        return true;
    base->trouble = ask_room(writer->descriptor, room_of_rows(writer, BATCH_ROWS));
    if (base->trouble != 0)
        return false;
    bool good;
    H5E_BEGIN_TRY {
        good = write_batch(writer);
    }
    H5E_END_TRY
    if (!good) {
        base->trouble = EIO;
        return false;
    }
    writer->file_rows += writer->batch_rows;
    writer->batch_rows = 0;
    base->safe_rows = writer->file_rows;
    return true;
}

static bool hdf5_append(struct dea_writer *base, double time, const double *values) {
    struct hdf5_writer *writer = (struct hdf5_writer *)base;
    if (base->trouble != 0)
        return false;
    double *place = writer->batch + writer->batch_rows;
    place[0] = time;
    for (size_t i = 1; i < writer->column_count; i++)
        place[i * BATCH_ROWS] = values[i - 1];
    /* Batches end where chunks end, so that no chunk is written twice. */
    writer->batch_rows++;
    if ((writer->file_rows + writer->batch_rows) % BATCH_ROWS == 0)
        return hdf5_flush(base);
    return true;
}

static bool hdf5_close(struct dea_writer *base) {
    struct hdf5_writer *writer = (struct hdf5_writer *)base;
    hdf5_flush(base);
    H5E_BEGIN_TRY {
        close_handles(writer);
    }
    H5E_END_TRY
    return base->trouble == 0;
}

const struct dea_writer_class dea_hdf5_writer = {DEA_FORMAT_HDF5, "result.h5", hdf5_open,
                                                 hdf5_append,     hdf5_flush,  hdf5_close};
