/* deasim: picks the command. */
#include "cli/cli.h"
#include "deasim/status.h"

#include <errno.h>
#include <locale.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>

static const struct {
    const char *name, *summary;
    int (*run)(int argc, char **argv);
} commands[] = {
    {"run", "run a scene in time: result files, summary", cli_run},
    {"check", "read and vet a scene with all its files, run nothing", cli_check},
    {"test", "run scenes and judge their `expect`", cli_test},
    {"static", "equilibrium of a device at voltages or fields, and its first failure", cli_static},
    {"map", "design map over two parameters: CSV and PNG", cli_map},
    {"optimum", "the design that moves its platform farthest", cli_optimum},
    {"fit", "elastic law or branches from measured data, with confidence intervals", cli_fit},
    {"plot", "draw a run's result.csv as result.png", cli_plot},
    {"export", "write a scene as a deck for plain ngspice", cli_export},
};
enum { COMMANDS = sizeof commands / sizeof commands[0] };

static void print_help(FILE *file) {
    fprintf(file, "deasim " DEASIM_VERSION ": dielectric elastomer actuators and their drive electronics, in time\n\n"
                  "usage: deasim COMMAND [ARGUMENTS]   (deasim COMMAND --help tells more)\n\ncommands:\n");
    for (int i = 0; i < COMMANDS; i++)
        fprintf(file, "  %-8s %s\n", commands[i].name, commands[i].summary);
    fprintf(file, "\nexit codes: 0 good, 1 an expectation failed, 2 bad input, 3 the solver gave up (results so far "
                  "are kept), 4 internal\n");
}

/* An answer that did not all get out is none, whatever the command thinks of it. */
static int check_answer(const char *command, int code) {
    errno = 0;
    if (fflush(stdout) == 0 && !ferror(stdout)) /* the latter remembers a write that failed on the way */
        return code;
    fprintf(stderr, "deasim %s: the answer could not be written: %s\n", command, strerror(errno != 0 ? errno : EIO));
    return code != 0 ? code : dea_exit_code(DEA_ERR_OUTPUT);
}

int main(int argc, char **argv) {
    setlocale(LC_ALL, "C");   /* numbers are read and written with a point, everywhere */
    signal(SIGXFSZ, SIG_IGN); /* a limit on file sizes is a full disk: the write fails and is reported */
    if (argc < 2) {
        print_help(stderr);
        return 2;
    }
    if (strcmp(argv[1], "--help") == 0 || strcmp(argv[1], "-h") == 0 || strcmp(argv[1], "help") == 0) {
        print_help(stdout);
        return check_answer("--help", 0);
    }
    if (strcmp(argv[1], "--version") == 0 || strcmp(argv[1], "-V") == 0) {
        puts("deasim " DEASIM_VERSION);
        return check_answer("--version", 0);
    }
    for (int i = 0; i < COMMANDS; i++)
        if (strcmp(argv[1], commands[i].name) == 0)
            return check_answer(commands[i].name, commands[i].run(argc - 1, argv + 1));
    fprintf(stderr, "deasim: unknown command \"%s\"; commands are:", argv[1]);
    for (int i = 0; i < COMMANDS; i++)
        fprintf(stderr, " %s", commands[i].name);
    fprintf(stderr, " (deasim --help)\n");
    return 2;
}
