/* What a result owns and how its parts are called. */
#include "output_internal.h"

#include <stdlib.h>

const char *dea_outcome_text(enum dea_status status) {
    if (status == DEA_OK)
        return "done";
    return status == DEA_STOPPED ? "stopped" : "failed";
}

const char *dea_event_zone(const struct dea_event *event) {
    return event->zone < 0 ? "platform" : dea_zone_names[event->zone];
}

void dea_result_clear(struct dea_result *result) {
    free(result->signals);
    free(result->stats);
    free(result->events);
    free(result->measures);
    *result = (struct dea_result){0};
}
