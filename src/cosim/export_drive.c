/* Native sources, their amplifiers and the load as ngspice's own sources. */
#include "cosim/coupled.h"
#include "cosim/export_internal.h"

#include <math.h>
#include <string.h>

#define STEPS_PER_PERIOD 50.0
#define MOST_POINTS 20000.0
/* An amplifier that only names its slew rate gets the pole the integrator gives it: see plant/layout.c. */
#define FREE_POLE_RATIO 20.0

/* ---- waveforms ---- */

/* A piecewise linear list; jumps become short ramps. Repetitions are written out as long as they are few: ngspice stops
 * at the corners of the first one only. */
static void write_points(FILE *file, const struct dea_waveform *w, double stop) {
    double edge = EXPORT_EDGE * stop, period = w->times[w->point_count - 1] - w->times[0];
    double periods = w->repeat ? floor(fmax(stop - w->times[0], 0.0) / period) + 1.0 : 1.0;
    bool written_out = periods * (double)w->point_count <= MOST_POINTS;
    double last = -1.0, value = 0.0;
    size_t count = 0;
    fputs("PWL(", file);
    for (double k = 0.0; k < (written_out ? periods : 1.0); k++)
        for (size_t i = 0; i < w->point_count; i++) {
            double t = w->times[i] + k * period;
            if (t <= last && w->values[i] == value)
                continue;
            t = fmax(t, last < 0.0 ? 0.0 : last + edge);
            fprintf(file, "%s%.17g %.17g", ++count % 4 == 0 ? "\n+ " : " ", t, w->values[i]);
            last = t;
            value = w->values[i];
        }
    if (written_out)
        fputs(")\n", file);
    else
        fprintf(file, ") r=%.17g\n", w->times[0]);
}

static void write_pulse(FILE *file, const struct dea_waveform *w, double stop) {
    double edge = EXPORT_EDGE * stop, rise = fmax(w->rise, edge), fall = fmax(w->fall, edge);
    double width = fmin(w->width, 1e3 * stop), period = w->period;
    if (w->kind == DEA_WAVE_TRAPEZOID && w->repeat)
        period = w->rise + w->width + w->fall + w->gap;
    if (!(period > 0.0)) /* a single one */
        period = 1e3 * stop + w->delay + rise + fall + width;
    fprintf(file, "PULSE(%.17g %.17g %.17g %.17g %.17g %.17g %.17g)\n", w->low, w->high, w->delay, rise, fall, width,
            period);
}

/* How long the waveform has been in its sweep, and past it, as the voltages of two sources, which stop ngspice at the
 * corners. */
static void write_chirp(FILE *file, const char *name, const char *node, const struct dea_waveform *w, double stop) {
    double swept = w->delay + w->duration, end = swept + fmax(stop, w->duration);
    const char *rest = w->delay > 0.0 ? "0 0 " : "";
    fprintf(file, "Vsweep_%s sweep_%s 0 PWL(%s%.17g 0 %.17g %.17g)\n", name, name, rest, w->delay, swept, w->duration);
    fprintf(file, "Vheld_%s held_%s 0 PWL(0 0 %.17g 0 %.17g %.17g)\n", name, name, swept, end, end - swept);
    fprintf(file, "B%s %s 0 V=%.17g+%.17g*sin(%.17g+2*pi*(V(sweep_%s)*(%.17g+%.17g*V(sweep_%s))+%.17g*V(held_%s)))\n",
            name, node, w->offset, w->amplitude, w->phase, name, w->frequency,
            0.5 * (w->frequency_end - w->frequency) / w->duration, name, w->frequency_end, name);
}

void export_source(FILE *file, const char *name, const char *node, const struct dea_waveform *w, double stop) {
    if (w->kind == DEA_WAVE_CHIRP) {
        write_chirp(file, name, node, w, stop);
        return;
    }
    fprintf(file, "V%s %s 0 ", name, node);
    switch (w->kind) {
    case DEA_WAVE_PULSE:
    case DEA_WAVE_TRAPEZOID:
        write_pulse(file, w, stop);
        return;
    case DEA_WAVE_PWL:
        write_points(file, w, stop);
        return;
    case DEA_WAVE_SINE:
        fprintf(file, "SIN(%.17g %.17g %.17g %.17g %.17g %.17g)\n", w->offset, w->amplitude, w->frequency, w->delay,
                w->decay, w->phase * 180.0 / M_PI);
        return;
    default:
        fprintf(file, "DC %.17g\n", w->level);
    }
}

double export_value_at_rest(const struct dea_waveform *w) {
    switch (w->kind) {
    case DEA_WAVE_PULSE:
    case DEA_WAVE_TRAPEZOID:
        return w->low;
    case DEA_WAVE_PWL:
        return w->values[0];
    default:
        return dea_waveform_value(w, 0.0);
    }
}

static double step_of(const struct dea_waveform *w) {
    if (w->kind == DEA_WAVE_SINE)
        return 1.0 / (STEPS_PER_PERIOD * w->frequency);
    if (w->kind == DEA_WAVE_CHIRP)
        return 1.0 / (STEPS_PER_PERIOD * fmax(w->frequency, w->frequency_end));
    return INFINITY;
}

