/* The deck the engine runs: the user's lines, one subcircuit per device, our own .tran, .save and .options.
 *
 * Per electroded zone the film is a charge Q = c V + q0 with c and q0 EXTERNAL numbers, in units of Q1 = rest
 * capacitance x 1 kV. The one product is the only thing ngspice has to derive: longer expressions cost more than a
 * converter's whole power stage.
 *     Bq 0 i I = V(p,n) V(c)
 *     Id 0 i external                                    q0, where the coupling asks for it
 *     Ga i 0 q 0 1                                       V(q): charge in units of Q1
 *     Cq q 0 Q1                                          the state; Q1 as a number of farads
 *     Gb 0 q i 0 1                                       V(i) = dQ/dt, 1 V per A
 *     Gq p n i 0 1
 * Ga, Gb and Cq are an inductor between i and ground. An inductor itself ngspice looks up by the name of its kind in
 * every iteration, a fifth of what a circuit without any costs.
 * External numbers come as currents: one straight into i, the others through 1 Ohm to be voltages (c above).
 * State of order 1, and a tolerance of vntol = 1 uA on the current: tighter than that, rounding noise C dV/dt of a kV
 * node stops ngspice with "timestep too small"; looser states (1 V = 1 A with unscaled charge, ngspice's own `C Q=`)
 * lose charge on an isolated node. */
#ifndef DEASIM_CIRCUIT_DECK_H
#define DEASIM_CIRCUIT_DECK_H

#include "circuit/netlist.h"

/* What the coupling feeds into a device instance. SI units. */
enum dea_external {
    DEA_EXTERNAL_CAPACITANCE, /* c in Q = c V + q0, F */
    DEA_EXTERNAL_OFFSET,      /* q0, C */
    DEA_EXTERNAL_RESISTANCE,  /* R_e, Ohm */
    DEA_EXTERNAL_STRETCH,     /* lam1, for the leakage */
    DEA_EXTERNAL_SHORT,       /* conductance of a punctured film, S */
    DEA_EXTERNAL_POSITION,    /* x, m (zone is -1); the pin shows 1 V per mm */
    DEA_EXTERNAL_COUNT
};

/* Electrical side of one electroded zone. */
struct dea_port {
    double rest_capacitance;   /* scale of c, F */
    bool offset;               /* ask for DEA_EXTERNAL_OFFSET; false: q0 = 0 */
    double resistance;         /* series R_e, Ohm; with resistance_external its value at rest; 0: none */
    bool resistance_external;  /* ask for DEA_EXTERNAL_RESISTANCE */
    double conductivity;       /* s0, S/m; 0: no leakage */
    double conductivity_field; /* E_B in sigma = s0 exp(|E|/E_B), V/m; INFINITY: ohmic */
    double leakage_area;       /* w l0 / lp1: area is this times lam1, m^2 */
    double leakage_thickness;  /* t0 lp1: E = V lam1 / this, m */
    bool may_short;            /* ask for DEA_EXTERNAL_SHORT */
    double initial_charge;     /* C; used with uic only, same for all instances of the device */
};

/* The device a netlist name stands for; same order as dea_netlist_options.devices. */
struct dea_circuit_device {
    const char *name;
    int port_count; /* electroded zones, in pin order */
    struct dea_port ports[DEA_ZONES];
};

enum dea_integration { DEA_INTEGRATION_TRAPEZOIDAL, DEA_INTEGRATION_GEAR };

/* How the engine runs. A tolerance of 0 keeps the netlist's or ngspice's own value. */
struct dea_deck_options {
    double stop;                 /* end of the run, s */
    double step;                 /* sets the first step (step / 100, at a breakpoint), s; 0: stop / 1000 */
    double max_step;             /* longest step, s; 0: stop / 50 */
    bool uic;                    /* skip the operating point, start from .ic */
    double reltol;               /* relative tolerance */
    double abstol;               /* A */
    double vntol;                /* V */
    double chgtol;               /* C */
    double trtol;                /* truncation error overestimate; 1 is strict, ngspice's default 7 */
    enum dea_integration method; /* ngspice never goes beyond order 2, whatever maxord says */
    bool forget_points;       /* memory stays flat: ngspice keeps the last point only, and no .measure works any more in
                               * this process */
    const char *const *nodes; /* user nodes whose voltage is wanted at accepted points */
    int node_count;
};

struct dea_deck {
    char **lines; /* owned, NULL-terminated, as ngSpice_Circ wants them */
    int *origins; /* owned; index into netlist lines, -1: generated */
    int line_count;
};

enum dea_status dea_deck_build(const struct dea_netlist *netlist, const struct dea_circuit_device *devices,
                               const struct dea_deck_options *options, struct dea_deck *deck, struct dea_error *error);

void dea_deck_clear(struct dea_deck *deck);

#endif
