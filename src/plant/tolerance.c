/* From the promised accuracy of a run to the tolerance of a step, the weights of the unknowns, and the first step. */
#include "plant/integrator.h"
#include "plant/network.h"

#include <float.h>
#include <math.h>

/* The promise A is on the result over the whole run; IDA controls the error of one step. What lies between was measured
 * with `./dev bench accuracy` and random scenes, A = 1e-2 .. 1e-6, against an independent program. With the tolerance
 * proportional to A, error/A grew as A^-0.16 (a BDF of order k passes tolerance^(k/(k+1)) on, k = 5 at most); it grows
 * in proportion to the number of free oscillations the run remembers (200 undamped cycles against 20: tenfold), more
 * where a drive sustains them at resonance, and as the root of the number of periods of a drive far above resonance,
 * whose errors the platform's velocity collects: or the place of one that creeps back slowly, or a film's charge behind
 * a large resistance. Hence tolerance = 0.6 A^1.17 / (1 + 3 cycles + 2 sqrt(further periods of the drive)). Where x
 * stays below 1e-6 of the membrane's length, rounding of that length ends the error near 1e-7.
 */
#define TOLERANCE_FACTOR 0.6
#define TOLERANCE_EXPONENT 1.17
#define PER_CYCLE 3.0
#define PER_PERIOD 2.0
/* Cycles that a circuit rings by itself, measured with R-L-C in front of a film, Q = 3 .. 260: error/A is about a third
 * of them without this. */
#define PER_RINGING 2.0
/* Without losses of its own an oscillation shows in its energy what the integrator takes from its amplitude, twice. */
#define LOSSLESS 10.0
#define UNDAMPED 1.6
/* Cycles remembered where the length of the run is not known. */
#define USUAL_CYCLES 20.0
/* Smallest tolerance double precision carries through a BDF step. */
#define TOLERANCE_FLOOR 1e-14

/* Before an unknown has moved, it is weighed as if it had already this part of its expected size: small, since a drive
 * may stay far below what its peak could do. */
#define EXPECTED_PART 1e-8
#define EXPECTED_PART_OF_CIRCUIT 1e-3

/* Rounding of lengths and stresses as large as the whole membrane's, in units of its last digit; a platform without
 * mass and damping sits where forces as large as the prestretch's cancel, and knows its place less well. */
#define ROUNDING 4.0
#define ROUNDING_OF_BALANCE 2000.0
/* The rate of a fast branch is its own last digit over its time constant; Newton's iteration, which stops at a
 * twentieth of the tolerance, would look for less. Times the rounding above. */
#define ROUNDING_OF_BRANCHES 20.0

/* The rates after a corner of a circuit are those over options.settle_time: a first step that is not much longer finds
 * nothing but their rounding. */
#define FIRST_OVER_SETTLING 10.0

/* The energy books add up errors of every step, those of the motion only some: their share of the tolerance, and the
 * part of the expected energy below which nothing is asked of them. */
#define ENERGY_SHARE 0.2
/* Beside a circuit steps go over bends of the charges, which a slack film's books feel most: over forty accuracies
 * around 1e-4 those of a film slackened by a fast charge closed to 1.1e-4 at worst with the share above, to 1.6e-5 with
 * this. */
#define ENERGY_SHARE_OF_COUPLED 0.05
#define NEGLIGIBLE_ENERGY 1e-6

/* ---- the tolerance ---- */

/* Stiffness that a branch adds to a zone while it has no time to relax, N/m. */
static double branch_stiffness(const struct dea_device *device, int zone, const struct dea_branch *branch) {
    struct dea_branch_response response;
    double z[2], per_length = device->prestretch[0] / device->zones[zone].length;
    dea_branch_relaxed(branch, device->prestretch, device->prestretch[0], z);
    if (!device->zones[zone].present ||
        dea_branch_respond(branch, device->prestretch, device->prestretch[0], z, true, &response) != DEA_OK)
        return 0.0;
    return device->zones[zone].volume * per_length * per_length * response.dp1_dlam1;
}

/* What branches make of a platform that moves in its own time: the resistance of those that relax along with it, and
 * the stiffness that they do not have. */
