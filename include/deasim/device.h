/* A lumped planar actuator: prestretched membrane, up to two zones, a rigid platform. Constant once read.
 * Energies in J, forces in N, displacement x in m (positive lengthens the left zone). */
#ifndef DEASIM_DEVICE_H
#define DEASIM_DEVICE_H

#include "deasim/material.h"

#define DEA_ZONES 2 /* index 0 "left" (side +1), index 1 "right" (side -1) */

enum dea_electrode_feed { DEA_FEED_LONG_EDGE, DEA_FEED_NARROW_END };

struct dea_zone {
    bool present;                 /* false: no membrane on that side (a dead load may replace it) */
    bool electroded;              /* false: passive */
    double length;                /* l0, prestretched, 0 V, m */
    double electrode_resistance;  /* fixed part of R_e, Ohm (both electrodes together) */
    double sheet_resistance;      /* R_sq, Ohm per square; 0 when not given */
    enum dea_electrode_feed feed; /* where the sheet is fed */
    /* set by dea_device_prepare */
    double side;             /* +1 left, -1 right */
    double volume;           /* w l0 t0, m^3 */
    double per_stretch;      /* C of a film of permittivity 1 over its stretch squared, F */
    double rest_capacitance; /* C at x = 0, F; 0 when passive */
};

struct dea_device {
    char name[64];
    double width;         /* w, m */
    double thickness;     /* t0, prestretched, 0 V, m */
    double prestretch[2]; /* lp1 along the motion, lp2 across */
    struct dea_material material;
    struct dea_zone zones[DEA_ZONES];
    bool right_first;     /* the file names the right zone first: the order of pins in a netlist */
    double platform_mass; /* kg */
    double damping;       /* c, N s/m */
    double load;          /* constant force on the platform, N, positive towards +x */
    bool has_stops;
    double stops[2];       /* x of the lower and upper end stop, m */
    double stop_stiffness; /* N/m; 0 in the input means 1000 times the membrane stiffness, set by prepare */
    double stop_loss;      /* Hunt-Crossley factor chi in F = k d (1 + chi d'), s/m */
    bool membrane_mass;    /* add a third of each zone's mass to the platform */
    bool slack;            /* model slack as a regime; false: only report it */
    /* set by dea_device_prepare */
    double effective_mass; /* m_eff, kg */
    double stiffness;      /* membrane stiffness k0 at x = 0, 0 V, N/m */
};

extern const char *const dea_zone_names[DEA_ZONES]; /* "left", "right" */

/* Fills the derived fields (volume, C0, m_eff, k0, default stop stiffness). Call once after reading or editing.
 * Returns DEA_ERR_INPUT with a message when a value is not physical (length <= 0, both zones missing, ...), but accepts
 * a prestretch that has failed already: see dea_prestretch_fails. */
enum dea_status dea_device_prepare(struct dea_device *device, struct dea_error *error);

/* Frees what the device owns (its branches) and clears it. */
void dea_device_clear(struct dea_device *device);

/* true when the prestretch alone has failed: slack in direction 1 or 2, or beyond the law's limit (physics.md
 * section 10, grey zones). `why` (may be NULL) receives a static text. */
bool dea_prestretch_fails(const struct dea_device *device, const char **why);

/* lam1 of a zone at platform displacement x, geometric (no slack). */
double dea_zone_stretch(const struct dea_device *device, int zone, double x);

/* Capacitance (F) of an electroded zone at stretch lam1 and its first two derivatives by lam1 (may be NULL).
 * Source: corrected eq. 6 of Rosset et al., C = eps w l0 lam1^2 / (lp1^2 t0), eps = eps0 eps_r(lam1). */
double dea_zone_capacitance(const struct dea_device *device, int zone, double lam1, double *slope, double *curvature);

/* True field (V/m) in a zone at voltage V and stretch lam1. */
double dea_zone_field(const struct dea_device *device, double voltage, double lam1);

/* R_e (Ohm) of a zone at stretch lam1 and its derivative by lam1 (may be NULL). */
double dea_zone_resistance(const struct dea_device *device, int zone, double lam1, double *slope);

/* Leakage current (A) through a zone's film at stretch lam1 and film voltage V, with derivatives by V (S) and lam1 (A),
 * which may be NULL. Density sigma(E) E on the deformed area. */
double dea_zone_leakage(const struct dea_device *device, int zone, double lam1, double voltage, double *by_voltage,
                        double *by_stretch);

/* Force of the end stops on the platform (N), with derivatives by x and v; their stored energy (J) and lost power (W).
 * Any output pointer may be NULL. */
double dea_stop_force(const struct dea_device *device, double x, double v, double *df_dx, double *df_dv, double *energy,
                      double *loss);

#endif
