/* A folder of small valid files that the tests of the scene reader change one at a time. */
#ifndef DEASIM_TEST_SCENE_FILES_H
#define DEASIM_TEST_SCENE_FILES_H

#include <assert.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static const struct scene_file {
    const char *name, *text;
} scene_files[] = {
    {"material.yaml", "elastic: {law: gent, mu: 0.365 MPa, jm: 16.6}\n"
                      "branches:\n"
                      "  - {kind: foo, mu: 29.2 kPa, tau: 2 ms}\n"
                      "dielectric: {permittivity: 2.5, breakdown: 100 V/um, conductivity: 0 S/m}\n"
                      "density: 1120 kg/m^3\n"},
    {"device.yaml", "geometry:\n"
                    "  width: 30 mm\n"
                    "  thickness: 33 um\n"
                    "  prestretch: [1.2, 1.2]\n"
                    "material: material.yaml\n"
                    "zones:\n"
                    "  left: {length: 4 mm, electrode: {resistance: 0 Ohm}}\n"
                    "  right: {length: 4 mm}\n"
                    "platform: {mass: 0.428 g, damping: 0 N s/m, load: 0 N, stops: [-3 mm, 3 mm]}\n"
                    "options: {membrane_mass: true, slack: true}\n"},
    {"scene.yaml", "title: Test\n"
                   "device: device.yaml\n"
                   "drive:\n"
                   "  left: {waveform: {type: dc, level: 3300 V}, resistance: 1 MOhm}\n"
                   "transient: {stop: 400 ms, accuracy: 1e-4}\n"
                   "events: {breakdown: stop, slack: warn}\n"
                   "output: {sample: 0.1 ms, formats: [csv, raw]}\n"
                   "expect:\n"
                   "  - {signal: x, measure: max, above: 0.40 mm, below: 0.46 mm}\n"},
    {"two.yaml", "devices: {DEA: device.yaml, DEB: device.yaml}\n"
                 "drive: {netlist: drive.cir}\n"},
    {"drive.cir", "a netlist\n"
                  ".end\n"},
    {"gap.csv", "time [ms], voltage [V]\n"
                "0, 0\n"
                "1,\n"
                "2, 100\n"},
    {"back.csv", "time [ms], voltage [V]\n"
                 "0, 0\n"
                 "2, 50\n"
                 "1, 100\n"},
    {"unitless.csv", "time, voltage\n"
                     "0, 0\n"
                     "1, 100\n"},
    {"comment.yaml", "# nothing\n"},
    {"list.yaml", "- 1\n"
                  "- 2\n"},
    {"text.yaml", "width:30 mm\n"},
    {"a.yaml", "base: b.yaml\n"},
    {"b.yaml", "base: a.yaml\n"},
    {"self.yaml", "base: self.yaml\n"},
    {"law.yaml", "base: material.yaml\n"
                 "elastic: {law: neo_hookean, mu: 1 MPa}\n"},
};

#define SCENE_FILE_COUNT (sizeof scene_files / sizeof scene_files[0])

static inline void write_bytes(const char *name, const void *bytes, size_t size) {
    FILE *file = fopen(name, "wb");
    if (file == NULL || fwrite(bytes, 1, size, file) != size || fclose(file) != 0) {
        perror(name);
        abort();
    }
}

static inline void write_text(const char *name, const char *text) {
    write_bytes(name, text, strlen(text));
}

static inline const char *original_text(const char *name) {
    for (size_t i = 0; i < SCENE_FILE_COUNT; i++)
        if (strcmp(scene_files[i].name, name) == 0)
            return scene_files[i].text;
    return NULL;
}

static inline void write_scene_files(void) {
    static const char garbage[] = {0, 1, 0x7f, 'E', 'L', 'F', 2};
    for (size_t i = 0; i < SCENE_FILE_COUNT; i++)
        write_text(scene_files[i].name, scene_files[i].text);
    write_text("empty.yaml", "");
    write_bytes("garbage.yaml", garbage, sizeof garbage);
}

/* Makes and enters a fresh folder below the working one; group setup. */
static inline int enter_scene_folder(void **state) {
    (void)state;
    char folder[] = "scene_files_XXXXXX";
    if (mkdtemp(folder) == NULL || chdir(folder) != 0)
        return -1;
    write_scene_files();
    return 0;
}

/* Leaves the folder and removes it with what the tests wrote there; group teardown. */
static inline int leave_scene_folder(void **state) {
    (void)state;
    char command[4200], folder[4096];
    if (getcwd(folder, sizeof folder) == NULL || strstr(folder, "scene_files_") == NULL || chdir("..") != 0)
        return -1;
    snprintf(command, sizeof command, "rm -r '%s'", folder);
    return system(command) == 0 ? 0 : -1;
}

#endif
