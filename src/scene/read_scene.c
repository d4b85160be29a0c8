/* Scene files: everything a run needs, checked. */
#include "scene/readers.h"

#include "deasim/quantity.h"
#include "scene/compose.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#define MAX_DEVICES 64
#define MAX_PERIODS 1e8        /* of a waveform within a run */
#define LONGEST_DEVICE_NAME 31 /* so that "NAME.left.port_voltage" stays short */

const char *const dea_event_names[DEA_EVENT_COUNT] = {"breakdown", "slack", "stress2", "limit", "stability", "stop"};

/* ---- devices ---- */

/* The name becomes a subcircuit of the netlist, where case does not count. */
static enum dea_status check_device_name(const struct dea_node *key, const struct dea_scene *scene,
                                         struct dea_error *error) {
    size_t length = strlen(key->text);
    bool good = length > 0 && length <= LONGEST_DEVICE_NAME && isalpha((unsigned char)key->text[0]);
    for (const char *p = key->text; *p != '\0' && good; p++)
        good = isalnum((unsigned char)*p) || *p == '_';
    if (!good)
        return dea_node_fail(key, error,
                             "'%.60s' cannot name a subcircuit; allowed: a letter, then letters, digits and _, "
                             "at most 31",
                             key->text);
    for (int i = 0; i < scene->device_count; i++)
        if (strcasecmp(scene->devices[i].name, key->text) == 0)
            return dea_node_fail(key, error, "'%s' and '%s' are the same name in a netlist", scene->devices[i].name,
                                 key->text);
    return DEA_OK;
}

static enum dea_status read_one_device(const struct dea_node *node, const char *name, struct dea_scene *scene,
                                       struct dea_error *error) {
    struct dea_scene_device *entry = &scene->devices[scene->device_count++];
    snprintf(entry->name, sizeof entry->name, "%s", name);
    return dea_read_device(node, &entry->device, error);
}

static enum dea_status read_devices(const struct dea_node *root, struct dea_scene *scene, struct dea_error *error) {
    const struct dea_node *single = dea_node_get(root, "device"), *several = dea_node_get(root, "devices");
    char found[80];
    if ((single == NULL) == (several == NULL))
        return dea_node_fail(several != NULL ? several : root, error,
                             single == NULL ? "the key 'device' of a scene is missing (or 'devices' for several)"
                                            : "give either device or devices, not both");
    if (several != NULL && several->kind != DEA_NODE_MAPPING)
        return dea_node_fail(several, error, "expected a mapping of names to devices, found %s",
                             dea_node_describe(several, found, sizeof found));
    if (several != NULL && (several->count == 0 || several->count > MAX_DEVICES))
        return dea_node_fail(several, error, "%zu devices; allowed: 1 to %d", several->count, MAX_DEVICES);
    scene->devices = calloc(several != NULL ? several->count : 1, sizeof *scene->devices);
    if (scene->devices == NULL)
        return dea_fail(error, DEA_ERR_MEMORY, "out of memory for devices");
    if (single != NULL)
        return read_one_device(single, "DEA", scene, error);
    for (size_t i = 0; i < several->count; i++) {
        DEA_TRY(check_device_name(several->keys[i], scene, error));
        DEA_TRY(read_one_device(several->items[i], several->keys[i]->text, scene, error));
    }
    return DEA_OK;
}

/* ---- drive and load ---- */

static enum dea_status read_drive_key(const struct dea_node *root, struct dea_scene *scene, struct dea_error *error) {
    const struct dea_node *drive = dea_node_get(root, "drive");
    if (drive != NULL)
        return dea_read_drive(drive, scene, error);
    for (int i = 0; i < scene->device_count; i++)
        for (int k = 0; k < DEA_ZONES; k++)
            if (scene->devices[i].device.zones[k].electroded)
                return dea_node_fail(root, error,
                                     "the key 'drive' of a scene is missing (drive: {} grounds every electrode)");
    return DEA_OK;
}

