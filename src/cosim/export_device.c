/* A device as a behavioural subcircuit: displacement in mm, velocity in mm times the natural frequency, charge in units
 * of rest capacitance times 1 kV, branch states relative to the prestretch. */
#include "cosim/coupled.h"
#include "cosim/export_internal.h"

#include <math.h>
#include <string.h>

/* What a node that no voltage source defines is at rest: ngspice's operating point starts there; without operating
 * point the run does. */
static void write_guess(FILE *file, const char *node, const struct export_start *start, double value) {
    fprintf(file, "%s v(%s)=%.17g\n", start->uic ? ".ic" : ".nodeset", node, value);
}

static void write_initial(FILE *file, const char *node, double value) {
    fprintf(file, ".ic v(%s)=%.17g\n", node, value);
}

/* ---- the elastic law ---- */

/* W1 in MPa as an expression of V(lNAME), with I1 - 3 at node e where the law needs it. */
static void write_law(FILE *file, const struct dea_device *device, int k, const struct export_start *start) {
    const struct dea_law *law = &device->material.elastic;
    const char *zone = dea_zone_names[k];
    char node[16];
    double lam1 = start->stretch[k], lam2 = device->prestretch[1], b = 1.0 / (lam2 * lam2);
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
        snprintf(node, sizeof node, "i_%s", zone);
        write_guess(file, node, start, chain * (3.0 - chain * chain) / (1.0 - chain * chain));
        break;
    default:
        fprintf(file, "%.17g\n", 0.5e-6 * law->mu);
    }
}

/* ---- branches ---- */

/* C dy/dt = I with C = time constant times the scale current. */
void export_state(FILE *file, const char *name, double time_constant) {
    fprintf(file, "C%s %s 0 %.17g\n", name, name, EXPORT_SCALE_CURRENT * time_constant);
}

/* Both states of a branch: capacitors and where they start. */
static void write_branch_states(FILE *file, const struct dea_device *device, int k, int b, const char *const names[2],
                                const struct export_start *start) {
    const struct dea_branch *branch = &device->material.branches[b];
    double z[2];
    if (start->fresh)
        dea_branch_fresh(branch, device->prestretch, z);
    else
        dea_branch_relaxed(branch, device->prestretch, start->stretch[k], z);
    for (int i = 0; i < 2; i++) {
        export_state(file, names[i], branch->tau);
        if (start->fresh)
            write_initial(file, names[i], z[i]);
        else
            write_guess(file, names[i], start, z[i]);
    }
}

static void write_foo(FILE *file, const struct dea_device *device, int k, int b, const struct export_start *start) {
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
    fprintf(file, "Bx1_%s 0 %s I=%.17g*(1+V(%s))*(V(s1_%s)-0.5*V(s2_%s))/3\n", z, first, EXPORT_SCALE_CURRENT, first, z,
            z);
    fprintf(file, "Bx2_%s 0 %s I=%.17g*(1+V(%s))*(V(s2_%s)-0.5*V(s1_%s))/3\n", z, second, EXPORT_SCALE_CURRENT, second,
            z, z);
    write_branch_states(file, device, k, b, (const char *const[2]){first, second}, start);
}

