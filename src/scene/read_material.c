/* material: elastic law, branches, dielectric, density. */
#include "scene/readers.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A forgotten "kPa" or "MPa" falls below these. */
#define MODULUS_RANGE                                                                                                  \
    { .unit = "Pa", .low = 100, .high = 1e9 }
#define SIGNED_MODULUS_RANGE                                                                                           \
    { .unit = "Pa", .low = -1e9, .high = 1e9 }
#define BRANCH_MODULUS_RANGE                                                                                           \
    { .unit = "Pa", .low = 10, .high = 1e9 }
#define JM_RANGE                                                                                                       \
    { .unit = "1", .low = 1e-3, .high = 1e9 }
#define EXPONENT_RANGE                                                                                                 \
    { .unit = "1", .low = -10, .high = 10 }

/* ---- elastic ---- */

static enum dea_status read_ogden_terms(const struct dea_node *node, void *target, struct dea_error *error) {
    struct term {
        double mu, alpha;
    };
    static const struct dea_field fields[] = {
        {.key = "mu", .required = true, .offset = offsetof(struct term, mu), .range = SIGNED_MODULUS_RANGE},
        {.key = "alpha",
         .required = true,
         .offset = offsetof(struct term, alpha),
         .range = {.unit = "1", .low = -100, .high = 100}},
    };
    struct dea_law *law = target;
    double modulus = 0;
    DEA_TRY(dea_field_list(node, "Ogden terms", 1, DEA_MAX_OGDEN_TERMS, error));
    for (size_t i = 0; i < node->count; i++) {
        struct term term;
        DEA_TRY(dea_fields_read(node->items[i], "an Ogden term", fields, DEA_COUNT(fields), &term, error));
        if (term.mu * term.alpha == 0)
            return dea_node_fail(node->items[i], error, "mu and alpha of an Ogden term must not be 0");
        law->ogden_mu[i] = term.mu;
        law->ogden_alpha[i] = term.alpha;
        modulus += term.mu * term.alpha / 2;
    }
    law->ogden_terms = (int)node->count;
    if (modulus <= 0)
        return dea_node_fail(node, error, "the shear modulus, the sum of mu alpha / 2, is %g Pa; it must be positive",
                             modulus);
    return DEA_OK;
}

#define LAW_KEY                                                                                                        \
    { .key = "law", .kind = DEA_FIELD_ELSEWHERE, .required = true }
#define LAW_QUANTITY(name, member, is_required, ...)                                                                   \
    { .key = name, .required = is_required, .offset = offsetof(struct dea_law, member), .range = __VA_ARGS__ }

static const struct dea_field gent_fields[] = {LAW_KEY, LAW_QUANTITY("mu", mu, true, MODULUS_RANGE),
                                               LAW_QUANTITY("jm", jm, true, JM_RANGE)};
static const struct dea_field neo_hookean_fields[] = {LAW_KEY, LAW_QUANTITY("mu", mu, true, MODULUS_RANGE)};
static const struct dea_field yeoh_fields[] = {LAW_KEY, LAW_QUANTITY("c10", yeoh[0], true, MODULUS_RANGE),
                                               LAW_QUANTITY("c20", yeoh[1], false, SIGNED_MODULUS_RANGE),
                                               LAW_QUANTITY("c30", yeoh[2], false, SIGNED_MODULUS_RANGE)};
static const struct dea_field ogden_fields[] = {
    LAW_KEY, {.key = "terms", .kind = DEA_FIELD_READER, .required = true, .read = read_ogden_terms}};
static const struct dea_field arruda_boyce_fields[] = {
    LAW_KEY, LAW_QUANTITY("mu", mu, true, MODULUS_RANGE),
    LAW_QUANTITY("locking_stretch", locking_stretch, true, {.unit = "1", .low = 1.001, .high = 1000})};

