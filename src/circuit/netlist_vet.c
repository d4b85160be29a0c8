/* What of a netlist may reach ngspice: a list of what is known to be harmless, not of what is known to be dangerous. */
#include "circuit/netlist_internal.h"

#include <ctype.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

enum verdict { PASS, OURS, LEAVE_OUT, REFUSE };

/* Dot cards. OURS: we read it, the deck gets our own. LEAVE_OUT: with a warning. */
static const struct {
    const char *card;
    enum verdict verdict;
} cards[] = {
    {".model", PASS},    {".subckt", PASS},    {".ends", PASS},         {".param", PASS},      {".func", PASS},
    {".ic", PASS},       {".nodeset", PASS},   {".global", PASS},       {".temp", PASS},       {".if", PASS},
    {".elseif", PASS},   {".else", PASS},      {".endif", PASS},        {".csparam", PASS},    {".options", PASS},
    {".option", PASS},   {".opt", PASS},       {".measure", PASS},      {".meas", PASS},       {".tran", OURS},
    {".save", OURS},     {".print", OURS},     {".plot", OURS},         {".probe", OURS},      {".title", OURS},
    {".width", OURS},    {".ac", LEAVE_OUT},   {".dc", LEAVE_OUT},      {".op", LEAVE_OUT},    {".noise", LEAVE_OUT},
    {".tf", LEAVE_OUT},  {".pz", LEAVE_OUT},   {".sens", LEAVE_OUT},    {".disto", LEAVE_OUT}, {".sp", LEAVE_OUT},
    {".pss", LEAVE_OUT}, {".four", LEAVE_OUT}, {".fourier", LEAVE_OUT}, {".exec", REFUSE},
};

/* Options that belong to the circuit's solution. Others steer ngspice's own output or front end. */
static const char *const simulation_options[] = {
    "abstol",    "reltol",   "vntol",        "chgtol",     "trtol",      "gmin",      "gminsteps", "srcsteps",
    "itl1",      "itl2",     "itl3",         "itl4",       "itl5",       "itl6",      "pivtol",    "pivrel",
    "method",    "maxord",   "temp",         "tnom",       "xmu",        "defl",      "defw",      "defad",
    "defas",     "defm",     "scale",        "cshunt",     "rshunt",     "rseries",   "noopiter",  "ramptime",
    "convlimit", "convstep", "convabsstep",  "maxevtiter", "maxopalter", "noopalter", "minbreak",  "bypass",
    "oldlimit",  "badmos3",  "trytocompact", "seed",
};

static bool is_simulation_option(const char *name) {
    for (size_t i = 0; i < sizeof simulation_options / sizeof simulation_options[0]; i++)
        if (strcmp(name, simulation_options[i]) == 0)
            return true;
    return false;
}

/* Rewrites an options line to the ones that count, with a warning for the others. */
static enum dea_status vet_options(struct dea_netlist_job *job, int index) {
    struct dea_netlist_line *line = &job->netlist->lines[index];
    char *kept = malloc(strlen(line->text) + 32), name[DEA_TOKEN_MAX], token[DEA_TOKEN_MAX];
    if (kept == NULL)
        return dea_fail(job->error, DEA_ERR_MEMORY, "out of memory reading the netlist");
    char *end = stpcpy(kept, ".options");
    const char *cursor = line->text;
    enum dea_status status = DEA_OK;
    bool any = false, more = dea_netlist_token(&cursor, token) && dea_netlist_token(&cursor, name);
    while (more && status == DEA_OK) {
        char value[DEA_TOKEN_MAX] = "";
        more = dea_netlist_token(&cursor, token);
        if (more && strcmp(token, "=") == 0) {
            if (!dea_netlist_token(&cursor, value))
                status = dea_netlist_fail(job, index, "option %s has no value", name);
            more = dea_netlist_token(&cursor, token);
        }
        if (is_simulation_option(name)) {
            *end++ = ' ';
            end = stpcpy(end, name);
            if (value[0] != '\0') {
                *end++ = '=';
                end = stpcpy(end, value);
            }
            any = true;
        } else if (status == DEA_OK) {
            status = dea_netlist_warn(job, index, "option %s left out: it does not concern the transient", name);
        }
        memcpy(name, token, sizeof name);
    }
    free(line->text);
    line->text = kept;
    line->passed = any;
    return status;
}

