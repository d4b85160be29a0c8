/* From files to logical lines: includes followed, continuations joined, comments dropped, sizes limited. */
#include "circuit/netlist_internal.h"

#include <ctype.h>
#include <errno.h>
#include <fcntl.h>
#include <libgen.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>
#include <unistd.h>

#define MAX_BYTES ((size_t)16 << 20) /* all files together */
#define MAX_LINES 100000
#define MAX_DEPTH 20
#define MAX_FILES 1000

/* One file being read, linked to the one that included it. */
struct source {
    const struct source *includer;
    const char *path; /* as shown in messages */
    int file, depth;
    int include_line;    /* line in the includer */
    const char *section; /* .lib section to take, NULL: all */
};

/* Where the reading of one file stands. */
struct scan {
    struct source *source;
    int line;        /* physical, from 1 */
    bool in_section; /* inside the wanted .lib section */
    bool section_seen;
    bool in_control;
    bool ended;
    int control_line;
    int first_logical; /* line_count when the file began: a continuation may not reach behind it */
};

struct reader {
    struct dea_netlist_job *job;
    size_t bytes;
    size_t last_length; /* of the last logical line */
};

static enum dea_status read_file(struct reader *reader, struct source *source);

static enum dea_status fail_at(struct reader *reader, const struct scan *scan, const char *what, const char *detail) {
    return dea_fail(reader->job->error, DEA_ERR_INPUT, "%s:%d: %s%s", scan->source->path, scan->line, what, detail);
}

static enum dea_status out_of_memory(struct dea_netlist_job *job) {
    return dea_fail(job->error, DEA_ERR_MEMORY, "out of memory reading the netlist");
}

/* ---- files ---- */

static bool inside(const char *path, const char *folder) {
    size_t length = strlen(folder);
    if (strcmp(folder, "/") == 0)
        return true;
    return strncmp(path, folder, length) == 0 && path[length] == '/';
}

enum dea_status dea_netlist_resolve(struct dea_netlist_job *job, const char *name, const char *file, int line,
                                    char **resolved) {
    *resolved = NULL;
    char candidate[PATH_MAX], from[PATH_MAX];
    if (name[0] == '\0' || strlen(name) >= PATH_MAX / 2 || strlen(file) >= PATH_MAX / 2)
        return dea_fail(job->error, DEA_ERR_INPUT, "%s:%d: no usable file name", file, line);
    if (name[0] == '~' || strpbrk(name, "$`{") != NULL)
        return dea_fail(job->error, DEA_ERR_INPUT, "%s:%d: %s: file names are taken literally, without ~ or variables",
                        file, line, name);
    snprintf(from, sizeof from, "%s", file);
    if (name[0] == '/')
        snprintf(candidate, sizeof candidate, "%s", name);
    else
        snprintf(candidate, sizeof candidate, "%s/%s", dirname(from), name);
    *resolved = realpath(candidate, NULL);
    if (*resolved == NULL && name[0] != '/') {
        snprintf(candidate, sizeof candidate, "%s/%s", job->netlist->folder, name);
        *resolved = realpath(candidate, NULL);
    }
    if (*resolved == NULL)
        return dea_fail(job->error, DEA_ERR_INPUT, "%s:%d: cannot open %s: %s", file, line, name, strerror(errno));
    if (!job->options->trusted && !inside(*resolved, job->netlist->folder)) {
        free(*resolved);
        *resolved = NULL;
        return dea_fail(job->error, DEA_ERR_INPUT,
                        "%s:%d: %s is outside the netlist's folder; only a trusted netlist may read it", file, line,
                        name);
    }
    return DEA_OK;
}

