/* SPDX-License-Identifier: MIT */
/* A command's options: one table drives parsing, --help and the messages. */
#ifndef INLAY_APP_OPTIONS_H
#define INLAY_APP_OPTIONS_H

#include <stddef.h>

#define EXIT_DONE 0
#define EXIT_FAILED 1
#define EXIT_USAGE 2

#define OPTIONS_GO_ON (-1)

struct option_row {
	const char *name;     /* without the dashes: "config" */
	char letter;	      /* short form; 0: none */
	const char *argument; /* "FILE"; NULL: takes none */
	const char *help;
	/* Called each time the option is given; argument is NULL where it takes none. 0, or -EINVAL
	 * with *expected set to what was expected. */
	int (*take)(void *context, const char *argument, const char **expected);
};

struct command {
	const char *name;
	const char *usage;		  /* one line after the name */
	const char *purpose;		  /* one line, for the list of commands */
	const char *details;		  /* paragraphs below it in --help; may be NULL */
	const struct option_row *options; /* ends with a NULL name */
	/* Called for each word that is no option, like take() of a row. NULL: words are refused. */
	int (*take_word)(void *context, const char *word, const char **expected);
	int (*run)(int argc, char **argv); /* argv[0] is the command's name; returns an exit code */
};

/* Reads argv[1..]. Returns OPTIONS_GO_ON, or an exit code: --help was printed, or a fault was
 * logged. */
int options_read(const struct command *command, int argc, char **argv, void *context);

/* Read a number from an argument, for take(). -EINVAL: not a number, or not within low..high. */
int option_integer(const char *argument, long low, long high, long *value);
int option_number(const char *argument, double low, double high, double *value);

#endif
