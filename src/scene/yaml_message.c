/* Messages about a place in a YAML text: "file:line:column: key: what", the line, and a caret. */
#include "scene/yaml_tree.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define SHOWN_CHARACTERS 100 /* of a source line */

static bool continues_character(char c) {
    return ((unsigned char)c & 0xC0) == 0x80;
}

/* Start of a line (from 1) in a text; NULL when there is none. */
static const char *find_line(const struct dea_text *origin, int line) {
    const char *p = origin->text, *end = origin->text + origin->size;
    for (int i = 1; i < line && p != NULL; i++) {
        p = memchr(p, '\n', (size_t)(end - p));
        if (p != NULL)
            p++;
    }
    return p != NULL && p < end ? p : NULL;
}

/* Writes "\n  12 | the line\n     |     ^" with the window of the line around the column. */
static void quote_line(const struct dea_text *origin, int line, int column, char *out, size_t size) {
    out[0] = '\0';
    const char *p = find_line(origin, line);
    if (p == NULL)
        return;
    const char *end = origin->text + origin->size;
    int first = column > SHOWN_CHARACTERS * 3 / 4 ? column - SHOWN_CHARACTERS / 2 : 1;
    char text[SHOWN_CHARACTERS * 4 + 1], pad[SHOWN_CHARACTERS + 1];
    size_t length = 0, padding = 0;
    for (int character = 0; p < end && *p != '\n' && *p != '\r'; p++) {
        if (!continues_character(*p))
            character++;
        if (character < first)
            continue;
        if (character >= first + SHOWN_CHARACTERS || length + 1 >= sizeof text)
            break;
        bool printable = (unsigned char)*p >= 0x20 && *p != 0x7F;
        text[length++] = printable ? *p : *p == '\t' ? ' ' : '?';
        if (character < column && !continues_character(*p) && padding + 1 < sizeof pad)
            pad[padding++] = ' ';
    }
    text[length] = pad[padding] = '\0';
    snprintf(out, size, "\n%5d | %s\n      | %s^", line, text, pad);
}

enum dea_status dea_text_fail(const struct dea_text *origin, int line, int column, const char *key,
                              struct dea_error *error, const char *message) {
    const char *separator = key[0] != '\0' ? ": " : "";
    if (origin->is_override)
        return dea_fail(error, DEA_ERR_INPUT, "%s: %s%s%s", origin->path, key, separator, message);
    char quote[SHOWN_CHARACTERS * 6];
    quote_line(origin, line, column, quote, sizeof quote);
    return dea_fail(error, DEA_ERR_INPUT, "%s:%d:%d: %s%s%s%s", origin->path, line, column, key, separator, message,
                    quote);
}

enum dea_status dea_node_fail(const struct dea_node *node, struct dea_error *error, const char *format, ...) {
    char message[1024], key[256];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(message, sizeof message, format, arguments);
    va_end(arguments);
    return dea_text_fail(node->origin, node->line, node->column, dea_node_path(node, key, sizeof key), error, message);
}

const char *dea_node_path(const struct dea_node *node, char *buffer, size_t size) {
    char path[512], longer[512];
    path[0] = '\0';
    while (!node->is_file_root && node->parent != NULL) {
        const struct dea_node *parent = node->parent;
        size_t i = 0;
        while (i < parent->count && parent->items[i] != node)
            i++;
        if (i < parent->count) { /* else a key: the path is that of its mapping */
            const char *dot = path[0] != '\0' ? "." : "";
            if (parent->kind == DEA_NODE_MAPPING)
                snprintf(longer, sizeof longer, "%.80s%s%.400s", parent->keys[i]->text, dot, path);
            else
                snprintf(longer, sizeof longer, "%zu%s%.400s", i, dot, path);
            memcpy(path, longer, sizeof path);
        }
        node = parent;
    }
    snprintf(buffer, size, "%s", path);
    return buffer;
}

const char *dea_node_describe(const struct dea_node *node, char *buffer, size_t size) {
    if (dea_node_is_null(node))
        snprintf(buffer, size, "nothing");
    else if (node->kind == DEA_NODE_LIST)
        snprintf(buffer, size, "a list");
    else if (node->kind == DEA_NODE_MAPPING)
        snprintf(buffer, size, "a mapping");
    else
        snprintf(buffer, size, "'%.60s'", node->text);
    return buffer;
}

char *dea_node_resolve_path(const struct dea_node *node) {
    const char *from = node->origin->is_override || node->text[0] == '/' ? "" : node->origin->path;
    const char *slash = strrchr(from, '/');
    size_t folder = slash != NULL ? (size_t)(slash - from) + 1 : 0, length = strlen(node->text);
    char *path = malloc(folder + length + 1);
    if (path != NULL) {
        memcpy(path, from, folder);
        memcpy(path + folder, node->text, length + 1);
    }
    return path;
}
