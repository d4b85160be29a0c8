/* NLopt, loaded by the first search: it brings the C++ library along, which no run in time needs. */
#ifndef DEASIM_DESIGN_SEARCH_LIBRARY_H
#define DEASIM_DESIGN_SEARCH_LIBRARY_H

#include "deasim/status.h"

#include <nlopt.h>

/* Its functions, by their names without nlopt_. */
struct search_library {
    __typeof__(nlopt_create) *create;
    __typeof__(nlopt_destroy) *destroy;
    __typeof__(nlopt_set_max_objective) *set_max_objective;
    __typeof__(nlopt_set_lower_bounds1) *set_lower_bounds1;
    __typeof__(nlopt_set_upper_bounds1) *set_upper_bounds1;
    __typeof__(nlopt_set_initial_step) *set_initial_step;
    __typeof__(nlopt_set_initial_step1) *set_initial_step1;
    __typeof__(nlopt_set_xtol_abs1) *set_xtol_abs1;
    __typeof__(nlopt_set_maxeval) *set_maxeval;
    __typeof__(nlopt_optimize) *optimize;
    __typeof__(nlopt_result_to_string) *result_to_string;
};

enum dea_status search_library_load(struct search_library *library, struct dea_error *error);

#endif
