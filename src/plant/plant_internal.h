/* The plant's inside, shared by the files of this room. Unknowns are scaled: y_i = state_i / scale_i, so that
 * tolerances and pivots see numbers of order one. */
#ifndef DEASIM_PLANT_INTERNAL_H
#define DEASIM_PLANT_INTERNAL_H

#include "deasim/plant.h"

#include <idas/idas.h>
#include <nvector/nvector_serial.h>
#include <sundials/sundials_linearsolver.h>
#include <sundials/sundials_matrix.h>

enum { ABSENT = -1, MAX_EVENTS = DEA_EVENT_COUNT * (DEA_ZONES + 1), MAX_LIMITS = 2 * DEA_ZONES };

/* Parts of the energy balance carried as quadratures. */
enum plant_loss {
    LOSS_WORK,
    LOSS_LOAD,
    LOSS_BRANCH,
    LOSS_DAMPING,
    LOSS_RESISTIVE,
    LOSS_LEAKAGE,
    LOSS_STOP,
    LOSS_COUNT
};

/* How the platform's position is found. */
enum plant_motion {
    MOTION_INERTIAL,  /* x' = v, m v' = force */
    MOTION_VISCOUS,   /* m = 0: c x' = force */
    MOTION_ALGEBRAIC, /* m = 0, c = 0: force = 0 */
};

/* Where a zone's states are; ABSENT where it has none. */
struct zone_layout {
    bool present;
    enum dea_port_kind kind;
    enum dea_control control;
    bool resistive;                /* an electrode resistance lies between the pins and the film */
    int branch;                    /* first of 2 branch_count states */
    int charge;                    /* film charge */
    int amplifier;                 /* commanded voltage behind slew limit and pole */
    double pole;                   /* of the amplifier, rad/s */
    double slew;                   /* V/s */
    int current_limit, slew_limit; /* which of the plant's limits */
};

/* A limit of an amplifier, and whether it holds for now: 0 not, 1 or -1 upwards or downwards. */
enum { LIMIT_UNDECIDED = 2 }; /* wherever it is exceeded */
struct held_limit {
    int zone;
    bool of_slew; /* of the commanded voltage's rate; otherwise of the current */
    int held;
    bool turns;      /* begins or ends to hold with the next step */
    double demanded; /* what is limited, in units of the limit, when it turned */
    double turned;   /* s: when it last changed */
    int quick_turns; /* changes in a row that came all but at once */
};

/* Whether a stop pushes; as long as that is undecided, where the platform is beyond it. See events.c. */
enum held_stop { STOP_UNDECIDED, STOP_OFF, STOP_ON };

/* One zone evaluated at a state. Partial derivatives of the film current are at fixed charge/voltage and stretch. */
struct zone_point {
    struct dea_film film;
    struct dea_branch_response *branches;
    double *states;     /* branch states, unscaled */
    double e, e_rate;   /* given electrical quantity (C or V) and its rate when imposed from outside */
    double emf;         /* V behind the series resistance */
    double emf_rate;    /* V/s, for an imposed emf */
    double current;     /* into the port, A */
    double demand;      /* the same without the amplifier's limit, A */
    double leak;        /* through the film, A */
    double charge_rate; /* dQ/dt of an imposed voltage or charge, A; for the signals */
    double current_v, current_emf, current_lam; /* derivatives of current */
    double leak_v, leak_lam;                    /* derivatives of leak */
};

/* How far a film is from going slack in the near future, to first order. */
struct tension_ahead {
    bool slack;
    double lam;       /* stretch at the last look ahead */
    double slope;     /* of the elastic energy and the branches' by stretch there, J */
    double stiffness; /* its slope by stretch, J */
    double rate;      /* its slope by time as the branches go on, W */
};

/* The state whose evaluation may be used again: see plant_remember. */
struct known_state {
    bool valid, with_derivatives;
    double t, rate_x; /* s, m/s */
    double *y;        /* scaled unknowns */
};

/* Spread of errors made at all times alike, variances in the same unit, s; see sensitivity.c. */
struct error_spread {
    double xx, xv, vv;    /* as they grow */
    double calm;          /* as they would at the stiffness of rest */
    double sum, calm_sum; /* over time, s^2 */
    /* at the end of the last step: m; N/m and Pa of each film */
    double x, stiffness[DEA_ZONES], margin[DEA_ZONES];
};