static void find_resistance(struct dea_plant *plant) {
    const struct dea_device *device = plant->device;
    bool swings = plant->motion == MOTION_INERTIAL;
    plant->resistance = device->damping;
    plant->relaxing[0] = plant->relaxing[1] = 0.0;
    if (device->stiffness <= 0.0 || plant->motion == MOTION_ALGEBRAIC)
        return;
    double omega = swings ? sqrt(device->stiffness / device->effective_mass) : device->stiffness / device->damping;
    for (int b = 0; b < device->material.branch_count; b++) {
        const struct dea_branch *branch = &device->material.branches[b];
        double turn = omega * branch->tau;
        for (int k = 0; k < DEA_ZONES; k++) {
            double relaxing = branch_stiffness(device, k, branch) / (1.0 + turn * turn);
            plant->relaxing[k] += relaxing;
            plant->resistance += swings ? relaxing * branch->tau : 0.0;
        }
    }
}

/* Time after which the platform has forgotten an error, s, and the period of its free oscillation: INFINITY where it
 * creeps back. */
static double platform_memory(const struct dea_plant *plant, double *cycle) {
    const struct dea_device *device = plant->device;
    *cycle = INFINITY;
    if (plant->motion == MOTION_ALGEBRAIC || device->stiffness <= 0.0)
        return 0.0;
    if (plant->motion == MOTION_VISCOUS)
        return plant->resistance / device->stiffness;
    double omega = sqrt(device->stiffness / device->effective_mass);
    double rate = 0.5 * plant->resistance / device->effective_mass; /* of the amplitude's decay, 1/s */
    if (rate >= omega)
        return (rate + sqrt(rate * rate - omega * omega)) / (omega * omega);
    *cycle = 2.0 * M_PI / omega;
    return 1.0 / fmax(rate, DBL_MIN);
}

/* The same of a film's charge behind its resistance, in parallel with the film's own leakage; in a circuit, of the
 * circuit. */
static double charge_memory(const struct dea_plant *plant, int k) {
    if (!plant->zones[k].present ||
        (plant->zones[k].kind != DEA_PORT_SOURCE && plant->zones[k].kind != DEA_PORT_NETWORK))
        return 0.0;
    if (plant->zones[k].kind == DEA_PORT_NETWORK)
        return plant->creep;
    double lam = plant->device->prestretch[0], leak;
    double resistance = plant->options.ports[k].resistance + dea_zone_resistance(plant->device, k, lam, NULL);
    dea_zone_leakage(plant->device, k, lam, 0.0, &leak, NULL);
    return plant->device->zones[k].rest_capacitance / (1.0 / resistance + leak);
}

/* Free oscillations over which an error is carried on. */
double dea_plant_remembered_cycles(const struct dea_plant *plant) {
    double cycle, memory = platform_memory(plant, &cycle);
    if (isinf(cycle))
        return 0.0;
    double duration = plant->options.duration > 0.0 ? plant->options.duration : USUAL_CYCLES * cycle;
    double count = fmin(memory, duration) / cycle;
    return memory > LOSSLESS * duration ? UNDAMPED * count : count;
}

/* Periods of the drive that are remembered, by the platform or by a charge that takes its time. */
static double count_periods(const struct dea_plant *plant) {
    double cycle, memory = platform_memory(plant, &cycle);
    for (int k = 0; k < DEA_ZONES; k++)
        memory = fmax(memory, charge_memory(plant, k));
    double duration = plant->options.duration;
    return duration > 0.0 ? plant->options.periods * fmin(memory / duration, 1.0) : 0.0;
}

/* How much an error grows by being carried on: over the free oscillations of the run, or those before damping has wiped
 * it out, and over faster periods of the drive in that time, whose errors add up at random. */
static double weigh_memory(const struct dea_plant *plant) {
    double cycles = dea_plant_remembered_cycles(plant), driven = count_periods(plant);
    return PER_CYCLE * cycles + PER_RINGING * plant->ringing + PER_PERIOD * sqrt(fmax(driven - cycles, 0.0));
}

void plant_set_tolerance(struct dea_plant *plant) {
    find_resistance(plant);
    double cycle;
    platform_memory(plant, &cycle);
    for (int k = 0; k < DEA_ZONES; k++)
        plant->keeps_charge[k] = 2.0 * M_PI * charge_memory(plant, k) > cycle;
    double asked = TOLERANCE_FACTOR * pow(plant->options.accuracy, TOLERANCE_EXPONENT);
    plant->rtol = fmax(asked / (1.0 + weigh_memory(plant)), TOLERANCE_FLOOR);

    /* a zone's length and tension carry rounding of the whole, however small the motion */
    double longest = 0.0;
    for (int k = 0; k < DEA_ZONES; k++)
        if (plant->device->zones[k].present)
            longest = fmax(longest, plant->device->zones[k].length);
    double digits = plant->motion == MOTION_ALGEBRAIC ? ROUNDING_OF_BALANCE : ROUNDING;
    plant->rounding = digits * DBL_EPSILON * fmax(1.0, longest / plant->scale[plant->x]);
}

