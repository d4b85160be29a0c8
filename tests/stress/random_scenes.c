/* Random scenes from a seed, each run in a process of its own under limits. Allowed ends: done with the books closed to
 * the accuracy, displacement and port voltage confirmed by a run at a tenth of it, or the run's own word that it may
 * miss that; or exit 2 or 3 with a reason. Not allowed: a crash, a hang, a number that is none, a silent error.
 *
 * usage: random_scenes PROGRAM MODELS COUNT SEED [FOLDER [linear]]
 * prints the seeds that fail, then "N passed, N failed"; with `linear`, seeds whose netlist has diodes or switches are
 * left out */
#include "deasim/result.h"

#include <cjson/cJSON.h>
#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <signal.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#define ACCURACY 1e-3
#define TIME_LIMIT 30           /* s of processor time a run may take */
#define LEAST_X 1e-12           /* m: below it rounding of the films' length shows */
#define LEAST_V 1e-9            /* V */
#define MEMORY_LIMIT (4L << 30) /* bytes */

/* ---- chance ---- */

static uint64_t chance_state;

/* splitmix64 (Steele, Lea, Flood, 2014): the same numbers on every machine */
static double chance(void) {
    uint64_t z = (chance_state += 0x9e3779b97f4a7c15u);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return (double)((z ^ (z >> 31)) >> 11) / 9007199254740992.0;
}

static bool maybe(double probability) {
    return chance() < probability;
}

static double between(double low, double high) {
    return low + (high - low) * chance();
}

/* Evenly in the logarithm. */
static double magnitude(double low, double high) {
    return low * pow(high / low, chance());
}

static int pick(int count) {
    return (int)(chance() * count);
}

/* ---- a device ---- */

struct design {
    double thickness, stop, volts;
    bool zones[2], electrodes[2];
    bool nonlinear; /* netlist */
};

static void write_law(FILE *file) {
    static const char *const laws[] = {"{law: gent, mu: 0.365 MPa, jm: 16.6}", "{law: neo_hookean, mu: 0.3 MPa}",
                                       "{law: yeoh, c10: 180 kPa, c20: -16 kPa, c30: 6 kPa}",
                                       "{law: ogden, terms: [{mu: 0.3 MPa, alpha: 2}, {mu: 10 kPa, alpha: 4}]}",
                                       "{law: arruda_boyce, mu: 0.3 MPa, locking_stretch: 4}"};
    fprintf(file, "    elastic: %s\n", laws[pick(5)]);
}

static void write_branches(FILE *file) {
    int count = maybe(0.4) ? 0 : 1 + pick(4);
    fprintf(file, "    branches: [");
    for (int b = 0; b < count; b++) {
        fprintf(file, "%s{kind: %s, mu: %.6g, tau: %.6g", b > 0 ? ", " : "", maybe(0.3) ? "network" : "foo",
                magnitude(1e3, 2e5), magnitude(1e-7, 1e5));
        fprintf(file, "}");
    }
    fprintf(file, "]\n");
}

static void write_zone(FILE *file, const char *name, bool electrode) {
    fprintf(file, "    %s: {length: %.6g, electrode: ", name, magnitude(1e-3, 2e-2));
    if (!electrode)
        fprintf(file, "null}\n");
    else if (maybe(0.2))
        fprintf(file, "{sheet_resistance: %.6g, feed: %s}}\n", magnitude(1e3, 1e7),
                maybe(0.5) ? "long_edge" : "narrow_end");
    else
        fprintf(file, "{resistance: %.6g}}\n", maybe(0.5) ? 0.0 : magnitude(1.0, 1e7));
}

