/* What a scene asks of a coupled run: the netlist, the devices' electrical side, the end, the circuit's tolerances. */
#include "cosim/cosim.h"

#include "cosim/coupled.h"

#include <math.h>
#include <stdlib.h>

/* ngspice integrates at second order: its steps go as (reltol trtol)^(1/3) and its error as their square, so the
 * product goes as A^1.5. reltol also ends Newton's iterations, trtol only judges truncation. What the iterations leave
 * is noise in the differences truncation is judged by, so trtol must not be small; and at the operating point nothing
 * follows that would make it good. */
#define NEWTON_SHARE 0.03
#define TRUNCATION_FACTOR 1.25
/* Charges below this part of what the film can hold are not resolved any finer: rounding would stop ngspice. */
#define SMALLEST_CHARGE 1e-3
/* Where ngspice cannot step at these tolerances (junctions and edges at tight ones), both are loosened by this factor
 * and the run repeated. */
#define RELAXATION 4.0

enum dea_status cosim_read_netlist(const struct dea_scene *scene, bool trusted, struct dea_report *report,
                                   struct dea_netlist *netlist, struct dea_error *error) {
    struct dea_netlist_device *devices = calloc((size_t)scene->device_count, sizeof *devices);
    if (devices == NULL)
        return dea_fail(error, DEA_ERR_MEMORY, "out of memory for %d devices", scene->device_count);
    enum dea_status status = DEA_OK;
    for (int d = 0; d < scene->device_count && status == DEA_OK; d++) {
        int zones[DEA_ZONES];
        devices[d].name = scene->devices[d].name;
        devices[d].electrodes = coupled_order_ports(&scene->devices[d].device, zones);
        if (devices[d].electrodes == 0)
            status = dea_fail(error, DEA_ERR_INPUT, "%s: device %s has no electrode, so a netlist cannot drive it",
                              scene->path, scene->devices[d].name);
        for (int p = 0; p < devices[d].electrodes; p++)
            devices[d].zone_names[p] = dea_zone_names[zones[p]];
    }
    struct dea_netlist_options options = {.trusted = trusted, .devices = devices, .device_count = scene->device_count};
    if (status == DEA_OK)
        status = dea_netlist_read(scene->netlist, &options, netlist, error);
    for (int i = 0; status == DEA_OK && report != NULL && i < netlist->warning_count; i++)
        dea_report_warn(report, "%s", netlist->warnings[i]);
    free(devices);
    return status;
}

enum dea_status cosim_choose_stop(const struct dea_scene *scene, const struct dea_netlist *netlist, double *stop,
                                  struct dea_error *error) {
    *stop = scene->has_transient ? scene->stop : netlist->tran.stop;
    if (*stop > 0.0)
        return DEA_OK;
    return dea_fail(error, DEA_ERR_INPUT,
                    "%s: no end of the run: give transient.stop in the scene, or a .tran with plain numbers in %s",
                    scene->path, scene->netlist);
}

static void describe_port(const struct dea_device *device, int k, bool may_short, struct dea_port *port) {
    const struct dea_zone *zone = &device->zones[k];
    const struct dea_dielectric *dielectric = &device->material.dielectric;
    *port = (struct dea_port){
        .rest_capacitance = zone->rest_capacitance,
        .offset = device->effective_mass <= 0.0 || device->slack,
        .resistance = dea_zone_resistance(device, k, device->prestretch[0], NULL),
        .resistance_external = zone->sheet_resistance > 0.0,
        .conductivity = dielectric->conductivity,
        .conductivity_field = dielectric->conductivity_field,
        .leakage_area = device->width * zone->length / device->prestretch[0],
        .leakage_thickness = device->thickness * device->prestretch[0],
        .may_short = may_short,
    };
}

enum dea_status cosim_describe_devices(const struct dea_scene *scene, struct dea_circuit_device **devices,
                                       struct dea_error *error) {
    *devices = calloc((size_t)scene->device_count, sizeof **devices);
    if (*devices == NULL)
        return dea_fail(error, DEA_ERR_MEMORY, "out of memory for %d devices", scene->device_count);
    for (int d = 0; d < scene->device_count; d++) {
        const struct dea_device *device = &scene->devices[d].device;
        int zones[DEA_ZONES];
        (*devices)[d].name = scene->devices[d].name;
        (*devices)[d].port_count = coupled_order_ports(device, zones);
        for (int p = 0; p < (*devices)[d].port_count; p++)
            describe_port(device, zones[p], scene->policies[DEA_EVENT_BREAKDOWN] == DEA_POLICY_SHORT,
                          &(*devices)[d].ports[p]);
    }
    return DEA_OK;
}

double cosim_expect_voltage(const struct dea_device *device) {
    const struct dea_dielectric *dielectric = &device->material.dielectric;
    if (!isinf(dielectric->breakdown))
        return device->thickness *
               dea_breakdown_field(dielectric, device->thickness, device->prestretch[0], device->prestretch[1]);
    double permittivity = dielectric->permittivity + dielectric->permittivity_slope * device->prestretch[0];
    return device->thickness *
           sqrt(dea_law_modulus(&device->material.elastic) / (DEA_VACUUM_PERMITTIVITY * permittivity));
}

void cosim_choose_tolerances(const struct dea_scene *scene, const struct dea_netlist *netlist, double stop, int relaxed,
                             struct dea_deck_options *options) {
    double looser = pow(RELAXATION, relaxed), largest_charge = 0.0;
    for (int d = 0; d < scene->device_count; d++) {
        const struct dea_device *device = &scene->devices[d].device;
        for (int k = 0; k < DEA_ZONES; k++)
            largest_charge = fmax(largest_charge, device->zones[k].rest_capacitance * cosim_expect_voltage(device));
    }
    *options = (struct dea_deck_options){
        .stop = stop,
        .step = netlist->tran.step,
        .max_step = netlist->tran.max_step,
        .uic = netlist->tran.uic,
        .reltol = fmin(1e-3, NEWTON_SHARE * scene->accuracy * looser),
        .trtol = fmin(TRUNCATION_FACTOR * sqrt(scene->accuracy) * looser, 7.0),
        .chgtol = SMALLEST_CHARGE * largest_charge,
        .forget_points = netlist->measure_count == 0,
    };
}
