/* How `deasim optimum` shows its answers. */
#ifndef DEASIM_CLI_OPTIMUM_PRINT_H
#define DEASIM_CLI_OPTIMUM_PRINT_H

#include "cli/optimum_dynamic.h"
#include "cli/range.h"
#include "deasim/optimum.h"

/* The same film otherwise used, each at its own optimum. */
struct optimum_comparison {
    struct dea_optimum dead_load, both_ways;
};

/* Optima over a parameter. */
struct optimum_sweep {
    enum dea_design_key key;
    struct dea_range range;
    struct dea_optimum *optima; /* range.count of them */
};

/* `comparison` and `dynamics` may be NULL. */
void optimum_print(const struct dea_optimum_task *task, const struct dea_optimum *optimum,
                   const struct optimum_comparison *comparison, const struct optimum_dynamics *dynamics);
enum dea_status optimum_print_json(const struct dea_optimum *optimum, const struct optimum_comparison *comparison,
                                   const struct optimum_dynamics *dynamics, struct dea_error *error);

void optimum_print_sweep(const struct dea_optimum_task *task, const struct optimum_sweep *sweep);
enum dea_status optimum_print_sweep_json(const struct optimum_sweep *sweep, struct dea_error *error);

#endif
