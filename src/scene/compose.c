/* One tree from several files. A key given later wins: base file, then the file itself, then `--set`. */
#include "scene/compose.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define MAX_CHAIN 32 /* files that name each other in a row */

/* The files being read, innermost first. */
struct chain {
    const struct chain *up;
    const char *shown; /* path for messages */
    char *canonical;   /* owned; NULL when the file does not exist */
    int length;
};

struct composer {
    struct dea_tree *tree;
    struct dea_error *error;
};

static enum dea_status expand(struct composer *composer, enum dea_file_role role, struct dea_node **slot,
                              const struct chain *chain);

/* ---- naming files ---- */

/* Writes "a.yaml -> b.yaml" for a chain, outermost first. */
static void write_chain(const struct chain *chain, char *text, size_t size) {
    if (chain == NULL)
        return;
    write_chain(chain->up, text, size);
    size_t length = strlen(text);
    snprintf(text + length, size - length, "%s -> ", chain->shown);
}

static enum dea_status refuse_circle(struct composer *composer, const struct chain *chain, const char *path,
                                     const struct dea_node *named_by) {
    char text[700] = "";
    bool circular = chain->length < MAX_CHAIN;
    write_chain(chain, text, sizeof text);
    return dea_node_fail(named_by, composer->error, "%s: %s%s",
                         circular ? "circular reference" : "more than 32 files name each other", text, path);
}

/* Reads one file and expands what it names. */
static enum dea_status load_file(struct composer *composer, enum dea_file_role role, const char *path,
                                 const struct dea_node *named_by, const struct chain *chain, struct dea_node **root) {
    struct chain link = {.up = chain, .shown = path, .length = chain != NULL ? chain->length + 1 : 1};
    link.canonical = realpath(path, NULL);
    enum dea_status status = DEA_OK;
    for (const struct chain *c = chain; c != NULL && link.canonical != NULL && status == DEA_OK; c = c->up)
        if ((c->canonical != NULL && strcmp(c->canonical, link.canonical) == 0) || chain->length >= MAX_CHAIN)
            status = refuse_circle(composer, chain, path, named_by);
    if (status == DEA_OK)
        status = dea_tree_read_file(composer->tree, path, named_by, root, composer->error);
    if (status == DEA_OK && (*root)->kind != DEA_NODE_MAPPING)
        status = dea_node_fail(*root, composer->error, "expected 'key: value' lines%s",
                               (*root)->kind == DEA_NODE_SCALAR ? "; is the space after a ':' missing?" : "");
    if (status == DEA_OK)
        status = expand(composer, role, root, &link);
    free(link.canonical);
    return status;
}

/* Reads the file that a scalar names. */
static enum dea_status load_named(struct composer *composer, enum dea_file_role role, const struct dea_node *named_by,
                                  const struct chain *chain, struct dea_node **root) {
    char found[80];
    if (named_by->kind != DEA_NODE_SCALAR || dea_node_is_null(named_by) || named_by->text[0] == '\0')
        return dea_node_fail(named_by, composer->error, "expected the path of a YAML file, found %s",
                             dea_node_describe(named_by, found, sizeof found));
    char *path = dea_node_resolve_path(named_by);
    char *kept = path != NULL ? dea_tree_copy_text(composer->tree, path, strlen(path)) : NULL;
    free(path);
    if (kept == NULL)
        return dea_fail(composer->error, DEA_ERR_MEMORY, "out of memory while reading YAML");
    return load_file(composer, role, kept, named_by, chain, root);
}

/* ---- base files ---- */

static void remove_entry(struct dea_node *node, size_t index) {
    size_t behind = node->count - index - 1;
    memmove(node->items + index, node->items + index + 1, behind * sizeof *node->items);
    if (node->keys != NULL)
        memmove(node->keys + index, node->keys + index + 1, behind * sizeof *node->keys);
    node->count--;
}

/* true when a mapping stands for itself instead of changing the base's: another law, kind or waveform type, a quantity
 * with its source, or a mapping with a base of its own. */
static bool replaces_whole(const struct dea_node *base, const struct dea_node *own) {
    static const char *const selectors[] = {"law", "kind", "type"};
    if (dea_node_get(own, "base") != NULL || dea_node_get(own, "value") != NULL)
        return true;
    for (size_t i = 0; i < sizeof selectors / sizeof selectors[0]; i++) {
        const struct dea_node *ours = dea_node_get(own, selectors[i]), *theirs = dea_node_get(base, selectors[i]);
        if (ours != NULL && theirs != NULL && strcmp(ours->text, theirs->text) != 0)
            return true;
    }
    return false;
}

/* Adds to `own` what only `base` has; null removes a key of the base. */
static enum dea_status merge_base(struct composer *composer, const struct dea_node *base, struct dea_node *own) {
    for (size_t i = 0; i < base->count; i++) {
        size_t known = dea_node_find(own, base->keys[i]->text);
        struct dea_node *theirs = base->items[i];
        if (known == own->count) {
            DEA_TRY(dea_tree_append(composer->tree, own, base->keys[i], theirs, composer->error));
        } else if (dea_node_is_null(own->items[known])) {
            remove_entry(own, known);
        } else if (own->items[known]->kind == DEA_NODE_MAPPING && theirs->kind == DEA_NODE_MAPPING &&
                   !replaces_whole(theirs, own->items[known])) {
            DEA_TRY(merge_base(composer, theirs, own->items[known]));
        }
    }
    return DEA_OK;
}

/* Replaces `base: path` by the contents of that file. */
static enum dea_status expand_base(struct composer *composer, enum dea_file_role role, struct dea_node *own,
                                   const struct chain *chain) {
    size_t index = dea_node_find(own, "base");
    if (index == own->count)
        return DEA_OK;
    struct dea_node *base;
    DEA_TRY(load_named(composer, role, own->items[index], chain, &base));
    remove_entry(own, index);
    return merge_base(composer, base, own);
}

