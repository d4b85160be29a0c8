/* The equations of motion once more, in long double, one function per formula of the model. Modes (slack, contact,
 * limits) are frozen over a step and switched where their function crosses zero, so that every step is smooth. */
#include "independent.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef long double real;

enum {
    MAX_BRANCHES = 40,
    MAX_STATES = 2 + DEA_ZONES * (2 * MAX_BRANCHES + 2) + 3,
    COLUMNS = 8,
    MAX_CORNERS = 20000,
    SWITCHES = 4 * DEA_ZONES + 2, /* slack, current limit, slew, breakdown of each zone; two stops */
};
enum { SWITCH_SLACK, SWITCH_CURRENT, SWITCH_SLEW, SWITCH_BREAKDOWN, ZONE_SWITCHES };

struct model {
    const struct dea_scene *scene;
    const struct dea_device *device;
    real middle; /* inside the present smooth piece of all waveforms */
    int count;   /* states, the three energy integrals last */
    int v, branch[DEA_ZONES], amplifier[DEA_ZONES], charge[DEA_ZONES];
    int mode[SWITCHES]; /* slack: 0 or 1; current and slew: -1, 0, 1; stops: 0 or 1; breakdown: 0 or 1 */
    real largest[MAX_STATES];
    real x_guess; /* of a massless platform */
    bool failed;
    struct independent_trace *trace;
    /* of the last evaluation */
    real lam[DEA_ZONES], volts[DEA_ZONES], port_volts[DEA_ZONES], velocity;
    real guard[SWITCHES]; /* functions whose zeros switch modes */
};

static const real vacuum = 8.8541878128e-12L;

/* ---- waveforms ---- */

/* Value of a waveform at t on the smooth piece that holds `middle`. */
static real drive(const struct dea_waveform *w, real middle, real t, real *rate) {
    real pi2 = 2.0L * acosl(-1.0L);
    *rate = 0.0L;
    if (w->kind == DEA_WAVE_DC)
        return w->level;
    if (w->kind == DEA_WAVE_SINE || w->kind == DEA_WAVE_CHIRP) {
        if (middle < w->delay)
            return w->offset + w->amplitude * sinl(w->phase);
        real tau = t - w->delay, angle = w->phase + pi2 * w->frequency * tau, omega = pi2 * w->frequency;
        real envelope = w->amplitude;
        if (w->kind == DEA_WAVE_CHIRP) {
            real sweep = pi2 * ((real)w->frequency_end - w->frequency) / w->duration, swept = fminl(tau, w->duration);
            if (middle - w->delay > w->duration)
                swept = w->duration;
            else
                swept = tau;
            angle = w->phase + pi2 * w->frequency * swept + 0.5L * sweep * swept * swept;
            omega = pi2 * w->frequency + sweep * swept;
            angle += (tau - swept) * omega;
        } else if (w->decay != 0.0) {
            envelope *= expl(-w->decay * tau);
            *rate = -w->decay * envelope * sinl(angle);
        }
        *rate += envelope * omega * cosl(angle);
        return w->offset + envelope * sinl(angle);
    }
    if (w->kind == DEA_WAVE_PWL) {
        size_t n = w->point_count;
        real base = 0.0L;
        if (w->repeat && middle > w->times[n - 1])
            base = floorl((middle - w->times[0]) / ((real)w->times[n - 1] - w->times[0])) *
                   ((real)w->times[n - 1] - w->times[0]);
        if (middle - base < w->times[0])
            return w->values[0];
        for (size_t i = 0; i + 1 < n; i++)
            if (middle - base < w->times[i + 1]) {
                *rate = ((real)w->values[i + 1] - w->values[i]) / ((real)w->times[i + 1] - w->times[i]);
                return w->values[i] + *rate * (t - base - w->times[i]);
            }
        return w->values[n - 1];
    }
    /* pulse and trapezoid */
    real period = w->kind == DEA_WAVE_PULSE ? (real)w->period
                  : w->repeat               ? (real)w->rise + w->width + w->fall + w->gap
                                            : 0.0L;
    if (middle < w->delay)
        return w->low;
    real base = w->delay;
    if (period > 0.0L)
        base += floorl((middle - w->delay) / period) * period;
    real into = middle - base, tau = t - base, swing = (real)w->high - w->low;
    if (into < w->rise) {
        *rate = swing / w->rise;
        return w->low + *rate * tau;
    }
    if (into < (real)w->rise + w->width)
        return w->high;
    if (into < (real)w->rise + w->width + w->fall) {
        *rate = -swing / w->fall;
        return w->high + *rate * (tau - w->rise - w->width);
    }
    return w->low;
}

static int compare_times(const void *a, const void *b) {
    real d = *(const real *)a - *(const real *)b;
    return d < 0.0L ? -1 : d > 0.0L;
}

static size_t list_corners(const struct dea_waveform *w, real stop, real *corners, size_t count) {
    real local[8];
    int n = 0;
    real period = 0.0L, first = w->delay;
    if (w->kind == DEA_WAVE_SINE || w->kind == DEA_WAVE_CHIRP) {
        local[n++] = 0.0L;
        if (w->kind == DEA_WAVE_CHIRP)
            local[n++] = w->duration;
    } else if (w->kind == DEA_WAVE_PWL) {
        real span = w->repeat ? (real)w->times[w->point_count - 1] - w->times[0] : 0.0L;
        for (real base = 0.0L; base < stop && count < MAX_CORNERS; base += span) {
            for (size_t i = 0; i < w->point_count && count < MAX_CORNERS; i++)
                corners[count++] = base + w->times[i];
            if (span <= 0.0L)
                break;
        }
        return count;
    } else if (w->kind != DEA_WAVE_DC) {
        local[n++] = 0.0L;
        local[n++] = w->rise;
        local[n++] = (real)w->rise + w->width;
        local[n++] = (real)w->rise + w->width + w->fall;
        period = w->kind == DEA_WAVE_PULSE ? (real)w->period
                 : w->repeat               ? (real)w->rise + w->width + w->fall + w->gap
                                           : 0.0L;
    }
    for (real base = first; base < stop && n > 0; base += period) {
        for (int i = 0; i < n && count < MAX_CORNERS; i++)
            if (base + local[i] < stop)
                corners[count++] = base + local[i];
        if (period <= 0.0L || count >= MAX_CORNERS)
            break;
    }
    return count;
}

