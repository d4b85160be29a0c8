/* Builds the tree from libyaml's events, with limits that no file can make it exceed. */
#include "scene/yaml_tree.h"

#include <errno.h>
#include <fcntl.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>
#include <yaml.h>

/* ---- memory: blocks that are freed together ---- */

struct dea_tree_block {
    struct dea_tree_block *next;
    size_t used, size; /* bytes behind this header */
};

static void *allocate(struct dea_tree *tree, size_t size) {
    size = (size + 15) & ~(size_t)15;
    struct dea_tree_block *block = tree->blocks;
    if (block == NULL || block->size - block->used < size) {
        size_t room = size > 65536 ? size : 65536;
        block = malloc(sizeof *block + 16 + room);
        if (block == NULL)
            return NULL;
        *block = (struct dea_tree_block){.next = tree->blocks, .used = 0, .size = room};
        tree->blocks = block;
    }
    uintptr_t start = ((uintptr_t)(block + 1) + 15) & ~(uintptr_t)15;
    void *memory = (void *)(start + block->used);
    block->used += size;
    return memset(memory, 0, size);
}

void dea_tree_clear(struct dea_tree *tree) {
    for (struct dea_tree_block *next, *block = tree->blocks; block != NULL; block = next) {
        next = block->next;
        free(block);
    }
    *tree = (struct dea_tree){0};
}

char *dea_tree_copy_text(struct dea_tree *tree, const char *text, size_t length) {
    char *copy = allocate(tree, length + 1);
    if (copy != NULL)
        memcpy(copy, text, length);
    return copy;
}

static enum dea_status out_of_memory(struct dea_error *error) {
    return dea_fail(error, DEA_ERR_MEMORY, "out of memory while reading YAML");
}

static const char too_many_values[] = "more than 1000000 values (aliases count as often as they are used)";

static enum dea_status new_node(struct dea_tree *tree, enum dea_node_kind kind, const struct dea_text *origin, int line,
                                int column, struct dea_node **node, struct dea_error *error) {
    if (tree->node_count >= DEA_TREE_MAX_NODES)
        return dea_text_fail(origin, line, column, "", error, too_many_values);
    tree->node_count++;
    *node = allocate(tree, sizeof **node);
    if (*node == NULL)
        return out_of_memory(error);
    **node = (struct dea_node){.kind = kind, .origin = origin, .line = line, .column = column, .text = ""};
    return DEA_OK;
}

enum dea_status dea_tree_new_node(struct dea_tree *tree, enum dea_node_kind kind, const struct dea_node *like,
                                  struct dea_node **node, struct dea_error *error) {
    return new_node(tree, kind, like->origin, like->line, like->column, node, error);
}

enum dea_status dea_tree_append(struct dea_tree *tree, struct dea_node *node, struct dea_node *key,
                                struct dea_node *item, struct dea_error *error) {
    if (node->count == node->room) {
        size_t room = node->room > 0 ? 2 * node->room : 4;
        struct dea_node **items = allocate(tree, room * sizeof *items);
        struct dea_node **keys = allocate(tree, key != NULL ? room * sizeof *keys : 0);
        if (items == NULL || keys == NULL)
            return out_of_memory(error);
        if (node->count > 0) {
            memcpy(items, node->items, node->count * sizeof *items);
            if (key != NULL)
                memcpy(keys, node->keys, node->count * sizeof *keys);
        }
        node->items = items;
        node->keys = key != NULL ? keys : NULL;
        node->room = room;
    }
    if (key != NULL) {
        key->parent = node;
        node->keys[node->count] = key;
    }
    item->parent = node;
    node->items[node->count++] = item;
    return DEA_OK;
}

size_t dea_node_find(const struct dea_node *mapping, const char *key) {
    size_t i = 0;
    if (mapping->kind != DEA_NODE_MAPPING)
        return mapping->count;
    while (i < mapping->count && strcmp(mapping->keys[i]->text, key) != 0)
        i++;
    return i;
}

