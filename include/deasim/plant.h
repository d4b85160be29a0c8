/* The DAE of one device in time, integrated by SUNDIALS IDA: platform, branches, film charges, amplifiers. The state
 * layout follows the scene: what a scene does not need has no state. Equations: physics.md sections 4 to 9. */
#ifndef DEASIM_PLANT_H
#define DEASIM_PLANT_H

#include "deasim/film.h"
#include "deasim/network.h"
#include "deasim/report.h"
#include "deasim/result.h"
#include "deasim/waveform.h"

struct dea_plant;

/* How a zone is driven electrically. */
enum dea_port_kind {
    DEA_PORT_PASSIVE, /* no electrode */
    DEA_PORT_IDEAL,   /* voltage given, no resistance anywhere: no electrical state */
    DEA_PORT_SOURCE,  /* voltage source behind resistance or amplifier: the film charge is a state */
    DEA_PORT_NETWORK, /* pins in a linear circuit that is solved along */
    DEA_PORT_CHARGE,  /* film charge given from outside (a circuit) as a cubic in time */
};

struct dea_plant_port {
    enum dea_port_kind kind;
    double resistance;                     /* in series outside the film's own R_e, amplifier output included, Ohm */
    const struct dea_amplifier *amplifier; /* NULL: none */
    double peak;                           /* largest expected |voltage|, V, for scales */
};

struct dea_plant_options {
    double accuracy;  /* A: promised relative error; sets the integrator's tolerance */
    double duration;  /* s, expected length of the run: errors of an undamped device grow with it; 0: unknown */
    double periods;   /* of the fastest drive over that length; 0: none, or unknown */
    double max_step;  /* s, 0: none */
    double load_peak; /* largest expected |load|, N, for scales */
    struct dea_plant_port ports[DEA_ZONES];
    const struct dea_network *network; /* linear circuit of the network ports; NULL: none; must outlive the plant */
    double settle_time;                /* with a network: length of the steps that find its rates after a corner, s */
};

/* Film charge over one circuit step: q(t) = c0 + c1 d + c2 d^2 + c3 d^3, d = t - start; C and s. */
struct dea_charge_piece {
    double start, c[4];
};

/* Inputs that hold until the caller changes them, at a restart. */
struct dea_plant_inputs {
    struct dea_piece source[DEA_ZONES]; /* V, for ideal and source ports */
    struct dea_charge_piece
        charge[DEA_ZONES];           /* for charge ports; may change without a restart when q and q' continue */
    struct dea_piece load;           /* N, added to the device's constant load */
    const struct dea_piece *network; /* per source of the network, V or A; owned by the caller */
};

/* Creates the DAE of a device; the device must outlive it. *plant is freed with dea_plant_destroy, also NULL. */
enum dea_status dea_plant_create(const struct dea_device *device, const struct dea_plant_options *options,
                                 struct dea_plant **plant, struct dea_error *error);
void dea_plant_destroy(struct dea_plant *plant);

/* "x v | left: xi1 xi2 Q | right: ..." for people; returns buffer. */
const char *dea_plant_describe(const struct dea_plant *plant, char *buffer, int size);

/* True when no state has a time derivative: the run is a sequence of equilibria. */
bool dea_plant_is_algebraic(const struct dea_plant *plant);

/* Puts the plant at time t into its start state with the inputs' values there: static equilibrium with relaxed
 * branches, or fresh branches; given x and v override (NULL: none). DEA_ERR_SOLVER with a message when there is no
 * equilibrium. */
enum dea_status dea_plant_start(struct dea_plant *plant, double t, const struct dea_plant_inputs *inputs,
                                enum dea_start start, const double *x, const double *v, struct dea_error *error);

/* Charges (C) that hold given film voltages at rest, for charge ports: fills inputs->charge with constants. Same rest
 * state as dea_plant_start then finds. */
enum dea_status dea_plant_rest_charges(struct dea_plant *plant, const double voltages[DEA_ZONES], enum dea_start start,
                                       const double *x, struct dea_plant_inputs *inputs, struct dea_error *error);

/* Puts new inputs in force at the current time and restarts the integrator with a consistent state; the work done by a
 * jump of an ideal source is booked. */
enum dea_status dea_plant_restart(struct dea_plant *plant, const struct dea_plant_inputs *inputs,
                                  struct dea_error *error);

/* Replaces the charge polynomials without a restart. */
void dea_plant_set_charge(struct dea_plant *plant, int zone, const struct dea_charge_piece *piece);

/* Connects a conductance (S) across a film, for breakdown policy "short"; takes effect at the next restart. */
void dea_plant_short_film(struct dea_plant *plant, int zone, double conductance);

/* Watches these events (bit 1 << kind) by root finding. */
enum dea_status dea_plant_watch(struct dea_plant *plant, unsigned kinds, struct dea_error *error);

/* How the plant will move on from its present time if each film charge keeps its present rate: what a circuit needs to
 * know of it. position(d) = sum of x[i] d^i, d in s from the plant's time, plus a decaying term fast * (1 - exp(-d /
 * settling)) where a massless platform settles faster than the step. */