/* ---- material ---- */

/* Newton from below on coth b - 1/b = y, concave in b: it cannot overshoot. */
static real inverse_langevin(real y) {
    real b = 3.0L * y;
    for (int i = 0; i < 100; i++) {
        real b2 = b * b, value, slope;
        if (b > 0.2L) {
            real s = 1.0L / sinhl(b);
            value = 1.0L / tanhl(b) - 1.0L / b;
            slope = 1.0L / b2 - s * s;
        } else { /* terms of the Taylor series up to b^13 */
            static const real c[7] = {1.0L / 3,     -1.0L / 45,           2.0L / 945,     -1.0L / 4725,
                                      2.0L / 93555, -1382.0L / 638512875, 4.0L / 18243225};
            value = slope = 0.0L;
            for (int k = 6; k >= 0; k--) {
                value = value * b2 + c[k];
                slope = slope * b2 + (2 * k + 1) * c[k];
            }
            value *= b;
        }
        real step = (y - value) / slope;
        b += step;
        if (fabsl(step) < 1e-18L * b)
            break;
    }
    return b;
}

/* dW/dlam1 at constant lam2, and W itself. */
static real spring(const struct dea_law *law, real l1, real l2, real *energy) {
    real l3 = 1.0L / (l1 * l2), i1 = l1 * l1 + l2 * l2 + l3 * l3, di1 = 2.0L * (l1 - l3 * l3 / l1), by_i1 = 0.0L;
    *energy = 0.0L;
    if (law->kind == DEA_GENT) {
        *energy = -0.5L * law->mu * law->jm * logl(1.0L - (i1 - 3.0L) / law->jm);
        by_i1 = 0.5L * law->mu * law->jm / (law->jm + 3.0L - i1);
    } else if (law->kind == DEA_NEO_HOOKEAN) {
        *energy = 0.5L * law->mu * (i1 - 3.0L);
        by_i1 = 0.5L * law->mu;
    } else if (law->kind == DEA_YEOH) {
        for (int i = 0; i < law->yeoh_terms; i++) {
            *energy += law->yeoh[i] * powl(i1 - 3.0L, i + 1);
            by_i1 += (i + 1) * law->yeoh[i] * powl(i1 - 3.0L, i);
        }
    } else if (law->kind == DEA_OGDEN) {
        real w1 = 0.0L;
        for (int i = 0; i < law->ogden_terms; i++) {
            real a = law->ogden_alpha[i], m = law->ogden_mu[i];
            *energy += m / a * (powl(l1, a) + powl(l2, a) + powl(l3, a) - 3.0L);
            w1 += m * (powl(l1, a - 1.0L) - powl(l3, a) / l1);
        }
        return w1;
    } else {
        real lock = law->locking_stretch, y = sqrtl(i1 / 3.0L) / lock, b = inverse_langevin(y);
        real y0 = 1.0L / lock, b0 = inverse_langevin(y0);
        *energy = law->mu * lock * lock * (y * b + logl(b / sinhl(b)) - y0 * b0 - logl(b0 / sinhl(b0)));
        by_i1 = law->mu * lock * b / (6.0L * sqrtl(i1 / 3.0L));
    }
    return by_i1 * di1;
}

/* True stress s1 of a branch at (lam1, lam2), rates of its states, dissipation and energy per volume. */
static real branch_stress(const struct dea_branch *branch, real l1, real l2, const real *z, real *rate, real *loss,
                          real *energy) {
    if (branch->kind == DEA_BRANCH_FOO) {
        real e1 = l1 / z[0], e2 = l2 / z[1], e3 = 1.0L / (e1 * e2), excess = e1 * e1 + e2 * e2 + e3 * e3 - 3.0L;
        bool gent = !isinf(branch->jm);
        real softness = gent ? 1.0L - excess / branch->jm : 1.0L;
        real s1 = branch->mu * (e1 * e1 - e3 * e3) / softness, s2 = branch->mu * (e2 * e2 - e3 * e3) / softness;
        real eta = (real)branch->mu * branch->tau;
        rate[0] = z[0] * (s1 - 0.5L * s2) / (3.0L * eta);
        rate[1] = z[1] * (s2 - 0.5L * s1) / (3.0L * eta);
        *loss = (s1 * s1 - s1 * s2 + s2 * s2) / (3.0L * eta);
        *energy = gent ? -0.5L * branch->mu * branch->jm * logl(softness) : 0.5L * branch->mu * excess;
        return s1;
    }
    real a2 = 1.0L / (l2 * l2), p = l1 * l1 * z[0], q = z[1] / (l1 * l1 * l2 * l2);
    rate[0] = (1.0L / (l1 * l1) - z[0]) / branch->tau;
    rate[1] = (l1 * l1 * l2 * l2 - z[1]) / branch->tau;
    *loss = branch->mu / (2.0L * branch->tau) * (p + q + 1.0L / p + 1.0L / q - 4.0L);
    *energy = 0.5L * branch->mu * (p + 1.0L + q - 3.0L - logl(z[0] * z[1] * a2));
    return branch->mu * (p - q);
}

