/* Reads mappings by table. Every refusal says what is allowed. */
#include "scene/fields.h"

#include "deasim/quantity.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#define MAX_FIELDS 32

/* Appends to a text in a buffer, cutting at its end. */
static void append(char *text, size_t size, const char *more) {
    size_t length = strlen(text);
    snprintf(text + length, size - length, "%s", more);
}

static void join_names(const char *const *names, size_t count, char *text, size_t size) {
    text[0] = '\0';
    for (size_t i = 0; i < count; i++) {
        append(text, size, i > 0 ? ", " : "");
        append(text, size, names[i]);
    }
}

/* ---- quantities ---- */

static const char *describe_range(const struct dea_range *range, char *text, size_t size) {
    char low[40], high[40];
    dea_quantity_format(range->low, range->unit, low, sizeof low);
    dea_quantity_format(range->high, range->unit, high, sizeof high);
    snprintf(text, size, "%s%s .. %s", range->or_zero ? "0 or " : "", low, high);
    return text;
}

static enum dea_status check_range(const struct dea_node *node, const struct dea_range *range, double value,
                                   struct dea_error *error) {
    char shown[40], allowed[100];
    if ((value >= range->low && value <= range->high) || (range->or_zero && value == 0))
        return DEA_OK;
    dea_quantity_format(value, range->unit, shown, sizeof shown);
    describe_range(range, allowed, sizeof allowed);
    if (range->low > 0 && value <= 0)
        return dea_node_fail(node, error, "%s is %s; allowed: %s", shown, range->or_zero ? "negative" : "not positive",
                             allowed);
    bool bare = node->text[strcspn(node->text, " \t")] == '\0' &&
                strspn(node->text, "+-0123456789.eE") == strlen(node->text) && strcmp(range->unit, "1") != 0;
    if (bare)
        return dea_node_fail(node, error, "%g %s is outside %s; is the unit missing?", value, range->unit, allowed);
    return dea_node_fail(node, error, "%s is outside %s", shown, allowed);
}

/* The scalar of a quantity: the node itself, or `value` of {value: .., source: ..}. */
static enum dea_status find_quantity(const struct dea_node *node, const char *unit, const struct dea_node **scalar,
                                     struct dea_error *error) {
    static const struct dea_field keys[] = {{.key = "value", .kind = DEA_FIELD_ELSEWHERE, .required = true}};
    char found[80];
    *scalar = node;
    if (node->kind == DEA_NODE_MAPPING && dea_node_get(node, "value") != NULL) {
        DEA_TRY(dea_fields_check_keys(node, "a quantity", keys, DEA_COUNT(keys), error));
        *scalar = dea_node_get(node, "value");
    }
    if ((*scalar)->kind == DEA_NODE_SCALAR && !dea_node_is_null(*scalar))
        return DEA_OK;
    return dea_node_fail(*scalar, error, "expected %s, found %s", dea_quantity_kind(unit),
                         dea_node_describe(*scalar, found, sizeof found));
}

enum dea_status dea_field_quantity(const struct dea_node *node, const struct dea_range *range, double *value,
                                   struct dea_error *error) {
    struct dea_error inner = {0};
    const struct dea_node *scalar;
    double read;
    DEA_TRY(find_quantity(node, range->unit, &scalar, error));
    enum dea_status status = dea_quantity_parse(scalar->text, range->unit, &read, &inner);
    if (status != DEA_OK) {
        dea_node_fail(scalar, error, "%s", inner.text);
        return status;
    }
    if (range->unit != NULL)
        DEA_TRY(check_range(scalar, range, read, error));
    *value = read;
    return DEA_OK;
}

enum dea_status dea_field_pair(const struct dea_node *node, const struct dea_range ranges[2], double values[2],
                               struct dea_error *error) {
    char found[80];
    if (node->kind != DEA_NODE_LIST || node->count != 2) {
        if (node->kind == DEA_NODE_LIST)
            snprintf(found, sizeof found, "%zu %s", node->count, node->count == 1 ? "entry" : "entries");
        else
            dea_node_describe(node, found, sizeof found);
        return dea_node_fail(node, error, "expected a list of two, found %s", found);
    }
    for (int i = 0; i < 2; i++)
        DEA_TRY(dea_field_quantity(node->items[i], &ranges[i], &values[i], error));
    return DEA_OK;
}

