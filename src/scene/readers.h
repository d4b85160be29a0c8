/* From composed trees to the structs of a scene. Targets hold their defaults before and are cleared by the caller. */
#ifndef DEASIM_READERS_H
#define DEASIM_READERS_H

#include "deasim/scene.h"
#include "scene/fields.h"

/* Fills a material; its branches are owned by it. */
enum dea_status dea_read_material(const struct dea_node *node, struct dea_material *material, struct dea_error *error);

/* Fills and prepares a device, whose material is already part of the tree. */
enum dea_status dea_read_device(const struct dea_node *node, struct dea_device *device, struct dea_error *error);

/* Fills and checks a waveform in `unit` ("V" or "N"). */
enum dea_status dea_read_waveform(const struct dea_node *node, const char *unit, struct dea_waveform *waveform,
                                  struct dea_error *error);

/* Reads `drive`: the netlist's path or the native sources. Needs the scene's devices. */
enum dea_status dea_read_drive(const struct dea_node *node, struct dea_scene *scene, struct dea_error *error);

/* Reads `output` and `expect`. Both need the scene's devices and drive. */
enum dea_status dea_read_output(const struct dea_node *node, struct dea_scene *scene, struct dea_error *error);
enum dea_status dea_read_expectations(const struct dea_node *node, struct dea_scene *scene, struct dea_error *error);

/* Copies a name out of the file's own name ("models/planar.yaml" -> "planar") where the mapping has none. */
void dea_name_from_file(const struct dea_node *node, char *name, size_t size);

#endif