/* ---- a zone ---- */

struct film {
    real lam, volts, charge, capacitance, net; /* net: nominal P1 minus Maxwell, Pa */
    real pull, branch_rate[2 * MAX_BRANCHES], loss, energy;
};

/* Everything at a given stretch; `given` is V or Q. */
static void at_stretch(const struct model *m, int k, real lam, real given, bool by_charge, const real *z,
                       struct film *film) {
    const struct dea_device *d = m->device;
    const struct dea_material *material = &d->material;
    const struct dea_zone *zone = &d->zones[k];
    real l2 = d->prestretch[1], energy, volume = (real)d->width * zone->length * d->thickness;
    film->lam = lam;
    real p1 = spring(&material->elastic, lam, l2, &energy);
    film->loss = 0.0L;
    for (int b = 0; z != NULL && b < material->branch_count; b++) {
        real loss, stored;
        real s1 = branch_stress(&material->branches[b], lam, l2, z + 2 * b, film->branch_rate + 2 * b, &loss, &stored);
        p1 += s1 / lam;
        film->loss += loss * volume;
        energy += stored;
    }
    film->energy = energy * volume;
    film->net = p1;
    film->volts = film->charge = film->capacitance = 0.0L;
    if (zone->electroded) {
        /* C = eps w l^2 / (l0 t0), l = l0 lam / lp1 */
        real l = zone->length * lam / d->prestretch[0];
        real a = material->dielectric.permittivity, b = material->dielectric.permittivity_slope;
        real geometry = vacuum * d->width / (zone->length * (real)d->thickness);
        real c = geometry * (a + b * lam) * l * l;
        real dc_dl = geometry * (2.0L * (a + b * lam) * l + b * d->prestretch[0] / zone->length * l * l);
        film->capacitance = c;
        film->volts = by_charge ? given / c : given;
        film->charge = by_charge ? given : given * c;
        film->energy += 0.5L * c * film->volts * film->volts;
        film->net -= 0.5L * film->volts * film->volts * dc_dl / (d->width * (real)d->thickness * d->prestretch[0]);
    }
    film->pull = d->width * (real)d->thickness * d->prestretch[0] * film->net;
}

/* The film at the platform's position, at its natural stretch when `slack`. */
static bool film_at(const struct model *m, int k, real x, real given, bool by_charge, const real *z, bool slack,
                    struct film *film, real *taut_net) {
    const struct dea_device *d = m->device;
    real side = k == 0 ? 1.0L : -1.0L;
    real lam = d->prestretch[0] * (d->zones[k].length + side * x) / d->zones[k].length;
    at_stretch(m, k, lam, given, by_charge, z, film);
    *taut_net = film->net;
    if (!slack)
        return isfinite(film->net);
    real low = lam, high = lam, step = 1e-4L * lam;
    if (film->net < 0.0L) {
        for (int i = 0;; i++, step *= 1.5L) {
            at_stretch(m, k, high + step, given, by_charge, z, film);
            if (!(film->net < 0.0L))
                break;
            high += step;
            if (i > 60)
                return false;
        }
        low = high;
        high += step;
    } else { /* just past the kink */
        for (int i = 0;; i++, step *= 1.5L) {
            at_stretch(m, k, low - step, given, by_charge, z, film);
            if (film->net < 0.0L)
                break;
            low -= step;
            if (i > 60)
                return false;
        }
        high = low;
        low -= step;
    }
    for (int i = 0; i < 80; i++) {
        real mid = 0.5L * (low + high);
        at_stretch(m, k, mid, given, by_charge, z, film);
        if (film->net < 0.0L)
            low = mid;
        else
            high = mid;
    }
    film->pull = 0.0L;
    return true;
}

static real electrode_resistance(const struct dea_device *d, int k, real lam) {
    const struct dea_zone *zone = &d->zones[k];
    real l = zone->length * lam / d->prestretch[0], w = d->width;
    real squares = zone->feed == DEA_FEED_LONG_EDGE ? l / w : w / l;
    return zone->electrode_resistance + 2.0L * zone->sheet_resistance * squares / 3.0L;
}

static real leakage(const struct dea_device *d, int k, const struct film *film) {
    const struct dea_dielectric *dielectric = &d->material.dielectric;
    real l = d->zones[k].length * film->lam / d->prestretch[0], t = d->thickness * (real)d->prestretch[0] / film->lam;
    real field = film->volts / t;
    return dielectric->conductivity * expl(fabsl(field) / dielectric->conductivity_field) * field * d->width * l;
}

static bool is_source(const struct model *m, int k) {
    const struct dea_zone *zone = &m->device->zones[k];
    const struct dea_source *source = &m->scene->sources[k];
    return zone->present && zone->electroded && source->present &&
           (source->amplified || source->resistance > 0.0 || zone->electrode_resistance > 0.0 ||
            zone->sheet_resistance > 0.0);
}

static real outer_resistance(const struct model *m, int k) {
    const struct dea_source *source = &m->scene->sources[k];
    return source->resistance + (source->amplified ? (real)source->amplifier.output_resistance : 0.0L);
}

static real command(const struct model *m, int k, real t, real *rate) {
    *rate = 0.0L;
    return m->scene->sources[k].present ? drive(&m->scene->sources[k].waveform, m->middle, t, rate) : 0.0L;
}

static real load_at(const struct model *m, real t, real *rate) {
    *rate = 0.0L;
    return m->scene->has_load_waveform ? drive(&m->scene->load, m->middle, t, rate) : 0.0L;
}

/* ---- the equations ---- */

