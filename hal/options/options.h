/* SPDX-License-Identifier: MIT */
/* Values of command-line options, and programs that are a table of commands. */
#ifndef INLAY_HAL_OPTIONS_OPTIONS_H
#define INLAY_HAL_OPTIONS_OPTIONS_H

#include <stddef.h>

#include "hal/base/fault.h"

#define EXIT_USAGE 2
/* Done, the file is kept, but an error is larger than asked for; or the camera sees no object, and
 * there is no file. */
#define EXIT_MISSED 3

/* One entry of the command table. run() gets argv from the command's own name on, and returns the
 * exit status. */
struct command {
	const char *name;
	const char *usage;   /* what follows the name in the line of usage */
	const char *summary; /* one line */
	const char *help;    /* what --help prints after the summary; may be NULL */
	int (*run)(const struct command *command, int argc, char **argv);
};

/* Does all of main(): finds the command in the table (NULL at its end) and runs it. about: what
 * --help says of the program, or NULL. Returns the exit status. */
int program_run(const char *name, const char *about, const struct command *const *commands,
		int argc, char **argv);

enum option_kind {
	OPTION_TEXT,   /* const char * */
	OPTION_FLAG,   /* bool; without an argument */
	OPTION_INT,    /* int, min..max */
	OPTION_REAL,   /* double, min..max */
	OPTION_SIZE,   /* two ints: width, height */
	OPTION_CHOICE, /* int: index into choices */
	OPTION_LIST,   /* struct option_list: may be given again */
	OPTION_OTHER   /* take() reads it into what lies at place */
};

#define OPTION_LIST_MAX 64

struct option_list {
	const char *text[OPTION_LIST_MAX];
	int count;
};

/* An option whose argument goes into a field of the command's struct. */
struct option_row {
	const char *name; /* "output" and "out" may also be written -o */
	enum option_kind kind;
	size_t place; /* of the field */
	double min, max;
	const char *const *choices; /* NULL at the end */
	/* option: its name with the dashes, for the fault */
	int (*take)(void *field, const char *option, const char *text, struct fault *fault);
	size_t given; /* of a bool that becomes true where the option is given; 0: of none */
	/* What --help says: the word that stands for its argument, and its meaning. NULL: the
	 * command's own help says it. */
	const char *argument, *help;
};

#define OPTION_ROWS_MAX 32

/*
 * Reads the options of argv by rows that end with a NULL name into the struct at values.
 * Afterwards optind of <getopt.h> is at the first word that is no option. Returns
 * COMMAND_GOES_ON, or the exit status when the command has been answered here: after --help and
 * --version, and after wrong usage.
 */
#define COMMAND_GOES_ON (-1)
int command_read(const struct command *command, int argc, char **argv,
		 const struct option_row *rows, void *values);
/* Refuses words beside the options as well. */
int command_read_all(const struct command *command, int argc, char **argv,
		     const struct option_row *rows, void *values);

/* Logs what is wrong with the usage. Returns the exit status. */
int command_wrong(const struct command *command, const char *format, ...)
	__attribute__((format(printf, 2, 3)));

/* These read the argument of an option. 0, or -EINVAL with a fault that names the option. Ranges
 * are inclusive. */
int option_int(const char *option, const char *text, int min, int max, int *value,
	       struct fault *fault);
int option_real(const char *option, const char *text, double min, double max, double *value,
		struct fault *fault);
/* Reads least to most numbers with commas between. Returns how many, or -EINVAL. */
int option_reals(const char *option, const char *text, int least, int most, double min, double max,
		 double *value, struct fault *fault);
int option_size(const char *option, const char *text, int *width, int *height, struct fault *fault);
int option_choice(const char *option, const char *text, const char *const *choices, int *value,
		  struct fault *fault);

#endif
