/* One function per command; each parses its own arguments (argv[0] is the command's name) and returns the exit code of
 * the contract: 0 good, 1 an expectation failed, 2 bad input, 3 the solver gave up, 4 internal. */
#ifndef DEASIM_CLI_H
#define DEASIM_CLI_H

int cli_run(int argc, char **argv);
int cli_check(int argc, char **argv);
int cli_test(int argc, char **argv);
int cli_static(int argc, char **argv);
int cli_map(int argc, char **argv);
int cli_optimum(int argc, char **argv);
int cli_fit(int argc, char **argv);
int cli_export(int argc, char **argv);
int cli_plot(int argc, char **argv);

#endif