static real stop_force(const struct model *m, real x, real velocity, real *loss, real *stored) {
    const struct dea_device *d = m->device;
    real force = 0.0L, k = d->stop_stiffness;
    *loss = *stored = 0.0L;
    for (int s = 0; s < 2 && d->has_stops; s++) {
        if (!m->mode[ZONE_SWITCHES * DEA_ZONES + s])
            continue;
        real side = s == 0 ? -1.0L : 1.0L, depth = side * (x - d->stops[s]), rate = side * velocity;
        force -= side * k * depth * (1.0L + d->stop_loss * rate);
        *loss += k * depth * d->stop_loss * rate * rate;
        *stored += 0.5L * k * depth * depth;
    }
    return force;
}

struct films {
    struct film zone[DEA_ZONES];
    real taut_net[DEA_ZONES];
};

/* Force on the platform except damping and stops. */
static bool membrane_force(const struct model *m, real t, real x, const real *y, struct films *films, real *force) {
    real rate;
    *force = m->device->load + load_at(m, t, &rate);
    for (int k = 0; k < DEA_ZONES; k++) {
        if (!m->device->zones[k].present)
            continue;
        bool source = is_source(m, k);
        real given = source ? y[m->charge[k]] : command(m, k, t, &rate);
        const real *z = m->device->material.branch_count > 0 ? y + m->branch[k] : NULL;
        bool slack = m->device->slack && m->mode[ZONE_SWITCHES * k + SWITCH_SLACK] != 0;
        if (!film_at(m, k, x, given, source, z, slack, &films->zone[k], &films->taut_net[k]))
            return false;
        *force -= (k == 0 ? 1.0L : -1.0L) * films->zone[k].pull;
    }
    return true;
}

/* Position of a platform without mass and damping. */
static bool balance(struct model *m, real t, const real *y, struct films *films, real *x) {
    real f0, f1, loss, stored, x0 = m->x_guess, x1, h = 1e-9L;
    for (int i = 0; i < 60; i++) {
        if (!membrane_force(m, t, x0, y, films, &f0))
            return false;
        f0 += stop_force(m, x0, 0.0L, &loss, &stored);
        x1 = x0 + h;
        if (!membrane_force(m, t, x1, y, films, &f1))
            return false;
        f1 += stop_force(m, x1, 0.0L, &loss, &stored);
        real step = -f0 * h / (f1 - f0);
        if (!isfinite(step))
            return false;
        x0 += fmaxl(-1e-4L, fminl(1e-4L, step));
        if (fabsl(step) < 1e-20L) {
            *x = m->x_guess = x0;
            return membrane_force(m, t, x0, y, films, &f0);
        }
        h = fmaxl(fminl(h, fabsl(step)), 1e-12L);
    }
    *x = m->x_guess = x0; /* at rounding */
    return membrane_force(m, t, x0, y, films, &f0);
}

static real effective_mass(const struct dea_device *d) {
    real mass = d->platform_mass;
    for (int k = 0; k < DEA_ZONES; k++)
        if (d->membrane_mass && d->zones[k].present)
            mass += d->material.density * d->width * (real)d->zones[k].length * d->thickness / 3.0L;
    return mass;
}

