/* How many designs of figure 5B a core evaluates per second, failure modes included, three ways:
 *   closed forms   dea_design_limit, roots on known brackets
 *   general walk   dea_static_limit, which serves any law, load and layout
 *   energy scan    the procedure described in the paper: at each voltage the total energy (eq. 7) over a grid of
 *                  stretches, its smallest value being the equilibrium; voltages until something fails */
#include "deasim/map.h"

#include <math.h>
#include <stdio.h>
#include <time.h>

#define FAST_SIDE 1000
#define WALK_SIDE 60
#define SCAN_SIDE 12
#define SCAN_VOLTAGES 250
#define SCAN_STRETCHES 2000
#define SCAN_LARGEST_VOLTAGE 4000.0

static double seconds(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static struct dea_design design_at(int i, int j, int side) {
    struct dea_design design = dea_design_of_paper();
    design.active_ratio = (i + 0.5) / side;
    design.prestretch[0] = 0.72 + 1.08 * (j + 0.5) / side;
    return design;
}

static double stress1(const struct dea_design *design, double lam, double maxwell) {
    struct dea_stress stress;
    return dea_law_stress(&design->elastic, lam, design->prestretch[1], &stress) == DEA_OK ? lam * stress.w1 - maxwell
                                                                                           : -1.0;
}

/* Stretch of least total energy per unit of membrane (eq. 4 to 7, eq. 6 corrected) at one voltage. */
static double scan_energies(const struct dea_design *design, double voltage, double largest) {
    double lp1 = design->prestretch[0], lp2 = design->prestretch[1], r = design->active_ratio;
    double eps = DEA_VACUUM_PERMITTIVITY * design->dielectric.permittivity, nominal = voltage / design->thickness;
    double best = lp1, least = INFINITY;
    for (int k = 0; k < SCAN_STRETCHES; k++) {
        double active = lp1 + (largest - lp1) * k / (SCAN_STRETCHES - 1),
               passive = lp1 - r / (1.0 - r) * (active - lp1);
        double wa, wp;
        if (dea_law_energy(&design->elastic, active, lp2, &wa) != DEA_OK ||
            dea_law_energy(&design->elastic, passive, lp2, &wp) != DEA_OK)
            continue;
        double ratio = active / lp1,
               energy = r * wa + (1.0 - r) * wp - 0.5 * eps * r * ratio * ratio * nominal * nominal;
        if (energy < least) {
            least = energy;
            best = active;
        }
    }
    return best;
}

/* d at the first failure by the energy scan. */
static double scan_design(const struct dea_design *design) {
    double lp1 = design->prestretch[0], r = design->active_ratio, last = lp1;
    double eps = DEA_VACUUM_PERMITTIVITY * design->dielectric.permittivity;
    double largest = fmin(lp1 + (1.0 - r) / r * (lp1 - 0.5), 3.0 * lp1);
    for (int n = 1; n < SCAN_VOLTAGES; n++) {
        double voltage = SCAN_LARGEST_VOLTAGE * n / SCAN_VOLTAGES, lam = scan_energies(design, voltage, largest);
        double field = voltage * lam / (design->thickness * lp1);
        if (field > design->dielectric.breakdown || stress1(design, lam, eps * field * field) < 0.0)
            break;
        last = lam;
    }
    return r * (last / lp1 - 1.0);
}

static void report(const char *name, long designs, double elapsed, double error) {
    printf("%-14s %10ld designs %9.3f s %12.0f designs/s   largest error of d %.1e\n", name, designs, elapsed,
           (double)designs / elapsed, error);
}

int main(void) {
    struct dea_design_end end;
    double sum = 0.0, started = seconds();
    for (int i = 0; i < FAST_SIDE; i++)
        for (int j = 0; j < FAST_SIDE; j++) {
            struct dea_design design = design_at(i, j, FAST_SIDE);
            if (dea_design_limit(&design, &end, NULL) != DEA_OK)
                return 1;
            sum += end.displacement;
        }
    report("closed forms", (long)FAST_SIDE * FAST_SIDE, seconds() - started, 0.0);

    double error = 0.0, elapsed = 0.0;
    for (int i = 0; i < WALK_SIDE; i++)
        for (int j = 0; j < WALK_SIDE; j++) {
            struct dea_design design = design_at(i, j, WALK_SIDE);
            struct dea_device device;
            struct dea_limit limit;
            if (dea_design_limit(&design, &end, NULL) != DEA_OK)
                return 1;
            started = seconds();
            if (dea_design_to_device(&design, 1e-2, 1e-2, false, &device, NULL) != DEA_OK ||
                dea_static_limit(&device, 0.0, &limit, NULL) != DEA_OK)
                return 1;
            elapsed += seconds() - started;
            error = fmax(error, fabs(limit.x / 1e-2 - end.displacement));
        }
    report("general walk", (long)WALK_SIDE * WALK_SIDE, elapsed, error);

    error = elapsed = 0.0;
    for (int i = 0; i < SCAN_SIDE; i++)
        for (int j = 0; j < SCAN_SIDE; j++) {
            struct dea_design design = design_at(i, j, SCAN_SIDE);
            if (dea_design_limit(&design, &end, NULL) != DEA_OK)
                return 1;
            started = seconds();
            double d = scan_design(&design);
            elapsed += seconds() - started;
            error = fmax(error, fabs(d - end.displacement));
        }
    report("energy scan", (long)SCAN_SIDE * SCAN_SIDE, elapsed, error);
    printf("(energy scan: %d voltages x %d stretches per design; mean d of the map %.6f)\n", SCAN_VOLTAGES,
           SCAN_STRETCHES, sum / FAST_SIDE / FAST_SIDE);
    return 0;
}
