/* Material parameters from measurements: elastic laws from pull tests, branches from relaxation or creep. Least squares
 * with 95 % confidence intervals. */
#ifndef DEASIM_FIT_H
#define DEASIM_FIT_H

#include "deasim/columns.h"
#include "deasim/material.h"

#define DEA_FIT_PARAMETERS (2 * DEA_MAX_OGDEN_TERMS)
#define DEA_FIT_BRANCHES 5

struct dea_fit_parameter {
    char name[16];
    const char *si_unit; /* "Pa", "s", "1" */
    double value;        /* SI */
    double low, high;    /* 95 % confidence interval, SI */
    bool determined;     /* false: the data say next to nothing about it */
};

struct dea_fit {
    struct dea_fit_parameter parameters[DEA_FIT_PARAMETERS];
    int count;
    size_t points;
    double residual;  /* standard deviation of the data about the fit, SI unit of the data */
    double r_squared; /* share of the variance explained */
    double aicc;      /* Akaike's criterion with small-sample correction, to compare fits of the same data */
};

/* ---- pull tests ---- */

enum dea_pull_kind { DEA_PULL_PURE_SHEAR, DEA_PULL_UNIAXIAL };

/* What the measured force was divided by. */
enum dea_stress_basis {
    DEA_STRESS_NOMINAL, /* the cross-section of the unstretched film */
    DEA_STRESS_CLAMPED, /* that of the film as clamped, where the stretch column reads 1 */
    DEA_STRESS_TRUE     /* that of the film as pulled */
};

struct dea_pull_test {
    enum dea_pull_kind kind;
    enum dea_stress_basis basis;
    double lam2;  /* pure shear: stretch across, held by the clamps */
    double start; /* lam1 where the stretch column reads 1: 1, or lam2^-1/2 for a film that was free to contract */
};

/* Reads "stretch [1], stress [unit]". Refuses stretches that are not positive. */
enum dea_status dea_pull_test_read(const char *path, struct dea_columns *columns, struct dea_error *error);

/* Stress of a law in that test at a value of the stretch column; NAN outside the law's domain. */
double dea_pull_stress(const struct dea_pull_test *test, const struct dea_law *law, double stretch);

/* Fits a law; `terms` counts those of Yeoh and Ogden. DEA_ERR_INPUT when the data cannot carry so many parameters. */
enum dea_status dea_fit_law(const struct dea_pull_test *test, const struct dea_columns *data, enum dea_law_kind kind,
                            int terms, struct dea_law *law, struct dea_fit *fit, struct dea_error *error);

/* ---- relaxation and creep ---- */

enum dea_step_kind {
    DEA_STEP_RELAXATION, /* stretch stepped at t = 0 and held, stress measured */
    DEA_STEP_CREEP       /* stress stepped and held, stretch or strain measured */
};

/* Linear viscoelastic answer: equilibrium modulus 1 and branches of modulus `ratio` and relaxation time `tau`. */
struct dea_step_model {
    enum dea_step_kind kind;
    int count;
    double final;                   /* stress or strain after all has relaxed, SI */
    double ratio[DEA_FIT_BRANCHES]; /* branch modulus over equilibrium modulus */
    double tau[DEA_FIT_BRANCHES];   /* s, ascending */
};

/* Reads "time [unit], stress [unit]" (relaxation) or "time [unit], strain [1]" or "..., stretch [1]" (creep; stretches
 * are turned into strains). Times must be positive and grow. */
enum dea_status dea_step_test_read(const char *path, enum dea_step_kind *kind, struct dea_columns *columns,
                                   struct dea_error *error);

/* Stress or strain at time t. */
double dea_step_answer(const struct dea_step_model *model, double t);

/* Fits `count` branches; 0 chooses their number by Akaike's criterion among those whose parameters the data determine.
 */
enum dea_status dea_fit_branches(enum dea_step_kind kind, const struct dea_columns *data, int count,
                                 struct dea_step_model *model, struct dea_fit *fit, struct dea_error *error);

#endif