static bool derivatives(struct model *m, real t, const real *y, real *rates) {
    const struct dea_device *d = m->device;
    struct films films;
    real x = y[0], force, contact_loss, stored, mass = effective_mass(d), rate;
    memset(rates, 0, (size_t)m->count * sizeof *rates);
    if (mass == 0.0L && d->damping == 0.0) {
        if (!balance(m, t, y, &films, &x))
            return false;
        m->velocity = 0.0L;
        stop_force(m, x, 0.0L, &contact_loss, &stored);
    } else {
        if (!membrane_force(m, t, x, y, &films, &force))
            return false;
        if (mass > 0.0L) {
            m->velocity = y[m->v];
            force += stop_force(m, x, m->velocity, &contact_loss, &stored);
            rates[m->v] = (force - d->damping * m->velocity) / mass;
        } else { /* the contact's rate term joins the damping */
            real still = stop_force(m, x, 0.0L, &contact_loss, &stored);
            real by_v = stop_force(m, x, 1.0L, &contact_loss, &stored) - still;
            m->velocity = (force + still) / (d->damping - by_v);
            stop_force(m, x, m->velocity, &contact_loss, &stored);
        }
        rates[0] = m->velocity;
    }
    real *energy = rates + m->count - 3; /* work, branch loss, all losses */
    energy[0] = (d->load + load_at(m, t, &rate)) * m->velocity;
    energy[2] = d->damping * m->velocity * m->velocity + contact_loss;
    for (int k = 0; k < DEA_ZONES; k++) {
        if (!d->zones[k].present)
            continue;
        const struct film *film = &films.zone[k];
        m->lam[k] = film->lam;
        m->volts[k] = m->port_volts[k] = film->volts;
        int *mode = m->mode + ZONE_SWITCHES * k;
        real *guard = m->guard + ZONE_SWITCHES * k;
        guard[SWITCH_SLACK] = films.taut_net[k];
        for (int i = 0; i < 2 * d->material.branch_count; i++)
            rates[m->branch[k] + i] = film->branch_rate[i];
        energy[1] += film->loss;
        energy[2] += film->loss;
        if (!d->zones[k].electroded)
            continue;
        real field = film->volts * film->lam / (d->thickness * (real)d->prestretch[0]);
        const struct dea_dielectric *dielectric = &d->material.dielectric;
        real strength = dielectric->breakdown;
        if (dielectric->breakdown_thickness_exponent != 0.0)
            strength *= powl(d->thickness * (real)d->prestretch[0] / film->lam / dielectric->breakdown_reference,
                             -dielectric->breakdown_thickness_exponent);
        strength *= powl(sqrtl(film->lam * d->prestretch[1]), dielectric->breakdown_stretch_exponent);
        guard[SWITCH_BREAKDOWN] = strength - fabsl(field);
        real leak = dielectric->conductivity > 0.0 ? leakage(d, k, film) : 0.0L;
        if (!is_source(m, k)) { /* the source's work V dQ/dt: by its own rate of charge, from neighbouring states */
            energy[2] += film->volts * leak;
            energy[0] += film->volts * leak;
            continue;
        }
        /* amplifier: slew limit and pole on the command, current limit on the output */
        const struct dea_source *source = &m->scene->sources[k];
        real emf = command(m, k, t, &rate), limit = INFINITY;
        if (source->amplified) {
            const struct dea_amplifier *a = &source->amplifier;
            limit = a->current_limit;
            if (m->amplifier[k] >= 0) {
                real wanted =
                    isinf(a->bandwidth) ? rate : 2.0L * acosl(-1.0L) * a->bandwidth * (emf - y[m->amplifier[k]]);
                int slewing = mode[SWITCH_SLEW];
                rates[m->amplifier[k]] = slewing ? slewing * (real)a->slew_rate : wanted;
                /* positive while the mode holds */
                if (!isinf(a->bandwidth))
                    guard[SWITCH_SLEW] = slewing ? slewing * wanted - a->slew_rate : a->slew_rate - fabsl(wanted);
                else
                    guard[SWITCH_SLEW] = slewing ? slewing * (emf - y[m->amplifier[k]]) : a->slew_rate - fabsl(rate);
                emf = y[m->amplifier[k]];
            }
        }
        real film_side = electrode_resistance(d, k, film->lam), total = film_side + outer_resistance(m, k);
        real current = (emf - film->volts) / total;
        if (!isinf((double)limit)) {
            int limited = mode[SWITCH_CURRENT];
            guard[SWITCH_CURRENT] = limited ? limited * current - limit : limit - fabsl(current);
            if (limited)
                current = limited * limit;
        }
        rates[m->charge[k]] = current - leak;
        m->port_volts[k] = film->volts + current * film_side;
        energy[0] += emf * current;
        energy[2] += (emf - film->volts) * current + film->volts * leak;
    }
    if (d->has_stops) {
        m->guard[ZONE_SWITCHES * DEA_ZONES] = x - d->stops[0];
        m->guard[ZONE_SWITCHES * DEA_ZONES + 1] = d->stops[1] - x;
    }
    if (mass == 0.0L && d->damping == 0.0)
        m->x_guess = x;
    return true;
}

/* Energy stored in films, platform and stops. */
static real stored_energy(struct model *m, real t, const real *y) {
    struct films films;
    const struct dea_device *d = m->device;
    real x = y[0], force, loss, stored;
    if (effective_mass(d) == 0.0L && d->damping == 0.0 && !balance(m, t, y, &films, &x))
        return NAN;
    if (!membrane_force(m, t, x, y, &films, &force))
        return NAN;
    stop_force(m, x, 0.0L, &loss, &stored);
    real sum = stored;
    if (m->v >= 0)
        sum += 0.5L * effective_mass(d) * y[m->v] * y[m->v];
    for (int k = 0; k < DEA_ZONES; k++)
        if (d->zones[k].present)
            sum += films.zone[k].energy;
    return sum;
}

/* ---- start ---- */

static real rest_volts(struct model *m, int k, real lam, real emf) {
    if (m->device->material.dielectric.conductivity <= 0.0)
        return emf;
    real low = fminl(0.0L, emf), high = fmaxl(0.0L, emf);
    real total = electrode_resistance(m->device, k, lam) + outer_resistance(m, k);
    for (int i = 0; i < 90; i++) {
        struct film film = {.lam = lam, .volts = 0.5L * (low + high)};
        real current = (emf - film.volts) / total;
        if (m->scene->sources[k].amplified)
            current = fmaxl(-m->scene->sources[k].amplifier.current_limit,
                            fminl(m->scene->sources[k].amplifier.current_limit, current));
        if (current > leakage(m->device, k, &film))
            low = film.volts;
        else
            high = film.volts;
    }
    return 0.5L * (low + high);
}

/* Static force with relaxed or fresh branches; decides slack by itself. Leakage is taken at the taut stretch: scenes
 * that start slack and leaky are not covered. */
static bool rest_force(struct model *m, real x, const real *y, struct films *films, real *force) {
    const struct dea_device *d = m->device;
    real rate, loss, stored;
    bool fresh = m->scene->start == DEA_START_FRESH;
    *force = d->load + load_at(m, 0.0L, &rate);
    for (int k = 0; k < DEA_ZONES; k++) {
        if (!d->zones[k].present)
            continue;
        real lam = d->prestretch[0] * (1.0L + (k == 0 ? x : -x) / d->zones[k].length);
        real volts = d->zones[k].electroded ? command(m, k, 0.0L, &rate) : 0.0L;
        if (is_source(m, k))
            volts = rest_volts(m, k, lam, volts);
        const real *z = fresh && d->material.branch_count > 0 ? y + m->branch[k] : NULL;
        film_at(m, k, x, volts, false, z, false, &films->zone[k], &films->taut_net[k]);
        m->mode[ZONE_SWITCHES * k + SWITCH_SLACK] = d->slack && films->taut_net[k] < 0.0L;
        if (m->mode[ZONE_SWITCHES * k + SWITCH_SLACK] &&
            !film_at(m, k, x, volts, false, z, true, &films->zone[k], &films->taut_net[k]))
            return false;
        *force -= (k == 0 ? 1.0L : -1.0L) * films->zone[k].pull;
    }
    for (int s = 0; s < 2 && d->has_stops; s++)
        m->mode[ZONE_SWITCHES * DEA_ZONES + s] = s == 0 ? x < d->stops[0] : x > d->stops[1];
    *force += stop_force(m, x, 0.0L, &loss, &stored);
    return true;
}

