/* One device between plant and circuit. */
#include "cosim/coupled.h"

#include <math.h>
#include <string.h>

/* The part of a capacitance that its own voltage may explain within one step. */
#define MAX_SOFT_PART 0.5

int coupled_order_ports(const struct dea_device *device, int zones[DEA_ZONES]) {
    int count = 0;
    for (int i = 0; i < DEA_ZONES; i++) {
        int k = device->right_first ? DEA_ZONES - 1 - i : i;
        if (device->zones[k].present && device->zones[k].electroded)
            zones[count++] = k;
    }
    return count;
}

enum dea_status coupled_create(struct coupled *coupled, const struct dea_device *device,
                               const struct dea_waveform *load, const struct coupled_demand *demand,
                               struct dea_error *error) {
    *coupled = (struct coupled){.device = device, .load = load, .told_at = NAN};
    struct dea_plant_options options = {.accuracy = demand->accuracy,
                                        .duration = demand->duration,
                                        .load_peak =
                                            fabs(device->load) + (load != NULL ? dea_waveform_peak(load) : 0.0)};
    coupled->port_count = coupled_order_ports(device, coupled->zones);
    for (int p = 0; p < coupled->port_count; p++)
        options.ports[coupled->zones[p]] = (struct dea_plant_port){.kind = DEA_PORT_CHARGE, .peak = demand->peak};
    return dea_plant_create(device, &options, &coupled->plant, error);
}

void coupled_clear(struct coupled *coupled) {
    dea_plant_destroy(coupled->plant);
    for (int p = 0; p < DEA_ZONES; p++)
        window_clear(&coupled->windows[p]);
    memset(coupled, 0, sizeof *coupled);
}

/* ---- what the circuit is told ---- */

/* Charge of a film a circuit step after its last point. */
static double foresee_charge(const struct coupled *coupled, int port, double t) {
    const struct window *window = &coupled->windows[port];
    const struct window_point *last = &window->points[window->count - 1];
    double rate = coupled->outlook.charge_rate[coupled->zones[port]];
    if (window->count > 1)
        rate = (last->q - last[-1].q) / (last->t - last[-1].t);
    return last->q + rate * (t - last->t);
}

/* How far the correction of the last outlook has faded, 1 to 0. */
static double fade(const struct coupled *coupled, double ahead) {
    double part = coupled->horizon > 0.0 ? fmin(ahead / coupled->horizon, 1.0) : 1.0;
    return (1.0 - part) * (1.0 - part) * (1.0 + 2.0 * part);
}

/* The tangent of Q(V) of one film at time t, about a charge. */
static struct told_film tell_film(const struct coupled *coupled, int port, double t, double charge) {
    const struct dea_outlook *outlook = &coupled->outlook;
    const struct dea_device *device = coupled->device;
    int k = coupled->zones[port];
    double ahead = fmax(t - outlook->start, 0.0), x = dea_outlook_position(outlook, outlook->start + ahead);
    /* a wild outlook must not lead out of the model */
    double lam = fmin(fmax(dea_zone_stretch(device, k, x), 0.2 * device->prestretch[0]), 5.0 * device->prestretch[0]);
    double c = dea_zone_capacitance(device, k, lam, NULL, NULL), v, soft = 0.0;
    struct dea_film_outlook film = {.slack = false};
    if (device->slack && dea_plant_imagine_film(coupled->plant, k, ahead, x, charge, &film) == DEA_OK &&
        film.slack) { /* its own charge stretches it, at once */
        lam = film.stretch;
        c = film.capacitance;
        soft = film.softness;
        v = charge / c;
    } else {
        v = (outlook->charge[k] + outlook->charge_rate[k] * ahead) / c;
        /* Inertia keeps the platform from following its own voltage within a step, the outlook alone is smoother;
         * damping lets it follow what the voltage does beyond the outlook since the last point. */
        if (outlook->mass <= 0.0 && outlook->damping <= 0.0) {
            soft = dea_outlook_softness(outlook, k, ahead);
        } else if (outlook->mass <= 0.0) {
            const struct window_point *last = &coupled->windows[port].points[coupled->windows[port].count - 1];
            double foreseen = (outlook->charge[k] + outlook->charge_rate[k] * (last->t - outlook->start)) / c;
            soft = dea_outlook_softness(outlook, k, t - last->t);
            v = copysign(sqrt(fmax(v * v - foreseen * foreseen + last->q / c * last->q / c, 0.0)), last->q);
        }
    }
    if (soft * v * v > MAX_SOFT_PART * c)
        soft = MAX_SOFT_PART * c / (v * v);
    /* at the outlook's own voltage, where the capacitance grows with V^2 as the film gives way */
    double slope = c + 2.0 * soft * v * v + coupled->fading[port] * fade(coupled, ahead);
    return (struct told_film){slope, -2.0 * soft * v * v * v, lam, dea_zone_resistance(device, k, lam, NULL)};
}

