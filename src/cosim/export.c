/* deasim export: devices as behavioural subcircuits, native sources as ngspice's own. States are scaled to order one:
 * displacement in mm, velocity in mm times the natural frequency, charge in units of rest capacitance times 1 kV,
 * branch states relative to the prestretch; each state is the voltage of a capacitor that a current charges at the
 * state's rate. */
#include "deasim/export.h"

#include "cosim/cosim.h"
#include "cosim/coupled.h"

#include <math.h>
#include <string.h>

#define SCALE_CURRENT 1e-3 /* A per unit of a state's rate times its time constant */

/* What a node that no voltage source defines is at rest: ngspice's operating point starts there. */
static void write_guess(FILE *file, const char *node, const char *of, double value) {
    fprintf(file, ".nodeset v(%s_%s)=%.17g\n", node, of, value);
}

/* ---- the elastic law ---- */

/* W1 in MPa as an expression of V(lNAME), with I1 - 3 at node e where the law needs it. */
static void write_law(FILE *file, const struct dea_device *device, int k) {
    const struct dea_law *law = &device->material.elastic;
    const char *zone = dea_zone_names[k];
    double lam1 = device->prestretch[0], lam2 = device->prestretch[1], b = 1.0 / (lam2 * lam2);
    double excess = lam1 * lam1 + lam2 * lam2 + b / (lam1 * lam1) - 3.0;
    double chain = law->kind == DEA_ARRUDA_BOYCE ? sqrt((excess + 3.0) / 3.0) / law->locking_stretch : 0.0;
    if (law->kind == DEA_OGDEN) {
        fprintf(file, "Bw_%s w_%s 0 V=0", zone, zone);
        for (int i = 0; i < law->ogden_terms; i++)
            fprintf(file, "\n+ + %.17g*(exp(%.17g*ln(lam(V(s_%s)))) - exp(%.17g*ln(lam(V(s_%s))*%.17g)))/lam(V(s_%s))",
                    1e-6 * law->ogden_mu[i], law->ogden_alpha[i], zone, -law->ogden_alpha[i], zone, lam2, zone);
        fputc('\n', file);
        return;
    }
    fprintf(file, "Be_%s e_%s 0 V=lam(V(s_%s))*lam(V(s_%s))+%.17g/(lam(V(s_%s))*lam(V(s_%s)))+%.17g\n", zone, zone,
            zone, zone, b, zone, zone, lam2 * lam2 - 3.0);
    fprintf(file, "Bw_%s w_%s 0 V=2*(lam(V(s_%s))-%.17g/(lam(V(s_%s))*lam(V(s_%s))*lam(V(s_%s))))*", zone, zone, zone,
            b, zone, zone, zone);
    switch (law->kind) {
    case DEA_GENT:
        fprintf(file, "%.17g/max(%.17g-V(e_%s),%.17g)\n", 0.5e-6 * law->mu * law->jm, law->jm, zone, 1e-6 * law->jm);
        break;
    case DEA_YEOH:
        fprintf(file, "(%.17g+V(e_%s)*(%.17g+V(e_%s)*%.17g))\n", 1e-6 * law->yeoh[0], zone, 2e-6 * law->yeoh[1], zone,
                3e-6 * law->yeoh[2]);
        break;
    case DEA_ARRUDA_BOYCE: /* node i solves the inverse Langevin function: coth(i) - 1/i = y */
        fprintf(file, "%.17g*V(i_%s)/lam(V(y_%s))\n", 1e-6 * law->mu / 6.0, zone, zone);
        fprintf(file, "By_%s y_%s 0 V=min(sqrt((V(e_%s)+3)/3)/%.17g,0.999)\n", zone, zone, zone, law->locking_stretch);
        fprintf(file, "Bi_%s i_%s 0 I=(1/tanh(max(V(i_%s),1m))-1/max(V(i_%s),1m)-V(y_%s))*1m\n", zone, zone, zone, zone,
                zone);
        write_guess(file, "i", zone, chain * (3.0 - chain * chain) / (1.0 - chain * chain));
        break;
    default:
        fprintf(file, "%.17g\n", 0.5e-6 * law->mu);
    }
}

/* ---- branches ---- */

/* A state y of time constant tau: C dy/dt = I with C = tau times the scale current. */
static void write_state(FILE *file, const char *name, double time_constant) {
    fprintf(file, "C%s %s 0 %.17g\n", name, name, SCALE_CURRENT * time_constant);
}

