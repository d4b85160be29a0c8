/* What deck and engine agree on. */
#ifndef DEASIM_CIRCUIT_DECK_INTERNAL_H
#define DEASIM_CIRCUIT_DECK_INTERNAL_H

#include "circuit/deck.h"

/* Charge (C) one unit of the state stands for: rest capacitance times 1 kV. */
double dea_port_charge_unit(const struct dea_port *port);

/* ngspice's longest step, s. */
double dea_deck_longest_step(const struct dea_deck_options *options);

#endif