static void write_network(FILE *file, const struct dea_device *device, int k, int b, const struct export_start *start) {
    char z[32], first[48], second[48], r[160];
    snprintf(z, sizeof z, "%s%d", dea_zone_names[k], b + 1);
    snprintf(first, sizeof first, "a1_%s", z);
    snprintf(second, sizeof second, "a3_%s", z);
    /* r: square of lam1/lp1 */
    snprintf(r, sizeof r, "(lam(V(s_%s))*lam(V(s_%s))/%.17g)", dea_zone_names[k], dea_zone_names[k],
             device->prestretch[0] * device->prestretch[0]);
    fprintf(file, "Bs1_%s s1_%s 0 V=%s*(1+V(%s))-(1+V(%s))/%s\n", z, z, r, first, second, r);
    fprintf(file, "Bx1_%s 0 %s I=%.17g*(1/%s-1-V(%s))\n", z, first, EXPORT_SCALE_CURRENT, r, first);
    fprintf(file, "Bx2_%s 0 %s I=%.17g*(%s-1-V(%s))\n", z, second, EXPORT_SCALE_CURRENT, r, second);
    write_branch_states(file, device, k, b, (const char *const[2]){first, second}, start);
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

static void write_electrode(FILE *file, const struct dea_device *device, int k, int port,
                            const struct export_start *start) {
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
    fprintf(file, "Lq_%s q_%s 0 %.17g", name, name, unit);
    if (start->uic)
        fprintf(file, " ic=%.17g", start->charge[k] / unit);
    fprintf(file, "\nGq_%s f%d n%d q_%s 0 1\n", name, port, port, name);
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

static void write_zone(FILE *file, const struct dea_device *device, int k, int port, const struct export_start *start) {
    const struct dea_material *material = &device->material;
    const struct dea_zone *zone = &device->zones[k];
    const char *name = dea_zone_names[k];
    fprintf(file, "* ---- %s zone\n", name);
    fprintf(file, "Ba_%s a_%s 0 V=%.17g+%.17g*V(x)\n", name, name, device->prestretch[0],
            device->prestretch[0] * zone->side * 1e-3 / zone->length);
    write_law(file, device, k, start);
    if (zone->electroded)
        write_electrode(file, device, k, port, start);
    for (int b = 0; b < material->branch_count; b++) {
        if (material->branches[b].kind == DEA_BRANCH_FOO)
            write_foo(file, device, k, b, start);
        else
            write_network(file, device, k, b, start);
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
    char node[16];
    snprintf(node, sizeof node, "s_%s", name);
    write_guess(file, node, start, start->stretch[k]);
}

/* ---- the platform ---- */

/* Hunt-Crossley contact, k d (1 + chi d'); node speed is the platform's in m/s. */
static void write_stops(FILE *file, const struct dea_device *device) {
    for (int i = 0; i < 2; i++) {
        const char *sign = i == 0 ? "+" : "-";
        fprintf(file, "\n+ %s%.17g*max(%s(%.17g-V(x)*1m),0)", sign, device->stop_stiffness, i == 0 ? "" : "-",
                device->stops[i]);
        if (device->stop_loss > 0.0)
            fprintf(file, "*(1%s%.17g*V(speed))", i == 0 ? "-" : "+", device->stop_loss);
    }
}

/* With mass: x and its velocity, in mm times the natural frequency. A given velocity is a step right after the
 * operating point, which knows rest only. */
static void write_inertia(FILE *file, const struct dea_device *device, const struct export_start *start) {
    double k = device->stiffness, omega = sqrt(k / device->effective_mass), per_mm = EXPORT_SCALE_CURRENT / (k * 1e-3);
    const char *velocity = start->v != 0.0 ? "(V(vel)+V(kick))" : "V(vel)";
    fprintf(file, "Bx 0 x I=%.17g*%s\n", EXPORT_SCALE_CURRENT, velocity);
    fprintf(file, "Bv 0 vel I=%.17g*V(force)-%.17g*%s\n", per_mm, EXPORT_SCALE_CURRENT * device->damping * omega / k,
            velocity);
    export_state(file, "x", 1.0 / omega);
    export_state(file, "vel", 1.0 / omega);
    if (start->v != 0.0)
        fprintf(file, "Vkick kick 0 PWL(0 0 %.17g %.17g)\n", start->kick, 1e3 * start->v / omega);
    if (device->has_stops && device->stop_loss > 0.0)
        fprintf(file, "Bspeed speed 0 V=%.17g*%s\n", 1e-3 * omega, velocity);
    if (start->has_x || start->uic)
        write_initial(file, "vel", 0.0);
    else
        write_guess(file, "vel", start, 0.0);
}

static void write_massless(FILE *file, const struct dea_device *device) {
    fprintf(file, "Bx 0 x I=%.17g*V(force)\n", EXPORT_SCALE_CURRENT / (device->stiffness * 1e-3));
    if (device->damping > 0.0)
        export_state(file, "x", device->damping / device->stiffness);
    if (device->has_stops && device->stop_loss > 0.0 && device->damping > 0.0)
        fprintf(file, "Bspeed speed 0 V=V(force)*%.17g\n", 1.0 / device->damping);
    else if (device->has_stops && device->stop_loss > 0.0)
        fprintf(file, "Vspeed speed 0 0\n"); /* a platform without mass and damping has no velocity of its own */
}

static void write_platform(FILE *file, const struct dea_device *device, const struct export_start *start) {
    fprintf(file, "* ---- platform: force in N at node force\nBf force 0 V=%.17g+V(load)", device->load);
    for (int i = 0; i < DEA_ZONES; i++)
        if (device->zones[i].present)
            fprintf(file, "%sV(t_%s)", device->zones[i].side > 0.0 ? "-" : "+", dea_zone_names[i]);
    if (device->has_stops)
        write_stops(file, device);
    fputc('\n', file);
    fprintf(file, "Epos pos 0 x 0 1\n"); /* the pin may be loaded, the state must not be */
    if (device->effective_mass > 0.0)
        write_inertia(file, device, start);
    else
        write_massless(file, device);
    if (start->has_x || start->uic)
        write_initial(file, "x", 1e3 * start->x);
    else
        write_guess(file, "x", start, 1e3 * start->x);
}

void export_device(FILE *file, const struct dea_scene *scene, int index, const struct export_start *start,
                   double stop) {
    const struct dea_device *device = &scene->devices[index].device;
    int zones[DEA_ZONES], ports = coupled_order_ports(device, zones);
    fprintf(file, "\n.subckt %s", scene->devices[index].name);
    for (int p = 0; p < ports; p++)
        fprintf(file, " p%d n%d", p, p);
    fprintf(file, " pos\n.func lam(v)={max(v,0.05)}\n");
    for (int k = 0; k < DEA_ZONES; k++) {
        if (!device->zones[k].present)
            continue;
        int port = 0;
        while (port < ports && zones[port] != k)
            port++;
        write_zone(file, device, k, port, start);
    }
    write_platform(file, device, start);
    if (scene->has_load_waveform)
        export_source(file, "load", "load", &scene->load, stop);
    else
        fprintf(file, "Vload load 0 0\n");
    fprintf(file, ".ends\n");
}