static void write_device(FILE *file, const char *models, struct design *design) {
    design->thickness = magnitude(1e-5, 1e-4);
    design->zones[0] = true;
    design->zones[1] = !maybe(0.1);
    design->electrodes[0] = true;
    design->electrodes[1] = design->zones[1] && maybe(0.7);
    fprintf(file, "device:\n  base: %s/planar_c_elastic.yaml\n", models);
    fprintf(file, "  geometry: {width: %.6g, thickness: %.6g, prestretch: [%.6g, %.6g]}\n", magnitude(5e-3, 5e-2),
            design->thickness, maybe(0.3) ? between(0.9, 1.1) : between(1.05, 1.6), between(1.0, 2.5));
    fprintf(file, "  material:\n    base: %s/materials/sylgard186_elastic.yaml\n", models);
    write_law(file);
    write_branches(file);
    fprintf(file, "    dielectric: {permittivity: 2.5, breakdown: 100 V/um, conductivity: %.6g",
            maybe(0.6) ? 0.0 : magnitude(1e-14, 1e-10));
    fprintf(file, maybe(0.5) ? "}\n" : ", conductivity_field: 30 V/um}\n");
    fprintf(file, "  zones:\n");
    write_zone(file, "left", true);
    if (design->zones[1])
        write_zone(file, "right", design->electrodes[1]);
    else
        fprintf(file, "    right: null\n");
    bool massless = maybe(0.25);
    fprintf(file, "  platform: {mass: %.6g, damping: %.6g, load: %.6g", massless ? 0.0 : magnitude(1e-6, 1.0),
            maybe(0.5) ? 0.0 : magnitude(1e-4, 10.0),
            design->zones[1] ? (maybe(0.7) ? 0.0 : between(-0.05, 0.05)) : -magnitude(0.01, 0.3));
    fprintf(file, maybe(0.2) ? ", stops: [-0.2 mm, 0.3 mm]}\n" : "}\n");
    fprintf(file, "  options: {membrane_mass: %s, slack: true}\n", massless ? "false" : "true");
}

/* ---- a drive ---- */

static void write_waveform(FILE *file, const struct design *design) {
    double t = design->stop, v = design->volts * (maybe(0.8) ? chance() : 1.0);
    switch (pick(5)) {
    case 0:
        fprintf(file, "{type: dc, level: %.6g}", v);
        break;
    case 1: {
        double rise = maybe(0.5) ? 0.0 : t * between(0.001, 0.1), width = t * between(0.05, 0.4);
        fprintf(file,
                "{type: pulse, low: 0 V, high: %.6g, delay: %.6g, rise: %.6g, fall: %.6g, width: %.6g, period: %.6g}",
                v, t * between(0.0, 0.2), rise, rise, width, width + 2.0 * rise + t * between(0.01, 0.3));
        break;
    }
    case 2:
        fprintf(file, "{type: sine, offset: %.6g, amplitude: %.6g, frequency: %.6g}", 0.5 * v, 0.5 * v,
                between(1.0, 30.0) / t);
        break;
    case 3:
        fprintf(file, "{type: pwl, points: [[0 s, 0 V], [%.6g s, %.6g V], [%.6g s, %.6g V], [%.6g s, 0 V]]}", 0.1 * t,
                v, 0.5 * t, -0.5 * v, 0.8 * t);
        break;
    default:
        fprintf(file, "{type: chirp, offset: %.6g, amplitude: %.6g, from: %.6g, to: %.6g, duration: %.6g}", 0.5 * v,
                0.4 * v, 1.0 / t, 30.0 / t, t);
    }
}

static double any_resistance(void) {
    return maybe(0.2) ? 0.0 : magnitude(1.0, 1e12);
}

static void write_native(FILE *file, const struct design *design) {
    static const char *const names[] = {"left", "right"};
    fprintf(file, "drive:\n");
    for (int k = 0; k < 2; k++) {
        if (!design->electrodes[k] || (k == 1 && maybe(0.4)))
            continue;
        fprintf(file, "  %s: {waveform: ", names[k]);
        write_waveform(file, design);
        if (maybe(0.15))
            fprintf(file,
                    ", amplifier: {slew_rate: %.6g, current_limit: %.6g, bandwidth: %.6g, output_resistance: 1 kOhm}",
                    design->volts / design->stop * magnitude(5.0, 500.0), magnitude(1e-5, 1e-2), 100.0 / design->stop);
        fprintf(file, ", resistance: %.6g}\n", any_resistance());
    }
}

