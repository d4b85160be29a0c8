/* Tables that describe the keys of a mapping, and one reader for all of them. */
#ifndef DEASIM_FIELDS_H
#define DEASIM_FIELDS_H

#include "scene/yaml_tree.h"

#include <stddef.h>

enum dea_field_kind {
    DEA_FIELD_QUANTITY, /* double, SI */
    DEA_FIELD_PAIR,     /* double[2], SI: a list of two quantities */
    DEA_FIELD_BOOL,     /* bool */
    DEA_FIELD_CHOICE,   /* int-sized enum: index into `names` */
    DEA_FIELD_TEXT,     /* char[size] */
    DEA_FIELD_STRING,   /* char *, malloc'd; the field must be NULL before */
    DEA_FIELD_READER,   /* `read` gets the node and the whole target */
    DEA_FIELD_ELSEWHERE /* allowed here, read by the caller */
};

/* Where a quantity may lie. Wide, but narrow enough to notice a forgotten unit. */
struct dea_range {
    const char *unit; /* SI */
    double low, high; /* SI, inclusive */
    bool or_zero;     /* 0 is allowed besides */
};

struct dea_field {
    const char *key;
    enum dea_field_kind kind;
    bool required; /* else the target keeps its default */
    size_t offset; /* in the target */
    struct dea_range range;
    const char *const *names; /* of a choice, NULL-terminated */
    size_t size;              /* of a text, bytes */
    enum dea_status (*read)(const struct dea_node *node, void *target, struct dea_error *error);
};

#define DEA_COUNT(array) (sizeof(array) / sizeof((array)[0]))

/* Reads a mapping into `target`. Every mapping may also hold the texts `source` and `notes`, and every quantity may be
 * written {value: .., source: ..}. `what` names the mapping in messages ("a material"). */
enum dea_status dea_fields_read(const struct dea_node *mapping, const char *what, const struct dea_field *fields,
                                size_t field_count, void *target, struct dea_error *error);

/* Checks only that the node is a mapping with no other keys than these. */
enum dea_status dea_fields_check_keys(const struct dea_node *mapping, const char *what, const struct dea_field *fields,
                                      size_t field_count, struct dea_error *error);

/* One quantity within its range. */
enum dea_status dea_field_quantity(const struct dea_node *node, const struct dea_range *range, double *value,
                                   struct dea_error *error);

/* A list of two quantities, each with its range. */
enum dea_status dea_field_pair(const struct dea_node *node, const struct dea_range ranges[2], double values[2],
                               struct dea_error *error);

/* Index of a scalar in a NULL-terminated list of names. */
enum dea_status dea_field_choice(const struct dea_node *node, const char *const *names, int *index,
                                 struct dea_error *error);

/* A non-empty text without control characters. */
enum dea_status dea_field_text(const struct dea_node *node, size_t size, char *text, struct dea_error *error);

/* Refuses anything but a list with `least` to `most` entries. `what` names the entries ("branches"). */
enum dea_status dea_field_list(const struct dea_node *node, const char *what, size_t least, size_t most,
                               struct dea_error *error);

/* The name nearest to `text` by edit distance, NULL when none is near. */
const char *dea_nearest_name(const char *text, const char *const *names, size_t count);

#endif
