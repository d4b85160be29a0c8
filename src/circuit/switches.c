/* When the circuit's switches turn, and landing just before. */
#include "circuit/switches.h"

#include "circuit/engine_internal.h"
#include "circuit/netlist_internal.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#define CLOSE 1e-12       /* of the run: the least step that passes a threshold */
#define CLOSE_PART 1e-2   /* of the step before: the length of the one that passes a threshold */
#define MOST_LANDINGS 5.0 /* in a row, then one in five points: a control that hovers must not stop the run */
#define LANDING_CREDIT 0.2

enum { WORDS_MAX = 64, POINTS = 3 };

struct control {
    char plus[300], minus[300]; /* vectors; minus empty: ground or none */
    int plus_vector, minus_vector;
    double on, off; /* turns on when above, off when below; V or A */
    bool known, is_on;
    double values[POINTS]; /* at the last accepted points, the latest first */
    double credit;         /* landings allowed */
    double passing;        /* s: just before its threshold, the step that passes it; else 0 */
};

struct dea_switches {
    struct control *controls; /* owned */
    int count;
    double times[POINTS]; /* s, the latest first */
    int points;
};

/* ---- finding them ---- */

struct words {
    char *line; /* owned */
    char *word[WORDS_MAX];
    int count;
};

static bool cut_words(struct words *words, const char *text) {
    free(words->line);
    words->count = 0;
    words->line = strdup(text);
    if (words->line == NULL)
        return false;
    for (char *c = words->line; *c != '\0'; c++)
        *c = strchr("(),=", *c) != NULL ? ' ' : (char)tolower((unsigned char)*c);
    char *rest = words->line;
    for (char *word = strtok_r(rest, " \t", &rest); word != NULL && words->count < WORDS_MAX;
         word = strtok_r(NULL, " \t", &rest))
        words->word[words->count++] = word;
    return true;
}

/* ngspice reads commands by its own rules: only a plain name can be part of one. */
static bool is_plain(const char *name) {
    for (const char *c = name; *c != '\0'; c++)
        if (!isalnum((unsigned char)*c) && strchr("_.:", *c) == NULL)
            return false;
    return strlen(name) < 280;
}

/* Threshold and hysteresis of a switch model; false when it is none. */
static bool read_model(const struct words *words, const char *kind, double *threshold, double *hysteresis) {
    *threshold = *hysteresis = 0.0;
    if (words->count < 3 || strcmp(words->word[2], kind) != 0)
        return false;
    for (int i = 3; i + 1 < words->count; i++) {
        const char *key = words->word[i];
        if (key[0] != (kind[0] == 'c' ? 'i' : 'v'))
            continue;
        if (strcmp(key + 1, "t") == 0 && !dea_spice_number(words->word[i + 1], threshold))
            return false;
        if (strcmp(key + 1, "h") == 0 && !dea_spice_number(words->word[i + 1], hysteresis))
            return false;
    }
    return true;
}

static bool find_model(const struct dea_listing *listing, const char *name, const char *kind, double *threshold,
                       double *hysteresis) {
    struct words words = {0};
    bool found = false;
    for (int i = 0; i < listing->count && !found; i++)
        if (strncasecmp(listing->lines[i], ".model", 6) == 0 && cut_words(&words, listing->lines[i]))
            found =
                words.count > 2 && strcmp(words.word[1], name) == 0 && read_model(&words, kind, threshold, hysteresis);
    free(words.line);
    return found;
}

/* S name p n c+ c- model, W name p n source model. */
static bool read_control(const struct dea_listing *listing, const struct words *words, struct control *control) {
    bool by_voltage = words->word[0][0] == 's';
    double threshold, hysteresis;
    *control = (struct control){.credit = MOST_LANDINGS};
    if (words->count < (by_voltage ? 6 : 5) ||
        !find_model(listing, words->word[by_voltage ? 5 : 4], by_voltage ? "sw" : "csw", &threshold, &hysteresis))
        return false;
    for (int i = 3; i < (by_voltage ? 5 : 4); i++)
        if (!is_plain(words->word[i]))
            return false;
    if (by_voltage) {
        snprintf(control->plus, sizeof control->plus, "%s", words->word[3]);
        snprintf(control->minus, sizeof control->minus, "%s", words->word[4]);
    } else {
        snprintf(control->plus, sizeof control->plus, "%s#branch", words->word[3]);
        snprintf(control->minus, sizeof control->minus, "0");
    }
    control->on = threshold + fabs(hysteresis);
    control->off = threshold - fabs(hysteresis);
    return isfinite(control->on) && isfinite(control->off);
}

/* Whether the netlist names a switch anywhere. */
static bool has_switches(const struct dea_netlist *netlist) {
    for (int i = 1; i < netlist->line_count; i++)
        if (netlist->lines[i].passed && strchr("sSwW", netlist->lines[i].text[0]) != NULL)
            return true;
    return false;
}

static void save(const char *name) {
    if (strcmp(name, "0") == 0)
        return;
    char command[320];
    snprintf(command, sizeof command, strchr(name, '#') != NULL ? "save %s" : "save v(%s)", name);
    dea_engine_command(command);
}