/* Written as `load: {type: ..}` or, like a source, `load: {waveform: {type: ..}}`. */
static enum dea_status read_load(const struct dea_node *node, void *target, struct dea_error *error) {
    static const struct dea_field fields[] = {{.key = "waveform", .kind = DEA_FIELD_ELSEWHERE, .required = true}};
    struct dea_scene *scene = target;
    const struct dea_node *waveform = node;
    if (dea_node_get(node, "waveform") != NULL) {
        DEA_TRY(dea_fields_check_keys(node, "a load", fields, DEA_COUNT(fields), error));
        waveform = dea_node_get(node, "waveform");
    }
    scene->has_load_waveform = true;
    return dea_read_waveform(waveform, "N", &scene->load, error);
}

/* ---- time, start, events ---- */

static enum dea_status read_transient(const struct dea_node *node, void *target, struct dea_error *error) {
    static const struct dea_field fields[] = {
        {.key = "stop", .offset = offsetof(struct dea_scene, stop), .range = {.unit = "s", .low = 1e-9, .high = 1e8}},
        {.key = "accuracy",
         .offset = offsetof(struct dea_scene, accuracy),
         .range = {.unit = "1", .low = 1e-12, .high = 0.1}},
        {.key = "max_step",
         .offset = offsetof(struct dea_scene, max_step),
         .range = {.unit = "s", .low = 1e-12, .high = 1e8}},
    };
    struct dea_scene *scene = target;
    DEA_TRY(dea_fields_read(node, "a transient", fields, DEA_COUNT(fields), scene, error));
    scene->has_transient = dea_node_get(node, "stop") != NULL;
    return DEA_OK;
}

static enum dea_status read_initial(const struct dea_node *node, void *target, struct dea_error *error) {
    static const struct dea_field fields[] = {
        {.key = "x", .offset = offsetof(struct dea_scene, initial_x), .range = {.unit = "m", .low = -1, .high = 1}},
        {.key = "v",
         .offset = offsetof(struct dea_scene, initial_v),
         .range = {.unit = "m/s", .low = -1e3, .high = 1e3}},
    };
    struct dea_scene *scene = target;
    if (node->kind == DEA_NODE_SCALAR) {
        static const char *const starts[] = {"equilibrium", "fresh", NULL};
        int start;
        DEA_TRY(dea_field_choice(node, starts, &start, error));
        scene->start = (enum dea_start)start;
        return DEA_OK;
    }
    DEA_TRY(dea_fields_read(node, "an initial state", fields, DEA_COUNT(fields), scene, error));
    scene->has_initial_x = dea_node_get(node, "x") != NULL;
    scene->has_initial_v = dea_node_get(node, "v") != NULL;
    return DEA_OK;
}

static enum dea_status read_events(const struct dea_node *node, void *target, struct dea_error *error) {
    static const char *const policies[] = {"ignore", "warn", "stop", "short", NULL};
    struct dea_field fields[DEA_EVENT_COUNT];
    struct dea_scene *scene = target;
    for (int i = 0; i < DEA_EVENT_COUNT; i++)
        fields[i] =
            (struct dea_field){.key = dea_event_names[i],
                               .kind = DEA_FIELD_CHOICE,
                               .offset = offsetof(struct dea_scene, policies) + (size_t)i * sizeof scene->policies[0],
                               .names = policies};
    DEA_TRY(dea_fields_read(node, "events", fields, DEA_EVENT_COUNT, scene, error));
    for (int i = 0; i < DEA_EVENT_COUNT; i++)
        if (i != DEA_EVENT_BREAKDOWN && scene->policies[i] == DEA_POLICY_SHORT)
            return dea_node_fail(dea_node_get(node, dea_event_names[i]), error,
                                 "only breakdown can be a short; allowed: ignore, warn, stop");
    return DEA_OK;
}

/* ---- the whole ---- */

/* A film that breaks down draws what its source can give; an ideal one has no limit. */
static enum dea_status check_short(const struct dea_node *root, const struct dea_scene *scene,
                                   struct dea_error *error) {
    if (scene->policies[DEA_EVENT_BREAKDOWN] != DEA_POLICY_SHORT || scene->netlist != NULL)
        return DEA_OK;
    for (int k = 0; k < DEA_ZONES; k++) {
        const struct dea_zone *zone = &scene->devices[0].device.zones[k];
        const struct dea_source *source = &scene->sources[k];
        bool series = source->resistance > 0 || source->amplifier.output_resistance > 0 ||
                      zone->electrode_resistance > 0 || zone->sheet_resistance > 0;
        if (source->present && !series && dea_waveform_peak(&source->waveform) > 0)
            return dea_node_fail(dea_node_get(dea_node_get(root, "events"), "breakdown"), error,
                                 "a short needs a resistance in drive.%s or its electrode: an ideal source cannot "
                                 "feed it",
                                 dea_zone_names[k]);
    }
    return DEA_OK;
}