static bool start(struct model *m, real *y) {
    const struct dea_device *d = m->device;
    struct films films;
    real force, first, x = 0.0L, rate;
    m->middle = -1.0L;
    memset(y, 0, MAX_STATES * sizeof *y);
    for (int k = 0; k < DEA_ZONES; k++)
        for (int b = 0; b < d->material.branch_count; b++)
            y[m->branch[k] + 2 * b] = y[m->branch[k] + 2 * b + 1] = 1.0L; /* fresh: xi = 1, a = 1 */
    if (m->scene->has_initial_x) {
        x = m->scene->initial_x;
    } else {
        if (!rest_force(m, x, y, &films, &first))
            return false;
        real step = (first > 0.0L ? 1.0L : -1.0L) * 1e-6L, other = x;
        for (int i = 0; first != 0.0L; i++, step *= 1.3L) {
            other = x + step;
            if (!rest_force(m, other, y, &films, &force) || i > 100)
                return false;
            if ((force > 0.0L) != (first > 0.0L))
                break;
            x = other;
        }
        for (int i = 0; i < 120 && first != 0.0L; i++) {
            real mid = 0.5L * (x + other);
            rest_force(m, mid, y, &films, &force);
            if ((force > 0.0L) == (first > 0.0L))
                x = mid;
            else
                other = mid;
        }
    }
    if (!rest_force(m, x, y, &films, &force))
        return false;
    y[0] = m->x_guess = x;
    if (m->v >= 0)
        y[m->v] = m->scene->has_initial_v ? (real)m->scene->initial_v : 0.0L;
    for (int k = 0; k < DEA_ZONES; k++) {
        if (!d->zones[k].present)
            continue;
        real lam = films.zone[k].lam, l2 = d->prestretch[1];
        for (int b = 0; b < d->material.branch_count && m->scene->start == DEA_START_EQUILIBRIUM; b++) {
            bool foo = d->material.branches[b].kind == DEA_BRANCH_FOO;
            y[m->branch[k] + 2 * b] = foo ? lam : 1.0L / (lam * lam);
            y[m->branch[k] + 2 * b + 1] = foo ? l2 : lam * lam * l2 * l2;
        }
        if (m->amplifier[k] >= 0)
            y[m->amplifier[k]] = command(m, k, 0.0L, &rate);
        if (m->charge[k] >= 0)
            y[m->charge[k]] = films.zone[k].charge;
    }
    return true;
}

static void lay_out(struct model *m) {
    const struct dea_device *d = m->device;
    int n = 1;
    m->v = effective_mass(d) > 0.0L ? n++ : -1;
    for (int k = 0; k < DEA_ZONES; k++) {
        m->branch[k] = n;
        n += 2 * d->material.branch_count;
        const struct dea_amplifier *a = &m->scene->sources[k].amplifier;
        m->amplifier[k] =
            is_source(m, k) && m->scene->sources[k].amplified && !(isinf(a->bandwidth) && isinf(a->slew_rate)) ? n++
                                                                                                               : -1;
        m->charge[k] = is_source(m, k) ? n++ : -1;
    }
    m->count = n + 3;
}

/* ---- integrator: Gragg's midpoint rule, extrapolated (Bulirsch and Stoer) ---- */

static bool try_step(struct model *m, real t, const real *y, real step, real *result, real *error) {
    static const int divisions[COLUMNS] = {2, 4, 6, 8, 10, 12, 14, 16};
    real table[COLUMNS][MAX_STATES], rates[MAX_STATES], start_rates[MAX_STATES];
    int n = m->count;
    if (!derivatives(m, t, y, start_rates))
        return false;
    for (int j = 0; j < COLUMNS; j++) {
        real h = step / divisions[j], before[MAX_STATES], now[MAX_STATES];
        for (int i = 0; i < n; i++) {
            before[i] = y[i];
            now[i] = y[i] + h * start_rates[i];
        }
        for (int s = 1; s < divisions[j]; s++) {
            if (!derivatives(m, t + s * h, now, rates))
                return false;
            for (int i = 0; i < n; i++) {
                real next = before[i] + 2.0L * h * rates[i];
                before[i] = now[i];
                now[i] = next;
            }
        }
        if (!derivatives(m, t + step, now, rates))
            return false;
        for (int i = 0; i < n; i++) {
            real value = 0.5L * (now[i] + before[i] + h * rates[i]), kept;
            for (int c = 0; c < j; c++) { /* Neville towards h = 0 in h^2 */
                kept = table[c][i];
                table[c][i] = value;
                real ratio = (real)divisions[j] / divisions[j - 1 - c];
                value += (value - kept) / (ratio * ratio - 1.0L);
            }
            table[j][i] = value;
        }
    }
    *error = 0.0L;
    for (int i = 0; i < n; i++) {
        result[i] = table[COLUMNS - 1][i];
        if (!isfinite(result[i]))
            return false;
        real scale = fmaxl(m->largest[i], 1e-30L);
        if (i < n - 3) /* the energy integrals follow */
            *error = fmaxl(*error, fabsl(table[COLUMNS - 1][i] - table[COLUMNS - 2][i]) / scale);
    }
    return true;
}

