/* deasim export: devices as behavioural subcircuits, native sources as ngspice's own. */
#include "deasim/export.h"

#include "cosim/cosim.h"
#include "cosim/coupled.h"
#include "cosim/export_internal.h"
#include "deasim/design.h"

#include <ctype.h>
#include <math.h>
#include <string.h>

/* Longest step: ngspice hardly controls the error of the motion. A thousandth of the run; less where the platform's
 * period asks for it, but not so little that the run takes for ever. */
#define FEWEST_STEPS 1000.0
#define MOST_STEPS 40000.0
#define STEPS_PER_PERIOD 400.0

/* ---- the start ---- */

/* Film voltages that .ic gives the instances of a device; they share one subcircuit, so all must have the same. */
static enum dea_status read_film_voltages(const struct dea_scene *scene, const struct dea_netlist *netlist, int d,
                                          double voltages[DEA_ZONES], struct dea_error *error) {
    int zones[DEA_ZONES], ports = coupled_order_ports(&scene->devices[d].device, zones);
    const struct dea_netlist_instance *first = NULL;
    for (int i = 0; i < netlist->instance_count; i++) {
        const struct dea_netlist_instance *instance = &netlist->instances[i];
        if (instance->device != d)
            continue;
        for (int p = 0; p < ports; p++) {
            double v = cosim_initial_voltage(netlist, instance->nodes[2 * p]) -
                       cosim_initial_voltage(netlist, instance->nodes[2 * p + 1]);
            if (first != NULL && v != voltages[zones[p]])
                return dea_fail(error, DEA_ERR_INPUT,
                                "%s: %s and %s start from different film voltages (.ic, uic): give them devices of "
                                "their own to export them",
                                scene->path, first->path, instance->path);
            voltages[zones[p]] = v;
        }
        first = first != NULL ? first : instance;
    }
    return DEA_OK;
}

/* Where the device rests at these film voltages, or at the given x. */
static enum dea_status rest_at(const struct dea_scene *scene, int d, const double voltages[DEA_ZONES],
                               struct export_start *start, struct dea_error *error) {
    const struct dea_device *device = &scene->devices[d].device;
    struct dea_device loaded = *device; /* shares what it owns */
    struct dea_static_point point = {.x = start->x};
    if (scene->has_load_waveform)
        loaded.load += export_value_at_rest(&scene->load);
    if (!start->has_x)
        DEA_TRY(dea_static_solve(&loaded, voltages, &point, error));
    start->x = point.x;
    for (int k = 0; k < DEA_ZONES; k++) {
        if (!device->zones[k].present)
            continue;
        start->stretch[k] = start->has_x ? dea_zone_stretch(device, k, start->x) : point.zones[k].stretch;
        if (device->zones[k].electroded)
            start->charge[k] = dea_zone_capacitance(device, k, start->stretch[k], NULL, NULL) * voltages[k];
    }
    return DEA_OK;
}

/* Without operating point (uic) the deck has to hold every state. */
static enum dea_status rest_without_circuit(const struct dea_scene *scene, const struct dea_netlist *netlist, int d,
                                            struct export_start *start, struct dea_error *error) {
    double voltages[DEA_ZONES] = {0.0, 0.0};
    if (start->fresh)
        return dea_fail(error, DEA_ERR_INPUT,
                        "%s: initial: fresh: plain ngspice finds where a fresh film rests in its operating point, "
                        "which uic skips",
                        scene->path);
    DEA_TRY(read_film_voltages(scene, netlist, d, voltages, error));
    return rest_at(scene, d, voltages, start, error);
}

/* Near enough for ngspice's operating point: the rest at the native sources' voltages, at 0 V in a circuit. Where there
 * is none, the prestretch stays the guess. */
static void guess_rest(const struct dea_scene *scene, int d, struct export_start *start) {
    const struct dea_device *device = &scene->devices[d].device;
    double voltages[DEA_ZONES] = {0.0, 0.0};
    struct dea_error ignored;
    for (int k = 0; k < DEA_ZONES; k++)
        if (scene->netlist == NULL && device->zones[k].electroded && scene->sources[k].present)
            voltages[k] = export_value_at_rest(&scene->sources[k].waveform);
    if (rest_at(scene, d, voltages, start, &ignored) != DEA_OK)
        for (int k = 0; k < DEA_ZONES; k++)
            start->stretch[k] = device->prestretch[0];
}

