/* Reading a netlist: the order of the steps, and what they share. */
#include "circuit/netlist_internal.h"

#include <ctype.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

void *dea_grow(void *array, int count, size_t element) {
    if (count > 0 && (count & (count - 1)) != 0)
        return array;
    return realloc(array, (count > 0 ? 2 * (size_t)count : 1) * element);
}

const char *dea_netlist_place(const struct dea_netlist *netlist, int index, int *line) {
    const struct dea_netlist_line *at = &netlist->lines[index];
    *line = at->line;
    return netlist->files[at->file];
}

enum dea_status dea_netlist_fail(struct dea_netlist_job *job, int line_index, const char *format, ...) {
    char text[1024];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    int line;
    const char *file = dea_netlist_place(job->netlist, line_index, &line);
    return dea_fail(job->error, DEA_ERR_INPUT, "%s:%d: %s", file, line, text);
}

enum dea_status dea_netlist_warn(struct dea_netlist_job *job, int line_index, const char *format, ...) {
    struct dea_netlist *netlist = job->netlist;
    char text[1024], *whole;
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    int line;
    const char *file = dea_netlist_place(netlist, line_index, &line);
    char **grown = dea_grow(netlist->warnings, netlist->warning_count, sizeof *grown);
    if (grown != NULL)
        netlist->warnings = grown;
    if (grown == NULL || asprintf(&whole, "%s:%d: %s", file, line, text) < 0)
        return dea_fail(job->error, DEA_ERR_MEMORY, "out of memory reading %s", file);
    netlist->warnings[netlist->warning_count++] = whole;
    return DEA_OK;
}

/* Length of a quoted or braced piece at c, 1 when it is neither. */
static size_t held_together(const char *c) {
    if (*c == '\'' || *c == '"') {
        const char *end = strchr(c + 1, *c);
        return end != NULL ? (size_t)(end - c) + 1 : strlen(c);
    }
    if (*c != '{')
        return 1;
    int depth = 0;
    for (const char *end = c; *end != '\0'; end++) {
        depth += (*end == '{') - (*end == '}');
        if (depth == 0)
            return (size_t)(end - c) + 1;
    }
    return strlen(c);
}

static bool separates(char c) {
    return isspace((unsigned char)c) || c == ',' || c == '(' || c == ')';
}

bool dea_netlist_token(const char **cursor, char token[DEA_TOKEN_MAX]) {
    const char *c = *cursor;
    while (*c != '\0' && separates(*c))
        c++;
    if (*c == '\0')
        return false;
    const char *start = c;
    if (*c == '=')
        c++;
    else
        while (*c != '\0' && *c != '=' && !separates(*c))
            c += held_together(c);
    size_t length = (size_t)(c - start);
    if (length >= DEA_TOKEN_MAX)
        length = DEA_TOKEN_MAX - 1;
    for (size_t i = 0; i < length; i++)
        token[i] = (char)tolower((unsigned char)start[i]);
    token[length] = '\0';
    *cursor = c;
    return true;
}

bool dea_spice_number(const char *text, double *value) {
    static const struct {
        const char *suffix;
        double factor;
    } suffixes[] = {{"meg", 1e6}, {"mil", 25.4e-6}, {"t", 1e12},  {"g", 1e9},   {"k", 1e3},  {"m", 1e-3},
                    {"u", 1e-6},  {"n", 1e-9},      {"p", 1e-12}, {"f", 1e-15}, {"a", 1e-18}};
    const char *c = text + (*text == '+' || *text == '-');
    if (!isdigit((unsigned char)*c) && !(*c == '.' && isdigit((unsigned char)c[1])))
        return false;
    if (c[0] == '0' && (c[1] == 'x' || c[1] == 'X')) /* strtod would read hexadecimal */
        return false;
    char *end;
    double number = strtod(text, &end);
    for (size_t i = 0; i < sizeof suffixes / sizeof suffixes[0]; i++)
        if (strncasecmp(end, suffixes[i].suffix, strlen(suffixes[i].suffix)) == 0) {
            number *= suffixes[i].factor;
            break;
        }
    for (; *end != '\0'; end++)
        if (!isalpha((unsigned char)*end))
            return false;
    *value = number;
    return number - number == 0.0; /* finite */
}

enum dea_status dea_netlist_read(const char *path, const struct dea_netlist_options *options,
                                 struct dea_netlist *netlist, struct dea_error *error) {
    memset(netlist, 0, sizeof *netlist);
    struct dea_netlist_job job = {.options = options, .netlist = netlist, .error = error};
    enum dea_status status = dea_netlist_read_files(&job, path);
    if (status == DEA_OK)
        status = dea_netlist_vet(&job);
    if (status == DEA_OK)
        status = dea_netlist_check_functions(&job);
    if (status == DEA_OK)
        status = dea_netlist_find(&job);
    if (status == DEA_OK)
        status = dea_netlist_find_devices(&job);
    return status;
}

static void free_texts(char **texts, int count) {
    for (int i = 0; i < count; i++)
        free(texts[i]);
    free(texts);
}

void dea_netlist_clear(struct dea_netlist *netlist) {
    free(netlist->folder);
    free_texts(netlist->files, netlist->file_count);
    free_texts(netlist->measures, netlist->measure_count);
    free_texts(netlist->warnings, netlist->warning_count);
    for (int i = 0; i < netlist->line_count; i++)
        free(netlist->lines[i].text);
    free(netlist->lines);
    for (int i = 0; i < netlist->initial_count; i++)
        free(netlist->initials[i].node);
    free(netlist->initials);
    for (int i = 0; i < netlist->instance_count; i++) {
        free(netlist->instances[i].path);
        for (int pin = 0; pin < DEA_PORT_PINS; pin++)
            free(netlist->instances[i].nodes[pin]);
    }
    free(netlist->instances);
    memset(netlist, 0, sizeof *netlist);
}
