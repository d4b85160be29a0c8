/* Where the netlist uses the simulated devices: subcircuit calls, also inside the user's own subcircuits, flattened the
 * way ngspice does it (instance x inside xarm is xarm.x, its local node n is xarm.n). */
#include "circuit/netlist_internal.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#define MAX_NESTING 20
#define MAX_INSTANCES 64
#define MAX_DEFINITIONS 5000
#define MAX_PINS 64      /* of a user subcircuit that holds a device */
#define MAX_ELEMENTS 1e6 /* subcircuits put in */

/* Targets of lines that call no subcircuit of the user's. */
enum { UNKNOWN = -1, A_DEVICE = -2 };

/* One .subckt of the user. */
struct definition {
    char name[DEA_TOKEN_MAX];
    int first, last;   /* lines of .subckt and .ends */
    int outer;         /* enclosing definition, -1 at top level */
    bool holds_device; /* directly or through others */
    double elements;   /* subcircuits put in; 0: not counted yet */
};

struct search {
    struct dea_netlist_job *job;
    struct definition *definitions;
    int count;
    int *owner;  /* per line: innermost definition, -1 at top level */
    int *target; /* per line: definition it calls, or UNKNOWN, A_DEVICE */
};

/* One level of the hierarchy while flattening. */
struct level {
    const char *path; /* "" at top level */
    int definition, depth, pin_count;
    char (*formals)[DEA_TOKEN_MAX], (*actuals)[DEA_TOKEN_MAX];
};

/* An X line: name, nodes, subcircuit. */
struct call {
    char name[DEA_TOKEN_MAX], target[DEA_TOKEN_MAX];
    char (*nodes)[DEA_TOKEN_MAX]; /* MAX_PINS + 1 entries */
    int node_count;
    bool parameters;
};

static enum dea_status out_of_memory(struct dea_netlist_job *job) {
    return dea_fail(job->error, DEA_ERR_MEMORY, "out of memory reading the netlist");
}

static int find_device(const struct dea_netlist_options *options, const char *name) {
    for (int i = 0; i < options->device_count; i++)
        if (strcasecmp(options->devices[i].name, name) == 0)
            return i;
    return -1;
}

/* Positional words of a .subckt or X line behind the first one: up to MAX_PINS + 1; stops at parameters. */
static int read_words(const char *cursor, char (*words)[DEA_TOKEN_MAX], bool *parameters) {
    char token[DEA_TOKEN_MAX];
    int count = 0;
    *parameters = false;
    while (dea_netlist_token(&cursor, token)) {
        if (strcmp(token, "params:") == 0) {
            *parameters = true;
            break;
        }
        if (strcmp(token, "=") == 0) { /* the word before was a parameter's name */
            *parameters = true;
            return count > 0 ? count - 1 : 0;
        }
        if (count <= MAX_PINS)
            memcpy(words[count], token, DEA_TOKEN_MAX);
        count++;
    }
    return count;
}

static void read_call(const char *text, struct call *call) {
    const char *cursor = text;
    dea_netlist_token(&cursor, call->name);
    int count = read_words(cursor, call->nodes, &call->parameters);
    call->target[0] = '\0';
    if (count > 0 && count <= MAX_PINS + 1)
        memcpy(call->target, call->nodes[count - 1], DEA_TOKEN_MAX);
    call->node_count = count > 0 ? count - 1 : 0;
}

/* ---- the user's subcircuits ---- */

static enum dea_status open_definition(struct search *search, int line, const char *cursor, int outer) {
    if (search->count >= MAX_DEFINITIONS)
        return dea_netlist_fail(search->job, line, "more than %d subcircuits", MAX_DEFINITIONS);
    struct definition *grown = dea_grow(search->definitions, search->count, sizeof *grown);
    if (grown == NULL)
        return out_of_memory(search->job);
    search->definitions = grown;
    struct definition *definition = &search->definitions[search->count];
    *definition = (struct definition){.first = line, .last = -1, .outer = outer};
    if (!dea_netlist_token(&cursor, definition->name))
        return dea_netlist_fail(search->job, line, ".subckt without a name");
    if (find_device(search->job->options, definition->name) >= 0)
        return dea_netlist_fail(search->job, line,
                                "subcircuit %s is the simulated device: remove its .subckt, it is supplied",
                                definition->name);
    search->count++;
    return DEA_OK;
}

