/* The analytic Jacobian dF/dy + cj dF/dy', written straight into the matrix: dense for few unknowns, compressed columns
 * and KLU for many. In the taut state branches meet only through x and the charge (an arrow); a slack film ties all
 * branches of its zone together through its natural stretch, so the sparse pattern has a taut and a slack form. */
#include "plant/amplifier.h"
#include "plant/dense.h"
#include "plant/network.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sunlinsol/sunlinsol_klu.h>
#include <sunmatrix/sunmatrix_dense.h>
#include <sunmatrix/sunmatrix_sparse.h>

/* Beyond so many unknowns KLU beats the dense solver, which looks at every zero (instructions of a run with 52
 * unknowns: 136 million against 283, with 104: 197 against 170). */
#define DENSE_LIMIT 60

/* ---- pattern ---- */

static void mark(char *pattern, int n, int row, int column) {
    if (row != ABSENT && column != ABSENT)
        pattern[row * n + column] = 1;
}

static void mark_zone(const struct dea_plant *plant, const struct zone_layout *zone, char *pattern, bool slack) {
    int n = plant->state_count, mover = plant->v != ABSENT ? plant->v : plant->x;
    int states = zone->branch != ABSENT ? 2 * plant->device->material.branch_count : 0;
    mark(pattern, n, mover, zone->charge);
    mark(pattern, n, zone->charge, zone->charge);
    mark(pattern, n, zone->charge, plant->x);
    mark(pattern, n, zone->charge, zone->amplifier);
    mark(pattern, n, zone->amplifier, zone->amplifier);
    for (int i = 0; i < states; i++) {
        int row = zone->branch + i;
        mark(pattern, n, mover, row);
        mark(pattern, n, row, plant->x);
        mark(pattern, n, row, row);
        mark(pattern, n, row, zone->branch + (i ^ 1));
        if (!slack)
            continue;
        mark(pattern, n, row, zone->charge);
        mark(pattern, n, zone->charge, row);
        for (int j = 0; j < states; j++)
            mark(pattern, n, row, zone->branch + j);
    }
}

/* Lays the entries out in the matrix and remembers where each one is. */
static void set_pattern(struct dea_plant *plant, bool slack, char *pattern) {
    int n = plant->state_count;
    memset(pattern, 0, (size_t)n * (size_t)n);
    mark(pattern, n, plant->x, plant->x);
    mark(pattern, n, plant->x, plant->v);
    mark(pattern, n, plant->v, plant->x);
    mark(pattern, n, plant->v, plant->v);
    for (int k = 0; k < DEA_ZONES; k++)
        if (plant->zones[k].present)
            mark_zone(plant, &plant->zones[k], pattern, slack);
    if (plant->network != ABSENT)
        plant_network_mark(plant, pattern, slack);

    sunindextype *pointers = plant->column_starts, *rows = plant->entry_rows;
    int used = 0;
    for (int column = 0; column < n; column++) {
        if (plant->sparse)
            pointers[column] = used;
        for (int row = 0; row < n; row++) {
            if (!plant->sparse) {
                plant->slots[row * n + column] = column * n + row;
            } else if (pattern[row * n + column]) {
                rows[used] = row;
                plant->slots[row * n + column] = used++;
            } else {
                plant->slots[row * n + column] = ABSENT;
            }
        }
    }
    if (plant->sparse)
        pointers[n] = used;
    plant->slack_pattern = slack;
}

/* Entries of the slack pattern, the larger one. */
static sunindextype count_entries(const struct dea_plant *plant) {
    sunindextype states = 2 * plant->device->material.branch_count, n = plant->state_count;
    sunindextype circuit =
        plant->network == ABSENT
            ? 0
            : (sunindextype)(plant->options.network->conductance_count + plant->options.network->capacitance_count) +
                  DEA_ZONES * 2 * (states + 6);
    return 4 * n + 4 + DEA_ZONES * (states * states + 5 * states + 8) + circuit;
}

/* IDA wipes the matrix before each Jacobian, which writes all of it anyway. */
static int leave_entries(SUNMatrix matrix) {
    (void)matrix;
    return 0;
}

