/* IDA's vectors with operations of our own. A step of a dozen unknowns is some fifty of these, short ones: in the
 * library, which Debian builds without optimization and which asks each time for special factors, they cost five times
 * as much. Layout and everything else are those of the serial vector. */
#include "plant/vectors.h"

#include <math.h>
#include <nvector/nvector_serial.h>

enum { MOST_TERMS = 8 }; /* of one combination: IDA's highest order has 6 */

/* Elements go in pairs, read before they are written, so that arguments may be the same vector. */
typedef double two __attribute__((vector_size(16), aligned(8), may_alias));

static two load(const double *from) {
    return *(const two *)(const void *)from;
}

static void store(two values, double *to) {
    *(two *)(void *)to = values;
}

static double *data_of(N_Vector v) {
    return NV_DATA_S(v);
}

static sunindextype length_of(N_Vector v) {
    return NV_LENGTH_S(v);
}

static void add(sunrealtype a, N_Vector x, sunrealtype b, N_Vector y, N_Vector z) {
    const double *u = data_of(x), *v = data_of(y);
    double *w = data_of(z);
    sunindextype n = length_of(z), i = 0;
    for (; i + 2 <= n; i += 2)
        store(a * load(u + i) + b * load(v + i), w + i);
    if (i < n)
        w[i] = a * u[i] + b * v[i];
}

static void fill(sunrealtype c, N_Vector z) {
    double *w = data_of(z);
    sunindextype n = length_of(z);
    for (sunindextype i = 0; i < n; i++)
        w[i] = c;
}

static void scale(sunrealtype c, N_Vector x, N_Vector z) {
    const double *u = data_of(x);
    double *w = data_of(z);
    sunindextype n = length_of(z), i = 0;
    for (; i + 2 <= n; i += 2)
        store(c * load(u + i), w + i);
    if (i < n)
        w[i] = c * u[i];
}

/* sqrt(sum (x w)^2 / n) */
static sunrealtype weighted_norm(N_Vector x, N_Vector weights) {
    const double *u = data_of(x), *w = data_of(weights);
    sunindextype n = length_of(x), i = 0;
    two even = {0.0, 0.0}, odd = even;
    for (; i + 4 <= n; i += 4) {
        two first = load(u + i) * load(w + i), second = load(u + i + 2) * load(w + i + 2);
        even += first * first;
        odd += second * second;
    }
    even += odd;
    double sum = even[0] + even[1];
    for (; i < n; i++)
        sum += u[i] * w[i] * (u[i] * w[i]);
    return sqrt(sum / (double)n);
}

/* z = sum c_k x_k; z may be one of them. */
static int combine(int count, sunrealtype *factors, N_Vector *vectors, N_Vector z) {
    if (count > MOST_TERMS)
        return N_VLinearCombination_Serial(count, factors, vectors, z);
    const double *u[MOST_TERMS] = {NULL};
    double *w = data_of(z);
    sunindextype n = length_of(z), i = 0;
    for (int k = 0; k < count; k++)
        u[k] = data_of(vectors[k]);
    for (; i + 4 <= n; i += 4) {
        two low = factors[0] * load(u[0] + i), high = factors[0] * load(u[0] + i + 2);
        for (int k = 1; k < count; k++) {
            low += factors[k] * load(u[k] + i);
            high += factors[k] * load(u[k] + i + 2);
        }
        store(low, w + i);
        store(high, w + i + 2);
    }
    for (; i < n; i++) {
        double sum = factors[0] * u[0][i];
        for (int k = 1; k < count; k++)
            sum += factors[k] * u[k][i];
        w[i] = sum;
    }
    return 0;
}

/* What the weights of the loss integrals are made with. */

static void take_magnitudes(N_Vector x, N_Vector z) {
    const double *u = data_of(x);
    double *w = data_of(z);
    for (sunindextype i = 0, n = length_of(z); i < n; i++)
        w[i] = fabs(u[i]);
}

static void invert(N_Vector x, N_Vector z) {
    const double *u = data_of(x);
    double *w = data_of(z);
    for (sunindextype i = 0, n = length_of(z); i < n; i++)
        w[i] = 1.0 / u[i];
}

static void add_constant(N_Vector x, sunrealtype c, N_Vector z) {
    const double *u = data_of(x);
    double *w = data_of(z);
    for (sunindextype i = 0, n = length_of(z); i < n; i++)
        w[i] = u[i] + c;
}

static sunrealtype find_least(N_Vector x) {
    const double *u = data_of(x);
    double least = u[0];
    for (sunindextype i = 1, n = length_of(x); i < n; i++)
        least = u[i] < least ? u[i] : least;
    return least;
}

static int add_each(int count, sunrealtype a, N_Vector *x, sunrealtype b, N_Vector *y, N_Vector *z) {
    for (int k = 0; k < count; k++)
        add(a, x[k], b, y[k], z[k]);
    return 0;
}

static int scale_each(int count, sunrealtype *factors, N_Vector *x, N_Vector *z) {
    for (int k = 0; k < count; k++)
        scale(factors[k], x[k], z[k]);
    return 0;
}

N_Vector plant_new_vector(sunindextype length, SUNContext context) {
    N_Vector v = N_VNew_Serial(length, context);
    if (v == NULL)
        return NULL;
    v->ops->nvlinearsum = add;
    v->ops->nvconst = fill;
    v->ops->nvscale = scale;
    v->ops->nvabs = take_magnitudes;
    v->ops->nvinv = invert;
    v->ops->nvaddconst = add_constant;
    v->ops->nvmin = find_least;
    v->ops->nvwrmsnorm = weighted_norm;
    v->ops->nvlinearcombination = combine;
    v->ops->nvlinearsumvectorarray = add_each;
    v->ops->nvscalevectorarray = scale_each;
    fill(0.0, v);
    return v;
}
