/* The integrator's solver of small dense systems: random systems solved, pivots where the diagonal has none, singular
 * ones refused and the solver fit for the next matrix. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>
#include <stdbool.h>
#include <string.h>
#include <sunmatrix/sunmatrix_dense.h>

#include "plant/dense.h"
#include "plant/vectors.h"

enum { LARGEST = 60 };

static double draw(uint32_t *state) { /* Numerical Recipes' linear congruential numbers, -1 .. 1 */
    *state = *state * 1664525u + 1013904223u;
    return *state / 2147483648.0 - 1.0;
}

struct problem {
    SUNContext context;
    SUNMatrix matrix;
    SUNLinearSolver solver;
    N_Vector x, b;
    double copy[LARGEST * LARGEST];
    int n;
};

static void begin(struct problem *p, int n) {
    p->n = n;
    assert_int_equal(SUNContext_Create(NULL, &p->context), 0);
    p->matrix = SUNDenseMatrix(n, n, p->context);
    p->solver = plant_new_dense_solver(n, p->context);
    p->x = plant_new_vector(n, p->context);
    p->b = plant_new_vector(n, p->context);
    assert_true(p->matrix != NULL && p->solver != NULL && p->x != NULL && p->b != NULL);
    assert_int_equal(SUNLinSolGetType(p->solver), SUNLINEARSOLVER_DIRECT);
    assert_int_equal(SUNLinSolInitialize(p->solver), 0);
}

static void end(struct problem *p) {
    SUNLinSolFree(p->solver);
    SUNMatDestroy(p->matrix);
    N_VDestroy(p->x);
    N_VDestroy(p->b);
    SUNContext_Free(&p->context);
}

static int factor(struct problem *p) {
    memcpy(p->copy, SUNDenseMatrix_Data(p->matrix), (size_t)(p->n * p->n) * sizeof *p->copy);
    return SUNLinSolSetup(p->solver, p->matrix);
}

/* Solves into x, or where b is, and looks at A x - b. */
static void check_solution(struct problem *p, bool in_place, uint32_t *state) {
    double b[LARGEST];
    for (int i = 0; i < p->n; i++)
        b[i] = N_VGetArrayPointer(p->b)[i] = draw(state);
    N_Vector where = in_place ? p->b : p->x;
    assert_int_equal(SUNLinSolSolve(p->solver, p->matrix, where, p->b, 0.0), 0);
    const double *x = N_VGetArrayPointer(where);
    for (int i = 0; i < p->n; i++) {
        double left = -b[i], size = fabs(b[i]);
        for (int j = 0; j < p->n; j++) {
            left += p->copy[j * p->n + i] * x[j];
            size += fabs(p->copy[j * p->n + i] * x[j]);
        }
        assert_true(fabs(left) < 1e-13 * size);
    }
}

static void random_systems_are_solved(void **unused) {
    (void)unused;
    uint32_t state = 11;
    for (int n = 1; n <= LARGEST; n += n < 20 ? 1 : 20) {
        struct problem p;
        begin(&p, n);
        for (int round = 0; round < 20; round++) {
            double *a = SUNDenseMatrix_Data(p.matrix);
            for (int i = 0; i < n * n; i++)
                a[i] = n > 1 && round % 2 != 0 && draw(&state) > -0.5 ? 0.0 : draw(&state);
            for (int i = 0; n > 1 && i < n; i++) /* nothing on the diagonal, something beside it */
                a[i * n + i] = 0.0, a[i * n + (i + 1) % n] += 3.0;
            assert_int_equal(factor(&p), 0);
            assert_int_equal(SUNLinSolLastFlag(p.solver), 0);
            check_solution(&p, false, &state);
            check_solution(&p, true, &state);
        }
        end(&p);
    }
}

static void singular_systems_are_refused(void **unused) {
    (void)unused;
    uint32_t state = 3;
    struct problem p;
    begin(&p, 3);
    double *a = SUNDenseMatrix_Data(p.matrix);
    const double singular[9] = {1.0, 2.0, 4.0, 2.0, 4.0, 8.0, 0.0, 0.0, 1.0}, regular[9] = {0, 0, 1, 1, 0, 0, 0, 1, 0};
    memcpy(a, singular, sizeof singular);
    assert_true(factor(&p) > 0);
    assert_int_equal(SUNLinSolLastFlag(p.solver), 3);
    memcpy(a, regular, sizeof regular);
    assert_int_equal(factor(&p), 0);
    assert_int_equal(SUNLinSolLastFlag(p.solver), 0);
    check_solution(&p, false, &state);
    end(&p);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(random_systems_are_solved),
        cmocka_unit_test(singular_systems_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
