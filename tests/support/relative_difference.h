/* How far a signal is from its reference. */
#ifndef DEASIM_TEST_RELATIVE_DIFFERENCE_H
#define DEASIM_TEST_RELATIVE_DIFFERENCE_H

#include <stddef.h>

/* Relative L2 difference of `count` values, each array with its stride; the absolute one where the reference is 0 all
 * along. */
double relative_difference(const double *values, size_t stride, const double *reference, size_t reference_stride,
                           size_t count);

#endif
