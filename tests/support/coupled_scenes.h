/* Scenes with netlists of every kind the coupling must stand: judged by their books, and by what a tenth of the
 * accuracy changes. */
#ifndef DEASIM_TEST_COUPLED_SCENES_H
#define DEASIM_TEST_COUPLED_SCENES_H

#include <stddef.h>

struct coupled_scene {
    const char *name;
    const char *device; /* YAML lines of the scene: device or devices */
    const char *netlist;
    double stop;       /* s; 0: the netlist's .tran */
    const char *extra; /* further lines of the scene */
};

const struct coupled_scene *list_scenes(size_t *count);

#endif