/* ---- files named in models ---- */

/* Finds `...file = name` at or after *cursor; start and length of the name, *cursor behind it. */
static bool find_file_parameter(const char **cursor, const char **name, size_t *length) {
    for (const char *c = *cursor; (c = strcasestr(c, "file")) != NULL; c++) {
        const char *at = c + 4;
        while (isspace((unsigned char)*at))
            at++;
        if (*at != '=')
            continue;
        at++;
        while (isspace((unsigned char)*at))
            at++;
        bool quoted = *at == '"';
        *name = at + quoted;
        *length = quoted ? strcspn(*name, "\"") : strcspn(*name, " \t)(,");
        *cursor = *name + *length;
        return true;
    }
    return false;
}

/* The name ngspice will find the file by: relative to the netlist's folder (the engine tells it that one), because it
 * reads names in lower case. NULL: it cannot. */
static const char *nameable(const struct dea_netlist *netlist, const char *resolved) {
    size_t length = strlen(netlist->folder);
    const char *name = resolved;
    if (strncmp(resolved, netlist->folder, length) == 0 && resolved[length] == '/')
        name = resolved + length + 1;
    for (const char *c = name; *c != '\0'; c++)
        if (isupper((unsigned char)*c) || *c == '"')
            return NULL;
    return name;
}

/* Replaces every file name by the one ngspice will find it by. */
static enum dea_status vet_file_parameters(struct dea_netlist_job *job, int index) {
    struct dea_netlist_line *line = &job->netlist->lines[index];
    const char *cursor = line->text, *name;
    size_t length;
    while (find_file_parameter(&cursor, &name, &length)) {
        char wanted[1024], *resolved, *changed = NULL;
        if (length >= sizeof wanted)
            return dea_netlist_fail(job, index, "a file name of more than 1000 characters");
        memcpy(wanted, name, length);
        wanted[length] = '\0';
        int at;
        const char *file = dea_netlist_place(job->netlist, index, &at);
        DEA_TRY(dea_netlist_resolve(job, wanted, file, at, &resolved));
        const char *found_as = nameable(job->netlist, resolved);
        if (found_as == NULL) {
            free(resolved);
            return dea_netlist_fail(job, index, "%s: ngspice reads file names in lower case; rename the file", wanted);
        }
        bool quoted = name > line->text && name[-1] == '"';
        size_t before = (size_t)(name - line->text) - quoted, resume = before + strlen(found_as) + 2;
        int made = asprintf(&changed, "%.*s\"%s\"%s", (int)before, line->text, found_as,
                            name + length + (quoted && name[length] == '"'));
        free(resolved);
        if (made < 0)
            return dea_fail(job->error, DEA_ERR_MEMORY, "out of memory reading the netlist");
        free(line->text);
        line->text = changed;
        cursor = changed + resume;
    }
    return DEA_OK;
}

/* Models that start programs or load libraries, however their type is quoted. */
static enum dea_status vet_model(struct dea_netlist_job *job, int index) {
    static const char *const refused[] = {"d_process", "d_cosim"};
    const char *text = job->netlist->lines[index].text, *cursor = text;
    char token[DEA_TOKEN_MAX];
    int words = 0;
    for (size_t i = 0; i < sizeof refused / sizeof refused[0]; i++)
        if (strcasestr(text, refused[i]) != NULL)
            return dea_netlist_fail(job, index, "models of type %s are refused: they start programs", refused[i]);
    while (dea_netlist_token(&cursor, token))
        words++;
    if (words < 3)
        return dea_netlist_fail(job, index, ".model needs a name and a type");
    DEA_TRY(dea_netlist_check_urc(job, index));
    return vet_file_parameters(job, index);
}