/* ---- other kinds ---- */

static enum dea_status read_bool(const struct dea_node *node, bool *value, struct dea_error *error) {
    static const char *const words[2][3] = {{"false", "no", "off"}, {"true", "yes", "on"}};
    char found[80];
    for (int truth = 0; truth < 2 && node->kind == DEA_NODE_SCALAR; truth++)
        for (int i = 0; i < 3; i++)
            if (strcasecmp(node->text, words[truth][i]) == 0) {
                *value = truth == 1;
                return DEA_OK;
            }
    return dea_node_fail(node, error, "expected true or false, found %s", dea_node_describe(node, found, sizeof found));
}

enum dea_status dea_field_choice(const struct dea_node *node, const char *const *names, int *index,
                                 struct dea_error *error) {
    char allowed[400], found[80];
    int count = 0;
    for (; names[count] != NULL; count++)
        if (node->kind == DEA_NODE_SCALAR && strcmp(node->text, names[count]) == 0) {
            *index = count;
            return DEA_OK;
        }
    join_names(names, (size_t)count, allowed, sizeof allowed);
    dea_node_describe(node, found, sizeof found);
    const char *nearest = node->kind == DEA_NODE_SCALAR ? dea_nearest_name(node->text, names, (size_t)count) : NULL;
    if (nearest != NULL)
        return dea_node_fail(node, error, "unknown choice %s; did you mean '%s'? allowed: %s", found, nearest, allowed);
    return dea_node_fail(node, error, "expected one of the allowed words, found %s; allowed: %s", found, allowed);
}

static enum dea_status check_text(const struct dea_node *node, struct dea_error *error) {
    char found[80];
    if (node->kind != DEA_NODE_SCALAR || dea_node_is_null(node) || node->text[0] == '\0')
        return dea_node_fail(node, error, "expected a text, found %s", dea_node_describe(node, found, sizeof found));
    for (const char *p = node->text; *p != '\0'; p++)
        if ((unsigned char)*p < 0x20 || *p == 0x7F)
            return dea_node_fail(node, error, "a line break or control character is not allowed in this text");
    return DEA_OK;
}

enum dea_status dea_field_text(const struct dea_node *node, size_t size, char *text, struct dea_error *error) {
    DEA_TRY(check_text(node, error));
    size_t length = strlen(node->text);
    if (length >= size)
        return dea_node_fail(node, error, "the text has %zu characters; at most %zu are allowed", length, size - 1);
    memcpy(text, node->text, length + 1);
    return DEA_OK;
}

static enum dea_status read_string(const struct dea_node *node, char **text, struct dea_error *error) {
    DEA_TRY(check_text(node, error));
    free(*text);
    *text = strdup(node->text);
    return *text != NULL ? DEA_OK : dea_fail(error, DEA_ERR_MEMORY, "out of memory while reading YAML");
}

enum dea_status dea_field_list(const struct dea_node *node, const char *what, size_t least, size_t most,
                               struct dea_error *error) {
    char found[80];
    if (node->kind != DEA_NODE_LIST)
        return dea_node_fail(node, error, "expected a list of %s, found %s", what,
                             dea_node_describe(node, found, sizeof found));
    if (node->count < least || node->count > most)
        return dea_node_fail(node, error, "%zu %s; allowed: %zu to %zu", node->count, what, least, most);
    return DEA_OK;
}

/* ---- mappings ---- */

static const struct dea_field *find_field(const struct dea_field *fields, size_t count, const char *key) {
    for (size_t i = 0; i < count; i++)
        if (strcmp(fields[i].key, key) == 0)
            return &fields[i];
    return NULL;
}

/* `source` and `notes` say where numbers come from: a text or a list of texts. */
static enum dea_status check_provenance(const struct dea_node *node, struct dea_error *error) {
    char found[80];
    bool good = node->kind == DEA_NODE_SCALAR && !dea_node_is_null(node);
    if (node->kind == DEA_NODE_LIST) {
        good = true;
        for (size_t i = 0; i < node->count; i++)
            good = good && node->items[i]->kind == DEA_NODE_SCALAR;
    }
    return good ? DEA_OK
                : dea_node_fail(node, error, "expected a text, found %s", dea_node_describe(node, found, sizeof found));
}

