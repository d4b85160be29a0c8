/* Scenes with their device, material and waveform file, and settings as the command line gives them. */
#include "deasim/scene.h"
#include "fuzz.h"

#include <math.h>
#include <string.h>

#define SETTINGS_MAX 8

static const char *const names[] = {"scene.yaml", "device.yaml", "material.yaml", "wave.csv"};

/* The lines key=value of the fifth part. */
static size_t find_settings(char *text, struct dea_override *settings) {
    size_t count = 0;
    for (char *line = strtok(text, "\n"); line != NULL && count < SETTINGS_MAX; line = strtok(NULL, "\n")) {
        char *equals = strchr(line, '=');
        if (equals == NULL || equals == line)
            continue;
        *equals = '\0';
        settings[count++] = (struct dea_override){.key = line, .value = equals + 1};
    }
    return count;
}

static void check_device(const struct dea_device *device) {
    fuzz_require(isfinite(device->width) && device->width > 0.0, "a width is positive");
    fuzz_require(isfinite(device->thickness) && device->thickness > 0.0, "a thickness is positive");
    fuzz_require(isfinite(device->stiffness), "a stiffness is finite");
}

static void check_scene(const struct dea_scene *scene) {
    fuzz_require(scene->device_count > 0, "there is a device");
    for (int i = 0; i < scene->device_count; i++)
        check_device(&scene->devices[i].device);
    fuzz_require(scene->netlist != NULL || scene->has_transient, "a native scene has its end");
    fuzz_require(!scene->has_transient || (isfinite(scene->stop) && scene->stop > 0.0), "the end is positive");
    fuzz_require(scene->accuracy > 0.0 && scene->accuracy < 1.0, "the accuracy is sensible");
    fuzz_require(isfinite(scene->sample) && scene->sample >= 0.0, "the sample time is sensible");
    for (int zone = 0; zone < DEA_ZONES && scene->netlist == NULL; zone++)
        fuzz_require(isfinite(dea_waveform_value(&scene->sources[zone].waveform, 0.5 * scene->stop)),
                     "a source has a value");
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    static char text[4096];
    struct dea_override settings[SETTINGS_MAX];
    struct dea_scene scene;
    struct dea_device device;
    struct dea_error error = {0};
    size_t length;
    const uint8_t *part = fuzz_find_part(data, size, 4, &length);
    length = part == NULL || length >= sizeof text ? 0 : length;
    if (length > 0)
        memcpy(text, part, length);
    text[length] = '\0';
    size_t count = find_settings(text, settings);

    fuzz_write_parts(data, size, names, 4);
    if (fuzz_judge(dea_scene_read("scene.yaml", settings, count, &scene, &error), &error))
        check_scene(&scene);
    dea_scene_clear(&scene);
    error = (struct dea_error){0};
    if (fuzz_judge(dea_device_read("device.yaml", settings, count, &device, &error), &error))
        check_device(&device);
    dea_device_clear(&device);
    return 0;
}