/* Every zone must keep some length; only a mass can have been thrown. */
static enum dea_status check_initial(const struct dea_node *root, const struct dea_scene *scene,
                                     struct dea_error *error) {
    for (int k = 0; k < DEA_ZONES && scene->has_initial_x; k++) {
        const struct dea_zone *zone = &scene->devices[0].device.zones[k];
        char x[40], length[40];
        if (zone->present && !(zone->length + zone->side * scene->initial_x > 0))
            return dea_node_fail(dea_node_get(dea_node_get(root, "initial"), "x"), error,
                                 "%s leaves the %s zone no length; it has %s at x = 0",
                                 dea_quantity_format(scene->initial_x, "m", x, sizeof x), dea_zone_names[k],
                                 dea_quantity_format(zone->length, "m", length, sizeof length));
    }
    if (scene->has_initial_v && scene->initial_v != 0 && !(scene->devices[0].device.effective_mass > 0))
        return dea_node_fail(dea_node_get(dea_node_get(root, "initial"), "v"), error,
                             "has no effect: platform and membrane have no mass");
    return DEA_OK;
}

/* A run has to follow every period of a source, so there must be an end of them. */
static enum dea_status check_periods(const struct dea_node *place, const struct dea_waveform *waveform, double stop,
                                     struct dea_error *error) {
    double count = dea_waveform_periods(waveform, stop);
    if (count > MAX_PERIODS)
        return dea_node_fail(place, error, "%.3g periods in the run; at most %g are allowed (is the unit right?)",
                             count, MAX_PERIODS);
    return DEA_OK;
}

static enum dea_status check_waveforms(const struct dea_node *root, const struct dea_scene *scene,
                                       struct dea_error *error) {
    const struct dea_node *drive = dea_node_get(root, "drive");
    for (int k = 0; k < DEA_ZONES; k++) {
        const struct dea_node *source = dea_node_get(drive, dea_zone_names[k]);
        if (source != NULL)
            DEA_TRY(check_periods(dea_node_get(source, "waveform"), &scene->sources[k].waveform, scene->stop, error));
    }
    if (scene->has_load_waveform)
        DEA_TRY(check_periods(dea_node_get(root, "load"), &scene->load, scene->stop, error));
    return DEA_OK;
}

static enum dea_status check_scene(const struct dea_node *root, const struct dea_scene *scene,
                                   struct dea_error *error) {
    const struct dea_node *transient = dea_node_get(root, "transient");
    if (scene->netlist == NULL && !scene->has_transient)
        return dea_node_fail(transient != NULL ? transient : root, error,
                             "the key '%s' is missing (only a netlist can give it by .tran)",
                             transient != NULL ? "stop" : "transient");
    if (scene->has_load_waveform && scene->device_count > 1)
        return dea_node_fail(dea_node_get(root, "load"), error, "a load waveform needs a single device");
    bool placed = scene->has_initial_x || scene->has_initial_v;
    if (placed && scene->device_count > 1)
        return dea_node_fail(dea_node_get(root, "initial"), error, "an initial x or v needs a single device");
    DEA_TRY(check_initial(root, scene, error));
    DEA_TRY(check_waveforms(root, scene, error));
    return check_short(root, scene, error);
}

static enum dea_status read_tree(const struct dea_node *root, struct dea_scene *scene, struct dea_error *error) {
    static const struct dea_field fields[] = {
        {.key = "title", .kind = DEA_FIELD_STRING, .offset = offsetof(struct dea_scene, title)},
        {.key = "device", .kind = DEA_FIELD_ELSEWHERE},
        {.key = "devices", .kind = DEA_FIELD_ELSEWHERE},
        {.key = "drive", .kind = DEA_FIELD_ELSEWHERE},
        {.key = "load", .kind = DEA_FIELD_READER, .read = read_load},
        {.key = "transient", .kind = DEA_FIELD_READER, .read = read_transient},
        {.key = "initial", .kind = DEA_FIELD_READER, .read = read_initial},
        {.key = "events", .kind = DEA_FIELD_READER, .read = read_events},
        {.key = "output", .kind = DEA_FIELD_ELSEWHERE},
        {.key = "expect", .kind = DEA_FIELD_ELSEWHERE},
    };
    DEA_TRY(dea_fields_read(root, "a scene", fields, DEA_COUNT(fields), scene, error));
    DEA_TRY(read_devices(root, scene, error));
    DEA_TRY(read_drive_key(root, scene, error));
    DEA_TRY(check_scene(root, scene, error));
    const struct dea_node *output = dea_node_get(root, "output"), *expect = dea_node_get(root, "expect");
    if (output != NULL)
        DEA_TRY(dea_read_output(output, scene, error));
    if (expect != NULL)
        DEA_TRY(dea_read_expectations(expect, scene, error));
    return DEA_OK;
}

