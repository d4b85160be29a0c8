/* A direct linear solver for small matrices that are dense in form and mostly zeros: LU with pivoting that passes over
 * the zeros. Unknowns are eliminated from the last to the first: platform and force balance, which all others meet in,
 * come first in the plant and are eliminated last, so that hardly anything fills in. */
#include "plant/dense.h"

#include <math.h>
#include <nvector/nvector_serial.h>
#include <stdlib.h>
#include <sunmatrix/sunmatrix_dense.h>

/* The diagonal element is the pivot unless it is smaller than this part of its column's largest. */
#define DIAGONAL_PART 0.1

/* A coefficient of a factor, and the unknown it goes with. */
struct entry {
    double value;
    int other;
};

struct content {
    int n;
    sunindextype singular; /* column without a pivot, counted from 1; 0: none */
    double *work;          /* the matrix from its last element to its first, by columns */
    double *reciprocals;   /* of the pivots */
    double *reversed;      /* the right side from its last element to its first */
    int *pivots;           /* rows exchanged with each in turn */
    /* below the diagonal by columns, right of it by rows: those of k from starts[k] on, to the next one's */
    struct entry *lower, *upper;
    int *lower_starts, *upper_starts;
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

/* Row of the pivot of column k, -1 where there is none. */
static int find_pivot(const double *column, int n, int k) {
    int best = k;
    double largest = fabs(column[k]);
    for (int i = k + 1; i < n; i++)
        if (fabs(column[i]) > largest) {
            largest = fabs(column[i]);
            best = i;
        }
    if (!(largest > 0.0))
        return -1;
    return fabs(column[k]) >= DIAGONAL_PART * largest ? k : best;
}

/* Columns before `from` have become factors and keep their order: exchanges are made in turn when solving. */
static void swap_rows(double *a, int n, int from, int i, int j) {
    for (int column = from; column < n; column++) {
        double *at = a + (ptrdiff_t)column * n, kept = at[i];
        at[i] = at[j];
        at[j] = kept;
    }
}

/* Takes row k times the factors of column k from the rows below. */
static void eliminate(struct content *c, int k) {
    int n = c->n, first = c->lower_starts[k], end = first, used = c->upper_starts[k];
    const double *column = c->work + (ptrdiff_t)k * n;
    for (int i = k + 1; i < n; i++)
        if (column[i] != 0.0)
            c->lower[end++] = (struct entry){column[i] * c->reciprocals[k], i};
    for (int j = k + 1; j < n; j++) {
        double *other = c->work + (ptrdiff_t)j * n, by = other[k];
        if (by == 0.0)
            continue;
        c->upper[used++] = (struct entry){by, j};
        for (int e = first; e < end; e++)
            other[c->lower[e].other] -= c->lower[e].value * by;
    }
    c->lower_starts[k + 1] = end;
    c->upper_starts[k + 1] = used;
}

static int factor(SUNLinearSolver solver, SUNMatrix matrix) {
    struct content *c = solver->content;
    const double *a = SM_DATA_D(matrix);
    int n = c->n, last = n * n - 1;
    for (int i = 0; i <= last; i++)
        c->work[i] = a[last - i];
    for (int k = 0; k < n; k++) {
        double *column = c->work + (ptrdiff_t)k * n;
        int pivot = c->pivots[k] = find_pivot(column, n, k);
        if (pivot < 0) {
            c->singular = k + 1;
            return SUNLS_LUFACT_FAIL;
        }
        if (pivot != k)
            swap_rows(c->work, n, k, k, pivot);
        c->reciprocals[k] = 1.0 / column[k];
        eliminate(c, k);
    }
    c->singular = 0;
    return SUNLS_SUCCESS;
}

static void substitute(const struct content *c, double *restrict u) {
    for (int k = 0; k < c->n; k++) {
        int pivot = c->pivots[k];
        double by = u[pivot];
        u[pivot] = u[k];
        u[k] = by;
        for (int e = c->lower_starts[k]; e < c->lower_starts[k + 1]; e++)
            u[c->lower[e].other] -= c->lower[e].value * by;
    }
    for (int k = c->n - 1; k >= 0; k--) {
        double rest = u[k];
        for (int e = c->upper_starts[k]; e < c->upper_starts[k + 1]; e++)
            rest -= c->upper[e].value * u[c->upper[e].other];
        u[k] = rest * c->reciprocals[k];
    }
}

static int solve(SUNLinearSolver solver, SUNMatrix matrix, N_Vector x, N_Vector b, sunrealtype tolerance) {
    (void)matrix, (void)tolerance;
    const struct content *c = solver->content;
    const double *given = NV_DATA_S(b);
    double *solution = NV_DATA_S(x);
    for (int i = 0; i < c->n; i++)
        c->reversed[i] = given[c->n - 1 - i];
    substitute(c, c->reversed);
    for (int i = 0; i < c->n; i++)
        solution[i] = c->reversed[c->n - 1 - i];
    return SUNLS_SUCCESS;
}

static sunindextype last_flag(SUNLinearSolver solver) {
    return ((const struct content *)solver->content)->singular;
}

static void free_content(struct content *c) {
    free(c->work);
    free(c->reciprocals);
    free(c->reversed);
    free(c->pivots);
    free(c->lower);
    free(c->upper);
    free(c->lower_starts);
    free(c->upper_starts);
    free(c);
}

static int release(SUNLinearSolver solver) {
    free_content(solver->content);
    solver->content = NULL;
    SUNLinSolFreeEmpty(solver);
    return SUNLS_SUCCESS;
}

static struct content *make_content(int n) {
    struct content *c = calloc(1, sizeof *c);
    if (c == NULL)
        return NULL;
    size_t rows = (size_t)n;
    c->n = n;
    c->work = calloc(rows * rows, sizeof *c->work);
    c->reciprocals = calloc(rows, sizeof *c->reciprocals);
    c->reversed = calloc(rows, sizeof *c->reversed);
    c->pivots = calloc(rows, sizeof *c->pivots);
    c->lower = calloc(rows * rows, sizeof *c->lower);
    c->upper = calloc(rows * rows, sizeof *c->upper);
    c->lower_starts = calloc(rows + 1, sizeof *c->lower_starts);
    c->upper_starts = calloc(rows + 1, sizeof *c->upper_starts);
    if (c->work == NULL || c->reciprocals == NULL || c->reversed == NULL || c->pivots == NULL || c->lower == NULL ||
        c->upper == NULL || c->lower_starts == NULL || c->upper_starts == NULL) {
        free_content(c);
        return NULL;
    }
    return c;
}

SUNLinearSolver plant_new_dense_solver(int n, SUNContext context) {
    SUNLinearSolver solver = SUNLinSolNewEmpty(context);
    if (solver == NULL)
        return NULL;
    solver->content = make_content(n);
    if (solver->content == NULL) {
        SUNLinSolFreeEmpty(solver);
        return NULL;
    }
    solver->ops->gettype = get_type;
    solver->ops->getid = get_id;
    solver->ops->initialize = initialize;
    solver->ops->setup = factor;
    solver->ops->solve = solve;
    solver->ops->lastflag = last_flag;
    solver->ops->free = release;
    return solver;
}