enum dea_status plant_make_matrix(struct dea_plant *plant, struct dea_error *error) {
    int n = plant->state_count;
    plant->sparse = n > DENSE_LIMIT;
    plant->slots = malloc((size_t)n * (size_t)n * sizeof *plant->slots);
    char *pattern = malloc((size_t)n * (size_t)n);
    plant->matrix = plant->sparse ? SUNSparseMatrix(n, n, count_entries(plant), CSC_MAT, plant->context)
                                  : SUNDenseMatrix(n, n, plant->context);
    if (plant->slots == NULL || pattern == NULL || plant->matrix == NULL) {
        free(pattern);
        return dea_fail(error, DEA_ERR_MEMORY, "out of memory for a matrix of %d unknowns", n);
    }
    plant->matrix->ops->zero = leave_entries;
    if (plant->sparse) {
        plant->column_starts = calloc((size_t)n + 1, sizeof *plant->column_starts);
        plant->entry_rows = calloc((size_t)SUNSparseMatrix_NNZ(plant->matrix), sizeof *plant->entry_rows);
        if (plant->column_starts == NULL || plant->entry_rows == NULL) {
            free(pattern);
            return dea_fail(error, DEA_ERR_MEMORY, "out of memory for a matrix of %d unknowns", n);
        }
    }
    set_pattern(plant, false, pattern);
    free(pattern);
    plant->solver = plant->sparse ? SUNLinSol_KLU(plant->y, plant->matrix, plant->context)
                                  : plant_new_dense_solver(n, plant->context);
    if (plant->solver == NULL)
        return dea_fail(error, DEA_ERR_MEMORY, "cannot set up the linear solver for %d unknowns", n);
    return DEA_OK;
}

/* Between taut and slack the sparse pattern changes; KLU then orders anew. */
static int follow_slack(struct dea_plant *plant) {
    bool slack = false;
    for (int k = 0; k < DEA_ZONES; k++)
        slack = slack || (plant->zones[k].present && plant->points[k].film.slack);
    if (!plant->sparse || slack == plant->slack_pattern)
        return 0;
    char *pattern = malloc((size_t)plant->state_count * (size_t)plant->state_count);
    if (pattern == NULL)
        return -1;
    set_pattern(plant, slack, pattern);
    free(pattern);
    return SUNLinSol_KLUReInit(plant->solver, plant->matrix, SUNSparseMatrix_NNZ(plant->matrix), SUNKLU_REINIT_PARTIAL);
}

/* ---- entries ---- */

/* Adds d(residual of row)/d(unknown of column), given in SI, to the scaled matrix. */
static void add(const struct dea_plant *plant, double *data, int row, int column, double value) {
    if (row != ABSENT && column != ABSENT)
        data[plant->slots[row * plant->state_count + column]] += value * plant->scale[column] / plant->scale[row];
}

/* How the platform's residual sees a force: divided by mass, by damping, or by the scaling of the balance. */
static double force_weight(const struct dea_plant *plant) {
    const struct dea_device *device = plant->device;
    return plant->motion == MOTION_INERTIAL  ? 1.0 / device->effective_mass
           : plant->motion == MOTION_VISCOUS ? 1.0 / device->damping
                                             : 1.0 / device->stiffness;
}

static void add_platform(const struct dea_plant *plant, double *data, double cj) {
    double weight = force_weight(plant), by_x = plant->force_x;
    for (int k = 0; k < DEA_ZONES; k++)
        if (plant->zones[k].present)
            by_x -= plant->device->zones[k].side * plant->points[k].film.dpull_dx;
    if (plant->motion == MOTION_INERTIAL) {
        add(plant, data, plant->x, plant->x, cj);
        add(plant, data, plant->x, plant->v, -1.0);
        add(plant, data, plant->v, plant->x, -weight * by_x);
        add(plant, data, plant->v, plant->v, cj + weight * (plant->device->damping - plant->force_v));
    } else if (plant->motion == MOTION_VISCOUS) {
        add(plant, data, plant->x, plant->x, cj - weight * (by_x + cj * plant->force_v));
    } else {
        add(plant, data, plant->x, plant->x, -weight * by_x);
    }
}

