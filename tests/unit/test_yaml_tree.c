/* The YAML layer: places, limits, aliases. */
#include "scene/yaml_tree.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "scene_files.h"

static enum dea_status read_text(const char *text, struct dea_tree *tree, struct dea_node **root,
                                 struct dea_error *error) {
    *tree = (struct dea_tree){0};
    *root = NULL;
    write_text("tree.yaml", text);
    return dea_tree_read_file(tree, "tree.yaml", NULL, root, error);
}

/* Expects the first line of the message. */
static void assert_refused(const char *text, const char *message) {
    struct dea_tree tree;
    struct dea_node *root;
    struct dea_error error = {0};
    enum dea_status status = read_text(text, &tree, &root, &error);
    dea_tree_clear(&tree);
    error.text[strcspn(error.text, "\n")] = '\0';
    assert_string_equal(error.text, message);
    assert_int_equal(status, DEA_ERR_INPUT);
}

static void keeps_places_and_paths(void **state) {
    (void)state;
    struct dea_tree tree;
    struct dea_node *root;
    struct dea_error error = {0};
    char path[64];
    assert_int_equal(read_text("# note\na:\n  b: [1, {c: 'two'}]\n\u00e4\u00f6: 3\n", &tree, &root, &error), DEA_OK);
    assert_int_equal(root->kind, DEA_NODE_MAPPING);
    const struct dea_node *list = dea_node_get(dea_node_get(root, "a"), "b");
    assert_int_equal(list->kind, DEA_NODE_LIST);
    assert_int_equal(list->line, 3);
    assert_int_equal(list->column, 6);
    const struct dea_node *inner = dea_node_get(list->items[1], "c");
    assert_string_equal(inner->text, "two");
    assert_true(inner->quoted);
    assert_int_equal(inner->line, 3);
    assert_int_equal(inner->column, 14);
    assert_string_equal(dea_node_path(inner, path, sizeof path), "a.b.1.c");
    assert_string_equal(dea_node_path(list->items[1]->keys[0], path, sizeof path), "a.b.1");
    assert_string_equal(dea_node_path(root, path, sizeof path), "");
    assert_int_equal(dea_node_get(root, "\u00e4\u00f6")->column, 5); /* characters, not bytes */
    assert_null(dea_node_get(root, "c"));
    assert_null(dea_node_get(list, "c"));
    dea_tree_clear(&tree);
}

static void tells_null_from_quoted_text(void **state) {
    (void)state;
    struct dea_tree tree;
    struct dea_node *root;
    struct dea_error error = {0};
    assert_int_equal(read_text("[~, null, , 'null', \"\", Null, nil]", &tree, &root, &error), DEA_ERR_INPUT);
    dea_tree_clear(&tree);
    assert_int_equal(read_text("[~, null, 'null', \"\", Null, nil]", &tree, &root, &error), DEA_OK);
    static const bool expected[] = {true, true, false, false, true, false};
    assert_int_equal(root->count, 6);
    for (size_t i = 0; i < 6; i++)
        assert_int_equal(dea_node_is_null(root->items[i]), expected[i]);
    dea_tree_clear(&tree);
}

static void copies_aliases(void **state) {
    (void)state;
    struct dea_tree tree;
    struct dea_node *root;
    struct dea_error error = {0};
    char path[64];
    assert_int_equal(read_text("a: &z {length: 4 mm}\nb: *z\n", &tree, &root, &error), DEA_OK);
    const struct dea_node *a = dea_node_get(root, "a"), *b = dea_node_get(root, "b");
    assert_ptr_not_equal(a, b);
    const struct dea_node *length = dea_node_get(b, "length");
    assert_string_equal(length->text, "4 mm");
    assert_int_equal(length->line, 1); /* where it was written */
    assert_string_equal(dea_node_path(length, path, sizeof path), "b.length");
    dea_tree_clear(&tree);
    /* an anchor may be given again; the last one counts */
    assert_int_equal(read_text("[&a 1, *a, &a 2, *a]", &tree, &root, &error), DEA_OK);
    assert_string_equal(root->items[1]->text, "1");
    assert_string_equal(root->items[3]->text, "2");
    dea_tree_clear(&tree);
}