struct dea_outlook {
    double start;                                     /* s, the plant's time */
    double x[4];                                      /* m, m/s, ... */
    double fast, settling;                            /* m, s; fast is 0 where there is none */
    double soft_gain[DEA_ZONES];                      /* (1/2)(dC/dx)^2 of a taut zone, 0 of a slack one, F^2/m^2 */
    double stiffness, damping, mass;                  /* of the platform at given voltages: N/m, N s/m, kg */
    double charge_stiffness;                          /* of the platform at given charges, N/m */
    double charge[DEA_ZONES], charge_rate[DEA_ZONES]; /* C, A, at start */
    double capacitance[DEA_ZONES];                    /* F, at start */
    /* With inertia: amplitude of the swing about the place where the forces balance (INFINITY where they hold none),
     * that place, and the velocity it moves at. */
    double swing, balance, creep; /* m, m, m/s */
};

/* Looks ahead over a step of about `horizon` (s). DEA_RECOVERABLE outside the model. */
enum dea_status dea_plant_look_ahead(struct dea_plant *plant, double horizon, struct dea_outlook *outlook);

/* Leaves the swing out: a platform with inertia that stays where the forces balance, as far ahead as they creep. */
void dea_outlook_rest(struct dea_outlook *outlook);

/* How much a taut film's capacitance gives way to its own voltage through the platform within a time h (s):
 * d(C)/d(V^2), F/V^2. */
double dea_outlook_softness(const struct dea_outlook *outlook, int zone, double h);

/* Position (m) at time t by an outlook. */
double dea_outlook_position(const struct dea_outlook *outlook, double t);

/* The same with velocity (m/s) and acceleration (m/s^2). */
double dea_outlook_motion(const struct dea_outlook *outlook, double t, double *velocity, double *acceleration);

/* When the position first passes an end stop, to it or off it, within a time `horizon` (s) of the outlook's start: s,
 * INFINITY when it does not. */
double dea_outlook_contact(const struct dea_outlook *outlook, const struct dea_device *device, double horizon);

/* One film as the circuit sees it. */
struct dea_film_outlook {
    double stretch, capacitance; /* 1, F */
    bool slack;
    double softness; /* of a slack film: d(C)/d(V^2) by its natural stretch, F/V^2; 0 when taut */
};

/* A zone's film `ahead` s after the last look ahead, at a position (m) and a charge (C); branches go on at the rates
 * they had. DEA_RECOVERABLE outside the model. */
enum dea_status dea_plant_imagine_film(struct dea_plant *plant, int zone, double ahead, double x, double charge,
                                       struct dea_film_outlook *film);

/* The force (N) by which an outlook's motion fails the platform's balance at time t when the films hold these charges
 * (C): it grows where charges leave the foreseen course, films turn slack or taut, or a stop is met. DEA_RECOVERABLE
 * outside the model. */
enum dea_status dea_plant_imagine_defect(struct dea_plant *plant, const struct dea_outlook *outlook, double t,
                                         const double charges[DEA_ZONES], double *defect);

/* What one step met. */
struct dea_step {
    double from, to; /* s; dense output is valid in between */
    bool root;       /* stopped at a root: see dea_plant_roots */
};

/* One integrator step, not past `limit`. DEA_ERR_SOLVER with the last steps and the reason when it cannot go on. */
enum dea_status dea_plant_step(struct dea_plant *plant, double limit, struct dea_step *step, struct dea_error *error);

/* Told of one event; zone is -1 for the platform. `cleared`: back on the safe side. */
typedef void (*dea_event_found)(void *context, enum dea_event_kind kind, int zone, bool cleared);

/* Calls back for each event whose root ended the last step. */
void dea_plant_roots(struct dea_plant *plant, dea_event_found found, void *context);

/* Calls back for conditions that changed without a root: at the start, and over a jump of the inputs. */
void dea_plant_conditions(struct dea_plant *plant, dea_event_found found, void *context);

/* Signals: names and units of what dea_plant_signals fills, dea_plant_signal_count of them. */
int dea_plant_signal_count(const struct dea_plant *plant);
void dea_plant_signal(const struct dea_plant *plant, int index, struct dea_signal *signal);

/* Groups of signals that are worked out together. */
enum dea_signal_group { DEA_SIGNALS_PLATFORM = 1, DEA_SIGNALS_ZONES = 2, DEA_SIGNALS_ENERGY = 4, DEA_SIGNALS_ALL = 7 };
enum dea_signal_group dea_plant_signal_group(const struct dea_plant *plant, int index);

/* Signals of the wanted groups (a set of them) at time t within the last step (or at its end); values of the others are
 * left alone. */
enum dea_status dea_plant_signals(struct dea_plant *plant, double t, unsigned wanted, double *values,
                                  struct dea_error *error);

/* The unknowns of the linear circuit (V, then A) at time t within the last step, and the platform's position (m). */
enum dea_status dea_plant_network(struct dea_plant *plant, double t, double *unknowns, double *x,
                                  struct dea_error *error);

/* Energy balance since the start, at the end of the last step. */
enum dea_status dea_plant_energy(struct dea_plant *plant, struct dea_energy *energy, struct dea_error *error);

/* Integrator statistics so far, restarts included. */
void dea_plant_stats(const struct dea_plant *plant, struct dea_run_stats *stats);

/* How many times the motion since the start has multiplied small errors, beyond what the platform would at its
 * stiffness of rest. */
double dea_plant_sensitivity(const struct dea_plant *plant);

double dea_plant_time(const struct dea_plant *plant);

/* Free oscillations over which an error is carried on: those of the run, or those before damping has wiped it out. */
double dea_plant_remembered_cycles(const struct dea_plant *plant);

#endif