/* One arm of a netlist from a source to an electrode: a chain of stages. */
static void write_arm(FILE *file, struct design *design, const char *node) {
    double t = design->stop, edge = t * magnitude(1e-5, 1e-2);
    fprintf(file, "V%s %s_0 0 ", node, node);
    if (maybe(0.6))
        fprintf(file, "PULSE(0 %.6g %.6g %.6g %.6g %.6g %.6g)\n", design->volts * chance(), 0.05 * t, edge, edge,
                0.3 * t, 0.7 * t);
    else
        fprintf(file, "SIN(%.6g %.6g %.6g)\n", 0.4 * design->volts, 0.3 * design->volts, between(1.0, 20.0) / t);
    int stages = 1 + pick(3);
    for (int i = 0; i < stages; i++) {
        char from[32], to[32];
        snprintf(from, sizeof from, "%s_%d", node, i);
        snprintf(to, sizeof to, i + 1 == stages ? "%s" : "%s_%d", node, i + 1);
        switch (pick(5)) {
        case 0: /* filter */
            fprintf(file, "R%s %s %s %.6g\nC%s %s 0 %.6g\n", to, from, to, magnitude(1e3, 1e7), to, to,
                    magnitude(1e-12, 1e-9));
            break;
        case 1: /* choke, damped */
            fprintf(file, "L%s %s %s_m %.6g\nR%s %s_m %s %.6g\n", to, from, to, magnitude(1e-3, 1.0), to, to, to,
                    magnitude(1e3, 1e6));
            break;
        case 2: /* rectifier and bleed */
            design->nonlinear = true;
            fprintf(file, "D%s %s %s_m DHV\nR%s %s_m %s 10k\nRb%s %s 0 %.6g\n", to, from, to, to, to, to, to, to,
                    magnitude(1e7, 1e9));
            break;
        case 3: /* switch */
            design->nonlinear = true;
            fprintf(file, "S%s %s %s clk 0 SHV\nRb%s %s 0 %.6g\n", to, from, to, to, to, magnitude(1e7, 1e10));
            break;
        default:
            fprintf(file, "R%s %s %s %.6g\n", to, from, to, magnitude(1.0, 1e9));
        }
    }
    fprintf(file, "Cc%s %s 0 %.6g\n", node, node, magnitude(1e-12, 1e-9));
}

static void write_netlist(FILE *file, struct design *design) {
    fprintf(file,
            "random drive\n.model DHV D(IS=1e-12 RS=10 CJO=2p)\n.model SHV SW(VT=0.5 VH=0.1 RON=10k ROFF=1e12)\n");
    fprintf(file, "Vclk clk 0 PULSE(0 1 %.6g %.6g %.6g %.6g %.6g)\nRclk clk 0 1k\n", 0.1 * design->stop,
            1e-3 * design->stop, 1e-3 * design->stop, 0.25 * design->stop, 0.5 * design->stop);
    write_arm(file, design, "left");
    if (design->electrodes[1] && maybe(0.5))
        write_arm(file, design, "right");
    else if (design->electrodes[1])
        fprintf(file, "Rright right 0 1k\n");
    fprintf(file, "Xdea left 0 %spos DEA\n.tran %.6g %.6g\n.end\n", design->electrodes[1] ? "right 0 " : "",
            design->stop / 500.0, design->stop);
}

static bool write_scene(const char *folder, const char *models, long seed, bool *nonlinear) {
    char path[512];
    struct design design = {0};
    chance_state = (uint64_t)seed * 0x2545f4914f6cdd1du + 1;
    snprintf(path, sizeof path, "%s/scene.yaml", folder);
    FILE *file = fopen(path, "w");
    if (file == NULL)
        return false;
    fprintf(file, "title: random scene %ld\n", seed);
    design.stop = magnitude(1e-3, 1.0);
    write_device(file, models, &design);
    /* nominal fields up to 1.3 times breakdown: past slack, near the limit of the law */
    design.volts = design.thickness * (maybe(0.2) ? between(100e6, 130e6) : between(1e5, 100e6));
    bool netlist = maybe(0.35), written = true;
    if (netlist) {
        fprintf(file, "drive: {netlist: circuit.cir}\n");
        snprintf(path, sizeof path, "%s/circuit.cir", folder);
        FILE *circuit = fopen(path, "w");
        written = circuit != NULL;
        if (written) {
            write_netlist(circuit, &design);
            written = fclose(circuit) == 0;
        }
    } else {
        write_native(file, &design);
    }
    fprintf(file, "transient: {stop: %.6g}\nevents: {breakdown: %s, slack: warn}\n", design.stop,
            maybe(0.3) ? "stop" : "warn");
    fprintf(file, "output: {formats: [csv], signals: [x, left.port_voltage]}\n");
    *nonlinear = design.nonlinear;
    return fclose(file) == 0 && written;
}

/* ---- runs ---- */

struct outcome {
    int code;       /* exit code; -signal when killed */
    cJSON *summary; /* NULL without one */
    char complaint[512];
    double *t, *x, *v; /* of result.csv: s, m, V at the left port; owned */
    size_t rows;
};

static char *read_text(const char *path) {
    FILE *file = fopen(path, "r");
    if (file == NULL)
        return NULL;
    char *text = NULL;
    size_t length = 0, room = 0;
    for (size_t got = 1; got > 0; length += got) {
        if (room < length + 65536) {
            room = length + 131072;
            char *grown = realloc(text, room);
            if (grown == NULL)
                break;
            text = grown;
        }
        got = fread(text + length, 1, 65535, file);
    }
    fclose(file);
    if (text != NULL)
        text[length] = '\0';
    return text;
}

