/* .param of a netlist, as far as it is worked out without ngspice: numbers, and arithmetic of parameters further up. */
#ifndef DEASIM_CIRCUIT_PARAMETERS_H
#define DEASIM_CIRCUIT_PARAMETERS_H

#include "circuit/netlist.h"

#define DEA_PARAMETERS_MAX 100

struct dea_parameters {
    char *names[DEA_PARAMETERS_MAX]; /* owned, lower case */
    double values[DEA_PARAMETERS_MAX];
    int count;
};

/* Takes the .param lines. False: something in them is for ngspice. The caller clears the parameters in any case. */
bool dea_parameters_read(struct dea_parameters *parameters, const struct dea_netlist *netlist);

/* The line with numbers in place of {..} and '..', malloc'd; NULL: for ngspice. */
char *dea_parameters_put_in(const struct dea_parameters *parameters, const char *line);

void dea_parameters_clear(struct dea_parameters *parameters);

#endif