static void note_event(struct model *m, real t, int index, bool cleared) {
    struct independent_trace *trace = m->trace;
    if (trace->event_count == INDEPENDENT_EVENTS)
        return;
    enum dea_event_kind kind = DEA_EVENT_STOP;
    int zone = -1;
    if (index < ZONE_SWITCHES * DEA_ZONES) {
        zone = index / ZONE_SWITCHES;
        if (index % ZONE_SWITCHES == SWITCH_SLACK)
            kind = DEA_EVENT_SLACK;
        else if (index % ZONE_SWITCHES == SWITCH_BREAKDOWN)
            kind = DEA_EVENT_BREAKDOWN;
        else
            return;
    }
    trace->events[trace->event_count].t = (double)t;
    trace->events[trace->event_count].kind = kind;
    trace->events[trace->event_count].zone = zone;
    trace->events[trace->event_count].cleared = cleared;
    trace->event_count++;
}

static bool is_watched(const struct model *m, int index) {
    const struct dea_device *d = m->device;
    if (index >= ZONE_SWITCHES * DEA_ZONES)
        return d->has_stops;
    int k = index / ZONE_SWITCHES, what = index % ZONE_SWITCHES;
    if (!d->zones[k].present)
        return false;
    const struct dea_source *source = &m->scene->sources[k];
    if (what == SWITCH_SLACK)
        return true;
    if (what == SWITCH_BREAKDOWN)
        return d->zones[k].electroded && !isinf(d->material.dielectric.breakdown);
    if (!is_source(m, k) || !source->amplified)
        return false;
    return what == SWITCH_CURRENT ? !isinf(source->amplifier.current_limit)
                                  : m->amplifier[k] >= 0 && !isinf(source->amplifier.slew_rate);
}

/* Sign with which the guard is positive while the present mode holds. */
static real signed_guard(const struct model *m, int index) {
    int what = index % ZONE_SWITCHES;
    bool two_sided = index < ZONE_SWITCHES * DEA_ZONES && (what == SWITCH_CURRENT || what == SWITCH_SLEW);
    return !two_sided && m->mode[index] ? -m->guard[index] : m->guard[index];
}

/* Which way a limiter is entered: along what it would exceed. */
static void toggle(struct model *m, real t, const real *y, int index) {
    int what = index % ZONE_SWITCHES, k = index / ZONE_SWITCHES;
    bool stop = index >= ZONE_SWITCHES * DEA_ZONES;
    if (m->mode[index]) {
        m->mode[index] = 0;
    } else if (!stop && (what == SWITCH_CURRENT || what == SWITCH_SLEW)) {
        real rate, value = command(m, k, t, &rate);
        const struct dea_amplifier *a = &m->scene->sources[k].amplifier;
        real emf = m->amplifier[k] >= 0 ? y[m->amplifier[k]] : value;
        real push = what == SWITCH_CURRENT ? emf - m->volts[k] : isinf(a->bandwidth) ? rate : value - emf;
        m->mode[index] = push > 0.0L ? 1 : -1;
    } else {
        m->mode[index] = 1;
    }
    note_event(m, t, index, m->mode[index] == 0);
}

/* After a jump of the inputs: every mode anew. */
static bool settle_modes(struct model *m, real t, const real *y) {
    real rates[MAX_STATES], rate;
    for (int round = 0; round < 6; round++) {
        bool changed = false;
        for (int k = 0; k < DEA_ZONES; k++) {
            int index = ZONE_SWITCHES * k + SWITCH_SLEW;
            if (!is_watched(m, index) || !isinf(m->scene->sources[k].amplifier.bandwidth))
                continue;
            real value = command(m, k, t, &rate), gap = value - y[m->amplifier[k]];
            real size = 1e-15L * fmaxl(fabsl(value), 1.0L);
            int wanted = fabsl(gap) > size                                        ? (gap > 0.0L ? 1 : -1)
                         : fabsl(rate) > m->scene->sources[k].amplifier.slew_rate ? (rate > 0.0L ? 1 : -1)
                                                                                  : 0;
            m->mode[index] = wanted;
        }
        if (!derivatives(m, t, y, rates))
            return false;
        for (int index = 0; index < SWITCHES; index++) {
            bool pure_slew = index % ZONE_SWITCHES == SWITCH_SLEW && index < ZONE_SWITCHES * DEA_ZONES &&
                             isinf(m->scene->sources[index / ZONE_SWITCHES].amplifier.bandwidth);
            if (is_watched(m, index) && !pure_slew && signed_guard(m, index) < 0.0L) {
                toggle(m, t, y, index);
                changed = true;
                break;
            }
        }
        if (!changed)
            return true;
    }
    return true;
}

/* Advances to `end` or the first switch. */
static bool advance(struct model *m, real *t, real *y, real end, real *step, real tolerance) {
    real result[MAX_STATES], error = 0.0L, h = fminl(*step, end - *t), rates[MAX_STATES];
    for (int i = 0;; i++) {
        if (try_step(m, *t, y, h, result, &error) && error <= tolerance)
            break;
        h *= 0.5L;
        if (i > 60) {
            snprintf(m->trace->trouble, sizeof m->trace->trouble, "t = %.9Lg s: no step", *t);
            return false;
        }
    }
    bool last = h == end - *t;
    if (!last || h >= *step)
        *step = h * fminl(4.0L, 0.9L * powl(tolerance / fmaxl(error, 1e-30L), 1.0L / (2 * COLUMNS - 1)));
    if (!derivatives(m, *t + h, result, rates))
        return false;
    real first = h;
    int hit = -1;
    for (int index = 0; index < SWITCHES; index++) {
        derivatives(m, *t + h, result, rates);
        if (!is_watched(m, index) || signed_guard(m, index) >= 0.0L)
            continue;
        real low = 0.0L, high = h, trial[MAX_STATES];
        for (int i = 0; i < 70 && high - low > 1e-19L; i++) {
            real mid = 0.5L * (low + high);
            if (!try_step(m, *t, y, mid, trial, &error) || !derivatives(m, *t + mid, trial, rates))
                return false;
            if (signed_guard(m, index) < 0.0L)
                high = mid;
            else
                low = mid;
        }
        if (high < first || hit < 0) {
            first = high;
            hit = index;
        }
    }
    m->trace->steps++;
    if (hit >= 0) {
        if (!try_step(m, *t, y, first, result, &error))
            return false;
        last = false;
    }
    *t = last ? end : *t + first;
    for (int i = 0; i < m->count; i++) {
        y[i] = result[i];
        m->largest[i] = fmaxl(m->largest[i], fabsl(y[i]));
    }
    if (hit >= 0) {
        derivatives(m, *t, y, rates);
        toggle(m, *t, y, hit);
        *step = fminl(*step, 0.1L * h + 1e-9L);
    }
    return true;
}