static void write_foo(FILE *file, const struct dea_device *device, int k, int b) {
    const struct dea_branch *branch = &device->material.branches[b];
    char z[32], first[48], second[48];
    snprintf(z, sizeof z, "%s%d", dea_zone_names[k], b + 1);
    snprintf(first, sizeof first, "xi1_%s", z);
    snprintf(second, sizeof second, "xi2_%s", z);
    /* squared elastic stretches g1, g2 and g3, stresses over mu_b at s1, s2 */
    double lp1 = device->prestretch[0];
    fprintf(file, "Bg1_%s g1_%s 0 V=lam(V(s_%s))*lam(V(s_%s))/(%.17g*(1+V(%s))*(1+V(%s)))\n", z, z, dea_zone_names[k],
            dea_zone_names[k], lp1 * lp1, first, first);
    fprintf(file, "Bg2_%s g2_%s 0 V=1/((1+V(%s))*(1+V(%s)))\n", z, z, second, second);
    char soft[320] = "1";
    if (!isinf(branch->jm))
        snprintf(soft, sizeof soft, "max(1-(V(g1_%s)+V(g2_%s)+1/(lam(V(g1_%s))*lam(V(g2_%s)))-3)/%.17g,1e-6)", z, z, z,
                 z, branch->jm);
    fprintf(file, "Bs1_%s s1_%s 0 V=(V(g1_%s)-1/(lam(V(g1_%s))*lam(V(g2_%s))))/(%s)\n", z, z, z, z, z, soft);
    fprintf(file, "Bs2_%s s2_%s 0 V=(V(g2_%s)-1/(lam(V(g1_%s))*lam(V(g2_%s))))/(%s)\n", z, z, z, z, z, soft);
    fprintf(file, "Bx1_%s 0 %s I=%.17g*(1+V(%s))*(V(s1_%s)-0.5*V(s2_%s))/3\n", z, first, SCALE_CURRENT, first, z, z);
    fprintf(file, "Bx2_%s 0 %s I=%.17g*(1+V(%s))*(V(s2_%s)-0.5*V(s1_%s))/3\n", z, second, SCALE_CURRENT, second, z, z);
    write_state(file, first, branch->tau);
    write_state(file, second, branch->tau);
}

static void write_network(FILE *file, const struct dea_device *device, int k, int b) {
    const struct dea_branch *branch = &device->material.branches[b];
    char z[32], first[48], second[48], r[160];
    snprintf(z, sizeof z, "%s%d", dea_zone_names[k], b + 1);
    snprintf(first, sizeof first, "a1_%s", z);
    snprintf(second, sizeof second, "a3_%s", z);
    /* r: square of lam1/lp1 */
    snprintf(r, sizeof r, "(lam(V(s_%s))*lam(V(s_%s))/%.17g)", dea_zone_names[k], dea_zone_names[k],
             device->prestretch[0] * device->prestretch[0]);
    fprintf(file, "Bs1_%s s1_%s 0 V=%s*(1+V(%s))-(1+V(%s))/%s\n", z, z, r, first, second, r);
    fprintf(file, "Bx1_%s 0 %s I=%.17g*(1/%s-1-V(%s))\n", z, first, SCALE_CURRENT, r, first);
    fprintf(file, "Bx2_%s 0 %s I=%.17g*(%s-1-V(%s))\n", z, second, SCALE_CURRENT, r, second);
    write_state(file, first, branch->tau);
    write_state(file, second, branch->tau);
}

/* ---- a zone ---- */

/* Electric pull as nominal stress in MPa: (V^2/2) dC/dlam over the volume. */
static void write_maxwell(FILE *file, const struct dea_device *device, int k, int port) {
    const struct dea_dielectric *d = &device->material.dielectric;
    double lp1 = device->prestretch[0], h = device->thickness * lp1;
    double factor = 1e-6 * 0.5 * DEA_VACUUM_PERMITTIVITY * 1e6 / (h * h); /* volts in kV */
    fprintf(file, "Bm_%s m_%s 0 V=%.17g*V(f%d,n%d)*V(f%d,n%d)*1u*lam(V(s_%s))*(%.17g+%.17g*lam(V(s_%s)))\n",
            dea_zone_names[k], dea_zone_names[k], factor, port, port, port, port, dea_zone_names[k],
            2.0 * d->permittivity, 3.0 * d->permittivity_slope, dea_zone_names[k]);
}

