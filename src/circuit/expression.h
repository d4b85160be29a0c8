/* Arithmetic in netlists, as far as it is worked out without ngspice: numbers, names, + - * / and brackets. */
#ifndef DEASIM_CIRCUIT_EXPRESSION_H
#define DEASIM_CIRCUIT_EXPRESSION_H

#include <stdbool.h>

enum operation { PUT_NUMBER, PUT_VALUE, ADD, SUBTRACT, MULTIPLY, DIVIDE, NEGATE };

#define EXPRESSION_MAX 24 /* operations; longer ones are left to ngspice */

/* In postfix order. */
struct expression {
    struct {
        enum operation operation;
        int value;     /* of PUT_VALUE: index into a row */
        double number; /* of PUT_NUMBER */
    } terms[EXPRESSION_MAX];
    int count;
};

/* What the values of a row are called. */
struct row_names {
    const char *const *names;
    int count;
};

/* Lower-case text. Names are parameters, or v(node) and i(source). False: not understood. */
bool expression_read(struct expression *expression, const char *text, const struct row_names *names);
bool expression_read_parameters(struct expression *expression, const char *text, const struct row_names *names);

/* The signal of a measure: v(node), i(source) or par('expression'). */
bool expression_read_signal(struct expression *expression, const char *text, const struct row_names *names);

/* Subtracts a number, or another expression; false where that makes it too long. */
bool expression_subtract_number(struct expression *expression, double number);
bool expression_subtract(struct expression *expression, const struct expression *other);

double expression_evaluate(const struct expression *expression, const double *row);

#endif
