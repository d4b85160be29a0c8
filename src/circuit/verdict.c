/* Why a run ended early, in words: what gave up where, the trouble behind it, what may help. */
#include "circuit/engine_internal.h"

#include "circuit/netlist_internal.h"

#include <stdio.h>
#include <string.h>

#define SEARCH_STEPS 2000 /* candidates a search for trouble may take */

/* ngspice names no unknown when the operating point fails, only when a transient does: lets one fail, of a few steps
 * from zero. */
static void search_trouble(struct dea_engine *engine) {
    const struct dea_deck_options *options = engine->options;
    double step = options->step > 0.0 ? options->step : options->stop / 1000.0;
    char text[128];
    snprintf(text, sizeof text, "tran %.9g %.9g uic", step, 10.0 * step);
    engine->complaints.searching = engine->complaints.searched = true;
    engine->search_steps = SEARCH_STEPS;
    dea_engine_command(text);
    engine->complaints.searching = false;
}

/* Why there is no operating point. */
static enum dea_status judge_start(struct dea_engine *engine, struct dea_error *error) {
    struct dea_complaints *complaints = &engine->complaints;
    char what[1200];
    if (complaints->misread) {
        char element[DEA_TOKEN_MAX + 16] = "instance ";
        if (complaints->count > 0 &&
            sscanf(complaints->texts[0], "Fatal error: %255[^: ]:", element + strlen("instance ")) == 1)
            dea_engine_place_complaint(engine, element);
        return dea_engine_complain(engine, DEA_ERR_INPUT, "ngspice refuses the circuit", NULL, error);
    }
    const char *lost = engine->options->uic ? "no step away from the given start (uic)" : "no operating point at t = 0";
    if (strchr(complaints->singular, '#') != NULL) {
        dea_engine_place_complaint(engine, complaints->singular);
        snprintf(
            what, sizeof what,
            "%s, singular at %s: voltage sources or inductors in a loop, whose current nothing determines (help: a "
            "small resistor in series)",
            lost, complaints->singular);
    } else if (complaints->singular[0] != '\0') {
        dea_engine_place_complaint(engine, complaints->singular);
        snprintf(what, sizeof what,
                 "%s, singular at %s: a node without DC path to ground, or sources that contradict each other (help: a "
                 "large resistor from it to ground, or .options rshunt=1e12)",
                 lost, complaints->singular);
    } else {
        if (!complaints->exit_requested && !engine->options->uic)
            search_trouble(engine);
        bool named = complaints->worst[0] != '\0';
        if (named)
            dea_engine_place_complaint(engine, complaints->worst);
        snprintf(what, sizeof what, "%s%s%s%s", lost, named ? ", trouble with " : "", complaints->worst,
                 complaints->searched && !complaints->search_failed
                     ? " (from zero it does start: .tran with uic, or .nodeset)"
                     : "");
    }
    return dea_engine_complain(engine, DEA_ERR_SOLVER, what, NULL, error);
}

/* What an early end of the transient means. */
enum dea_status dea_engine_judge_failure(struct dea_engine *engine, struct dea_error *error) {
    struct dea_complaints *complaints = &engine->complaints;
    char what[1200], steps[800];
    if (engine->stats.points == 0)
        return judge_start(engine, error);
    if (engine->stats.reached >= engine->options->stop)
        return dea_engine_complain(engine, DEA_ERR_SOLVER, "the circuit reported errors during the run", NULL, error);
    dea_engine_describe_steps(engine, steps, sizeof steps);
    if (complaints->place < 0)
        dea_engine_place_complaint(engine, complaints->worst);
    snprintf(what, sizeof what, "the circuit gave up at t = %.9g s%s%s", engine->stats.reached,
             complaints->worst[0] != '\0' ? ", trouble with " : "", complaints->worst);
    return dea_engine_complain(engine, DEA_ERR_SOLVER, what, steps, error);
}
