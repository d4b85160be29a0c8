/* Answers of the commands as one JSON object. */
#ifndef DEASIM_CLI_JSON_H
#define DEASIM_CLI_JSON_H

#include "deasim/status.h"

#include <cJSON.h>
#include <stdbool.h>

/* A number with all its digits; null for one that does not exist. False when out of memory. */
bool cli_json_number(cJSON *object, const char *key, double value);

/* Prints the object on one line and deletes it. `good`: it is complete, what is missing for lack of memory. */
enum dea_status cli_json_print(cJSON *root, bool good, struct dea_error *error);

#endif
