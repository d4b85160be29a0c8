/* What ngspice says, sorted: chatter, warnings, errors, results of .measure. Its return codes say nothing. */
#include "circuit/engine_internal.h"
#include "circuit/netlist_internal.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

static bool begins(const char *text, const char *with) {
    return strncmp(text, with, strlen(with)) == 0;
}

/* ---- places ---- */

/* Lower case, single blanks. */
static void normalise(const char *text, char *plain, size_t size) {
    size_t length = 0;
    for (const char *c = text; *c != '\0' && length + 1 < size; c++) {
        if (!isspace((unsigned char)*c))
            plain[length++] = (char)tolower((unsigned char)*c);
        else if (length > 0 && plain[length - 1] != ' ')
            plain[length++] = ' ';
    }
    while (length > 0 && plain[length - 1] == ' ')
        length--;
    plain[length] = '\0';
}

/* The netlist line a message quotes, -1 when none does. */
static int find_quoted_line(const struct dea_engine *engine, const char *text) {
    char message[1024], line[512];
    normalise(text, message, sizeof message);
    for (int i = 1; i < engine->netlist->line_count; i++) {
        if (!engine->netlist->lines[i].passed)
            continue;
        normalise(engine->netlist->lines[i].text, line, sizeof line);
        const char *at = strstr(message, line);
        if (strlen(line) > 2 && at != NULL && (at == message || at[-1] == ' '))
            return i;
    }
    return -1;
}

/* The call a message means with "(instance: xname)", where ngspice puts an x in front of the name; -1 when there is
 * none. */
static int find_called_line(const struct dea_engine *engine, const char *text) {
    const char *name = strstr(text, "(instance: x");
    if (name == NULL)
        return -1;
    name += strlen("(instance: x");
    size_t length = strcspn(name, ")");
    for (int i = 1; i < engine->netlist->line_count; i++) {
        const char *line = engine->netlist->lines[i].text;
        if (strncasecmp(line, name, length) == 0 && (line[length] == '\0' || isspace((unsigned char)line[length])))
            return i;
    }
    return -1;
}

/* The netlist line that begins with, or else the first element that holds, a word; -1 when none does. */
static int find_word(const struct dea_netlist *netlist, const char *word, bool element) {
    for (int i = 1; i < netlist->line_count; i++) {
        const char *cursor = netlist->lines[i].text;
        char token[DEA_TOKEN_MAX];
        if (!netlist->lines[i].passed || cursor[0] == '.' || !dea_netlist_token(&cursor, token))
            continue;
        if (element && strcmp(token, word) == 0)
            return i;
        while (!element && dea_netlist_token(&cursor, token))
            if (strcmp(token, word) == 0)
                return i;
    }
    return -1;
}

void dea_engine_place_complaint(struct dea_engine *engine, const char *name) {
    const char *quoted = strchr(name, '"'), *instance = strstr(name, "instance ");
    const char *start = quoted != NULL ? quoted + 1 : instance != NULL ? instance + strlen("instance ") : name;
    char word[DEA_TOKEN_MAX];
    size_t length = strcspn(start, "\" \t");
    snprintf(word, sizeof word, "%.*s", (int)(length < sizeof word ? length : sizeof word - 1), start);
    char *branch = strchr(word, '#'), *dot = strchr(word, '.');
    bool element = branch != NULL || dot != NULL || instance != NULL;
    if (branch != NULL)
        *branch = '\0';
    const char *first = word;
    if (dot != NULL && dot == word + 1 && strchr(dot + 1, '.') != NULL) { /* "l.xarm.l1": the kind, then the call */
        first = dot + 1;
        dot = strchr(first, '.');
    }
    if (dot != NULL)
        *dot = '\0'; /* inside a subcircuit: its outermost call */
    engine->complaints.place = find_word(engine->netlist, first, element);
}

