/* Parts of .measure: signals within a step (measure_curve.c), lines (measure_read.c), following a run (measures.c). */
#ifndef DEASIM_CIRCUIT_MEASURES_INTERNAL_H
#define DEASIM_CIRCUIT_MEASURES_INTERNAL_H

#include "circuit/expression.h"
#include "circuit/measures.h"

/* ---- measure_curve.c ---- */

enum { CURVE_END = DEA_MEASURE_ROWS - 1, CURVE_POINTS = 2 * DEA_MEASURE_ROWS + 2 };

/* A signal within a step, as a polynomial of u = 0 .. CURVE_END, a whole number at every row. */
struct curve {
    double rows[DEA_MEASURE_ROWS], coefficients[DEA_MEASURE_ROWS];
};

void curve_fit(struct curve *curve, const struct expression *expression, const double *rows, int row_length);
double curve_at(const struct curve *curve, double u);

/* Places from low to high, rising: both ends, the rows and the extremes in between. Returns how many. */
int curve_places(const struct curve *curve, double low, double high, double places[CURVE_POINTS]);

/* Where the curve passes zero between two places with values of different sign; `low` where it starts at zero. */
double curve_zero(const struct curve *curve, double low, double high);

/* Integrals over u of the signal and of its square. */
double curve_integral(const struct curve *curve, double low, double high);
double curve_square_integral(const struct curve *curve, double low, double high);

/* ---- measure_read.c ---- */

enum measure_kind {
    MEASURE_MAX,
    MEASURE_MIN,
    MEASURE_PEAK_TO_PEAK,
    MEASURE_MAX_AT,
    MEASURE_MIN_AT,
    MEASURE_MEAN,
    MEASURE_RMS,
    MEASURE_INTEGRAL,
    MEASURE_WHEN,
    MEASURE_FIND_AT,
    MEASURE_FIND_WHEN,
    MEASURE_DELAY /* from TRIG to TARG */
};

enum edge { EDGE_ANY, EDGE_RISE, EDGE_FALL };

/* A moment: given, or when a signal passes zero for the n-th time. */
struct moment {
    struct expression signal; /* less the level */
    enum edge edge;
    int number;      /* which passage; LAST_PASSAGE: the last one */
    double from, to; /* s, looked for in between */
    bool given;
    /* as the run goes on */
    bool begun, found;
    int side, passages; /* sign of the signal; passages so far */
    double before;      /* the signal at the last place */
    double time;        /* s, where found */
};

enum { LAST_PASSAGE = -1 };

struct measure {
    enum measure_kind kind;
    struct expression signal;   /* what is averaged, found and so on */
    double from, to;            /* s, its window */
    struct moment moment, targ; /* WHEN, AT or TRIG; TARG */
    /* as the run goes on */
    bool begun;
    double most, least, most_at, least_at; /* and times in s */
    double sum, covered;                   /* integral; s */
    double value;                          /* of FIND */
};

/* One line in lower case, behind its name. False: not understood. */
bool measure_read(struct measure *measure, char *text, const struct row_names *names);

#endif
