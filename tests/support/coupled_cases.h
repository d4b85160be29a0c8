/* Drive circuits and devices on which the coupling is judged: those of the examples, and others that had no part in its
 * calibration. */
#ifndef DEASIM_TEST_COUPLED_CASES_H
#define DEASIM_TEST_COUPLED_CASES_H

#include "circuits.h"

#define TWO_ZONES "base: " SOURCE_ROOT "/models/planar_c_s5.yaml"
#define ELASTIC "base: " SOURCE_ROOT "/models/planar_c_elastic.yaml"
#define NO_MASS "options: {membrane_mass: false}, platform: {mass: 0 kg}"
#define SILENT_EVENTS "events: {breakdown: ignore, slack: ignore, stress2: ignore, limit: ignore, stability: ignore}"

struct coupled_case {
    const char *name, *device; /* the device as a YAML mapping */
    struct drive_circuit circuit;
    bool native; /* the leads are sources with resistance: they can be run natively as well */
};

/* All cases; NULL for an unknown name. */
const struct coupled_case *list_cases(size_t *count);
const struct coupled_case *find_case(const char *name);

#endif
