/* What a linear circuit remembers: its natural modes with the films at rest on it, from the eigenvalues of the pencil
 * G v = -lambda C v (LAPACK's dggev). Errors made while a mode rings are carried on through all its cycles, errors in
 * one that decays slowly add up over the periods of the drive. */
#include "base/library.h"
#include "plant/network.h"

#include <complex.h>
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sundials/sundials_dense.h>

/* Of what the port voltages can be, in units of the accuracy: modes that show less are left alone. */
#define NEGLIGIBLE_SHARE 0.1

/* Of the run's length: a circuit that cannot ring and forgets sooner need not be looked at (loading LAPACK takes as
 * long as a thousand steps). */
#define SHORT_MEMORY 0.05

#define MAX_PIECES 64 /* of a waveform, looked at for its steepest slope */

/* G and C as dggev wants them: columns one after the other, rows and unknowns scaled as the plant's, time in units of
 * the run's length. */
struct pencil {
    int n;
    double time;                 /* s */
    double *a, *b;               /* -G and C; dggev overwrites both */
    double *c;                   /* C once more */
    double *real, *imag, *scale; /* eigenvalues are (real + i imag) / scale */
    double *left, *right;        /* eigenvectors; those of a pair as real and imaginary part */
};

typedef void dggev_function(const char *, const char *, const int *, double *, const int *, double *, const int *,
                            double *, double *, double *, double *, const int *, double *, const int *, double *,
                            const int *, int *, size_t, size_t);

/* ---- the matrices ---- */

/* Scale of an unknown and of a row; the charges of films behind R_e come after the circuit's. */
static double unknown_scale(const struct dea_plant *plant, int i) {
    return i < plant->network_count ? plant->scale[plant->network + i] : plant->scale[plant->network];
}

static double row_scale(const struct dea_plant *plant, int i) {
    return i < plant->network_count ? plant->row_scale[i] : plant->row_scale[0];
}

static void add(const struct dea_plant *plant, const struct pencil *pencil, double *matrix, int row, int column,
                double value) {
    if (row >= 0 && column >= 0)
        matrix[column * pencil->n + row] += value * unknown_scale(plant, column) / row_scale(plant, row);
}

/* An element between two nodes. */
static void add_between(const struct dea_plant *plant, const struct pencil *pencil, double *matrix, int p, int n,
                        double value) {
    add(plant, pencil, matrix, p, p, value);
    add(plant, pencil, matrix, n, n, value);
    add(plant, pencil, matrix, p, n, -value);
    add(plant, pencil, matrix, n, p, -value);
}

/* A film is its capacitance at rest, behind R_e with a node of its own. */
static void add_films(const struct dea_plant *plant, const struct pencil *pencil) {
    int inner = plant->network_count;
    for (int k = 0; k < DEA_ZONES; k++) {
        if (!plant->zones[k].present || plant->zones[k].kind != DEA_PORT_NETWORK)
            continue;
        int p = plant->options.network->ports[k].p, n = plant->options.network->ports[k].n;
        double resistance = dea_zone_resistance(plant->device, k, plant->device->prestretch[0], NULL);
        if (plant->zones[k].resistive) {
            add_between(plant, pencil, pencil->a, p, inner, -1.0 / resistance);
            p = inner++;
        }
        add_between(plant, pencil, pencil->b, p, n, plant->device->zones[k].rest_capacitance / pencil->time);
    }
}

static void fill(const struct dea_plant *plant, const struct pencil *pencil) {
    const struct dea_network *network = plant->options.network;
    for (size_t s = 0; s < network->conductance_count; s++)
        add(plant, pencil, pencil->a, network->conductances[s].row, network->conductances[s].column,
            -network->conductances[s].value);
    for (size_t s = 0; s < network->capacitance_count; s++)
        add(plant, pencil, pencil->b, network->capacitances[s].row, network->capacitances[s].column,
            network->capacitances[s].value / pencil->time);
    add_films(plant, pencil);
    for (int i = 0; i < pencil->n * pencil->n; i++)
        pencil->c[i] = pencil->b[i];
}

/* ---- what excites a mode, and what shows of it ---- */

/* Steepest slope of a waveform in units of its peak, 1/s; INFINITY for a jump. */
static double find_quickness(const struct dea_waveform *waveform, double peak) {
    double steepest = 0.0, t = 0.0, rate;
    struct dea_piece piece, next;
    dea_waveform_piece(waveform, -1.0, &piece); /* what holds before t = 0: a step there is one */
    for (int i = 0; i < MAX_PIECES; i++) {
        steepest = fmax(steepest, piece.kind == DEA_PIECE_LINE
                                      ? fabs(piece.slope)
                                      : (fabs(piece.omega) + fabs(piece.sweep) * fmin(piece.end - t, 1.0)) *
                                            fabs(piece.amplitude));
        if (isinf(piece.end))
            break;
        t = piece.end;
        dea_waveform_piece(waveform, t, &next);
        if (fabs(dea_piece_value(&next, t, &rate) - dea_piece_value(&piece, t, &rate)) > 1e-9 * peak)
            return INFINITY;
        piece = next;
    }
    return steepest / peak;
}

