/* Steps of reading a netlist, in order: read (files to logical lines), vet (what may pass), find (what the coupling
 * needs). */
#ifndef DEASIM_CIRCUIT_NETLIST_INTERNAL_H
#define DEASIM_CIRCUIT_NETLIST_INTERNAL_H

#include "circuit/netlist.h"

#define DEA_TOKEN_MAX 256 /* longest name in a netlist */

struct dea_netlist_job {
    const struct dea_netlist_options *options;
    struct dea_netlist *netlist;
    struct dea_error *error;
};

/* Reads the file and what it includes; includes do not appear as lines. Handles .control blocks and comments. */
enum dea_status dea_netlist_read_files(struct dea_netlist_job *job, const char *path);

/* Decides for every line whether it passes; may rewrite it (options, file names). */
enum dea_status dea_netlist_vet(struct dea_netlist_job *job);

/* Refuses a URC line, or a model of one, that would keep ngspice for ever. A line with all its words, or .model. */
enum dea_status dea_netlist_check_urc(struct dea_netlist_job *job, int index);

/* Warns where the value of a resistor is in M or that of a capacitor in F. */
enum dea_status dea_netlist_check_suffix(struct dea_netlist_job *job, int index);

/* Refuses functions that ngspice cannot put in or crashes over. After vetting: brackets match. */
enum dea_status dea_netlist_check_functions(struct dea_netlist_job *job);

/* Finds .tran, .measure, .ic and the device calls. */
enum dea_status dea_netlist_find(struct dea_netlist_job *job);
enum dea_status dea_netlist_find_devices(struct dea_netlist_job *job);

/* Resolves a file named in a netlist against the naming file's folder, then the netlist's; refuses one outside the
 * netlist's folder unless trusted. *resolved is malloc'd. `file`, `line`: where it was named. */
enum dea_status dea_netlist_resolve(struct dea_netlist_job *job, const char *name, const char *file, int line,
                                    char **resolved);

/* Fails with "file:line: " in front. */
enum dea_status dea_netlist_fail(struct dea_netlist_job *job, int line_index, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
enum dea_status dea_netlist_warn(struct dea_netlist_job *job, int line_index, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* Next token of *cursor into token (cut at DEA_TOKEN_MAX), lower case; blanks, ',', '(' and ')' separate, '=' is a
 * token of its own, quotes and braces hold together. False at the end. */
bool dea_netlist_token(const char **cursor, char token[DEA_TOKEN_MAX]);

/* Grows an array by one element, doubling; NULL when out of memory. */
void *dea_grow(void *array, int count, size_t element);

#endif
