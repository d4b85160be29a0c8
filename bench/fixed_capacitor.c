/* Writes the deck of a coupled run with plain capacitors where the device is: what the electronics alone would cost.
 * usage: fixed_capacitor SCENE ACCURACY DECK */
#include "cosim/cosim.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static bool starts(const char *line, const char *with) {
    return strncmp(line, with, strlen(with)) == 0;
}

/* .save v(INSTANCE.q0), v(INSTANCE.i0) */
static bool saves_film(const char *line) {
    const char *dot = strrchr(line, '.');
    return starts(line, ".save v(") && strchr("qi", dot[1]) != NULL && strlen(dot) == strlen(".q0)") && dot[3] == ')';
}

/* The generated subcircuit gives way to capacitors; what it offered for saving is saved no more. */
static void write_deck(const struct dea_deck *deck, const struct dea_circuit_device *devices, int count, FILE *file) {
    bool inside = false;
    for (int i = 0; i < deck->line_count; i++) {
        const char *line = deck->lines[i];
        if (deck->origins[i] < 0 && starts(line, ".subckt")) {
            inside = true;
            fprintf(file, "%s\n", line);
            for (int d = 0; d < count; d++)
                for (int p = 0; starts(line + strlen(".subckt "), devices[d].name) && p < devices[d].port_count; p++)
                    fprintf(file, "C%d p%d n%d %.17g\n", p, p, p, devices[d].ports[p].rest_capacitance);
            fputs("Vpos pos 0 0\n", file);
        } else if (inside && starts(line, ".ends")) {
            inside = false;
            fprintf(file, "%s\n", line);
        } else if (starts(line, ".end") && !starts(line, ".ends")) {
            fprintf(file, ".options acct\n%s\n", line);
        } else if (!inside && !(deck->origins[i] < 0 && saves_film(line))) {
            fprintf(file, "%s\n", line);
        }
    }
}

static enum dea_status write_scene(const struct dea_scene *scene, FILE *file, struct dea_error *error) {
    struct dea_netlist netlist = {0};
    struct dea_circuit_device *devices = NULL;
    struct dea_deck deck = {0};
    struct dea_deck_options options;
    double stop;
    enum dea_status status = cosim_read_netlist(scene, false, NULL, &netlist, error);
    if (status == DEA_OK)
        status = cosim_choose_stop(scene, &netlist, &stop, error);
    if (status == DEA_OK)
        status = cosim_describe_devices(scene, &devices, error);
    if (status == DEA_OK) {
        cosim_choose_tolerances(scene, &netlist, stop, 0, &options);
        options.forget_points = false; /* the program ngspice cannot */
        status = dea_deck_build(&netlist, devices, &options, &deck, error);
    }
    if (status == DEA_OK)
        write_deck(&deck, devices, scene->device_count, file);
    dea_deck_clear(&deck);
    free(devices);
    dea_netlist_clear(&netlist);
    return status;
}

int main(int count, char **arguments) {
    struct dea_error error = {.status = DEA_OK};
    struct dea_scene scene = {0};
    if (count != 4) {
        fprintf(stderr, "usage: fixed_capacitor SCENE ACCURACY DECK\n");
        return 2;
    }
    struct dea_override accuracy = {"transient.accuracy", arguments[2]};
    enum dea_status status = dea_scene_read(arguments[1], &accuracy, 1, &scene, &error);
    if (status == DEA_OK && scene.netlist == NULL)
        status = dea_fail(&error, DEA_ERR_INPUT, "fixed_capacitor wants a netlist");
    FILE *file = status == DEA_OK ? fopen(arguments[3], "w") : NULL;
    if (status == DEA_OK && file == NULL)
        status = dea_fail(&error, DEA_ERR_OUTPUT, "cannot write %s", arguments[3]);
    if (status == DEA_OK)
        status = write_scene(&scene, file, &error);
    if (file != NULL && fclose(file) != 0 && status == DEA_OK)
        status = dea_fail(&error, DEA_ERR_OUTPUT, "cannot write %s", arguments[3]);
    if (status != DEA_OK)
        fprintf(stderr, "%s\n", error.text);
    dea_scene_clear(&scene);
    return status == DEA_OK ? 0 : 3;
}