/* Component of an eigenvector. */
static double complex component(const struct pencil *pencil, const double *vectors, int mode, int i) {
    const double *at = vectors + (size_t)mode * (size_t)pencil->n;
    return i < 0 ? 0.0 : pencil->imag[mode] > 0.0 ? at[i] + I * at[pencil->n + i] : at[i];
}

/* u^H C v, by which a mode's excitation is divided. */
static double complex normalise(const struct pencil *pencil, int mode) {
    double complex sum = 0.0;
    for (int column = 0; column < pencil->n; column++)
        for (int row = 0; row < pencil->n; row++)
            if (pencil->c[column * pencil->n + row] != 0.0)
                sum += conj(component(pencil, pencil->left, mode, row)) * pencil->c[column * pencil->n + row] *
                       component(pencil, pencil->right, mode, column);
    return sum;
}

/* What a mode shows at the ports, in units of the sources' values. */
struct showing {
    double jumped[DEA_ZONES]; /* after every source has jumped to its peak */
    double moved[DEA_ZONES];  /* after it has got there at its quickest */
};

static double complex find_kick(const struct dea_plant *plant, const struct pencil *pencil, int mode,
                                const struct dea_network_source *source) {
    double complex kick = 0.0;
    if (source->row >= 0)
        kick += conj(component(pencil, pencil->left, mode, source->row)) / row_scale(plant, source->row);
    if (source->other_row >= 0)
        kick -= conj(component(pencil, pencil->left, mode, source->other_row)) / row_scale(plant, source->other_row);
    return kick;
}

static void find_showing(const struct dea_plant *plant, const struct pencil *pencil, int mode, double complex lambda,
                         struct showing *showing) {
    const struct dea_network *network = plant->options.network;
    double complex norm = normalise(pencil, mode);
    double jumped = 0.0, moved = 0.0, omega = fabs(cimag(lambda)) / pencil->time;
    for (size_t s = 0; s < network->source_count; s++) {
        const struct dea_network_source *source = &network->sources[s];
        double peak = dea_waveform_peak(&source->waveform);
        if (!(peak > 0.0))
            continue;
        double kick = cabs(find_kick(plant, pencil, mode, source) / norm / lambda) * peak;
        jumped += kick;
        moved += kick * (omega > 0.0 ? fmin(find_quickness(&source->waveform, peak) / omega, 1.0) : 1.0);
    }
    memset(showing, 0, sizeof *showing);
    for (int k = 0; k < DEA_ZONES; k++) {
        if (!plant->zones[k].present || plant->zones[k].kind != DEA_PORT_NETWORK)
            continue;
        double across = cabs(component(pencil, pencil->right, mode, network->ports[k].p) -
                             component(pencil, pencil->right, mode, network->ports[k].n));
        showing->jumped[k] = (omega > 0.0 ? 2.0 : 1.0) * jumped * across;
        showing->moved[k] = (omega > 0.0 ? 2.0 : 1.0) * moved * across;
    }
}

/* Largest part of a port's voltage, which is about the sum of what the modes show there, that is a mode's. */
static double find_share(const struct showing *showing, const double sizes[DEA_ZONES]) {
    double share = 0.0;
    for (int k = 0; k < DEA_ZONES; k++)
        if (showing->moved[k] > 0.0)
            share = fmax(share, showing->moved[k] / fmax(sizes[k], DBL_MIN));
    return share < 1.0 ? share : 1.0; /* also where a mode's norm vanishes */
}

/* ---- circuits that forget at once ---- */

static bool can_ring(const struct dea_network *network) {
    for (size_t s = 0; s < network->capacitance_count; s++)
        if (network->capacitances[s].row >= network->node_count) /* an inductor's voltage law */
            return true;
    return false;
}

/* Sum of the time constants, the trace of G^-1 C, in units of the run's length; INFINITY where G is singular. */
static double sum_time_constants(const struct pencil *pencil) {
    int n = pencil->n;
    double sum = 0.0;
    sunrealtype **g = SUNDlsMat_newDenseMat(n, n), *column = malloc((size_t)n * sizeof *column);
    sunindextype *pivots = SUNDlsMat_newIndexArray(n);
    bool good = g != NULL && column != NULL && pivots != NULL;
    if (good) {
        for (int i = 0; i < n * n; i++)
            g[i / n][i % n] = -pencil->a[i];
        good = SUNDlsMat_denseGETRF(g, n, n, pivots) == 0;
    }
    for (int j = 0; good && j < n; j++) {
        memcpy(column, pencil->c + (size_t)j * (size_t)n, (size_t)n * sizeof *column);
        SUNDlsMat_denseGETRS(g, n, pivots, column);
        sum += column[j];
    }
    if (g != NULL)
        SUNDlsMat_destroyMat(g);
    if (pivots != NULL)
        SUNDlsMat_destroyArray(pivots);
    free(column);
    return good && isfinite(sum) ? sum : INFINITY;
}

