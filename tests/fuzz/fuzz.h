/* Fuzz targets: each fuzz_x.c reads one input in process. libFuzzer drives them, or replay.c with the kept corpus. */
#ifndef DEASIM_FUZZ_H
#define DEASIM_FUZZ_H

#include "deasim/status.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* One input; returns 0. Ends the process where a promise of the reader is broken. */
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* Lines "=====" part an input. The part number `index` from 0 and its length; NULL when there are fewer. */
const uint8_t *fuzz_find_part(const uint8_t *data, size_t size, int index, size_t *length);

/* Writes the first parts of an input to files of a folder of its own, which becomes the current one; a name without a
 * part is removed. */
void fuzz_write_parts(const uint8_t *data, size_t size, const char *const names[], int name_count);

/* What must hold. Prints the text and ends the process when it does not. */
void fuzz_require(bool holds, const char *text);

/* Good, or refused as input with a message that says something. Returns true when good. */
bool fuzz_judge(enum dea_status status, const struct dea_error *error);

/* How many were good so far. */
long fuzz_accepted(void);

#endif