static enum dea_status collect_definitions(struct search *search) {
    const struct dea_netlist *netlist = search->job->netlist;
    int current = -1;
    for (int i = 1; i < netlist->line_count; i++) {
        const char *cursor = netlist->lines[i].text;
        char card[DEA_TOKEN_MAX];
        if (*cursor == '.' && dea_netlist_token(&cursor, card)) {
            if (strcmp(card, ".subckt") == 0) {
                DEA_TRY(open_definition(search, i, cursor, current));
                current = search->count - 1;
            } else if (strcmp(card, ".ends") == 0) {
                if (current < 0)
                    return dea_netlist_fail(search->job, i, ".ends without .subckt");
                search->definitions[current].last = i;
                search->owner[i] = current;
                current = search->definitions[current].outer;
                continue;
            }
        }
        search->owner[i] = current;
    }
    if (current >= 0)
        return dea_netlist_fail(search->job, search->definitions[current].first, ".subckt %s without .ends",
                                search->definitions[current].name);
    return DEA_OK;
}

/* The definition a name means at a place: innermost scope first. */
static int find_definition(const struct search *search, const char *name, int scope) {
    for (;;) {
        for (int i = 0; i < search->count; i++)
            if (search->definitions[i].outer == scope && strcmp(search->definitions[i].name, name) == 0)
                return i;
        if (scope < 0)
            return -1;
        scope = search->definitions[scope].outer;
    }
}

static bool is_call(const char *text) {
    return *text == 'x' || *text == 'X';
}

static void resolve_calls(struct search *search, struct call *call) {
    const struct dea_netlist *netlist = search->job->netlist;
    for (int i = 1; i < netlist->line_count; i++) {
        search->target[i] = UNKNOWN;
        if (!is_call(netlist->lines[i].text))
            continue;
        read_call(netlist->lines[i].text, call);
        bool device = find_device(search->job->options, call->target) >= 0;
        search->target[i] = device ? A_DEVICE : find_definition(search, call->target, search->owner[i]);
    }
}

/* Marks the subcircuits that hold a device, until nothing changes. */
static void mark_holders(struct search *search) {
    for (bool changed = true; changed;) {
        changed = false;
        for (int i = 1; i < search->job->netlist->line_count; i++) {
            int owner = search->owner[i], target = search->target[i];
            if (owner < 0 || search->definitions[owner].holds_device)
                continue;
            if (target == A_DEVICE || (target >= 0 && search->definitions[target].holds_device))
                search->definitions[owner].holds_device = changed = true;
        }
    }
}

/* Elements of a definition (-1: the top level), so that ngspice need not put in what has no end. */
static enum dea_status count_elements(struct search *search, int definition, int depth, double *elements) {
    const struct dea_netlist *netlist = search->job->netlist;
    int first = definition < 0 ? 1 : search->definitions[definition].first + 1;
    int end = definition < 0 ? netlist->line_count : search->definitions[definition].last;
    double sum = 1.0;
    for (int i = first; i < end; i++) {
        int target = search->target[i];
        double inner = 1.0;
        if (search->owner[i] != definition)
            continue;
        if (target >= 0 && depth >= MAX_NESTING)
            return dea_netlist_fail(search->job, i, "subcircuits nested more than %d deep (does %s call itself?)",
                                    MAX_NESTING, search->definitions[target].name);
        if (target >= 0 && search->definitions[target].elements == 0.0)
            DEA_TRY(count_elements(search, target, depth + 1, &search->definitions[target].elements));
        if (target >= 0)
            inner = search->definitions[target].elements;
        sum += inner;
        if (sum > MAX_ELEMENTS)
            return dea_netlist_fail(search->job, i, "subcircuits put in, the circuit has more than a million elements");
    }
    *elements = sum;
    return DEA_OK;
}

/* ---- flattening ---- */

