/* The one table from status codes to text and exit codes. */
#include "deasim/status.h"

#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>

static const struct {
    enum dea_status status;
    const char *text;
    int exit_code;
} status_table[] = {
    {DEA_OK, "done", 0},
    {DEA_RECOVERABLE, "state outside the model", 3},
    {DEA_STOPPED, "stopped", 0},
    {DEA_ERR_INPUT, "bad input", 2},
    {DEA_ERR_SOLVER, "solver failed", 3},
    {DEA_ERR_INTERRUPTED, "interrupted", 3},
    {DEA_ERR_OUTPUT, "output failed", 3},
    {DEA_ERR_MEMORY, "out of memory", 4},
    {DEA_ERR_INTERNAL, "internal error", 4},
    {DEA_ERR_EXPECTATION, "expectation not met", 1},
};

enum dea_status(dea_fail)(struct dea_error *error, enum dea_status status, const char *format, ...) {
    if (error != NULL) {
        va_list arguments;
        va_start(arguments, format);
        vsnprintf(error->text, sizeof error->text, format, arguments);
        va_end(arguments);
        error->status = status;
    }
    return status;
}

const char *dea_status_text(enum dea_status status) {
    for (size_t i = 0; i < sizeof status_table / sizeof status_table[0]; i++)
        if (status_table[i].status == status)
            return status_table[i].text;
    return "unknown status";
}

int dea_exit_code(enum dea_status status) {
    for (size_t i = 0; i < sizeof status_table / sizeof status_table[0]; i++)
        if (status_table[i].status == status)
            return status_table[i].exit_code;
    return 4;
}