/* ---- weights ---- */

/* Errors are weighed by the size an unknown has reached. Velocity and branch states act through the displacement, so
 * that they need no better resolution than it: their scaled sizes compare directly. */
static double weigh_size(const struct dea_plant *plant, const double *u, int i) {
    double size = larger(fabs(u[i]), plant->largest[i]);
    return plant->follows[i] ? larger(size, larger(fabs(u[plant->x]), plant->largest[plant->x])) : size;
}

/* Velocity and the branches are what follows the displacement. */
static bool is_of_branch(const struct dea_plant *plant, int i) {
    return plant->follows[i] && i != plant->v;
}

/* Error of an unknown that a step may make. What a circuit does at an edge is known no better than the time. */
static double tolerate(const struct dea_plant *plant, const double *u, int i) {
    double rounding = is_of_branch(plant, i) ? ROUNDING_OF_BRANCHES * plant->rounding : plant->rounding;
    if (plant->network != ABSENT)
        rounding += ROUNDING * DBL_EPSILON * fabs(plant->t * NV_DATA_S(plant->yp)[i]);
    return plant->rtol * weigh_size(plant, u, i) + rounding;
}

/* Currents of voltage sources follow from the rest, without memory. */
static bool is_not_judged(const struct dea_plant *plant, int i) {
    return plant->network != ABSENT && i >= plant->network && plant->options.network->imposed[i - plant->network];
}

int plant_weigh(N_Vector y, N_Vector weights, void *context) {
    struct dea_plant *plant = context;
    const double *u = NV_DATA_S(y);
    double *w = NV_DATA_S(weights);
    /* IDA takes the mean square; times the count it is the sum, and idle unknowns do not dilute the error of others */
    double count = sqrt(plant->state_count);
    for (int i = 0; i < plant->state_count; i++)
        w[i] = is_not_judged(plant, i) ? 1e-12 : count / tolerate(plant, u, i);
    return 0;
}

void plant_note_sizes(struct dea_plant *plant) {
    const double *y = NV_DATA_S(plant->y);
    for (int i = 0; i < plant->state_count; i++) {
        bool of_circuit = plant->network != ABSENT && i >= plant->network;
        double expected = of_circuit ? EXPECTED_PART_OF_CIRCUIT : EXPECTED_PART;
        plant->largest[i] = larger(larger(plant->largest[i], expected), fabs(y[i]));
    }
}

/* Energy the drive moves at full scale, J. */
static double expect_energy(const struct dea_plant *plant) {
    const struct dea_device *device = plant->device;
    double x = plant->scale[plant->x], energy = 0.5 * device->stiffness * x * x;
    for (int k = 0; k < DEA_ZONES; k++)
        energy += 0.5 * device->zones[k].rest_capacitance * plant->options.ports[k].peak * plant->options.ports[k].peak;
    return energy;
}

/* Integrals of the books are judged by the energy that has really moved, up to what one swing can move: over many
 * cycles their errors add up as the exchange does. */
static double energy_yardstick(const struct dea_plant *plant) {
    double expected = expect_energy(plant), seen = fmax(plant->moved, plant->kinetic);
    const double *quad = NV_DATA_S(plant->quad);
    for (int i = 0; i < LOSS_COUNT; i++)
        seen = larger(seen, fabs(quad[i]));
    return fmin(expected, fmax(seen, NEGLIGIBLE_ENERGY * expected));
}

static double energy_share(const struct dea_plant *plant) {
    for (int k = 0; k < DEA_ZONES; k++)
        if (plant->zones[k].present && plant->zones[k].kind == DEA_PORT_CHARGE)
            return ENERGY_SHARE_OF_COUPLED;
    return ENERGY_SHARE;
}

/* Error allowed to an integral of the books in one step, J. A massless platform's work is known no better than its
 * place, however short the step. */
static double allowed_energy(const struct dea_plant *plant) {
    double allowed = energy_share(plant) * plant->rtol * energy_yardstick(plant);
    return plant->v == ABSENT ? fmax(allowed, plant->rounding * expect_energy(plant)) : allowed;
}

bool plant_judge_energy(struct dea_plant *plant) {
    return IDAQuadSStolerances(plant->ida, energy_share(plant) * plant->rtol, allowed_energy(plant)) == IDA_SUCCESS;
}

