/* Recognises linear circuits: R, C, L, K, independent and linear controlled sources, from plain lines or read back
 * flattened from ngspice, as equations that can be solved together with the device. */
#ifndef DEASIM_CIRCUIT_LINEAR_H
#define DEASIM_CIRCUIT_LINEAR_H

#include "circuit/engine.h"
#include "deasim/network.h"

/* False when a line of the netlist shows at once that it is not linear, or asks for something only ngspice does
 * (uic, several devices). Costs no ngspice. */
bool dea_linear_possible(const struct dea_netlist *netlist);

/* Lists the circuit as dea_engine_list does, but from the netlist alone, after dea_linear_possible. *plain is false
 * where only ngspice knows what the lines mean. The caller clears the listing, also after a failure. */
enum dea_status dea_linear_list(const struct dea_netlist *netlist, struct dea_listing *listing, bool *plain,
                                struct dea_error *error);

/* True when every .measure line can be evaluated on a file of the circuit's unknowns: no parameters in it. */
bool dea_measures_movable(const struct dea_netlist *netlist);

/* Turns a listing into equations. *linear is false, and *why says which line, when something in it is not linear or not
 * understood; that is no failure. `step` and `stop` (s) are the defaults of ngspice's sources. Ports are by zone;
 * zones[] is the zone of each port. The caller clears the network in any case. */
enum dea_status dea_linear_read(const struct dea_listing *listing, const struct dea_netlist *netlist,
                                const int zones[DEA_ZONES], int port_count, double step, double stop,
                                struct dea_network *network, bool *linear, char *why, size_t why_size,
                                struct dea_error *error);

#endif