static void write_electrode(FILE *file, const struct dea_device *device, int k, int port) {
    const struct dea_zone *zone = &device->zones[k];
    const struct dea_dielectric *d = &device->material.dielectric;
    const char *name = dea_zone_names[k];
    double lp1 = device->prestretch[0], unit = 1e3 * zone->rest_capacitance;
    double rest = d->permittivity + d->permittivity_slope * lp1;
    if (zone->sheet_resistance > 0.0) {
        double sheet = 2.0 * zone->sheet_resistance / 3.0, aspect = zone->length / (lp1 * device->width);
        fprintf(file, "Br_%s p%d f%d I=V(p%d,f%d)/(%.17g+%.17g*", name, port, port, port, port,
                zone->electrode_resistance, sheet);
        fprintf(file, zone->feed == DEA_FEED_LONG_EDGE ? "%.17g*lam(V(s_%s)))\n" : "1/(%.17g*lam(V(s_%s))))\n", aspect,
                name);
    } else if (zone->electrode_resistance > 0.0) {
        fprintf(file, "R_%s p%d f%d %.17g\n", name, port, port, zone->electrode_resistance);
    } else {
        fprintf(file, "V_%s p%d f%d 0\n", name, port, port);
    }
    /* charge in units of C0 1 kV: current of an inductor whose voltage is dQ/dt */
    fprintf(file, "Bq_%s 0 q_%s I=V(f%d,n%d)*1m*lam(V(s_%s))*lam(V(s_%s))*(%.17g+%.17g*lam(V(s_%s)))/%.17g\n", name,
            name, port, port, name, name, d->permittivity / rest, d->permittivity_slope / rest, name, lp1 * lp1);
    fprintf(file, "Lq_%s q_%s 0 %.17g\nGq_%s f%d n%d q_%s 0 1\n", name, name, unit, name, port, port, name);
    if (d->conductivity > 0.0) {
        double ohmic = d->conductivity * device->width * zone->length / (lp1 * lp1 * device->thickness);
        fprintf(file, "Bj_%s f%d n%d I=%.17g*V(f%d,n%d)*lam(V(s_%s))*lam(V(s_%s))", name, port, port, ohmic, port, port,
                name, name);
        if (!isinf(d->conductivity_field))
            fprintf(file, "*exp(min(60,abs(V(f%d,n%d))*lam(V(s_%s))*%.17g))", port, port, name,
                    1.0 / (device->thickness * lp1 * d->conductivity_field));
        fputc('\n', file);
    }
    write_maxwell(file, device, k, port);
}

static void write_zone(FILE *file, const struct dea_device *device, int k, int port) {
    const struct dea_material *material = &device->material;
    const struct dea_zone *zone = &device->zones[k];
    const char *name = dea_zone_names[k];
    fprintf(file, "* ---- %s zone\n", name);
    fprintf(file, "Ba_%s a_%s 0 V=%.17g+%.17g*V(x)\n", name, name, device->prestretch[0],
            device->prestretch[0] * zone->side * 1e-3 / zone->length);
    write_law(file, device, k);
    if (zone->electroded)
        write_electrode(file, device, k, port);
    for (int b = 0; b < material->branch_count; b++) {
        if (material->branches[b].kind == DEA_BRANCH_FOO)
            write_foo(file, device, k, b);
        else
            write_network(file, device, k, b);
    }
    fprintf(file, "Bn_%s net_%s 0 V=V(w_%s)", name, name, name);
    for (int b = 0; b < material->branch_count; b++)
        fprintf(file, "\n+ + %.17g*V(s1_%s%d)/lam(V(s_%s))", 1e-6 * material->branches[b].mu, name, b + 1, name);
    fprintf(file, zone->electroded ? "\n+ - V(m_%s)\n" : "\n", name);

    /* stretch: geometric (a), or where the net stress vanishes if that is longer: min(s - a, net) = 0; never below what
     * makes sense, so that a wild iterate stays finite */
    double modulus = 1e-6 * dea_law_modulus(&material->elastic), lp1 = device->prestretch[0];
    if (device->slack)
        fprintf(file, "Bs_%s s_%s 0 I=1m*min(V(s_%s)-V(a_%s),V(net_%s)/%.17g)\n", name, name, name, name, name,
                modulus);
    else
        fprintf(file, "Es_%s s_%s 0 a_%s 0 1\n", name, name, name);
    double section = 1e6 * device->width * device->thickness * lp1;
    fprintf(file, device->slack ? "Bt_%s t_%s 0 V=%.17g*max(V(net_%s),0)\n" : "Bt_%s t_%s 0 V=%.17g*V(net_%s)\n", name,
            name, section, name);
    write_guess(file, "s", name, lp1);
}