/* ---- the modes ---- */

static enum dea_status solve(struct pencil *pencil, bool *found, struct dea_error *error) {
    dggev_function *dggev = NULL;
    const struct dea_library_function functions[] = {{"dggev_", &dggev}};
    DEA_TRY(dea_library_load("liblapack.so.3", "liblapack3", functions, 1, error));
    int n = pencil->n, room = 8 * n + 16, info = 0;
    double *work = malloc((size_t)room * sizeof *work);
    if (work == NULL)
        return dea_fail(error, DEA_ERR_MEMORY, "out of memory for the modes of %d unknowns", n);
    dggev("V", "V", &n, pencil->a, &n, pencil->b, &n, pencil->real, pencil->imag, pencil->scale, pencil->left, &n,
          pencil->right, &n, work, &room, &info, 1, 1);
    free(work);
    *found = info == 0;
    return DEA_OK;
}

/* The eigenvalue of a mode, in units of the run's length; false for the other one of a pair and for an unknown without
 * memory. */
static bool get_mode(const struct pencil *pencil, int mode, double complex *lambda) {
    *lambda = (pencil->real[mode] + I * pencil->imag[mode]) / pencil->scale[mode];
    return pencil->imag[mode] >= 0.0 && isfinite(creal(*lambda)) && isfinite(cimag(*lambda)) && *lambda != 0.0;
}

/* Adds up what the modes remember. `showings` is room for one of each. */
static void remember(struct dea_plant *plant, const struct pencil *pencil, struct showing *showings) {
    double complex lambda;
    double sizes[DEA_ZONES] = {0.0};
    for (int mode = 0; mode < pencil->n; mode++) {
        if (!get_mode(pencil, mode, &lambda))
            continue;
        find_showing(plant, pencil, mode, lambda, &showings[mode]);
        for (int k = 0; k < DEA_ZONES; k++)
            sizes[k] += isfinite(showings[mode].jumped[k]) ? showings[mode].jumped[k] : 0.0;
    }
    for (int mode = 0; mode < pencil->n; mode++) {
        if (!get_mode(pencil, mode, &lambda))
            continue;
        double share = find_share(&showings[mode], sizes);
        if (share < NEGLIGIBLE_SHARE * plant->options.accuracy)
            continue;
        double memory = fmin(1.0 / fmax(-creal(lambda), DBL_MIN), 1.0);
        plant->creep = fmax(plant->creep, memory * pencil->time);
        plant->ringing += share * memory * cimag(lambda) / (2.0 * M_PI);
    }
}

static enum dea_status find_modes(struct dea_plant *plant, struct pencil *pencil, struct dea_error *error) {
    bool found;
    plant->creep = 0.0;
    DEA_TRY(solve(pencil, &found, error));
    if (!found)
        return DEA_OK;
    struct showing *showings = calloc((size_t)pencil->n, sizeof *showings);
    if (showings == NULL)
        return dea_fail(error, DEA_ERR_MEMORY, "out of memory for the modes of %d unknowns", pencil->n);
    remember(plant, pencil, showings);
    free(showings);
    return DEA_OK;
}

enum dea_status plant_network_remember(struct dea_plant *plant, struct dea_error *error) {
    plant->ringing = plant->creep = 0.0;
    if (plant->network == ABSENT || !(plant->options.duration > 0.0))
        return DEA_OK;
    struct pencil pencil = {.n = plant->network_count, .time = plant->options.duration};
    for (int k = 0; k < DEA_ZONES; k++)
        pencil.n += plant->zones[k].present && plant->zones[k].resistive ? 1 : 0;
    size_t n = (size_t)pencil.n, square = n * n;
    double *all = calloc(5 * square + 3 * n, sizeof *all);
    if (all == NULL)
        return dea_fail(error, DEA_ERR_MEMORY, "out of memory for the modes of %d unknowns", pencil.n);
    double **const parts[] = {&pencil.a, &pencil.b, &pencil.c, &pencil.left, &pencil.right};
    for (size_t i = 0; i < sizeof parts / sizeof parts[0]; i++)
        *parts[i] = all + i * square;
    pencil.real = all + 5 * square;
    pencil.imag = pencil.real + n;
    pencil.scale = pencil.imag + n;
    fill(plant, &pencil);
    bool rings = can_ring(plant->options.network);
    double sum = rings ? INFINITY : sum_time_constants(&pencil);
    plant->creep = fmin(sum, 1.0) * pencil.time;
    /* what creeps hands on errors from one period of the drive to the next: of one period there is no next */
    bool hands_on = sum > SHORT_MEMORY && plant->options.periods > 1.0;
    enum dea_status status = rings || hands_on ? find_modes(plant, &pencil, error) : DEA_OK;
    free(all);
    return status;
}
