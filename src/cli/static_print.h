/* The three ways `deasim static` shows its answer. */
#ifndef DEASIM_CLI_STATIC_PRINT_H
#define DEASIM_CLI_STATIC_PRINT_H

#include "deasim/design.h"

/* One row: what was asked and what came out. */
struct static_row {
    double voltage;                /* of the left zone; NAN when a field was asked and there is no equilibrium */
    struct dea_static_point point; /* only when `solved` */
    bool solved;                   /* false: no equilibrium */
    bool beyond;                   /* past the first failure */
};

struct static_answer {
    const struct dea_device *device;
    const char *path; /* of the device file, as given */
    double right_voltage;
    struct static_row *rows;
    int count;
    struct dea_limit limit;
};

/* Aligned table in field units. */
void static_print_table(const struct static_answer *answer);

/* SI, one header row "name [unit]". */
void static_print_csv(const struct static_answer *answer);

/* One JSON object; DEA_ERR_MEMORY when it cannot be built, and then nothing is printed. */
enum dea_status static_print_json(const struct static_answer *answer, struct dea_error *error);

#endif