static enum dea_status read_switches(struct dea_switches *switches, const struct dea_listing *listing,
                                     struct dea_error *error) {
    struct words words = {0};
    enum dea_status status = DEA_OK;
    for (int i = 0; i < listing->count && status == DEA_OK; i++) {
        if (strchr("sSwW", listing->lines[i][0]) == NULL)
            continue;
        struct control *controls = dea_grow(switches->controls, switches->count, sizeof *controls);
        if (controls != NULL)
            switches->controls = controls;
        if (controls == NULL || !cut_words(&words, listing->lines[i]))
            status = dea_fail(error, DEA_ERR_MEMORY, "out of memory for the circuit's switches");
        else if (words.count > 0 && read_control(listing, &words, &controls[switches->count]))
            switches->count++;
    }
    free(words.line);
    return status;
}

enum dea_status dea_switches_find(struct dea_engine *engine, struct dea_switches **made, struct dea_error *error) {
    *made = NULL;
    if (!has_switches(engine->netlist))
        return DEA_OK;
    struct dea_listing listing;
    enum dea_status status = dea_engine_list(engine, &listing, error);
    struct dea_switches *switches = calloc(1, sizeof *switches);
    if (status == DEA_OK && switches == NULL)
        status = dea_fail(error, DEA_ERR_MEMORY, "out of memory for the circuit's switches");
    if (status == DEA_OK)
        status = read_switches(switches, &listing, error);
    for (int i = 0; status == DEA_OK && i < switches->count; i++) {
        save(switches->controls[i].plus);
        save(switches->controls[i].minus);
    }
    dea_listing_clear(&listing);
    if (status != DEA_OK)
        dea_switches_destroy(switches);
    else
        *made = switches;
    return status;
}

void dea_switches_destroy(struct dea_switches *switches) {
    if (switches != NULL)
        free(switches->controls);
    free(switches);
}

/* ---- following them ---- */

void dea_switches_map(struct dea_switches *switches, const vecvaluesall *values) {
    for (int i = 0; i < switches->count; i++) {
        struct control *control = &switches->controls[i];
        control->plus_vector = dea_engine_find_vector(values, control->plus);
        control->minus_vector = dea_engine_find_vector(values, control->minus);
        if (control->plus_vector < -1 || control->minus_vector < -1) /* not delivered: cannot be followed */
            *control = switches->controls[--switches->count], i--;
    }
}

void dea_switches_follow(struct dea_switches *switches, double time, const vecvaluesall *values) {
    memmove(&switches->times[1], &switches->times[0], (POINTS - 1) * sizeof switches->times[0]);
    switches->times[0] = time;
    if (switches->points < POINTS)
        switches->points++;
    for (int i = 0; i < switches->count; i++) {
        struct control *control = &switches->controls[i];
        double plus = control->plus_vector < 0 ? 0.0 : values->vecsa[control->plus_vector]->creal;
        double minus = control->minus_vector < 0 ? 0.0 : values->vecsa[control->minus_vector]->creal;
        memmove(&control->values[1], &control->values[0], (POINTS - 1) * sizeof control->values[0]);
        control->values[0] = plus - minus;
        if (control->values[0] > control->on || control->values[0] < control->off) {
            control->known = true;
            control->is_on = control->values[0] > control->on;
        }
        control->credit = fmin(control->credit + LANDING_CREDIT, MOST_LANDINGS);
    }
}

/* Time until value + rate d + bend d^2 reaches the level; INFINITY when it goes elsewhere. */
static double reach(double distance, double rate, double bend) {
    /* bend d^2 + rate d - distance = 0, the smaller positive root, without cancellation */
    double discriminant = rate * rate + 4.0 * bend * distance;
    if (discriminant < 0.0)
        return INFINITY;
    double q = rate + copysign(sqrt(discriminant), rate), first = 2.0 * distance / q, second = -0.5 * q / bend;
    double soonest = INFINITY;
    if (first > 0.0)
        soonest = first;
    if (second > 0.0)
        soonest = fmin(soonest, second);
    return soonest;
}

/* Time from the last point until the control is expected at the level: on the line through the last two points or the
 * parabola through three, whichever is sooner. */
static double expect_turn(const struct dea_switches *switches, const struct control *control, double level) {
    const double *t = switches->times, *c = control->values;
    double distance = level - c[0], rate = (c[0] - c[1]) / (t[0] - t[1]);
    double soonest = reach(distance, rate, 0.0);
    if (switches->points > 2) {
        double bend = (rate - (c[1] - c[2]) / (t[1] - t[2])) / (t[0] - t[2]);
        soonest = fmin(soonest, reach(distance, rate + bend * (t[0] - t[1]), bend));
    }
    return soonest;
}

double dea_switches_limit(struct dea_switches *switches, double delta, double duration) {
    if (switches->points < 2)
        return delta;
    double last = switches->times[0] - switches->times[1], close = fmax(CLOSE * duration, CLOSE_PART * last);
    double limited = delta;
    for (int i = 0; i < switches->count; i++) {
        struct control *control = &switches->controls[i];
        double turn = INFINITY;
        if (!control->known || !control->is_on)
            turn = expect_turn(switches, control, control->on);
        if (!control->known || control->is_on)
            turn = fmin(turn, expect_turn(switches, control, control->off));
        if (control->passing > 0.0) {
            limited = fmin(limited, control->passing);
            control->passing = 0.0;
        } else if (turn < delta && control->credit >= 1.0) {
            control->credit -= 1.0;
            control->passing = turn > close ? close : 0.0;
            limited = fmin(limited, turn > close ? turn - 0.5 * close : turn + 0.5 * close);
        }
    }
    return limited;
}
