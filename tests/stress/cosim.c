/* What the coupling delivers for the accuracy asked, at what cost: against an integration of circuit and device as one
 * system. Usage:
 *   stress_cosim [all|CASE [A ...]]  accuracy delivered and cost
 *   stress_cosim auto                the same, circuits solved as one problem where they are linear
 *   stress_cosim robust              scenes of every kind: books, and what a tenth of the accuracy changes
 *   stress_cosim order               error against the interval of the exchange */
#include "coupled_capture.h"
#include "coupled_cases.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SAMPLES = 6000 };

static void print_row(const char *name, double a, const struct coupled_rows *rows, struct coupled_error e) {
    const struct dea_run_stats *s = &rows->result.stats_run;
    printf("%-18s %7.0e %8.3f %8.3f %9.2e %9.2e %8ld %6ld %7ld %8ld %8.1f %.*s%s\n", name, a, e.x / a, e.port / a,
           rows->result.energy.imbalance, rows->result.coupling_error, s->circuit_points, s->circuit_rejected,
           s->plant_steps, s->residuals, 1e3 * s->wall_s, rows->result.relaxed, "rrrr",
           rows->status < 0 ? rows->error.text
           : e.x > a || e.port > a || !(rows->result.energy.imbalance <= a) || !(rows->result.coupling_error <= a) ||
                   isnan(e.x)
               ? "  <<<"
               : "");
    fflush(stdout);
}

static void measure_case(const struct coupled_case *c, enum dea_engine_choice engine, const double *accuracies,
                         int count) {
    struct dea_scene scene;
    struct coupled_trace trace, coarse;
    make_circuit_scene(c->device, &c->circuit, SILENT_EVENTS, &scene);
    bool good = solve_circuit(&c->circuit, &scene.devices[0].device, 1e-12, SAMPLES, &trace) &&
                solve_circuit(&c->circuit, &scene.devices[0].device, 1e-11, SAMPLES, &coarse);
    if (!good) {
        printf("%-18s no reference\n", c->name);
        return;
    }
    double worst = 0.0, size = 0.0;
    for (size_t i = 0; i < trace.count; i++) {
        worst += (trace.x[i] - coarse.x[i]) * (trace.x[i] - coarse.x[i]);
        size += trace.x[i] * trace.x[i];
    }
    struct coupled_rows rows;
    double native = NAN;
    if (c->native) {
        struct dea_scene sources;
        make_circuit_scene(c->device, &c->circuit, SILENT_EVENTS, &sources);
        set_native_sources(&sources, &c->circuit);
        run_scene(&sources, DEA_ENGINE_AUTO, 1e-9, SAMPLES, &rows);
        struct coupled_error e = compare_with_trace(&rows, &trace);
        native = fmax(e.x, e.port);
        if (rows.status < 0)
            printf("%s\n", rows.error.text);
        free_rows(&rows);
        dea_scene_clear(&sources);
    }
    printf("%-18s reference %ld steps, own difference %.1e, native run %.1e\n", c->name, trace.steps,
           sqrt(worst / size), native);
    for (int i = 0; i < count; i++) {
        run_scene(&scene, engine, accuracies[i], SAMPLES, &rows);
        print_row("", accuracies[i], &rows, compare_with_trace(&rows, &trace));
        free_rows(&rows);
    }
    free_trace(&trace);
    free_trace(&coarse);
    dea_scene_clear(&scene);
}

/* Error against a fixed exchange interval: every circuit step ends in an exchange, or the circuit is all but exact. */
static void measure_order(const char *name, double longest, double accuracy) {
    const struct coupled_case *c = find_case(name);
    struct dea_scene scene;
    struct coupled_trace trace;
    make_circuit_scene(c->device, &c->circuit, SILENT_EVENTS, &scene);
    if (!solve_circuit(&c->circuit, &scene.devices[0].device, 1e-12, SAMPLES, &trace))
        return;
    printf("%s, circuit at A = %.0e\n%12s %10s %7s %10s %7s %9s %8s\n", name, accuracy, "interval us", "x", "order",
           "port", "order", "coupling", "points");
    struct coupled_error before = {0.0, 0.0};
    for (int halvings = 0; halvings < 6; halvings++) {
        struct coupled_rows rows;
        double interval = longest / (1 << halvings);
        run_with_horizon(&scene, accuracy, interval, SAMPLES, &rows);
        struct coupled_error e = compare_with_trace(&rows, &trace);
        printf("%12.3f %10.2e %7.2f %10.2e %7.2f %9.1e %8ld %s\n", 1e6 * interval, e.x, log2(before.x / e.x), e.port,
               log2(before.port / e.port), rows.result.coupling_error, rows.result.stats_run.circuit_points,
               rows.status < 0 ? rows.error.text : "");
        fflush(stdout);
        before = e;
        free_rows(&rows);
    }
    free_trace(&trace);
    dea_scene_clear(&scene);
}

