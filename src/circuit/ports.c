/* External numbers into ngspice, samples out of it. */
#include "circuit/engine_internal.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

static enum dea_status out_of_memory(struct dea_error *error) {
    return dea_fail(error, DEA_ERR_MEMORY, "out of memory for the circuit");
}

/* ---- external numbers ---- */

static enum dea_status add_source(struct dea_engine *engine, int instance, int port, enum dea_external which,
                                  double scale, struct dea_error *error) {
    static const char letters[DEA_EXTERNAL_COUNT] = {'c', 'd', 'r', 's', 'h', 'p'};
    struct dea_external_source *source = &engine->sources[engine->source_count];
    *source = (struct dea_external_source){
        .instance = instance, .port = port, .which = which, .scale = scale, .told_at = NAN};
    const char *path = engine->netlist->instances[instance].path;
    int made = which == DEA_EXTERNAL_POSITION ? asprintf(&source->name, "v.%s.vpos", path)
                                              : asprintf(&source->name, "i.%s.i%c%d", path, letters[which], port);
    if (made < 0) {
        source->name = NULL;
        return out_of_memory(error);
    }
    engine->source_count++;
    return DEA_OK;
}

static enum dea_status add_sources(struct dea_engine *engine, int instance, struct dea_error *error) {
    const struct dea_circuit_device *device = &engine->devices[engine->netlist->instances[instance].device];
    for (int i = 0; i < device->port_count; i++) {
        const struct dea_port *port = &device->ports[i];
        double unit = 1.0 / dea_port_charge_unit(port);
        DEA_TRY(add_source(engine, instance, i, DEA_EXTERNAL_CAPACITANCE, unit, error));
        if (port->offset)
            DEA_TRY(add_source(engine, instance, i, DEA_EXTERNAL_OFFSET, unit, error));
        if (port->resistance > 0.0 && port->resistance_external)
            DEA_TRY(add_source(engine, instance, i, DEA_EXTERNAL_RESISTANCE, 1.0 / port->resistance, error));
        if (port->conductivity > 0.0)
            DEA_TRY(add_source(engine, instance, i, DEA_EXTERNAL_STRETCH, 1.0, error));
        if (port->may_short)
            DEA_TRY(add_source(engine, instance, i, DEA_EXTERNAL_SHORT, 1.0, error));
    }
    return add_source(engine, instance, -1, DEA_EXTERNAL_POSITION, 1e3, error); /* 1 V per mm */
}

/* By ngspice's pointer, and by the name itself the first time. -1: not one of ours. */
static int find_source(const struct dea_engine *engine, const char *name) {
    for (int i = 0; i < engine->source_count; i++)
        if (engine->sources[i].asked_as == name)
            return i;
    for (int i = 0; i < engine->source_count; i++)
        if (strcasecmp(engine->sources[i].name, name) == 0)
            return i;
    return -1;
}

double dea_engine_external_value(struct dea_engine *engine, const char *name, double t) {
    /* ngspice asks in the same order at every iteration, its own: each source remembers which came after it */
    struct dea_external_source *before = &engine->sources[engine->last_source], *source;
    source = &engine->sources[before->next];
    if (source->asked_as != name) {
        int i = find_source(engine, name);
        if (i < 0)
            return 0.0; /* vetting lets no other EXTERNAL source through */
        before->next = i;
        source = &engine->sources[i];
        source->asked_as = name;
    }
    engine->last_source = before->next;
    engine->stats.iterations += source == engine->sources;
    if (t != source->told_at) {
        const struct dea_engine_callbacks *callbacks = engine->callbacks;
        source->told_at = t;
        source->told =
            source->scale * callbacks->port_value(callbacks->context, source->instance, source->port, source->which, t);
    }
    return source->told;
}

void dea_engine_forget_values(struct dea_engine *engine) {
    for (int i = 0; i < engine->source_count; i++)
        engine->sources[i].told_at = NAN;
}

/* ---- samples ---- */

/* Index of a node's or branch's vector; ngspice writes a node that is a number as V(1). -2: not there. */
int dea_engine_find_vector(const vecvaluesall *values, const char *name) {
    char numbered[320];
    if (strcmp(name, "0") == 0)
        return -1;
    snprintf(numbered, sizeof numbered, "v(%.300s)", name);
    for (int i = 0; i < values->veccount; i++)
        if (strcasecmp(values->vecsa[i]->name, name) == 0 || strcasecmp(values->vecsa[i]->name, numbered) == 0)
            return i;
    return -2;
}

