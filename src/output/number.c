/* Decimal numbers for result files, both ways, without printf and scanf in the common range. */
#include "output_internal.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define DIGITS 12
#define EXACT_POWERS 23 /* 10^0 ... 10^22 are exact in a double */

static const double powers[EXACT_POWERS] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,  1e8,  1e9,  1e10, 1e11,
                                            1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};

static int write_with_printf(double value, char *text) {
    char wide[40];
    int length = snprintf(wide, sizeof wide, "%.*g", DIGITS, value);
    memcpy(text, wide, (size_t)length);
    return length;
}

/* value * 10^exponent with at most two rounding errors; |exponent| <= 44. */
static double scale(double value, int exponent) {
    while (exponent >= EXACT_POWERS) {
        value *= powers[EXACT_POWERS - 1];
        exponent -= EXACT_POWERS - 1;
    }
    while (exponent <= -EXACT_POWERS) {
        value /= powers[EXACT_POWERS - 1];
        exponent += EXACT_POWERS - 1;
    }
    return exponent >= 0 ? value * powers[exponent] : value / powers[-exponent];
}

/* Two digits at a time, right to left. */
static void put_digits(uint64_t mantissa, char digits[DIGITS]) {
    for (int i = DIGITS - 2; i >= 0; i -= 2) {
        unsigned pair = (unsigned)(mantissa % 100);
        mantissa /= 100;
        digits[i] = (char)('0' + pair / 10);
        digits[i + 1] = (char)('0' + pair % 10);
    }
}

/* Lays out digits d.ddd x 10^exponent as "%g" does: fixed from 1e-5 below to 12 digits above, else scientific. */
static int lay_out(const char digits[DIGITS], int exponent, char *text) {
    int count = DIGITS; /* without trailing zeros */
    while (count > 1 && digits[count - 1] == '0')
        count--;
    char *out = text;
    if (exponent < -4 || exponent >= DIGITS) {
        *out++ = digits[0];
        if (count > 1) {
            *out++ = '.';
            memcpy(out, digits + 1, (size_t)(count - 1));
            out += count - 1;
        }
        *out++ = 'e';
        *out++ = exponent < 0 ? '-' : '+';
        int magnitude = exponent < 0 ? -exponent : exponent;
        *out++ = (char)('0' + magnitude / 10);
        *out++ = (char)('0' + magnitude % 10);
    } else if (exponent < 0) {
        memcpy(out, "0.0000", 6);
        out += 1 - exponent;
        memcpy(out, digits, (size_t)count);
        out += count;
    } else {
        int whole = exponent + 1;
        memcpy(out, digits, DIGITS);
        out += whole;
        if (count > whole) {
            *out++ = '.';
            memcpy(out, digits + whole, (size_t)(count - whole));
            out += count - whole;
        }
    }
    return (int)(out - text);
}

int dea_number_write(double value, char *text) {
    if (isnan(value)) {
        memcpy(text, "nan", 3);
        return 3;
    }
    char *out = text;
    double magnitude = value;
    if (signbit(value)) {
        *out++ = '-';
        magnitude = -value;
    }
    if (magnitude == 0.0) {
        *out++ = '0';
        return (int)(out - text);
    }
    if (!(magnitude > 1e-32 && magnitude < 1e32))
        return write_with_printf(value, text);

    /* Decimal exponent from the binary one (log10(2) = 0.30103), then corrected by one where needed. */
    int binary;
    frexp(magnitude, &binary);
    int exponent = (int)floor((binary - 1) * 0.30102999566398120);
    double scaled = scale(magnitude, DIGITS - 1 - exponent);
    if (scaled >= 1e12) {
        exponent++;
        scaled = scale(magnitude, DIGITS - 1 - exponent);
    }

    /* The scaled number carries an error below 4e-4; so near a tie printf decides, which is rare. */
    uint64_t mantissa = (uint64_t)scaled;
    double fraction = scaled - (double)mantissa;
    if (fabs(fraction - 0.5) < 1e-3)
        return write_with_printf(value, text);
    if (fraction > 0.5)
        mantissa++;
    if (mantissa < 100000000000 || mantissa >= 1000000000000)
        return write_with_printf(value, text);
    char digits[DIGITS];
    put_digits(mantissa, digits);
    return (int)(out - text) + lay_out(digits, exponent, out);
}

static const char *read_word(const char *text, const char *end, bool negative, double *value) {
    if (end - text >= 3 && strncasecmp(text, "nan", 3) == 0)
        *value = NAN;
    else if (end - text >= 3 && strncasecmp(text, "inf", 3) == 0)
        *value = negative ? -INFINITY : INFINITY;
    else
        return NULL;
    return text + 3;
}

/* Reads "e-12"; leaves *exponent alone when what follows is not an exponent. */
static const char *read_exponent(const char *text, const char *end, int *exponent) {
    const char *in = text;
    if (in >= end || (*in != 'e' && *in != 'E'))
        return text;
    in++;
    bool negative = in < end && *in == '-';
    if (in < end && (*in == '-' || *in == '+'))
        in++;
    if (in >= end || *in < '0' || *in > '9')
        return text;
    int written = 0;
    for (; in < end && *in >= '0' && *in <= '9'; in++)
        if (written < 10000)
            written = 10 * written + (*in - '0');
    *exponent += negative ? -written : written;
    return in;
}

const char *dea_number_read(const char *text, const char *end, double *value) {
    const char *in = text;
    bool negative = in < end && *in == '-';
    if (in < end && (*in == '-' || *in == '+'))
        in++;
    uint64_t mantissa = 0;
    int exponent = 0;
    bool any = false, point = false;
    for (; in < end; in++) {
        if (*in == '.' && !point) {
            point = true;
            continue;
        }
        if (*in < '0' || *in > '9')
            break;
        any = true;
        if (mantissa < 100000000000000000) { /* 18 digits are kept, the others only move the point */
            mantissa = 10 * mantissa + (uint64_t)(*in - '0');
            exponent -= point;
        } else {
            exponent += !point;
        }
    }
    if (!any)
        return read_word(in, end, negative, value);
    in = read_exponent(in, end, &exponent);
    double magnitude = (double)mantissa;
    if (mantissa != 0 && exponent != 0)
        magnitude = exponent >= -44 && exponent <= 44 ? scale(magnitude, exponent)
                                                      : (double)((long double)magnitude * powl(10.0L, exponent));
    *value = negative ? -magnitude : magnitude;
    return in;
}
