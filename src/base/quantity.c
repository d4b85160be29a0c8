/* Numbers with units. udunits2 knows the units; this file keeps it from reading more into a text than was meant:
 * reciprocals ("10 ms" for a frequency), radians hidden in "rpm", offsets ("V @ 3"), logarithms, numbers inside a unit.
 */
#include "deasim/quantity.h"

#include "base/known_units.h"

#include <ctype.h>
#include <errno.h>
#include <locale.h>
#include <math.h>
#include <pthread.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <udunits2.h>

#define UNIT_TEXT_MAX 64

/* Units a user may expect for a dimension, for messages only. */
static const struct dimension {
    const char *si_unit, *name, *examples;
} dimensions[] = {
    {"m", "a length", "um, mm, m"},
    {"s", "a time", "ns, us, ms, s, min, h"},
    {"V", "a voltage", "mV, V, kV"},
    {"V/m", "an electric field", "V/um, MV/m, kV/mm, V/m"},
    {"Pa", "a pressure", "Pa, kPa, MPa, N/mm^2"},
    {"kg", "a mass", "mg, g, kg"},
    {"kg/m^3", "a density", "kg/m^3, g/cm^3"},
    {"Ohm", "a resistance", "Ohm, kOhm, MOhm, GOhm"},
    {"Ohm/sq", "a sheet resistance", "Ohm/sq, kOhm/sq, MOhm/sq"},
    {"Ohm m", "a resistivity", "Ohm m, GOhm m"},
    {"A", "a current", "nA, uA, mA, A"},
    {"C", "a charge", "pC, nC, uC, C"},
    {"F", "a capacitance", "pF, nF, F"},
    {"J", "an energy", "nJ, uJ, mJ, J"},
    {"N", "a force", "uN, mN, N"},
    {"N s/m", "a damping", "N s/m, mN s/m, kg/s"},
    {"N/m", "a stiffness", "N/m, N/mm, kN/m"},
    {"s/m", "an inverse velocity", "s/m, s/mm"},
    {"S/m", "a conductivity", "S/m, nS/m, pS/m"},
    {"V/s", "a slew rate", "V/us, V/ms, kV/s, V/s"},
    {"Hz", "a frequency", "mHz, Hz, kHz, MHz"},
    {"1/s", "a rate", "1/s, 1/ms"},
    {"m/s", "a velocity", "um/s, mm/s, m/s"},
    {"rad", "an angle", "rad, deg"},
    {"1", "a number", "no unit, or %"},
};

/* ---- the unit database ---- */

/* Read once per process and never changed; udunits2's parser is not reentrant, hence the lock. */
static pthread_mutex_t unit_lock = PTHREAD_MUTEX_INITIALIZER;
static ut_system *unit_system;
static locale_t c_locale;

static enum dea_status open_locale(struct dea_error *error) {
    if (c_locale == (locale_t)0)
        c_locale = newlocale(LC_ALL_MASK, "C", (locale_t)0);
    if (c_locale == (locale_t)0)
        return dea_fail(error, DEA_ERR_MEMORY, "out of memory for the C locale");
    return DEA_OK;
}

static enum dea_status open_units(struct dea_error *error) {
    if (unit_system != NULL)
        return DEA_OK;
    ut_set_error_message_handler(ut_ignore);
    unit_system = ut_read_xml(NULL);
    if (unit_system == NULL) {
        ut_status path_status;
        const char *path = ut_get_path_xml(NULL, &path_status);
        return dea_fail(error, DEA_ERR_INPUT,
                        "the unit database %s cannot be read (is the package libudunits2-data installed, and "
                        "UDUNITS2_XML_PATH unset or right?)",
                        path != NULL ? path : "udunits2.xml");
    }
    return DEA_OK;
}

/* What a unit boils down to: a factor, and what else is in it. */
struct unit_makeup {
    double scale;
    bool plain;         /* no offset, logarithm or calendar time anywhere */
    bool dimensionless; /* nothing left but the factor */
};

static ut_status visit_basic(const ut_unit *unit, void *makeup) {
    (void)unit;
    ((struct unit_makeup *)makeup)->dimensionless = false;
    return UT_SUCCESS;
}

static ut_status visit_product(const ut_unit *unit, int count, const ut_unit *const *basics, const int *powers,
                               void *makeup) {
    (void)unit;
    (void)basics;
    (void)powers;
    if (count > 0)
        ((struct unit_makeup *)makeup)->dimensionless = false;
    return UT_SUCCESS;
}