/* What `--set key=null` leaves where there was no such key: the null, and the mappings made on the way to it. */
static bool is_nothing_set(const struct dea_node *node) {
    if (!node->origin->is_override || node->kind != DEA_NODE_MAPPING)
        return node->origin->is_override && dea_node_is_null(node);
    size_t nothing = 0;
    while (nothing < node->count && is_nothing_set(node->items[nothing]))
        nothing++;
    return nothing > 0 && nothing == node->count;
}

struct dea_node *dea_node_get(const struct dea_node *mapping, const char *key) {
    size_t i = dea_node_find(mapping, key);
    return i < mapping->count && !is_nothing_set(mapping->items[i]) ? mapping->items[i] : NULL;
}

bool dea_node_is_null(const struct dea_node *node) {
    static const char *const spellings[] = {"", "~", "null", "Null", "NULL"};
    if (node->kind != DEA_NODE_SCALAR || node->quoted)
        return false;
    for (size_t i = 0; i < sizeof spellings / sizeof spellings[0]; i++)
        if (strcmp(node->text, spellings[i]) == 0)
            return true;
    return false;
}

/* ---- parsing ---- */

struct anchor {
    const char *name;
    struct dea_node *node;
    bool complete; /* false while its node is still being built: an alias then is circular */
};

struct parse {
    struct dea_tree *tree;
    const struct dea_text *origin;
    struct dea_error *error;
    yaml_parser_t parser;
    yaml_event_t event; /* the current one */
    bool has_event;
    struct anchor anchors[DEA_TREE_MAX_ANCHORS];
    size_t anchor_count;
};

static enum dea_status fail_at(struct parse *parse, const yaml_mark_t *mark, const char *message) {
    return dea_text_fail(parse->origin, (int)mark->line + 1, (int)mark->column + 1, "", parse->error, message);
}

/* libyaml's own complaint, with its place. */
static enum dea_status fail_syntax(struct parse *parse) {
    const yaml_parser_t *parser = &parse->parser;
    const char *problem = parser->problem != NULL ? parser->problem : "cannot be parsed";
    char message[512];
    if (parser->error == YAML_MEMORY_ERROR)
        return out_of_memory(parse->error);
    if (parser->error == YAML_READER_ERROR)
        return dea_fail(parse->error, DEA_ERR_INPUT, "%s: not a YAML text file: %s (byte %zu)", parse->origin->path,
                        problem, parser->problem_offset);
    const yaml_mark_t *mark = &parser->problem_mark;
    bool tab = strcmp(problem, "found character that cannot start any token") == 0 &&
               memchr(parse->origin->text, '\t', parse->origin->size) != NULL;
    char context[200] = "";
    if (parser->context != NULL)
        snprintf(context, sizeof context, "%s from line %zu, ", parser->context, parser->context_mark.line + 1);
    snprintf(message, sizeof message, "not valid YAML: %s%s%s", context, problem,
             tab ? " (a tab? indent with spaces)" : "");
    return fail_at(parse, mark, message);
}

static enum dea_status next_event(struct parse *parse) {
    if (parse->has_event)
        yaml_event_delete(&parse->event);
    parse->has_event = yaml_parser_parse(&parse->parser, &parse->event) != 0;
    return parse->has_event ? DEA_OK : fail_syntax(parse);
}

static enum dea_status remember_anchor(struct parse *parse, const yaml_char_t *name, struct dea_node *node,
                                       size_t *index) {
    *index = SIZE_MAX;
    if (name == NULL)
        return DEA_OK;
    if (parse->anchor_count == DEA_TREE_MAX_ANCHORS)
        return fail_at(parse, &parse->event.start_mark, "more than 256 anchors");
    const char *text = (const char *)name;
    char *copy = dea_tree_copy_text(parse->tree, text, strlen(text));
    if (copy == NULL)
        return out_of_memory(parse->error);
    *index = parse->anchor_count;
    parse->anchors[parse->anchor_count++] = (struct anchor){copy, node, false};
    return DEA_OK;
}