static void refuses_broken_structure(void **state) {
    (void)state;
    assert_refused("a: 1\nb: 2\na: 3\n", "tree.yaml:3:1: duplicate key 'a'; already given on line 1");
    assert_refused("a: {b: 1, 'b': 2}\n", "tree.yaml:1:11: duplicate key 'b'; already given on line 1");
    assert_refused("{[1]: 2}", "tree.yaml:1:2: a key must be plain text");
    assert_refused("&a [*a]", "tree.yaml:1:5: alias '*a' stands inside its own anchor: circular");
    assert_refused("a: &a {b: &b {c: *a}}", "tree.yaml:1:18: alias '*a' stands inside its own anchor: circular");
    assert_refused("[*a, &a 1]", "tree.yaml:1:2: alias '*a' has no anchor '&a' before it");
    assert_refused("a: !!int 3", "tree.yaml:1:4: YAML tags ('!...') have no meaning here");
    assert_refused("a: 1\n---\nb: 2\n", "tree.yaml:2:1: a second YAML document ('---'); only one is read");
    assert_refused("a: \"x\\0y\"", "tree.yaml:1:4: a text contains a NUL character");
    assert_refused(
        "a: [1, 2",
        "tree.yaml:2:1: not valid YAML: while parsing a flow sequence from line 1, did not find expected ',' "
        "or ']'");
    assert_refused("a: 'open\n",
                   "tree.yaml:2:1: not valid YAML: while scanning a quoted scalar from line 1, found unexpected end of "
                   "stream");
    assert_refused("   \n\n", "tree.yaml: holds no keys");
    assert_refused("a: \x01", "tree.yaml: not a YAML text file: control characters are not allowed (byte 3)");
    assert_refused("a: \xff\xfe", "tree.yaml: not a YAML text file: invalid leading UTF-8 octet (byte 3)");
}

/* Repeats a text into a malloc'd buffer with a head and a tail. */
static char *repeat(const char *head, const char *text, size_t times, const char *tail) {
    size_t length = strlen(text);
    char *all = malloc(strlen(head) + length * times + strlen(tail) + 1);
    assert_non_null(all);
    char *p = stpcpy(all, head);
    for (size_t i = 0; i < times; i++)
        p = stpcpy(p, text);
    strcpy(p, tail);
    return all;
}

static void refuses_deep_nesting(void **state) {
    (void)state;
    struct dea_tree tree;
    struct dea_node *root;
    struct dea_error error = {0};
    char *text = repeat("", "[", 64, "1");
    char *closed = repeat(text, "]", 64, "");
    assert_int_equal(read_text(closed, &tree, &root, &error), DEA_OK);
    dea_tree_clear(&tree);
    free(text);
    free(closed);
    text = repeat("", "[", 65, "");
    assert_refused(text, "tree.yaml:1:65: nested deeper than 64 levels");
    free(text);
    text = repeat("", "[", 1000000, "");
    assert_refused(text, "tree.yaml:1:65: nested deeper than 64 levels");
    free(text);
    /* depth gained through aliases counts as well */
    text = repeat("a0: &a0 [1]\n", "", 0, "");
    for (int i = 1; i < 70; i++) {
        char line[64];
        snprintf(line, sizeof line, "a%d: &a%d [*a%d]\n", i, i, i - 1);
        char *longer = repeat(text, line, 1, "");
        free(text);
        text = longer;
    }
    assert_refused(text, "tree.yaml:63:12: nested deeper than 64 levels");
    free(text);
}

