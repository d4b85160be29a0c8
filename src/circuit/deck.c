/* Builds the deck: the user's lines that pass, the devices' subcircuits, our own options, saves and transient. */
#include "circuit/deck_internal.h"

#include "circuit/netlist_internal.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

struct builder {
    struct dea_deck *deck;
    struct dea_error *error;
};

/* Appends a generated or copied line. */
static enum dea_status add(struct builder *builder, int origin, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

static enum dea_status add(struct builder *builder, int origin, const char *format, ...) {
    struct dea_deck *deck = builder->deck;
    /* one slot ahead for the closing NULL */
    char **lines =
        deck->line_count == 0 ? malloc(2 * sizeof *lines) : dea_grow(deck->lines, deck->line_count + 1, sizeof *lines);
    if (lines != NULL)
        deck->lines = lines;
    int *origins = dea_grow(deck->origins, deck->line_count, sizeof *origins);
    if (origins != NULL)
        deck->origins = origins;
    char *text = NULL;
    if (lines != NULL && origins != NULL) {
        va_list arguments;
        va_start(arguments, format);
        if (vasprintf(&text, format, arguments) < 0)
            text = NULL;
        va_end(arguments);
    }
    if (text == NULL)
        return dea_fail(builder->error, DEA_ERR_MEMORY, "out of memory building the circuit");
    deck->lines[deck->line_count] = text;
    deck->origins[deck->line_count++] = origin;
    deck->lines[deck->line_count] = NULL;
    return DEA_OK;
}

/* ---- devices ---- */

/* An external number as the voltage of a node, letter and port: a current into 1 Ohm, since a voltage source would be
 * two unknowns. */
static enum dea_status add_number(struct builder *builder, char letter, int i) {
    DEA_TRY(add(builder, -1, "I%c%d 0 %c%d external", letter, i, letter, i));
    return add(builder, -1, "R%c%d %c%d 0 1", letter, i, letter, i);
}

/* Elements of one port; `film` is the name of the node behind the electrode resistance. The formulation is explained in
 * deck.h. A film against ground has one node less to be asked for in every expression. */
static enum dea_status add_port(struct builder *builder, const struct dea_port *port, int i, bool grounded, bool uic) {
    double unit = dea_port_charge_unit(port);
    char film[16], voltage[48];
    snprintf(film, sizeof film, "%s%d", port->resistance > 0.0 ? "f" : "p", i);
    if (grounded)
        snprintf(voltage, sizeof voltage, "V(%s)", film);
    else
        snprintf(voltage, sizeof voltage, "V(%s,n%d)", film, i);
    if (port->resistance > 0.0 && port->resistance_external) {
        DEA_TRY(add_number(builder, 'r', i));
        DEA_TRY(add(builder, -1, "Bre%d p%d f%d I=V(p%d,f%d)*%.17g/V(r%d)", i, i, i, i, i, 1.0 / port->resistance, i));
    } else if (port->resistance > 0.0) {
        DEA_TRY(add(builder, -1, "Re%d p%d f%d %.17g", i, i, i, port->resistance));
    }

    DEA_TRY(add_number(builder, 'c', i));
    DEA_TRY(add(builder, -1, "Bq%d 0 i%d I=%s*V(c%d)", i, i, voltage, i));
    if (port->offset)
        DEA_TRY(add(builder, -1, "Id%d 0 i%d external", i, i));
    DEA_TRY(add(builder, -1, "Ga%d i%d 0 q%d 0 1", i, i, i));
    DEA_TRY(add(builder, -1, "Gb%d 0 q%d i%d 0 1", i, i, i));
    if (uic)
        DEA_TRY(add(builder, -1, "Cq%d q%d 0 %.17g ic=%.17g", i, i, unit, port->initial_charge / unit));
    else
        DEA_TRY(add(builder, -1, "Cq%d q%d 0 %.17g", i, i, unit));
    DEA_TRY(add(builder, -1, "Gq%d %s n%d i%d 0 1", i, film, i, i));

    if (port->may_short) {
        DEA_TRY(add_number(builder, 'h', i));
        DEA_TRY(add(builder, -1, "Bh%d %s n%d I=%s*V(h%d)", i, film, i, voltage, i));
    }
    if (port->conductivity > 0.0) {
        /* I = s0 A lam E exp(|E|/E_B), E = V lam / (t0 lp1) */
        double ohmic = port->conductivity * port->leakage_area / port->leakage_thickness;
        DEA_TRY(add_number(builder, 's', i));
        if (isinf(port->conductivity_field))
            DEA_TRY(add(builder, -1, "Bg%d %s n%d I=%.17g*%s*V(s%d)*V(s%d)", i, film, i, ohmic, voltage, i, i));
        else
            DEA_TRY(add(builder, -1, "Bg%d %s n%d I=%.17g*%s*V(s%d)*V(s%d)*exp(min(40,abs(%s)*V(s%d)*%.17g))", i, film,
                        i, ohmic, voltage, i, i, voltage, i,
                        1.0 / (port->leakage_thickness * port->conductivity_field)));
    }
    return DEA_OK;
}

/* Whether the second pin of a port is at ground wherever the device is. */
static bool is_grounded(const struct dea_netlist *netlist, int device, int port) {
    for (int i = 0; i < netlist->instance_count; i++)
        if (netlist->instances[i].device == device && strcmp(netlist->instances[i].nodes[2 * port + 1], "0") != 0)
            return false;
    return true;
}

static enum dea_status add_device(struct builder *builder, const struct dea_netlist *netlist, int index,
                                  const struct dea_circuit_device *device, bool uic) {
    char pins[64] = "";
    for (int i = 0, used = 0; i < device->port_count; i++)
        used += snprintf(pins + used, sizeof pins - (size_t)used, "p%d n%d ", i, i);
    DEA_TRY(add(builder, -1, ".subckt %s %spos", device->name, pins));
    for (int i = 0; i < device->port_count; i++)
        DEA_TRY(add_port(builder, &device->ports[i], i, is_grounded(netlist, index, i), uic));
    DEA_TRY(add(builder, -1, "Vpos pos 0 external"));
    return add(builder, -1, ".ends");
}

double dea_port_charge_unit(const struct dea_port *port) {
    return port->rest_capacitance * 1e3;
}

/* ---- what to save ---- */

/* Saves every v(..), i(..) and @device[..] a .measure line names: ngspice would not do so by itself. */
static enum dea_status save_measured(struct builder *builder, const char *text, int *expressions) {
    for (const char *c = text; *c != '\0'; c++) {
        bool starts = c == text || strchr(" \t=,'\"(+-*/", c[-1]) != NULL;
        if (!starts)
            continue;
        if (strncasecmp(c, "par(", 4) == 0 || strncasecmp(c, "par (", 5) == 0) {
            /* ngspice turns the n-th par('...') of a deck into a node pa_NN */
            DEA_TRY(add(builder, -1, ".save v(pa_%02d)", (*expressions)++));
        } else if (strchr("vViI", *c) != NULL && c[1] == '(') {
            size_t length = strcspn(c, ")");
            const char *comma = memchr(c, ',', length);
            if (comma != NULL) /* v(a,b) */
                DEA_TRY(add(builder, -1, ".save v(%.*s) v(%.*s)", (int)(comma - c - 2), c + 2,
                            (int)(c + length - comma - 1), comma + 1));
            else if (length < DEA_TOKEN_MAX)
                DEA_TRY(add(builder, -1, ".save %.*s)", (int)length, c));
        } else if (*c == '@') {
            size_t length = strcspn(c, "]");
            if (length < DEA_TOKEN_MAX && c[length] == ']')
                DEA_TRY(add(builder, -1, ".save %.*s]", (int)length, c));
        }
    }
    return DEA_OK;
}

static enum dea_status save_instance(struct builder *builder, const struct dea_netlist_instance *instance,
                                     const struct dea_circuit_device *device) {
    for (int i = 0; i < device->port_count; i++) {
        for (int pin = 2 * i; pin < 2 * i + 2; pin++)
            if (strcmp(instance->nodes[pin], "0") != 0)
                DEA_TRY(add(builder, -1, ".save v(%s)", instance->nodes[pin]));
        if (device->ports[i].resistance > 0.0)
            DEA_TRY(add(builder, -1, ".save v(%s.f%d)", instance->path, i));
        DEA_TRY(add(builder, -1, ".save v(%s.i%d)", instance->path, i));
        DEA_TRY(add(builder, -1, ".save v(%s.q%d)", instance->path, i));
    }
    return DEA_OK;
}

static enum dea_status add_saves(struct builder *builder, const struct dea_netlist *netlist,
                                 const struct dea_circuit_device *devices, const struct dea_deck_options *options) {
    if (options->forget_points)
        return add(builder, -1, ".save none");
    for (int i = 0; i < netlist->instance_count; i++)
        DEA_TRY(save_instance(builder, &netlist->instances[i], &devices[netlist->instances[i].device]));
    for (int i = 0; i < options->node_count; i++)
        if (strcmp(options->nodes[i], "0") != 0)
            DEA_TRY(add(builder, -1, ".save v(%s)", options->nodes[i]));
    int expressions = 0;
    for (int i = 1; i < netlist->line_count; i++)
        if (netlist->lines[i].passed && strncasecmp(netlist->lines[i].text, ".meas", 5) == 0)
            DEA_TRY(save_measured(builder, netlist->lines[i].text, &expressions));
    return DEA_OK;
}

/* ---- options and transient ---- */

static enum dea_status add_options(struct builder *builder, const struct dea_deck_options *options) {
    const struct {
        const char *name;
        double value;
    } numbers[] = {{"reltol", options->reltol},
                   {"abstol", options->abstol},
                   {"vntol", options->vntol},
                   {"chgtol", options->chgtol},
                   {"trtol", options->trtol}};
    for (size_t i = 0; i < sizeof numbers / sizeof numbers[0]; i++)
        if (numbers[i].value > 0.0)
            DEA_TRY(add(builder, -1, ".options %s=%.17g", numbers[i].name, numbers[i].value));
    if (options->method == DEA_INTEGRATION_GEAR)
        DEA_TRY(add(builder, -1, ".options method=gear"));
    return DEA_OK;
}

double dea_deck_longest_step(const struct dea_deck_options *options) {
    return options->max_step > 0.0 ? options->max_step : options->stop / 50.0;
}

static enum dea_status add_transient(struct builder *builder, const struct dea_deck_options *options) {
    double step = options->step > 0.0 ? options->step : options->stop / 1000.0;
    return add(builder, -1, ".tran %.17g %.17g 0 %.17g%s", step, options->stop, dea_deck_longest_step(options),
               options->uic ? " uic" : "");
}

static enum dea_status check_input(const struct dea_netlist *netlist, const struct dea_circuit_device *devices,
                                   const struct dea_deck_options *options, struct dea_error *error) {
    if (!(options->stop > 0.0) || !isfinite(options->stop))
        return dea_fail(error, DEA_ERR_INPUT, "%s: the transient needs a stop time", netlist->files[0]);
    for (int i = 0; i < netlist->instance_count; i++) {
        const struct dea_circuit_device *device = &devices[netlist->instances[i].device];
        for (int port = 0; port < device->port_count; port++)
            if (!(device->ports[port].rest_capacitance > 0.0) || !isfinite(device->ports[port].rest_capacitance))
                return dea_fail(error, DEA_ERR_INTERNAL, "device %s has no capacitance", device->name);
    }
    return DEA_OK;
}

enum dea_status dea_deck_build(const struct dea_netlist *netlist, const struct dea_circuit_device *devices,
                               const struct dea_deck_options *options, struct dea_deck *deck, struct dea_error *error) {
    memset(deck, 0, sizeof *deck);
    struct builder builder = {.deck = deck, .error = error};
    DEA_TRY(check_input(netlist, devices, options, error));
    DEA_TRY(add(&builder, 0, "deasim"));
    for (int i = 1; i < netlist->line_count; i++)
        if (netlist->lines[i].passed)
            DEA_TRY(add(&builder, i, "%s", netlist->lines[i].text));
    for (int i = 0; i < netlist->instance_count; i++) { /* one subcircuit per device, at its first use */
        int device = netlist->instances[i].device;
        bool first = true;
        for (int earlier = 0; earlier < i; earlier++)
            first = first && netlist->instances[earlier].device != device;
        if (first)
            DEA_TRY(add_device(&builder, netlist, device, &devices[device], options->uic));
    }
    DEA_TRY(add_options(&builder, options));
    DEA_TRY(add_saves(&builder, netlist, devices, options));
    DEA_TRY(add_transient(&builder, options));
    return add(&builder, -1, ".end");
}

void dea_deck_clear(struct dea_deck *deck) {
    for (int i = 0; i < deck->line_count; i++)
        free(deck->lines[i]);
    free(deck->lines);
    free(deck->origins);
    memset(deck, 0, sizeof *deck);
}
