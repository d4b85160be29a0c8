/* Shared libraries that few runs need. They are loaded by the first that does: linked, they would be mapped and
 * relocated at every start (libngspice, and libstdc++ behind it and NLopt, take a millisecond). */
#ifndef DEASIM_BASE_LIBRARY_H
#define DEASIM_BASE_LIBRARY_H

#include "deasim/status.h"

#include <stddef.h>

/* A function wanted from a library, and the pointer to it that is filled in. */
struct dea_library_function {
    const char *name;
    void *pointer; /* to a pointer to a function of the right type */
};

/* Loads `file` ("libnlopt.so.0"), where it is not yet, for as long as the process runs, and finds the functions.
 * DEA_ERR_INTERNAL names the Debian package to install. */
enum dea_status dea_library_load(const char *file, const char *package, const struct dea_library_function *functions,
                                 size_t count, struct dea_error *error);

#endif
