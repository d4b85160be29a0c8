/* Memory of the process, from Linux's /proc. */
#include "memory.h"

#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

long resident_bytes(void) {
    long pages = 0;
    FILE *file = fopen("/proc/self/statm", "r");
    if (file == NULL || fscanf(file, "%*d %ld", &pages) != 1 || fclose(file) != 0)
        abort();
    return pages * sysconf(_SC_PAGESIZE);
}
