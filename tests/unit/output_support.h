/* Shared by the tests of the output room: scratch folders, whole files as text, running a program. */
#ifndef OUTPUT_SUPPORT_H
#define OUTPUT_SUPPORT_H

#include "deasim/result.h"

#include <errno.h>
#include <ftw.h>
#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmocka.h>

#define SCRATCH_LENGTH 64

/* A new folder below the working folder. */
static inline void make_scratch(char folder[SCRATCH_LENGTH]) {
    snprintf(folder, SCRATCH_LENGTH, "scratch-XXXXXX");
    assert_non_null(mkdtemp(folder));
}

static inline int remove_entry(const char *path, const struct stat *status, int kind, struct FTW *place) {
    (void)status, (void)kind, (void)place;
    return remove(path);
}

static inline void remove_scratch(const char *folder) {
    assert_int_equal(nftw(folder, remove_entry, 16, FTW_DEPTH | FTW_PHYS), 0);
}

/* "folder/name" in a buffer that lives until the next call with the same `slot`. */
static inline const char *path_in(const char *folder, const char *name) {
    static char paths[4][512];
    static int slot;
    slot = (slot + 1) % 4;
    snprintf(paths[slot], sizeof paths[slot], "%s/%s", folder, name);
    return paths[slot];
}

/* A whole file, with a zero behind it; NULL when it cannot be read. */
static inline char *read_whole(const char *path, size_t *length) {
    FILE *file = fopen(path, "rb");
    if (file == NULL)
        return NULL;
    char *text = NULL;
    size_t used = 0;
    for (size_t room = 65536;; room *= 2) {
        text = realloc(text, room + 1);
        assert_non_null(text);
        used += fread(text + used, 1, room - used, file);
        if (used < room)
            break;
    }
    fclose(file);
    text[used] = '\0';
    if (length != NULL)
        *length = used;
    return text;
}

static inline void write_whole(const char *path, const char *text) {
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_int_equal(fputs(text, file) >= 0, 1);
    assert_int_equal(fclose(file), 0);
}

/* From now on no file grows beyond so many bytes, as on a full disk; returns the limit before. */
static inline struct rlimit limit_files(rlim_t bytes) {
    struct rlimit before;
    signal(SIGXFSZ, SIG_IGN);
    assert_int_equal(getrlimit(RLIMIT_FSIZE, &before), 0);
    const struct rlimit tight = {bytes, before.rlim_max};
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &tight), 0);
    return before;
}

static inline void release_files(struct rlimit before) {
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &before), 0);
}

static inline bool exists(const char *path) {
    return access(path, F_OK) == 0;
}

#endif