/* A file with keys of another kind of file and none of its own was named by mistake. */
static enum dea_status refuse_other_kind(const struct dea_node *root, const char *const *own, const char *const *others,
                                         const char *what, struct dea_error *error) {
    for (; *own != NULL; own++)
        if (dea_node_get(root, *own) != NULL)
            return DEA_OK;
    for (; *others != NULL; others++)
        if (dea_node_get(root, *others) != NULL)
            return dea_node_fail(root, error, "%s", what);
    return DEA_OK;
}

static const char *const scene_keys[] = {"device", "devices", "drive", "transient", "expect", NULL};
static const char *const device_keys[] = {"geometry", "zones", "platform", NULL};

/* A scene without a title is called after its file. */
static enum dea_status complete_title(const struct dea_node *root, struct dea_scene *scene, struct dea_error *error) {
    char name[200] = "";
    if (scene->title == NULL) {
        dea_name_from_file(root, name, sizeof name);
        scene->title = strdup(name);
    }
    return scene->title != NULL ? DEA_OK : dea_fail(error, DEA_ERR_MEMORY, "out of memory for the title");
}

enum dea_status dea_scene_read(const char *path, const struct dea_override *overrides, size_t override_count,
                               struct dea_scene *scene, struct dea_error *error) {
    struct dea_tree tree = {0};
    struct dea_node *root;
    *scene = (struct dea_scene){.accuracy = 1e-4, .formats = DEA_FORMAT_CSV};
    for (int i = 0; i < DEA_EVENT_COUNT; i++)
        scene->policies[i] = DEA_POLICY_WARN;
    scene->path = strdup(path);
    if (scene->path == NULL)
        return dea_fail(error, DEA_ERR_MEMORY, "out of memory for the path of the scene");
    enum dea_status status = dea_compose(&tree, DEA_FILE_SCENE, path, overrides, override_count, &root, error);
    if (status == DEA_OK)
        status = refuse_other_kind(root, scene_keys, device_keys,
                                   "this is a device, not a scene; a scene names it as its device", error);
    if (status == DEA_OK)
        status = read_tree(root, scene, error);
    if (status == DEA_OK)
        status = complete_title(root, scene, error);
    dea_tree_clear(&tree);
    return status;
}

enum dea_status dea_device_read(const char *path, const struct dea_override *overrides, size_t override_count,
                                struct dea_device *device, struct dea_error *error) {
    struct dea_tree tree = {0};
    struct dea_node *root;
    *device = (struct dea_device){0};
    enum dea_status status = dea_compose(&tree, DEA_FILE_DEVICE, path, overrides, override_count, &root, error);
    if (status == DEA_OK)
        status = refuse_other_kind(root, device_keys, scene_keys,
                                   "this is a scene, not a device; give the file it names as its device", error);
    if (status == DEA_OK)
        status = dea_read_device(root, device, error);
    dea_tree_clear(&tree);
    return status;
}

void dea_scene_clear(struct dea_scene *scene) {
    for (int i = 0; i < scene->device_count; i++)
        dea_device_clear(&scene->devices[i].device);
    for (int k = 0; k < DEA_ZONES; k++)
        dea_waveform_clear(&scene->sources[k].waveform);
    dea_waveform_clear(&scene->load);
    for (size_t i = 0; i < scene->signal_count; i++)
        free(scene->signals[i]);
    free(scene->signals);
    free(scene->expectations);
    free(scene->devices);
    free(scene->netlist);
    free(scene->title);
    free(scene->path);
    *scene = (struct dea_scene){0};
}
