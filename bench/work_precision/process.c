/* Running and timing programs. */
#include "work_precision.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* In the child. The alarm outlives exec and ends a program that takes too long. */
static void become(char *const *arguments, const char *stdout_path, double limit) {
    int null = open("/dev/null", O_RDWR | O_CLOEXEC);
    int out = stdout_path != NULL ? open(stdout_path, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644) : null;
    if (null < 0 || out < 0 || dup2(null, STDIN_FILENO) < 0 || dup2(out, STDOUT_FILENO) < 0 ||
        dup2(null, STDERR_FILENO) < 0)
        _exit(127);
    alarm((unsigned)ceil(limit));
    execvp(arguments[0], arguments);
    _exit(127);
}

struct process_result process_run(char *const *arguments, const char *stdout_path, double limit) {
    struct process_result result = {0};
    struct rusage usage;
    int status = 0;
    double started = now();
    pid_t child = fork();
    if (child == 0)
        become(arguments, stdout_path, limit);
    pid_t ended = -1;
    if (child > 0)
        do
            ended = wait4(child, &status, 0, &usage);
        while (ended < 0 && errno == EINTR);
    if (ended != child)
        return result;
    result.wall = now() - started;
    result.cpu = (double)(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec) +
                 1e-6 * (double)(usage.ru_utime.tv_usec + usage.ru_stime.tv_usec);
    result.timed_out = WIFSIGNALED(status);
    result.good = WIFEXITED(status) && WEXITSTATUS(status) == 0;
    return result;
}