/* ---- the platform ---- */

static void write_platform(FILE *file, const struct dea_device *device) {
    double k = device->stiffness, m = device->effective_mass, c = device->damping;
    fprintf(file, "* ---- platform: force in N at node force\nBf force 0 V=%.17g+V(load)", device->load);
    for (int i = 0; i < DEA_ZONES; i++)
        if (device->zones[i].present)
            fprintf(file, "%sV(t_%s)", device->zones[i].side > 0.0 ? "-" : "+", dea_zone_names[i]);
    if (device->has_stops)
        fprintf(file, "\n+ -%.17g*max(V(x)*1m-%.17g,0)+%.17g*max(%.17g-V(x)*1m,0)", device->stop_stiffness,
                device->stops[1], device->stop_stiffness, device->stops[0]);
    fputc('\n', file);
    fprintf(file, ".nodeset v(x)=0\n%s", m > 0.0 ? ".nodeset v(vel)=0\n" : "");
    fprintf(file, "Epos pos 0 x 0 1\n"); /* the pin may be loaded, the state must not be */
    double per_mm = SCALE_CURRENT / (k * 1e-3);
    if (m > 0.0) {
        double omega = sqrt(k / m);
        fprintf(file, "Bx 0 x I=%.17g*V(vel)\n", SCALE_CURRENT);
        write_state(file, "x", 1.0 / omega);
        fprintf(file, "Bv 0 vel I=%.17g*V(force)-%.17g*V(vel)\n", per_mm, SCALE_CURRENT * c * omega / k);
        write_state(file, "vel", 1.0 / omega);
    } else {
        fprintf(file, "Bx 0 x I=%.17g*V(force)\n", per_mm);
        if (c > 0.0)
            write_state(file, "x", c / k);
    }
}

static void write_device(FILE *file, const char *name, const struct dea_device *device, bool load_pin) {
    int zones[DEA_ZONES], ports = coupled_order_ports(device, zones);
    fprintf(file, "\n.subckt %s", name);
    for (int p = 0; p < ports; p++)
        fprintf(file, " p%d n%d", p, p);
    fprintf(file, " pos%s\n", load_pin ? " load" : "");
    fprintf(file, ".func lam(v)={max(v,0.05)}\n");
    if (!load_pin)
        fprintf(file, "Vload load 0 0\n");
    for (int k = 0; k < DEA_ZONES; k++) {
        if (!device->zones[k].present)
            continue;
        int port = 0;
        while (port < ports && zones[port] != k)
            port++;
        write_zone(file, device, k, port);
    }
    write_platform(file, device);
    fprintf(file, ".ends\n");
}

/* ---- native sources ---- */

/* A piecewise linear list; jumps become ramps of a millionth of the run. */
static void write_points(FILE *file, const struct dea_waveform *w, double stop) {
    double edge = 1e-7 * stop, last = -1.0;
    fputs("PWL(", file);
    for (size_t i = 0; i < w->point_count; i++) {
        double t = w->times[i] > last ? w->times[i] : last + edge;
        fprintf(file, "%s%.17g %.17g", i % 4 == 3 ? "\n+ " : " ", t, w->values[i]);
        last = t;
    }
    fputs(w->repeat ? ") r=0" : ")", file);
}

static enum dea_status write_waveform(FILE *file, const struct dea_waveform *w, double stop, struct dea_error *error) {
    double edge = 1e-7 * stop, rise = fmax(w->rise, edge), fall = fmax(w->fall, edge);
    switch (w->kind) {
    case DEA_WAVE_DC:
        fprintf(file, "DC %.17g\n", w->level);
        return DEA_OK;
    case DEA_WAVE_PULSE:
    case DEA_WAVE_TRAPEZOID:
        fprintf(file, "PULSE(%.17g %.17g %.17g %.17g %.17g %.17g %.17g)\n", w->low, w->high, w->delay, rise, fall,
                w->width, w->period > 0.0 ? w->period : 1e3 * stop + w->delay + rise + fall + w->width);
        return DEA_OK;
    case DEA_WAVE_PWL:
        write_points(file, w, stop);
        fputc('\n', file);
        return DEA_OK;
    case DEA_WAVE_SINE:
        fprintf(file, "SIN(%.17g %.17g %.17g %.17g %.17g %.17g)\n", w->offset, w->amplitude, w->frequency, w->delay,
                w->decay, w->phase * 180.0 / M_PI);
        return DEA_OK;
    default:
        return dea_fail(error, DEA_ERR_INPUT,
                        "a chirp has no counterpart among ngspice's sources; export it as a file waveform");
    }
}

