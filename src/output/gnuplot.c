/* gnuplot as a child process: script in, whole PNG out. */
#include "deasim/gnuplot.h"
#include "deasim/new_file.h"
#include "output_internal.h"

#include <errno.h>
#include <spawn.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

/* Starts gnuplot with its default settings, script as standard input, picture as standard output. 0 or an errno. */
static int spawn_gnuplot(int script, int picture, int messages, pid_t *child) {
    static char name[] = "gnuplot", defaults[] = "-d";
    char *const arguments[] = {name, defaults, NULL};
    posix_spawn_file_actions_t actions;
    int trouble = posix_spawn_file_actions_init(&actions);
    if (trouble != 0)
        return trouble;
    trouble = posix_spawn_file_actions_adddup2(&actions, script, STDIN_FILENO);
    if (trouble == 0)
        trouble = posix_spawn_file_actions_adddup2(&actions, picture, STDOUT_FILENO);
    if (trouble == 0)
        trouble = posix_spawn_file_actions_adddup2(&actions, messages, STDERR_FILENO);
    if (trouble == 0)
        trouble = posix_spawnp(child, name, &actions, NULL, arguments, environ);
    posix_spawn_file_actions_destroy(&actions);
    return trouble;
}

/* Last line of the complaint: gnuplot echoes the command and points at it before it says what is wrong. */
static void read_complaint(FILE *messages, char *complaint, size_t size) {
    char line[512];
    complaint[0] = '\0';
    rewind(messages);
    while (fgets(line, sizeof line, messages) != NULL) {
        line[strcspn(line, "\n")] = '\0';
        if (line[strspn(line, " \t^")] != '\0')
            dea_header_text(line, complaint, size);
    }
}

static enum dea_status run_gnuplot(FILE *script, int picture, struct dea_error *error) {
    FILE *messages = tmpfile();
    if (messages == NULL)
        return dea_fail(error, DEA_ERR_OUTPUT, "no temporary file for gnuplot: %s", strerror(errno));
    pid_t child;
    int trouble = spawn_gnuplot(fileno(script), picture, fileno(messages), &child);
    enum dea_status status = DEA_OK;
    if (trouble == ENOENT)
        status = dea_fail(error, DEA_ERR_OUTPUT,
                          "gnuplot is not installed (or not on PATH); on Debian: apt install gnuplot-nox");
    else if (trouble != 0)
        status = dea_fail(error, DEA_ERR_OUTPUT, "gnuplot cannot be started: %s", strerror(trouble));
    int outcome = 0;
    while (status == DEA_OK && waitpid(child, &outcome, 0) < 0)
        if (errno != EINTR)
            status = dea_fail(error, DEA_ERR_OUTPUT, "gnuplot cannot be waited for: %s", strerror(errno));
    if (status == DEA_OK && outcome != 0) {
        char complaint[512];
        read_complaint(messages, complaint, sizeof complaint);
        status = dea_fail(error, DEA_ERR_OUTPUT, "gnuplot failed%s%s", complaint[0] != '\0' ? ": " : "", complaint);
    }
    fclose(messages);
    return status;
}

/* gnuplot does not fail when its output does not fit on the disk: a PNG is whole when it ends with its IEND chunk. */
static bool is_whole_png(int picture) {
    static const unsigned char begin[8] = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
    static const unsigned char finish[8] = {'I', 'E', 'N', 'D', 0xae, 0x42, 0x60, 0x82};
    unsigned char bytes[8];
    off_t size = lseek(picture, 0, SEEK_END);
    return size > 16 && pread(picture, bytes, 8, 0) == 8 && memcmp(bytes, begin, 8) == 0 &&
           pread(picture, bytes, 8, size - 8) == 8 && memcmp(bytes, finish, 8) == 0;
}

enum dea_status dea_gnuplot_draw(FILE *script, const char *path, struct dea_error *error) {
    struct dea_new_file picture;
    DEA_TRY(dea_new_file_open(path, &picture, error));
    enum dea_status status = run_gnuplot(script, fileno(picture.file), error);
    if (status == DEA_OK && !is_whole_png(fileno(picture.file)))
        status = dea_fail(error, DEA_ERR_OUTPUT, "%s: gnuplot wrote no whole picture (is the disk full?)", path);
    return dea_new_file_finish(&picture, status, error);
}

enum dea_status dea_gnuplot_draw_file(const char *script, const char *path, struct dea_error *error) {
    FILE *file = fopen(script, "re");
    if (file == NULL)
        return dea_fail(error, DEA_ERR_OUTPUT, "%s: %s", script, strerror(errno));
    enum dea_status status = dea_gnuplot_draw(file, path, error);
    fclose(file);
    return status;
}
