/* Parent side of a run in a forked child: starts it, reads its messages, watches over it, judges how it ended. */
#include "base/isolate.h"
#include "base/isolate_internal.h"
#include "deasim/report.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#define POLL_MS 50 /* reaction time to the stop flag and the limits */
#define DEFAULT_GRACE_S 10.0
#define LAST_WORDS 400 /* bytes of the child's log quoted when it died */

struct watch {
    pid_t child;
    int descriptor;                  /* read end of the pipe */
    struct dea_shared_state *shared; /* page shared with the child */
    const struct dea_isolate_limits *limits;
    double started, last_sign, asked; /* s, monotonic; asked < 0: not yet */
    uint64_t last_beat;
    const char *killed_because; /* static text; NULL when we did not kill it */
    bool ended;                 /* the final frame arrived */
    enum dea_status status;     /* of the final frame */
    char text[sizeof((struct dea_error *)0)->text];
};

/* ---- the child ---- */

/* Points stdout and stderr at the log, stdin at nothing. */
static void redirect_output(const char *log_path) {
    int log = log_path != NULL ? open(log_path, O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0644) : -1;
    int null = open("/dev/null", O_RDWR | O_CLOEXEC);
    if (log < 0)
        log = null;
    if (log >= 0) {
        dup2(log, STDOUT_FILENO);
        dup2(log, STDERR_FILENO);
    }
    if (null >= 0)
        dup2(null, STDIN_FILENO);
}

static void run_child(dea_isolated function, void *context, const struct dea_isolate_limits *limits, int descriptor,
                      struct dea_shared_state *shared, pid_t parent) {
    /* end with the parent; leave the terminal's signals to it, it asks through the shared page */
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() != parent)
        _exit(1);
    signal(SIGINT, SIG_IGN);
    signal(SIGTERM, SIG_IGN);
    signal(SIGHUP, SIG_IGN);
    signal(SIGPIPE, SIG_IGN);
    redirect_output(limits->log_path);
    if (limits->memory_bytes > 0) {
        struct rlimit limit = {limits->memory_bytes, limits->memory_bytes};
        setrlimit(RLIMIT_AS, &limit);
    }
    struct rlimit no_core = {0, 0};
    setrlimit(RLIMIT_CORE, &no_core);

    struct dea_error error = {.status = DEA_OK};
    struct dea_channel *channel = dea_channel_open(descriptor, shared);
    enum dea_status status = channel == NULL ? dea_fail(&error, DEA_ERR_MEMORY, "out of memory in the child process")
                                             : function(channel, context, &error);
    if (status == DEA_OK)
        error.text[0] = '\0';
    fflush(stdout);
    fflush(stderr);
    if (channel == NULL || dea_channel_finish(channel, status, error.text) != DEA_OK)
        _exit(1);
    _exit(0);
}

/* ---- the parent ---- */

static void ask_to_end(struct watch *watch) {
    if (watch->asked >= 0.0)
        return;
    watch->asked = dea_clock();
    atomic_store_explicit(&watch->shared->stop, 1, memory_order_relaxed);
}

/* Hands complete frames of the buffer to the handler; returns the bytes used. */
static enum dea_status dispatch(struct watch *watch, const char *buffer, size_t filled, size_t *used,
                                dea_message_handler handler, void *handler_context, struct dea_error *error) {
    *used = 0;
    while (filled - *used >= sizeof(struct dea_frame)) {
        struct dea_frame frame;
        memcpy(&frame, buffer + *used, sizeof frame);
        size_t whole = dea_frame_bytes(frame.size);
        if (frame.size > DEA_MESSAGE_MAX)
            return dea_fail(error, DEA_ERR_INTERNAL, "the child process sent a damaged message");
        if (filled - *used < whole)
            break;
        const char *data = buffer + *used + sizeof frame;
        *used += whole;
        if (frame.type == DEA_FRAME_END) {
            int32_t status;
            memcpy(&status, data, sizeof status);
            watch->ended = true;
            watch->status = (enum dea_status)status;
            size_t length = frame.size - sizeof status;
            if (length >= sizeof watch->text)
                length = sizeof watch->text - 1;
            memcpy(watch->text, data + sizeof status, length);
            watch->text[length] = '\0';
        } else if (handler != NULL) {
            enum dea_status handled = handler(handler_context, frame.type, data, frame.size, error);
            if (handled != DEA_STOPPED)
                DEA_TRY(handled);
            else
                ask_to_end(watch);
        }
    }
    return DEA_OK;
}

/* Kills when a limit is passed; asks the child to end when the caller wants to. */
static void enforce_limits(struct watch *watch) {
    const struct dea_isolate_limits *limits = watch->limits;
    double now = dea_clock();
    uint64_t beat = atomic_load_explicit(&watch->shared->beat, memory_order_relaxed);
    if (beat != watch->last_beat) {
        watch->last_beat = beat;
        watch->last_sign = now;
    }
    if (limits->stop != NULL && *limits->stop != 0)
        ask_to_end(watch);
    const char *why = NULL;
    if (limits->wall_s > 0.0 && now - watch->started > limits->wall_s)
        why = "the wall time limit was reached";
    else if (limits->silence_s > 0.0 && now - watch->last_sign > limits->silence_s)
        why = "it made no progress for too long";
    else if (watch->asked >= 0.0 && now - watch->asked > (limits->grace_s > 0.0 ? limits->grace_s : DEFAULT_GRACE_S))
        why = "it did not end when asked to";
    if (why != NULL && watch->killed_because == NULL) {
        watch->killed_because = why;
        kill(watch->child, SIGKILL);
    }
}

