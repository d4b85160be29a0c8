/* Finds NLopt's functions. */
#include "design/search_library.h"

#include "base/library.h"

enum dea_status search_library_load(struct search_library *library, struct dea_error *error) {
    const struct dea_library_function functions[] = {
        {"nlopt_create", &library->create},
        {"nlopt_destroy", &library->destroy},
        {"nlopt_set_max_objective", &library->set_max_objective},
        {"nlopt_set_lower_bounds1", &library->set_lower_bounds1},
        {"nlopt_set_upper_bounds1", &library->set_upper_bounds1},
        {"nlopt_set_initial_step", &library->set_initial_step},
        {"nlopt_set_initial_step1", &library->set_initial_step1},
        {"nlopt_set_xtol_abs1", &library->set_xtol_abs1},
        {"nlopt_set_maxeval", &library->set_maxeval},
        {"nlopt_optimize", &library->optimize},
        {"nlopt_result_to_string", &library->result_to_string},
    };
    return dea_library_load("libnlopt.so.0", "libnlopt0", functions, sizeof functions / sizeof functions[0], error);
}