/* Whole content, NUL-terminated; refuses what is not a text file of sensible size. */
static enum dea_status load_text(struct reader *reader, const struct source *source, char **text) {
    struct dea_error *error = reader->job->error;
    *text = NULL;
    int file = open(source->path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    struct stat about;
    if (file < 0 || fstat(file, &about) != 0) {
        int why = errno;
        if (file >= 0)
            close(file);
        return dea_fail(error, DEA_ERR_INPUT, "%s: %s", source->path, strerror(why));
    }
    enum dea_status status = DEA_OK;
    size_t size = about.st_size > 0 ? (size_t)about.st_size : 0;
    if (!S_ISREG(about.st_mode))
        status = dea_fail(error, DEA_ERR_INPUT, "%s: not a regular file", source->path);
    else if (size > MAX_BYTES - reader->bytes)
        status = dea_fail(error, DEA_ERR_INPUT,
                          "%s: a netlist with its includes may have at most 16 MB, this file has %zu bytes",
                          source->path, size);
    else if ((*text = malloc(size + 1)) == NULL)
        status = out_of_memory(reader->job);
    size_t got = 0;
    while (status == DEA_OK && got < size) {
        ssize_t more = read(file, *text + got, size - got);
        if (more < 0 && errno == EINTR)
            continue;
        if (more < 0)
            status = dea_fail(error, DEA_ERR_INPUT, "%s: %s", source->path, strerror(errno));
        if (more <= 0)
            break;
        got += (size_t)more;
    }
    close(file);
    if (status != DEA_OK) {
        free(*text);
        *text = NULL;
        return status;
    }
    (*text)[got] = '\0';
    reader->bytes += got;
    int line = 1;
    for (size_t i = 0; i < got; i++) {
        unsigned char c = (unsigned char)(*text)[i];
        line += c == '\n';
        if (c == '\0' || (c < 32 && strchr("\t\n\v\f\r", c) == NULL)) {
            free(*text);
            *text = NULL;
            return dea_fail(error, DEA_ERR_INPUT, "%s:%d: not a text file (byte 0x%02x)", source->path, line, c);
        }
    }
    return DEA_OK;
}

/* ---- lines ---- */

/* Cuts comments behind ';', '//' and a '$' that stands alone, outside quotes; then trailing blanks. */
static void strip_comment(char *line) {
    char quote = '\0';
    for (char *c = line; *c != '\0'; c++) {
        if (quote != '\0') {
            quote = *c == quote ? '\0' : quote;
            continue;
        }
        if (*c == '"') {
            quote = *c;
            continue;
        }
        bool dollar =
            *c == '$' && (c == line || isspace((unsigned char)c[-1])) && (c[1] == '\0' || isspace((unsigned char)c[1]));
        if (*c == ';' || (c[0] == '/' && c[1] == '/') || dollar) {
            *c = '\0';
            break;
        }
    }
    size_t length = strlen(line);
    while (length > 0 && isspace((unsigned char)line[length - 1]))
        line[--length] = '\0';
}

static enum dea_status add_line(struct reader *reader, const struct scan *scan, const char *text) {
    struct dea_netlist *netlist = reader->job->netlist;
    if (netlist->line_count >= MAX_LINES)
        return fail_at(reader, scan, "a netlist may have at most 100000 lines", "");
    struct dea_netlist_line *grown = dea_grow(netlist->lines, netlist->line_count, sizeof *grown);
    char *copy = strdup(text);
    if (grown != NULL)
        netlist->lines = grown;
    if (grown == NULL || copy == NULL) {
        free(copy);
        return out_of_memory(reader->job);
    }
    netlist->lines[netlist->line_count++] =
        (struct dea_netlist_line){.text = copy, .file = scan->source->file, .line = scan->line};
    reader->last_length = strlen(copy);
    return DEA_OK;
}

/* Joins a '+' line to the logical line before it, which must come from the same file. */
static enum dea_status continue_line(struct reader *reader, const struct scan *scan, const char *text) {
    struct dea_netlist *netlist = reader->job->netlist;
    if (netlist->line_count <= scan->first_logical)
        return fail_at(reader, scan, "a continuation '+' without a line before it", "");
    struct dea_netlist_line *last = &netlist->lines[netlist->line_count - 1];
    size_t length = strlen(text);
    char *joined = realloc(last->text, reader->last_length + length + 2);
    if (joined == NULL)
        return out_of_memory(reader->job);
    joined[reader->last_length] = ' ';
    memcpy(joined + reader->last_length + 1, text, length + 1);
    reader->last_length += length + 1;
    last->text = joined;
    return DEA_OK;
}

/* ---- cards that steer the reading ---- */

/* A resolved path as the user would write it: relative like the main file where it lies beneath its folder. */
static char *shorten(const struct dea_netlist_job *job, const char *resolved) {
    char *shown = NULL, *main_path = strdup(job->netlist->files[0]);
    if (main_path != NULL && strchr(main_path, '/') == NULL && inside(resolved, job->netlist->folder))
        shown = strdup(resolved + strlen(job->netlist->folder) + 1);
    else if (main_path != NULL && inside(resolved, job->netlist->folder)) {
        if (asprintf(&shown, "%s/%s", dirname(main_path), resolved + strlen(job->netlist->folder) + 1) < 0)
            shown = NULL;
    } else {
        shown = strdup(resolved);
    }
    free(main_path);
    return shown;
}

static enum dea_status include_file(struct reader *reader, struct scan *scan, const char *name, const char *section) {
    struct source inner = {
        .includer = scan->source, .depth = scan->source->depth + 1, .include_line = scan->line, .section = section};
    char *resolved, *shown;
    DEA_TRY(dea_netlist_resolve(reader->job, name, scan->source->path, scan->line, &resolved));
    shown = shorten(reader->job, resolved);
    if (shown == NULL) {
        free(resolved);
        return out_of_memory(reader->job);
    }
    inner.path = shown;
    enum dea_status status = DEA_OK;
    bool endless = inner.depth > MAX_DEPTH;
    for (const struct source *at = scan->source; at != NULL && !endless && section == NULL; at = at->includer) {
        char *real = realpath(at->path, NULL);
        endless = real != NULL && strcmp(real, resolved) == 0;
        free(real);
    }
    if (endless) {
        char chain[1024];
        int used = snprintf(chain, sizeof chain, "%s", shown);
        for (const struct source *at = scan->source; at != NULL && used < (int)sizeof chain; at = at->includer)
            used += snprintf(chain + used, sizeof chain - (size_t)used, " <- %s", at->path);
        status = dea_fail(reader->job->error, DEA_ERR_INPUT, "%s:%d: endless .include: %s", scan->source->path,
                          scan->line, chain);
    }
    if (status == DEA_OK)
        status = read_file(reader, &inner);
    free(resolved);
    free(shown);
    return status;
}

/* First word and up to two arguments, quotes removed, case kept. */
static int split_card(const char *line, char words[3][PATH_MAX]) {
    int count = 0;
    const char *c = line;
    while (count < 3) {
        while (isspace((unsigned char)*c))
            c++;
        if (*c == '\0')
            break;
        size_t length;
        if (*c == '"' || *c == '\'') {
            char quote = *c++;
            length = strcspn(c, quote == '"' ? "\"" : "'");
        } else {
            for (length = 0; c[length] != '\0' && !isspace((unsigned char)c[length]); length++)
                ;
        }
        snprintf(words[count++], PATH_MAX, "%.*s", (int)(length < PATH_MAX ? length : PATH_MAX - 1), c);
        c += length + (c[length] == '"' || c[length] == '\'');
    }
    return count;
}

static enum dea_status control_card(struct reader *reader, struct scan *scan, const char *card) {
    if (strcasecmp(card, ".endc") == 0) {
        scan->in_control = false;
        return DEA_OK;
    }
    if (!reader->job->options->trusted)
        return fail_at(
            reader, scan,
            ".control blocks are refused: they run commands; deasim runs the transient itself, so remove the block",
            "");
    scan->in_control = true;
    scan->control_line = scan->line;
    return DEA_OK;
}

/* Takes .include, .lib, .control, .end; *taken tells whether the line was one of them. */
static enum dea_status steer(struct reader *reader, struct scan *scan, const char *line, bool *taken) {
    char words[3][PATH_MAX];
    int count = split_card(line, words);
    const char *card = words[0];
    *taken = true;
    if (strcasecmp(card, ".control") == 0 || strcasecmp(card, ".endc") == 0)
        return control_card(reader, scan, card);
    if (strcasecmp(card, ".include") == 0 || strcasecmp(card, ".inc") == 0) {
        if (count != 2)
            return fail_at(reader, scan, ".include needs one file name", "");
        return include_file(reader, scan, words[1], NULL);
    }
    if (strcasecmp(card, ".lib") == 0) {
        if (count == 3)
            return include_file(reader, scan, words[1], words[2]);
        if (count != 2 || scan->source->section == NULL)
            return fail_at(reader, scan, ".lib needs a file and a section, as in .lib models.lib typical", "");
        scan->in_section = strcasecmp(words[1], scan->source->section) == 0;
        scan->section_seen = scan->section_seen || scan->in_section;
        return DEA_OK;
    }
    if (strcasecmp(card, ".endl") == 0 || strcasecmp(card, ".endlib") == 0) {
        scan->in_section = false;
        return DEA_OK;
    }
    if (strcasecmp(card, ".end") == 0) {
        scan->ended = scan->source->includer == NULL;
        return DEA_OK;
    }
    *taken = false;
    return DEA_OK;
}

/* One physical line. */
static enum dea_status take_line(struct reader *reader, struct scan *scan, char *line) {
    while (isspace((unsigned char)*line))
        line++;
    if (strchr("*#$", *line) != NULL) {
        if (line[0] == '*' && line[1] == '#' && !reader->job->options->trusted)
            return fail_at(reader, scan, "lines beginning with *# are refused: ngspice runs them as commands", "");
        return DEA_OK; /* empty or comment */
    }
    if (scan->in_control && strncasecmp(line, ".endc", 5) != 0)
        return DEA_OK;
    strip_comment(line);
    size_t length = strlen(line); /* without the comment and blanks that may have hidden the end */
    if (length >= 2 && line[length - 1] == '\\' && line[length - 2] == '\\')
        return fail_at(reader, scan, "continue a line with '+' on the next one, not with \\\\", "");
    if (*line == '\0')
        return DEA_OK;
    for (const char *c = line; *c != '\0'; c++)
        if ((unsigned char)*c > 126)
            return fail_at(reader, scan, "a character outside ASCII (for micro write u)", "");
    bool taken = false;
    if (*line == '.')
        DEA_TRY(steer(reader, scan, line, &taken));
    if (taken || (scan->source->section != NULL && !scan->in_section))
        return DEA_OK;
    return *line == '+' ? continue_line(reader, scan, line + 1) : add_line(reader, scan, line);
}

static enum dea_status add_file(struct reader *reader, struct source *source) {
    struct dea_netlist *netlist = reader->job->netlist;
    if (netlist->file_count >= MAX_FILES)
        return dea_fail(reader->job->error, DEA_ERR_INPUT, "%s: a netlist may include at most 1000 files",
                        source->path);
    char **grown = dea_grow(netlist->files, netlist->file_count, sizeof *grown);
    char *copy = strdup(source->path);
    if (grown != NULL)
        netlist->files = grown;
    if (grown == NULL || copy == NULL) {
        free(copy);
        return out_of_memory(reader->job);
    }
    source->file = netlist->file_count;
    netlist->files[netlist->file_count++] = copy;
    return DEA_OK;
}

static enum dea_status read_file(struct reader *reader, struct source *source) {
    char *text;
    DEA_TRY(load_text(reader, source, &text));
    struct scan scan = {.source = source, .first_logical = reader->job->netlist->line_count};
    enum dea_status status = add_file(reader, source);
    char *rest = text;
    while (status == DEA_OK && rest != NULL && !scan.ended) {
        char *line = strsep(&rest, "\n");
        scan.line++;
        if (scan.line == 1 && source->includer == NULL) { /* the title, whatever it holds */
            strip_comment(line);
            status = add_line(reader, &scan, line);
            scan.first_logical = reader->job->netlist->line_count;
            continue;
        }
        line[strcspn(line, "\r")] = '\0';
        status = take_line(reader, &scan, line);
    }
    if (status == DEA_OK && scan.in_control) {
        scan.line = scan.control_line;
        status = fail_at(reader, &scan, ".control without .endc", "");
    }
    if (status == DEA_OK && source->section != NULL && !scan.section_seen)
        status = dea_fail(reader->job->error, DEA_ERR_INPUT, "%s:%d: no section %s in %s", source->includer->path,
                          source->include_line, source->section, source->path);
    free(text);
    return status;
}

enum dea_status dea_netlist_read_files(struct dea_netlist_job *job, const char *path) {
    char *real = realpath(path, NULL);
    if (real == NULL)
        return dea_fail(job->error, DEA_ERR_INPUT, "%s: %s", path, strerror(errno));
    job->netlist->folder = strdup(dirname(real));
    free(real);
    if (job->netlist->folder == NULL)
        return out_of_memory(job);
    struct reader reader = {.job = job};
    struct source source = {.path = path};
    DEA_TRY(read_file(&reader, &source));
    if (job->netlist->line_count < 2)
        return dea_fail(job->error, DEA_ERR_INPUT, "%s: the netlist has no element (its first line is the title)",
                        path);
    return DEA_OK;
}
