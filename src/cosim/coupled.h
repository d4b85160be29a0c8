/* One device in a circuit: its plant, the charge the circuit delivered since the last exchange, and the capacitances
 * the circuit is told until the next one. */
#ifndef DEASIM_COSIM_COUPLED_H
#define DEASIM_COSIM_COUPLED_H

#include "circuit/engine.h"
#include "cosim/observer.h"
#include "cosim/window.h"

/* The circuit's side of the energy balance, J. */
struct port_books {
    double film_work, resistive, leakage;
};

/* What the circuit is told of a film: Q = c V + q0 and what goes with it. */
struct told_film {
    double c, q0;               /* F, C */
    double stretch, resistance; /* 1, Ohm */
    bool slack;
};

struct coupled {
    const struct dea_device *device;
    struct dea_plant *plant;
    const struct dea_waveform *load; /* NULL: only the device's constant load */
    struct dea_plant_inputs inputs;  /* in force */
    int port_count;
    int zones[DEA_ZONES];             /* zone of each port */
    struct window windows[DEA_ZONES]; /* per port */
    struct dea_outlook outlook;       /* since the last exchange */
    double horizon;                   /* how long the outlook is meant to hold, s */
    double allowed_mismatch;          /* relative, of a told capacitance, that one exchange may find */
    double drift; /* largest relative error of a told capacitance, from how the outlook fails the platform's balance */
    double defect, strayed, straying; /* N, m, m/s: that failure when last compared, and where it has led to */
    double compared_at, compared_charge[DEA_ZONES]; /* s, C per port */
    /* what the circuit is told at `told_at` */
    double told_at; /* s */
    struct told_film told[DEA_ZONES];
    double position; /* m */
    /* what the last outlook missed, faded out over the horizon: no jump excites the circuit */
    double fading[DEA_ZONES], fading_position; /* F, m, at the start of the outlook */
    double last_told[DEA_ZONES];               /* F, at the end of the last outlook */
    struct port_books books, books_at_exchange;
    bool pending;              /* the interval to the last point has not been booked yet */
    double shorted[DEA_ZONES]; /* conductance of a punctured film, S, per port */
    bool watched;              /* for breakdown: it ends an outlook at once */
    bool slack[DEA_ZONES];     /* at the last circuit point, per port */
    bool turned;               /* a film went slack or taut with that point */
    /* a smaller swing, relative to the capacitances and to the displacement, is left out of the outlook */
    double rest_capacitance, rest_position;
    double largest_position;          /* m, so far */
    bool at_rest;                     /* the present outlook has no swing */
    double largest_charge[DEA_ZONES]; /* C, so far */
};

/* Electroded zones in the order of their pins; returns how many. */
int coupled_order_ports(const struct dea_device *device, int zones[DEA_ZONES]);

/* What a run expects of its plants. */
struct coupled_demand {
    double accuracy; /* relative */
    double duration; /* s */
    double peak;     /* largest voltage at a port, V */
    bool breakdown;  /* breakdown has consequences */
    /* A swing need not be foreseen below these parts of the capacitances and of the displacement; 0: all are. */
    double rest_capacitance, rest_position;
};

/* Creates the plant with one charge port per electroded zone. */
enum dea_status coupled_create(struct coupled *coupled, const struct dea_device *device,
                               const struct dea_waveform *load, const struct coupled_demand *demand,
                               struct dea_error *error);
void coupled_clear(struct coupled *coupled);

/* Rests the device at these film voltages (per port): start state and outlook. */
enum dea_status coupled_rest(struct coupled *coupled, const double *film_voltages, enum dea_start start,
                             const double *x, const double *v, struct dea_error *error);

/* Film charge of a port at the last circuit point, C. */
double coupled_charge(const struct coupled *coupled, int port);

/* When the platform is foreseen to meet or leave an end stop within `horizon` (s): s; INFINITY otherwise. */
double coupled_next_contact(const struct coupled *coupled, double horizon);

/* Next corner of the load after the plant's time, s; INFINITY without one. */
double coupled_next_corner(const struct coupled *coupled);

/* What the circuit asks at time t. */
double coupled_tell(struct coupled *coupled, int port, enum dea_external which, double t);

/* Takes in an accepted circuit point: `ports` of this device. Work and rows follow one point later, when the rates of
 * charge are known, or at the exchange. */
enum dea_status coupled_take(struct coupled *coupled, int index, double from, double to,
                             const struct dea_port_sample *ports, struct observer *observer, struct dea_error *error);

/* Shorts films (bit 1 << zone) from the circuit's next step on. */
void coupled_short(struct coupled *coupled, unsigned zones);

/* Moves the plant to the last taken point, or to an event that stops the run. `mismatch` is the largest relative
 * difference between the capacitance foreseen and the one the plant has, `policy` the strongest wish of events met.
 * Films that are to be shorted are so for the circuit's next step. `fit_tolerance` is that of charge fits (s, of the
 * square of the largest charge); below 0: none, every point is a piece of its own. */
struct exchange {
    double mismatch;
    enum dea_policy policy;
};
enum dea_status coupled_advance(struct coupled *coupled, int index, double fit_tolerance, struct observer *observer,
                                struct exchange *exchange, struct dea_error *error);

/* Then a new outlook over `horizon` (s). */
enum dea_status coupled_renew(struct coupled *coupled, double horizon, struct dea_error *error);

#endif