static const struct {
    const struct dea_field *fields;
    size_t count;
} law_tables[DEA_LAW_COUNT] = {
    [DEA_GENT] = {gent_fields, DEA_COUNT(gent_fields)},
    [DEA_NEO_HOOKEAN] = {neo_hookean_fields, DEA_COUNT(neo_hookean_fields)},
    [DEA_YEOH] = {yeoh_fields, DEA_COUNT(yeoh_fields)},
    [DEA_OGDEN] = {ogden_fields, DEA_COUNT(ogden_fields)},
    [DEA_ARRUDA_BOYCE] = {arruda_boyce_fields, DEA_COUNT(arruda_boyce_fields)},
};

static enum dea_status read_elastic(const struct dea_node *node, void *target, struct dea_error *error) {
    struct dea_law *law = &((struct dea_material *)target)->elastic;
    const char *names[DEA_LAW_COUNT + 1] = {NULL};
    char what[60];
    int kind;
    for (int i = 0; i < DEA_LAW_COUNT; i++)
        names[i] = dea_law_name((enum dea_law_kind)i);
    const struct dea_node *chosen = dea_node_get(node, "law");
    if (node->kind == DEA_NODE_MAPPING && chosen == NULL)
        return dea_node_fail(node, error, "the key 'law' of an elastic law is missing");
    if (chosen == NULL)
        return dea_fields_check_keys(node, "an elastic law", gent_fields, DEA_COUNT(gent_fields), error);
    DEA_TRY(dea_field_choice(chosen, names, &kind, error));
    law->kind = (enum dea_law_kind)kind;
    if (law->kind == DEA_YEOH)
        law->yeoh_terms = dea_node_get(node, "c30") != NULL ? 3 : dea_node_get(node, "c20") != NULL ? 2 : 1;
    snprintf(what, sizeof what, "the law %s", names[kind]);
    return dea_fields_read(node, what, law_tables[kind].fields, law_tables[kind].count, law, error);
}

/* ---- branches ---- */

static enum dea_status read_branch(const struct dea_node *node, struct dea_branch *branch, struct dea_error *error) {
    static const char *const kinds[] = {"foo", "network", NULL};
    static const struct dea_field fields[] = {
        {.key = "kind",
         .kind = DEA_FIELD_CHOICE,
         .required = true,
         .offset = offsetof(struct dea_branch, kind),
         .names = kinds},
        {.key = "mu", .required = true, .offset = offsetof(struct dea_branch, mu), .range = BRANCH_MODULUS_RANGE},
        {.key = "tau",
         .required = true,
         .offset = offsetof(struct dea_branch, tau),
         .range = {.unit = "s", .low = 1e-9, .high = 1e8}},
        {.key = "jm", .offset = offsetof(struct dea_branch, jm), .range = JM_RANGE},
    };
    *branch = (struct dea_branch){.kind = DEA_BRANCH_FOO, .jm = INFINITY};
    DEA_TRY(dea_fields_read(node, "a branch", fields, DEA_COUNT(fields), branch, error));
    const struct dea_node *limit = dea_node_get(node, "jm");
    if (limit != NULL && branch->kind == DEA_BRANCH_NETWORK)
        return dea_node_fail(limit, error, "a network branch has no jm; leave it out, or use kind: foo");
    return DEA_OK;
}

static enum dea_status read_branches(const struct dea_node *node, void *target, struct dea_error *error) {
    struct dea_material *material = target;
    DEA_TRY(dea_field_list(node, "branches", 0, 32, error));
    if (node->count == 0)
        return DEA_OK;
    material->branches = calloc(node->count, sizeof *material->branches);
    if (material->branches == NULL)
        return dea_fail(error, DEA_ERR_MEMORY, "out of memory for %zu branches", node->count);
    material->branch_count = (int)node->count;
    for (size_t i = 0; i < node->count; i++)
        DEA_TRY(read_branch(node->items[i], &material->branches[i], error));
    return DEA_OK;
}

/* ---- dielectric ---- */