static enum dea_status refuse_key(const struct dea_node *key, const struct dea_field *fields, size_t field_count,
                                  struct dea_error *error) {
    const char *names[MAX_FIELDS];
    char allowed[500];
    for (size_t i = 0; i < field_count; i++)
        names[i] = fields[i].key;
    join_names(names, field_count, allowed, sizeof allowed);
    if (key->text[0] >= '0' && key->text[0] <= '9')
        return dea_node_fail(key, error, "unknown key '%.60s' (a decimal comma? use a point); allowed: %s", key->text,
                             allowed);
    const char *nearest = dea_nearest_name(key->text, names, field_count);
    if (nearest != NULL)
        return dea_node_fail(key, error, "unknown key '%.60s'; did you mean '%s'? allowed: %s", key->text, nearest,
                             allowed);
    return dea_node_fail(key, error, "unknown key '%.60s'; allowed: %s", key->text, allowed);
}

enum dea_status dea_fields_check_keys(const struct dea_node *mapping, const char *what, const struct dea_field *fields,
                                      size_t field_count, struct dea_error *error) {
    const char *names[MAX_FIELDS];
    char allowed[500], found[80];
    if (field_count > MAX_FIELDS)
        return dea_fail(error, DEA_ERR_INTERNAL, "the table of keys of %s is too long", what);
    if (mapping->kind != DEA_NODE_MAPPING) {
        for (size_t i = 0; i < field_count; i++)
            names[i] = fields[i].key;
        join_names(names, field_count, allowed, sizeof allowed);
        dea_node_describe(mapping, found, sizeof found);
        return dea_node_fail(mapping, error, "expected %s as a mapping, found %s; keys: %s", what, found, allowed);
    }
    for (size_t i = 0; i < mapping->count; i++) {
        const struct dea_node *key = mapping->keys[i];
        bool provenance = strcmp(key->text, "source") == 0 || strcmp(key->text, "notes") == 0;
        if (provenance && dea_node_get(mapping, key->text) != NULL)
            DEA_TRY(check_provenance(mapping->items[i], error));
        if (!provenance && find_field(fields, field_count, key->text) == NULL)
            return refuse_key(key, fields, field_count, error);
    }
    for (size_t i = 0; i < field_count; i++)
        if (fields[i].required && dea_node_get(mapping, fields[i].key) == NULL)
            return dea_node_fail(mapping, error, "the key '%s' of %s is missing", fields[i].key, what);
    return DEA_OK;
}

static enum dea_status read_field(const struct dea_node *node, const struct dea_field *field, void *target,
                                  struct dea_error *error) {
    char *place = (char *)target + field->offset;
    int choice = 0;
    if (dea_node_is_null(node))
        return dea_node_fail(node, error, "has no value; give one or leave the key out");
    switch (field->kind) {
    case DEA_FIELD_QUANTITY:
        return dea_field_quantity(node, &field->range, (double *)(void *)place, error);
    case DEA_FIELD_PAIR: {
        const struct dea_range both[2] = {field->range, field->range};
        return dea_field_pair(node, both, (double *)(void *)place, error);
    }
    case DEA_FIELD_BOOL:
        return read_bool(node, (bool *)(void *)place, error);
    case DEA_FIELD_CHOICE:
        DEA_TRY(dea_field_choice(node, field->names, &choice, error));
        memcpy(place, &choice, sizeof choice);
        return DEA_OK;
    case DEA_FIELD_TEXT:
        return dea_field_text(node, field->size, place, error);
    case DEA_FIELD_STRING:
        return read_string(node, (char **)(void *)place, error);
    case DEA_FIELD_READER:
        return field->read(node, target, error);
    case DEA_FIELD_ELSEWHERE:
        return DEA_OK;
    }
    return dea_fail(error, DEA_ERR_INTERNAL, "key '%s' has no reader", field->key);
}

enum dea_status dea_fields_read(const struct dea_node *mapping, const char *what, const struct dea_field *fields,
                                size_t field_count, void *target, struct dea_error *error) {
    DEA_TRY(dea_fields_check_keys(mapping, what, fields, field_count, error));
    for (size_t i = 0; i < field_count; i++) {
        const struct dea_node *node = dea_node_get(mapping, fields[i].key);
        if (node != NULL)
            DEA_TRY(read_field(node, &fields[i], target, error));
    }
    return DEA_OK;
}
