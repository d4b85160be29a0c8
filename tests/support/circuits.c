/* Circuit and device in one system of equations. */
#include "circuits.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MAX_STATES = 64 };

static const double vacuum = 8.8541878128e-12;

/* ---- building circuits ---- */

struct lead dc_lead(double volts, double resistance) {
    return (struct lead){.points = 1, .u = {volts}, .resistance = resistance};
}

struct lead step_lead(double volts, double at, double rise, double resistance) {
    return (struct lead){.points = 2, .t = {at, at + rise}, .u = {0.0, volts}, .resistance = resistance};
}

struct lead sine_lead(double offset, double amplitude, double frequency, double resistance) {
    return (struct lead){.offset = offset, .amplitude = amplitude, .frequency = frequency, .resistance = resistance};
}

static void write_lead(FILE *file, const struct lead *lead, int k) {
    char node[16];
    if (lead->points > 0) {
        fprintf(file, "V%d s%d 0 PWL(", k, k);
        if (lead->points == 1 || lead->t[0] > 0.0)
            fprintf(file, "0 %.17g ", lead->u[0]);
        for (int i = lead->points == 1 ? 1 : 0; i < lead->points; i++)
            fprintf(file, "%.17g %.17g ", lead->t[i], lead->u[i]);
        fprintf(file, ")\n");
    } else {
        fprintf(file, "V%d s%d 0 SIN(%.17g %.17g %.17g)\n", k, k, lead->offset, lead->amplitude, lead->frequency);
    }
    snprintf(node, sizeof node, "s%d", k);
    if (lead->opens_at > 0.0) {
        fprintf(file, "Vcoil%d coil%d 0 PWL(0 1 %.17g 1 %.17g 0)\n", k, k, lead->opens_at - 0.5e-6,
                lead->opens_at + 0.5e-6);
        fprintf(file, "S%d %s w%d coil%d 0 relay%d\n.model relay%d SW(VT=0.5 VH=0 RON=1e-3 ROFF=%.17g)\n", k, node, k,
                k, k, k, lead->open_r);
        snprintf(node, sizeof node, "w%d", k);
    }
    const char *last = lead->sections > 0 ? "n" : "p";
    if (lead->inductance > 0.0) {
        fprintf(file, "R%d %s l%d %.17g\nL%d l%d %s%d%s %.17g\n", k, node, k, lead->resistance, k, k, last, k,
                lead->sections > 0 ? "_0" : "", lead->inductance);
    } else {
        fprintf(file, "R%d %s %s%d%s %.17g\n", k, node, last, k, lead->sections > 0 ? "_0" : "",
                lead->resistance > 0.0 ? lead->resistance : 1e-9);
    }
    for (int i = 0; i < lead->sections; i++) {
        fprintf(file, "Cn%d_%d n%d_%d 0 %.17g\n", k, i, k, i, lead->section_c);
        if (i + 1 < lead->sections)
            fprintf(file, "Rn%d_%d n%d_%d n%d_%d %.17g\n", k, i, k, i, k, i + 1, lead->section_r);
        else
            fprintf(file, "Rn%d_%d n%d_%d p%d %.17g\n", k, i, k, i, k, lead->section_r);
    }
    if (lead->shunt_c > 0.0)
        fprintf(file, "Cp%d p%d 0 %.17g\n", k, k, lead->shunt_c);
    if (lead->shunt_r > 0.0)
        fprintf(file, "Rp%d p%d 0 %.17g\n", k, k, lead->shunt_r);
}

void write_circuit(const char *path, const struct drive_circuit *circuit, const struct dea_device *device) {
    FILE *file = fopen(path, "w");
    if (file == NULL) {
        perror(path);
        abort();
    }
    fprintf(file, "test circuit\n");
    char pins[64] = "";
    for (int i = 0; i < DEA_ZONES; i++) {
        int k = device->right_first ? DEA_ZONES - 1 - i : i;
        if (!device->zones[k].present || !device->zones[k].electroded)
            continue;
        write_lead(file, &circuit->leads[k], k);
        snprintf(pins + strlen(pins), sizeof pins - strlen(pins), "p%d 0 ", k);
    }
    fprintf(file, "Xdea %spos DEA\n.end\n", pins);
    if (fclose(file) != 0)
        abort();
}

