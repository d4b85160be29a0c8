/* Inputs as files, and what is asked of every reader. */
#include "fuzz.h"

#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define PARTING "=====\n"

static char folder[4096];
static long accepted;

static void remove_folder(void) {
    char command[sizeof folder + 16];
    snprintf(command, sizeof command, "rm -rf '%s'", folder);
    if (chdir("/") != 0 || system(command) != 0)
        fprintf(stderr, "cannot remove %s\n", folder);
}

static void enter_folder(void) {
    const char *base = getenv("TMPDIR");
    snprintf(folder, sizeof folder, "%s/deasim-fuzz-XXXXXX", base != NULL && base[0] == '/' ? base : "/tmp");
    fuzz_require(mkdtemp(folder) != NULL && chdir(folder) == 0, "a folder can be made");
    atexit(remove_folder);
}

static void write_part(const char *name, const uint8_t *data, size_t size) {
    int file = open(name, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
    fuzz_require(file >= 0 && write(file, data, size) == (ssize_t)size && close(file) == 0, "an input can be written");
}

const uint8_t *fuzz_find_part(const uint8_t *data, size_t size, int index, size_t *length) {
    const uint8_t *end = data + size, *part = data;
    for (;; index--) {
        const uint8_t *parting = part < end ? memmem(part, (size_t)(end - part), PARTING, strlen(PARTING)) : NULL;
        *length = (size_t)((parting != NULL ? parting : end) - part);
        if (index == 0)
            return part;
        if (parting == NULL)
            return NULL;
        part = parting + strlen(PARTING);
    }
}

void fuzz_write_parts(const uint8_t *data, size_t size, const char *const names[], int name_count) {
    if (folder[0] == '\0')
        enter_folder();
    for (int i = 0; i < name_count; i++) {
        size_t length;
        const uint8_t *part = fuzz_find_part(data, size, i, &length);
        if (part != NULL)
            write_part(names[i], part, length);
        else
            unlink(names[i]);
    }
}

void fuzz_require(bool holds, const char *text) {
    if (holds)
        return;
    fprintf(stderr, "does not hold: %s\n", text);
    if (folder[0] != '\0')
        remove_folder();
    abort();
}

bool fuzz_judge(enum dea_status status, const struct dea_error *error) {
    if (status == DEA_OK) {
        accepted++;
        return true;
    }
    if (status != DEA_ERR_INPUT || strlen(error->text) < 10)
        fprintf(stderr, "status %d: %s\n", status, error->text);
    fuzz_require(status == DEA_ERR_INPUT, "what is refused is refused as input");
    fuzz_require(strlen(error->text) >= 10, "a refusal has a message");
    return false;
}

long fuzz_accepted(void) {
    return accepted;
}
