/* Functions in expressions. ngspice crashes when one of its own gets the wrong number of arguments, replaces the user's
 * (.func) as text, and so comes to no end when they call themselves or grow with every call. */
#include "circuit/netlist_internal.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define FUNCTIONS_MAX 1000
#define PARAMETERS_MAX 16
#define NESTING_MAX 50
#define LONGEST 1e6 /* characters a line may have after replacement */

/* A user's function. Replaced, it has at most base + growth x (length of its arguments) characters. */
struct function {
    char name[DEA_TOKEN_MAX];
    char parameters[PARAMETERS_MAX][64];
    int parameter_count;
    int line;         /* index into lines */
    const char *body; /* in the line's text */
    enum { UNSEEN, IN_PROGRESS, MEASURED } state;
    double base, growth;
};

struct functions {
    struct dea_netlist_job *job;
    struct function *list; /* owned */
    int count, depth;
};

/* Length of a text after replacement: base + sum of uses[k] x length of parameter k. */
struct length {
    double base, uses[PARAMETERS_MAX];
};

/* ---- text ---- */

static bool in_name(char c) {
    return isalnum((unsigned char)c) || c == '_';
}

/* The next name at or after *cursor, before `end`; *cursor behind it. False when there is none. */
static bool find_name(const char **cursor, const char *end, const char **name, size_t *length) {
    const char *c = *cursor;
    while (c < end && !isalpha((unsigned char)*c) && *c != '_') {
        bool number = isdigit((unsigned char)*c);
        do
            c++;
        while (number && c < end && (in_name(*c) || *c == '.')); /* 1e3k is one number */
    }
    *name = c;
    while (c < end && in_name(*c))
        c++;
    *length = (size_t)(c - *name);
    *cursor = c;
    return *length > 0;
}

/* The bracket that closes the one at `open`; `end` when there is none. */
static const char *find_close(const char *open, const char *end) {
    int depth = 0;
    for (const char *c = open; c < end; c++) {
        depth += (*c == '(') - (*c == ')');
        if (depth == 0)
            return c;
    }
    return end;
}

static const char *skip_blanks(const char *c) {
    while (isspace((unsigned char)*c))
        c++;
    return c;
}

/* Arguments between a bracket and the one that closes it. */
static int count_arguments(const char *open, const char *close) {
    int count = 1, depth = 0;
    for (const char *c = open + 1; c < close; c++) {
        depth += (strchr("([{", *c) != NULL) - (strchr(")]}", *c) != NULL);
        count += depth == 0 && *c == ',';
    }
    return skip_blanks(open + 1) == close ? 0 : count;
}

static bool same_name(const char *name, size_t length, const char *other) {
    return strlen(other) == length && strncasecmp(name, other, length) == 0;
}

static struct function *find_function(const struct functions *functions, const char *name, size_t length) {
    for (int i = 0; i < functions->count; i++)
        if (same_name(name, length, functions->list[i].name))
            return &functions->list[i];
    return NULL;
}

/* ---- the user's functions ---- */

/* .func name(a, b) {body} */
static enum dea_status add_function(struct functions *functions, int index) {
    struct dea_netlist_job *job = functions->job;
    const char *text = job->netlist->lines[index].text, *cursor = text + strlen(".func"), *end = text + strlen(text);
    const char *name;
    size_t length;
    if (!find_name(&cursor, end, &name, &length) || length >= DEA_TOKEN_MAX || *(cursor = skip_blanks(cursor)) != '(')
        return dea_netlist_fail(job, index, ".func needs a name, parameters and a body, as in .func f(x) {2*x}");
    if (functions->count >= FUNCTIONS_MAX)
        return dea_netlist_fail(job, index, "a netlist may have at most %d functions", FUNCTIONS_MAX);
    struct function *grown = dea_grow(functions->list, functions->count, sizeof *grown);
    if (grown == NULL)
        return dea_fail(job->error, DEA_ERR_MEMORY, "out of memory reading the netlist");
    functions->list = grown;
    struct function *made = &grown[functions->count++];
    const char *close = find_close(cursor, end);
    *made = (struct function){.line = index, .body = close < end ? close + 1 : end};
    memcpy(made->name, name, length);
    while (find_name(&cursor, close, &name, &length)) {
        if (made->parameter_count == PARAMETERS_MAX || length >= sizeof made->parameters[0])
            return dea_netlist_fail(job, index, ".func %s: at most %d parameters with names of at most 63 characters",
                                    made->name, PARAMETERS_MAX);
        memcpy(made->parameters[made->parameter_count++], name, length);
    }
    return DEA_OK;
}

