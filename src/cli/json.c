/* JSON on stdout. */
#include "cli/json.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

bool cli_json_number(cJSON *object, const char *key, double value) {
    char text[32];
    snprintf(text, sizeof text, "%.17g", value);
    return cJSON_AddRawToObject(object, key, isfinite(value) ? text : "null") != NULL;
}

enum dea_status cli_json_print(cJSON *root, bool good, struct dea_error *error) {
    char *text = good ? cJSON_PrintUnformatted(root) : NULL;
    cJSON_Delete(root);
    if (text == NULL)
        return dea_fail(error, DEA_ERR_MEMORY, "out of memory for the JSON");
    puts(text);
    free(text);
    return DEA_OK;
}
