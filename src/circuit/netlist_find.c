/* Cards the coupling reads itself: .tran, .measure names, .ic values. */
#include "circuit/netlist_internal.h"

#include <stdlib.h>
#include <string.h>

#define MAX_MEASURES 2000

static enum dea_status out_of_memory(struct dea_netlist_job *job) {
    return dea_fail(job->error, DEA_ERR_MEMORY, "out of memory reading the netlist");
}

/* `.tran tstep tstop [tstart [tmax]] [uic]` */
static enum dea_status find_tran(struct dea_netlist_job *job, int index, const char *cursor) {
    struct dea_netlist_tran *tran = &job->netlist->tran;
    if (tran->present) {
        int line;
        const char *file = dea_netlist_place(job->netlist, tran->line, &line);
        return dea_netlist_fail(job, index, "a second .tran; the first is at %s:%d", file, line);
    }
    double *const numbers[] = {&tran->step, &tran->stop, &tran->start, &tran->max_step};
    char token[DEA_TOKEN_MAX];
    int count = 0;
    *tran = (struct dea_netlist_tran){.present = true, .numeric = true, .line = index};
    while (dea_netlist_token(&cursor, token)) {
        if (strcmp(token, "uic") == 0) {
            tran->uic = true;
            continue;
        }
        if (count == 4)
            return dea_netlist_fail(job, index, ".tran has a word too many: %s", token);
        if (!dea_spice_number(token, numbers[count])) {
            if (strpbrk(token, "{'\"") == NULL)
                return dea_netlist_fail(job, index, ".tran: %s is not a number", token);
            tran->numeric = false;
        }
        count++;
    }
    if (count < 2)
        return dea_netlist_fail(job, index, ".tran needs tstep and tstop");
    if (!tran->numeric) {
        *tran = (struct dea_netlist_tran){.present = true, .uic = tran->uic, .line = index};
        return DEA_OK;
    }
    if (!(tran->step > 0.0) || !(tran->stop > 0.0) || tran->start < 0.0 || tran->start >= tran->stop ||
        tran->max_step < 0.0)
        return dea_netlist_fail(
            job, index, ".tran: needs tstep > 0, tstop > 0, 0 <= tstart < tstop, tmax >= 0 (note: 1M is 1 milli)");
    return DEA_OK;
}

/* What is measured: an incomplete line would crash ngspice after the run, and its results with it. */
static enum dea_status check_measured(struct dea_netlist_job *job, int index, const char *name, const char *cursor) {
    static const char *const kinds[] = {"trig", "when", "find",  "avg",      "max",   "min",        "max_at", "min_at",
                                        "pp",   "rms",  "integ", "integral", "deriv", "derivative", "param"};
    char kind[DEA_TOKEN_MAX], what[DEA_TOKEN_MAX];
    bool complete = dea_netlist_token(&cursor, kind) && dea_netlist_token(&cursor, what);
    if (complete && strcmp(kind, "find") == 0) {
        bool placed = false;
        while (!placed && dea_netlist_token(&cursor, what))
            placed = strcmp(what, "at") == 0 || strcmp(what, "when") == 0;
        if (!placed)
            return dea_netlist_fail(job, index, ".measure %s: find needs at=.. or when ..", name);
    }
    if (complete)
        for (size_t i = 0; i < sizeof kinds / sizeof kinds[0]; i++)
            if (strcmp(kind, kinds[i]) == 0)
                return DEA_OK;
    return dea_netlist_fail(
        job, index,
        ".measure %s: say what to measure, as in .measure tran v_peak max v(out); known: trig, when, find, "
        "avg, max, min, max_at, min_at, pp, rms, integ, deriv, param",
        name);
}

static enum dea_status find_measure(struct dea_netlist_job *job, int index, const char *cursor) {
    struct dea_netlist *netlist = job->netlist;
    char name[DEA_TOKEN_MAX];
    bool named = dea_netlist_token(&cursor, name); /* the analysis, then the name */
    named = named && dea_netlist_token(&cursor, name);
    if (!named)
        return dea_netlist_fail(job, index,
                                ".measure needs an analysis and a name, as in .measure tran v_peak max v(out)");
    if (name[strspn(name, "abcdefghijklmnopqrstuvwxyz0123456789_")] != '\0')
        return dea_netlist_fail(job, index, ".measure %s: a name is made of letters, digits and _", name);
    DEA_TRY(check_measured(job, index, name, cursor));
    if (netlist->measure_count >= MAX_MEASURES)
        return dea_netlist_fail(job, index, "a netlist may have at most %d .measure lines", MAX_MEASURES);
    for (int i = 0; i < netlist->measure_count; i++)
        if (strcmp(netlist->measures[i], name) == 0)
            return dea_netlist_fail(job, index, "a second .measure named %s", name);
    char **grown = dea_grow(netlist->measures, netlist->measure_count, sizeof *grown);
    if (grown == NULL)
        return out_of_memory(job);
    netlist->measures = grown;
    netlist->measures[netlist->measure_count] = strdup(name);
    return netlist->measures[netlist->measure_count++] != NULL ? DEA_OK : out_of_memory(job);
}

/* `.ic v(a)=1 v(b)=2`; values that are expressions are left to ngspice alone. */
static enum dea_status find_initials(struct dea_netlist_job *job, const char *cursor) {
    struct dea_netlist *netlist = job->netlist;
    char token[DEA_TOKEN_MAX], node[DEA_TOKEN_MAX] = "";
    double value;
    while (dea_netlist_token(&cursor, token)) {
        if (strcmp(token, "=") != 0) {
            memcpy(node, token, sizeof node);
            continue;
        }
        if (!dea_netlist_token(&cursor, token) || !dea_spice_number(token, &value))
            continue;
        struct dea_netlist_initial *grown = dea_grow(netlist->initials, netlist->initial_count, sizeof *grown);
        if (grown == NULL)
            return out_of_memory(job);
        netlist->initials = grown;
        netlist->initials[netlist->initial_count] = (struct dea_netlist_initial){strdup(node), value};
        if (netlist->initials[netlist->initial_count++].node == NULL)
            return out_of_memory(job);
    }
    return DEA_OK;
}

enum dea_status dea_netlist_find(struct dea_netlist_job *job) {
    struct dea_netlist *netlist = job->netlist;
    for (int i = 1; i < netlist->line_count; i++) {
        const char *cursor = netlist->lines[i].text;
        char card[DEA_TOKEN_MAX];
        if (*cursor != '.' || !dea_netlist_token(&cursor, card))
            continue;
        if (strcmp(card, ".tran") == 0)
            DEA_TRY(find_tran(job, i, cursor));
        else if (strncmp(card, ".meas", 5) == 0 && netlist->lines[i].passed)
            DEA_TRY(find_measure(job, i, cursor));
        else if (strcmp(card, ".ic") == 0)
            DEA_TRY(find_initials(job, cursor));
    }
    return DEA_OK;
}