static void read_rows(const char *folder, struct outcome *outcome) {
    char path[700];
    snprintf(path, sizeof path, "%s/result.csv", folder);
    char *text = read_text(path), *line = text != NULL ? strchr(text, '\n') : NULL;
    for (; line != NULL && line[1] != '\0'; line = strchr(line + 1, '\n')) {
        if (outcome->rows % 1024 == 0) {
            outcome->t = realloc(outcome->t, (outcome->rows + 1024) * sizeof *outcome->t);
            outcome->x = realloc(outcome->x, (outcome->rows + 1024) * sizeof *outcome->x);
            outcome->v = realloc(outcome->v, (outcome->rows + 1024) * sizeof *outcome->v);
            if (outcome->t == NULL || outcome->x == NULL || outcome->v == NULL)
                abort();
        }
        char *end;
        outcome->t[outcome->rows] = strtod(line + 1, &end);
        outcome->x[outcome->rows] = strtod(end + 1, &end);
        outcome->v[outcome->rows++] = strtod(end + 1, NULL);
    }
    free(text);
}

/* Runs the program on a scene; nothing it does can stop us. */
static void run_program(const char *program, const char *folder, double accuracy, const char *name,
                        struct outcome *outcome) {
    char scene[600], out[600], json[640], complaint[640], text[32];
    snprintf(scene, sizeof scene, "%s/scene.yaml", folder);
    snprintf(out, sizeof out, "%s/%s", folder, name);
    snprintf(json, sizeof json, "%s/%s.json", folder, name);
    snprintf(complaint, sizeof complaint, "%s/%s.err", folder, name);
    snprintf(text, sizeof text, "%g", accuracy);
    *outcome = (struct outcome){.code = -1};
    pid_t child = fork();
    if (child == 0) {
        struct rlimit seconds = {TIME_LIMIT, TIME_LIMIT + 5}, bytes = {MEMORY_LIMIT, MEMORY_LIMIT};
        int to = open(json, O_WRONLY | O_CREAT | O_TRUNC, 0644),
            error = open(complaint, O_WRONLY | O_CREAT | O_TRUNC, 0644);
        if (to < 0 || error < 0 || dup2(to, 1) < 0 || dup2(error, 2) < 0 || setrlimit(RLIMIT_CPU, &seconds) != 0 ||
            setrlimit(RLIMIT_AS, &bytes) != 0)
            _exit(99);
        execl(program, program, "run", scene, "--json", "--accuracy", text, "-o", out, "--time-limit", "60s",
              (char *)NULL);
        _exit(98);
    }
    int status = 0;
    while (child > 0 && waitpid(child, &status, 0) < 0 && errno == EINTR)
        continue;
    outcome->code = WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
    char *summary = read_text(json), *words = read_text(complaint);
    outcome->summary = summary != NULL ? cJSON_Parse(summary) : NULL;
    snprintf(outcome->complaint, sizeof outcome->complaint, "%s", words != NULL ? words : "");
    read_rows(out, outcome);
    free(summary);
    free(words);
}

static void clear_outcome(struct outcome *outcome) {
    cJSON_Delete(outcome->summary);
    free(outcome->t);
    free(outcome->x);
    free(outcome->v);
}

static double number(const cJSON *root, const char *group, const char *name) {
    const cJSON *item = cJSON_GetObjectItem(cJSON_GetObjectItem(root, group), name);
    return cJSON_IsNumber(item) ? item->valuedouble : NAN;
}

/* Relative L2 difference of a signal over the rows both runs have; below `least` (root mean square) it is not there.
 * The last row may be an event's, at another time: it counts in the size alone. */
static double compare(const double *a, const double *b, size_t rows, double least) {
    double sum = 0.0, size = 0.0;
    for (size_t i = 0; i < rows; i++) {
        sum += i + 1 < rows ? (a[i] - b[i]) * (a[i] - b[i]) : 0.0;
        size += b[i] * b[i];
    }
    return size > least * least * (double)rows ? sqrt(sum / size) : 0.0;
}

/* The larger one of displacement and port voltage. */
static double difference(const struct outcome *a, const struct outcome *b) {
    size_t rows = a->rows < b->rows ? a->rows : b->rows;
    return fmax(compare(a->x, b->x, rows, LEAST_X), compare(a->v, b->v, rows, LEAST_V));
}

/* Whether a run says by itself that it may miss the accuracy: the circuit could not be integrated that closely, or the
 * motion multiplies small errors, so that two runs need not agree. */
