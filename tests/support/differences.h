/* Finite differences of high order, to check analytic derivatives against. */
#ifndef DEASIM_TEST_DIFFERENCES_H
#define DEASIM_TEST_DIFFERENCES_H

/* f at x; context is the caller's. */
typedef double (*plain_function)(double x, void *context);

/* Central difference of order 8, step h. */
static inline double differentiate(plain_function f, void *context, double x, double h) {
    static const double c[4] = {4.0 / 5.0, -1.0 / 5.0, 4.0 / 105.0, -1.0 / 280.0};
    double sum = 0.0;
    for (int i = 1; i <= 4; i++)
        sum += c[i - 1] * (f(x + i * h, context) - f(x - i * h, context));
    return sum / h;
}

/* xorshift (Marsaglia 2003): the same random numbers on every machine, in [low, high). */
static inline double draw_between(unsigned long long *state, double low, double high) {
    *state ^= *state << 13;
    *state ^= *state >> 7;
    *state ^= *state << 17;
    return low + (high - low) * ((double)(*state >> 11) / 9007199254740992.0);
}

#endif