/* All numbers of one time at once; a circuit asks for each of them in each Newton iteration. */
static void tell_all(struct coupled *coupled, double t) {
    double ahead = fmax(t - coupled->outlook.start, 0.0);
    coupled->told_at = t;
    coupled->position = dea_outlook_position(&coupled->outlook, coupled->outlook.start + ahead) +
                        coupled->fading_position * fade(coupled, ahead);
    for (int p = 0; p < coupled->port_count; p++)
        coupled->told[p] = tell_film(coupled, p, t, foresee_charge(coupled, p, t));
}

double coupled_tell(struct coupled *coupled, int port, enum dea_external which, double t) {
    if (t != coupled->told_at)
        tell_all(coupled, t);
    switch (which) {
    case DEA_EXTERNAL_CAPACITANCE:
        return coupled->told[port].c;
    case DEA_EXTERNAL_OFFSET:
        return coupled->told[port].q0;
    case DEA_EXTERNAL_RESISTANCE:
        return coupled->told[port].resistance;
    case DEA_EXTERNAL_STRETCH:
        return coupled->told[port].stretch;
    default:
        return coupled->position;
    }
}

/* ---- start ---- */

static enum dea_status look_ahead(struct coupled *coupled, double horizon, struct dea_error *error) {
    coupled->told_at = NAN;
    coupled->horizon = horizon;
    coupled->drift = coupled->defect = coupled->strayed = coupled->straying = 0.0;
    if (dea_plant_look_ahead(coupled->plant, horizon, &coupled->outlook) != DEA_OK)
        return dea_fail(error, DEA_ERR_SOLVER, "t = %.9g s: the device left the model", dea_plant_time(coupled->plant));
    return DEA_OK;
}

/* The load's piece after t in force. */
static enum dea_status turn_load(struct coupled *coupled, double t, struct dea_error *error) {
    dea_waveform_piece(coupled->load, t, &coupled->inputs.load);
    return dea_plant_restart(coupled->plant, &coupled->inputs, error);
}

double coupled_charge(const struct coupled *coupled, int port) {
    const struct window *window = &coupled->windows[port];
    return window->points[window->count - 1].q;
}

double coupled_next_corner(const struct coupled *coupled) {
    return coupled->load != NULL ? coupled->inputs.load.end : INFINITY;
}

enum dea_status coupled_rest(struct coupled *coupled, const double *film_voltages, enum dea_start start,
                             const double *x, const double *v, struct dea_error *error) {
    struct dea_plant_inputs *inputs = &coupled->inputs;
    *inputs = (struct dea_plant_inputs){.load = {.kind = DEA_PIECE_LINE, .end = INFINITY}};
    if (coupled->load != NULL) /* what it was before t = 0 */
        dea_waveform_piece(coupled->load, -1.0, &inputs->load);
    double voltages[DEA_ZONES] = {0.0, 0.0};
    for (int p = 0; p < coupled->port_count; p++)
        voltages[coupled->zones[p]] = film_voltages[p];
    DEA_TRY(dea_plant_rest_charges(coupled->plant, voltages, start, x, inputs, error));
    DEA_TRY(dea_plant_start(coupled->plant, 0.0, inputs, start, x, v, error));
    if (coupled->load != NULL)
        DEA_TRY(turn_load(coupled, 0.0, error));
    DEA_TRY(look_ahead(coupled, 1e-6, error));
    coupled->film_work = coupled->resistive = coupled->leakage = 0.0;
    for (int p = 0; p < coupled->port_count; p++) {
        int k = coupled->zones[p];
        if (window_begin(&coupled->windows[p], 0.0, coupled->outlook.charge[k]) != DEA_OK)
            return dea_fail(error, DEA_ERR_MEMORY, "out of memory");
        coupled->taken[p][1] = (struct port_point){film_voltages[p], film_voltages[p], 0.0};
        coupled->fading[p] = 0.0;
        coupled->largest_charge[p] = fabs(coupled->outlook.charge[k]);
    }
    coupled->fading_position = 0.0;
    coupled->pending = false;
    return DEA_OK;
}

