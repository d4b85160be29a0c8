/* Shared by the files of the drive room. */
#ifndef DEASIM_DRIVE_INTERNAL_H
#define DEASIM_DRIVE_INTERNAL_H

#include "deasim/waveform.h"

/* Checks point i of a pwl waveform against the limits and the points before it; the message says "point i + 1". */
enum dea_status dea_waveform_check_point(const struct dea_waveform *waveform, size_t i, struct dea_error *error);

#endif
