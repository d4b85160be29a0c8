/* Libraries loaded when they are first needed: their functions work, and what is missing is named. */
#include "base/library.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

static void finds_functions(void **state) {
    (void)state;
    double (*root)(double) = NULL, (*cube_root)(double) = NULL;
    const struct dea_library_function functions[] = {{"sqrt", &root}, {"cbrt", &cube_root}};
    struct dea_error error;
    assert_int_equal(dea_library_load("libm.so.6", "libc6", functions, 2, &error), DEA_OK);
    assert_true(root(9.0) == 3.0);
    assert_true(cube_root(8.0) == 2.0);
}

static void names_the_package_of_a_missing_library(void **state) {
    (void)state;
    struct dea_error error;
    assert_int_equal(dea_library_load("libmissing.so.7", "libmissing7", NULL, 0, &error), DEA_ERR_INTERNAL);
    assert_non_null(strstr(error.text, "libmissing.so.7"));
    assert_non_null(strstr(error.text, "install the package libmissing7"));
}

static void refuses_a_library_without_the_function(void **state) {
    (void)state;
    double (*root)(double) = NULL;
    void (*missing)(void) = NULL;
    const struct dea_library_function functions[] = {{"sqrt", &root}, {"no_such_function", &missing}};
    struct dea_error error;
    assert_int_equal(dea_library_load("libm.so.6", "libc6", functions, 2, &error), DEA_ERR_INTERNAL);
    assert_non_null(strstr(error.text, "no_such_function"));
    assert_null(missing);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(finds_functions),
                                       cmocka_unit_test(names_the_package_of_a_missing_library),
                                       cmocka_unit_test(refuses_a_library_without_the_function)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
