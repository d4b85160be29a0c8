/* How `deasim fit` shows its answers. */
#ifndef DEASIM_CLI_FIT_PRINT_H
#define DEASIM_CLI_FIT_PRINT_H

#include "deasim/fit.h"

struct fit_answer {
    const char *path; /* of the data */
    struct dea_columns data;
    bool branches;
    struct dea_pull_test test; /* pull test */
    struct dea_law law;
    struct dea_step_model model; /* step test */
    double mu;                   /* equilibrium modulus for branch moduli, Pa; 0: not given */
    struct dea_fit fit;
};

void fit_print(const struct fit_answer *answer);
enum dea_status fit_print_json(const struct fit_answer *answer, struct dea_error *error);

/* Writes DIR/fit.csv (data beside the fit, SI) and DIR/fit.gnuplot, and draws DIR/fit.png. */
enum dea_status fit_draw(const struct fit_answer *answer, const char *directory, struct dea_error *error);

#endif
