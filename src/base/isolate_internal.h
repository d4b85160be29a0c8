/* What both ends of the pipe between a run and its child process agree on. */
#ifndef DEASIM_BASE_ISOLATE_INTERNAL_H
#define DEASIM_BASE_ISOLATE_INTERNAL_H

#include "base/isolate.h"

#include <stdatomic.h>

#define DEA_FRAME_END UINT32_MAX /* the function's status (int32) and message */

/* Header of a message; the data follows, padded to 8 bytes. */
struct dea_frame {
    uint32_t type, size; /* bytes of data without padding */
};

/* Memory both processes see. */
struct dea_shared_state {
    _Atomic uint64_t beat; /* counts signs of life */
    _Atomic int stop;      /* the parent asks the child to end */
    double progress;       /* simulated time, s; written by the child only */
};

static inline size_t dea_frame_bytes(size_t size) {
    return sizeof(struct dea_frame) + (size + 7) / 8 * 8;
}

/* The child's end; lives until the process ends. */
struct dea_channel *dea_channel_open(int descriptor, struct dea_shared_state *shared);

/* Sends what is queued and the final frame. */
enum dea_status dea_channel_finish(struct dea_channel *channel, enum dea_status status, const char *text);

#endif
