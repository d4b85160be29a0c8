/* One device between plant and circuit. */
#include "cosim/coupled_internal.h"

#include <math.h>
#include <string.h>

/* A rest goes on until the swing is so many times the one it began with: seen at different phases it is not quite even.
 */
#define WAKING_RATIO 2.0

/* A capacitance that changes less than this within a circuit step needs no look at the film in between. */
#define STEADY 1e-5
/* The foreseen course is compared with the balance when this part of the horizon has gone by, or a charge has changed
 * by this part of the largest. */
#define WATCH_TIME (1.0 / 50.0)
#define WATCH_CHARGE 0.01

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
    *coupled = (struct coupled){.device = device,
                                .load = load,
                                .told_at = NAN,
                                .watched = demand->breakdown,
                                .rest_capacitance = demand->rest_capacitance,
                                .rest_position = demand->rest_position};
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

/* ---- start ---- */

static enum dea_status look_ahead(struct coupled *coupled, double horizon, struct dea_error *error) {
    coupled->told_at = NAN;
    coupled->horizon = horizon;
    coupled->drift = coupled->defect = coupled->strayed = coupled->straying = 0.0;
    if (dea_plant_look_ahead(coupled->plant, horizon, &coupled->outlook) != DEA_OK)
        return dea_fail(error, DEA_ERR_SOLVER, "t = %.9g s: the device left the model", dea_plant_time(coupled->plant));
    coupled->compared_at = coupled->outlook.start;
    for (int p = 0; p < coupled->port_count; p++)
        coupled->compared_charge[p] = coupled->outlook.charge[coupled->zones[p]];
    return DEA_OK;
}

/* The load's piece after t in force. */
static enum dea_status turn_load(struct coupled *coupled, double t, struct dea_error *error) {
    dea_waveform_piece(coupled->load, t, &coupled->inputs.load);
    return dea_plant_restart(coupled->plant, &coupled->inputs, error);
}

double coupled_charge(const struct coupled *coupled, int port) {
    return coupled_last_point(coupled, port)->q;
}

double coupled_next_corner(const struct coupled *coupled) {
    return coupled->load != NULL ? coupled->inputs.load.end : INFINITY;
}

double coupled_next_contact(const struct coupled *coupled, double horizon) {
    return dea_outlook_contact(&coupled->outlook, coupled->device, horizon);
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
    coupled->books = coupled->books_at_exchange = (struct port_books){0};
    for (int p = 0; p < coupled->port_count; p++) {
        int k = coupled->zones[p];
        struct window_point first = {.q = coupled->outlook.charge[k],
                                     .film_voltage = film_voltages[p],
                                     .port_voltage = film_voltages[p],
                                     .capacitance = coupled->outlook.capacitance[k]};
        if (window_begin(&coupled->windows[p], &first) != DEA_OK)
            return dea_fail(error, DEA_ERR_MEMORY, "out of memory");
        coupled->fading[p] = 0.0;
        coupled->largest_charge[p] = fabs(coupled->outlook.charge[k]);
    }
    coupled->fading_position = 0.0;
    coupled->pending = false;
    return DEA_OK;
}

void coupled_short(struct coupled *coupled, unsigned zones) {
    for (int p = 0; p < coupled->port_count; p++)
        if (zones & 1u << coupled->zones[p] && coupled->shorted[p] == 0.0) {
            struct window_point *last = coupled_last_point(coupled, p);
            coupled->shorted[p] = 1.0 / SHORT_RESISTANCE;
            last->leak += coupled->shorted[p] * last->film_voltage;
        }
}

/* ---- circuit points ---- */

/* Rows between two circuit points: charge from the Hermite cubic, the rest from it. */
static enum dea_status sample_port(struct coupled *coupled, int index, int port, const struct window_point *a,
                                   const struct window_point *b, struct observer *observer, struct dea_error *error) {
    double interval = observer_sample_interval(observer);
    long sample = (long)fmax(floor(a->t / interval), (double)observer_next_sample(observer) - 1.0);
    for (; (double)sample * interval <= b->t; sample++) {
        double t = (double)sample * interval, rate, part = (t - a->t) / (b->t - a->t);
        if (t <= a->t || sample < observer_next_sample(observer))
            continue;
        struct port_values values;
        values.charge = window_value(a, b, t, &rate);
        values.voltage = coupled_film_voltage(coupled, port, t, values.charge, NULL);
        double drop = (1.0 - part) * (a->port_voltage - a->film_voltage) + part * (b->port_voltage - b->film_voltage);
        values.port_voltage = values.voltage + drop;
        values.current = rate + (1.0 - part) * a->leak + part * b->leak;
        DEA_TRY(observer_sample_port(observer, index, coupled->zones[port], sample, &values, error));
    }
    return DEA_OK;
}