/* Reads until the child closes its end. */
static enum dea_status pump_messages(struct watch *watch, dea_message_handler handler, void *handler_context,
                                     struct dea_error *error) {
    size_t capacity = 2 * dea_frame_bytes(DEA_MESSAGE_MAX);
    char *buffer = malloc(capacity); /* malloc aligns; frames are padded to 8 bytes */
    if (buffer == NULL)
        return dea_fail(error, DEA_ERR_MEMORY, "out of memory for messages of the child process");
    size_t filled = 0;
    enum dea_status status = DEA_OK;
    for (;;) {
        struct pollfd wait_for = {.fd = watch->descriptor, .events = POLLIN};
        int ready = poll(&wait_for, 1, POLL_MS);
        enforce_limits(watch);
        if (ready <= 0)
            continue;
        ssize_t got = read(watch->descriptor, buffer + filled, capacity - filled);
        if (got < 0 && (errno == EINTR || errno == EAGAIN))
            continue;
        if (got <= 0)
            break;
        filled += (size_t)got;
        watch->last_sign = dea_clock();
        size_t used;
        status = dispatch(watch, buffer, filled, &used, handler, handler_context, error);
        if (status != DEA_OK)
            break;
        memmove(buffer, buffer + used, filled - used);
        filled -= used;
    }
    free(buffer);
    return status;
}

/* Last lines of the log, for the message of a crash. */
static void quote_log(const char *log_path, char *text, size_t size) {
    text[0] = '\0';
    int file = log_path != NULL ? open(log_path, O_RDONLY | O_CLOEXEC) : -1;
    if (file < 0)
        return;
    off_t end = lseek(file, 0, SEEK_END);
    off_t from = end > (off_t)(size - 1) ? end - (off_t)(size - 1) : 0;
    ssize_t got = pread(file, text, size - 1, from);
    close(file);
    text[got > 0 ? got : 0] = '\0';
    for (char *c = text; *c != '\0'; c++)
        if (*c == '\n' || *c == '\r')
            *c = ' ';
}

/* What the end of the child means. */
static enum dea_status judge_end(const struct watch *watch, int wait_status, struct dea_error *error) {
    if (watch->ended && watch->killed_because == NULL) {
        if (watch->status != DEA_OK)
            return dea_fail(error, watch->status, "%s", watch->text);
        return DEA_OK;
    }
    char how[160], words[LAST_WORDS];
    if (watch->killed_because != NULL)
        snprintf(how, sizeof how, "was killed: %s", watch->killed_because);
    else if (WIFSIGNALED(wait_status))
        snprintf(how, sizeof how, "crashed with SIG%s (%s)", sigabbrev_np(WTERMSIG(wait_status)),
                 strsignal(WTERMSIG(wait_status)));
    else
        snprintf(how, sizeof how, "exited by itself with code %d", WEXITSTATUS(wait_status));
    double reached;
    memcpy(&reached, &watch->shared->progress, sizeof reached);
    quote_log(watch->limits->log_path, words, sizeof words);
    return dea_fail(error, DEA_ERR_SOLVER, "the solver process %s after %.1f s, at t = %.9g s%s%s", how,
                    dea_clock() - watch->started, reached, words[0] != '\0' ? "; its last words: " : "", words);
}

/* Forks with a pipe; the parent's end is left in watch. */
static enum dea_status start_child(struct watch *watch, dea_isolated function, void *context, struct dea_error *error) {
    int ends[2];
    if (pipe2(ends, O_CLOEXEC) != 0)
        return dea_fail(error, DEA_ERR_INTERNAL, "cannot make a pipe: %s", strerror(errno));
    (void)fcntl(ends[1], F_SETPIPE_SZ, 1 << 20); /* only speed: the default size works too */
    fflush(NULL);                                /* or the child would write the parent's buffers again */
    pid_t parent = getpid();
    watch->child = fork();
    if (watch->child < 0) {
        close(ends[0]);
        close(ends[1]);
        return dea_fail(error, DEA_ERR_INTERNAL, "cannot start a process: %s", strerror(errno));
    }
    if (watch->child == 0) {
        close(ends[0]);
        run_child(function, context, watch->limits, ends[1], watch->shared, parent);
    }
    close(ends[1]);
    watch->descriptor = ends[0];
    return DEA_OK;
}

enum dea_status dea_isolate_run(dea_isolated function, void *context, const struct dea_isolate_limits *limits,
                                dea_message_handler handler, void *handler_context, struct dea_error *error) {
    static const struct dea_isolate_limits no_limits = {0};
    struct watch watch = {.limits = limits != NULL ? limits : &no_limits, .asked = -1.0};
    watch.shared = mmap(NULL, sizeof *watch.shared, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (watch.shared == MAP_FAILED)
        return dea_fail(error, DEA_ERR_MEMORY, "out of memory for the child process");
    watch.started = watch.last_sign = dea_clock();

    enum dea_status status = start_child(&watch, function, context, error);
    if (status == DEA_OK) {
        status = pump_messages(&watch, handler, handler_context, error);
        if (status != DEA_OK)
            kill(watch.child, SIGKILL);
        int wait_status = 0;
        close(watch.descriptor);
        while (waitpid(watch.child, &wait_status, 0) < 0 && errno == EINTR)
            ;
        if (status == DEA_OK)
            status = judge_end(&watch, wait_status, error);
    }
    munmap(watch.shared, sizeof *watch.shared);
    return status;
}
