/* YAML text as a tree of nodes that know where they were written. Knows nothing of scenes. */
#ifndef DEASIM_YAML_TREE_H
#define DEASIM_YAML_TREE_H

#include "deasim/status.h"

#include <stdbool.h>
#include <stddef.h>

#define DEA_TREE_MAX_FILE_BYTES ((size_t)16 << 20)
#define DEA_TREE_MAX_DEPTH 64
#define DEA_TREE_MAX_NODES 1000000 /* all files and alias copies of one tree together */
#define DEA_TREE_MAX_KEYS 1000     /* of one mapping */
#define DEA_TREE_MAX_ANCHORS 256   /* of one file */

enum dea_node_kind { DEA_NODE_SCALAR, DEA_NODE_LIST, DEA_NODE_MAPPING };

/* A text that nodes come from: a file, or one `--set key=value`. */
struct dea_text {
    const char *path; /* as shown in messages */
    const char *text;
    size_t size;      /* bytes */
    bool is_override; /* not a file: no line, column and caret in messages */
};

struct dea_node {
    enum dea_node_kind kind;
    const struct dea_text *origin;
    int line, column;        /* from 1; column in characters */
    const char *text;        /* scalar: its value */
    bool quoted;             /* scalar: was in quotes or a block, hence never null */
    bool is_file_root;       /* top of a file: paths in messages start here */
    struct dea_node **items; /* list: entries; mapping: values */
    struct dea_node **keys;  /* mapping: scalars */
    size_t count, room;      /* of items and keys */
    struct dea_node *parent; /* NULL at the top */
};

/* Owns every node and text; freed as a whole. Zero it before use. */
struct dea_tree {
    struct dea_tree_block *blocks;
    size_t node_count;
};

void dea_tree_clear(struct dea_tree *tree);

/* Reads a YAML file. `named_by` is the node that names the file (for messages), NULL when the command line does. */
enum dea_status dea_tree_read_file(struct dea_tree *tree, const char *path, const struct dea_node *named_by,
                                   struct dea_node **root, struct dea_error *error);

/* Reads `value` as YAML, as the value of `--set key=value`. */
enum dea_status dea_tree_read_override(struct dea_tree *tree, const char *key, const char *value,
                                       struct dea_node **root, struct dea_error *error);

/* Makes an empty node that says it came from where `like` did. */
enum dea_status dea_tree_new_node(struct dea_tree *tree, enum dea_node_kind kind, const struct dea_node *like,
                                  struct dea_node **node, struct dea_error *error);

/* Appends to a list (`key` NULL) or mapping. The item's parent becomes `node`. */
enum dea_status dea_tree_append(struct dea_tree *tree, struct dea_node *node, struct dea_node *key,
                                struct dea_node *item, struct dea_error *error);

/* A copy of the text that lives as long as the tree; NULL when out of memory. */
char *dea_tree_copy_text(struct dea_tree *tree, const char *text, size_t length);

/* ---- looking at nodes ---- */

/* Index of a key in a mapping; `count` when it is not there or `mapping` is none. */
size_t dea_node_find(const struct dea_node *mapping, const char *key);

/* Value of a key in a mapping, NULL when it is not there, when `--set` has taken it away, or when `mapping` is none. */
struct dea_node *dea_node_get(const struct dea_node *mapping, const char *key);

/* The path a scalar names, relative to the folder of the file it stands in (an override: the working folder). malloc'd;
 * NULL when out of memory. */
char *dea_node_resolve_path(const struct dea_node *node);

/* true for an unquoted empty text, ~ or null. */
bool dea_node_is_null(const struct dea_node *node);

/* "text 'abc'", "a list", "a mapping", "nothing": for messages. Returns buffer. */
const char *dea_node_describe(const struct dea_node *node, char *buffer, size_t size);

/* Dotted path of a node within its file ("geometry.width", "branches.0.tau"); that of the mapping for a key node. */
const char *dea_node_path(const struct dea_node *node, char *buffer, size_t size);

/* Records "file:line:column: key: message", the line and a caret. Returns DEA_ERR_INPUT. */
enum dea_status dea_node_fail(const struct dea_node *node, struct dea_error *error, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* Records "file:line:column: message", the line and a caret, for a place rather than a node. */
enum dea_status dea_text_fail(const struct dea_text *origin, int line, int column, const char *key,
                              struct dea_error *error, const char *message);

#endif