/* The netlist line of a deck line number in the message, -1 when there is none. */
static int find_numbered_line(const struct dea_engine *engine, const char *text) {
    static const char *const leads[] = {"ine no. ", "n line "};
    long number = 0;
    for (size_t i = 0; i < sizeof leads / sizeof leads[0] && number == 0; i++) {
        const char *at = strstr(text, leads[i]);
        if (at != NULL)
            number = strtol(at + strlen(leads[i]), NULL, 10);
    }
    return number >= 1 && number <= engine->deck->line_count ? engine->deck->origins[number - 1] : -1;
}

/* ---- errors ---- */

static void tell(const struct dea_engine *engine, enum dea_message_kind kind, int place, const char *text) {
    const struct dea_engine_callbacks *callbacks = engine->callbacks;
    if (callbacks == NULL || callbacks->message == NULL)
        return;
    char whole[1200];
    if (place >= 0) {
        int line;
        const char *file = dea_netlist_place(engine->netlist, place, &line);
        snprintf(whole, sizeof whole, "%s:%d: %s", file, line, text);
        text = whole;
    }
    callbacks->message(callbacks->context, kind, text);
}

static void keep_complaint(struct dea_engine *engine, const char *text) {
    struct dea_complaints *complaints = &engine->complaints;
    int place = find_numbered_line(engine, text);
    if (place < 0)
        place = find_quoted_line(engine, text);
    if (place < 0)
        place = find_called_line(engine, text);
    if (complaints->place < 0)
        complaints->place = place;
    for (int i = 0; i < complaints->count; i++)
        if (strcmp(complaints->texts[i], text) == 0)
            return;
    tell(engine, DEA_MESSAGE_ERROR, place, text);
    if (complaints->count < DEA_COMPLAINTS_MAX && (complaints->texts[complaints->count] = strdup(text)) != NULL)
        complaints->count++;
}

/* Lines that repeat what another one says better. */
static bool is_empty_talk(const char *text) {
    static const char *const talk[] = {"Error: ngspice.dll cannot recover",
                                       "Please check your input netlist",
                                       "Error: circuit not parsed",
                                       "Error: there aren't any circuits",
                                       "This will cause subsequent",
                                       "Error on line",
                                       "Netlist line no.",
                                       "run simulation(s) aborted",
                                       "run simulation interrupted"};
    for (size_t i = 0; i < sizeof talk / sizeof talk[0]; i++)
        if (begins(text, talk[i]))
            return true;
    return false;
}

static bool is_error(const char *text) {
    static const char *const starts[] = {"Error",
                                         "ERROR",
                                         "Fatal",
                                         "doAnalyses:",
                                         "run simulation(s) aborted",
                                         "Undefined",
                                         "Mismatch",
                                         "Expression err",
                                         "Cannot compute",
                                         "Netlist line no.",
                                         "PTerror",
                                         "MIF-ERROR",
                                         "warning, can't find model",
                                         "Check line",
                                         "Closing \"",
                                         "Too few parameters",
                                         "Too many parameters"};
    for (size_t i = 0; i < sizeof starts / sizeof starts[0]; i++)
        if (begins(text, starts[i]))
            return true;
    return begins(text, "Instance:") &&
           strstr(text, "Message: cannot open") != NULL; /* a code model without its file */
}

/* The operating point is searched with several methods; only the last one's failure counts. */
static bool is_search_chatter(const char *text) {
    static const char *const talk[] = {"Note:",
                                       "Trying gmin",
                                       "Supplies reduced",
                                       "Warning: Further gmin",
                                       "Warning: Last gmin",
                                       "Warning: True gmin",
                                       "Warning: gmin step",
                                       "Warning: source stepping",
                                       "Warning: Dynamic gmin"};
    for (size_t i = 0; i < sizeof talk / sizeof talk[0]; i++)
        if (begins(text, talk[i]))
            return true;
    return strstr(text, "gmin step") != NULL || strstr(text, "singular matrix") != NULL;
}

