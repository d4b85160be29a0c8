/* IDA's residual and quadrature functions. */
#include "plant/network.h"

int plant_residual(sunrealtype t, N_Vector y, N_Vector yp, N_Vector residual, void *context) {
    struct dea_plant *plant = context;
    const double *u = N_VGetArrayPointer(y), *up = N_VGetArrayPointer(yp);
    double *r = N_VGetArrayPointer(residual);
    double velocity = plant_velocity(plant, u, up);
    plant->rates_now = up;
    if (plant_evaluate(plant, t, u, velocity, false) != DEA_OK)
        return 1;

    /* residual = y' - rate for differential unknowns */
    plant_rates(plant, t, u, r);
    for (int i = 0; i < plant->state_count; i++)
        r[i] = up[i] - r[i];

    /* a massless, undamped platform: force balance, in units of the membrane's stiffness */
    if (plant->motion == MOTION_ALGEBRAIC)
        r[plant->x] = -plant->force / (plant->device->stiffness * plant->scale[plant->x]);
    if (plant->network != ABSENT)
        plant_network_residual(plant, t, u, up, r);
    return 0;
}

enum dea_status plant_quadrature_rates(struct dea_plant *plant, double t, const double *y, double velocity,
                                       double *losses) {
    DEA_TRY(plant_evaluate(plant, t, y, velocity, true));
    if (plant->motion == MOTION_ALGEBRAIC) {
        double *state_rates = N_VGetArrayPointer(plant->rates);
        plant_rates(plant, t, y, state_rates);
        velocity = plant_algebraic_rate(plant, t, state_rates);
    }
    if (plant->motion == MOTION_VISCOUS) /* the force says it more accurately than the integrator's derivative */
        velocity = plant->force / plant->device->damping;
    plant_losses(plant, t, y[plant->x] * plant->scale[plant->x], velocity, losses);
    return DEA_OK;
}

int plant_quadrature(sunrealtype t, N_Vector y, N_Vector yp, N_Vector rates, void *context) {
    struct dea_plant *plant = context;
    const double *u = N_VGetArrayPointer(y), *up = N_VGetArrayPointer(yp);
    plant->rates_now = up;
    return plant_quadrature_rates(plant, t, u, plant_velocity(plant, u, up), N_VGetArrayPointer(rates)) == DEA_OK ? 0
                                                                                                                  : 1;
}