static enum dea_status copy_node(struct parse *parse, const struct dea_node *from, struct dea_node **copy) {
    DEA_TRY(dea_tree_new_node(parse->tree, from->kind, from, copy, parse->error));
    (*copy)->text = from->text;
    (*copy)->quoted = from->quoted;
    for (size_t i = 0; i < from->count; i++) {
        struct dea_node *item, *key = NULL;
        if (from->keys != NULL)
            DEA_TRY(copy_node(parse, from->keys[i], &key));
        DEA_TRY(copy_node(parse, from->items[i], &item));
        DEA_TRY(dea_tree_append(parse->tree, *copy, key, item, parse->error));
    }
    return DEA_OK;
}

/* Levels of a node and all below it; adds their number, keys included, to *count. */
static int measure_node(const struct dea_node *node, size_t *count) {
    int depth = 0;
    *count += node->keys != NULL ? 1 + node->count : 1;
    for (size_t i = 0; i < node->count; i++) {
        int below = measure_node(node->items[i], count);
        depth = below > depth ? below : depth;
    }
    return depth + 1;
}

static enum dea_status parse_alias(struct parse *parse, int depth, struct dea_node **node) {
    const char *name = (const char *)parse->event.data.alias.anchor;
    const yaml_mark_t *mark = &parse->event.start_mark;
    char message[160];
    for (size_t i = parse->anchor_count; i-- > 0;) {
        const struct anchor *anchor = &parse->anchors[i];
        if (strcmp(anchor->name, name) != 0)
            continue;
        snprintf(message, sizeof message, "alias '*%.60s' stands inside its own anchor: circular", name);
        if (!anchor->complete)
            return fail_at(parse, mark, message);
        size_t count = parse->tree->node_count;
        if (depth + measure_node(anchor->node, &count) > DEA_TREE_MAX_DEPTH)
            return fail_at(parse, mark, "nested deeper than 64 levels");
        if (count > DEA_TREE_MAX_NODES)
            return fail_at(parse, mark, too_many_values);
        return copy_node(parse, anchor->node, node);
    }
    snprintf(message, sizeof message, "alias '*%.60s' has no anchor '&%.60s' before it", name, name);
    return fail_at(parse, mark, message);
}

static enum dea_status parse_node(struct parse *parse, int depth, struct dea_node **node);

static enum dea_status parse_scalar(struct parse *parse, struct dea_node **node) {
    const yaml_event_t *event = &parse->event;
    const yaml_mark_t *mark = &event->start_mark;
    size_t anchor;
    const char *value = (const char *)event->data.scalar.value;
    size_t length = event->data.scalar.length;
    if (strlen(value) != length)
        return fail_at(parse, mark, "a text contains a NUL character");
    DEA_TRY(new_node(parse->tree, DEA_NODE_SCALAR, parse->origin, (int)mark->line + 1, (int)mark->column + 1, node,
                     parse->error));
    (*node)->text = dea_tree_copy_text(parse->tree, value, length);
    (*node)->quoted = event->data.scalar.style != YAML_PLAIN_SCALAR_STYLE;
    if ((*node)->text == NULL)
        return out_of_memory(parse->error);
    DEA_TRY(remember_anchor(parse, event->data.scalar.anchor, *node, &anchor));
    if (anchor != SIZE_MAX)
        parse->anchors[anchor].complete = true;
    return DEA_OK;
}

/* A key is on `parse->event`; appends key and value. */
static enum dea_status parse_entry(struct parse *parse, int depth, struct dea_node *mapping) {
    struct dea_node *key, *value;
    if (parse->event.type != YAML_SCALAR_EVENT)
        return fail_at(parse, &parse->event.start_mark, "a key must be plain text");
    DEA_TRY(parse_scalar(parse, &key));
    key->parent = mapping;
    size_t known = dea_node_find(mapping, key->text);
    if (known < mapping->count)
        return dea_node_fail(key, parse->error, "duplicate key '%.80s'; already given on line %d", key->text,
                             mapping->keys[known]->line);
    if (mapping->count == DEA_TREE_MAX_KEYS)
        return dea_node_fail(key, parse->error, "more than 1000 keys in one mapping");
    DEA_TRY(next_event(parse));
    DEA_TRY(parse_node(parse, depth + 1, &value));
    return dea_tree_append(parse->tree, mapping, key, value, parse->error);
}