static void hear_error(struct dea_engine *engine, const char *text) {
    struct dea_complaints *complaints = &engine->complaints;
    if (begins(text, "doAnalyses: pause")) /* our own stop */
        return;
    const char *trouble = strstr(text, "trouble with ");
    if (trouble != NULL)
        snprintf(complaints->worst, sizeof complaints->worst, "%s", trouble + strlen("trouble with "));
    if (complaints->searching) {
        complaints->search_failed = true;
        return;
    }
    complaints->aborted = complaints->aborted || engine->running;
    complaints->misread = complaints->misread || begins(text, "Fatal error: ") ||
                          strstr(text, "parameter value out of range or the wrong type") != NULL;
    if (begins(text, "Error on line") || begins(text, "warning, can't find model"))
        complaints->expect_detail = begins(text, "Error") ? 2 : 1;
    if (is_empty_talk(text)) {
        int place = find_numbered_line(engine, text);
        if (complaints->place < 0)
            complaints->place = place;
        if (complaints->count == 0 && begins(text, "Error: circuit not parsed"))
            keep_complaint(engine, text);
        return;
    }
    keep_complaint(engine, text);
}

/* ---- measures ---- */

/* "name = value ..." or "... name ... failed". */
static bool hear_measure(struct dea_engine *engine, const char *text) {
    for (int i = 0; i < engine->measure_count; i++) {
        struct dea_engine_measure *measure = &engine->measures[i];
        size_t length = strlen(measure->name);
        if (strncasecmp(text, measure->name, length) != 0)
            continue;
        const char *c = text + length;
        while (*c == ' ')
            c++;
        if (*c != '=')
            continue;
        char *end;
        double value = strtod(c + 1, &end);
        measure->failed = end == c + 1 || !(value - value == 0.0);
        measure->value = measure->failed ? 0.0 : value;
        return true;
    }
    return false;
}

/* A reason that no .measure line has followed stands for itself. */
static void tell_measure_trouble(struct dea_engine *engine) {
    char *why = engine->complaints.measure_trouble;
    if (why[0] != '\0')
        tell(engine, DEA_MESSAGE_WARNING, -1, why);
    why[0] = '\0';
}

/* What goes wrong with a .measure mostly comes in two lines, why and which: one warning. */
static void hear_measure_trouble(struct dea_engine *engine, const char *text) {
    char *why = engine->complaints.measure_trouble, whole[600];
    const char *failed = strstr(text, " failed!");
    if (begins(text, ".meas") && failed != NULL && why[0] != '\0') {
        snprintf(whole, sizeof whole, "%.*s failed: %s", (int)(failed - text), text, why);
        why[0] = '\0';
        tell(engine, DEA_MESSAGE_WARNING, -1, whole);
        return;
    }
    tell_measure_trouble(engine);
    if (begins(text, ".meas"))
        tell(engine, DEA_MESSAGE_WARNING, -1, text);
    else if (!is_empty_talk(text))
        snprintf(why, sizeof engine->complaints.measure_trouble, "%s", text);
}

/* ---- entry ---- */

/* "   12 : r1 a b 1k" of a listing. */
static void hear_listing(struct dea_engine *engine, const char *text) {
    size_t digits = strspn(text, "0123456789");
    const char *element = text + digits + strspn(text + digits, " ");
    if (digits == 0 || *element != ':')
        return;
    struct dea_listing *listing = engine->listing;
    char **lines = dea_grow(listing->lines, listing->count, sizeof *lines);
    if (lines != NULL)
        listing->lines = lines;
    char *copy = lines != NULL ? strdup(element + 1 + strspn(element + 1, " ")) : NULL;
    if (copy == NULL)
        engine->listing_cut = true;
    else
        listing->lines[listing->count++] = copy;
}

