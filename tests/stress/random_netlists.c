/* Damaged netlists from a seed, each run by the product in a process of its own under limits. Allowed ends: done, or
 * exit 2 or 3 with a reason. Not allowed: a crash of the program, an end without a word, an internal error. Runs in
 * which ngspice itself crashed (its child process, told to the user) or used all its time are counted and named.
 *
 * usage: random_netlists PROGRAM NETLISTS DEVICE COUNT SEED FOLDER     prints seeds, then "N passed, N failed" */
#include <dirent.h>
#include <fcntl.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#define TIME_LIMIT "15s"
#define CPU_LIMIT 30            /* s */
#define MEMORY_LIMIT (4L << 30) /* bytes */
#define LINES_MAX 400
#define LINE_MAX_BYTES 4000
#define FILES_MAX 100

/* ---- chance ---- */

static uint64_t chance_state;

/* splitmix64 (Steele, Lea, Flood, 2014): the same numbers on every machine */
static uint64_t chance(void) {
    uint64_t z = (chance_state += 0x9e3779b97f4a7c15u);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
}

static int pick(int count) {
    return (int)(chance() % (uint64_t)count);
}

/* ---- a netlist and its damage ---- */

struct netlist {
    char *lines[LINES_MAX]; /* owned */
    int count;
};

static bool read_netlist(const char *path, struct netlist *netlist) {
    static char line[LINE_MAX_BYTES];
    FILE *file = fopen(path, "r");
    netlist->count = 0;
    while (file != NULL && netlist->count < LINES_MAX - 50 && fgets(line, sizeof line, file) != NULL) {
        bool comment = line[0] == '*' && netlist->count > 0;
        if (comment || strncasecmp(line, ".tran", 5) == 0 || strncasecmp(line, ".end\n", 5) == 0)
            continue;
        line[strcspn(line, "\r\n")] = '\0';
        netlist->lines[netlist->count++] = strdup(line);
    }
    if (file != NULL)
        fclose(file);
    return netlist->count > 2;
}

static void clear_netlist(struct netlist *netlist) {
    for (int i = 0; i < netlist->count; i++)
        free(netlist->lines[i]);
    netlist->count = 0;
}

/* Bounds of a random word of a line; false when it has none. */
static bool pick_word(const char *line, size_t *from, size_t *to) {
    static const char between[] = " \t(),=";
    size_t starts[200], count = 0;
    for (size_t i = 0; line[i] != '\0' && count < 200; i++)
        if (strchr(between, line[i]) == NULL && (i == 0 || strchr(between, line[i - 1]) != NULL))
            starts[count++] = i;
    if (count == 0)
        return false;
    *from = starts[pick((int)count)];
    *to = *from + strcspn(line + *from, between);
    return true;
}

/* Puts `with` in the place of a part of a line. */
static void replace(char **line, size_t from, size_t to, const char *with, size_t length) {
    char *changed = NULL;
    if (asprintf(&changed, "%.*s%.*s%s", (int)from, *line, (int)length, with, *line + to) < 0)
        abort();
    free(*line);
    *line = changed;
}

static void damage_word(struct netlist *netlist) {
    static const char *const strange[] = {"0",        "-1",     "1e30",    "1e-30",    "nan",  "inf", "{x}",
                                          "left",     "pos",    "V(p)",    "1e9",      "",     "dc",  "pulse",
                                          "external", "temper", "time",    "DEA",      "1k 1", "=",   "'1'",
                                          "V(",       "par",    "poly(2)", "Xdea.pos", "gnd"};
    char **line = &netlist->lines[1 + pick(netlist->count - 1)];
    const char *other = netlist->lines[1 + pick(netlist->count - 1)];
    size_t from, to, other_from, other_to;
    if (!pick_word(*line, &from, &to))
        return;
    const char *word = strange[pick((int)(sizeof strange / sizeof strange[0]))];
    size_t length = strlen(word);
    if (pick(2) == 0 && pick_word(other, &other_from, &other_to)) {
        word = other + other_from;
        length = other_to - other_from;
    }
    char *copy = strndup(word, length);
    replace(line, from, to, copy, length);
    free(copy);
}

static void damage_character(struct netlist *netlist) {
    static const char strange[] = "(){}[]'\"=,;.*+-/\\$#!~^&|<>?:%@ 09eEvV";
    char **line = &netlist->lines[1 + pick(netlist->count - 1)];
    size_t at = (size_t)pick((int)strlen(*line) + 1), removed = pick(2) == 0 && (*line)[at] != '\0';
    const char *with = &strange[pick((int)sizeof strange - 1)];
    replace(line, at, at + removed, with, pick(3) > 0 ? 1 : 0);
}

static void damage_lines(struct netlist *netlist) {
    int at = 1 + pick(netlist->count - 1), other = 1 + pick(netlist->count - 1);
    char *line = netlist->lines[at];
    switch (pick(4)) {
    case 0: /* leave one out */
        if (netlist->count <= 3)
            return;
        free(line);
        memmove(&netlist->lines[at], &netlist->lines[at + 1], (size_t)(--netlist->count - at) * sizeof line);
        return;
    case 1: /* once more */
        netlist->lines[netlist->count++] = strdup(line);
        return;
    case 2: /* in another place */
        netlist->lines[at] = netlist->lines[other];
        netlist->lines[other] = line;
        return;
    default: /* cut */
        line[pick((int)strlen(line) + 1)] = '\0';
    }
}

static void damage(struct netlist *netlist) {
    for (int times = 1 + pick(4); times > 0; times--) {
        int kind = pick(10);
        if (kind < 5)
            damage_word(netlist);
        else if (kind < 8)
            damage_character(netlist);
        else
            damage_lines(netlist);
    }
}

