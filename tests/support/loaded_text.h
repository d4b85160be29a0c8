/* A netlist given as text, read and loaded into an engine with one device: DEA, its one electrode being left. */
#ifndef DEASIM_TEST_LOADED_TEXT_H
#define DEASIM_TEST_LOADED_TEXT_H

#include "circuit/engine.h"

/* What has to outlive the run; not copyable once loaded. */
struct loaded_text {
    struct dea_netlist netlist;
    struct dea_deck deck;
    struct dea_circuit_device device;
};

/* A film that does not move: its port, and its numbers for a callback. */
#define STILL_CAPACITANCE 80.5e-12 /* F */
extern const struct dea_port still_port;
double give_still(void *context, int instance, int port, enum dea_external which, double t);

/* The caller clears `loaded`, also after a failure; options and callbacks must outlive the run. */
enum dea_status load_text(struct dea_engine *engine, const char *text, const struct dea_port *port,
                          const struct dea_deck_options *options, const struct dea_engine_callbacks *callbacks,
                          struct loaded_text *loaded, struct dea_error *error);
void clear_text(struct loaded_text *loaded);

#endif