double export_native_step(const struct dea_scene *scene) {
    double step = scene->has_load_waveform ? step_of(&scene->load) : INFINITY;
    for (int k = 0; k < DEA_ZONES; k++)
        if (scene->sources[k].present)
            step = fmin(step, step_of(&scene->sources[k].waveform));
    return step;
}

/* ---- amplifiers ---- */

/* Node u_NAME, in kV, follows cmd_NAME at the slew rate at most. */
static void write_slewing(FILE *file, const char *name, const struct dea_source *source) {
    const struct dea_amplifier *amplifier = &source->amplifier;
    double pole = isinf(amplifier->bandwidth)
                      ? FREE_POLE_RATIO * amplifier->slew_rate / fmax(dea_waveform_peak(&source->waveform), 1.0)
                      : 2.0 * M_PI * amplifier->bandwidth;
    char node[16];
    snprintf(node, sizeof node, "u_%s", name);
    if (isinf(amplifier->slew_rate)) {
        fprintf(file, "B%s 0 %s I=%.17g*(V(cmd_%s)*1m-V(%s))\n", node, node, EXPORT_SCALE_CURRENT, name, node);
    } else {
        double reach = 1e-3 * amplifier->slew_rate / pole; /* kV: further behind the command, the slew rate rules */
        fprintf(file, "B%s 0 %s I=%.17g*min(max(V(cmd_%s)*1m-V(%s),%.17g),%.17g)\n", node, node, EXPORT_SCALE_CURRENT,
                name, node, -reach, reach);
    }
    export_state(file, node, 1.0 / pole);
    fprintf(file, ".nodeset v(%s)=%.17g\nEemf_%s emf_%s 0 %s 0 1k\n", node,
            1e-3 * export_value_at_rest(&source->waveform), name, name, node);
}

/* Current from emf_NAME into the electrode, within the limit. The film's own resistance counts, so that there may be no
 * other. */
static void write_limited(FILE *file, const struct dea_device *device, int k, int port,
                          const struct dea_source *source) {
    const char *name = dea_zone_names[k];
    const struct dea_zone *zone = &device->zones[k];
    double limit = source->amplifier.current_limit;
    fprintf(file, "Bout_%s 0 %s I=min(max((V(emf_%s)-V(xdea.f%d))/(%.17g", name, name, name, port,
            source->resistance + source->amplifier.output_resistance + zone->electrode_resistance);
    if (zone->sheet_resistance > 0.0) {
        double sheet = 2.0 * zone->sheet_resistance / 3.0,
               aspect = zone->length / (device->prestretch[0] * device->width);
        fprintf(file, zone->feed == DEA_FEED_LONG_EDGE ? "+%.17g*V(xdea.s_%s)" : "+%.17g/V(xdea.s_%s)",
                zone->feed == DEA_FEED_LONG_EDGE ? sheet * aspect : sheet / aspect, name);
    }
    fprintf(file, "),%.17g),%.17g)\n.nodeset v(%s)=%.17g\n", -limit, limit, name,
            export_value_at_rest(&source->waveform));
}

static void write_amplifier(FILE *file, const struct dea_device *device, int k, int port,
                            const struct dea_source *source) {
    const struct dea_amplifier *amplifier = &source->amplifier;
    const char *name = dea_zone_names[k];
    double resistance = source->resistance + amplifier->output_resistance;
    if (isinf(amplifier->bandwidth) && isinf(amplifier->slew_rate))
        fprintf(file, "Vemf_%s emf_%s cmd_%s 0\n", name, name, name);
    else
        write_slewing(file, name, source);
    if (!isinf(amplifier->current_limit))
        write_limited(file, device, k, port, source);
    else if (resistance > 0.0)
        fprintf(file, "R%s emf_%s %s %.17g\n", name, name, name, resistance);
    else
        fprintf(file, "Vout_%s emf_%s %s 0\n", name, name, name);
}

/* ---- the drive ---- */

static void write_electrode_drive(FILE *file, const struct dea_scene *scene, int k, int port, double stop) {
    const struct dea_source *source = &scene->sources[k];
    const char *name = dea_zone_names[k];
    char node[16];
    if (!source->present) {
        fprintf(file, "V%s %s 0 DC 0\n", name, name);
        return;
    }
    snprintf(node, sizeof node, "%s%s", source->amplified ? "cmd_" : source->resistance > 0.0 ? "src_" : "", name);
    export_source(file, name, node, &source->waveform, stop);
    if (source->amplified)
        write_amplifier(file, &scene->devices[0].device, k, port, source);
    else if (source->resistance > 0.0)
        fprintf(file, "R%s src_%s %s %.17g\n", name, name, name, source->resistance);
}

void export_native_drive(FILE *file, const struct dea_scene *scene, double stop) {
    int zones[DEA_ZONES], ports = coupled_order_ports(&scene->devices[0].device, zones);
    fprintf(file, "Xdea");
    for (int p = 0; p < ports; p++)
        fprintf(file, " %s 0", dea_zone_names[zones[p]]);
    fprintf(file, " pos %s\n", scene->devices[0].name);
    for (int p = 0; p < ports; p++)
        write_electrode_drive(file, scene, zones[p], p, stop);
}