static enum dea_status plan_start(const struct dea_scene *scene, const struct dea_netlist *netlist, int d, double stop,
                                  struct export_start *start, struct dea_error *error) {
    *start = (struct export_start){.fresh = scene->start == DEA_START_FRESH,
                                   .has_x = scene->has_initial_x,
                                   .uic = netlist != NULL && netlist->tran.uic,
                                   .x = scene->has_initial_x ? scene->initial_x : 0.0,
                                   .v = scene->has_initial_v ? scene->initial_v : 0.0,
                                   .kick = EXPORT_EDGE * stop};
    if (start->uic)
        return rest_without_circuit(scene, netlist, d, start, error);
    guess_rest(scene, d, start);
    return DEA_OK;
}

/* ---- the deck ---- */

/* Shortest natural period of the scene's devices, s; INFINITY without mass. */
static double shortest_period(const struct dea_scene *scene) {
    double period = INFINITY;
    for (int d = 0; d < scene->device_count; d++) {
        const struct dea_device *device = &scene->devices[d].device;
        if (device->effective_mass > 0.0)
            period = fmin(period, 2.0 * M_PI * sqrt(device->effective_mass / device->stiffness));
    }
    return period;
}

static void write_analysis(const struct dea_scene *scene, const struct dea_netlist *netlist, double stop, FILE *file) {
    double step = stop / FEWEST_STEPS;
    double longest = fmin(step, fmax(shortest_period(scene) / STEPS_PER_PERIOD, stop / MOST_STEPS));
    if (netlist != NULL && netlist->tran.step > 0.0)
        step = netlist->tran.step;
    if (netlist != NULL && netlist->tran.max_step > 0.0)
        longest = fmin(longest, netlist->tran.max_step);
    if (netlist == NULL)
        longest = fmin(longest, export_native_step(scene));
    if (scene->max_step > 0.0)
        longest = fmin(longest, scene->max_step);
    fprintf(file, "\n.tran %.17g %.17g 0 %.17g%s\n", step, stop, longest,
            netlist != NULL && netlist->tran.uic ? " uic" : "");
    /* one column, so that batch mode without a raw file has something to print */
    const char *pos = "pos";
    if (netlist != NULL) {
        const struct dea_netlist_instance *first = &netlist->instances[0];
        int zones[DEA_ZONES];
        pos = first->nodes[2 * coupled_order_ports(&scene->devices[first->device].device, zones)];
    }
    fprintf(file, ".print tran v(%s)\n.end\n", pos);
}

static enum dea_status write_deck(const struct dea_scene *scene, const struct dea_netlist *netlist, double stop,
                                  FILE *file, struct dea_error *error) {
    /* a first line that begins like a command would be one to ngspice */
    const char *title = scene->title != NULL ? scene->title : "";
    fprintf(file, "%s%s\n* written by deasim export; events are left out\n",
            isalnum((unsigned char)title[0]) ? "" : "deasim: ", title);
    for (int i = 1; netlist != NULL && i < netlist->line_count; i++)
        if (netlist->lines[i].passed)
            fprintf(file, "%s\n", netlist->lines[i].text);
    if (netlist == NULL)
        export_native_drive(file, scene, stop);
    for (int d = 0; d < scene->device_count; d++) {
        struct export_start start;
        DEA_TRY(plan_start(scene, netlist, d, stop, &start, error));
        export_device(file, scene, d, &start, stop);
    }
    write_analysis(scene, netlist, stop, file);
    return DEA_OK;
}

enum dea_status dea_export_scene(const struct dea_scene *scene, bool trust_netlist, FILE *file,
                                 struct dea_error *error) {
    struct dea_netlist netlist = {0};
    double stop = scene->stop;
    enum dea_status status = DEA_OK;
    if (scene->netlist != NULL) {
        status = cosim_read_netlist(scene, trust_netlist, NULL, &netlist, error);
        if (status == DEA_OK)
            status = cosim_choose_stop(scene, &netlist, &stop, error);
    }
    if (status == DEA_OK)
        status = write_deck(scene, scene->netlist != NULL ? &netlist : NULL, stop, file, error);
    dea_netlist_clear(&netlist);
    return status;
}