/* A list or mapping start is on `parse->event`; consumes up to its end. */
static enum dea_status parse_collection(struct parse *parse, int depth, struct dea_node **node) {
    const yaml_event_t *event = &parse->event;
    bool is_mapping = event->type == YAML_MAPPING_START_EVENT;
    const yaml_mark_t mark = event->start_mark;
    size_t anchor;
    if (depth >= DEA_TREE_MAX_DEPTH)
        return fail_at(parse, &mark, "nested deeper than 64 levels");
    DEA_TRY(new_node(parse->tree, is_mapping ? DEA_NODE_MAPPING : DEA_NODE_LIST, parse->origin, (int)mark.line + 1,
                     (int)mark.column + 1, node, parse->error));
    DEA_TRY(remember_anchor(parse, is_mapping ? event->data.mapping_start.anchor : event->data.sequence_start.anchor,
                            *node, &anchor));
    DEA_TRY(next_event(parse));
    while (event->type != YAML_MAPPING_END_EVENT && event->type != YAML_SEQUENCE_END_EVENT) {
        if (is_mapping) {
            DEA_TRY(parse_entry(parse, depth, *node));
        } else {
            struct dea_node *item;
            DEA_TRY(parse_node(parse, depth + 1, &item));
            DEA_TRY(dea_tree_append(parse->tree, *node, NULL, item, parse->error));
        }
        DEA_TRY(next_event(parse));
    }
    if (anchor != SIZE_MAX)
        parse->anchors[anchor].complete = true;
    return DEA_OK;
}

static enum dea_status parse_node(struct parse *parse, int depth, struct dea_node **node) {
    const yaml_event_t *event = &parse->event;
    const yaml_char_t *tag = event->type == YAML_SCALAR_EVENT           ? event->data.scalar.tag
                             : event->type == YAML_MAPPING_START_EVENT  ? event->data.mapping_start.tag
                             : event->type == YAML_SEQUENCE_START_EVENT ? event->data.sequence_start.tag
                                                                        : NULL;
    if (tag != NULL && strcmp((const char *)tag, "!") != 0)
        return fail_at(parse, &event->start_mark, "YAML tags ('!...') have no meaning here");
    switch (event->type) {
    case YAML_SCALAR_EVENT:
        return parse_scalar(parse, node);
    case YAML_ALIAS_EVENT:
        return parse_alias(parse, depth, node);
    case YAML_MAPPING_START_EVENT:
    case YAML_SEQUENCE_START_EVENT:
        return parse_collection(parse, depth, node);
    default:
        return fail_at(parse, &event->start_mark, "not valid YAML: a value is missing");
    }
}

static enum dea_status parse_document(struct parse *parse, struct dea_node **root) {
    DEA_TRY(next_event(parse)); /* stream start */
    DEA_TRY(next_event(parse));
    if (parse->event.type != YAML_DOCUMENT_START_EVENT)
        return dea_fail(parse->error, DEA_ERR_INPUT, "%s: holds no keys", parse->origin->path);
    DEA_TRY(next_event(parse));
    DEA_TRY(parse_node(parse, 0, root));
    DEA_TRY(next_event(parse)); /* document end */
    DEA_TRY(next_event(parse));
    if (parse->event.type != YAML_STREAM_END_EVENT)
        return fail_at(parse, &parse->event.start_mark, "a second YAML document ('---'); only one is read");
    return DEA_OK;
}

