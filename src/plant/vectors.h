/* Vectors of IDA for problems of a few unknowns. */
#ifndef DEASIM_PLANT_VECTORS_H
#define DEASIM_PLANT_VECTORS_H

#include <sundials/sundials_nvector.h>

/* A serial vector of zeros whose operations, and those of its clones, are quick on few elements; NULL without memory.
 */
N_Vector plant_new_vector(sunindextype length, SUNContext context);

#endif