void set_native_sources(struct dea_scene *scene, const struct drive_circuit *circuit) {
    free(scene->netlist);
    scene->netlist = NULL;
    for (int k = 0; k < DEA_ZONES; k++) {
        const struct lead *lead = &circuit->leads[k];
        struct dea_source *source = &scene->sources[k];
        *source = (struct dea_source){.present = true, .resistance = lead->resistance};
        struct dea_waveform *wave = &source->waveform;
        if (lead->points == 0) {
            *wave = (struct dea_waveform){.kind = DEA_WAVE_SINE,
                                          .offset = lead->offset,
                                          .amplitude = lead->amplitude,
                                          .frequency = lead->frequency};
        } else if (lead->points == 1) {
            *wave = (struct dea_waveform){.kind = DEA_WAVE_DC, .level = lead->u[0]};
        } else {
            *wave = (struct dea_waveform){.kind = DEA_WAVE_PWL, .point_count = (size_t)lead->points};
            wave->times = malloc(sizeof lead->t);
            wave->values = malloc(sizeof lead->u);
            if (wave->times == NULL || wave->values == NULL)
                abort();
            memcpy(wave->times, lead->t, sizeof lead->t);
            memcpy(wave->values, lead->u, sizeof lead->u);
        }
    }
}

/* ---- the equations ---- */

struct system {
    const struct drive_circuit *circuit;
    const struct dea_device *device;
    int count, v, branch[DEA_ZONES], coil[DEA_ZONES], node[DEA_ZONES], port[DEA_ZONES], charge[DEA_ZONES];
    double mass, middle, x; /* middle: inside the present smooth stretch of time */
    /* of the last evaluation */
    double port_volts[DEA_ZONES];
};

static bool driven(const struct dea_device *device, int k) {
    return device->zones[k].present && device->zones[k].electroded;
}

static double source_value(const struct lead *lead, double t, double middle) {
    if (lead->points == 0)
        return lead->offset + lead->amplitude * sin(2.0 * M_PI * lead->frequency * t);
    int i = 0;
    while (i < lead->points && lead->t[i] <= middle)
        i++;
    if (lead->points == 1 || i == 0)
        return lead->u[0];
    if (i == lead->points)
        return lead->u[i - 1];
    return lead->u[i - 1] + (lead->u[i] - lead->u[i - 1]) * (t - lead->t[i - 1]) / (lead->t[i] - lead->t[i - 1]);
}

static double stretch_of(const struct system *s, int k, double x) {
    const struct dea_zone *zone = &s->device->zones[k];
    return s->device->prestretch[0] * (1.0 + (k == 0 ? x : -x) / zone->length);
}

static double capacitance_of(const struct system *s, int k, double x, double *per_length) {
    const struct dea_device *d = s->device;
    double l0 = d->zones[k].length, l = l0 + (k == 0 ? x : -x);
    double lam = d->prestretch[0] * l / l0;
    double eps = d->material.dielectric.permittivity + d->material.dielectric.permittivity_slope * lam;
    double shape = vacuum * d->width / (l0 * d->thickness);
    *per_length = shape * (2.0 * eps * l + l * l * d->material.dielectric.permittivity_slope * d->prestretch[0] / l0);
    return shape * eps * l * l;
}

/* Foo's branch: true stresses s1, s2 and rates of xi1, xi2. */
static void branch_stress(const struct dea_branch *b, double lam1, double lam2, const double *xi, double *s,
                          double *rate) {
    double third = xi[0] * xi[1] / (lam1 * lam2), e1 = lam1 / xi[0], e2 = lam2 / xi[1];
    double soft = isinf(b->jm) ? 1.0 : 1.0 - (e1 * e1 + e2 * e2 + third * third - 3.0) / b->jm;
    for (int i = 0; i < 2; i++)
        s[i] = b->mu * ((i == 0 ? e1 * e1 : e2 * e2) - third * third) / soft;
    double eta = b->tau * b->mu;
    rate[0] = xi[0] * (s[0] - 0.5 * s[1]) / (3.0 * eta);
    rate[1] = xi[1] * (s[1] - 0.5 * s[0]) / (3.0 * eta);
}

/* Pull of a membrane without Maxwell stress, N. */
static double tension(const struct system *s, int k, double x, const double *xi) {
    const struct dea_device *d = s->device;
    double lam1 = stretch_of(s, k, x), lam2 = d->prestretch[1], mu = d->material.elastic.mu,
           jm = d->material.elastic.jm;
    double i1 = lam1 * lam1 + lam2 * lam2 + 1.0 / (lam1 * lam1 * lam2 * lam2);
    double p1 = mu * jm * (lam1 - 1.0 / (lam1 * lam1 * lam1 * lam2 * lam2)) / (jm + 3.0 - i1);
    for (int b = 0; xi != NULL && b < d->material.branch_count; b++) {
        double stress[2], rate[2];
        branch_stress(&d->material.branches[b], lam1, lam2, xi + 2 * b, stress, rate);
        p1 += stress[0] / lam1;
    }
    return d->width * d->thickness * d->prestretch[0] * p1;
}

