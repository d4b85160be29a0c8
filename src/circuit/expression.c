/* Expressions of parameters, or of a circuit's unknowns in .measure lines. */
#include "circuit/expression.h"

#include "circuit/netlist.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define NAME_MAX_LENGTH 255
#define DEPTH_MAX 50 /* of brackets and signs */

struct parser {
    struct expression *expression;
    const struct row_names *names;
    const char *at;
    bool parameters; /* names are those of parameters */
    int depth;
};

static bool put(struct expression *expression, enum operation operation, int value, double number) {
    if (expression->count == EXPRESSION_MAX)
        return false;
    expression->terms[expression->count].operation = operation;
    expression->terms[expression->count].value = value;
    expression->terms[expression->count++].number = number;
    return true;
}

static void skip_blanks(struct parser *parser) {
    parser->at += strspn(parser->at, " \t");
}

static bool take(struct parser *parser, char wanted) {
    skip_blanks(parser);
    if (*parser->at != wanted)
        return false;
    parser->at++;
    return true;
}

static bool put_named(struct parser *parser, const char *name) {
    for (int i = 0; i < parser->names->count; i++)
        if (strcmp(parser->names->names[i], name) == 0)
            return put(parser->expression, PUT_VALUE, i, 0.0);
    return false;
}

/* v(node) or i(source). Ground and differences of two nodes are not, as for ngspice. */
static bool read_value(struct parser *parser) {
    char kind = *parser->at++, name[NAME_MAX_LENGTH + sizeof "#branch"];
    if (!take(parser, '('))
        return false;
    skip_blanks(parser);
    size_t length = strcspn(parser->at, " \t(),");
    if (length == 0 || length > NAME_MAX_LENGTH)
        return false;
    snprintf(name, sizeof name, "%.*s%s", (int)length, parser->at, kind == 'i' ? "#branch" : "");
    parser->at += length;
    return take(parser, ')') && strcmp(name, "0") != 0 && put_named(parser, name);
}

static bool read_parameter(struct parser *parser) {
    char name[NAME_MAX_LENGTH + 1];
    size_t length = strspn(parser->at, "abcdefghijklmnopqrstuvwxyz0123456789_");
    if (length > NAME_MAX_LENGTH)
        return false;
    snprintf(name, sizeof name, "%.*s", (int)length, parser->at);
    parser->at += length;
    return put_named(parser, name);
}

/* Units and other letters behind a suffix are not read alike everywhere in ngspice. */
static bool ends_plainly(const char *number) {
    static const char *const suffixes[] = {"", "t", "g", "meg", "k", "m", "u", "n", "p", "f"};
    char *end;
    strtod(number, &end);
    for (size_t i = 0; i < sizeof suffixes / sizeof suffixes[0]; i++)
        if (strcmp(end, suffixes[i]) == 0)
            return true;
    return false;
}

static bool read_number(struct parser *parser) {
    char text[64];
    size_t length = 0;
    const char *c = parser->at;
    while (isalnum((unsigned char)c[length]) || c[length] == '.' ||
           (length > 0 && strchr("+-", c[length]) != NULL && c[length] != '\0' && c[length - 1] == 'e' &&
            isdigit((unsigned char)c[length + 1])))
        length++;
    double number;
    snprintf(text, sizeof text, "%.*s", (int)length, c);
    if (length >= sizeof text || !dea_spice_number(text, &number) || !ends_plainly(text))
        return false;
    parser->at += length;
    return put(parser->expression, PUT_NUMBER, 0, number);
}

static bool read_sum(struct parser *parser);

static bool read_factor(struct parser *parser) {
    bool good;
    if (++parser->depth > DEPTH_MAX)
        return false;
    skip_blanks(parser);
    if (take(parser, '+'))
        good = read_factor(parser);
    else if (take(parser, '-'))
        good = read_factor(parser) && put(parser->expression, NEGATE, 0, 0.0);
    else if (take(parser, '('))
        good = read_sum(parser) && take(parser, ')');
    else if (parser->parameters && isalpha((unsigned char)*parser->at))
        good = read_parameter(parser);
    else if ((*parser->at == 'v' || *parser->at == 'i') && !isalnum((unsigned char)parser->at[1]))
        good = read_value(parser);
    else
        good = read_number(parser);
    parser->depth--;
    return good;
}

static bool read_product(struct parser *parser) {
    bool good = read_factor(parser);
    for (;;) {
        if (good && take(parser, '*'))
            good = read_factor(parser) && put(parser->expression, MULTIPLY, 0, 0.0);
        else if (good && take(parser, '/'))
            good = read_factor(parser) && put(parser->expression, DIVIDE, 0, 0.0);
        else
            return good;
    }
}

static bool read_sum(struct parser *parser) {
    bool good = read_product(parser);
    for (;;) {
        if (good && take(parser, '+'))
            good = read_product(parser) && put(parser->expression, ADD, 0, 0.0);
        else if (good && take(parser, '-'))
            good = read_product(parser) && put(parser->expression, SUBTRACT, 0, 0.0);
        else
            return good;
    }
}

static bool read_whole(struct expression *expression, const char *text, const struct row_names *names,
                       bool parameters) {
    struct parser parser = {.expression = expression, .names = names, .at = text, .parameters = parameters};
    expression->count = 0;
    if (!read_sum(&parser))
        return false;
    skip_blanks(&parser);
    return *parser.at == '\0';
}

bool expression_read(struct expression *expression, const char *text, const struct row_names *names) {
    return read_whole(expression, text, names, false);
}

bool expression_read_parameters(struct expression *expression, const char *text, const struct row_names *names) {
    return read_whole(expression, text, names, true);
}

bool expression_read_signal(struct expression *expression, const char *text, const struct row_names *names) {
    struct parser parser = {.expression = expression, .names = names, .at = text};
    expression->count = 0;
    if (strncmp(text, "par('", 5) != 0)
        return (*text == 'v' || *text == 'i') && read_value(&parser) && *parser.at == '\0';
    const char *end = strchr(text + 5, '\'');
    char inner[1024];
    if (end == NULL || strcmp(end, "')") != 0 || end - text - 5 >= (long)sizeof inner)
        return false;
    snprintf(inner, sizeof inner, "%.*s", (int)(end - text - 5), text + 5);
    return expression_read(expression, inner, names);
}

bool expression_subtract_number(struct expression *expression, double number) {
    return put(expression, PUT_NUMBER, 0, number) && put(expression, SUBTRACT, 0, 0.0);
}

bool expression_subtract(struct expression *expression, const struct expression *other) {
    for (int i = 0; i < other->count; i++)
        if (!put(expression, other->terms[i].operation, other->terms[i].value, other->terms[i].number))
            return false;
    return put(expression, SUBTRACT, 0, 0.0);
}

double expression_evaluate(const struct expression *expression, const double *row) {
    double stack[EXPRESSION_MAX + 1] = {0.0};
    int top = -1;
    for (int i = 0; i < expression->count; i++) {
        switch (expression->terms[i].operation) {
        case PUT_NUMBER:
            stack[++top] = expression->terms[i].number;
            break;
        case PUT_VALUE:
            stack[++top] = row[expression->terms[i].value];
            break;
        case ADD:
            top--;
            stack[top] += stack[top + 1];
            break;
        case SUBTRACT:
            top--;
            stack[top] -= stack[top + 1];
            break;
        case MULTIPLY:
            top--;
            stack[top] *= stack[top + 1];
            break;
        case DIVIDE:
            top--;
            stack[top] /= stack[top + 1];
            break;
        case NEGATE:
            stack[top] = -stack[top];
            break;
        }
    }
    return stack[0];
}
