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
/* The same of a light platform, which leaves by the push; and how much deeper than the push takes it, in hystereses, it
 * is by momentum. */
#define LIGHT_HYSTERESIS 1.0
#define DEEP 10.0

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
    double stress2;
    if (dea_film_stress2(plant->device, k, point->film.lam, point->film.voltage, point->branches, &stress2) != DEA_OK)
        return -1.0;
    return stress2 / dea_law_modulus(&plant->device->material.elastic);
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

static double distance_to_stop(const struct dea_plant *plant, int sign, double x) {
    const double *stops = plant->device->stops;
    return (sign > 0 ? stops[1] - x : x - stops[0]) / plant->scale[plant->x];
}

/* Whether a light platform is pushed onto a stop, as the distance (scaled) from the stop to about where it would
 * come to rest without it: positive when pulled off. The forces it would feel at the stop depend on charges and
 * branches alone, which are smooth. */
static enum dea_status find_push(struct dea_plant *plant, double t, const double *u, int sign, double *distance) {
    double *there = NV_DATA_S(plant->sample_y), scale = plant->scale[plant->x];
    enum held_stop kept[2] = {plant->stops_held[0], plant->stops_held[1]};
    memcpy(there, u, (size_t)plant->state_count * sizeof *there);
    there[plant->x] = plant->device->stops[sign > 0] / scale;
    plant->stops_held[0] = plant->stops_held[1] = STOP_OFF;
    plant_forget(plant);
    enum dea_status status = plant_evaluate(plant, t, there, 0.0, false);
    memcpy(plant->stops_held, kept, sizeof kept);
    *distance = -sign * plant->force / (plant->device->stiffness * scale);
    return status;
}

bool plant_is_light(const struct dea_plant *plant) {
    const struct dea_device *device = plant->device;
    return device->stiffness > 0.0 &&
           (plant->v == ABSENT || device->damping >= 2.0 * sqrt(device->stiffness * device->effective_mass));
}

/* A light platform's distance to a stop. Its position has a bend where it comes to the stop or leaves it, and hardly
 * changes while it rests there: where an interpolation finds it off the stop the forces may put it back, again and
 * again. So a platform on the stop leaves it when the push changes sign, and one without damping comes to it then, too.
 */
static enum dea_status light_reserve(struct dea_plant *plant, double t, const double *u, int index, double *value) {
    int sign = plant->roots[index].sign;
    double push, gap = distance_to_stop(plant, sign, u[plant->x] * plant->scale[plant->x]);
    DEA_TRY(find_push(plant, t, u, sign, &push));
    double hysteresis = fmax(LIGHT_HYSTERESIS * plant->rtol, HYSTERESIS);
    bool thrown = plant->v != ABSENT && sign * u[plant->v] > 0.0; /* onto the stop, whatever the forces do */
    /* deeper than the push takes it: by momentum */
    double rest = fmax(-push, 0.0) * plant->device->stiffness / plant->device->stop_stiffness;
    bool deep = thrown || (plant->v != ABSENT && -gap > 2.0 * rest + DEEP * hysteresis);
    if (plant->motion == MOTION_ALGEBRAIC)
        *value = push;
    else if (plant->violated[index])
        *value = deep ? gap : fmax(push, gap - hysteresis);
    else
        *value = thrown ? gap : fmax(push, gap);
    return DEA_OK;
}

void plant_release_stops(struct dea_plant *plant) {
    plant->stops_held[0] = plant->stops_held[1] = STOP_UNDECIDED;
    plant_forget(plant);
}

/* Without mass and damping the equations themselves have that bend, where Newton's iteration would go to and fro: a
 * stop pushes or does not over whole steps. */
void plant_hold_stops(struct dea_plant *plant) {
    if (plant->motion != MOTION_ALGEBRAIC || plant->device->stiffness <= 0.0)
        return;
    for (int i = 0; i < plant->event_count; i++)
        if (plant->roots[i].kind == DEA_EVENT_STOP)
            plant->stops_held[plant->roots[i].sign > 0] = plant->violated[i] ? STOP_ON : STOP_OFF;
    plant_forget(plant);
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
        return distance_to_stop(plant, plant->roots[index].sign, x);
    default:
        return 1.0;
    }
}

int plant_root_functions(sunrealtype t, N_Vector y, N_Vector yp, sunrealtype *values, void *context) {
    struct dea_plant *plant = context;
    const double *u = NV_DATA_S(y), *up = NV_DATA_S(yp);
    double velocity = plant_velocity(plant, u, up), reserves[MAX_EVENTS] = {0.0};
    plant->rates_now = up;
    bool light = plant_is_light(plant);
    for (int i = 0; light && i < plant->event_count; i++)
        if (plant->roots[i].kind == DEA_EVENT_STOP && light_reserve(plant, t, u, i, &reserves[i]) != DEA_OK)
            return 1;
    if (plant_evaluate(plant, t, u, velocity, false) != DEA_OK)
        return 1;
    plant_remember(plant, t, u, velocity, false);
    for (int i = 0; i < plant->event_count; i++) {
        bool stop = plant->roots[i].kind == DEA_EVENT_STOP;
        double value = stop && light ? reserves[i] : reserve(plant, i, u[plant->x] * plant->scale[plant->x]);
        if (plant->violated[i])
            value -= stop && !light ? fmax(STOP_HYSTERESIS * plant->rtol, HYSTERESIS) : HYSTERESIS;
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
    plant_hold_stops(plant);
}