/* ---- circuit points ---- */

/* What a charge over its voltage makes a tangent: far from where it was taken, near no voltage, that means nothing. */
static double quotient(const struct told_film *film, double v) {
    if (film->q0 == 0.0)
        return film->c;
    return fabs(film->q0) < 2.0 / 3.0 * film->c * fabs(v) ? film->c + film->q0 / v : film->c / 3.0;
}

/* Film voltage that holds charge q at time t under what was told; *capacitance (may be NULL) is their quotient. */
static double film_voltage(const struct coupled *coupled, int port, double t, double q, double *capacitance) {
    struct told_film film = tell_film(coupled, port, t, q);
    double v = (q - film.q0) / film.c;
    if (capacitance != NULL)
        *capacitance = quotient(&film, v);
    return v;
}

/* Rows between two circuit points: charge from the Hermite cubic, the rest from it. */
static enum dea_status sample_port(struct coupled *coupled, int index, int port, const struct window_point *a,
                                   const struct window_point *b, struct observer *observer, struct dea_error *error) {
    const struct port_point *before = &coupled->taken[port][0], *after = &coupled->taken[port][1];
    double interval = observer_sample_interval(observer);
    long sample = (long)fmax(floor(a->t / interval), (double)observer_next_sample(observer) - 1.0);
    for (; (double)sample * interval <= b->t; sample++) {
        double t = (double)sample * interval, rate, part = (t - a->t) / (b->t - a->t);
        if (t <= a->t || sample < observer_next_sample(observer))
            continue;
        struct port_values values;
        values.charge = window_value(a, b, t, &rate);
        values.voltage = film_voltage(coupled, port, t, values.charge, NULL);
        double drop = (1.0 - part) * (before->port_voltage - before->film_voltage) +
                      part * (after->port_voltage - after->film_voltage);
        values.port_voltage = values.voltage + drop;
        values.current = rate + (1.0 - part) * before->leak + part * after->leak;
        DEA_TRY(observer_sample_port(observer, index, coupled->zones[port], sample, &values, error));
    }
    return DEA_OK;
}

/* Work on the film over one circuit step. With V = Q/C, int V dQ = [Q V / 2] + (1/2) int V^2 dC: the bracket is exact
 * and C changes slowly, however fast the charge rings. Losses in R_e and leakage by trapezoids. */
static void book_work(struct coupled *coupled, int port, const struct window_point *a, const struct window_point *b) {
    const struct port_point *before = &coupled->taken[port][0], *after = &coupled->taken[port][1];
    double h = b->t - a->t, middle = 0.5 * (a->t + b->t);
    double c0, c1, v0 = film_voltage(coupled, port, a->t, a->q, &c0);
    double v = film_voltage(coupled, port, middle, window_value(a, b, middle, NULL), NULL);
    double v1 = film_voltage(coupled, port, b->t, b->q, &c1);
    coupled->film_work += 0.5 * (b->q * v1 - a->q * v0) + (v0 * v0 + 4.0 * v * v + v1 * v1) / 12.0 * (c1 - c0);
    double lost_before = (before->port_voltage - before->film_voltage) * (a->after + before->leak);
    double lost_after = (after->port_voltage - after->film_voltage) * (b->before + after->leak);
    coupled->resistive += 0.5 * h * (lost_before + lost_after);
    coupled->leakage += 0.5 * h * (before->film_voltage * before->leak + after->film_voltage * after->leak);
}