/* Rows of the branches: own states directly, everything that moves the stretch through it. */
static void add_branches(const struct dea_plant *plant, int k, double *data, double cj) {
    const struct zone_layout *zone = &plant->zones[k];
    const struct zone_point *point = &plant->points[k];
    const struct dea_film *film = &point->film;
    int count = plant->device->material.branch_count, mover = plant->v != ABSENT ? plant->v : plant->x;
    double weight = force_weight(plant) * plant->device->zones[k].side;
    for (int b = 0; b < count; b++) {
        const struct dea_branch_response *branch = &point->branches[b];
        for (int i = 0; i < 2; i++) {
            int row = zone->branch + 2 * b + i;
            add(plant, data, mover, row, weight * film->dpull_dp1 * branch->dp1_dz[i]);
            add(plant, data, row, row, cj);
            for (int j = 0; j < 2; j++)
                add(plant, data, row, zone->branch + 2 * b + j, -branch->drate_dz[i][j]);
            if (!film->slack) {
                add(plant, data, row, plant->x, -branch->drate_dlam1[i] * film->dlam_dx);
                continue;
            }
            add(plant, data, row, zone->charge, -branch->drate_dlam1[i] * film->dlam_de);
            for (int other = 0; other < count; other++)
                for (int j = 0; j < 2; j++)
                    add(plant, data, row, zone->branch + 2 * other + j,
                        -branch->drate_dlam1[i] * film->dlam_dp1 * point->branches[other].dp1_dz[j]);
        }
    }
}

static void add_charge(const struct dea_plant *plant, int k, double *data, double cj) {
    const struct zone_layout *zone = &plant->zones[k];
    const struct zone_point *point = &plant->points[k];
    const struct dea_film *film = &point->film;
    int mover = plant->v != ABSENT ? plant->v : plant->x;
    add(plant, data, mover, zone->charge, force_weight(plant) * plant->device->zones[k].side * film->dpull_de);

    if (zone->kind == DEA_PORT_NETWORK && !zone->resistive)
        return; /* its row is a constraint, written with the circuit's */

    /* rate = current - leak, by voltage and stretch */
    double by_v = point->current_v - point->leak_v;
    double by_lam = point->current_lam - point->leak_lam + by_v * film->dvoltage_dlam;
    add(plant, data, zone->charge, zone->charge, cj - by_v * film->dvoltage_de - by_lam * film->dlam_de);
    add(plant, data, zone->charge, plant->x, -by_lam * film->dlam_dx);
    add(plant, data, zone->charge, zone->amplifier, -point->current_emf);
    if (film->slack && zone->branch != ABSENT)
        for (int b = 0; b < plant->device->material.branch_count; b++)
            for (int i = 0; i < 2; i++)
                add(plant, data, zone->charge, zone->branch + 2 * b + i,
                    -by_lam * film->dlam_dp1 * point->branches[b].dp1_dz[i]);
}

static void add_amplifier(const struct dea_plant *plant, int k, double t, double *data, double cj) {
    const struct zone_layout *zone = &plant->zones[k];
    double command = dea_piece_value(&plant->inputs.source[k], t, NULL);
    double rate = zone->pole * (command - plant->points[k].emf);
    bool slewing = plant_limit_holds(plant, zone->slew_limit, rate, zone->slew);
    add(plant, data, zone->amplifier, zone->amplifier, slewing ? cj : cj + zone->pole);
}

int plant_jacobian(sunrealtype t, sunrealtype cj, N_Vector y, N_Vector yp, N_Vector residual, SUNMatrix matrix,
                   void *context, N_Vector tmp1, N_Vector tmp2, N_Vector tmp3) {
    struct dea_plant *plant = context;
    (void)residual, (void)tmp1, (void)tmp2, (void)tmp3;
    const double *u = NV_DATA_S(y), *up = NV_DATA_S(yp);
    plant->rates_now = up;
    if (plant_evaluate(plant, t, u, plant_velocity(plant, u, up), true) != DEA_OK)
        return 1;
    if (follow_slack(plant) != 0)
        return -1;
    double *data;
    size_t n = (size_t)plant->state_count, entries = n * n;
    if (plant->sparse) {
        entries = (size_t)plant->column_starts[n];
        memcpy(SUNSparseMatrix_IndexPointers(matrix), plant->column_starts, (n + 1) * sizeof *plant->column_starts);
        memcpy(SUNSparseMatrix_IndexValues(matrix), plant->entry_rows, entries * sizeof *plant->entry_rows);
        data = SUNSparseMatrix_Data(matrix);
    } else {
        data = SUNDenseMatrix_Data(matrix);
    }
    memset(data, 0, entries * sizeof *data);
    add_platform(plant, data, cj);
    for (int k = 0; k < DEA_ZONES; k++) {
        if (!plant->zones[k].present)
            continue;
        if (plant->zones[k].branch != ABSENT)
            add_branches(plant, k, data, cj);
        if (plant->zones[k].charge != ABSENT)
            add_charge(plant, k, data, cj);
        if (plant->zones[k].amplifier != ABSENT)
            add_amplifier(plant, k, t, data, cj);
    }
    if (plant->network != ABSENT)
        plant_network_jacobian(plant, cj, data);
    return 0;
}
