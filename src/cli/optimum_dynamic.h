/* What a voltage step or ramp does to a design that is safe at rest. */
#ifndef DEASIM_CLI_OPTIMUM_DYNAMIC_H
#define DEASIM_CLI_OPTIMUM_DYNAMIC_H

#include "deasim/optimum.h"

/* One way of switching on. */
struct optimum_transient {
    double rise;               /* s; 0: step */
    double voltage;            /* that of the static end, V */
    double peak_ratio;         /* largest displacement over the static one */
    double peak_field;         /* V/m */
    double breakdown_ratio;    /* peak field over the breakdown field there; NAN without one */
    double least_tension;      /* smallest pull of a part, N; negative values do not occur, 0 means slack */
    double least_stress2;      /* Pa */
    const char *first_failure; /* "breakdown", "slack", "stress2" or "none" */
    double first_time;         /* s; NAN for none */
    double safe_voltage;       /* largest voltage that can be switched on this way without any of them, V */
};

struct optimum_dynamics {
    double period; /* natural, at rest, s */
    struct optimum_transient step, ramp;
};

/* Switches the optimum's final voltage on at once and over one natural period, and finds the largest safe voltages.
 * `body` lends what a design does not say: width, total length, platform, film density, branches. */
enum dea_status optimum_switch_on(const struct dea_optimum *optimum, const struct dea_device *body,
                                  struct optimum_dynamics *dynamics, struct dea_error *error);

#endif
