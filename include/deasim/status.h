/* Status codes, error text and exit codes shared by every room of deasim. */
#ifndef DEASIM_STATUS_H
#define DEASIM_STATUS_H

/* Sign as in SUNDIALS: 0 good, positive recoverable or an ordinary early end, negative failed. */
enum dea_status {
    DEA_OK = 0,
    DEA_RECOVERABLE = 1,      /* state outside the model (for example D <= 0): retry with a shorter step */
    DEA_STOPPED = 2,          /* an event asked the run to end; everything up to there is valid */
    DEA_ERR_INPUT = -1,       /* bad input: file, key, value, command line */
    DEA_ERR_SOLVER = -2,      /* a solver gave up; what was computed is kept */
    DEA_ERR_INTERRUPTED = -3, /* SIGINT, SIGTERM or SIGHUP ended the run; what was computed is kept */
    DEA_ERR_OUTPUT = -4,      /* a result could not be written */
    DEA_ERR_MEMORY = -5,      /* out of memory */
    DEA_ERR_INTERNAL = -6,    /* a defect of deasim itself */
    DEA_ERR_EXPECTATION = -7, /* a scene's `expect` was not met */
};

/* The message travels with the code; it is built where the fact is known. */
struct dea_error {
    enum dea_status status;
    char text[2048];
};

/* Records a printf-style message in *error (may be NULL) and returns status, so callers write `return dea_fail(...)`.
 * Text longer than the buffer is cut. */
enum dea_status dea_fail(struct dea_error *error, enum dea_status status, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* The same call; lets compilers and analyzers see that the status that comes back is the one that was given. */
#define dea_fail(error, status, ...)                                                                                   \
    __extension__({                                                                                                    \
        (dea_fail)((error), (status), __VA_ARGS__);                                                                    \
        (status);                                                                                                      \
    })

/* Short English name of a code, never NULL. */
const char *dea_status_text(enum dea_status status);

/* Process exit code: 0 good (also DEA_STOPPED), 1 expectation, 2 input, 3 solver, interrupted or output, 4 internal. */
int dea_exit_code(enum dea_status status);

/* Passes any status but DEA_OK up to the caller. */
#define DEA_TRY(call)                                                                                                  \
    do {                                                                                                               \
        enum dea_status dea_try_status_ = (call);                                                                      \
        if (dea_try_status_ != DEA_OK)                                                                                 \
            return dea_try_status_;                                                                                    \
    } while (0)

#endif