static enum dea_status measure_function(struct functions *functions, struct function *function);

/* Adds the length of a text, replaced, with the parameters of `inside` (NULL: none). */
static enum dea_status measure_text(struct functions *functions, const char *text, const char *end,
                                    const struct function *inside, struct length *sum) {
    const char *cursor = text, *name;
    size_t length;
    sum->base += (double)(end - text);
    while (find_name(&cursor, end, &name, &length)) {
        for (int k = 0; inside != NULL && k < inside->parameter_count; k++)
            if (same_name(name, length, inside->parameters[k]))
                sum->uses[k] += 1.0;
        const char *open = skip_blanks(cursor);
        struct function *called = open < end && *open == '(' ? find_function(functions, name, length) : NULL;
        if (called == NULL)
            continue;
        struct length arguments = {0};
        const char *close = find_close(open, end);
        DEA_TRY(measure_function(functions, called));
        DEA_TRY(measure_text(functions, open + 1, close, inside, &arguments));
        sum->base += called->base + called->growth * arguments.base;
        for (int k = 0; k < PARAMETERS_MAX; k++)
            sum->uses[k] += called->growth * arguments.uses[k];
        cursor = close;
    }
    return DEA_OK;
}

static enum dea_status measure_function(struct functions *functions, struct function *function) {
    struct dea_netlist_job *job = functions->job;
    if (function->state == MEASURED)
        return DEA_OK;
    if (function->state == IN_PROGRESS)
        return dea_netlist_fail(job, function->line, ".func %s calls itself", function->name);
    if (functions->depth == NESTING_MAX)
        return dea_netlist_fail(job, function->line, ".func %s: functions nested more than %d deep", function->name,
                                NESTING_MAX);
    function->state = IN_PROGRESS;
    functions->depth++;
    struct length length = {0};
    DEA_TRY(measure_text(functions, function->body, function->body + strlen(function->body), function, &length));
    functions->depth--;
    function->state = MEASURED;
    function->base = length.base;
    for (int k = 0; k < function->parameter_count; k++)
        function->growth = length.uses[k] > function->growth ? length.uses[k] : function->growth;
    return DEA_OK;
}

/* ---- ngspice's functions ---- */

/* pwl(x, x1,y1, x2,y2, ..): the points must be constants, x going up. */
static enum dea_status check_points(const struct functions *functions, int index, const char *open, const char *close) {
    double last = -INFINITY, value;
    int depth = 0, place = 0;
    const char *start = open + 1;
    for (const char *c = open + 1; c <= close; c++) {
        depth += (strchr("([{", *c) != NULL) - (c < close && strchr(")]}", *c) != NULL);
        if (c < close && (depth > 0 || *c != ','))
            continue;
        char argument[64];
        start = skip_blanks(start);
        size_t length = (size_t)(c - start);
        snprintf(argument, sizeof argument, "%.*s", (int)(length < sizeof argument ? length : sizeof argument - 1),
                 start);
        while (length > 0 && length < sizeof argument && isspace((unsigned char)argument[length - 1]))
            argument[--length] = '\0';
        if (place > 0 && (strcasestr(argument, "v(") != NULL || strcasestr(argument, "i(") != NULL))
            return dea_netlist_fail(functions->job, index, "pwl(): %s is no constant; points are", argument);
        if (place % 2 == 1 && dea_spice_number(argument, &value)) {
            if (value <= last)
                return dea_netlist_fail(functions->job, index, "pwl(): its points must go up, %s does not", argument);
            last = value;
        }
        place++;
        start = c + 1;
    }
    return DEA_OK;
}

