/* Child side of an isolated run: queues messages and writes them to the parent in large batches. */
#include "base/isolate_internal.h"
#include "deasim/report.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define BATCH_BYTES ((size_t)1 << 18) /* written at once */
#define BATCH_S 0.2                   /* a message waits no longer than this for the next one */

struct dea_channel {
    int descriptor;
    struct dea_shared_state *shared;
    size_t filled;
    unsigned since_clock; /* messages since the clock was read */
    double flushed;       /* s, monotonic */
    char *batch;          /* BATCH_BYTES + one largest frame */
};

struct dea_channel *dea_channel_open(int descriptor, struct dea_shared_state *shared) {
    struct dea_channel *channel = calloc(1, sizeof *channel);
    char *batch = malloc(BATCH_BYTES + dea_frame_bytes(DEA_MESSAGE_MAX));
    if (channel == NULL || batch == NULL) {
        free(channel);
        free(batch);
        return NULL;
    }
    *channel = (struct dea_channel){.descriptor = descriptor, .shared = shared, .flushed = dea_clock(), .batch = batch};
    return channel;
}

enum dea_status dea_channel_flush(struct dea_channel *channel) {
    size_t sent = 0;
    while (sent < channel->filled) {
        ssize_t put = write(channel->descriptor, channel->batch + sent, channel->filled - sent);
        if (put < 0 && errno == EINTR)
            continue;
        if (put < 0)
            return DEA_ERR_OUTPUT;
        sent += (size_t)put;
    }
    channel->filled = 0;
    channel->since_clock = 0;
    channel->flushed = dea_clock();
    return DEA_OK;
}

/* Appends a frame made of one or two parts. The batch has room for the largest. */
static void append_frame(struct dea_channel *channel, uint32_t type, const void *head, size_t head_size,
                         const void *tail, size_t tail_size) {
    struct dea_frame frame = {type, (uint32_t)(head_size + tail_size)};
    char *to = channel->batch + channel->filled;
    memcpy(to, &frame, sizeof frame);
    if (head_size > 0)
        memcpy(to + sizeof frame, head, head_size);
    if (tail_size > 0)
        memcpy(to + sizeof frame + head_size, tail, tail_size);
    size_t whole = dea_frame_bytes(frame.size), plain = sizeof frame + frame.size;
    memset(to + plain, 0, whole - plain);
    channel->filled += whole;
}

enum dea_status dea_channel_send(struct dea_channel *channel, uint32_t type, const void *data, size_t size) {
    if (size > DEA_MESSAGE_MAX || type == DEA_FRAME_END)
        return DEA_ERR_INTERNAL;
    append_frame(channel, type, data, size, NULL, 0);
    /* slow senders are heard within BATCH_S, fast ones pay for a clock read only now and then */
    if (channel->filled >= BATCH_BYTES)
        return dea_channel_flush(channel);
    if (++channel->since_clock >= 16) {
        channel->since_clock = 0;
        if (dea_clock() - channel->flushed > BATCH_S)
            return dea_channel_flush(channel);
    }
    return DEA_OK;
}

enum dea_status dea_channel_finish(struct dea_channel *channel, enum dea_status status, const char *text) {
    int32_t code = (int32_t)status;
    append_frame(channel, DEA_FRAME_END, &code, sizeof code, text, strlen(text));
    return dea_channel_flush(channel);
}

void dea_channel_progress(struct dea_channel *channel, double time) {
    channel->shared->progress = time;
    atomic_fetch_add_explicit(&channel->shared->beat, 1, memory_order_relaxed);
}

bool dea_channel_stop_requested(const struct dea_channel *channel) {
    return atomic_load_explicit(&channel->shared->stop, memory_order_relaxed) != 0;
}