static ut_status visit_galilean(const ut_unit *unit, double scale, const ut_unit *inner, double offset, void *data);

static ut_status visit_timestamp(const ut_unit *unit, const ut_unit *time_unit, double origin, void *makeup) {
    (void)unit;
    (void)time_unit;
    (void)origin;
    ((struct unit_makeup *)makeup)->plain = false;
    return UT_SUCCESS;
}

static ut_status visit_logarithm(const ut_unit *unit, double base, const ut_unit *reference, void *makeup) {
    (void)unit;
    (void)base;
    (void)reference;
    ((struct unit_makeup *)makeup)->plain = false;
    return UT_SUCCESS;
}

static const ut_visitor makeup_visitor = {visit_basic, visit_product, visit_galilean, visit_timestamp, visit_logarithm};

static ut_status visit_galilean(const ut_unit *unit, double scale, const ut_unit *inner, double offset, void *data) {
    struct unit_makeup *makeup = data;
    (void)unit;
    makeup->scale *= scale;
    if (offset != 0)
        makeup->plain = false;
    return ut_accept_visitor(inner, &makeup_visitor, makeup);
}

static struct unit_makeup unit_makeup_of(const ut_unit *unit) {
    struct unit_makeup makeup = {.scale = 1, .plain = true, .dimensionless = true};
    if (unit == NULL || ut_accept_visitor(unit, &makeup_visitor, &makeup) != UT_SUCCESS)
        makeup.plain = makeup.dimensionless = false;
    return makeup;
}

enum unit_match { UNIT_MATCHES, UNIT_UNKNOWN, UNIT_OTHER_DIMENSION };

/* Factor from `text` to `si_unit` (NULL: to the SI base of whatever it is). */
static enum unit_match match_unit(const char *text, const char *si_unit, double *scale) {
    ut_unit *unit = ut_parse(unit_system, text, UT_UTF8);
    if (unit == NULL)
        return UNIT_UNKNOWN;
    struct unit_makeup makeup = unit_makeup_of(unit);
    enum unit_match match = makeup.plain ? UNIT_MATCHES : UNIT_UNKNOWN;
    if (match == UNIT_MATCHES && si_unit != NULL) {
        /* a quotient instead of ut_are_convertible, which would also convert reciprocals and radians */
        ut_unit *target = ut_parse(unit_system, si_unit, UT_UTF8);
        ut_unit *quotient = target != NULL ? ut_divide(unit, target) : NULL;
        makeup = unit_makeup_of(quotient);
        if (!makeup.dimensionless || !makeup.plain)
            match = UNIT_OTHER_DIMENSION;
        ut_free(quotient);
        ut_free(target);
    }
    ut_free(unit);
    *scale = makeup.scale;
    return match;
}

/* ---- text ---- */

/* true for unit texts of letters, products, quotients and integer powers. Anything else udunits2 would read in its own
 * way: numbers inside ("3 300 V"), unbalanced brackets, shifts. */
static bool looks_like_unit(const char *text) {
    const char *p = text[0] == '1' && text[1 + strspn(text + 1, " ")] == '/' ? text + 1 : text;
    bool after_letter = false;
    for (; *p != '\0'; p++) {
        unsigned char c = (unsigned char)*p;
        if (isalpha(c) || c >= 0x80 || c == '%') {
            after_letter = true;
        } else if (isdigit(c)) {
            if (!after_letter)
                return false;
        } else if (c == '^' || c == '-') {
            if (!after_letter)
                return false;
            if (c == '^' && p[1] == '-')
                p++;
            if (!isdigit((unsigned char)p[1]) && (c == '^' || !isalpha((unsigned char)p[1])))
                return false;
        } else if (c == '.' || c == '*' || c == '/' || c == ' ') {
            after_letter = false;
            if (c == '.' && !isalpha((unsigned char)p[1]))
                return false;
        } else {
            return false;
        }
    }
    return true;
}

/* Rewrites what users write and udunits2 does not know: "deg", and "/sq" of a sheet resistance. */
static bool translate_unit(const char *text, const char **si_unit, char *unit) {
    size_t length = strlen(text);
    if (length >= UNIT_TEXT_MAX)
        return false;
    memcpy(unit, text, length + 1);
    if (*si_unit != NULL && strcmp(*si_unit, "Ohm/sq") == 0) {
        *si_unit = "Ohm";
        static const char *const suffixes[] = {"/sq", "/square", "/\u25a1"};
        for (size_t i = 0; i < sizeof suffixes / sizeof suffixes[0]; i++) {
            size_t suffix = strlen(suffixes[i]);
            if (length > suffix && strcmp(unit + length - suffix, suffixes[i]) == 0)
                unit[length - suffix] = '\0';
        }
    }
    if (strcmp(unit, "deg") == 0)
        memcpy(unit, "degree", sizeof "degree");
    return true;
}

