/* .measure lines on results that ngspice did not compute: the lines become `meas` commands on a loaded raw file. */
#include "circuit/engine_internal.h"
#include "circuit/linear.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

/* Whatever else ngspice's command language knows (; ` $ | < > !) could run something: an untrusted line must not reach
 * it. */
#define HARMLESS "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_.,=()+-*/'# \t"

static bool is_measure(const struct dea_netlist_line *line) {
    return line->passed && strncasecmp(line->text, ".meas", 5) == 0;
}

/* Names that are neither functions nor part of a number would be parameters, which only ngspice's parser knows. */
static bool names_parameter(const char *expression, const char *end) {
    for (const char *c = expression; c < end; c++) {
        if (isdigit((unsigned char)*c) || *c == '.') { /* 22meg, 1e-3 */
            while (c + 1 < end && (isalnum((unsigned char)c[1]) || c[1] == '.'))
                c++;
        } else if (isalpha((unsigned char)*c)) {
            const char *name = c;
            while (c < end && (isalnum((unsigned char)*c) || *c == '_'))
                c++;
            if (c == end || *c != '(')
                return true;
            if (c - name == 1 && strchr("vViI", *name) != NULL) /* what stands in v(..) is a node */
                while (c < end && *c != ')')
                    c++;
        }
    }
    return false;
}

/* The expression of a par('...') in the text; *after is behind the closing bracket. */
static const char *find_expression(const char *text, const char **start, const char **end, const char **after) {
    const char *par = strcasestr(text, "par('");
    if (par == NULL)
        return NULL;
    *start = par + strlen("par('");
    *end = strchr(*start, '\'');
    *after = *end != NULL ? strchr(*end, ')') : NULL;
    if (*after == NULL)
        return NULL;
    (*after)++;
    return par;
}

bool dea_measures_movable(const struct dea_netlist *netlist) {
    for (int i = 1; i < netlist->line_count; i++) {
        const char *text = netlist->lines[i].text;
        if (!is_measure(&netlist->lines[i]))
            continue;
        if (strlen(text) > DEA_COMMAND_MAX / 2 || text[strspn(text, HARMLESS)] != '\0' ||
            strcasestr(text, "param") != NULL)
            return false;
        const char *start, *end, *after;
        for (const char *rest = text; strcasestr(rest, "par(") != NULL; rest = after)
            if (find_expression(rest, &start, &end, &after) == NULL || names_parameter(start, end))
                return false;
    }
    return true;
}

/* One line: expressions become vectors first. */
static void measure_line(const char *text, int *vectors) {
    char line[DEA_COMMAND_MAX], let[DEA_COMMAND_MAX];
    snprintf(line, sizeof line, "meas%s", text + strcspn(text, " \t"));
    const char *start, *end, *after, *par;
    while ((par = find_expression(line, &start, &end, &after)) != NULL) {
        snprintf(let, sizeof let, "let dea_expression_%d = %.*s", *vectors, (int)(end - start), start);
        dea_engine_command(let);
        char shortened[DEA_COMMAND_MAX];
        int head = (int)(par - line);
        snprintf(shortened, sizeof shortened, "%.*sdea_expression_%d%s", head, line, (*vectors)++, after);
        memcpy(line, shortened, sizeof line);
    }
    dea_engine_command(line); /* its return code says nothing; a measure that fails keeps its mark */
}

enum dea_status dea_engine_measure_file(struct dea_engine *engine, const char *raw_path, struct dea_error *error) {
    char load[DEA_COMMAND_MAX];
    if (snprintf(load, sizeof load, "load %s", raw_path) >= (int)sizeof load)
        return dea_fail(error, DEA_ERR_INTERNAL, "the path %s is too long", raw_path);
    dea_engine_command(load);
    engine->complaints.measuring = true;
    int vectors = 0;
    for (int i = 1; i < engine->netlist->line_count; i++)
        if (is_measure(&engine->netlist->lines[i]))
            measure_line(engine->netlist->lines[i].text, &vectors);
    engine->complaints.measuring = false;
    return DEA_OK;
}
