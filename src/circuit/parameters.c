/* Parameters of plain netlists. */
#include "circuit/parameters.h"

#include "circuit/expression.h"
#include "circuit/netlist_internal.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#define NUMBER_ROOM 32 /* bytes of a number with 17 digits */

/* The value of lower-case text, with or without the brackets or quotes around it. */
static bool evaluate(const struct dea_parameters *parameters, const char *text, size_t length, double *value) {
    char inner[DEA_TOKEN_MAX];
    struct expression expression;
    const struct row_names names = {.names = (const char *const *)parameters->names, .count = parameters->count};
    if (length >= 2 && ((text[0] == '{' && text[length - 1] == '}') || (text[0] == '\'' && text[length - 1] == '\''))) {
        text++;
        length -= 2;
    }
    if (length >= sizeof inner)
        return false;
    for (size_t i = 0; i < length; i++)
        inner[i] = (char)tolower((unsigned char)text[i]);
    inner[length] = '\0';
    if (!expression_read_parameters(&expression, inner, &names))
        return false;
    *value = expression_evaluate(&expression, parameters->values);
    return isfinite(*value);
}

/* Names ngspice gives a meaning of its own. */
static bool is_reserved(const char *name) {
    static const char *const reserved[] = {
        "and", "or", "not", "div", "mod",  "defined", "pi",   "e",    "c",      "time",  "temper",  "hertz",
        "vt",  "i",  "yes", "no",  "true", "false",   "gmin", "temp", "kelvin", "boltz", "echarge", "planck"};
    for (size_t i = 0; i < sizeof reserved / sizeof reserved[0]; i++)
        if (strcmp(name, reserved[i]) == 0)
            return true;
    return false;
}

/* "name=value", a new name. */
static bool add(struct dea_parameters *parameters, const char *name, const char *value) {
    bool good = isalpha((unsigned char)name[0]) &&
                name[strspn(name, "abcdefghijklmnopqrstuvwxyz0123456789_")] == '\0' && !is_reserved(name) &&
                parameters->count < DEA_PARAMETERS_MAX &&
                evaluate(parameters, value, strlen(value), &parameters->values[parameters->count]);
    for (int i = 0; i < parameters->count && good; i++)
        good = strcmp(parameters->names[i], name) != 0;
    if (good)
        good = (parameters->names[parameters->count] = strdup(name)) != NULL;
    parameters->count += good ? 1 : 0;
    return good;
}

bool dea_parameters_read(struct dea_parameters *parameters, const struct dea_netlist *netlist) {
    *parameters = (struct dea_parameters){.count = 0};
    for (int i = 1; i < netlist->line_count; i++) {
        const char *rest = netlist->lines[i].text;
        char word[DEA_TOKEN_MAX], equals[DEA_TOKEN_MAX], value[DEA_TOKEN_MAX];
        if (!netlist->lines[i].passed || strncasecmp(rest, ".param", 6) != 0)
            continue;
        /* brackets and commas would be lost between words */
        if (rest[strcspn(rest, "(),\"")] != '\0' || !dea_netlist_token(&rest, word) || strcmp(word, ".param") != 0)
            return false;
        while (dea_netlist_token(&rest, word))
            if (!dea_netlist_token(&rest, equals) || strcmp(equals, "=") != 0 || !dea_netlist_token(&rest, value) ||
                !add(parameters, word, value))
                return false;
    }
    return true;
}

char *dea_parameters_put_in(const struct dea_parameters *parameters, const char *line) {
    size_t pieces = 1;
    for (const char *c = line; *c != '\0'; c++)
        pieces += *c == '{' || *c == '\'' ? 1 : 0;
    char *text = malloc(strlen(line) + pieces * NUMBER_ROOM), *out = text;
    for (const char *c = line; text != NULL && *c != '\0';) {
        if (*c != '{' && *c != '\'') {
            *out++ = *c++;
            continue;
        }
        const char *end = strchr(c + 1, *c == '{' ? '}' : '\'');
        double value;
        /* a value by itself, not a part of a word */
        bool apart = c > line && strchr(" \t=(,", c[-1]) != NULL && end != NULL && strchr(" \t),", end[1]) != NULL;
        if (!apart || !evaluate(parameters, c, (size_t)(end - c) + 1, &value)) {
            free(text);
            return NULL;
        }
        out += snprintf(out, NUMBER_ROOM, "%.17g", value);
        c = end + 1;
    }
    if (text != NULL)
        *out = '\0';
    return text;
}

void dea_parameters_clear(struct dea_parameters *parameters) {
    for (int i = 0; i < parameters->count; i++)
        free(parameters->names[i]);
    parameters->count = 0;
}