/* Capacitance halfway through a circuit step; where it hardly changes, the mean of its ends will do. */
static double find_middle(const struct coupled *coupled, int port, const struct window_point *a,
                          const struct window_point *b) {
    double middle = 0.5 * (a->t + b->t), c = 0.5 * (a->capacitance + b->capacitance);
    if (fabs(b->capacitance - a->capacitance) >= STEADY * a->capacitance)
        coupled_film_voltage(coupled, port, middle, window_value(a, b, middle, NULL), &c);
    return c;
}

/* Work on the film over one circuit step. With V = Q/C, int V dQ = [Q V / 2] + (1/2) int V^2 dC: the bracket is exact
 * and C changes slowly, however fast the charge rings. Losses in R_e and leakage by trapezoids. */
static void book_work(struct coupled *coupled, const struct window_point *a, const struct window_point *b) {
    double h = b->t - a->t, v = window_value(a, b, 0.5 * (a->t + b->t), NULL) / b->middle;
    double c0 = a->capacitance, c1 = b->capacitance, v0 = a->q / c0, v1 = b->q / c1;
    coupled->books.film_work += 0.5 * (b->q * v1 - a->q * v0) + (v0 * v0 + 4.0 * v * v + v1 * v1) / 12.0 * (c1 - c0);
    coupled->books.resistive += 0.5 * h *
                                ((a->port_voltage - a->film_voltage) * (a->after + a->leak) +
                                 (b->port_voltage - b->film_voltage) * (b->before + b->leak));
    coupled->books.leakage += 0.5 * h * (a->film_voltage * a->leak + b->film_voltage * b->leak);
}

static void note_point(const struct coupled *coupled, int index, int port, const struct window_point *point,
                       struct observer *observer) {
    struct port_values values = {point->film_voltage, point->port_voltage, point->q, point->before + point->leak};
    observer_note_port(observer, index, coupled->zones[port], point->t, point->stretch, &values);
}

/* Extremes of the circuit's points, up to where the plant has come. */
static void note_points(const struct coupled *coupled, int index, struct observer *observer) {
    for (int p = 0; p < coupled->port_count; p++) {
        const struct window *window = &coupled->windows[p];
        for (size_t n = window->first + 1; n < window->count; n++)
            if (window->points[n].t <= dea_plant_time(coupled->plant))
                note_point(coupled, index, p, &window->points[n], observer);
    }
}

/* Capacitance at a part of the interval from a to b, by the parabola through its ends and middle. */
static double capacitance_at(const struct window_point *a, const struct window_point *b, double part) {
    return a->capacitance * (1.0 - part) * (1.0 - 2.0 * part) + 4.0 * b->middle * part * (1.0 - part) +
           b->capacitance * part * (2.0 * part - 1.0);
}

/* The run stops where the plant is, at t, between points that have been booked already: with the capacitances of then,
 * for the films have gone on. */
static void book_until(struct coupled *coupled, int index, double t, struct observer *observer) {
    coupled->books = coupled->books_at_exchange;
    for (int p = 0; p < coupled->port_count; p++) {
        const struct window *window = &coupled->windows[p];
        for (size_t n = window->first; n + 1 < window->count && window->points[n].t < t; n++) {
            const struct window_point *a = &window->points[n], *b = a + 1;
            struct window_point end = *b;
            if (end.t > t) {
                double part = (t - a->t) / (b->t - a->t);
                end.t = t;
                end.q = window_value(a, b, t, &end.before);
                end.capacitance = capacitance_at(a, b, part);
                end.middle = capacitance_at(a, b, 0.5 * part);
                end.film_voltage += (1.0 - part) * (a->film_voltage - b->film_voltage);
                end.port_voltage += (1.0 - part) * (a->port_voltage - b->port_voltage);
                end.leak += (1.0 - part) * (a->leak - b->leak);
                end.stretch += (1.0 - part) * (a->stretch - b->stretch);
                note_point(coupled, index, p, &end, observer);
            }
            book_work(coupled, a, &end);
        }
    }
}

/* Rates, work and rows of the interval that ends at points[n]. */
static enum dea_status settle_interval(struct coupled *coupled, int index, size_t n, struct observer *observer,
                                       struct dea_error *error) {
    coupled->pending = false;
    for (int p = 0; p < coupled->port_count; p++) {
        window_find_rates(&coupled->windows[p], n - 1);
        const struct window_point *a = &coupled->windows[p].points[n - 1];
        struct window_point *b = &coupled->windows[p].points[n];
        b->middle = find_middle(coupled, p, a, b);
        book_work(coupled, a, b);
        DEA_TRY(sample_port(coupled, index, p, a, b, observer, error));
    }
    return DEA_OK;
}

