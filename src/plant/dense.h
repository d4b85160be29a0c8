/* Direct solver of small dense systems for IDA. */
#ifndef DEASIM_PLANT_DENSE_H
#define DEASIM_PLANT_DENSE_H

#include <sundials/sundials_linearsolver.h>

/* For SUNDenseMatrix of n rows and columns, n > 0; freed with SUNLinSolFree. NULL without memory. */
SUNLinearSolver plant_new_dense_solver(int n, SUNContext context);

#endif