/* Film voltage: from a given voltage, or from the charge on the electrode and what is parallel to it. */
struct electrode {
    bool given;
    double voltage, charge, parallel;
};

static double film_voltage(const struct electrode *e, double c) {
    return e->given ? e->voltage : e->charge / (c + e->parallel);
}

static double net_force(const struct system *s, const double *y, const struct electrode *electrodes, double x) {
    double force = s->device->load, slope;
    for (int k = 0; k < DEA_ZONES; k++) {
        if (!s->device->zones[k].present)
            continue;
        double pull = tension(s, k, x, y != NULL && s->branch[k] >= 0 ? y + s->branch[k] : NULL);
        if (driven(s->device, k)) {
            double v = film_voltage(&electrodes[k], capacitance_of(s, k, x, &slope));
            pull -= 0.5 * v * v * slope;
        }
        force -= (k == 0 ? 1.0 : -1.0) * pull;
    }
    return force;
}

/* Newton's method on the force balance from the last position. */
static double find_balance(const struct system *s, const double *y, const struct electrode *electrodes, double x) {
    double l = fmin(s->device->zones[0].present ? s->device->zones[0].length : 1.0,
                    s->device->zones[1].present ? s->device->zones[1].length : 1.0);
    for (int i = 0; i < 60; i++) {
        double h = 1e-6 * l, f = net_force(s, y, electrodes, x);
        double slope = (net_force(s, y, electrodes, x + h) - net_force(s, y, electrodes, x - h)) / (2.0 * h);
        double step = fmax(-0.05 * l, fmin(0.05 * l, -f / slope));
        x += step;
        if (fabs(step) < 1e-15 * l)
            break;
    }
    return x;
}

static double leakage(const struct system *s, int k, double x, double v) {
    const struct dea_dielectric *d = &s->device->material.dielectric;
    if (d->conductivity == 0.0)
        return 0.0;
    double l0 = s->device->zones[k].length, l = l0 + (k == 0 ? x : -x), field = v / s->device->thickness * l / l0;
    double sigma = d->conductivity * (isinf(d->conductivity_field) ? 1.0 : exp(fabs(field) / d->conductivity_field));
    return sigma * field * s->device->width * l;
}

static double electrode_resistance(const struct system *s, int k, double x) {
    const struct dea_zone *z = &s->device->zones[k];
    double l = z->length + (k == 0 ? x : -x), w = s->device->width;
    return z->electrode_resistance + 2.0 / 3.0 * z->sheet_resistance * (z->feed == DEA_FEED_LONG_EDGE ? l / w : w / l);
}

static double series_resistance(const struct lead *lead, double middle) {
    double r = lead->resistance;
    if (lead->opens_at > 0.0)
        r += middle < lead->opens_at ? 1e-3 : lead->open_r;
    return r;
}

/* What feeds the electrode: a voltage behind a resistance, or the current of a coil. */
static void lead_rates(const struct system *s, int k, double t, const double *y, double port_volts, double *rates,
                       double *volts, double *resistance) {
    const struct lead *lead = &s->circuit->leads[k];
    double u = source_value(lead, t, s->middle), r = series_resistance(lead, s->middle);
    *volts = u;
    *resistance = r;
    if (lead->inductance > 0.0)
        *resistance = INFINITY;
    for (int i = 0; i < lead->sections; i++) {
        int at = s->node[k] + i;
        double next = i + 1 < lead->sections ? y[at + 1] : port_volts;
        double in = i > 0                  ? (y[at - 1] - y[at]) / lead->section_r
                    : lead->inductance > 0 ? y[s->coil[k]]
                                           : (u - y[at]) / r;
        rates[at] = (in - (y[at] - next) / lead->section_r) / lead->section_c;
        *volts = y[at];
        *resistance = lead->section_r;
    }
    if (lead->inductance > 0.0) {
        double far = lead->sections > 0 ? y[s->node[k]] : port_volts;
        rates[s->coil[k]] = (u - r * y[s->coil[k]] - far) / lead->inductance;
    }
}

