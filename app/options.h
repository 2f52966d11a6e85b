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
	char letter;	      /* of a short form, 0 for none */
	const char *argument; /* "FILE"; NULL: takes none */
	const char *help;
	/* Called for each time it is given; argument is NULL where it takes none. 0, or -EINVAL
	 * with what was expected in expected[]. */
	int (*take)(void *context, const char *argument, const char **expected);
};

struct command {
	const char *name;
	const char *usage;		  /* one line after the name */
	const char *purpose;		  /* one line, for the list of commands */
	const char *details;		  /* paragraphs below it in --help; may be NULL */
	const struct option_row *options; /* ends with a NULL name */
	/* Called for each word that is no option, as take() of a row. NULL: there are none. */
	int (*take_word)(void *context, const char *word, const char **expected);
	int (*run)(int argc, char **argv); /* argv[0] is the command's name; returns an exit code */
};

/* Reads argv[1..]. OPTIONS_GO_ON, or an exit code: --help was printed, or something is wrong and
 * was said on stderr. */
int options_read(const struct command *command, int argc, char **argv, void *context);

/* take() of plain values. */
int option_integer(const char *argument, long low, long high, long *value);
int option_number(const char *argument, double low, double high, double *value);

#endif
