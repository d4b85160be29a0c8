/* Which unknowns a scene needs, where they are, and how large they are expected to be. */
#include "plant/network.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* A pole fast enough to be out of the way, for an amplifier that only names its slew rate: it settles in a twentieth of
 * the time the slew limit takes over the full voltage. */
#define FREE_POLE_RATIO 20.0

static void lay_out_amplifier(struct zone_layout *zone, const struct dea_plant_port *port, int *count) {
    const struct dea_amplifier *amplifier = port->amplifier;
    if (amplifier == NULL || (isinf(amplifier->bandwidth) && isinf(amplifier->slew_rate)))
        return;
    zone->amplifier = (*count)++;
    zone->slew = amplifier->slew_rate;
    zone->pole = isinf(amplifier->bandwidth) ? FREE_POLE_RATIO * amplifier->slew_rate / fmax(port->peak, 1.0)
                                             : 2.0 * M_PI * amplifier->bandwidth;
}

static void lay_out_zone(const struct dea_device *device, struct zone_layout *zone, int index,
                         const struct dea_plant_port *port, int *count) {
    *zone = (struct zone_layout){.branch = ABSENT, .charge = ABSENT, .amplifier = ABSENT};
    zone->present = device->zones[index].present;
    if (!zone->present)
        return;
    zone->kind = port->kind;
    if (device->material.branch_count > 0) {
        zone->branch = *count;
        *count += 2 * device->material.branch_count;
    }
    zone->control = zone->kind == DEA_PORT_PASSIVE ? DEA_CONTROL_PASSIVE
                    : zone->kind == DEA_PORT_IDEAL ? DEA_CONTROL_VOLTAGE
                                                   : DEA_CONTROL_CHARGE;
    zone->resistive = device->zones[index].electrode_resistance > 0.0 || device->zones[index].sheet_resistance > 0.0;
    if (zone->kind == DEA_PORT_SOURCE)
        lay_out_amplifier(zone, port, count);
    if (zone->kind == DEA_PORT_SOURCE || zone->kind == DEA_PORT_NETWORK)
        zone->charge = (*count)++;
}

/* Largest static displacement the drive can cause, one side at a time, m. */
static double expect_displacement(const struct dea_plant *plant) {
    const struct dea_device *device = plant->device;
    double expected = 0.0, shortest = INFINITY, x, still[DEA_ZONES] = {0.0, 0.0};
    for (int k = 0; k < DEA_ZONES; k++) {
        if (!device->zones[k].present)
            continue;
        shortest = fmin(shortest, device->zones[k].length);
        double voltages[DEA_ZONES] = {0.0, 0.0};
        voltages[k] = plant->options.ports[k].peak;
        if (voltages[k] > 0.0 && plant_find_equilibrium(device, voltages, 0.0, &x) == DEA_OK)
            expected = fmax(expected, fabs(x));
    }
    if (plant->options.load_peak > 0.0 && plant_find_equilibrium(device, still, plant->options.load_peak, &x) == DEA_OK)
        expected = fmax(expected, fabs(x));
    return fmin(fmax(expected, 1e-6 * shortest), 0.5 * shortest);
}

static void set_scales(struct dea_plant *plant) {
    const struct dea_device *device = plant->device;
    double x = expect_displacement(plant);
    double stiffness = device->stiffness > 0.0 ? device->stiffness : 1.0;
    plant->scale[plant->x] = x;
    if (plant->v != ABSENT) {
        plant->scale[plant->v] = x * sqrt(stiffness / device->effective_mass);
        plant->follows[plant->v] = true;
    }
    for (int k = 0; k < DEA_ZONES; k++) {
        const struct zone_layout *zone = &plant->zones[k];
        if (!zone->present)
            continue;
        double volts = plant->options.ports[k].peak > 0.0 ? plant->options.ports[k].peak : 1.0;
        if (zone->branch != ABSENT)
            for (int i = 0; i < 2 * device->material.branch_count; i++) {
                plant->scale[zone->branch + i] = x / device->zones[k].length;
                plant->follows[zone->branch + i] = true;
            }
        if (zone->amplifier != ABSENT)
            plant->scale[zone->amplifier] = volts;
        if (zone->charge != ABSENT)
            plant->scale[zone->charge] = volts * device->zones[k].rest_capacitance;
    }
}

