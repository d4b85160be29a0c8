/* What ngspice is told once, at its start: leave out what nobody reads. */
#include "circuit/engine_internal.h"

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
