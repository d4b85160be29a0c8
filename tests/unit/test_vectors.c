/* Operations of the integrator's vectors against the library's serial ones, for every length from 1 up, with arguments
 * that are the same vector. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>
#include <nvector/nvector_serial.h>

#include "plant/vectors.h"

enum { LONGEST = 19, MOST = 12 };

static double draw(uint32_t *state) { /* Numerical Recipes' linear congruential numbers, -1 .. 1 */
    *state = *state * 1664525u + 1013904223u;
    return *state / 2147483648.0 - 1.0;
}

/* Count vectors of ours, the last ones clones, and as many of the library's with the same numbers. */
static void make(N_Vector *ours, N_Vector *theirs, int count, int length, SUNContext context, uint32_t *state) {
    for (int k = 0; k < count; k++) {
        ours[k] = k < 2 ? plant_new_vector(length, context) : N_VClone(ours[0]);
        theirs[k] = N_VNew_Serial(length, context);
        assert_non_null(ours[k]);
        assert_non_null(theirs[k]);
        for (int i = 0; i < length; i++) {
            if (k < 2)
                assert_true(N_VGetArrayPointer(ours[k])[i] == 0.0);
            N_VGetArrayPointer(ours[k])[i] = N_VGetArrayPointer(theirs[k])[i] = draw(state);
        }
    }
}

static void compare(N_Vector *ours, N_Vector *theirs, int count, int length) {
    for (int k = 0; k < count; k++)
        for (int i = 0; i < length; i++)
            assert_true(fabs(N_VGetArrayPointer(ours[k])[i] - N_VGetArrayPointer(theirs[k])[i]) < 1e-14);
}

static void operate(N_Vector *v, double *norms) {
    double factors[MOST];
    for (int k = 0; k < MOST; k++)
        factors[k] = 0.3 * k - 1.1;
    N_VLinearSum(1.0, v[0], -0.7, v[1], v[2]);
    N_VLinearSum(0.4, v[3], 1.0, v[4], v[4]);
    N_VLinearSum(-1.0, v[5], 2.0, v[6], v[5]);
    N_VScale(1.0, v[0], v[7]);
    N_VScale(-0.6, v[1], v[1]);
    norms[0] = N_VWrmsNorm(v[2], v[4]);
    norms[1] = N_VWrmsNorm(v[5], v[5]);
    assert_int_equal(N_VLinearCombination(6, factors, v, v[0]), 0);
    assert_int_equal(N_VLinearCombination(1, factors, v + 3, v[8]), 0);
    assert_int_equal(N_VLinearCombination(MOST, factors, v, v[9]), 0);
    assert_int_equal(N_VLinearSumVectorArray(3, 0.5, v, -0.25, v + 3, v + 3), 0);
    assert_int_equal(N_VScaleVectorArray(4, factors, v + 6, v + 6), 0);
    N_VConst(0.125, v[10]);
    N_VAbs(v[0], v[11]);
    N_VAddConst(v[11], 0.5, v[11]);
    norms[2] = N_VMin(v[11]);
    N_VInv(v[11], v[11]);
}

static void operations_are_those_of_the_library(void **unused) {
    (void)unused;
    SUNContext context;
    uint32_t state = 7;
    assert_int_equal(SUNContext_Create(NULL, &context), 0);
    for (int length = 1; length <= LONGEST; length++) {
        N_Vector ours[MOST], theirs[MOST];
        double our_norms[3], their_norms[3];
        make(ours, theirs, MOST, length, context, &state);
        operate(ours, our_norms);
        operate(theirs, their_norms);
        compare(ours, theirs, MOST, length);
        for (int i = 0; i < 3; i++)
            assert_true(fabs(our_norms[i] - their_norms[i]) < 1e-14);
        for (int k = 0; k < MOST; k++) {
            N_VDestroy(ours[k]);
            N_VDestroy(theirs[k]);
        }
    }
    SUNContext_Free(&context);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(operations_are_those_of_the_library)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
