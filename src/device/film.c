/* A zone's film: taut at the geometric stretch, or slack at its natural stretch where the net stress vanishes.
 * Work is done with the slope of the zone's energy by stretch,
 *     G(lam) = Vol P1(lam) - (V^2/2) dC/dlam,   V = Q/C under charge control,
 * whose zero is the natural stretch; pull = G lp1 / l0 while G(geometric) >= 0, else 0. */
#include "deasim/film.h"

#include <math.h>
#include <stddef.h>

#define MAX_SLACK_ITERATIONS 100

/* G and its slope at one stretch, with what they were made of. */
struct slope_of_energy {
    double g;     /* dU/dlam, J */
    double g_lam; /* d2U/dlam2 at fixed e, J */
    double soft;  /* the same at fixed voltage, J */
    double g_e;   /* d2U/(dlam de), J/C or J/V */
    double p1;    /* Pa */
    double c, c1; /* F */
    double v;     /* V */
};

struct film_task {
    const struct dea_device *device;
    int zone;
    enum dea_control control;
    double e;
    const double *states;
    struct dea_branch_response *branches;
    bool with_derivatives; /* of the branches by their states */
};

static enum dea_status slope_energy(const struct film_task *task, double lam, struct slope_of_energy *out) {
    const struct dea_device *device = task->device;
    const struct dea_material *material = &device->material;
    double volume = device->zones[task->zone].volume;

    /* springs and branches */
    struct dea_stress stress;
    DEA_TRY(dea_law_stress(&material->elastic, lam, device->prestretch[1], &stress));
    double p1 = stress.w1, p11 = stress.w11;
    for (int b = 0; b < material->branch_count; b++) {
        DEA_TRY(dea_branch_respond(&material->branches[b], device->prestretch, lam, task->states + 2 * b,
                                   task->with_derivatives, &task->branches[b]));
        p1 += task->branches[b].p1;
        p11 += task->branches[b].dp1_dlam1;
    }
    out->p1 = p1;
    out->g = volume * p1;
    out->g_lam = volume * p11;
    out->soft = out->g_lam;
    out->g_e = 0.0;
    out->c = out->c1 = out->v = 0.0;
    if (task->control == DEA_CONTROL_PASSIVE)
        return DEA_OK;

    /* Maxwell part */
    double c1, c2, c = dea_zone_capacitance(device, task->zone, lam, &c1, &c2);
    if (!(c > 0.0))
        return DEA_RECOVERABLE;
    double per_c = 1.0 / c, v = task->control == DEA_CONTROL_CHARGE ? task->e * per_c : task->e;
    out->g -= 0.5 * v * v * c1;
    out->soft -= 0.5 * v * v * c2;
    if (task->control == DEA_CONTROL_CHARGE) { /* stiffer by (dQ/dlam)^2 / C */
        out->g_e = -v * c1 * per_c;
        out->g_lam = out->soft - v * c1 * out->g_e;
    } else {
        out->g_e = -v * c1;
        out->g_lam = out->soft;
    }
    out->c = c;
    out->c1 = c1;
    out->v = v;
    return DEA_OK;
}

/* Smallest stretch above `taut` with G = 0, given G(taut) < 0: bracket upwards, then Newton kept inside the bracket. */
static enum dea_status find_natural_stretch(const struct film_task *task, double taut,
                                            const struct slope_of_energy *at_taut, double *natural,
                                            struct slope_of_energy *at_natural) {
    double low = taut, high = taut, stride = fmax(1e-3 * taut, -1.2 * at_taut->g / fabs(at_taut->g_lam));
    stride = fmin(stride, 0.05 * taut);
    struct slope_of_energy probe;
    for (int i = 0;; i++) {
        enum dea_status status = slope_energy(task, low + stride, &probe);
        if (status != DEA_OK) { /* beyond the law's limit, where G grows without bound */
            stride *= 0.5;
        } else if (probe.g >= 0.0) {
            high = low + stride;
            break;
        } else {
            low += stride;
            stride *= 1.3;
        }
        if (i == MAX_SLACK_ITERATIONS)
            return DEA_RECOVERABLE; /* pull-in without end: no natural stretch */
    }
    double lam = high;
    *at_natural = probe;
    for (int i = 0; i < MAX_SLACK_ITERATIONS; i++) {
        double step = -at_natural->g / at_natural->g_lam, next = lam + step;
        if (!(next > low && next < high) || !isfinite(step))
            next = 0.5 * (low + high);
        bool converged = fabs(next - lam) <= 2e-16 * lam;
        lam = next;
        DEA_TRY(slope_energy(task, lam, at_natural));
        if (converged || at_natural->g == 0.0)
            break;
        if (at_natural->g > 0.0)
            high = lam;
        else
            low = lam;
    }
    *natural = lam;
    return at_natural->g_lam > 0.0 ? DEA_OK : DEA_RECOVERABLE;
}

/* A film squeezed past the law's limit is slack, for the net stress falls without bound on the way there. Finds a
 * stretch between the geometric one and the spring at rest where the law holds and the film is still pushed, G < 0. */