struct dea_plant {
    const struct dea_device *device;
    struct dea_plant_options options;
    struct dea_plant_inputs inputs;

    /* layout */
    enum plant_motion motion;
    int x, v; /* v is ABSENT without mass */
    struct zone_layout zones[DEA_ZONES];
    int state_count;
    double *scale;                       /* SI per unit of each unknown */
    int network, network_count;          /* first unknown of the linear circuit, ABSENT without; how many */
    double *row_scale;                   /* of the circuit's rows, A or V */
    double ringing, creep;               /* what the circuit remembers: cycles of its own, s; see network_modes.c */
    double short_conductance[DEA_ZONES]; /* S */

    /* scratch of the last evaluation */
    const double *rates_now; /* scaled derivatives that go with the state being evaluated; NULL: none known */
    struct zone_point points[DEA_ZONES];
    double *imagined_states; /* of one film in the near future, with its branches */
    struct dea_branch_response *imagined_branches;
    struct tension_ahead tension[DEA_ZONES];
    struct known_state known;
    double force;            /* on the platform without damping, N */
    double force_x, force_v; /* its derivatives from load and stops, N/m, N s/m */
    double stop_loss;        /* W */

    /* integrator */
    SUNContext context;
    void *ida;
    N_Vector y, yp, id, rates, sample_y, sample_yp, kept_yp, quad, sample_quad;
    SUNMatrix matrix;
    SUNLinearSolver solver;
    double *largest;              /* running maximum of |y_i|, for the weights */
    bool *follows;                /* unknowns whose errors are weighed by the displacement's size */
    double resistance;            /* to motion: damping, and branches at the natural frequency, N s/m */
    double relaxing[DEA_ZONES];   /* stiffness of each zone's branches that relax within a swing, N/m */
    bool keeps_charge[DEA_ZONES]; /* films that cannot be charged within a swing */
    struct error_spread spread;
    double rtol, rounding; /* of a step, relative and, per scaled unknown, absolute */
    int *slots;            /* place of entry (row, column) in the matrix data, ABSENT outside the pattern */
    bool sparse, slack_pattern;
    sunindextype *column_starts, *entry_rows; /* the sparse pattern; IDA wipes the matrix's own before each Jacobian */
    double t, t_previous;
    double restarted_at; /* s; the interpolant reaches back to here */
    bool integrating;    /* IDA holds a valid history */

    /* events */
    int event_count;
    struct {
        enum dea_event_kind kind;
        int zone;
        int sign;
    } roots[MAX_EVENTS];
    int root_hits[MAX_EVENTS + MAX_LIMITS]; /* those of the limits behind those of the events */
    bool violated[MAX_EVENTS];              /* as last told to the caller */
    bool
        bent; /* a film or stop began or ceased to pull: a bend of the forces, from which the next step starts afresh */
    enum held_stop stops_held[2]; /* lower, upper; of a platform without mass and damping */
    int limit_count;
    struct held_limit limits[MAX_LIMITS];

    /* audit */
    double stored_at_start;     /* J */
    double imposed_at_start[2]; /* J: electrical; load times x (plant_imposed_energy) */
    double jump_work[2];        /* J, booked at jumps: electrical, load */
    double start_x;             /* m */
    double moved;               /* J, sum over steps of |electrical work| + |load work| */
    double work_seen[2];        /* J, both at the last step */
    double kinetic;             /* J, largest so far */

    /* statistics of finished integrator stretches */
    struct dea_run_stats stats;
    struct {
        double t, h;
        int order;
    } trail[8]; /* last steps, for diagnosis */
    long trail_length;
    int quiet_steps;     /* in a row, with an inertia that has come to rest; see note_quiet */
    bool low_order;      /* the integrator is held to order 2 */
    int standstill;      /* steps in a row without progress in time */
    int crawl_steps;     /* steps since crawl_from */
    double crawl_from;   /* s */
    const char *trouble; /* why the residual last refused a state, static text */
    double trouble_t;    /* s, end of the step in which it did */
};

