/* What ngspice is told once, at its start: leave out what nobody reads. */
#include "circuit/engine_internal.h"

#include <dlfcn.h>
#include <glob.h>
#include <stdio.h>
#include <string.h>
#include <sys/timeb.h>
#include <time.h>

/* ngspice asks for the time about ten times in every Newton iteration, for statistics. The C library's ftime reads the
 * processor's counter each time, 6 % of a converter's run; this one, found before it by all of the process, returns the
 * kernel's last tick. That is a few milliseconds old; the unit of its result is one. */
int ftime(struct timeb *now) {
    struct timespec tick = {0};
    int failed = clock_gettime(CLOCK_REALTIME_COARSE, &tick);
    *now = (struct timeb){.time = tick.tv_sec, .millitm = (unsigned short)(tick.tv_nsec / 1000000)};
    return failed;
}

void dea_engine_settle(void) {
    /* Its last resort for the operating point, a pseudo transient, can run for ever and asks for external values at
     * times of its own: without it the failure is clean and names the node. */
    dea_engine_command("optran 1 1 1 0 0 0");
    dea_engine_command("set num_threads=1"); /* threads cost more than they bring in small circuits */
    dea_engine_command("set norefvalue");    /* a progress line, for which it asks the kernel at every point */
}

enum dea_status dea_engine_add_code_models(void *function, struct dea_error *error) {
    Dl_info library;
    char pattern[DEA_COMMAND_MAX], command[DEA_COMMAND_MAX];
    const char *slash = dladdr(function, &library) != 0 ? strrchr(library.dli_fname, '/') : NULL;
    int folder = slash != NULL ? (int)(slash - library.dli_fname) : 0;
    if (folder > DEA_COMMAND_MAX / 2)
        return dea_fail(error, DEA_ERR_SOLVER, "the path of libngspice is too long");
    snprintf(pattern, sizeof pattern, "%.*s/ngspice/*.cm", folder, folder > 0 ? library.dli_fname : "");
    glob_t found;
    if (glob(pattern, 0, NULL, &found) != 0)
        return dea_fail(error, DEA_ERR_SOLVER, "there are no code models %s", pattern);
    for (size_t i = 0; i < found.gl_pathc; i++)
        if ((size_t)snprintf(command, sizeof command, "codemodel %s", found.gl_pathv[i]) < sizeof command)
            dea_engine_command(command);
    globfree(&found);
    return DEA_OK;
}