/* A node's flattened name. */
static enum dea_status flatten_node(const struct search *search, const struct level *level, const char *node, int line,
                                    char flat[DEA_TOKEN_MAX]) {
    if (strcmp(node, "0") == 0 || strcmp(node, "gnd") == 0) {
        snprintf(flat, DEA_TOKEN_MAX, "0");
        return DEA_OK;
    }
    for (int i = 0; i < level->pin_count; i++)
        if (strcmp(level->formals[i], node) == 0) {
            memcpy(flat, level->actuals[i], DEA_TOKEN_MAX);
            return DEA_OK;
        }
    const struct dea_netlist *netlist = search->job->netlist;
    for (int i = 1; i < netlist->line_count && level->path[0] != '\0'; i++) {
        const char *cursor = netlist->lines[i].text;
        char token[DEA_TOKEN_MAX];
        if (*cursor != '.' || !dea_netlist_token(&cursor, token) || strcmp(token, ".global") != 0)
            continue;
        while (dea_netlist_token(&cursor, token))
            if (strcmp(token, node) == 0) {
                memcpy(flat, token, DEA_TOKEN_MAX);
                return DEA_OK;
            }
    }
    int length = snprintf(flat, DEA_TOKEN_MAX, "%s%s%s", level->path, level->path[0] != '\0' ? "." : "", node);
    if (length >= DEA_TOKEN_MAX)
        return dea_netlist_fail(search->job, line, "a flattened name of more than 255 characters");
    return DEA_OK;
}

/* "left p, left n, right p, right n, pos" */
static void describe_pins(const struct dea_netlist_device *device, char *text, size_t size) {
    int used = 0;
    for (int i = 0; i < device->electrodes; i++)
        used +=
            snprintf(text + used, size - (size_t)used, "%s p, %s n, ", device->zone_names[i], device->zone_names[i]);
    snprintf(text + used, size - (size_t)used, "pos");
}

static enum dea_status check_device_call(const struct search *search, int line, const struct call *call, int device) {
    const struct dea_netlist_device *wanted = &search->job->options->devices[device];
    char pins[256];
    describe_pins(wanted, pins, sizeof pins);
    int expected = 2 * wanted->electrodes + 1;
    if (call->node_count != expected)
        return dea_netlist_fail(search->job, line, "%s: device %s has %d pins (%s), %d nodes are given", call->name,
                                wanted->name, expected, pins, call->node_count);
    if (call->parameters)
        return dea_netlist_fail(search->job, line,
                                "%s: device %s takes no parameters; they belong into its device file", call->name,
                                wanted->name);
    if (search->job->netlist->instance_count >= MAX_INSTANCES)
        return dea_netlist_fail(search->job, line, "more than %d devices", MAX_INSTANCES);
    int depth = 0;
    for (int i = 1; i < line; i++) {
        const char *text = search->job->netlist->lines[i].text;
        depth += strncasecmp(text, ".if", 3) == 0;
        depth -= strncasecmp(text, ".endif", 6) == 0;
    }
    if (depth > 0)
        return dea_netlist_fail(search->job, line, "%s: a device inside .if is not supported", call->name);
    return DEA_OK;
}

static enum dea_status add_instance(const struct search *search, const struct level *level, int line,
                                    const struct call *call, int device) {
    struct dea_netlist *netlist = search->job->netlist;
    DEA_TRY(check_device_call(search, line, call, device));
    struct dea_netlist_instance *grown = dea_grow(netlist->instances, netlist->instance_count, sizeof *grown);
    if (grown == NULL)
        return out_of_memory(search->job);
    netlist->instances = grown;
    struct dea_netlist_instance *instance = &netlist->instances[netlist->instance_count];
    *instance = (struct dea_netlist_instance){.device = device, .line = line};
    netlist->instance_count++;
    if (asprintf(&instance->path, "%s%s%s", level->path, level->path[0] != '\0' ? "." : "", call->name) < 0) {
        instance->path = NULL;
        return out_of_memory(search->job);
    }
    for (int i = 0; i < call->node_count; i++) {
        char flat[DEA_TOKEN_MAX];
        DEA_TRY(flatten_node(search, level, call->nodes[i], line, flat));
        instance->nodes[i] = strdup(flat);
        if (instance->nodes[i] == NULL)
            return out_of_memory(search->job);
    }
    return DEA_OK;
}

static enum dea_status flatten_level(const struct search *search, const struct level *level);