/* ---- lines ---- */

static bool matches(char opening, char closing) {
    return (opening == '(' && closing == ')') || (opening == '[' && closing == ']') ||
           (opening == '{' && closing == '}');
}

/* Brackets that do not match: ngspice would write past the end of its stack or never come back. */
static enum dea_status check_brackets(struct dea_netlist_job *job, int index) {
    char open[64], quote = '\0';
    int depth = 0;
    for (const char *c = job->netlist->lines[index].text; *c != '\0'; c++) {
        if (*c == '"' || *c == '\'')
            quote = quote == '\0' ? *c : quote == *c ? '\0' : quote;
        if (quote == '"')
            continue;
        if (strchr("([{", *c) != NULL) {
            if (depth == (int)sizeof open)
                return dea_netlist_fail(job, index, "brackets nested more than %zu deep", sizeof open);
            open[depth++] = *c;
        } else if (strchr(")]}", *c) != NULL && (depth == 0 || !matches(open[--depth], *c))) {
            return dea_netlist_fail(job, index, "'%c' without its opening bracket", *c);
        }
    }
    if (depth > 0)
        return dea_netlist_fail(job, index, "'%c' is not closed", open[depth - 1]);
    if (quote != '\0')
        return dea_netlist_fail(job, index, "a quote (%c) is not closed", quote);
    return DEA_OK;
}

/* `.param name=` without a value, or a comma between parameters: ngspice would never come back. */
static enum dea_status vet_parameters(struct dea_netlist_job *job, int index) {
    int depth = 0;
    bool quoted = false;
    for (const char *c = job->netlist->lines[index].text; *c != '\0'; c++) {
        depth += (strchr("([{", *c) != NULL) - (strchr(")]}", *c) != NULL);
        quoted = quoted != (*c == '\'');
        if (depth > 0 || quoted)
            continue;
        if (*c == ',')
            return dea_netlist_fail(job, index, ".param: separate parameters with blanks, not with ','");
        if (*c == '=' && c[1 + strspn(c + 1, " \t=")] == '\0')
            return dea_netlist_fail(job, index, ".param: a value is missing behind '='");
    }
    return DEA_OK;
}

/* `.csparam` without `name=value`, `v()` in .ic and .nodeset: ngspice crashes. */
static enum dea_status vet_settings(struct dea_netlist_job *job, int index, const char *card) {
    const char *text = job->netlist->lines[index].text;
    if (strcmp(card, ".csparam") == 0) {
        const char *equals = strchr(text, '=');
        if (equals == NULL || equals[1 + strspn(equals + 1, " \t")] == '\0')
            return dea_netlist_fail(job, index, ".csparam: written as in .csparam name={value}");
        return DEA_OK;
    }
    for (const char *open = strchr(text, '('); open != NULL; open = strchr(open + 1, '('))
        if (open[1 + strspn(open + 1, " \t")] == ')')
            return dea_netlist_fail(job, index, "%s: v() names no node", card);
    return DEA_OK;
}

/* par('expression') of a .measure: ngspice corrupts its memory over a lone '=' and over blanks inside v(...). */
static enum dea_status vet_measure(struct dea_netlist_job *job, int index) {
    const char *c = job->netlist->lines[index].text;
    while ((c = strcasestr(c, "par(")) != NULL) {
        c += strlen("par(");
        c += strspn(c, " \t");
        size_t length = *c == '\'' ? strcspn(c + 1, "'") : 0;
        bool in_probe = false;
        for (const char *e = c + 1; e <= c + length; e++) {
            bool lone = *e == '=' && e[1] != '=' && strchr("=<>!", e[-1]) == NULL;
            in_probe = (in_probe || (*e == '(' && strchr("vViI", e[-1]) != NULL)) && *e != ')';
            bool blank = in_probe && isspace((unsigned char)*e) && strchr(",() \t", e[1]) == NULL &&
                         strchr(",( \t", e[-1]) == NULL;
            if (lone || blank)
                return dea_netlist_fail(job, index, "par('%.*s'): not an expression",
                                        (int)(length < 100 ? length : 100), c + 1);
        }
    }
    return DEA_OK;
}

