/* Runs a scene in time: native sources inside one IDA problem, or a netlist in co-simulation. */
#ifndef DEASIM_RUN_H
#define DEASIM_RUN_H

#include "deasim/report.h"
#include "deasim/result.h"
#include "deasim/scene.h"

#include <signal.h>

/* auto: what the scene needs. ngspice: co-simulation also where a circuit could be solved without. native: refuse
 * netlists. */
enum dea_engine_choice { DEA_ENGINE_AUTO, DEA_ENGINE_NGSPICE, DEA_ENGINE_NATIVE };

struct dea_run_options {
    const char *directory;                  /* result files go here; NULL: no files */
    struct dea_report *report;              /* words; must not be NULL, may be silent */
    const volatile sig_atomic_t *interrupt; /* set from outside to end the run in order; may be NULL */
    enum dea_engine_choice engine;
    bool trust_netlist; /* run .control blocks and the like of the netlist */
    double time_limit;  /* of a netlist's run, wall clock, s; 0: none */
};

/* Vets what can be vetted without running: that the devices can be run, and the netlist with its includes, device pins
 * and end time. DEA_ERR_INPUT with the first mistake. */
enum dea_status dea_check_scene(const struct dea_scene *scene, const struct dea_run_options *options,
                                struct dea_error *error);

/* Runs the scene and fills *result (the caller clears it, also after a failure). Returns the result's status: DEA_OK,
 * DEA_STOPPED, or a failure with its message in *error; files and *result then hold everything computed so far. */
enum dea_status dea_run_scene(const struct dea_scene *scene, const struct dea_run_options *options,
                              struct dea_result *result, struct dea_error *error);

#endif
