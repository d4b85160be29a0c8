/* Files written beside their place and moved into it. */
#include "deasim/new_file.h"

#include <errno.h>
#include <fcntl.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* `shown` is what the user calls the path. */
static enum dea_status check_kind(const char *path, const char *shown, struct dea_error *error) {
    struct stat found;
    if (lstat(path, &found) != 0 || S_ISREG(found.st_mode) || S_ISLNK(found.st_mode))
        return DEA_OK;
    const char *kind = S_ISDIR(found.st_mode)    ? "directory"
                       : S_ISFIFO(found.st_mode) ? "pipe"
                       : S_ISSOCK(found.st_mode) ? "socket"
                                                 : "device";
    return dea_fail(error, DEA_ERR_INPUT, "%s: there is a %s, which is not replaced by a file", shown, kind);
}

enum dea_status dea_new_file_check(const char *path, struct dea_error *error) {
    return check_kind(path, path, error);
}

/* Where the file belongs: at the end of its links, if there is something. */
static enum dea_status find_place(const char *path, struct dea_new_file *made, struct dea_error *error) {
    if (path[0] == '\0')
        return dea_fail(error, DEA_ERR_INPUT, "a file without a name cannot be written");
    made->path = realpath(path, NULL);
    bool there = made->path != NULL;
    if (!there)
        made->path = strdup(path);
    made->name = strdup(path);
    char *part = NULL;
    if (made->path == NULL || made->name == NULL || asprintf(&part, "%s.part", made->path) < 0)
        return dea_fail(error, DEA_ERR_MEMORY, "out of memory for the path %s", path);
    made->part = part;
    DEA_TRY(check_kind(made->path, path, error));
    if (there && access(made->path, W_OK) != 0) /* moving another file there would not ask for it */
        return dea_fail(error, DEA_ERR_INPUT, "%s: cannot be written: %s", path, strerror(errno));
    return DEA_OK;
}

static void forget(struct dea_new_file *made) {
    free(made->name);
    free(made->path);
    free(made->part);
    *made = (struct dea_new_file){0};
}

enum dea_status dea_new_file_open(const char *path, struct dea_new_file *made, struct dea_error *error) {
    *made = (struct dea_new_file){0};
    enum dea_status status = find_place(path, made, error);
    if (status == DEA_OK)
        status = dea_new_file_check(made->part, error);
    if (status == DEA_OK) {
        (void)unlink(made->part); /* of a program that was killed */
        int descriptor = open(made->part, O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
        made->file = descriptor >= 0 ? fdopen(descriptor, "w+") : NULL;
        if (made->file == NULL) {
            status = dea_fail(error, DEA_ERR_INPUT, "%s: cannot be written: %s", path, strerror(errno));
            if (descriptor >= 0) {
                close(descriptor);
                unlink(made->part);
            }
        }
    }
    if (status != DEA_OK)
        forget(made);
    return status;
}

enum dea_status dea_new_file_finish(struct dea_new_file *made, enum dea_status written, struct dea_error *error) {
    enum dea_status status = written;
    errno = 0;
    bool bad = fflush(made->file) != 0 || ferror(made->file);
    int trouble = bad ? (errno != 0 ? errno : EIO) : 0;
    if (fclose(made->file) != 0 && !bad) /* some file systems report a full disk only here */
        trouble = errno;
    if (status == DEA_OK && trouble == 0 && rename(made->part, made->path) != 0)
        trouble = errno;
    if (status == DEA_OK && trouble != 0)
        status = dea_fail(error, DEA_ERR_OUTPUT, "%s: cannot be written: %s", made->name, strerror(trouble));
    if (status != DEA_OK)
        unlink(made->part);
    forget(made);
    return status;
}

enum dea_status dea_new_file_try(const char *path, struct dea_error *error) {
    struct dea_new_file made;
    DEA_TRY(dea_new_file_open(path, &made, error));
    (void)dea_new_file_finish(&made, DEA_STOPPED, error);
    return DEA_OK;
}
