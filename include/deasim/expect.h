/* Judges a scene's `expect` lines against the result of its run. */
#ifndef DEASIM_EXPECT_H
#define DEASIM_EXPECT_H

#include "deasim/result.h"

/* True when the measured value lies within the expectation's bounds. `text` receives one line with file, measure, value
 * and bounds. A signal or measure the run does not have is not met. */
bool dea_expectation_met(const struct dea_expectation *expectation, const struct dea_result *result, char *text,
                         int size);

#endif
