/* The table of common units against udunits2 itself. */
#include "base/known_units.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
/* cmocka wants the four above */
#include <cmocka.h>
#include <udunits2.h>

static void each_answer_is_that_of_udunits(void **state) {
    (void)state;
    ut_set_error_message_handler(ut_ignore);
    ut_system *system = ut_read_xml(NULL);
    assert_non_null(system);
    for (size_t i = 0; i < known_unit_count; i++) {
        const struct known_unit *known = &known_units[i];
        ut_unit *unit = ut_parse(system, known->text, UT_UTF8), *si = ut_parse(system, known->si_unit, UT_UTF8);
        cv_converter *converter = unit != NULL && si != NULL ? ut_get_converter(unit, si) : NULL;
        if (converter == NULL)
            fail_msg("udunits2 has no way from %s to %s", known->text, known->si_unit);
        double one = cv_convert_double(converter, 1.0), zero = cv_convert_double(converter, 0.0);
        if (fabs(one / known->scale - 1.0) > 4e-16 || zero != 0.0)
            fail_msg("1 %s is %.17g %s, the table says %.17g", known->text, one, known->si_unit, known->scale);
        cv_free(converter);
        ut_free(unit);
        ut_free(si);
    }
    ut_free_system(system);
}

static void pairs_are_looked_up_as_a_whole(void **state) {
    (void)state;
    assert_non_null(find_known_unit("um", "m"));
    assert_null(find_known_unit("um", "s"));
    assert_string_equal(find_known_unit("mA", NULL)->si_unit, "A");
    assert_null(find_known_unit("furlong", "m"));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_answer_is_that_of_udunits),
        cmocka_unit_test(pairs_are_looked_up_as_a_whole),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