static enum dea_status map_port(struct dea_engine *engine, int instance, int port, const vecvaluesall *values,
                                struct dea_error *error) {
    const struct dea_netlist_instance *called = &engine->netlist->instances[instance];
    struct dea_port_vectors *vectors = &engine->vectors[instance * DEA_ZONES + port];
    char film[300], current[300], charge[300];
    snprintf(film, sizeof film, "%s.f%d", called->path, port);
    snprintf(current, sizeof current, "%s.i%d", called->path, port);
    snprintf(charge, sizeof charge, "%s.q%d", called->path, port);
    vectors->p = dea_engine_find_vector(values, called->nodes[2 * port]);
    vectors->n = dea_engine_find_vector(values, called->nodes[2 * port + 1]);
    vectors->film = engine->devices[called->device].ports[port].resistance > 0.0 ? dea_engine_find_vector(values, film)
                                                                                 : vectors->p;
    vectors->current = dea_engine_find_vector(values, current);
    vectors->charge = dea_engine_find_vector(values, charge);
    vectors->charge_unit = dea_port_charge_unit(&engine->devices[called->device].ports[port]);
    if (vectors->p == -2 || vectors->n == -2 || vectors->film == -2 || vectors->current < 0 || vectors->charge < 0)
        return dea_fail(error, DEA_ERR_INTERNAL, "ngspice does not deliver the values of device %s", called->path);
    return DEA_OK;
}

enum dea_status dea_engine_map_vectors(struct dea_engine *engine, const vecvaluesall *values, struct dea_error *error) {
    engine->time_vector = dea_engine_find_vector(values, "time");
    if (engine->time_vector < 0)
        return dea_fail(error, DEA_ERR_INTERNAL, "ngspice does not deliver the time");
    for (int i = 0; i < engine->netlist->instance_count; i++)
        for (int port = 0; port < engine->devices[engine->netlist->instances[i].device].port_count; port++)
            DEA_TRY(map_port(engine, i, port, values, error));
    for (int i = 0; i < engine->options->node_count; i++) {
        engine->node_vectors[i] = dea_engine_find_vector(values, engine->options->nodes[i]);
        if (engine->node_vectors[i] == -2)
            return dea_fail(error, DEA_ERR_INPUT, "%s: the circuit has no node %s", engine->netlist->files[0],
                            engine->options->nodes[i]);
    }
    if (engine->switches != NULL)
        dea_switches_map(engine->switches, values);
    engine->vectors_known = true;
    return DEA_OK;
}

static double value_at(const vecvaluesall *values, int index) {
    return index < 0 ? 0.0 : values->vecsa[index]->creal;
}

void dea_engine_fill_samples(struct dea_engine *engine, const vecvaluesall *values) {
    for (int i = 0; i < engine->netlist->instance_count; i++)
        for (int port = 0; port < engine->devices[engine->netlist->instances[i].device].port_count; port++) {
            const struct dea_port_vectors *vectors = &engine->vectors[i * DEA_ZONES + port];
            double n = value_at(values, vectors->n);
            engine->samples[i * DEA_ZONES + port] =
                (struct dea_port_sample){.port_voltage = value_at(values, vectors->p) - n,
                                         .film_voltage = value_at(values, vectors->film) - n,
                                         .charge = value_at(values, vectors->charge) * vectors->charge_unit,
                                         .current = value_at(values, vectors->current)};
        }
    for (int i = 0; i < engine->options->node_count; i++)
        engine->node_values[i] = value_at(values, engine->node_vectors[i]);
}

/* ---- set up ---- */

enum dea_status dea_engine_prepare_ports(struct dea_engine *engine, struct dea_error *error) {
    size_t ports = (size_t)engine->netlist->instance_count * DEA_ZONES, nodes = (size_t)engine->options->node_count;
    engine->sources = calloc(ports * DEA_EXTERNAL_COUNT + 1, sizeof *engine->sources);
    engine->vectors = calloc(ports + 1, sizeof *engine->vectors);
    engine->samples = calloc(ports + 1, sizeof *engine->samples);
    engine->node_vectors = calloc(nodes + 1, sizeof *engine->node_vectors);
    engine->node_values = calloc(nodes + 1, sizeof *engine->node_values);
    if (engine->sources == NULL || engine->vectors == NULL || engine->samples == NULL || engine->node_vectors == NULL ||
        engine->node_values == NULL)
        return out_of_memory(error);
    for (int i = 0; i < engine->netlist->instance_count; i++)
        DEA_TRY(add_sources(engine, i, error));
    return DEA_OK;
}

void dea_engine_clear_ports(struct dea_engine *engine) {
    for (int i = 0; i < engine->source_count; i++)
        free(engine->sources[i].name);
    free(engine->sources);
    free(engine->vectors);
    free(engine->samples);
    free(engine->node_vectors);
    free(engine->node_values);
    engine->sources = NULL;
    engine->vectors = NULL;
    engine->samples = NULL;
    engine->node_vectors = NULL;
    engine->node_values = NULL;
    engine->source_count = engine->last_source = 0;
    engine->vectors_known = false;
}
