/* How far a signal is from its reference. */
#include "relative_difference.h"

#include <math.h>

double relative_difference(const double *values, size_t stride, const double *reference, size_t reference_stride,
                           size_t count) {
    double sum = 0.0, size = 0.0;
    for (size_t i = 0; i < count; i++) {
        double r = reference[i * reference_stride], d = values[i * stride] - r;
        sum += d * d;
        size += r * r;
    }
    return size > 0.0 ? sqrt(sum / size) : sqrt(sum);
}
