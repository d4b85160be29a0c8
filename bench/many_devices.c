/* One netlist with 1, 4, 16 and 64 devices, and the same netlist with fixed capacitors in their place run by plain
 * ngspice: does time grow as the circuit's own? In mode linear, which is for one device, the circuit grows instead.
 * usage: many_devices PROGRAM FIXED_CAPACITOR DEVICE FOLDER TABLE; the table is CSV */
#include "process.h"
#include "text.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { PATH_ROOM = 1024, ROUNDS = 3 };

#define LONG_RUN 3.0 /* s: not repeated */
#define LIMIT 1800.0 /* s of processor time for one run */

/* ---- circuits ---- */

static void write_device(FILE *file, int i, const char *pin) {
    fprintf(file, "Xd%d %s 0 r%d 0 pos%d DEA\nRr%d r%d 0 1k\n", i, pin, i, i, i, i);
}

static const char diode_model[] = ".model dhv D(is=1e-12 n=2 rs=10 cjo=1p bv=10k)\n";

/* All charged by the same pulses, each through its own resistor and diode. */
static void write_together(FILE *file, int count) {
    fprintf(file, "Vs s 0 PULSE(0 2500 1m 1m 1m 20m 40m)\n%s", diode_model);
    for (int i = 0; i < count; i++) {
        char pin[16];
        snprintf(pin, sizeof pin, "l%d", i);
        fprintf(file, "R%d s a%d 1meg\nD%d a%d l%d dhv\nRl%d l%d 0 50meg\n", i, i, i, i, i, i, i);
        write_device(file, i, pin);
    }
}

/* Each at its own instants: what happens to one of them costs all of them a point of the circuit. */
static void write_apart(FILE *file, int count) {
    fputs(diode_model, file);
    for (int i = 0; i < count; i++) {
        char pin[16];
        snprintf(pin, sizeof pin, "l%d", i);
        fprintf(file, "Vs%d s%d 0 PULSE(0 2500 %du 1m 1m %du 40m)\n", i, i, 1000 + 300 * i, 20000 - 170 * i);
        fprintf(file, "R%d s%d a%d 1meg\nD%d a%d l%d dhv\nRl%d l%d 0 50meg\n", i, i, i, i, i, i, i, i);
        write_device(file, i, pin);
    }
}

/* One device at the end of a ladder of R and C, 1 MOhm and 100 pF in all. */
static void write_ladder(FILE *file, int count) {
    char pin[16] = "n0";
    fputs("Vs n0 0 PULSE(0 2500 1m 1m 1m 20m 40m)\n", file);
    for (int i = 1; i <= count; i++) {
        fprintf(file, "R%d n%d n%d %.17g\nC%d n%d 0 %.17g\n", i, i - 1, i, 1e6 / count, i, i, 1e-10 / count);
        snprintf(pin, sizeof pin, "n%d", i);
    }
    write_device(file, 0, pin);
}

struct family {
    const char *name, *title, *counted, *mode;
    void (*write)(FILE *file, int count);
    double stop; /* s */
};

static const struct family families[] = {
    {"together", "devices behind a diode each, on one source", "devices", "cosim", write_together, 0.4},
    {"apart", "devices behind a diode each, all at instants of their own", "devices", "cosim", write_apart, 0.1},
    {"ladder", "one device behind a ladder of R and C", "sections", "linear", write_ladder, 0.4},
};

static FILE *create(const char *path) {
    FILE *file = fopen(path, "w");
    if (file == NULL) {
        perror(path);
        exit(2);
    }
    return file;
}

static void finish(FILE *file, const char *path) {
    if (ferror(file) || fclose(file) != 0) {
        perror(path);
        exit(2);
    }
}

static void write_scene(const struct family *family, int count, const char *device, const char *folder, char *scene) {
    char netlist[PATH_ROOM];
    snprintf(netlist, sizeof netlist, "%s/%s%d.cir", folder, family->name, count);
    snprintf(scene, PATH_ROOM, "%s/%s%d.yaml", folder, family->name, count);
    FILE *file = create(netlist);
    fprintf(file, "%s\n", family->title);
    family->write(file, count);
    fputs(".end\n", file);
    finish(file, netlist);
    file = create(scene);
    fprintf(file, "title: %d %s\ndevice: %s\ndrive: {netlist: %s%d.cir}\ntransient: {stop: %g s}\n", count,
            family->counted, device, family->name, count, family->stop);
    fputs("events: {breakdown: warn, slack: warn}\n", file);
    finish(file, scene);
}