static enum dea_status enter_domain(const struct film_task *task, double taut, double *pushed,
                                    struct slope_of_energy *at_pushed) {
    double low = taut, high = 1.0 / sqrt(task->device->prestretch[1]); /* W1 = 0 */
    *pushed = high;
    for (int i = 0; i < MAX_SLACK_ITERATIONS && low < high; i++) {
        bool inside = slope_energy(task, *pushed, at_pushed) == DEA_OK;
        if (inside && at_pushed->g < 0.0)
            return DEA_OK;
        if (inside)
            high = *pushed;
        else
            low = *pushed;
        *pushed = 0.5 * (low + high);
    }
    return DEA_RECOVERABLE;
}

enum dea_status dea_film_respond(const struct dea_device *device, int zone, enum dea_control control, double x,
                                 double e, const double *states, bool with_derivatives,
                                 struct dea_branch_response *branches, struct dea_film *film) {
    const struct dea_zone *geometry = &device->zones[zone];
    struct film_task task = {device, zone, control, e, states, branches, with_derivatives};
    double per_length = device->prestretch[0] / geometry->length, taut = dea_zone_stretch(device, zone, x);
    if (!(taut > 0.0))
        return DEA_RECOVERABLE;
    struct slope_of_energy s;
    double pushed = taut;
    if (slope_energy(&task, taut, &s) != DEA_OK) {
        if (!device->slack)
            return DEA_RECOVERABLE;
        DEA_TRY(enter_domain(&task, taut, &pushed, &s));
    }
    film->lam = taut;
    film->margin = s.g / geometry->volume;
    film->slack = device->slack && s.g < 0.0;
    if (film->slack) {
        struct slope_of_energy pushed_slope = s;
        DEA_TRY(find_natural_stretch(&task, pushed, &pushed_slope, &film->lam, &s));
    }
    film->p1 = s.p1;
    film->pull = film->slack ? 0.0 : s.g * per_length;
    film->stiffness = film->slack ? 0.0 : s.soft * per_length * per_length;
    film->capacitance = s.c;
    film->voltage = s.v;
    film->charge = control == DEA_CONTROL_CHARGE ? e : s.c * s.v;
    film->dlam_dx = film->slack ? 0.0 : geometry->side * per_length;
    if (!with_derivatives)
        return DEA_OK;

    /* taut: lam follows x. slack: lam follows the electrical and branch state through G = 0 */
    film->dlam_de = film->slack ? -s.g_e / s.g_lam : 0.0;
    film->dlam_dp1 = film->slack ? -geometry->volume / s.g_lam : 0.0;
    film->dpull_dx = film->slack ? 0.0 : s.g_lam * per_length * film->dlam_dx;
    film->dpull_de = film->slack ? 0.0 : s.g_e * per_length;
    film->dpull_dp1 = film->slack ? 0.0 : geometry->volume * per_length;
    bool charge_given = control == DEA_CONTROL_CHARGE, voltage_given = control == DEA_CONTROL_VOLTAGE;
    film->dvoltage_dlam = charge_given ? -film->voltage * s.c1 / s.c : 0.0;
    film->dvoltage_de = charge_given ? 1.0 / s.c : voltage_given ? 1.0 : 0.0;
    film->dcharge_dlam = voltage_given ? s.c1 * e : 0.0;
    film->dcharge_de = voltage_given ? s.c : charge_given ? 1.0 : 0.0;
    return DEA_OK;
}

enum dea_status dea_film_energy(const struct dea_device *device, int zone, double lam, double charge,
                                const double *states, double *energy) {
    const struct dea_material *material = &device->material;
    double sum, part;
    DEA_TRY(dea_law_energy(&material->elastic, lam, device->prestretch[1], &sum));
    for (int b = 0; b < material->branch_count; b++) {
        DEA_TRY(dea_branch_energy(&material->branches[b], device->prestretch, lam, states + 2 * b, &part));
        sum += part;
    }
    *energy = device->zones[zone].volume * sum;
    if (charge != 0.0)
        *energy += 0.5 * charge * charge / dea_zone_capacitance(device, zone, lam, NULL, NULL);
    return DEA_OK;
}

enum dea_status dea_film_stress2(const struct dea_device *device, int zone, double lam, double voltage,
                                 const struct dea_branch_response *branches, double *stress2) {
    const struct dea_material *material = &device->material;
    struct dea_stress stress;
    DEA_TRY(dea_law_stress(&material->elastic, lam, device->prestretch[1], &stress));
    *stress2 = device->prestretch[1] * stress.w2;
    for (int b = 0; b < material->branch_count; b++)
        *stress2 += branches[b].s2;
    if (device->zones[zone].electroded) {
        double field = dea_zone_field(device, voltage, lam);
        double permittivity = material->dielectric.permittivity + material->dielectric.permittivity_slope * lam;
        *stress2 -= DEA_VACUUM_PERMITTIVITY * permittivity * field * field;
    }
    return DEA_OK;
}