static const struct dimension *find_dimension(const char *si_unit) {
    for (size_t i = 0; si_unit != NULL && i < sizeof dimensions / sizeof dimensions[0]; i++)
        if (strcmp(dimensions[i].si_unit, si_unit) == 0)
            return &dimensions[i];
    return NULL;
}

/* Removes spaces and dots between the parts of a unit, so that "Ns/m" and "n s/M" compare to "N s/m". */
static void squeeze(const char *text, size_t length, char *out) {
    size_t n = 0;
    for (size_t i = 0; i < length && n + 1 < UNIT_TEXT_MAX; i++)
        if (text[i] != ' ' && text[i] != '.' && text[i] != '*')
            out[n++] = text[i];
    out[n] = '\0';
}

/* The example of a dimension that differs from `unit` only in case or spacing; its length in *length, NULL when none.
 */
static const char *near_example(const char *examples, const char *unit, size_t *length) {
    char wanted[UNIT_TEXT_MAX], candidate[UNIT_TEXT_MAX];
    squeeze(unit, strlen(unit), wanted);
    for (const char *p = examples; *p != '\0'; p += strspn(p, ", ")) {
        *length = strcspn(p, ",");
        squeeze(p, *length, candidate);
        if (strcasecmp(wanted, candidate) == 0)
            return p;
        p += *length;
    }
    return NULL;
}

static enum dea_status refuse_unit(enum unit_match match, const char *unit, const char *si_unit,
                                   struct dea_error *error) {
    const struct dimension *dimension = find_dimension(si_unit);
    const char *examples = dimension != NULL ? dimension->examples : si_unit != NULL ? si_unit : "mm, ms, kV, uA";
    if (match == UNIT_OTHER_DIMENSION)
        return dea_fail(error, DEA_ERR_INPUT, "unit '%s' is not that of %s; allowed: %s", unit,
                        dimension != NULL ? dimension->name : "this quantity", examples);
    static const char *const prefixes[] = {"f", "p", "n", "u", "m", "k", "K", "M", "Meg", "meg", "MEG", "G", "g", "T"};
    for (size_t i = 0; i < sizeof prefixes / sizeof prefixes[0]; i++)
        if (strcmp(unit, prefixes[i]) == 0)
            return dea_fail(error, DEA_ERR_INPUT,
                            "'%s' alone is not a unit (a SPICE suffix is not read here); allowed: %s", unit, examples);
    size_t length = 0;
    const char *near_unit = near_example(examples, unit, &length);
    if (near_unit != NULL)
        return dea_fail(error, DEA_ERR_INPUT, "unknown unit '%s'; did you mean '%.*s'? allowed: %s", unit, (int)length,
                        near_unit, examples);
    return dea_fail(error, DEA_ERR_INPUT, "unknown unit '%s'; allowed: %s", unit, examples);
}

/* Reads the number in front; *rest points behind it. */
static enum dea_status parse_number(const char *text, const char **rest, double *value, struct dea_error *error) {
    const char *digits = text + strspn(text, "+-");
    if (strncasecmp(digits, "nan", 3) == 0 || strncasecmp(digits, "inf", 3) == 0)
        return dea_fail(error, DEA_ERR_INPUT, "'%.40s' is not a finite number", text);
    if (digits - text > 1 || !(isdigit((unsigned char)digits[0]) || digits[0] == '.') ||
        (digits[0] == '0' && tolower((unsigned char)digits[1]) == 'x'))
        return dea_fail(error, DEA_ERR_INPUT, "'%.40s' is not a number with a unit", text);
    char *end;
    errno = 0;
    *value = strtod_l(text, &end, c_locale);
    if (end == text)
        return dea_fail(error, DEA_ERR_INPUT, "'%.40s' is not a number with a unit", text);
    if (!isfinite(*value))
        return dea_fail(error, DEA_ERR_INPUT, "'%.40s' is too large a number", text);
    if (*end == ',' || *end == '_')
        return dea_fail(error, DEA_ERR_INPUT, "'%.40s': '%c' is not allowed in a number; use a decimal point", text,
                        *end);
    *rest = end + strspn(end, " \t");
    return DEA_OK;
}