/* Of numbers that are numbers; fmax is a call. */
static inline double larger(double a, double b) {
    return a > b ? a : b;
}

/* layout.c */
enum dea_status plant_lay_out(struct dea_plant *plant, struct dea_error *error);

/* evaluate.c: fills points and force at time t from scaled unknowns. */
enum dea_status plant_evaluate(struct dea_plant *plant, double t, const double *y, double rate_x,
                               bool with_derivatives);
/* Notes that points and force are those of this state: evaluating it again, within rounding, is free until another one
 * is evaluated, or until inputs or limits change and it is forgotten. */
void plant_remember(struct dea_plant *plant, double t, const double *y, double rate_x, bool with_derivatives);
void plant_forget(struct dea_plant *plant);
/* Right side of each differential unknown (scaled), with 0 for algebraic ones. Uses the last evaluation. */
void plant_rates(const struct dea_plant *plant, double t, const double *y, double *rates);
/* Rates of the energy balance, W, LOSS_COUNT of them. Uses the last evaluation. */
void plant_losses(const struct dea_plant *plant, double t, double x, double rate_x, double *losses);
/* Velocity of the platform from the unknowns (m/s); `yp` serves the massless cases. */
double plant_velocity(const struct dea_plant *plant, const double *y, const double *yp);
/* The same where 0 will not do for a platform without mass and damping, which only the integrator's derivative knows.
 */
double plant_pace(const struct dea_plant *plant, const double *y, const double *yp);
/* d(lam)/dt of an electroded zone, 1/s. Uses the last evaluation, with derivatives where the film is slack. */
double plant_stretch_rate(const struct dea_plant *plant, int zone, double rate_x);
/* dx/dt of a massless, undamped platform, from the derivative of the force balance. Uses the last evaluation. */
double plant_algebraic_rate(const struct dea_plant *plant, double t, const double *rates);

/* jacobian.c */
/* Loss rates at a state and the platform's velocity (m/s), evaluating it. */
enum dea_status plant_quadrature_rates(struct dea_plant *plant, double t, const double *y, double velocity,
                                       double *losses);
enum dea_status plant_make_matrix(struct dea_plant *plant, struct dea_error *error);
int plant_jacobian(sunrealtype t, sunrealtype cj, N_Vector y, N_Vector yp, N_Vector residual, SUNMatrix matrix,
                   void *context, N_Vector tmp1, N_Vector tmp2, N_Vector tmp3);

/* residual.c */
int plant_residual(sunrealtype t, N_Vector y, N_Vector yp, N_Vector residual, void *context);
int plant_quadrature(sunrealtype t, N_Vector y, N_Vector yp, N_Vector rates, void *context);

/* balance.c: equilibria */
/* Platform position where the net force vanishes at given electrical state, from x0 downhill to the first one. */
typedef enum dea_status (*balance_force)(void *context, double x, double *force);
enum dea_status plant_find_balance(balance_force force, void *context, double x0, double stride, double force_scale,
                                   double *x);
/* Static equilibrium of a device with relaxed branches at given film voltages and extra load; any number of zones. */
enum dea_status plant_find_equilibrium(const struct dea_device *device, const double voltages[DEA_ZONES], double load,
                                       double *x);

/* events.c */
/* A platform without mass, or damped too much to swing. */
bool plant_is_light(const struct dea_plant *plant);
/* Leaves it to the position whether stops push, as long as the platform is put to its place; decides it for the steps
 * to come, by the events that have been told. */
void plant_release_stops(struct dea_plant *plant);
void plant_hold_stops(struct dea_plant *plant);
int plant_root_functions(sunrealtype t, N_Vector y, N_Vector yp, sunrealtype *values, void *context);

/* signals.c */
/* Energy stored in films, platform and stops, J. Uses the last evaluation. */
enum dea_status plant_stored_energy(struct dea_plant *plant, const double *y, double *energy);
/* [0] sum of Q V / 2 over the ports, [1] load times x (J): boundary terms of the imposed
 * work. Uses the last evaluation.
 */
void plant_imposed_energy(const struct dea_plant *plant, double t, double x, double imposed[2]);

#endif