/* ---- files in place of mappings ---- */

static enum dea_status expand_key(struct composer *composer, enum dea_file_role role, struct dea_node *mapping,
                                  const char *key, const struct chain *chain) {
    size_t index = dea_node_find(mapping, key);
    if (index == mapping->count)
        return DEA_OK;
    return expand(composer, role, &mapping->items[index], chain);
}

/* Makes *slot a mapping without `base` and without further file names, where it is a path or a mapping. */
static enum dea_status expand(struct composer *composer, enum dea_file_role role, struct dea_node **slot,
                              const struct chain *chain) {
    if ((*slot)->kind == DEA_NODE_SCALAR) {
        struct dea_node *loaded;
        DEA_TRY(load_named(composer, role, *slot, chain, &loaded));
        loaded->parent = (*slot)->parent;
        *slot = loaded;
        return DEA_OK;
    }
    if ((*slot)->kind != DEA_NODE_MAPPING)
        return DEA_OK; /* its reader says what was expected */
    DEA_TRY(expand_base(composer, role, *slot, chain));
    if (role == DEA_FILE_DEVICE)
        return expand_key(composer, DEA_FILE_MATERIAL, *slot, "material", chain);
    if (role == DEA_FILE_SCENE) {
        DEA_TRY(expand_key(composer, DEA_FILE_DEVICE, *slot, "device", chain));
        struct dea_node *devices = dea_node_get(*slot, "devices");
        for (size_t i = 0; devices != NULL && devices->kind == DEA_NODE_MAPPING && i < devices->count; i++)
            DEA_TRY(expand(composer, DEA_FILE_DEVICE, &devices->items[i], chain));
    }
    return DEA_OK;
}

/* ---- overrides ---- */

/* Index of one part of a dotted key in a mapping or list; `count` when absent. */
static size_t find_part(const struct dea_node *node, const char *part) {
    if (node->kind == DEA_NODE_MAPPING)
        return dea_node_find(node, part);
    char *end;
    unsigned long index = strtoul(part, &end, 10);
    return part[0] >= '0' && part[0] <= '9' && *end == '\0' && index < node->count ? index : node->count;
}

/* Puts `value` under `part` of `node`, replacing what is there; null removes it. */
static enum dea_status put_part(struct composer *composer, struct dea_node *node, const char *part,
                                struct dea_node *value) {
    size_t index = find_part(node, part);
    if (index < node->count && dea_node_is_null(value)) {
        remove_entry(node, index);
        return DEA_OK;
    }
    if (index < node->count) {
        node->items[index] = value;
        value->parent = node;
        return DEA_OK;
    }
    if (node->kind == DEA_NODE_LIST)
        return dea_node_fail(value, composer->error, "'%.60s' is not an entry of the list, which has %zu", part,
                             node->count);
    struct dea_node *key;
    DEA_TRY(dea_tree_new_node(composer->tree, DEA_NODE_SCALAR, value, &key, composer->error));
    key->text = part;
    return dea_tree_append(composer->tree, node, key, value, composer->error);
}

/* Walks to the mapping or list that holds the last part of `key` (which is cut at its dots), making mappings on the
 * way. */
static enum dea_status walk_key(struct composer *composer, struct dea_node *node, char *key, struct dea_node *value,
                                struct dea_node **holder, char **last) {
    for (char *part = key, *dot;; part = dot + 1) {
        dot = strchr(part, '.');
        if (dot != NULL)
            *dot = '\0';
        if (*part == '\0')
            return dea_node_fail(value, composer->error, "the key has an empty part");
        if (node->kind == DEA_NODE_SCALAR) {
            char path[256], found[80];
            return dea_node_fail(value, composer->error, "'%s' is %s, not a mapping with a key '%.60s'",
                                 dea_node_path(node, path, sizeof path), dea_node_describe(node, found, sizeof found),
                                 part);
        }
        *holder = node;
        *last = part;
        if (dot == NULL)
            return DEA_OK;
        size_t index = find_part(node, part);
        if (index == node->count) {
            struct dea_node *made;
            DEA_TRY(dea_tree_new_node(composer->tree, DEA_NODE_MAPPING, value, &made, composer->error));
            DEA_TRY(put_part(composer, node, part, made));
            node = made;
        } else {
            node = node->items[index];
        }
    }
}

static enum dea_status apply_override(struct composer *composer, const struct dea_override *override,
                                      struct dea_node *root) {
    struct dea_node *value, *holder = NULL;
    char *last = NULL;
    DEA_TRY(dea_tree_read_override(composer->tree, override->key, override->value, &value, composer->error));
    char *key = dea_tree_copy_text(composer->tree, override->key, strlen(override->key));
    if (key == NULL)
        return dea_fail(composer->error, DEA_ERR_MEMORY, "out of memory while reading YAML");
    DEA_TRY(walk_key(composer, root, key, value, &holder, &last));
    return put_part(composer, holder, last, value);
}

enum dea_status dea_compose(struct dea_tree *tree, enum dea_file_role role, const char *path,
                            const struct dea_override *overrides, size_t override_count, struct dea_node **root,
                            struct dea_error *error) {
    struct composer composer = {tree, error};
    DEA_TRY(load_file(&composer, role, path, NULL, NULL, root));
    const struct chain top = {.shown = path, .length = 1};
    for (size_t i = 0; i < override_count; i++) {
        DEA_TRY(apply_override(&composer, &overrides[i], *root));
        DEA_TRY(expand(&composer, role, root, &top));
    }
    return DEA_OK;
}
