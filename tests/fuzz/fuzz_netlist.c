/* Netlists with an include: what passes holds nothing that ngspice would run, and becomes a deck. */
#include "circuit/deck.h"
#include "circuit/netlist.h"
#include "fuzz.h"

#include <ctype.h>
#include <math.h>
#include <string.h>
#include <strings.h>

static const char *const names[] = {"main.cir", "part.inc"};

static const struct dea_netlist_device devices[] = {{"DEA", 2, {"left", "right"}}, {"DEB", 1, {"left", NULL}}};

static bool begins(const char *text, const char *with) {
    return strncasecmp(text, with, strlen(with)) == 0;
}

/* A line of the deck: an element or a card, on one line, nothing that runs or reads anything. */
static void check_line(const char *line) {
    static const char *const cards[] = {".model",  ".subckt", ".ends", ".param",   ".func",    ".ic",
                                        ".global", ".temp",   ".if",   ".elseif",  ".else",    ".endif",
                                        ".opt",    ".meas",   ".tran", ".nodeset", ".csparam", ".save"};
    fuzz_require(strpbrk(line, "\r\n") == NULL, "a line is one line");
    size_t length = strlen(line);
    fuzz_require(length < 2 || strcmp(line + length - 2, "\\\\") != 0, "a line does not go on at its end");
    bool known = isalpha((unsigned char)line[0]) || strcasecmp(line, ".end") == 0;
    for (size_t i = 0; i < sizeof cards / sizeof cards[0]; i++)
        known = known || begins(line, cards[i]);
    fuzz_require(known, "a line is an element or a card that is harmless");
    fuzz_require(!begins(line, ".model") ||
                     (strcasestr(line, "d_process") == NULL && strcasestr(line, "d_cosim") == NULL),
                 "no model starts a program");
}

static void build(const struct dea_netlist *netlist) {
    const struct dea_port port = {.rest_capacitance = 80e-12, .conductivity_field = INFINITY};
    const struct dea_circuit_device circuit_devices[] = {{"DEA", 2, {port, port}}, {"DEB", 1, {port}}};
    const struct dea_deck_options options = {.stop = 1e-3};
    struct dea_deck deck = {0};
    struct dea_error error = {0};
    if (fuzz_judge(dea_deck_build(netlist, circuit_devices, &options, &deck, &error), &error))
        for (int i = 1; i < deck.line_count; i++) /* line 0 is the title, which ngspice does not read */
            check_line(deck.lines[i]);
    dea_deck_clear(&deck);
}

static void check(const struct dea_netlist *netlist) {
    fuzz_require(netlist->line_count > 0 && netlist->file_count > 0, "there are lines");
    for (int i = 0; i < netlist->line_count; i++) {
        int line;
        fuzz_require(dea_netlist_place(netlist, i, &line) != NULL && line > 0, "every line has its place");
    }
    for (int i = 0; i < netlist->instance_count; i++) {
        const struct dea_netlist_instance *instance = &netlist->instances[i];
        for (int pin = 0; pin <= 2 * devices[instance->device].electrodes; pin++)
            fuzz_require(instance->nodes[pin] != NULL && instance->nodes[pin][0] != '\0', "every pin has a node");
    }
    fuzz_require(!netlist->tran.numeric || (isfinite(netlist->tran.stop) && netlist->tran.stop > 0.0),
                 "the end of the run is positive");
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    fuzz_write_parts(data, size, names, 2);
    for (int used = 0; used <= 2; used += 2) { /* without devices every netlist gets further */
        const struct dea_netlist_options options = {.devices = devices, .device_count = used};
        struct dea_netlist netlist;
        struct dea_error error = {0};
        if (fuzz_judge(dea_netlist_read(names[0], &options, &netlist, &error), &error)) {
            check(&netlist);
            build(&netlist);
        }
        dea_netlist_clear(&netlist);
    }
    return 0;
}
