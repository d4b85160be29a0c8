/* A direct linear solver for small dense matrices: LU with partial pivoting as in the library, whose Debian build is
 * not optimized. Factors replace the matrix, its diagonal holds reciprocals of the pivots. */
#include "plant/dense.h"

#include <math.h>
#include <stdlib.h>
#include <sunmatrix/sunmatrix_dense.h>

struct content {
    sunindextype singular; /* column without a pivot, counted from 1; 0: none */
    int pivots[];
};

static SUNLinearSolver_Type get_type(SUNLinearSolver solver) {
    (void)solver;
    return SUNLINEARSOLVER_DIRECT;
}

static SUNLinearSolver_ID get_id(SUNLinearSolver solver) {
    (void)solver;
    return SUNLINEARSOLVER_CUSTOM;
}

static int initialize(SUNLinearSolver solver) {
    ((struct content *)solver->content)->singular = 0;
    return SUNLS_SUCCESS;
}

static int find_pivot(const double *column, int n, int k) {
    int best = k;
    for (int i = k + 1; i < n; i++)
        if (fabs(column[i]) > fabs(column[best]))
            best = i;
    return best;
}

static void swap_rows(double *a, int n, int i, int j) {
    for (int column = 0; column < n; column++, a += n) {
        double kept = a[i];
        a[i] = a[j];
        a[j] = kept;
    }
}

static int factor(SUNLinearSolver solver, SUNMatrix matrix) {
    struct content *content = solver->content;
    double *a = SM_DATA_D(matrix);
    int n = (int)SM_ROWS_D(matrix);
    for (int k = 0; k < n; k++) {
        double *restrict column = a + (ptrdiff_t)k * n;
        int pivot = content->pivots[k] = find_pivot(column, n, k);
        if (column[pivot] == 0.0) {
            content->singular = k + 1;
            return SUNLS_LUFACT_FAIL;
        }
        if (pivot != k)
            swap_rows(a, n, k, pivot);
        double reciprocal = column[k] = 1.0 / column[k];
        for (int i = k + 1; i < n; i++)
            column[i] *= reciprocal;
        for (int j = k + 1; j < n; j++) {
            double *restrict other = a + (ptrdiff_t)j * n, by = other[k];
            if (by == 0.0)
                continue;
            for (int i = k + 1; i < n; i++)
                other[i] -= column[i] * by;
        }
    }
    content->singular = 0;
    return SUNLS_SUCCESS;
}

static void substitute(const double *restrict a, const int *pivots, int n, double *restrict u) {
    for (int k = 0; k < n; k++) {
        double kept = u[pivots[k]];
        u[pivots[k]] = u[k];
        u[k] = kept;
    }
    for (int k = 0; k < n; k++) {
        const double *column = a + (ptrdiff_t)k * n;
        double by = u[k];
        for (int i = k + 1; i < n; i++)
            u[i] -= column[i] * by;
    }
    for (int k = n - 1; k >= 0; k--) {
        const double *column = a + (ptrdiff_t)k * n;
        double by = u[k] *= column[k];
        for (int i = 0; i < k; i++)
            u[i] -= column[i] * by;
    }
}

static int solve(SUNLinearSolver solver, SUNMatrix matrix, N_Vector x, N_Vector b, sunrealtype tolerance) {
    (void)tolerance;
    const struct content *content = solver->content;
    if (x != b)
        N_VScale(1.0, b, x);
    substitute(SM_DATA_D(matrix), content->pivots, (int)SM_ROWS_D(matrix), N_VGetArrayPointer(x));
    return SUNLS_SUCCESS;
}

static sunindextype last_flag(SUNLinearSolver solver) {
    return ((const struct content *)solver->content)->singular;
}

static int release(SUNLinearSolver solver) {
    free(solver->content);
    solver->content = NULL;
    SUNLinSolFreeEmpty(solver);
    return SUNLS_SUCCESS;
}

SUNLinearSolver plant_new_dense_solver(int n, SUNContext context) {
    SUNLinearSolver solver = SUNLinSolNewEmpty(context);
    if (solver == NULL)
        return NULL;
    struct content *content = calloc(1, sizeof *content + (size_t)n * sizeof content->pivots[0]);
    if (content == NULL) {
        SUNLinSolFreeEmpty(solver);
        return NULL;
    }
    solver->content = content;
    solver->ops->gettype = get_type;
    solver->ops->getid = get_id;
    solver->ops->initialize = initialize;
    solver->ops->setup = factor;
    solver->ops->solve = solve;
    solver->ops->lastflag = last_flag;
    solver->ops->free = release;
    return solver;
}
