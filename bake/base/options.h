/* SPDX-License-Identifier: MIT */
/* Command-line values, and programs that are a table of commands. */
#ifndef INLAY_BAKE_BASE_OPTIONS_H
#define INLAY_BAKE_BASE_OPTIONS_H

#include "hal/base/fault.h"

#define EXIT_USAGE 2

/* One entry of the command table. run gets argv with the command's own name first, and returns the
 * exit status. */
struct command {
	const char *name;
	const char *usage;   /* what follows the name */
	const char *summary; /* one line */
	const char *help;    /* the rest */
	int (*run)(const struct command *command, int argc, char **argv);
};

/* main() of such a program: its commands, NULL at the end. Returns the exit status. */
int program_run(const char *name, const struct command *const *commands, int argc, char **argv);

/* --help, --version (what getopt_long returns for them) and wrong usage. */
#define OPTION_HELP 1000
#define OPTION_VERSION 1001
#define OPTIONS_OF_ALL                                                                             \
	{"help", no_argument, NULL, OPTION_HELP},                                                  \
	{                                                                                          \
		"version", no_argument, NULL, OPTION_VERSION                                       \
	}

struct option;

/*
 * Goes through the options of argv: take() gets each, what belongs to it being optarg, and says in
 * `fault` what is wrong with it. optind is then at the first word. 'o' among them is -o, too.
 * Returns COMMAND_GOES_ON; or the exit status, where --help or --version was asked for or something
 * is wrong, which it has answered.
 */
#define COMMAND_GOES_ON (-1)
int command_options(const struct command *command, int argc, char **argv,
		    const struct option *options,
		    int (*take)(void *choices, int option, struct fault *fault), void *choices);

/* Says what is wrong with the usage; returns the exit status. */
int command_wrong(const struct command *command, const char *format, ...)
	__attribute__((format(printf, 2, 3)));

/* -EINVAL with a fault that names the option. Ranges are inclusive. */
int option_int(const char *option, const char *text, int min, int max, int *value,
	       struct fault *fault);
int option_real(const char *option, const char *text, double min, double max, double *value,
		struct fault *fault);
/* Numbers with commas between; how many, or -EINVAL. */
int option_reals(const char *option, const char *text, int least, int most, double min, double max,
		 double *value, struct fault *fault);
int option_size(const char *option, const char *text, int *width, int *height, struct fault *fault);
int option_choice(const char *option, const char *text, const char *const *choices, int *value,
		  struct fault *fault);

#endif