static void measure_orders(void) {
    static const struct {
        const char *name;
        double longest; /* s */
    } tasks[] = {{"rc_step", 400e-6},          {"two_side_sine", 800e-6}, {"hold", 800e-6},
                 {"massless_ramp", 100e-6},    {"massless_bias", 100e-6}, {"massless_viscous", 100e-6},
                 {"massless_branches", 400e-6}};
    for (size_t i = 0; i < sizeof tasks / sizeof tasks[0]; i++) {
        measure_order(tasks[i].name, tasks[i].longest, 1e-7);
        measure_order(tasks[i].name, tasks[i].longest, 1e-3);
    }
}

static void measure_robustness(void) {
    static const double accuracies[] = {1e-3, 1e-4, 1e-5, 1e-6};
    enum { COUNT = sizeof accuracies / sizeof accuracies[0] };
    size_t count;
    const struct coupled_scene *scenes = list_scenes(&count);
    printf("%-18s %7s %9s %9s %9s %8s %7s %8s\n", "scene", "A", "change/A", "imbal./A", "coupl./A", "points", "steps",
           "ms");
    for (size_t i = 0; i < count; i++) {
        struct dea_scene scene;
        struct coupled_rows rows[COUNT];
        make_listed_scene(&scenes[i], &scene);
        for (int a = 0; a < COUNT; a++)
            run_scene(&scene, DEA_ENGINE_NGSPICE, accuracies[a], 500, &rows[a]);
        for (int a = 0; a < COUNT; a++) {
            const struct dea_result *result = &rows[a].result;
            struct coupled_error change = {NAN, NAN};
            if (a + 1 < COUNT)
                change = compare_rows(&rows[a], &rows[a + 1]);
            double largest = fmax(change.x, change.port) / accuracies[a];
            double imbalance = result->energy.imbalance / accuracies[a],
                   coupling = result->coupling_error / accuracies[a];
            printf("%-18s %7.0e %9.3f %9.3f %9.3f %8ld %7ld %8.1f %.*s%s%s\n", a == 0 ? scenes[i].name : "",
                   accuracies[a], largest, imbalance, coupling, result->stats_run.circuit_points,
                   result->stats_run.plant_steps, 1e3 * result->stats_run.wall_s, result->relaxed, "rrrr",
                   largest > 1.0 || !(imbalance <= 1.0) || !(coupling <= 1.0) ? "  <<<" : "",
                   rows[a].status < 0 ? rows[a].error.text : "");
        }
        fflush(stdout);
        for (int a = 0; a < COUNT; a++)
            free_rows(&rows[a]);
        dea_scene_clear(&scene);
    }
}

int main(int argc, char **argv) {
    double accuracies[16] = {1e-2, 1e-3, 1e-4, 1e-5, 1e-6};
    int count = 5;
    if (argc > 2)
        for (count = 0; count + 2 < argc && count < 16; count++)
            accuracies[count] = atof(argv[count + 2]);
    size_t case_count;
    const struct coupled_case *cases = list_cases(&case_count);
    bool linear = argc > 1 && strcmp(argv[1], "auto") == 0, every = argc < 2 || linear || strcmp(argv[1], "all") == 0;
    enum dea_engine_choice engine = linear ? DEA_ENGINE_AUTO : DEA_ENGINE_NGSPICE;
    struct test_folder folder;
    enter_folder(&folder);
    if (argc > 1 && (strcmp(argv[1], "order") == 0 || strcmp(argv[1], "robust") == 0)) {
        if (strcmp(argv[1], "order") == 0)
            measure_orders();
        else
            measure_robustness();
        leave_folder(&folder);
        return 0;
    }
    printf("%-18s %7s %8s %8s %9s %9s %8s %6s %7s %8s %8s\n", "case", "A", "x/A", "port/A", "imbalance", "coupling",
           "points", "rej.", "steps", "resid.", "ms");
    for (size_t i = 0; i < case_count; i++)
        if (every || strcmp(argv[1], cases[i].name) == 0)
            measure_case(&cases[i], engine, accuracies, count);
    leave_folder(&folder);
    return 0;
}