static void port_rates(struct system *s, int k, double t, const double *y, double x, double *rates) {
    const struct lead *lead = &s->circuit->leads[k];
    double slope, c = capacitance_of(s, k, x, &slope), re = electrode_resistance(s, k, x), volts, r, vp;
    double shunt = lead->shunt_r > 0.0 ? 1.0 / lead->shunt_r : 0.0, unused[MAX_STATES];
    lead_rates(s, k, t, y, 0.0, unused, &volts, &r);
    bool coil = isinf(r);
    if (s->charge[k] < 0) { /* ideal source at the film */
        s->port_volts[k] = volts;
        return;
    }
    double v = y[s->charge[k]] / (c + (re > 0.0 ? 0.0 : lead->shunt_c)), leak = leakage(s, k, x, v);
    if (re <= 0.0) {
        vp = v;
    } else if (s->port[k] >= 0) {
        vp = y[s->port[k]];
    } else if (r == 0.0) {
        vp = volts;
    } else { /* node equation */
        double in = coil ? y[s->coil[k]] : volts / r, g = (coil ? 0.0 : 1.0 / r) + shunt + 1.0 / re;
        vp = (in + v / re) / g;
    }
    lead_rates(s, k, t, y, vp, rates, &volts, &r);
    double in = coil ? y[s->coil[k]] : r > 0.0 ? (volts - vp) / r : 0.0;
    if (re <= 0.0) {
        rates[s->charge[k]] = in - vp * shunt - leak;
    } else {
        rates[s->charge[k]] = (vp - v) / re - leak;
        if (s->port[k] >= 0)
            rates[s->port[k]] = (in - vp * shunt - (vp - v) / re) / lead->shunt_c;
    }
    s->port_volts[k] = vp;
}

static void derivatives(struct system *s, double t, const double *y, double *rates) {
    struct electrode electrodes[DEA_ZONES] = {{0}};
    const struct dea_device *d = s->device;
    for (int k = 0; k < DEA_ZONES; k++) {
        const struct lead *lead = &s->circuit->leads[k];
        if (!driven(d, k))
            continue;
        electrodes[k].given = s->charge[k] < 0;
        electrodes[k].voltage = source_value(lead, t, s->middle);
        electrodes[k].charge = s->charge[k] < 0 ? 0.0 : y[s->charge[k]];
        electrodes[k].parallel = electrode_resistance(s, k, 0.0) > 0.0 ? 0.0 : lead->shunt_c;
    }
    double x = y[0];
    rates[0] = 0.0;
    if (s->v >= 0) {
        rates[0] = y[s->v];
        rates[s->v] = (net_force(s, y, electrodes, x) - d->damping * y[s->v]) / s->mass;
    } else if (d->damping > 0.0) {
        rates[0] = net_force(s, y, electrodes, x) / d->damping;
    } else {
        x = s->x = find_balance(s, y, electrodes, s->x);
    }
    for (int k = 0; k < DEA_ZONES; k++) {
        for (int b = 0; s->branch[k] >= 0 && b < d->material.branch_count; b++) {
            double stress[2];
            branch_stress(&d->material.branches[b], stretch_of(s, k, x), d->prestretch[1], y + s->branch[k] + 2 * b,
                          stress, rates + s->branch[k] + 2 * b);
        }
        if (driven(d, k))
            port_rates(s, k, t, y, x, rates);
    }
}

/* ---- start ---- */

static void lay_out(struct system *s) {
    const struct dea_device *d = s->device;
    s->mass = d->platform_mass;
    for (int k = 0; k < DEA_ZONES; k++)
        if (d->membrane_mass && d->zones[k].present)
            s->mass += d->material.density * d->width * d->thickness * d->zones[k].length / 3.0;
    s->count = 1;
    s->v = s->mass > 0.0 ? s->count++ : -1;
    for (int k = 0; k < DEA_ZONES; k++) {
        const struct lead *lead = &s->circuit->leads[k];
        s->branch[k] = s->coil[k] = s->node[k] = s->port[k] = s->charge[k] = -1;
        if (d->zones[k].present && d->material.branch_count > 0) {
            s->branch[k] = s->count;
            s->count += 2 * d->material.branch_count;
        }
        if (!driven(d, k))
            continue;
        if (lead->inductance > 0.0)
            s->coil[k] = s->count++;
        if (lead->sections > 0) {
            s->node[k] = s->count;
            s->count += lead->sections;
        }
        bool stiff = lead->resistance == 0.0 && lead->inductance == 0.0 && lead->sections == 0 && lead->opens_at == 0.0;
        bool film_resistance = electrode_resistance(s, k, 0.0) > 0.0;
        if (film_resistance && lead->shunt_c > 0.0 && !stiff)
            s->port[k] = s->count++;
        if (film_resistance || !stiff)
            s->charge[k] = s->count++;
    }
}

