/* Puts one tree together from several files: paths in place of mappings, `base:` files, and `--set` overrides. */
#ifndef DEASIM_COMPOSE_H
#define DEASIM_COMPOSE_H

#include "deasim/scene.h"
#include "scene/yaml_tree.h"

/* What a file holds decides which of its keys may name further files. */
enum dea_file_role { DEA_FILE_SCENE, DEA_FILE_DEVICE, DEA_FILE_MATERIAL };

/* Reads `path` and everything it names, then applies the overrides in order. No path and no `base` is left in *root. */
enum dea_status dea_compose(struct dea_tree *tree, enum dea_file_role role, const char *path,
                            const struct dea_override *overrides, size_t override_count, struct dea_node **root,
                            struct dea_error *error);

#endif
