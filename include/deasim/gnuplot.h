/* Pictures by gnuplot. */
#ifndef DEASIM_GNUPLOT_H
#define DEASIM_GNUPLOT_H

#include "deasim/status.h"

#include <stdio.h>

/* Has gnuplot (with its default settings) run a script that puts a PNG on its standard output. `script` is an open file
 * positioned at the first command. The picture appears under `path` only when it is whole. DEA_ERR_INPUT when no
 * picture can be put there; DEA_ERR_OUTPUT with what gnuplot said, or when it is not installed. */
enum dea_status dea_gnuplot_draw(FILE *script, const char *path, struct dea_error *error);

/* The same with a script that is a file of its own. */
enum dea_status dea_gnuplot_draw_file(const char *script, const char *path, struct dea_error *error);

#endif
