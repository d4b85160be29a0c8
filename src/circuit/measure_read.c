/* .measure lines into what is to be followed. What ngspice would refuse or take in a way of its own is not understood
 * here and left to it. */
#include "circuit/measures_internal.h"

#include <math.h>
#include <string.h>

#define WORDS_MAX 16

struct words {
    char *word[WORDS_MAX + 1]; /* NULL behind the last */
    int count;
};

/* Cuts at blanks outside of brackets and quotes; blanks around = do not separate. */
static bool cut_words(char *text, struct words *words) {
    char *out = text; /* written over what has been read */
    words->count = 0;
    for (char *c = text + strspn(text, " \t"); *c != '\0';) {
        if (words->count == WORDS_MAX)
            return false;
        words->word[words->count++] = out;
        int depth = 0;
        bool quoted = false;
        for (; *c != '\0'; c++) {
            if (!quoted && depth == 0 && strchr(" \t", *c) != NULL) {
                char *next = c + strspn(c, " \t");
                if (*next != '=' && (out == text || out[-1] != '='))
                    break;
                c = next - 1;
                continue;
            }
            quoted = quoted != (*c == '\'');
            depth += *c == '(' ? 1 : *c == ')' ? -1 : 0;
            *out++ = *c;
        }
        c += strspn(c, " \t");
        *out++ = '\0';
    }
    words->word[words->count] = NULL;
    return true;
}

/* The value of "name=value" for one name; false when the word is for another one or has no number. */
static bool read_setting(const char *word, const char *name, double *value) {
    size_t length = strlen(name);
    return strncmp(word, name, length) == 0 && word[length] == '=' && dea_spice_number(word + length + 1, value);
}

/* rise=2, fall=last, cross=1 */
static bool read_edge(struct moment *moment, const char *word) {
    static const struct {
        const char *name;
        enum edge edge;
    } edges[] = {{"rise=", EDGE_RISE}, {"fall=", EDGE_FALL}, {"cross=", EDGE_ANY}};
    for (size_t i = 0; i < sizeof edges / sizeof edges[0]; i++) {
        size_t length = strlen(edges[i].name);
        if (strncmp(word, edges[i].name, length) != 0 || moment->number != 0)
            continue;
        double number;
        moment->edge = edges[i].edge;
        moment->number = LAST_PASSAGE;
        if (strcmp(word + length, "last") == 0)
            return true;
        if (!dea_spice_number(word + length, &number) || !(number >= 1.0 && number <= 1e9) || number != floor(number))
            return false;
        moment->number = (int)number;
        return true;
    }
    return false;
}

/* What may follow the signal of a moment; *level is set by val=. */
static bool read_moment_settings(struct moment *moment, char *const *word, char *const *end, double *level) {
    double delay = 0.0, from = 0.0, to = 0.0;
    for (; word != end; word++)
        if (!read_setting(*word, "td", &delay) && !read_setting(*word, "from", &from) &&
            !read_setting(*word, "to", &to) && !(level != NULL && read_setting(*word, "val", level)) &&
            !read_edge(moment, *word))
            return false;
    moment->from = fmax(delay, from);
    moment->to = to > 0.0 ? to : INFINITY;
    return to >= 0.0;
}

/* "v(left) val=330 rise=1 td=1m" or "at=1m"; a window is not taken over from the other one here. */
static bool read_delay_end(struct moment *moment, char *const *word, char *const *end, const struct row_names *names) {
    double level = NAN;
    if (word == end)
        return false;
    if (end - word == 1 && read_setting(*word, "at", &moment->time)) {
        moment->given = true;
        return true;
    }
    return expression_read_signal(&moment->signal, *word, names) &&
           read_moment_settings(moment, word + 1, end, &level) && moment->number != 0 && !isnan(level) &&
           isinf(moment->to) && expression_subtract_number(&moment->signal, level);
}

/* "v(left)=500 rise=2" or "v(left)=v(right)" */
static bool read_when(struct moment *moment, char *const *word, char *const *end, const struct row_names *names) {
    struct expression other;
    double level;
    char *equals = word != end ? strrchr(*word, '=') : NULL;
    if (equals == NULL)
        return false;
    *equals = '\0';
    bool number = dea_spice_number(equals + 1, &level);
    bool good =
        expression_read_signal(&moment->signal, *word, names) &&
        (number ? expression_subtract_number(&moment->signal, level)
                : expression_read_signal(&other, equals + 1, names) && expression_subtract(&moment->signal, &other)) &&
        read_moment_settings(moment, word + 1, end, NULL);
    if (moment->number == 0)
        moment->number = 1;
    return good;
}

static bool read_delay(struct measure *measure, const struct words *words, const struct row_names *names) {
    char *const *end = words->word + words->count, *const *targ = words->word + 1;
    while (targ != end && strcmp(*targ, "targ") != 0)
        targ++;
    measure->kind = MEASURE_DELAY;
    return targ != end && read_delay_end(&measure->moment, words->word + 1, targ, names) &&
           read_delay_end(&measure->targ, targ + 1, end, names);
}

static bool read_find(struct measure *measure, const struct words *words, const struct row_names *names) {
    char *const *end = words->word + words->count;
    if (words->count < 3 || !expression_read_signal(&measure->signal, words->word[1], names))
        return false;
    if (strcmp(words->word[2], "when") == 0) {
        measure->kind = MEASURE_FIND_WHEN;
        return read_when(&measure->moment, words->word + 3, end, names);
    }
    measure->kind = MEASURE_FIND_AT;
    measure->moment.given = true;
    return words->count == 3 && read_setting(words->word[2], "at", &measure->moment.time);
}

/* "max v(left) from=1m to=2m" */
static bool read_statistic(struct measure *measure, const struct words *words, const struct row_names *names) {
    double from = 0.0, to = 0.0;
    if (words->count < 2 || !expression_read_signal(&measure->signal, words->word[1], names))
        return false;
    for (int i = 2; i < words->count; i++)
        if (!read_setting(words->word[i], "from", &from) && !read_setting(words->word[i], "to", &to))
            return false;
    measure->from = from;
    measure->to = to > 0.0 ? to : INFINITY; /* 0 is none for ngspice */
    return to >= 0.0;
}

bool measure_read(struct measure *measure, char *text, const struct row_names *names) {
    static const struct {
        const char *name;
        enum measure_kind kind;
    } statistics[] = {{"max", MEASURE_MAX},       {"min", MEASURE_MIN},  {"pp", MEASURE_PEAK_TO_PEAK},
                      {"max_at", MEASURE_MAX_AT}, {"avg", MEASURE_MEAN}, {"integ", MEASURE_INTEGRAL},
                      {"min_at", MEASURE_MIN_AT}, {"rms", MEASURE_RMS}};
    struct words words;
    *measure = (struct measure){.to = INFINITY};
    if (!cut_words(text, &words) || words.count < 2)
        return false;
    if (strcmp(words.word[0], "trig") == 0)
        return read_delay(measure, &words, names);
    if (strcmp(words.word[0], "find") == 0)
        return read_find(measure, &words, names);
    if (strcmp(words.word[0], "when") == 0) {
        measure->kind = MEASURE_WHEN;
        return read_when(&measure->moment, words.word + 1, words.word + words.count, names);
    }
    for (size_t i = 0; i < sizeof statistics / sizeof statistics[0]; i++)
        if (strcmp(words.word[0], statistics[i].name) == 0) {
            measure->kind = statistics[i].kind;
            return read_statistic(measure, &words, names);
        }
    return false;
}
