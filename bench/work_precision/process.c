/* Running and timing programs. */
#include "work_precision.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

double process_clock(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

#define WALL_PER_LIMIT 6.0 /* a run that waits for ever ends at this many times its limit of processor time */

/* In the child. Limit and alarm outlive exec and end a program that takes too long. */
static void become(char *const *arguments, const char *stdout_path, int complaints, double limit) {
    int null = open("/dev/null", O_RDWR | O_CLOEXEC);
    int out = stdout_path != NULL ? open(stdout_path, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644) : null;
    if (null < 0 || out < 0 || dup2(null, STDIN_FILENO) < 0 || dup2(out, STDOUT_FILENO) < 0 ||
        dup2(complaints >= 0 ? complaints : null, STDERR_FILENO) < 0)
        _exit(127);
    struct rlimit cpu = {(rlim_t)ceil(limit), (rlim_t)ceil(limit)};
    if (setrlimit(RLIMIT_CPU, &cpu) != 0)
        _exit(127);
    alarm((unsigned)ceil(WALL_PER_LIMIT * limit));
    execvp(arguments[0], arguments);
    _exit(127);
}

/* What the program said last of why it failed. */
static void read_message(FILE *complaints, struct process_result *result) {
    char line[sizeof result->message];
    rewind(complaints);
    while (fgets(line, sizeof line, complaints) != NULL) {
        line[strcspn(line, "\n")] = '\0';
        if (line[0] != '\0' && strncmp(line, "Note:", 5) != 0)
            memcpy(result->message, line, sizeof line);
    }
}

struct process_result process_run(char *const *arguments, const char *stdout_path, double limit) {
    struct process_result result = {0};
    struct rusage usage;
    int status = 0;
    FILE *complaints = tmpfile();
    double started = process_clock();
    pid_t child = fork();
    if (child == 0)
        become(arguments, stdout_path, complaints != NULL ? fileno(complaints) : -1, limit);
    pid_t ended = -1;
    if (child > 0)
        do
            ended = wait4(child, &status, 0, &usage);
        while (ended < 0 && errno == EINTR);
    result.wall = process_clock() - started;
    if (complaints != NULL) {
        read_message(complaints, &result);
        fclose(complaints);
    }
    if (ended != child)
        return result;
    result.cpu = (double)(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec) +
                 1e-6 * (double)(usage.ru_utime.tv_usec + usage.ru_stime.tv_usec);
    result.good = WIFEXITED(status) && WEXITSTATUS(status) == 0;
    /* deasim's own child may have met the limit in its stead */
    result.timed_out = WIFSIGNALED(status) || (!result.good && result.cpu > 0.95 * limit);
    return result;
}