/* Rest at the sources' initial values: dividers of leads, shunts and leaks. */
static void start(struct system *s, double *y) {
    const struct dea_device *d = s->device;
    struct electrode electrodes[DEA_ZONES] = {{0}};
    double current[DEA_ZONES] = {0.0, 0.0}, ports[DEA_ZONES] = {0.0, 0.0};
    s->x = 0.0;
    for (int round = 0; round < 200; round++) {
        for (int k = 0; k < DEA_ZONES; k++) {
            const struct lead *lead = &s->circuit->leads[k];
            if (!driven(d, k))
                continue;
            double u = source_value(lead, 0.0, -1.0), re = electrode_resistance(s, k, s->x);
            double r = series_resistance(lead, -1.0) + lead->sections * lead->section_r;
            double leak = leakage(s, k, s->x, electrodes[k].voltage);
            ports[k] = (u - r * leak) / (1.0 + (lead->shunt_r > 0.0 ? r / lead->shunt_r : 0.0));
            current[k] = leak + (lead->shunt_r > 0.0 ? ports[k] / lead->shunt_r : 0.0);
            electrodes[k].given = true;
            electrodes[k].voltage = ports[k] - re * leak;
        }
        s->x = find_balance(s, NULL, electrodes, s->x);
    }
    memset(y, 0, MAX_STATES * sizeof *y);
    y[0] = s->x;
    for (int k = 0; k < DEA_ZONES; k++) {
        const struct lead *lead = &s->circuit->leads[k];
        for (int b = 0; s->branch[k] >= 0 && b < d->material.branch_count; b++) {
            y[s->branch[k] + 2 * b] = stretch_of(s, k, s->x);
            y[s->branch[k] + 2 * b + 1] = d->prestretch[1];
        }
        if (!driven(d, k))
            continue;
        double slope, c = capacitance_of(s, k, s->x, &slope);
        if (s->coil[k] >= 0)
            y[s->coil[k]] = current[k];
        for (int i = 0; i < lead->sections; i++)
            y[s->node[k] + i] = ports[k] + current[k] * lead->section_r * (lead->sections - i);
        if (s->port[k] >= 0)
            y[s->port[k]] = ports[k];
        if (s->charge[k] >= 0)
            y[s->charge[k]] =
                electrodes[k].voltage * (c + (electrode_resistance(s, k, 0.0) > 0.0 ? 0.0 : lead->shunt_c));
    }
}

/* ---- the integrator ---- */

/* One step of Dormand and Prince's 5(4) pair; returns the error over the scales. */
static double try_step(struct system *s, double t, const double *y, double h, const double *scale, double *next) {
    static const double a[6][6] = {{1.0 / 5.0},
                                   {3.0 / 40.0, 9.0 / 40.0},
                                   {44.0 / 45.0, -56.0 / 15.0, 32.0 / 9.0},
                                   {19372.0 / 6561.0, -25360.0 / 2187.0, 64448.0 / 6561.0, -212.0 / 729.0},
                                   {9017.0 / 3168.0, -355.0 / 33.0, 46732.0 / 5247.0, 49.0 / 176.0, -5103.0 / 18656.0},
                                   {35.0 / 384.0, 0.0, 500.0 / 1113.0, 125.0 / 192.0, -2187.0 / 6784.0, 11.0 / 84.0}};
    static const double c[6] = {0.2, 0.3, 0.8, 8.0 / 9.0, 1.0, 1.0};
    static const double e[7] = {71.0 / 57600.0,      0.0,          -71.0 / 16695.0, 71.0 / 1920.0,
                                -17253.0 / 339200.0, 22.0 / 525.0, -1.0 / 40.0};
    double k[7][MAX_STATES], error = 0.0;
    derivatives(s, t, y, k[0]);
    for (int stage = 0; stage < 6; stage++) {
        for (int i = 0; i < s->count; i++) {
            double sum = 0.0;
            for (int j = 0; j <= stage; j++)
                sum += a[stage][j] * k[j][i];
            next[i] = y[i] + h * sum;
        }
        derivatives(s, t + c[stage] * h, next, k[stage + 1]);
    }
    for (int i = 0; i < s->count; i++) {
        double sum = 0.0;
        for (int j = 0; j < 7; j++)
            sum += e[j] * k[j][i];
        error = fmax(error, fabs(h * sum) / scale[i]);
    }
    return error;
}