/* A constant field, or the power law E_bd = coefficient (h/reference_thickness)^-m lam^n. */
static enum dea_status read_breakdown(const struct dea_node *node, void *target, struct dea_error *error) {
    static const struct dea_range field_range = {.unit = "V/m", .low = 1e5, .high = 1e11};
    static const struct dea_field fields[] = {
        {.key = "coefficient",
         .required = true,
         .offset = offsetof(struct dea_dielectric, breakdown),
         .range = {.unit = "V/m", .low = 1e5, .high = 1e11}},
        {.key = "reference_thickness",
         .required = true,
         .offset = offsetof(struct dea_dielectric, breakdown_reference),
         .range = {.unit = "m", .low = 1e-9, .high = 0.1}},
        {.key = "thickness_exponent",
         .offset = offsetof(struct dea_dielectric, breakdown_thickness_exponent),
         .range = EXPONENT_RANGE},
        {.key = "stretch_exponent",
         .offset = offsetof(struct dea_dielectric, breakdown_stretch_exponent),
         .range = EXPONENT_RANGE},
    };
    struct dea_dielectric *dielectric = target;
    if (node->kind == DEA_NODE_MAPPING && dea_node_get(node, "value") == NULL)
        return dea_fields_read(node, "a breakdown law", fields, DEA_COUNT(fields), dielectric, error);
    return dea_field_quantity(node, &field_range, &dielectric->breakdown, error);
}

static enum dea_status read_dielectric(const struct dea_node *node, void *target, struct dea_error *error) {
    static const struct dea_field fields[] = {
        {.key = "permittivity",
         .required = true,
         .offset = offsetof(struct dea_dielectric, permittivity),
         .range = {.unit = "1", .low = 0.1, .high = 1e5}},
        {.key = "permittivity_slope",
         .offset = offsetof(struct dea_dielectric, permittivity_slope),
         .range = {.unit = "1", .low = -1e5, .high = 1e5}},
        {.key = "breakdown", .kind = DEA_FIELD_READER, .read = read_breakdown},
        {.key = "conductivity",
         .offset = offsetof(struct dea_dielectric, conductivity),
         .range = {.unit = "S/m", .low = 1e-25, .high = 1, .or_zero = true}},
        {.key = "conductivity_field",
         .offset = offsetof(struct dea_dielectric, conductivity_field),
         .range = {.unit = "V/m", .low = 1e4, .high = 1e12}},
    };
    struct dea_dielectric *dielectric = &((struct dea_material *)target)->dielectric;
    return dea_fields_read(node, "a dielectric", fields, DEA_COUNT(fields), dielectric, error);
}

/* ---- the whole ---- */

void dea_name_from_file(const struct dea_node *node, char *name, size_t size) {
    if (name[0] != '\0' || !node->is_file_root)
        return;
    const char *path = node->origin->path, *slash = strrchr(path, '/');
    const char *stem = slash != NULL ? slash + 1 : path, *dot = strrchr(stem, '.');
    size_t length = dot != NULL && dot != stem ? (size_t)(dot - stem) : strlen(stem);
    snprintf(name, size, "%.*s", (int)(length < size ? length : size - 1), stem);
}

enum dea_status dea_read_material(const struct dea_node *node, struct dea_material *material, struct dea_error *error) {
    static const struct dea_field fields[] = {
        {.key = "name", .kind = DEA_FIELD_TEXT, .offset = offsetof(struct dea_material, name), .size = 64},
        {.key = "elastic", .kind = DEA_FIELD_READER, .required = true, .read = read_elastic},
        {.key = "branches", .kind = DEA_FIELD_READER, .read = read_branches},
        {.key = "dielectric", .kind = DEA_FIELD_READER, .required = true, .read = read_dielectric},
        {.key = "density",
         .required = true,
         .offset = offsetof(struct dea_material, density),
         .range = {.unit = "kg/m^3", .low = 10, .high = 3e4}},
    };
    *material = (struct dea_material){
        .dielectric = {.breakdown = INFINITY, .breakdown_reference = 1, .conductivity_field = INFINITY}};
    DEA_TRY(dea_fields_read(node, "a material", fields, DEA_COUNT(fields), material, error));
    dea_name_from_file(node, material->name, sizeof material->name);
    return DEA_OK;
}
