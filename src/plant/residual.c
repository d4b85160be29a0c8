/* IDA's residual and quadrature functions. */
#include "plant/plant_internal.h"

int plant_residual(sunrealtype t, N_Vector y, N_Vector yp, N_Vector residual, void *context) {
    struct dea_plant *plant = context;
    const double *u = N_VGetArrayPointer(y), *up = N_VGetArrayPointer(yp);
    double *r = N_VGetArrayPointer(residual);
    double velocity = plant_velocity(plant, u, up);
    if (plant_evaluate(plant, t, u, velocity, false) != DEA_OK)
        return 1;

    /* residual = y' - rate for differential unknowns */
    plant_rates(plant, t, u, r);
    for (int i = 0; i < plant->state_count; i++)
        r[i] = up[i] - r[i];

    /* a massless, undamped platform: force balance, in units of the membrane's stiffness */
    if (plant->motion == MOTION_ALGEBRAIC)
        r[plant->x] = -plant->force / (plant->device->stiffness * plant->scale[plant->x]);
    return 0;
}

int plant_quadrature(sunrealtype t, N_Vector y, N_Vector yp, N_Vector rates, void *context) {
    struct dea_plant *plant = context;
    const double *u = N_VGetArrayPointer(y), *up = N_VGetArrayPointer(yp);
    double rate_x = plant_velocity(plant, u, up);
    if (plant_evaluate(plant, t, u, rate_x, plant->charge_driven) != DEA_OK)
        return 1;
    if (plant->charge_driven && plant->motion == MOTION_ALGEBRAIC) {
        double *state_rates = N_VGetArrayPointer(plant->rates);
        plant_rates(plant, t, u, state_rates);
        rate_x = plant_algebraic_rate(plant, t, state_rates);
    }
    plant_losses(plant, t, u[plant->x] * plant->scale[plant->x], rate_x, N_VGetArrayPointer(rates));
    return 0;
}