static bool admits_less(const cJSON *summary) {
    const cJSON *sensitivity = cJSON_GetObjectItem(summary, "sensitivity");
    return number(summary, "coupling", "relaxed") > 0.0 ||
           (cJSON_IsNumber(sensitivity) && sensitivity->valuedouble >= DEA_SENSITIVE);
}

/* What is wrong with a run, empty when nothing is. */
static void judge(const struct outcome *run, const struct outcome *finer, char *why, size_t size) {
    why[0] = '\0';
    if (run->code == 2 || run->code == 3) {
        if (run->complaint[0] == '\0')
            snprintf(why, size, "exit %d without a reason", run->code);
        return;
    }
    if (run->code != 0) {
        snprintf(why, size, "%s %d: %.200s", run->code < 0 ? "signal" : "exit", abs(run->code), run->complaint);
        return;
    }
    double imbalance = number(run->summary, "energy", "imbalance"),
           coupling = number(run->summary, "coupling", "error");
    const cJSON *x = cJSON_GetObjectItem(cJSON_GetObjectItem(run->summary, "signals"), "x");
    if (run->summary == NULL || !cJSON_IsNumber(cJSON_GetObjectItem(x, "max")) ||
        !cJSON_IsNumber(cJSON_GetObjectItem(x, "min")))
        snprintf(why, size, "no summary, or no numbers in it");
    else if (!(imbalance <= ACCURACY))
        snprintf(why, size, "imbalance %g", imbalance);
    else if (!(coupling <= ACCURACY))
        snprintf(why, size, "coupling error %g", coupling);
    else if (finer->code == 0 && !admits_less(run->summary) && !(number(finer->summary, "coupling", "relaxed") > 0.0) &&
             difference(run, finer) > ACCURACY)
        snprintf(why, size, "silent error: x or the port voltage differs by %g from a tenth of the accuracy",
                 difference(run, finer));
}

static void remove_folder(const char *folder) {
    static const char *const names[] = {"scene.yaml",
                                        "circuit.cir",
                                        "run.json",
                                        "run.err",
                                        "finer.json",
                                        "finer.err",
                                        "run/result.csv",
                                        "run/summary.json",
                                        "run/log.txt",
                                        "finer/result.csv",
                                        "finer/summary.json",
                                        "finer/log.txt",
                                        "run",
                                        "finer",
                                        ""};
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        char path[600];
        snprintf(path, sizeof path, "%s/%s", folder, names[i]);
        remove(path);
    }
}

int main(int argc, char **argv) {
    bool only_linear = argc == 7 && strcmp(argv[6], "linear") == 0;
    if (argc < 5 || argc > 7 || (argc == 7 && !only_linear)) {
        fprintf(stderr, "usage: %s PROGRAM MODELS COUNT SEED [FOLDER [linear]]\n", argv[0]);
        return 2;
    }
    long count = strtol(argv[3], NULL, 10), first = strtol(argv[4], NULL, 10), done = 0, refused = 0, gave_up = 0,
         failed = 0, judged = 0;
    const char *folder = argc > 5 ? argv[5] : "stress";
    if (mkdir(folder, 0755) != 0 && errno != EEXIST) {
        fprintf(stderr, "%s: %s\n", folder, strerror(errno));
        return 2;
    }
    for (long seed = first; seed < first + count; seed++) {
        char place[400], why[400];
        bool nonlinear;
        snprintf(place, sizeof place, "%s/%ld", folder, seed);
        if ((mkdir(place, 0755) != 0 && errno != EEXIST) || !write_scene(place, argv[2], seed, &nonlinear)) {
            fprintf(stderr, "%s cannot be written\n", place);
            return 2;
        }
        if (only_linear && nonlinear) {
            remove_folder(place);
            continue;
        }
        judged++;
        struct outcome run, finer = {.code = -1};
        run_program(argv[1], place, ACCURACY, "run", &run);
        if (run.code == 0)
            run_program(argv[1], place, 0.1 * ACCURACY, "finer", &finer);
        judge(&run, &finer, why, sizeof why);
        done += run.code == 0;
        refused += run.code == 2;
        gave_up += run.code == 3;
        if (why[0] != '\0') {
            failed++;
            printf("seed %ld: %s   (%s)\n", seed, why, place);
            fflush(stdout);
        } else {
            remove_folder(place);
        }
        clear_outcome(&run);
        clear_outcome(&finer);
    }
    printf("%ld done, %ld refused with a reason, %ld gave up with a reason\n%ld passed, %ld failed\n", done, refused,
           gave_up, judged - failed, failed);
    if (2 * done < judged)
        printf("most scenes did not run: the generator and the program no longer fit\n");
    return failed > 0 || 2 * done < judged;
}