static bool should_compare(const struct coupled *coupled, double t) {
    double change = 0.0, largest = 0.0;
    for (int p = 0; p < coupled->port_count; p++) {
        change = fmax(change, fabs(coupled_last_point(coupled, p)->q - coupled->compared_charge[p]));
        largest = fmax(largest, coupled->largest_charge[p]);
    }
    return t - coupled->compared_at >= WATCH_TIME * coupled->horizon || change > WATCH_CHARGE * largest;
}

/* Where the platform's balance fails on the foreseen course, the platform goes another way: how far, in capacitance. */
static void note_drift(struct coupled *coupled, double to) {
    if (!should_compare(coupled, to))
        return;
    const struct dea_outlook *outlook = &coupled->outlook;
    double charges[DEA_ZONES] = {0.0, 0.0}, h = to - coupled->compared_at, before = coupled->defect;
    for (int p = 0; p < coupled->port_count; p++)
        charges[coupled->zones[p]] = coupled->compared_charge[p] = coupled_last_point(coupled, p)->q;
    coupled->compared_at = to;
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

/* Whether a sound film is beyond breakdown: the plant must look when. */
static bool breaks_down(const struct coupled *coupled, int port) {
    const struct dea_device *device = coupled->device;
    double lam = coupled->told[port].stretch, thickness = device->thickness * device->prestretch[0] / lam;
    return coupled->shorted[port] == 0.0 &&
           fabs(dea_zone_field(device, coupled_last_point(coupled, port)->film_voltage, lam)) >=
               dea_breakdown_field(&device->material.dielectric, thickness, lam, device->prestretch[1]);
}

enum dea_status coupled_take(struct coupled *coupled, int index, double from, double to,
                             const struct dea_port_sample *ports, struct observer *observer, struct dea_error *error) {
    size_t last = coupled->windows[0].count - 1;
    for (int p = 0; p < coupled->port_count; p++) {
        struct window_point point = {.t = to,
                                     .q = ports[p].charge,
                                     .film_voltage = ports[p].film_voltage,
                                     .port_voltage = ports[p].port_voltage};
        if (to <= from)
            coupled->windows[p].count--; /* the very first point */
        if (window_add(&coupled->windows[p], &point) != DEA_OK)
            return dea_fail(error, DEA_ERR_MEMORY, "t = %.9g s: out of memory for the circuit's points", to);
    }
    if (coupled->pending)
        DEA_TRY(settle_interval(coupled, index, last, observer, error));
    coupled_tell_all(coupled, to);
    coupled->turned = false;
    for (int p = 0; p < coupled->port_count; p++) {
        coupled->turned = coupled->turned || (to > from && coupled->told[p].slack != coupled->slack[p]);
        coupled->slack[p] = coupled->told[p].slack;
        struct window_point *point = coupled_last_point(coupled, p);
        const struct told_film *told = &coupled->told[p];
        double v = point->film_voltage, lam = point->stretch = told->stretch;
        point->capacitance = coupled_quotient(told, (point->q - told->q0) / told->c);
        point->leak =
            dea_zone_leakage(coupled->device, coupled->zones[p], lam, v, NULL, NULL) + coupled->shorted[p] * v;
        coupled->largest_charge[p] = fmax(coupled->largest_charge[p], fabs(ports[p].charge));
        if (to <= from)
            note_point(coupled, index, p, point, observer);
    }
    if (to > from)
        note_drift(coupled, to);
    for (int p = 0; coupled->watched && p < coupled->port_count; p++)
        if (breaks_down(coupled, p))
            coupled->drift = INFINITY;
    coupled->pending = to > from;
    return DEA_OK;
}

/* ---- exchange ---- */

/* What the circuit takes a capacitance to be at the last point. */
static double told_capacitance(struct coupled *coupled, int port) {
    const struct window_point *point = coupled_last_point(coupled, port);
    double capacitance;
    coupled_film_voltage(coupled, port, point->t, point->q, &capacitance);
    return capacitance;
}

/* Square of the charge per pulling force of a film, C^2/N: it pulls with q^2 / (C length). */
static double square_per_pull(const struct coupled *coupled, int port) {
    const struct dea_zone *zone = &coupled->device->zones[coupled->zones[port]];
    return zone->rest_capacitance * zone->length;
}

/* Charge pieces of all ports over a common stretch of points, as long as every port allows: for the platform, the
 * films' pulls must be known alike. */
static size_t fit_pieces(const struct coupled *coupled, size_t first, double fit_tolerance,
                         struct dea_charge_piece *pieces) {
    size_t last = fit_tolerance >= 0.0 ? coupled->windows[0].count - 1 : first + 1;
    double largest = 0.0; /* pull, N */
    for (int p = 0; p < coupled->port_count; p++)
        largest = fmax(largest, coupled->largest_charge[p] * coupled->largest_charge[p] / square_per_pull(coupled, p));
    for (int settled = 0, p = 0; settled < coupled->port_count; p = (p + 1) % coupled->port_count) {
        double tolerance = fit_tolerance * largest * square_per_pull(coupled, p);
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
        coupled_short(coupled, observer_short_zones(observer));
        if (policy > exchange->policy)
            exchange->policy = policy;
        if (policy == DEA_POLICY_STOP)
            return DEA_OK;
    }
    return DEA_OK;
}

/* Relative change of capacitance that the platform's swing makes. */
static double swing_in_capacitance(const struct coupled *coupled) {
    double shortest = INFINITY;
    for (int p = 0; p < coupled->port_count; p++)
        shortest = fmin(shortest, coupled->device->zones[coupled->zones[p]].length);
    return 2.0 * coupled->outlook.swing / shortest; /* C goes as the square of the length */
}

enum dea_status coupled_advance(struct coupled *coupled, int index, double fit_tolerance, struct observer *observer,
                                struct exchange *exchange, struct dea_error *error) {
    *exchange = (struct exchange){.policy = DEA_POLICY_IGNORE};
    size_t last = coupled->windows[0].count - 1;
    double end = coupled->windows[0].points[last].t, foreseen[DEA_ZONES];
    if (coupled->pending)
        DEA_TRY(settle_interval(coupled, index, last, observer, error));
    for (int p = 0; coupled->watched && p < coupled->port_count; p++)
        if (breaks_down(coupled, p)) /* when and at what energy is a matter of each charge, not of their integral */
            fit_tolerance = -1.0;
    coupled_tell_all(coupled, end);
    for (int p = 0; p < coupled->port_count; p++)
        coupled->last_told[p] = told_capacitance(coupled, p);
    double fading[DEA_ZONES]; /* the outlook's own promise is without it */
    memcpy(fading, coupled->fading, sizeof fading);
    memset(coupled->fading, 0, sizeof coupled->fading);
    for (int p = 0; p < coupled->port_count; p++)
        foreseen[p] = told_capacitance(coupled, p);
    memcpy(coupled->fading, fading, sizeof fading);
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
    note_points(coupled, index, observer);
    if (exchange->policy == DEA_POLICY_STOP)
        book_until(coupled, index, dea_plant_time(coupled->plant), observer);
    DEA_TRY(look_ahead(coupled, coupled->horizon, error));
    /* what an outlook at rest leaves out on purpose is none of its faults */
    double left_out =
        coupled->at_rest ? fmin(swing_in_capacitance(coupled), WAKING_RATIO * coupled->rest_capacitance) : 0.0;
    for (int p = 0; p < coupled->port_count; p++) {
        double actual = coupled->outlook.capacitance[coupled->zones[p]];
        exchange->mismatch = fmax(exchange->mismatch, fabs(foreseen[p] - actual) / actual - left_out);
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
    coupled->largest_position = fmax(coupled->largest_position, fabs(coupled->outlook.x[0]));
    double wakes = coupled->at_rest ? WAKING_RATIO : 1.0;
    coupled->at_rest = swing_in_capacitance(coupled) < wakes * coupled->rest_capacitance &&
                       coupled->outlook.swing < wakes * coupled->rest_position * coupled->largest_position;
    if (coupled->at_rest)
        dea_outlook_rest(&coupled->outlook);
    double told_position = coupled->position;
    memset(coupled->fading, 0, sizeof coupled->fading);
    for (int p = 0; p < coupled->port_count; p++) { /* the circuit's voltages stay what they are */
        double q = coupled->outlook.charge[coupled->zones[p]], v = q / coupled->last_told[p];
        struct told_film film = coupled_tell_film(coupled, p, coupled->outlook.start, q);
        coupled->fading[p] = coupled->last_told[p] - coupled_quotient(&film, v);
    }
    coupled->fading_position = told_position - coupled->outlook.x[0];
    coupled->books_at_exchange = coupled->books;
    coupled->told_at = NAN;
    return DEA_OK;
}
