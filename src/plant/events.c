/* Failure measures of physics.md section 8 as functions that are positive while all is well; IDA locates their zeros in
 * time. */
#include "plant/amplifier.h"
#include "plant/integrator.h"

#include <float.h>
#include <math.h>
#include <string.h>

#define LIMIT_MARGIN 1e-3   /* of the elastic law, D/Jm */
#define HYSTERESIS 1e-9     /* a limit just crossed must be left by this much, so that rounding is no event */
#define STOP_HYSTERESIS 0.1 /* of what a step may err: a platform leaving a stop must be off it for good */

static double breakdown_reserve(const struct dea_plant *plant, int k) {
    const struct dea_device *device = plant->device;
    const struct dea_film *film = &plant->points[k].film;
    double thickness = device->thickness * device->prestretch[0] / film->lam;
    double strength = dea_breakdown_field(&device->material.dielectric, thickness, film->lam, device->prestretch[1]);
    double ratio = dea_zone_field(device, film->voltage, film->lam) / strength;
    return 1.0 - ratio * ratio;
}

static double stress2_reserve(const struct dea_plant *plant, int k) {
    const struct zone_point *point = &plant->points[k];
    return dea_film_stress2(plant->device, k, &point->film, point->branches) /
           dea_law_modulus(&plant->device->material.elastic);
}

static double stability_reserve(const struct dea_plant *plant) {
    double stiffness = 0.0;
    bool taut = false;
    for (int k = 0; k < DEA_ZONES; k++)
        if (plant->zones[k].present) {
            stiffness += plant->points[k].film.stiffness;
            taut = taut || !plant->points[k].film.slack;
        }
    return taut ? stiffness / plant->device->stiffness : 1.0; /* all slack: reported as slack */
}

/* Value of one root function at the evaluated state. */
static double reserve(const struct dea_plant *plant, int index, double x) {
    const struct dea_device *device = plant->device;
    int k = plant->roots[index].zone;
    switch (plant->roots[index].kind) {
    case DEA_EVENT_BREAKDOWN:
        return breakdown_reserve(plant, k);
    case DEA_EVENT_SLACK:
        return plant->points[k].film.margin / dea_law_modulus(&device->material.elastic);
    case DEA_EVENT_STRESS2:
        return stress2_reserve(plant, k);
    case DEA_EVENT_LIMIT:
        return dea_law_margin(&device->material.elastic, plant->points[k].film.lam, device->prestretch[1]) -
               LIMIT_MARGIN;
    case DEA_EVENT_STABILITY:
        return stability_reserve(plant);
    case DEA_EVENT_STOP:
        return (plant->roots[index].sign > 0 ? device->stops[1] - x : x - device->stops[0]) / plant->scale[plant->x];
    default:
        return 1.0;
    }
}

int plant_root_functions(sunrealtype t, N_Vector y, N_Vector yp, sunrealtype *values, void *context) {
    struct dea_plant *plant = context;
    const double *u = NV_DATA_S(y), *up = NV_DATA_S(yp);
    double velocity = plant_velocity(plant, u, up);
    plant->rates_now = up;
    if (plant_evaluate(plant, t, u, velocity, false) != DEA_OK)
        return 1;
    plant_remember(plant, t, u, velocity, false);
    for (int i = 0; i < plant->event_count; i++) {
        double value = reserve(plant, i, u[plant->x] * plant->scale[plant->x]);
        if (plant->violated[i])
            value -=
                plant->roots[i].kind == DEA_EVENT_STOP ? fmax(STOP_HYSTERESIS * plant->rtol, HYSTERESIS) : HYSTERESIS;
        values[i] = value != 0.0 ? value : DBL_MIN; /* IDA cannot leave a function that stays at 0 */
    }
    plant_limit_roots(plant, t, up, values + plant->event_count);
    return 0;
}

static void add_root(struct dea_plant *plant, enum dea_event_kind kind, int zone, int sign) {
    plant->roots[plant->event_count].kind = kind;
    plant->roots[plant->event_count].zone = zone;
    plant->roots[plant->event_count].sign = sign;
    plant->event_count++;
}

enum dea_status dea_plant_watch(struct dea_plant *plant, unsigned kinds, struct dea_error *error) {
    const struct dea_device *device = plant->device;
    plant->event_count = 0;
    memset(plant->violated, 0, sizeof plant->violated);
    for (int kind = 0; kind < DEA_EVENT_COUNT; kind++) {
        if (!(kinds & 1u << kind))
            continue;
        if (kind == DEA_EVENT_STABILITY) {
            add_root(plant, DEA_EVENT_STABILITY, ABSENT, 1);
        } else if (kind == DEA_EVENT_STOP) {
            if (device->has_stops) {
                add_root(plant, DEA_EVENT_STOP, ABSENT, -1);
                add_root(plant, DEA_EVENT_STOP, ABSENT, 1);
            }
        } else {
            for (int k = 0; k < DEA_ZONES; k++) {
                bool charged = plant->zones[k].present && plant->zones[k].kind != DEA_PORT_PASSIVE;
                bool breakable = charged && !isinf(device->material.dielectric.breakdown);
                if (plant->zones[k].present && (kind != DEA_EVENT_BREAKDOWN || breakable))
                    add_root(plant, (enum dea_event_kind)kind, k, 1);
            }
        }
    }
    int directions[MAX_EVENTS + MAX_LIMITS] = {0}, count = plant->event_count + plant->limit_count;
    for (int i = plant->event_count; i < count; i++)
        directions[i] = -1;
    if (IDARootInit(plant->ida, count, count > 0 ? plant_root_functions : NULL) != IDA_SUCCESS ||
        (count > 0 && IDASetRootDirection(plant->ida, directions) != IDA_SUCCESS))
        return dea_fail(error, DEA_ERR_INTERNAL, "cannot set up the root functions of the events");
    return DEA_OK;
}

void dea_plant_roots(struct dea_plant *plant, dea_event_found found, void *context) {
    for (int i = 0; i < plant->event_count; i++) {
        if (plant->root_hits[i] == 0)
            continue;
        plant->violated[i] = plant->root_hits[i] < 0;
        found(context, plant->roots[i].kind, plant->roots[i].zone, !plant->violated[i]);
    }
}

void dea_plant_conditions(struct dea_plant *plant, dea_event_found found, void *context) {
    double values[MAX_EVENTS + MAX_LIMITS];
    if (plant_root_functions(plant->t, plant->y, plant->yp, values, plant) != 0)
        return; /* outside the model: the next step says so */
    for (int i = 0; i < plant->event_count; i++) {
        bool violated = values[i] < 0.0;
        if (violated != plant->violated[i]) {
            plant->violated[i] = violated;
            found(context, plant->roots[i].kind, plant->roots[i].zone, !violated);
        }
    }
}