/* Rates, work, rows and extremes of the interval that ends at points[n]. */
static enum dea_status settle_interval(struct coupled *coupled, int index, size_t n, struct observer *observer,
                                       struct dea_error *error) {
    coupled->pending = false;
    for (int p = 0; p < coupled->port_count; p++) {
        window_find_rates(&coupled->windows[p], n - 1);
        const struct window_point *a = &coupled->windows[p].points[n - 1], *b = a + 1;
        const struct port_point *after = &coupled->taken[p][1];
        book_work(coupled, p, a, b);
        DEA_TRY(sample_port(coupled, index, p, a, b, observer, error));
        struct port_values values = {after->film_voltage, after->port_voltage, b->q, b->before + after->leak};
        observer_note_port(observer, index, coupled->zones[p], b->t, coupled->told[p].stretch, &values);
    }
    return DEA_OK;
}

/* Where the platform's balance fails on the foreseen course, the platform goes another way: how far, in capacitance. */
static void note_drift(struct coupled *coupled, double from, double to) {
    const struct dea_outlook *outlook = &coupled->outlook;
    double charges[DEA_ZONES] = {0.0, 0.0}, h = to - from, before = coupled->defect;
    for (int p = 0; p < coupled->port_count; p++)
        charges[coupled->zones[p]] = coupled->windows[p].points[coupled->windows[p].count - 1].q;
    if (dea_plant_imagine_defect(coupled->plant, outlook, to, charges, &coupled->defect) != DEA_OK) {
        coupled->drift = INFINITY;
        return;
    }
    if (outlook->mass > 0.0) {
        double push = 0.5 * (before + coupled->defect) / outlook->mass;
        coupled->strayed += h * (coupled->straying + 0.5 * h * push);
        coupled->straying += h * push;
    } else { /* without damping: at once */
        double c = outlook->damping, stiffness = fmax(outlook->charge_stiffness, outlook->stiffness);
        coupled->strayed = (c * coupled->strayed + h * coupled->defect) / (c + h * stiffness);
    }
    for (int p = 0; p < coupled->port_count; p++) /* C goes as the square of the length */
        coupled->drift =
            fmax(coupled->drift, 2.0 * fabs(coupled->strayed) / coupled->device->zones[coupled->zones[p]].length);
}

enum dea_status coupled_take(struct coupled *coupled, int index, double from, double to,
                             const struct dea_port_sample *ports, struct observer *observer, struct dea_error *error) {
    size_t last = coupled->windows[0].count - 1;
    for (int p = 0; p < coupled->port_count; p++)
        if (to > from && window_add(&coupled->windows[p], to, ports[p].charge) != DEA_OK)
            return dea_fail(error, DEA_ERR_MEMORY, "t = %.9g s: out of memory for the circuit's points", to);
    if (coupled->pending)
        DEA_TRY(settle_interval(coupled, index, last, observer, error));
    for (int p = 0; p < coupled->port_count; p++) {
        double v = ports[p].film_voltage;
        tell_all(coupled, to);
        coupled->taken[p][0] = coupled->taken[p][1];
        coupled->taken[p][1] = (struct port_point){
            v, ports[p].port_voltage,
            dea_zone_leakage(coupled->device, coupled->zones[p], coupled->told[p].stretch, v, NULL, NULL)};
        coupled->largest_charge[p] = fmax(coupled->largest_charge[p], fabs(ports[p].charge));
    }
    if (to > from)
        note_drift(coupled, from, to);
    coupled->pending = to > from;
    return DEA_OK;
}

/* ---- exchange ---- */

/* What the circuit takes a capacitance to be at the last point. */
static double told_capacitance(struct coupled *coupled, int port) {
    const struct window *window = &coupled->windows[port];
    const struct window_point *point = &window->points[window->count - 1];
    double capacitance;
    film_voltage(coupled, port, point->t, point->q, &capacitance);
    return capacitance;
}

