/* SPDX-License-Identifier: MIT */
#include "app/options.h"

#include <errno.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "hal/base/log.h"
#include "hal/base/number.h"
#include "hal/ini/ini.h"

#define ROWS_MAX 32

int option_integer(const char *argument, long low, long high, long *value)
{
	char *end;
	long n;

	errno = 0;
	n = strtol(argument, &end, 10);
	if (end == argument || *end || errno || n < low || n > high)
		return -EINVAL;
	*value = n;
	return 0;
}

int option_number(const char *argument, double low, double high, double *value)
{
	double v;

	if (number_of(argument, &v) < 0 || v < low || v > high)
		return -EINVAL;
	*value = v;
	return 0;
}

static void print_option(const struct option_row *row)
{
	char left[64];
	int length = 0;

	if (row->letter)
		length = snprintf(left, sizeof(left), "-%c, ", row->letter);
	snprintf(left + length, sizeof(left) - (size_t)length, "--%s%s%s", row->name,
		 row->argument ? " " : "", row->argument ? row->argument : "");
	printf("  %-24s %s\n", left, row->help);
}

static void print_options(const struct command *command)
{
	printf("usage: inlay %s %s\n\n%s\n", command->name, command->usage, command->purpose);
	if (command->details)
		printf("\n%s\n", command->details);
	printf("\noptions:\n");
	for (const struct option_row *row = command->options; row->name; row++)
		print_option(row);
	printf("  %-24s %s\n", "--help", "this text");
}

static const struct option_row *find_row(const struct option_row *rows, const char *name,
					 size_t length)
{
	for (; rows->name; rows++) {
		if (strlen(rows->name) == length && !memcmp(rows->name, name, length))
			return rows;
	}
	return NULL;
}

static const struct option_row *find_letter(const struct option_row *rows, char letter)
{
	for (; rows->name; rows++) {
		if (rows->letter == letter)
			return rows;
	}
	return NULL;
}

static int refuse_option(const struct command *command, const char *word, size_t length)
{
	const char *names[ROWS_MAX] = {"help"}, *near;
	char name[64];
	size_t count = 1;

	for (const struct option_row *row = command->options; row->name && count < ROWS_MAX; row++)
		names[count++] = row->name;
	snprintf(name, sizeof(name), "%.*s", (int)length, word);
	near = ini_nearest(name, names, count);
	if (near)
		log_error("%s: unknown option --%s, did you mean --%s?", command->name, name, near);
	else
		log_error(
			"%s: unknown option --%s, expected one of those that inlay %s --help lists",
			command->name, name, command->name);
	return EXIT_USAGE;
}

/* The argument of an option: behind "=", or the next word. NULL: there is none, which was
 * logged. */
static const char *argument_of(const struct command *command, const struct option_row *row,
			       const char *attached, int argc, char **argv, int *at)
{
	if (attached)
		return attached;
	if (*at + 1 < argc)
		return argv[++*at];
	log_error("%s: --%s has no value, expected --%s %s", command->name, row->name, row->name,
		  row->argument);
	return NULL;
}

static int take_option(const struct command *command, const struct option_row *row,
		       const char *attached, int argc, char **argv, int *at, void *context)
{
	const char *argument = NULL, *expected = row->argument;
	int err;

	if (!row->argument && attached) {
		log_error("%s: --%s takes no value, \"%s\" was given", command->name, row->name,
			  attached);
		return EXIT_USAGE;
	}
	if (row->argument) {
		argument = argument_of(command, row, attached, argc, argv, at);
		if (!argument)
			return EXIT_USAGE;
	}
	err = row->take(context, argument, &expected);
	if (err) {
		log_error("%s: --%s is \"%s\", expected %s", command->name, row->name,
			  argument ? argument : "", expected);
		return EXIT_USAGE;
	}
	return OPTIONS_GO_ON;
}

static int take_bare(const struct command *command, const char *word, void *context)
{
	const char *expected = NULL;

	if (!command->take_word) {
		log_error("%s: \"%.60s\" is no option, expected --name", command->name, word);
		return EXIT_USAGE;
	}
	if (command->take_word(context, word, &expected)) {
		log_error("%s: \"%.60s\" is not right here, expected %s", command->name, word,
			  expected);
		return EXIT_USAGE;
	}
	return OPTIONS_GO_ON;
}

static int read_word(const struct command *command, int argc, char **argv, int *at, void *context)
{
	const char *word = argv[*at], *attached = NULL;
	const struct option_row *row;
	size_t length;

	if (word[0] == '-' && word[1] && word[1] != '-') {
		row = find_letter(command->options, word[1]);
		if (!row) {
			log_error(
				"%s: unknown option %.20s, expected one of those that inlay %s --help lists",
				command->name, word, command->name);
			return EXIT_USAGE;
		}
		return take_option(command, row, word[2] ? word + 2 : NULL, argc, argv, at,
				   context);
	}
	if (word[0] != '-' || !word[1])
		return take_bare(command, word, context);
	word += 2;
	length = strcspn(word, "=");
	if (word[length])
		attached = word + length + 1;
	if (length == 4 && !memcmp(word, "help", 4)) {
		print_options(command);
		return EXIT_DONE;
	}
	row = find_row(command->options, word, length);
	if (!row)
		return refuse_option(command, word, length);
	return take_option(command, row, attached, argc, argv, at, context);
}

int options_read(const struct command *command, int argc, char **argv, void *context)
{
	for (int at = 1; at < argc; at++) {
		int code = read_word(command, argc, argv, &at, context);

		if (code != OPTIONS_GO_ON)
			return code;
	}
	return OPTIONS_GO_ON;
}