/* value * scale, correctly rounded when the scale is 1/10^n, so that "33 um" is exactly 33e-6. */
static double apply_scale(double value, double scale) {
    double inverse = nearbyint(1 / scale);
    return scale < 1 && inverse < 1e18 && fabs(scale * inverse - 1) < 4e-16 ? value / inverse : value * scale;
}

static enum dea_status parse_locked(const char *text, const char *si_unit, double *value, struct dea_error *error) {
    DEA_TRY(open_locale(error));
    const char *rest = text;
    double number = 0, scale = 1;
    DEA_TRY(parse_number(text, &rest, &number, error));
    if (*rest != '\0') {
        const char *target = si_unit;
        char unit[UNIT_TEXT_MAX];
        enum unit_match match = UNIT_UNKNOWN;
        if (looks_like_unit(rest) && translate_unit(rest, &target, unit)) {
            const struct known_unit *known = find_known_unit(unit, target);
            DEA_TRY(known != NULL ? DEA_OK : open_units(error));
            /* udunits2 reads numbers inside units with the locale of the thread */
            locale_t before = uselocale(c_locale);
            match = known != NULL ? UNIT_MATCHES : match_unit(unit, target, &scale);
            uselocale(before);
            scale = known != NULL ? known->scale : scale;
        }
        char shown[UNIT_TEXT_MAX];
        snprintf(shown, sizeof shown, "%.40s", rest);
        if (match != UNIT_MATCHES)
            return refuse_unit(match, shown, si_unit, error);
    }
    number = apply_scale(number, scale);
    if (!isfinite(number))
        return dea_fail(error, DEA_ERR_INPUT, "'%.40s' is too large a number", text);
    *value = number;
    return DEA_OK;
}

enum dea_status dea_quantity_parse(const char *text, const char *si_unit, double *value, struct dea_error *error) {
    char trimmed[256];
    text += strspn(text, " \t\r\n");
    size_t length = strlen(text);
    while (length > 0 && strchr(" \t\r\n", text[length - 1]) != NULL)
        length--;
    if (length == 0)
        return dea_fail(error, DEA_ERR_INPUT, "a number is missing");
    if (length >= sizeof trimmed)
        return dea_fail(error, DEA_ERR_INPUT, "'%.40s...' is not a number with a unit", text);
    memcpy(trimmed, text, length);
    trimmed[length] = '\0';
    pthread_mutex_lock(&unit_lock);
    enum dea_status status = parse_locked(trimmed, si_unit, value, error);
    pthread_mutex_unlock(&unit_lock);
    return status;
}

/* ---- printing ---- */

const char *dea_quantity_kind(const char *si_unit) {
    const struct dimension *dimension = find_dimension(si_unit);
    return dimension != NULL ? dimension->name : "a quantity";
}

static bool takes_prefix(const char *unit) {
    static const char *const bare[] = {"1", "1/s", "kg/m^3", "rad", "m^2", "m^3"};
    for (size_t i = 0; i < sizeof bare / sizeof bare[0]; i++)
        if (strcmp(unit, bare[i]) == 0)
            return false;
    return true;
}

const char *dea_quantity_format(double value, const char *si_unit, char *buffer, int size) {
    static const struct {
        double factor;
        const char *symbol;
    } prefixes[] = {{1e12, "T"}, {1e9, "G"},  {1e6, "M"},  {1e3, "k"},   {1, ""},
                    {1e-3, "m"}, {1e-6, "u"}, {1e-9, "n"}, {1e-12, "p"}, {1e-15, "f"}};
    if (size <= 0)
        return buffer;
    const char *unit = strcmp(si_unit, "kg") == 0 ? "g" : si_unit;
    const char *symbol = "";
    if (unit != si_unit)
        value *= 1000;
    bool is_time = strcmp(unit, "s") == 0;
    bool in_reach = fabs(value) >= 1e-15 && fabs(value) < 1e15; /* beyond, a power of ten reads better */
    if (in_reach && takes_prefix(unit)) {
        size_t i = is_time ? 4 : 0, last = sizeof prefixes / sizeof prefixes[0] - 1;
        while (i < last && fabs(value) < prefixes[i].factor * 0.99995)
            i++;
        value /= prefixes[i].factor;
        symbol = prefixes[i].symbol;
    }
    if (strcmp(unit, "1") == 0)
        snprintf(buffer, (size_t)size, "%.4g", value);
    else
        snprintf(buffer, (size_t)size, "%.4g %s%s", value, symbol, unit);
    return buffer;
}