/* Charge pieces of all ports over a common stretch of points, as long as every port allows. */
static size_t fit_pieces(const struct coupled *coupled, size_t first, double fit_tolerance,
                         struct dea_charge_piece *pieces) {
    size_t last = coupled->windows[0].count - 1;
    double largest = 0.0;
    for (int p = 0; p < coupled->port_count; p++)
        largest = fmax(largest, coupled->largest_charge[p]);
    double tolerance = fit_tolerance * largest * largest;
    for (int settled = 0, p = 0; settled < coupled->port_count; p = (p + 1) % coupled->port_count) {
        size_t reach = window_fit(&coupled->windows[p], first, last, tolerance, &pieces[p]);
        settled = reach == last ? settled + 1 : 1;
        last = reach;
    }
    return last;
}

static enum dea_status follow_piece(struct coupled *coupled, int index, double end, struct observer *observer,
                                    struct exchange *exchange, struct dea_error *error) {
    while (dea_plant_time(coupled->plant) < end) {
        struct dea_step step;
        double corner = coupled_next_corner(coupled);
        DEA_TRY(dea_plant_step(coupled->plant, fmin(end, corner), &step, error));
        DEA_TRY(observer_follow(observer, index, step.from, step.to, error));
        if (step.to >= corner) {
            DEA_TRY(turn_load(coupled, corner, error));
            observer_break(observer);
        }
        if (!step.root)
            continue;
        int zone;
        enum dea_policy policy = observer_roots(observer, index, step.to, &zone);
        if (policy > exchange->policy) {
            exchange->policy = policy;
            exchange->zone = zone;
        }
        if (policy == DEA_POLICY_STOP)
            return DEA_OK;
    }
    return DEA_OK;
}

enum dea_status coupled_advance(struct coupled *coupled, int index, double fit_tolerance, struct observer *observer,
                                struct exchange *exchange, struct dea_error *error) {
    *exchange = (struct exchange){.policy = DEA_POLICY_IGNORE, .zone = -1};
    size_t last = coupled->windows[0].count - 1;
    double end = coupled->windows[0].points[last].t, foreseen[DEA_ZONES];
    if (coupled->pending)
        DEA_TRY(settle_interval(coupled, index, last, observer, error));
    tell_all(coupled, end);
    for (int p = 0; p < coupled->port_count; p++)
        coupled->last_told[p] = told_capacitance(coupled, p);
    memset(coupled->fading, 0, sizeof coupled->fading);
    for (int p = 0; p < coupled->port_count; p++)
        foreseen[p] = told_capacitance(coupled, p);
    for (size_t first = coupled->windows[0].first; first < last && exchange->policy != DEA_POLICY_STOP;) {
        struct dea_charge_piece pieces[DEA_ZONES];
        size_t next = fit_pieces(coupled, first, fit_tolerance, pieces);
        for (int p = 0; p < coupled->port_count; p++) {
            coupled->inputs.charge[coupled->zones[p]] = pieces[p];
            dea_plant_set_charge(coupled->plant, coupled->zones[p], &pieces[p]);
        }
        DEA_TRY(follow_piece(coupled, index, coupled->windows[0].points[next].t, observer, exchange, error));
        first = next;
    }
    DEA_TRY(look_ahead(coupled, coupled->horizon, error));
    for (int p = 0; p < coupled->port_count; p++) {
        double actual = coupled->outlook.capacitance[coupled->zones[p]];
        exchange->mismatch = fmax(exchange->mismatch, fabs(foreseen[p] - actual) / actual);
    }
    return DEA_OK;
}

enum dea_status coupled_renew(struct coupled *coupled, double horizon, struct dea_error *error) {
    DEA_TRY(look_ahead(coupled, horizon, error));
    for (int p = 0; p < coupled->port_count; p++) {
        struct window *window = &coupled->windows[p];
        coupled->outlook.charge[coupled->zones[p]] = window->points[window->count - 1].q;
        window_restart(window);
    }
    double told_position = coupled->position;
    for (int p = 0; p < coupled->port_count; p++) { /* the circuit's voltages stay what they are */
        double q = coupled->outlook.charge[coupled->zones[p]], v = q / coupled->last_told[p];
        struct told_film film = tell_film(coupled, p, coupled->outlook.start, q);
        coupled->fading[p] = coupled->last_told[p] - quotient(&film, v);
    }
    coupled->fading_position = told_position - coupled->outlook.x[0];
    coupled->told_at = NAN;
    return DEA_OK;
}
