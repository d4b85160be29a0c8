/* A signal within a step: the polynomial of order 4 through its values at five rows. */
#include "circuit/measures_internal.h"

#include <float.h>
#include <math.h>

/* Newton's forward differences, their products multiplied out. */
void curve_fit(struct curve *curve, const struct expression *expression, const double *rows, int row_length) {
    double d[DEA_MEASURE_ROWS], *c = curve->coefficients;
    for (int i = 0; i < DEA_MEASURE_ROWS; i++)
        d[i] = curve->rows[i] = expression_evaluate(expression, rows + i * row_length);
    for (int order = 1; order < DEA_MEASURE_ROWS; order++)
        for (int i = DEA_MEASURE_ROWS - 1; i >= order; i--)
            d[i] -= d[i - 1];
    c[0] = d[0];
    c[1] = d[1] - d[2] / 2.0 + d[3] / 3.0 - d[4] / 4.0;
    c[2] = d[2] / 2.0 - d[3] / 2.0 + d[4] * (11.0 / 24.0);
    c[3] = d[3] / 6.0 - d[4] / 4.0;
    c[4] = d[4] / 24.0;
}

/* At a row exactly what was given there: a signal may rest at the very level it is compared with. */
double curve_at(const struct curve *curve, double u) {
    const double *c = curve->coefficients;
    int row = (int)u;
    if (row >= 0 && row <= CURVE_END && (double)row == u)
        return curve->rows[row];
    return c[0] + u * (c[1] + u * (c[2] + u * (c[3] + u * c[4])));
}

static double slope_at(const struct curve *curve, double u) {
    const double *c = curve->coefficients;
    return c[1] + u * (2.0 * c[2] + u * (3.0 * c[3] + u * 4.0 * c[4]));
}

/* Between two places where `function` has different signs, by halving: 40 of a quarter of a step are time's rounding.
 */
static double halve(const struct curve *curve, double (*function)(const struct curve *curve, double u), double low,
                    double high) {
    bool negative = function(curve, low) < 0.0;
    for (int i = 0; i < 40 && high - low > DBL_EPSILON; i++) {
        double middle = 0.5 * (low + high);
        if ((function(curve, middle) < 0.0) == negative)
            low = middle;
        else
            high = middle;
    }
    return 0.5 * (low + high);
}

int curve_places(const struct curve *curve, double low, double high, double places[CURVE_POINTS]) {
    int count = 0;
    double before = slope_at(curve, low);
    places[count++] = low;
    for (double next = floor(low) + 1.0; places[count - 1] < high; next += 1.0) {
        double end = fmin(next, high), slope = slope_at(curve, end);
        if (slope * before < 0.0) {
            double extreme = halve(curve, slope_at, places[count - 1], end);
            if (extreme > places[count - 1] && extreme < end)
                places[count++] = extreme;
        }
        places[count++] = end;
        before = slope;
    }
    return count;
}

double curve_zero(const struct curve *curve, double low, double high) {
    if (curve_at(curve, low) == 0.0)
        return low;
    return curve_at(curve, high) == 0.0 ? high : halve(curve, curve_at, low, high);
}

double curve_integral(const struct curve *curve, double low, double high) {
    const double *c = curve->coefficients;
    double sum[2];
    const double ends[] = {low, high};
    for (int i = 0; i < 2; i++) {
        double u = ends[i];
        sum[i] = u * (c[0] + u * (c[1] / 2.0 + u * (c[2] / 3.0 + u * (c[3] / 4.0 + u * c[4] / 5.0))));
    }
    return sum[1] - sum[0];
}

/* Gauss and Legendre with five places, exact to order 9; places and weights from Abramowitz and Stegun, table 25.4. */
double curve_square_integral(const struct curve *curve, double low, double high) {
    static const double places[] = {0.0, 0.538469310105683, 0.906179845938664};
    static const double weights[] = {0.568888888888889, 0.478628670499366, 0.236926885056189};
    double middle = 0.5 * (low + high), half = 0.5 * (high - low), sum = 0.0;
    for (int i = 0; i < 3; i++)
        for (int sign = -1; sign <= (i > 0 ? 1 : -1); sign += 2)
            sum += weights[i] * pow(curve_at(curve, middle + sign * places[i] * half), 2.0);
    return sum * half;
}
