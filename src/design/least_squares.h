/* Nonlinear least squares by MINPACK's Levenberg-Marquardt, with confidence intervals. */
#ifndef DEASIM_LEAST_SQUARES_H
#define DEASIM_LEAST_SQUARES_H

#include "deasim/fit.h"

/* Prediction at x; NAN outside the model. q: the parameters as the search sees them. */
typedef double (*dea_prediction)(const double *q, double x, const void *context);

struct dea_least_squares {
    dea_prediction predict;
    const void *context;
    const struct dea_columns *data;
    int count; /* parameters */
};

/* Improves q from its start and keeps it in `best` if its sum of squared residuals is below *least, which then becomes
 * that. A start that leads nowhere is passed over. */
enum dea_status dea_least_squares_try(const struct dea_least_squares *problem, double *q, double *best, double *least,
                                      struct dea_error *error);

/* Fills a fit at the solution. Parameters marked in `logarithmic` are exp(q); their names and units are set before. */
enum dea_status dea_least_squares_judge(const struct dea_least_squares *problem, const double *q,
                                        const bool *logarithmic, struct dea_fit *fit, struct dea_error *error);

#endif
