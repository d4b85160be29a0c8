/* A scene as one deck for plain ngspice: the same physics as behavioural elements, for checking and comparing. */
#ifndef DEASIM_EXPORT_H
#define DEASIM_EXPORT_H

#include "deasim/scene.h"

#include <stdbool.h>
#include <stdio.h>

/* Writes the deck to `file`; it runs in `ngspice -b -r out.raw DECK` unchanged. Events are left out, and the deck's
 * comments say so. DEA_ERR_INPUT for a scene that plain ngspice cannot express (message says what).
 * Whether all of it got into the file is for the caller to find out, who closes it. */
enum dea_status dea_export_scene(const struct dea_scene *scene, bool trust_netlist, FILE *file,
                                 struct dea_error *error);

#endif