/* Descends into a user subcircuit that holds a device. */
static enum dea_status descend(const struct search *search, const struct level *level, int line,
                               const struct call *call, int definition) {
    struct dea_netlist_job *job = search->job;
    char(*names)[DEA_TOKEN_MAX] = calloc(2 * (MAX_PINS + 2), DEA_TOKEN_MAX), path[DEA_TOKEN_MAX];
    if (names == NULL)
        return out_of_memory(job);
    struct level inner = {.path = path,
                          .definition = definition,
                          .depth = level->depth + 1,
                          .formals = names,
                          .actuals = names + MAX_PINS + 2};
    const char *cursor = job->netlist->lines[search->definitions[definition].first].text;
    char token[DEA_TOKEN_MAX];
    bool parameters;
    dea_netlist_token(&cursor, token); /* .subckt */
    dea_netlist_token(&cursor, token); /* name */
    inner.pin_count = read_words(cursor, inner.formals, &parameters);
    enum dea_status status = DEA_OK;
    if (inner.pin_count > MAX_PINS || call->node_count > MAX_PINS)
        status = dea_netlist_fail(job, line, "%s: more than %d pins on a subcircuit that holds a device", call->name,
                                  MAX_PINS);
    else if (inner.pin_count != call->node_count)
        status = dea_netlist_fail(job, line, "%s: subcircuit %s has %d pins, %d nodes are given", call->name,
                                  call->target, inner.pin_count, call->node_count);
    else if (snprintf(path, sizeof path, "%s%s%s", level->path, level->path[0] != '\0' ? "." : "", call->name) >=
             (int)sizeof path)
        status = dea_netlist_fail(job, line, "a flattened name of more than 255 characters");
    for (int i = 0; i < inner.pin_count && status == DEA_OK; i++)
        status = flatten_node(search, level, call->nodes[i], line, inner.actuals[i]);
    if (status == DEA_OK)
        status = flatten_level(search, &inner);
    free(names);
    return status;
}

static enum dea_status flatten_level(const struct search *search, const struct level *level) {
    const struct dea_netlist *netlist = search->job->netlist;
    struct call call = {.nodes = calloc(MAX_PINS + 1, DEA_TOKEN_MAX)};
    if (call.nodes == NULL)
        return out_of_memory(search->job);
    int first = level->definition < 0 ? 1 : search->definitions[level->definition].first + 1;
    int end = level->definition < 0 ? netlist->line_count : search->definitions[level->definition].last;
    enum dea_status status = DEA_OK;
    for (int i = first; i < end && status == DEA_OK; i++) {
        if (search->owner[i] != level->definition || !is_call(netlist->lines[i].text))
            continue;
        read_call(netlist->lines[i].text, &call);
        int device = find_device(search->job->options, call.target);
        int definition = find_definition(search, call.target, level->definition);
        if (device >= 0)
            status = add_instance(search, level, i, &call, device);
        else if (definition >= 0 && search->definitions[definition].holds_device)
            status = descend(search, level, i, &call, definition);
    }
    free(call.nodes);
    return status;
}

static enum dea_status search_devices(struct search *search) {
    struct dea_netlist_job *job = search->job;
    DEA_TRY(collect_definitions(search));
    struct call call = {.nodes = calloc(MAX_PINS + 1, DEA_TOKEN_MAX)};
    if (call.nodes == NULL)
        return out_of_memory(job);
    resolve_calls(search, &call);
    free(call.nodes);
    double elements;
    DEA_TRY(count_elements(search, -1, 0, &elements));
    mark_holders(search);
    struct level top = {.path = "", .definition = -1};
    DEA_TRY(flatten_level(search, &top));
    for (int device = 0; device < job->options->device_count; device++) {
        bool used = false;
        for (int i = 0; i < job->netlist->instance_count; i++)
            used = used || job->netlist->instances[i].device == device;
        if (!used) {
            char pins[256];
            const struct dea_netlist_device *wanted = &job->options->devices[device];
            describe_pins(wanted, pins, sizeof pins);
            return dea_fail(job->error, DEA_ERR_INPUT,
                            "%s: device %s is never used; call it as Xname nodes %s, nodes for: %s",
                            job->netlist->files[0], wanted->name, wanted->name, pins);
        }
    }
    return DEA_OK;
}

enum dea_status dea_netlist_find_devices(struct dea_netlist_job *job) {
    size_t lines = (size_t)job->netlist->line_count;
    struct search search = {.job = job, .owner = calloc(lines, sizeof(int)), .target = calloc(lines, sizeof(int))};
    enum dea_status status =
        search.owner != NULL && search.target != NULL ? search_devices(&search) : out_of_memory(job);
    free(search.owner);
    free(search.target);
    free(search.definitions);
    return status;
}
