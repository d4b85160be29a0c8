/* IDA's residual and quadrature functions. */
#include "plant/network.h"

int plant_residual(sunrealtype t, N_Vector y, N_Vector yp, N_Vector residual, void *context) {
    struct dea_plant *plant = context;
    const double *u = NV_DATA_S(y), *up = NV_DATA_S(yp);
    double *r = NV_DATA_S(residual);
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
    DEA_TRY(plant_evaluate(plant, t, y, velocity, false));
    bool slack = false;
    for (int k = 0; k < DEA_ZONES; k++)
        slack = slack || (plant->zones[k].present && plant->points[k].film.slack);
    if (slack) /* whose stretch moves with everything */
        DEA_TRY(plant_evaluate(plant, t, y, velocity, true));
    plant_remember(plant, t, y, velocity, slack);
    plant_losses(plant, t, y[plant->x] * plant->scale[plant->x], velocity, losses);
    return DEA_OK;
}

/* The velocity of a massless platform is the integrator's derivative: as good as its positions. From the forces it
 * would be better only while steps are shorter than every time constant; behind a stiff charge, branch or damper they
 * hand on Newton's leftovers and rounding, magnified by step over time constant, and the books with them. */
int plant_quadrature(sunrealtype t, N_Vector y, N_Vector yp, N_Vector rates, void *context) {
    struct dea_plant *plant = context;
    const double *u = NV_DATA_S(y), *up = NV_DATA_S(yp);
    plant->rates_now = up;
    enum dea_status status = plant_quadrature_rates(plant, t, u, plant_pace(plant, u, up), NV_DATA_S(rates));
    return status == DEA_OK ? 0 : 1;
}