void dea_engine_hear(struct dea_engine *engine, const char *line) {
    struct dea_complaints *complaints = &engine->complaints;
    bool from_stderr = begins(line, "stderr ");
    const char *text = from_stderr || begins(line, "stdout ") ? line + strlen("stderr ") : line;
    while (isspace((unsigned char)*text))
        text++;
    if (*text == '\0')
        return;
    if (engine->listing != NULL) {
        hear_listing(engine, text);
        return;
    }
    const char *singular = strstr(text, "check node");
    if (singular != NULL)
        snprintf(complaints->singular, sizeof complaints->singular, "%s",
                 singular + strlen("check node") + strspn(singular + strlen("check node"), "s: "));
    complaints->model_missing = complaints->model_missing || begins(text, "MIF-ERROR - unable to find definition");
    if (begins(text, "Measurements for"))
        complaints->measuring = true;
    bool warning = strncasecmp(text, "warning", 7) == 0;
    if (complaints->measuring) {
        if (!hear_measure(engine, text) && from_stderr) {
            hear_measure_trouble(engine, text);
            return;
        }
        tell_measure_trouble(engine);
        warning = false;
    } else if (complaints->expect_detail > 0) {
        complaints->expect_detail--;
        keep_complaint(engine, text);
        return;
    } else if (is_search_chatter(text)) {
        warning = false;
    } else if (is_error(text)) {
        hear_error(engine, text);
        return;
    }
    snprintf(complaints->last_words, sizeof complaints->last_words, "%s", text);
    tell(engine, warning ? DEA_MESSAGE_WARNING : DEA_MESSAGE_NOTE, -1, text);
}

void dea_engine_clear_complaints(struct dea_engine *engine) {
    for (int i = 0; i < engine->complaints.count; i++)
        free(engine->complaints.texts[i]);
    bool exited = engine->complaints.exit_requested;
    engine->complaints = (struct dea_complaints){.place = -1, .exit_requested = exited};
}

enum dea_status dea_engine_complain(const struct dea_engine *engine, enum dea_status status, const char *what,
                                    const char *tail, struct dea_error *error) {
    const struct dea_complaints *complaints = &engine->complaints;
    char text[2000];
    size_t used = 0;
    if (complaints->place >= 0) {
        int line;
        const char *file = dea_netlist_place(engine->netlist, complaints->place, &line);
        used += (size_t)snprintf(text, sizeof text, "%s:%d: ", file, line);
    } else {
        used += (size_t)snprintf(text, sizeof text, "%s: ", engine->netlist->files[0]);
    }
    if (used < sizeof text)
        used += (size_t)snprintf(text + used, sizeof text - used, "%s", what);
    for (int i = 0; i < complaints->count && used < sizeof text; i++)
        used += (size_t)snprintf(text + used, sizeof text - used, "%s%s", i == 0 ? ": " : "; ", complaints->texts[i]);
    if (complaints->count == 0 && complaints->last_words[0] != '\0' && used < sizeof text)
        used += (size_t)snprintf(text + used, sizeof text - used, "; ngspice's last words: %s", complaints->last_words);
    if (tail != NULL && used < sizeof text)
        snprintf(text + used, sizeof text - used, "; %s", tail);
    return (dea_fail)(error, status, "%s", text);
}

void dea_engine_describe_steps(const struct dea_engine *engine, char *text, size_t size) {
    static const char *const verdicts[] = {"accepted", "rejected by ngspice"};
    long first = engine->step_count > DEA_STEPS_KEPT ? engine->step_count - DEA_STEPS_KEPT : 0;
    size_t used = (size_t)snprintf(text, size, "%s", DEA_LAST_STEPS);
    for (long i = first; i < engine->step_count && used < size; i++) {
        const struct dea_step_record *step = &engine->steps[i % DEA_STEPS_KEPT];
        used += (size_t)snprintf(text + used, size - used, "%s %.9g %.3g %s", i > first ? ";" : "", step->time,
                                 step->delta, verdicts[step->verdict]);
    }
}
