/* Gives every file of the named folders to the fuzz target it is linked with. Some of them must be good: a corpus of
 * refusals alone tries little. */
#include "fuzz.h"

#include <dirent.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void replay_file(const char *path) {
    FILE *file = fopen(path, "rb");
    static uint8_t data[1 << 20];
    fuzz_require(file != NULL, path);
    size_t size = fread(data, 1, sizeof data, file);
    fuzz_require(size < sizeof data && ferror(file) == 0, path);
    fclose(file);
    uint8_t *exact = malloc(size > 0 ? size : 1); /* so that a sanitizer sees reads past its end */
    fuzz_require(exact != NULL, "there is memory");
    memcpy(exact, data, size);
    fprintf(stderr, "%s\n", path); /* the last one named is the one that failed */
    LLVMFuzzerTestOneInput(exact, size);
    free(exact);
}

static long replay_folder(const char *folder) {
    struct dirent **entries;
    int count = scandir(folder, &entries, NULL, alphasort);
    long replayed = 0;
    fuzz_require(count >= 0, folder);
    for (int i = 0; i < count; i++) {
        char path[PATH_MAX];
        snprintf(path, sizeof path, "%s/%s", folder, entries[i]->d_name);
        if (entries[i]->d_name[0] != '.') {
            replay_file(path);
            replayed++;
        }
        free(entries[i]);
    }
    free(entries);
    return replayed;
}

int main(int argc, char **argv) {
    for (int i = 1; i < argc; i++) {
        char *folder = realpath(argv[i], NULL); /* the target changes the current folder */
        fuzz_require(folder != NULL, argv[i]);
        long replayed = replay_folder(folder);
        printf("%ld inputs of %s, %ld times accepted\n", replayed, folder, fuzz_accepted());
        fuzz_require(replayed > 0, "a folder of inputs holds some");
        fuzz_require(fuzz_accepted() > 0, "some input is good");
        free(folder);
    }
    return argc > 1 ? 0 : 2;
}