/* ---- one run ---- */

/* The files of one seed, all in the folder that holds the parts netlists include. */
struct paths {
    char netlist[600], scene[600], complaint[600];
};

static struct paths name_files(const char *folder, long seed) {
    struct paths paths;
    snprintf(paths.netlist, sizeof paths.netlist, "%s/%ld.cir", folder, seed);
    snprintf(paths.scene, sizeof paths.scene, "%s/%ld.yaml", folder, seed);
    snprintf(paths.complaint, sizeof paths.complaint, "%s/%ld.err", folder, seed);
    return paths;
}

static bool write_scene(const struct paths *paths, const char *device, const struct netlist *netlist) {
    FILE *file = fopen(paths->netlist, "w");
    for (int i = 0; file != NULL && i < netlist->count; i++)
        fprintf(file, "%s\n", netlist->lines[i]);
    if (file == NULL || fclose(file) != 0)
        return false;
    file = fopen(paths->scene, "w");
    if (file == NULL)
        return false;
    fprintf(file, "device: %s\ndrive: {netlist: %s}\ntransient: {stop: 1 ms, accuracy: 1e-2}\n", device,
            strrchr(paths->netlist, '/') + 1);
    return fclose(file) == 0;
}

static bool copy_parts(const char *from, const char *folder) {
    char command[1200];
    snprintf(command, sizeof command, "mkdir -p '%s' && cp -r '%s/parts' '%s'", folder, from, folder);
    return system(command) == 0;
}

enum verdict { DONE, REFUSED, GAVE_UP, ENGINE_CRASHED, SLOW, BROKEN };

static enum verdict run(const char *program, const struct paths *paths, char *words, size_t size) {
    pid_t child = fork();
    if (child == 0) {
        struct rlimit seconds = {CPU_LIMIT, CPU_LIMIT + 5}, bytes = {MEMORY_LIMIT, MEMORY_LIMIT};
        int to = open("/dev/null", O_WRONLY), error = open(paths->complaint, O_WRONLY | O_CREAT | O_TRUNC, 0644);
        if (to < 0 || error < 0 || dup2(to, 1) < 0 || dup2(error, 2) < 0 || setrlimit(RLIMIT_CPU, &seconds) != 0 ||
            setrlimit(RLIMIT_AS, &bytes) != 0)
            _exit(99);
        execl(program, program, "run", paths->scene, "--quiet", "--time-limit", TIME_LIMIT, (char *)NULL);
        _exit(98);
    }
    int status = 0;
    if (child < 0 || waitpid(child, &status, 0) != child)
        abort();
    FILE *file = fopen(paths->complaint, "r");
    size_t length = file != NULL ? fread(words, 1, size - 1, file) : 0;
    words[length] = '\0';
    if (file != NULL)
        fclose(file);
    int code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    if ((code != 0 && code != 2 && code != 3) || (code != 0 && length < 20))
        return BROKEN;
    if (strstr(words, " crashed with SIG") != NULL || strstr(words, " exited by itself") != NULL)
        return ENGINE_CRASHED;
    if (strstr(words, "time limit") != NULL || strstr(words, "was killed") != NULL)
        return SLOW;
    return code == 0 ? DONE : code == 2 ? REFUSED : GAVE_UP;
}

static int list_netlists(const char *folder, char *paths[FILES_MAX]) {
    struct dirent **entries;
    int found = scandir(folder, &entries, NULL, alphasort), count = 0;
    for (int i = 0; i < found; i++) {
        const char *ending = strrchr(entries[i]->d_name, '.');
        if (ending != NULL && strcmp(ending, ".cir") == 0 && count < FILES_MAX &&
            asprintf(&paths[count], "%s/%s", folder, entries[i]->d_name) > 0)
            count++;
        free(entries[i]);
    }
    if (found >= 0)
        free(entries);
    return count;
}

int main(int argc, char **argv) {
    static const char *const names[] = {"done", "refused", "gave up", "ngspice crashed", "slow", "broken"};
    static char words[4096];
    char *paths[FILES_MAX];
    long counts[6] = {0};
    if (argc != 7)
        return 2;
    const char *base = argv[6];
    int files = list_netlists(argv[2], paths);
    if (!copy_parts(argv[2], base))
        return 2;
    for (long i = 0, seed = atol(argv[5]); i < atol(argv[4]) && files > 0; i++, seed++) {
        struct netlist netlist;
        struct paths files_of_seed = name_files(base, seed);
        chance_state = (uint64_t)seed * 0x2545f4914f6cdd1du;
        if (!read_netlist(paths[pick(files)], &netlist))
            return 2;
        damage(&netlist);
        bool written = write_scene(&files_of_seed, argv[3], &netlist);
        clear_netlist(&netlist);
        if (!written)
            return 2;
        enum verdict verdict = run(argv[1], &files_of_seed, words, sizeof words);
        counts[verdict]++;
        if (verdict >= ENGINE_CRASHED) {
            printf("%ld: %s: %.300s\n", seed, names[verdict], words);
            fflush(stdout);
            continue; /* its files stay */
        }
        unlink(files_of_seed.netlist);
        unlink(files_of_seed.scene);
        unlink(files_of_seed.complaint);
    }
    for (int i = 0; i < 6; i++)
        printf("%ld %s%s", counts[i], names[i], i < 5 ? ", " : "\n");
    printf("%ld passed, %ld failed\n",
           counts[DONE] + counts[REFUSED] + counts[GAVE_UP] + counts[ENGINE_CRASHED] + counts[SLOW], counts[BROKEN]);
    for (int i = 0; i < files; i++)
        free(paths[i]);
    return counts[BROKEN] > 0 || files == 0;
}