/* Too few words: ngspice takes what is missing as ground, as 0 or as the next thing's name, often without a word. */
static enum dea_status check_words(struct dea_netlist_job *job, int index) {
    static const struct {
        char letter;
        int words; /* with the name */
        const char *example;
    } shapes[] = {
        {'b', 6, "B1 p n V=V(a)*2"},
        {'c', 4, "C1 p n 1n"},
        {'d', 4, "D1 anode cathode model"},
        {'e', 5, "E1 p n cp cn 2"},
        {'f', 5, "F1 p n Vsense 2"},
        {'g', 5, "G1 p n cp cn 1m"},
        {'h', 5, "H1 p n Vsense 2"},
        {'i', 3, "I1 from to 1m"},
        {'j', 5, "J1 drain gate source model"},
        {'k', 4, "K1 L1 L2 0.99"},
        {'l', 4, "L1 p n 1m"},
        {'m', 5, "M1 drain gate source bulk model"},
        {'o', 6, "O1 a 0 b 0 model"},
        {'q', 5, "Q1 collector base emitter model"},
        {'r', 4, "R1 p n 1k"},
        {'s', 6, "S1 p n cp cn model"},
        {'t', 6, "T1 a 0 b 0 Z0=50 TD=1n"},
        {'u', 5, "U1 a b 0 model"},
        {'v', 3, "V1 p n 5"},
        {'w', 5, "W1 p n Vsense model"},
        {'x', 2, "X1 node subcircuit"},
        {'z', 5, "Z1 drain gate source model"},
    };
    const char *cursor = job->netlist->lines[index].text;
    char name[DEA_TOKEN_MAX] = "", token[DEA_TOKEN_MAX];
    int words = dea_netlist_token(&cursor, name);
    while (dea_netlist_token(&cursor, token))
        words++;
    for (size_t i = 0; i < sizeof shapes / sizeof shapes[0]; i++)
        if (name[0] == shapes[i].letter && words < shapes[i].words)
            return dea_netlist_fail(job, index, "%s: nodes or a value are missing; written as in %s", name,
                                    shapes[i].example);
    return DEA_OK;
}

/* A node named like ngspice's variable of the temperature crashes it. */
static enum dea_status check_nodes(struct dea_netlist_job *job, int index) {
    const char *cursor = job->netlist->lines[index].text;
    char name[DEA_TOKEN_MAX] = "", token[DEA_TOKEN_MAX];
    bool more = dea_netlist_token(&cursor, name);
    int nodes = name[0] == 'x' ? INT_MAX : strchr("brclvidk", name[0]) != NULL ? 2 : 5; /* at most */
    for (int i = 0; i < nodes && more && (more = dea_netlist_token(&cursor, token)) && strcmp(token, "=") != 0; i++)
        if (strcmp(token, "temper") == 0)
            return dea_netlist_fail(job, index, "%s: no node may be named temper", name);
    return DEA_OK;
}

/* PWL(t1 v1 t2 v2 ..) with plain numbers: ngspice ends in the middle of a run where time goes back. */
static enum dea_status check_points(struct dea_netlist_job *job, int index, const char *cursor) {
    char token[DEA_TOKEN_MAX];
    double value, last = -INFINITY;
    int count = 0;
    for (; dea_netlist_token(&cursor, token) && dea_spice_number(token, &value); count++) {
        if (count % 2 == 0 && value < last)
            return dea_netlist_fail(job, index, "PWL: the time %s goes back", token);
        last = count % 2 == 0 ? value : last;
    }
    if (count % 2 != 0 && cursor[strspn(cursor, " \t)")] == '\0' && dea_spice_number(token, &value))
        return dea_netlist_fail(job, index, "PWL: the time %s has no value", token);
    return DEA_OK;
}