/* Wrong numbers of arguments in a text that becomes a behavioural source. */
static enum dea_status check_arguments(const struct functions *functions, int index, const char *text) {
    static const struct {
        const char *name;
        int least, most;
    } known[] = {
        {"abs", 1, 1},   {"acos", 1, 1},  {"acosh", 1, 1}, {"asin", 1, 1},   {"asinh", 1, 1}, {"atan", 1, 1},
        {"atanh", 1, 1}, {"ceil", 1, 1},  {"cos", 1, 1},   {"cosh", 1, 1},   {"ddt", 1, 1},   {"exp", 1, 1},
        {"floor", 1, 1}, {"ln", 1, 1},    {"log", 1, 1},   {"log10", 1, 1},  {"nint", 1, 1},  {"sgn", 1, 1},
        {"sin", 1, 1},   {"sinh", 1, 1},  {"sqrt", 1, 1},  {"tan", 1, 1},    {"tanh", 1, 1},  {"u", 1, 1},
        {"u2", 1, 1},    {"uramp", 1, 1}, {"max", 2, 2},   {"min", 2, 2},    {"pow", 2, 2},   {"pwr", 2, 2},
        {"limit", 2, 3}, {"unif", 2, 2},  {"aunif", 2, 2}, {"agauss", 3, 3}, {"gauss", 3, 3}, {"pwl", 5, 100000},
    };
    const char *end = text + strlen(text), *cursor = text, *name;
    size_t length;
    while (find_name(&cursor, end, &name, &length)) {
        const char *open = skip_blanks(cursor);
        if (*open != '(' || find_function(functions, name, length) != NULL)
            continue;
        const char *close = find_close(open, end);
        int count = count_arguments(open, close);
        if (count == 1 && same_name(name, length, "pwl") && isdigit((unsigned char)*skip_blanks(open + 1)))
            continue; /* E1 p n PWL(1) cp cn ..: a kind of source */
        for (size_t i = 0; i < sizeof known / sizeof known[0]; i++)
            if (same_name(name, length, known[i].name) && (count < known[i].least || count > known[i].most))
                return dea_netlist_fail(functions->job, index, "%s() takes %s%d argument%s, %d %s given", known[i].name,
                                        known[i].most > known[i].least ? "at least " : "", known[i].least,
                                        known[i].least == 1 ? "" : "s", count, count == 1 ? "is" : "are");
        if (same_name(name, length, "pwl"))
            DEA_TRY(check_points(functions, index, open, close));
    }
    return DEA_OK;
}

static enum dea_status check_lines(struct functions *functions) {
    const struct dea_netlist *netlist = functions->job->netlist;
    for (int i = 1; i < netlist->line_count; i++) {
        const char *text = netlist->lines[i].text;
        bool function = strncasecmp(text, ".func", 5) == 0;
        if (!netlist->lines[i].passed)
            continue;
        if (function || strchr("bBeEgGrRcClLfFhH", text[0]) != NULL)
            DEA_TRY(check_arguments(functions, i, text));
        const char *expression = strncasecmp(text, ".meas", 5) == 0 ? strcasestr(text, "par(") : NULL;
        if (expression != NULL)
            DEA_TRY(check_arguments(functions, i, expression));
        struct length length = {0};
        if (!function && functions->count > 0)
            DEA_TRY(measure_text(functions, text, text + strlen(text), NULL, &length));
        if (!(length.base <= LONGEST))
            return dea_netlist_fail(functions->job, i, "functions put in, the line has more than a million characters");
    }
    return DEA_OK;
}

enum dea_status dea_netlist_check_functions(struct dea_netlist_job *job) {
    struct functions functions = {.job = job};
    enum dea_status status = DEA_OK;
    for (int i = 1; i < job->netlist->line_count && status == DEA_OK; i++)
        if (job->netlist->lines[i].passed && strncasecmp(job->netlist->lines[i].text, ".func", 5) == 0)
            status = add_function(&functions, i);
    for (int i = 0; i < functions.count && status == DEA_OK; i++) {
        functions.depth = 0;
        status = measure_function(&functions, &functions.list[i]);
    }
    if (status == DEA_OK)
        status = check_lines(&functions);
    free(functions.list);
    return status;
}
