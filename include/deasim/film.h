/* One membrane zone as the platform and the circuit see it: pull, voltage, charge, slack, at a given platform
 * displacement, electrical state and branch states. Energies follow physics.md sections 3 to 7. */
#ifndef DEASIM_FILM_H
#define DEASIM_FILM_H

#include "deasim/device.h"

/* Which electrical quantity of the zone is given. */
enum dea_control { DEA_CONTROL_PASSIVE, DEA_CONTROL_CHARGE, DEA_CONTROL_VOLTAGE };

/* Answer of a zone. `e` stands for the given electrical quantity (C or V), z[j] for the branch states.
 * Derivatives other than dlam_dx are filled only when asked for. */
struct dea_film {
    double lam;           /* effective stretch lam1: geometric when taut, natural when slack */
    bool slack;           /* the film is buckled: zero pull, lam > geometric stretch */
    double margin;        /* net nominal stress at the geometric stretch, Pa; < 0 exactly when slack */
    double p1;            /* nominal stress of spring and branches, Pa */
    double capacitance;   /* F, 0 when passive */
    double voltage;       /* V */
    double charge;        /* C */
    double stiffness;     /* d2 E_total/dx2 of the zone at given voltage and frozen branches, N/m; 0 when slack */
    double pull;          /* force with which the zone pulls the platform to its own side of the frame, N, >= 0 */
    double dlam_dx;       /* 1/m */
    double dlam_de;       /* 1/C or 1/V */
    double dlam_dp1;      /* 1/Pa: change of lam by a branch stress at fixed lam; 0 when taut */
    double dpull_dx;      /* N/m */
    double dpull_de;      /* N/C or N/V */
    double dpull_dp1;     /* N/Pa: change of pull by a branch stress; 0 when slack */
    double dvoltage_dlam; /* V, at fixed e (0 under voltage control) */
    double dvoltage_de;   /* direct part, at fixed lam */
    double dcharge_dlam;  /* C, at fixed e (0 under charge control) */
    double dcharge_de;    /* direct part, at fixed lam */
};

/* Evaluates a zone. `states` holds branch_count pairs z; `branches` receives each branch's response at the effective
 * stretch. DEA_RECOVERABLE when the state lies outside the model. */
enum dea_status dea_film_respond(const struct dea_device *device, int zone, enum dea_control control, double x,
                                 double e, const double *states, bool with_derivatives,
                                 struct dea_branch_response *branches, struct dea_film *film);

/* Stored energy of a zone (J): springs, branches and Q^2/(2C), at an effective stretch and charge. */
enum dea_status dea_film_energy(const struct dea_device *device, int zone, double lam, double charge,
                                const double *states, double *energy);

/* True stress in direction 2 (Pa): lam2 dW/dlam2 + branches - eps E^2, physics.md section 7. */
enum dea_status dea_film_stress2(const struct dea_device *device, int zone, double lam, double voltage,
                                 const struct dea_branch_response *branches, double *stress2);

#endif