/* ---- the first step ---- */

/* Norm of a scaled vector as IDA takes it. */
static double norm(const struct dea_plant *plant, const double *u, const double *d) {
    double sum = 0.0;
    for (int i = 0; i < plant->state_count; i++) {
        if (is_not_judged(plant, i))
            continue;
        double e = d[i] / tolerate(plant, u, i);
        sum += e * e;
    }
    return sqrt(sum);
}

/* Loss rates from the state alone: the integrator has no derivatives of a massless platform yet. */
static enum dea_status foresee_losses(struct dea_plant *plant, double t, const double *y, const double *yp,
                                      double *losses) {
    double velocity = plant_velocity(plant, y, yp);
    plant->rates_now = plant->network != ABSENT ? yp : NULL;
    if (plant->v == ABSENT) {
        double *rates = NV_DATA_S(plant->rates);
        DEA_TRY(plant_evaluate(plant, t, y, velocity, true));
        plant_rates(plant, t, y, rates);
        velocity = plant->motion == MOTION_ALGEBRAIC ? plant_algebraic_rate(plant, t, rates)
                                                     : plant->force / plant->device->damping;
    }
    return plant_quadrature_rates(plant, t, y, velocity, losses);
}

/* Shortens a first step until its error in the loss integrals, h^2/2 of the change of their rates, is in order. */
static double limit_by_losses(struct dea_plant *plant, double h) {
    const double *y = NV_DATA_S(plant->y), *yp = NV_DATA_S(plant->yp);
    double *later = NV_DATA_S(plant->sample_y), now[LOSS_COUNT], then[LOSS_COUNT], change = 0.0;
    for (int j = 0; j < plant->state_count; j++)
        later[j] = y[j] + h * yp[j];
    if (foresee_losses(plant, plant->t, y, yp, now) != DEA_OK ||
        foresee_losses(plant, plant->t + h, later, yp, then) != DEA_OK)
        return h;
    for (int i = 0; i < LOSS_COUNT; i++)
        change = fmax(change, fabs(then[i] - now[i]));
    double allowed = allowed_energy(plant), error = 0.5 * h * change;
    return error > allowed ? h * sqrt(0.5 * allowed / error) : h;
}

/* y'' from the rates a little later, into plant->rates. */
static enum dea_status find_bends(struct dea_plant *plant, double h) {
    const double *y = NV_DATA_S(plant->y), *yp = NV_DATA_S(plant->yp);
    double *later = NV_DATA_S(plant->sample_y), *bends = NV_DATA_S(plant->rates);
    if (plant->network != ABSENT)
        return plant_network_try(plant, h, bends);
    for (int j = 0; j < plant->state_count; j++)
        later[j] = y[j] + h * yp[j];
    DEA_TRY(plant_evaluate(plant, plant->t + h, later, plant_velocity(plant, later, yp), false));
    plant_rates(plant, plant->t + h, later, bends);
    for (int j = 0; j < plant->state_count; j++)
        bends[j] = (bends[j] - yp[j]) / h;
    if (plant->motion == MOTION_ALGEBRAIC)
        bends[plant->x] = 0.0;
    return DEA_OK;
}

/* The first step is one of backward Euler, whose error is h^2 y''/2: y'' from the rates a little later. IDA by itself
 * looks at y' alone and starts far too long where only the rates jumped, far too short where the state is on the move.
 */
double plant_first_step(struct dea_plant *plant, double length) {
    const double *y = NV_DATA_S(plant->y), *yp = NV_DATA_S(plant->yp);
    plant->rates_now = yp;
    double longest = 1e-2 * length, speed = norm(plant, y, yp);
    double shortest = plant->network != ABSENT ? FIRST_OVER_SETTLING * plant->options.settle_time : 0.0;
    double h = fmax(fmin(1e-3 * length, 1.0 / fmax(speed, DBL_MIN)), fmin(shortest, longest));
    for (int i = 0; i < 3; i++) {
        if (find_bends(plant, h) != DEA_OK) {
            h *= 0.01;
            continue;
        }
        double bend = norm(plant, y, NV_DATA_S(plant->rates)), next = bend > 0.0 ? sqrt(0.5 / bend) : longest;
        bool settled = next > 0.3 * h && next < 3.0 * h;
        h = fmin(fmax(next, shortest), longest);
        if (settled)
            break;
    }
    return limit_by_losses(plant, h);
}