/* EXTERNAL sources belong to the devices; nobody would answer for the user's. */
static enum dea_status vet_source(struct dea_netlist_job *job, int index) {
    const char *cursor = job->netlist->lines[index].text;
    char token[DEA_TOKEN_MAX];
    while (dea_netlist_token(&cursor, token)) {
        if (strcmp(token, "external") == 0)
            return dea_netlist_fail(job, index, "EXTERNAL sources are refused: nothing would drive them");
        if (strcmp(token, "portnum") == 0)
            return dea_netlist_fail(job, index, "portnum is refused: it is for S-parameters, and ngspice crashes");
        if (strcmp(token, "pwl") == 0)
            DEA_TRY(check_points(job, index, cursor));
    }
    return DEA_OK;
}

static enum dea_status vet_card(struct dea_netlist_job *job, int index) {
    struct dea_netlist_line *line = &job->netlist->lines[index];
    const char *cursor = line->text;
    char card[DEA_TOKEN_MAX], kind[DEA_TOKEN_MAX];
    if (!dea_netlist_token(&cursor, card))
        return DEA_OK;
    enum verdict verdict = REFUSE;
    for (size_t i = 0; i < sizeof cards / sizeof cards[0]; i++)
        if (strcmp(card, cards[i].card) == 0)
            verdict = cards[i].verdict;
    if (verdict == REFUSE)
        return dea_netlist_fail(job, index, "%s is not allowed in a netlist for a coupled run", card);
    if (verdict == LEAVE_OUT)
        return dea_netlist_warn(job, index, "%s left out: only the transient is run", card);
    line->passed = verdict == PASS;
    if (strncmp(card, ".opt", 4) == 0)
        return vet_options(job, index);
    if (strcmp(card, ".model") == 0)
        return vet_model(job, index);
    if (strcmp(card, ".param") == 0)
        return vet_parameters(job, index);
    if (strcmp(card, ".csparam") == 0 || strcmp(card, ".ic") == 0 || strcmp(card, ".nodeset") == 0)
        return vet_settings(job, index, card);
    if (line->passed && strncmp(card, ".meas", 5) == 0)
        DEA_TRY(vet_measure(job, index));
    if (strncmp(card, ".meas", 5) == 0 && dea_netlist_token(&cursor, kind) && strcmp(kind, "tran") != 0) {
        line->passed = false;
        return dea_netlist_warn(job, index, ".measure %s left out: only the transient is run", kind);
    }
    return DEA_OK;
}

enum dea_status dea_netlist_vet(struct dea_netlist_job *job) {
    struct dea_netlist *netlist = job->netlist;
    for (int i = 1; i < netlist->line_count; i++) {
        struct dea_netlist_line *line = &netlist->lines[i];
        char first = line->text[0];
        if (first == '.') {
            DEA_TRY(vet_card(job, i));
            if (line->passed)
                DEA_TRY(check_brackets(job, i));
            continue;
        }
        if (!isalpha((unsigned char)first))
            return dea_netlist_fail(job, i, "not an element: \"%.40s\"", line->text);
        line->passed = true;
        netlist->has_event_parts = netlist->has_event_parts || tolower((unsigned char)first) == 'a';
        if (strchr("vViI", first) != NULL)
            DEA_TRY(vet_source(job, i));
        DEA_TRY(vet_file_parameters(job, i));
        DEA_TRY(check_brackets(job, i));
        DEA_TRY(check_words(job, i));
        DEA_TRY(check_nodes(job, i));
        if (tolower((unsigned char)first) == 'u')
            DEA_TRY(dea_netlist_check_urc(job, i));
        if (strchr("rRcC", first) != NULL)
            DEA_TRY(dea_netlist_check_suffix(job, i));
    }
    return DEA_OK;
}