static enum dea_status write_native_drive(FILE *file, const struct dea_scene *scene, struct dea_error *error) {
    const struct dea_device *device = &scene->devices[0].device;
    int zones[DEA_ZONES], ports = coupled_order_ports(device, zones);
    fprintf(file, "Xdea");
    for (int p = 0; p < ports; p++)
        fprintf(file, " %s 0", dea_zone_names[zones[p]]);
    fprintf(file, " pos%s %s\n", scene->has_load_waveform ? " load" : "", scene->devices[0].name);
    for (int p = 0; p < ports; p++) {
        const char *name = dea_zone_names[zones[p]];
        const struct dea_source *source = &scene->sources[zones[p]];
        if (source->amplified)
            return dea_fail(error, DEA_ERR_INPUT, "%s: drive.%s: an amplifier is not exported; model it in a netlist",
                            scene->path, name);
        fprintf(file, "V%s %s%s 0 ", name, source->resistance > 0.0 ? "src_" : "", name);
        if (source->present)
            DEA_TRY(write_waveform(file, &source->waveform, scene->stop, error));
        else
            fputs("DC 0\n", file);
        if (source->resistance > 0.0)
            fprintf(file, "R%s src_%s %s %.17g\n", name, name, name, source->resistance);
    }
    if (scene->has_load_waveform) {
        fputs("Vload load 0 ", file);
        DEA_TRY(write_waveform(file, &scene->load, scene->stop, error));
    }
    return DEA_OK;
}

/* ---- the deck ---- */

static enum dea_status write_deck(const struct dea_scene *scene, const struct dea_netlist *netlist, double stop,
                                  FILE *file, struct dea_error *error) {
    fprintf(file, "%s\n* written by deasim export; events and the stops' impact losses are left out\n",
            scene->title != NULL ? scene->title : "deasim");
    for (int i = 1; netlist != NULL && i < netlist->line_count; i++)
        if (netlist->lines[i].passed)
            fprintf(file, "%s\n", netlist->lines[i].text);
    if (netlist == NULL)
        DEA_TRY(write_native_drive(file, scene, error));
    for (int d = 0; d < scene->device_count; d++)
        write_device(file, scene->devices[d].name, &scene->devices[d].device, scene->has_load_waveform);
    double step = stop / 1000.0, longest = step;
    if (netlist != NULL && netlist->tran.step > 0.0)
        step = netlist->tran.step;
    if (netlist != NULL && netlist->tran.max_step > 0.0)
        longest = netlist->tran.max_step;
    fprintf(file, "\n.save all\n.tran %.17g %.17g 0 %.17g%s\n", step, stop, fmin(longest, stop / 1000.0),
            netlist != NULL && netlist->tran.uic ? " uic" : "");
    /* one column, so that batch mode without a raw file has something to print */
    if (netlist == NULL)
        fprintf(file, ".print tran v(pos)\n");
    else
        fprintf(
            file, ".print tran v(%s)\n",
            netlist->instances[0].nodes[2 * coupled_order_ports(&scene->devices[netlist->instances[0].device].device,
                                                                (int[DEA_ZONES]){0})]);
    fprintf(file, ".end\n");
    return ferror(file) ? dea_fail(error, DEA_ERR_OUTPUT, "the deck could not be written") : DEA_OK;
}

enum dea_status dea_export_scene(const struct dea_scene *scene, bool trust_netlist, FILE *file,
                                 struct dea_error *error) {
    if (scene->start != DEA_START_EQUILIBRIUM || scene->has_initial_x || scene->has_initial_v)
        return dea_fail(error, DEA_ERR_INPUT, "%s: initial: plain ngspice starts from the equilibrium only",
                        scene->path);
    struct dea_netlist netlist = {0};
    double stop = scene->stop;
    enum dea_status status = DEA_OK;
    if (scene->netlist != NULL) {
        status = cosim_read_netlist(scene, trust_netlist, &netlist, error);
        if (status == DEA_OK)
            status = cosim_choose_stop(scene, &netlist, &stop, error);
    }
    if (status == DEA_OK)
        status = write_deck(scene, scene->netlist != NULL ? &netlist : NULL, stop, file, error);
    dea_netlist_clear(&netlist);
    return status;
}
