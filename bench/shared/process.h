/* Programs, and functions, run in a process of their own under a limit, and what that took. */
#ifndef DEASIM_BENCH_PROCESS_H
#define DEASIM_BENCH_PROCESS_H

#include <stdbool.h>

struct process_result {
    bool good;         /* exit code 0, in time */
    bool timed_out;    /* killed at the limit */
    int code;          /* of the exit; less than 0: the signal that killed it */
    double wall, cpu;  /* s */
    double memory;     /* MB, largest resident set */
    char message[160]; /* the last it said on stderr */
};

/* s, of a clock that never jumps. */
double process_clock(void);

/* Runs a command with stdout into a file (NULL: thrown away). The limit is processor time in s, so that a busy machine
 * does not turn runs into failures. */
struct process_result process_run(char *const *arguments, const char *stdout_path, double limit);

/* The same for a function; what it returns is the exit code. */
struct process_result process_call(int (*work)(void *context), void *context, double limit);

#endif
