/* The taut path: equilibria of a device parametrised by x, with the left voltage explicit (eq. 7 to 9 of Rosset et
 * al.). */
#ifndef DEASIM_DESIGN_PATH_H
#define DEASIM_DESIGN_PATH_H

#include "deasim/design.h"

/* One equilibrium with every membrane counted as taut, also where its stress is negative. */
struct dea_path_point {
    double x;                  /* m */
    double voltage_squared;    /* of the left zone, V^2 */
    double slope;              /* its derivative by x, V^2/m */
    double lam[DEA_ZONES];     /* lam1 */
    double field[DEA_ZONES];   /* |true field|, V/m */
    double net1[DEA_ZONES];    /* net nominal stress along the motion, Pa */
    double stress2[DEA_ZONES]; /* Cauchy stress across, Pa */
    double margin;             /* smallest margin to the law's limit */
};

/* DEA_RECOVERABLE outside the model. Needs an electroded left zone. */
enum dea_status dea_path_evaluate(const struct dea_device *device, double right_voltage, double x,
                                  struct dea_path_point *point);

/* What ends a walk along the path. Called with points in order of growing x. */
typedef bool (*dea_path_predicate)(const struct dea_device *device, const struct dea_path_point *point,
                                   const void *context);

/* Walks from `start` towards +x to the first point where `ends` holds, located to neighbouring doubles: `before` is the
 * last point where it does not hold, `after` the first where it does. A point outside the model ends the walk too; then
 * `after` equals `before`. Returns false when nothing ends the walk. */
struct dea_path_end {
    struct dea_path_point before, after;
    bool outside; /* the model ends here, not the predicate */
};
bool dea_path_walk(const struct dea_device *device, double right_voltage, double start, dea_path_predicate ends,
                   const void *context, struct dea_path_end *end);

/* dea_static_limit with slack1 where a zone's Cauchy stress along the motion falls to `least_tension` (Pa). */
enum dea_status dea_find_limit(const struct dea_device *device, double right_voltage, double least_tension,
                               struct dea_limit *limit, struct dea_error *error);

/* Where the platform rests at 0 V left: the start of the path. `device` has no branches. */
enum dea_status dea_find_rest(const struct dea_device *device, const double voltages[DEA_ZONES], double *x,
                              struct dea_error *error);

/* Refuses a voltage on a zone without electrode and voltages that are not numbers. */
enum dea_status dea_check_voltages(const struct dea_device *device, const double voltages[DEA_ZONES],
                                   struct dea_error *error);

/* A device without its branches, sharing everything else; it must not be cleared. */
struct dea_device dea_relaxed_device(const struct dea_device *device);

/* Refuses what the static commands cannot drive. */
enum dea_status dea_check_left_electrode(const struct dea_device *device, struct dea_error *error);

#endif