static void refuses_alias_bombs(void **state) {
    (void)state;
    char text[4096] = "a: &a [x, x, x, x, x, x, x, x, x, x]\n";
    for (char c = 'b'; c < 'l'; c++) {
        char line[128];
        snprintf(line, sizeof line, "%c: &%c [*%c, *%c, *%c, *%c, *%c, *%c, *%c, *%c, *%c, *%c]\n", c, c, c - 1, c - 1,
                 c - 1, c - 1, c - 1, c - 1, c - 1, c - 1, c - 1, c - 1);
        strcat(text, line);
    }
    assert_refused(text, "tree.yaml:6:36: more than 1000000 values (aliases count as often as they are used)");
}

static void refuses_too_much(void **state) {
    (void)state;
    char *text = repeat("a: [", "1,", 1000001, "1]");
    assert_refused(text, "tree.yaml:1:1999999: more than 1000000 values (aliases count as often as they are used)");
    free(text);
    text = repeat("[", "&a 1,", 257, "1]");
    assert_refused(text, "tree.yaml:1:1282: more than 256 anchors");
    free(text);
    text = malloc(20000);
    assert_non_null(text);
    char *p = text;
    for (int i = 0; i <= 1000; i++)
        p += sprintf(p, "k%d: 1\n", i);
    assert_refused(text, "tree.yaml:1001:1: more than 1000 keys in one mapping");
    free(text);
    text = repeat("# ", "x", (size_t)17 << 20, "\n");
    assert_refused(text, "cannot read tree.yaml: it is larger than 16 MB");
    free(text);
}

static void cuts_long_lines_around_the_caret(void **state) {
    (void)state;
    struct dea_tree tree;
    struct dea_node *root;
    struct dea_error error = {0};
    char *text = repeat("a: [", "1, ", 200, "*b, 1]");
    assert_int_equal(read_text(text, &tree, &root, &error), DEA_ERR_INPUT);
    dea_tree_clear(&tree);
    free(text);
    const char *quote = strchr(error.text, '\n');
    assert_non_null(quote);
    assert_true(strlen(quote) < 200);
    const char *star = strstr(quote, "*b"), *last = strrchr(error.text, '\n');
    assert_non_null(star);
    assert_int_equal(star - quote, strchr(last, '^') - last); /* the caret stands below it */
}

static void reads_override_values(void **state) {
    (void)state;
    struct dea_tree tree = {0};
    struct dea_node *root;
    struct dea_error error = {0};
    assert_int_equal(dea_tree_read_override(&tree, "a.b", "400 ms", &root, &error), DEA_OK);
    assert_string_equal(root->text, "400 ms");
    assert_int_equal(dea_node_fail(root, &error, "is %s", "wrong"), DEA_ERR_INPUT);
    assert_string_equal(error.text, "--set a.b=400 ms: is wrong");
    assert_int_equal(dea_tree_read_override(&tree, "a", " ", &root, &error), DEA_ERR_INPUT);
    assert_string_equal(error.text, "--set a= : the value is missing");
    assert_int_equal(dea_tree_read_override(&tree, "a", "[1", &root, &error), DEA_ERR_INPUT);
    assert_non_null(strstr(error.text, "--set a=[1: not valid YAML: while parsing a flow sequence from line 1"));
    assert_int_equal(dea_tree_read_override(&tree, "a", "# x", &root, &error), DEA_ERR_INPUT);
    assert_string_equal(error.text, "--set a=# x: holds no keys");
    dea_tree_clear(&tree);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(keeps_places_and_paths), cmocka_unit_test(tells_null_from_quoted_text),
        cmocka_unit_test(copies_aliases),         cmocka_unit_test(refuses_broken_structure),
        cmocka_unit_test(refuses_deep_nesting),   cmocka_unit_test(refuses_alias_bombs),
        cmocka_unit_test(refuses_too_much),       cmocka_unit_test(cuts_long_lines_around_the_caret),
        cmocka_unit_test(reads_override_values),
    };
    return cmocka_run_group_tests(tests, enter_scene_folder, leave_scene_folder);
}
