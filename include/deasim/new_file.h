/* Files that appear under their name only when they are whole. */
#ifndef DEASIM_NEW_FILE_H
#define DEASIM_NEW_FILE_H

#include "deasim/status.h"

#include <stdio.h>

struct dea_new_file {
    FILE *file;               /* for reading and writing */
    char *name, *path, *part; /* owned: as the caller calls it, where it will be, where it is meanwhile */
};

/* Opens PATH.part beside PATH; behind a symbolic link, beside the file it leads to. DEA_ERR_INPUT when nothing can be
 * written there, and when something is there that is no ordinary file: a directory, a device or a pipe is not
 * replaced. */
enum dea_status dea_new_file_open(const char *path, struct dea_new_file *made, struct dea_error *error);

/* Closes it and puts it in its place. With `written` other than DEA_OK, or when what was written did not all fit
 * (DEA_ERR_OUTPUT), it is taken away instead and what was there before stays. Returns the first failure. */
enum dea_status dea_new_file_finish(struct dea_new_file *made, enum dea_status written, struct dea_error *error);

/* Whether it could be opened, for asking before long work; leaves nothing behind. */
enum dea_status dea_new_file_try(const char *path, struct dea_error *error);

/* DEA_ERR_INPUT when something is at the path that is neither an ordinary file nor a link. */
enum dea_status dea_new_file_check(const char *path, struct dea_error *error);

#endif
