/* Runs a function in a forked child: what it calls may crash, hang, leak or exit without taking the caller along. */
#ifndef DEASIM_BASE_ISOLATE_H
#define DEASIM_BASE_ISOLATE_H

#include "deasim/status.h"

#include <signal.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct dea_channel; /* the child's end */

/* The work. Its status and error text become those of dea_isolate_run. */
typedef enum dea_status (*dea_isolated)(struct dea_channel *channel, void *context, struct dea_error *error);

struct dea_isolate_limits {
    double wall_s;                     /* kill after this wall time, s; 0: none */
    double silence_s;                  /* kill when no message and no progress arrives for this long, s; 0: none */
    size_t memory_bytes;               /* address space limit of the child; 0: none */
    const char *log_path;              /* the child's stdout and stderr are appended here; NULL: discarded */
    const volatile sig_atomic_t *stop; /* set by the caller's signal handler: the child is asked to end; may be NULL */
    double grace_s;                    /* time to end in order after being asked, s; 0: 10 s */
};

/* Receives messages in the order sent; `data` is aligned to 8 bytes. DEA_STOPPED asks the child to end, as `stop` does;
 * what it still sends is received. Any other status than DEA_OK ends the child at once and is returned. */
typedef enum dea_status (*dea_message_handler)(void *context, uint32_t type, const void *data, size_t size,
                                               struct dea_error *error);

/* Returns what the function returned; DEA_ERR_SOLVER when the child was killed, crashed or exited, with the signal's
 * name and the last progress in the message. No zombie and no descriptor is left. */
enum dea_status dea_isolate_run(dea_isolated function, void *context, const struct dea_isolate_limits *limits,
                                dea_message_handler handler, void *handler_context, struct dea_error *error);

/* ---- inside the child ---- */

/* Queues a message; sent in batches. DEA_ERR_OUTPUT when the parent is gone. `size` is at most DEA_MESSAGE_MAX. */
#define DEA_MESSAGE_MAX ((size_t)1 << 20)
enum dea_status dea_channel_send(struct dea_channel *channel, uint32_t type, const void *data, size_t size);

/* Sends what is queued now (progress for a waiting user, before long work). */
enum dea_status dea_channel_flush(struct dea_channel *channel);

/* Cheap sign of life, no message: the simulated time reached. Also what a crash message quotes. */
void dea_channel_progress(struct dea_channel *channel, double time);

/* True once the caller asked to end (its stop flag is set). */
bool dea_channel_stop_requested(const struct dea_channel *channel);

#endif