/* ---- runs ---- */

struct cost {
    double cpu;    /* s, user and system */
    double memory; /* MB, largest resident set of one process */
};

/* Runs a command with stdout into a file (NULL: thrown away); a failure ends the benchmark. */
static struct cost run_once(char *const *arguments, const char *output) {
    struct process_result result = process_run(arguments, output, LIMIT);
    if (!result.good) {
        fprintf(stderr, "%s failed: %s\n", arguments[0], result.timed_out ? "took too long" : result.message);
        exit(3);
    }
    return (struct cost){result.cpu, result.memory};
}

/* The best of some rounds. */
static struct cost run(char *const *arguments, const char *output) {
    struct cost best = run_once(arguments, output);
    for (int round = 1; round < ROUNDS && best.cpu < LONG_RUN; round++)
        best.cpu = fmin(best.cpu, run_once(arguments, output).cpu);
    return best;
}

static double read_number(const char *summary, const char *key) {
    char wanted[64];
    snprintf(wanted, sizeof wanted, "\"%s\":", key);
    const char *at = strstr(summary, wanted);
    return at != NULL ? strtod(at + strlen(wanted), NULL) : NAN;
}

static void measure(const struct family *family, int count, char **arguments, FILE *table) {
    char *program = arguments[1], *capacitor = arguments[2], *folder = arguments[4];
    char scene[PATH_ROOM], summary[PATH_ROOM], deck[PATH_ROOM], raw[PATH_ROOM], mode[32];
    write_scene(family, count, arguments[3], folder, scene);
    snprintf(summary, sizeof summary, "%s/summary.json", folder);
    snprintf(deck, sizeof deck, "%s/fixed.cir", folder);
    snprintf(raw, sizeof raw, "%s/fixed.raw", folder); /* not /dev/null: ngspice deletes a raw file in the end */
    struct cost coupled = run((char *[]){program, "run", scene, "--quiet", "--json", NULL}, summary);
    run_once((char *[]){capacitor, scene, "1e-4", deck, NULL}, NULL);
    struct cost alone = run((char *[]){"ngspice", "-b", "-r", raw, deck, NULL}, NULL);
    remove(raw);
    char *text = read_text(summary);
    if (text == NULL) {
        perror(summary);
        exit(3);
    }
    snprintf(mode, sizeof mode, "\"mode\":\t\"%s\"", family->mode);
    if (strstr(text, mode) == NULL) {
        fprintf(stderr, "%s: the mode of the run is not %s\n", scene, family->mode);
        exit(3);
    }
    double points = read_number(text, "circuit_points"), steps = read_number(text, "plant_steps");
    free(text);
    printf("%8d %10.0f %10.0f %10.3f %10.3f %8.1f %8.1f\n", count, points, steps, coupled.cpu, alone.cpu,
           coupled.cpu / alone.cpu, coupled.memory);
    fflush(stdout);
    fprintf(table, "%s,%d,%.0f,%.0f,%.3f,%.3f,%.1f,%.1f\n", family->name, count, points, steps, coupled.cpu, alone.cpu,
            coupled.cpu / alone.cpu, coupled.memory);
}

int main(int count, char **arguments) {
    if (count != 6) {
        fprintf(stderr, "usage: many_devices PROGRAM FIXED_CAPACITOR DEVICE FOLDER TABLE\n");
        return 2;
    }
    FILE *table = create(arguments[5]);
    fputs("family,count,circuit_points,device_steps,coupled_cpu_s,circuit_alone_cpu_s,ratio,memory_mb\n", table);
    for (size_t f = 0; f < sizeof families / sizeof families[0]; f++) {
        printf("\n%s, %g s, mode %s\n%8s %10s %10s %10s %10s %8s %8s\n", families[f].title, families[f].stop,
               families[f].mode, families[f].counted, "points", "steps", "coupled s", "alone s", "ratio", "MB");
        for (int devices = 1; devices <= 64; devices *= 4)
            measure(&families[f], devices, arguments, table);
    }
    finish(table, arguments[5]);
    return 0;
}