/* ---- the run ---- */

static bool sample(struct model *m, real t, real *y, size_t index) {
    real rates[MAX_STATES];
    struct films films;
    if (!derivatives(m, t, y, rates))
        return false;
    real x = y[0];
    if (effective_mass(m->device) == 0.0L && m->device->damping == 0.0 && !balance(m, t, y, &films, &x))
        return false;
    y[0] = x;
    m->trace->x[index] = (double)x;
    m->trace->v[index] = (double)m->velocity;
    for (int k = 0; k < DEA_ZONES; k++) {
        m->trace->port[k][index] = (double)m->port_volts[k];
        m->trace->film[k][index] = (double)m->volts[k];
    }
    return true;
}

static bool integrate(struct model *m, real tolerance, size_t samples) {
    real y[MAX_STATES], stop = m->scene->stop, step = 1e-9L, stored;
    real *corners = malloc((MAX_CORNERS + samples + 2) * sizeof *corners);
    if (corners == NULL || !start(m, y))
        return free(corners), false;
    m->middle = -1.0L;
    stored = stored_energy(m, 0.0L, y);
    size_t count = 0, next_sample = 0;
    for (int k = 0; k < DEA_ZONES; k++)
        if (m->scene->sources[k].present)
            count = list_corners(&m->scene->sources[k].waveform, stop, corners, count);
    if (m->scene->has_load_waveform)
        count = list_corners(&m->scene->load, stop, corners, count);
    corners[count++] = 0.0L;
    corners[count++] = stop;
    qsort(corners, count, sizeof *corners, compare_times);
    /* scales: what a state has reached, at first a small part of what it will */
    for (int i = 0; i < m->count; i++)
        m->largest[i] = fabsl(y[i]);
    m->largest[0] = fmaxl(m->largest[0], 1e-9L);
    if (m->v >= 0)
        m->largest[m->v] = fmaxl(m->largest[m->v], 1e-6L);
    for (int k = 0; k < DEA_ZONES; k++) {
        if (m->charge[k] >= 0)
            m->largest[m->charge[k]] = fmaxl(m->largest[m->charge[k]], 1e-13L);
        if (m->amplifier[k] >= 0)
            m->largest[m->amplifier[k]] = fmaxl(m->largest[m->amplifier[k]], 1.0L);
    }
    bool good = sample(m, 0.0L, y, next_sample++); /* before anything moves: left limits, as the run's rows */
    for (size_t c = 0; c + 1 < count && good; c++) {
        real from = corners[c], to = corners[c + 1];
        if (to - from < 1e-15L * stop)
            continue;
        m->middle = 0.5L * (from + to);
        real t = from;
        good = settle_modes(m, t, y);
        step = fminl(step, 1e-8L);
        while (good && t < to) {
            real due = stop * next_sample / samples;
            good = advance(m, &t, y, fminl(to, due), &step, tolerance);
            if (good && next_sample <= samples && t >= due * (1.0L - 1e-18L))
                good = sample(m, t, y, next_sample++);
        }
    }
    while (good && next_sample <= samples) /* due at the end, but for rounding */
        good = sample(m, stop, y, next_sample++);
    if (good) {
        m->trace->stored = (double)(stored_energy(m, stop, y) - stored);
        m->trace->work = (double)y[m->count - 3];
        m->trace->branch_loss = (double)y[m->count - 2];
        m->trace->loss = (double)y[m->count - 1];
    }
    free(corners);
    return good;
}

bool independent_run(const struct dea_scene *scene, double tolerance, size_t samples, struct independent_trace *trace) {
    struct model *m = calloc(1, sizeof *m);
    memset(trace, 0, sizeof *trace);
    trace->count = samples + 1;
    double *all = calloc(6 * trace->count, sizeof *all);
    if (m == NULL || all == NULL || scene->devices[0].device.material.branch_count > MAX_BRANCHES) {
        free(m);
        free(all);
        return false;
    }
    trace->x = all;
    trace->v = all + trace->count;
    for (int k = 0; k < DEA_ZONES; k++) {
        trace->port[k] = all + (2 + (size_t)k) * trace->count;
        trace->film[k] = all + (4 + (size_t)k) * trace->count;
    }
    m->scene = scene;
    m->device = &scene->devices[0].device;
    m->trace = trace;
    lay_out(m);
    bool good = integrate(m, tolerance, samples);
    if (!good && trace->trouble[0] == '\0')
        snprintf(trace->trouble, sizeof trace->trouble, "the state left the model");
    free(m);
    return good;
}

void independent_free(struct independent_trace *trace) {
    free(trace->x);
    memset(trace, 0, sizeof *trace);
}