static enum dea_status parse_text(struct dea_tree *tree, const struct dea_text *origin, struct dea_node **root,
                                  struct dea_error *error) {
    struct parse *parse = calloc(1, sizeof *parse);
    if (parse == NULL)
        return out_of_memory(error);
    parse->tree = tree;
    parse->origin = origin;
    parse->error = error;
    if (!yaml_parser_initialize(&parse->parser)) {
        free(parse);
        return out_of_memory(error);
    }
    yaml_parser_set_input_string(&parse->parser, (const unsigned char *)origin->text, origin->size);
    enum dea_status status = parse_document(parse, root);
    if (parse->has_event)
        yaml_event_delete(&parse->event);
    yaml_parser_delete(&parse->parser);
    free(parse);
    return status;
}

/* ---- files ---- */

static enum dea_status refuse_file(const struct dea_node *named_by, const char *path, const char *why,
                                   struct dea_error *error) {
    if (named_by != NULL)
        return dea_node_fail(named_by, error, "cannot read %.200s: %s", path, why);
    return dea_fail(error, DEA_ERR_INPUT, "cannot read %.200s: %s", path, why);
}

static enum dea_status read_open_file(struct dea_tree *tree, int file, const char *path,
                                      const struct dea_node *named_by, struct dea_text *origin,
                                      struct dea_error *error) {
    struct stat info;
    if (fstat(file, &info) != 0)
        return refuse_file(named_by, path, strerror(errno), error);
    if (S_ISDIR(info.st_mode))
        return refuse_file(named_by, path, "it is a directory", error);
    if (!S_ISREG(info.st_mode))
        return refuse_file(named_by, path, "it is not a regular file", error);
    if ((uintmax_t)info.st_size > DEA_TREE_MAX_FILE_BYTES)
        return refuse_file(named_by, path, "it is larger than 16 MB", error);
    if (info.st_size == 0)
        return refuse_file(named_by, path, "it is empty", error);
    size_t size = (size_t)info.st_size, done = 0;
    char *text = allocate(tree, size + 1);
    if (text == NULL)
        return out_of_memory(error);
    while (done < size) {
        ssize_t got = read(file, text + done, size - done);
        if (got < 0 && errno != EINTR)
            return refuse_file(named_by, path, strerror(errno), error);
        if (got == 0)
            break;
        done += got > 0 ? (size_t)got : 0;
    }
    origin->text = text;
    origin->size = done;
    return DEA_OK;
}

enum dea_status dea_tree_read_file(struct dea_tree *tree, const char *path, const struct dea_node *named_by,
                                   struct dea_node **root, struct dea_error *error) {
    struct dea_text *origin = allocate(tree, sizeof *origin);
    if (origin == NULL || (origin->path = dea_tree_copy_text(tree, path, strlen(path))) == NULL)
        return out_of_memory(error);
    int file = open(path, O_RDONLY | O_NONBLOCK | O_CLOEXEC);
    if (file < 0)
        return refuse_file(named_by, path, strerror(errno), error);
    enum dea_status status = read_open_file(tree, file, path, named_by, origin, error);
    close(file);
    DEA_TRY(status);
    DEA_TRY(parse_text(tree, origin, root, error));
    (*root)->is_file_root = true;
    return DEA_OK;
}

enum dea_status dea_tree_read_override(struct dea_tree *tree, const char *key, const char *value,
                                       struct dea_node **root, struct dea_error *error) {
    char label[400];
    snprintf(label, sizeof label, "--set %.160s=%.160s", key, value);
    struct dea_text *origin = allocate(tree, sizeof *origin);
    if (origin == NULL || (origin->path = dea_tree_copy_text(tree, label, strlen(label))) == NULL ||
        (origin->text = dea_tree_copy_text(tree, value, strlen(value))) == NULL)
        return out_of_memory(error);
    origin->size = strlen(value);
    origin->is_override = true;
    if (value[strspn(value, " \t\r\n")] == '\0')
        return dea_fail(error, DEA_ERR_INPUT, "%s: the value is missing", label);
    return parse_text(tree, origin, root, error);
}
