/* Running and timing programs. */
#include "process.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <signal.h>
#include <stdio.h>
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

/* A command, or a function in its place. */
struct job {
    char *const *arguments;
    const char *stdout_path;
    int (*work)(void *context);
    void *context;
    double limit; /* s */
};

/* In the child. Limit and alarm outlive exec and end a program that takes too long. */
static void become(const struct job *job, int complaints) {
    int null = open("/dev/null", O_RDWR | O_CLOEXEC);
    int out = job->stdout_path != NULL ? open(job->stdout_path, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644) : null;
    if (null < 0 || out < 0 || dup2(null, STDIN_FILENO) < 0 || dup2(out, STDOUT_FILENO) < 0 ||
        dup2(complaints >= 0 ? complaints : null, STDERR_FILENO) < 0)
        _exit(127);
    struct rlimit cpu = {(rlim_t)ceil(job->limit), (rlim_t)ceil(job->limit)};
    if (setrlimit(RLIMIT_CPU, &cpu) != 0)
        _exit(127);
    alarm((unsigned)ceil(WALL_PER_LIMIT * job->limit));
    if (job->work != NULL)
        _exit(job->work(job->context));
    execvp(job->arguments[0], job->arguments);
    _exit(127);
}

/* What the program said last of why it failed; not its notes, and not the source line shown below a message. */
static void read_message(FILE *complaints, struct process_result *result) {
    char line[sizeof result->message];
    rewind(complaints);
    while (fgets(line, sizeof line, complaints) != NULL) {
        line[strcspn(line, "\n")] = '\0';
        if (line[0] != '\0' && line[0] != ' ' && strncmp(line, "Note:", 5) != 0)
            memcpy(result->message, line, sizeof line);
    }
}

static struct process_result run(const struct job *job) {
    struct process_result result = {.code = 127};
    struct rusage usage;
    int status = 0;
    FILE *complaints = tmpfile();
    double started = process_clock();
    pid_t child = fork();
    if (child == 0)
        become(job, complaints != NULL ? fileno(complaints) : -1);
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
    result.memory = (double)usage.ru_maxrss / 1024.0;
    result.code = WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
    result.good = result.code == 0;
    /* deasim's own child may have met the limit in its stead */
    result.timed_out = result.code == -SIGXCPU || result.code == -SIGKILL || result.code == -SIGALRM ||
                       (!result.good && result.cpu > 0.95 * job->limit);
    return result;
}

struct process_result process_run(char *const *arguments, const char *stdout_path, double limit) {
    return run(&(struct job){.arguments = arguments, .stdout_path = stdout_path, .limit = limit});
}

struct process_result process_call(int (*work)(void *context), void *context, double limit) {
    return run(&(struct job){.work = work, .context = context, .limit = limit});
}