enum dea_status plant_lay_out(struct dea_plant *plant, struct dea_error *error) {
    const struct dea_device *device = plant->device;
    int count = 0;
    plant->x = count++;
    plant->v = ABSENT;
    plant->motion = device->effective_mass > 0.0 ? MOTION_INERTIAL
                    : device->damping > 0.0      ? MOTION_VISCOUS
                                                 : MOTION_ALGEBRAIC;
    if (plant->motion == MOTION_INERTIAL)
        plant->v = count++;
    for (int k = 0; k < DEA_ZONES; k++) {
        const struct dea_plant_port *port = &plant->options.ports[k];
        lay_out_zone(device, &plant->zones[k], k, port, &count);
        if (plant->zones[k].kind == DEA_PORT_SOURCE && port->resistance <= 0.0 &&
            device->zones[k].electrode_resistance <= 0.0 && device->zones[k].sheet_resistance <= 0.0)
            return dea_fail(
                error, DEA_ERR_INPUT,
                "drive.%s: an amplifier needs some resistance in series: give output_resistance, resistance "
                "or the electrode's resistance",
                dea_zone_names[k]);
    }
    DEA_TRY(plant_network_lay_out(plant, &count, error));
    plant->state_count = count;
    plant->scale = calloc((size_t)count, sizeof *plant->scale);
    plant->largest = calloc((size_t)count, sizeof *plant->largest);
    plant->follows = calloc((size_t)count, sizeof *plant->follows);
    plant->known.y = calloc((size_t)count, sizeof *plant->known.y);
    if (plant->scale == NULL || plant->largest == NULL || plant->follows == NULL || plant->known.y == NULL)
        return dea_fail(error, DEA_ERR_MEMORY, "out of memory for %d states", count);
    for (int k = 0; k < DEA_ZONES; k++) {
        int branches = device->material.branch_count;
        plant->points[k].branches = calloc((size_t)(branches > 0 ? branches : 1), sizeof *plant->points[k].branches);
        plant->points[k].states = calloc((size_t)(branches > 0 ? 2 * branches : 1), sizeof *plant->points[k].states);
        if (plant->points[k].branches == NULL || plant->points[k].states == NULL)
            return dea_fail(error, DEA_ERR_MEMORY, "out of memory for %d branches", branches);
    }
    size_t branches = (size_t)device->material.branch_count + 1;
    plant->imagined_states = calloc(2 * branches, sizeof *plant->imagined_states);
    plant->imagined_branches = calloc(branches, sizeof *plant->imagined_branches);
    if (plant->imagined_states == NULL || plant->imagined_branches == NULL)
        return dea_fail(error, DEA_ERR_MEMORY, "out of memory for %zu branches", branches);
    set_scales(plant);
    plant_network_scale(plant);
    return DEA_OK;
}

const char *dea_plant_describe(const struct dea_plant *plant, char *buffer, int size) {
    int used = snprintf(buffer, (size_t)size, "x%s", plant->v != ABSENT ? " v" : "");
    for (int k = 0; k < DEA_ZONES && used < size; k++) {
        const struct zone_layout *zone = &plant->zones[k];
        if (!zone->present)
            continue;
        used += snprintf(buffer + used, (size_t)(size - used), " | %s:", dea_zone_names[k]);
        for (int b = 0; zone->branch != ABSENT && b < plant->device->material.branch_count && used < size; b++) {
            bool foo = plant->device->material.branches[b].kind == DEA_BRANCH_FOO;
            used += snprintf(buffer + used, (size_t)(size - used), foo ? " xi1[%d] xi2[%d]" : " a1[%d] a3[%d]", b + 1,
                             b + 1);
        }
        if (zone->amplifier != ABSENT && used < size)
            used += snprintf(buffer + used, (size_t)(size - used), " u");
        if (zone->charge != ABSENT && used < size)
            used += snprintf(buffer + used, (size_t)(size - used), " Q");
    }
    if (plant->network != ABSENT && used < size)
        snprintf(buffer + used, (size_t)(size - used), " | circuit: %d nodes, %d branches",
                 plant->options.network->node_count, plant->options.network->branch_count);
    return buffer;
}

bool dea_plant_is_algebraic(const struct dea_plant *plant) {
    return plant->motion == MOTION_ALGEBRAIC && plant->state_count == 1;
}