static int compare_times(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static size_t list_stops(const struct system *s, size_t samples, double *stops) {
    size_t count = 0;
    for (int k = 0; k < DEA_ZONES; k++) {
        const struct lead *lead = &s->circuit->leads[k];
        for (int i = 0; i < lead->points; i++)
            if (lead->t[i] > 0.0 && lead->t[i] < s->circuit->stop)
                stops[count++] = lead->t[i];
        if (lead->opens_at > 0.0)
            stops[count++] = lead->opens_at;
    }
    for (size_t i = 0; i <= samples; i++)
        stops[count++] = s->circuit->stop * (double)i / (double)samples;
    qsort(stops, count, sizeof *stops, compare_times);
    return count;
}

static void keep_sample(struct system *s, double t, const double *y, size_t index, struct coupled_trace *trace) {
    double rates[MAX_STATES];
    derivatives(s, t, y, rates);
    trace->x[index] = s->v < 0 && s->device->damping <= 0.0 ? s->x : y[0];
    for (int k = 0; k < DEA_ZONES; k++)
        trace->port[k][index] = driven(s->device, k) ? s->port_volts[k] : 0.0;
}

static bool advance(struct system *s, double from, double to, double tolerance, double *step, double *y,
                    struct coupled_trace *trace, double *largest) {
    double t = from, scale[MAX_STATES], next[MAX_STATES];
    while (t < to) {
        double h = fmin(*step, to - t);
        for (int i = 0; i < s->count; i++) {
            largest[i] = fmax(largest[i], fabs(y[i]));
            scale[i] = tolerance * largest[i] + 1e-300;
        }
        double error = try_step(s, t, y, h, scale, next);
        double factor = fmin(5.0, fmax(0.2, 0.9 * pow(fmax(error, 1e-10), -0.2)));
        if (!(error <= 1.0)) {
            *step = h * (isnan(error) ? 0.1 : fmin(factor, 0.9));
            if (!(h > 1e-16 * to))
                return false;
            continue;
        }
        if (h == *step || factor < 1.0)
            *step = h * factor;
        t = h == to - t ? to : t + h;
        memcpy(y, next, (size_t)s->count * sizeof *y);
        trace->steps++;
    }
    return true;
}

bool solve_circuit(const struct drive_circuit *circuit, const struct dea_device *device, double tolerance,
                   size_t samples, struct coupled_trace *trace) {
    struct system s = {.circuit = circuit, .device = device, .middle = -1.0};
    double y[MAX_STATES], largest[MAX_STATES];
    memset(trace, 0, sizeof *trace);
    trace->count = samples + 1;
    trace->x = calloc(3 * trace->count, sizeof *trace->x);
    double *stops = malloc((samples + 2 + DEA_ZONES * (LEAD_POINTS + 1)) * sizeof *stops);
    if (trace->x == NULL || stops == NULL)
        abort();
    for (int k = 0; k < DEA_ZONES; k++)
        trace->port[k] = trace->x + (size_t)(k + 1) * trace->count;
    lay_out(&s);
    start(&s, y);
    /* a state that has not moved yet is weighed by what moves visibly: um, mm/s, uA, V, nC */
    for (int i = 0; i < s.count; i++)
        largest[i] = 1e-3;
    largest[0] = 1e-6;
    for (int k = 0; k < DEA_ZONES; k++) {
        if (s.coil[k] >= 0)
            largest[s.coil[k]] = 1e-6;
        if (s.charge[k] >= 0)
            largest[s.charge[k]] = 1e-10;
    }
    size_t count = list_stops(&s, samples, stops), next = 0;
    keep_sample(&s, 0.0, y, next++, trace);
    double step = 1e-9;
    bool good = true;
    for (size_t i = 0; i + 1 < count && good; i++) {
        s.middle = 0.5 * (stops[i] + stops[i + 1]);
        if (stops[i + 1] > stops[i])
            good = advance(&s, stops[i], stops[i + 1], tolerance, &step, y, trace, largest);
        if (next <= samples && stops[i + 1] == circuit->stop * (double)next / (double)samples)
            keep_sample(&s, stops[i + 1], y, next++, trace);
    }
    free(stops);
    return good && next == trace->count;
}

void free_trace(struct coupled_trace *trace) {
    free(trace->x);
    memset(trace, 0, sizeof *trace);
}
