/* SPDX-License-Identifier: MIT */
#include "hal/options/options.h"

#include <errno.h>
#include <getopt.h>
#include <signal.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "hal/base/log.h"
#include "hal/base/number.h"
#include "hal/basis/basis_format.h"
#include "hal/ini/ini.h"

#define COMMANDS_MAX 16
#define HELP_COLUMN 26 /* of what an option means */
/* What getopt_long() returns: for the first row, above all letters; and for what every command
 * has. */
#define OPTION_FIRST 256
#define OPTION_HELP 1000
#define OPTION_VERSION 1001

static const char *program = "inlay";

static void print_usage(FILE *stream, const char *about, const struct command *const *commands)
{
	fprintf(stream, "usage: %s COMMAND ...\n\n%s", program, about ? about : "");
	for (; *commands; commands++)
		fprintf(stream, "  %-10s %s\n", (*commands)->name, (*commands)->summary);
	fprintf(stream, "\n%s COMMAND --help says more; %s --version.\n", program, program);
}

static int refuse_command(const char *word, const struct command *const *commands)
{
	const char *names[COMMANDS_MAX], *near;
	size_t count = 0;

	for (; commands[count] && count < COMMANDS_MAX; count++)
		names[count] = commands[count]->name;
	near = ini_nearest(word, names, count);
	if (near)
		log_error("there is no command \"%.60s\", did you mean \"%s\"?", word, near);
	else
		log_error(
			"there is no command \"%.60s\", expected one of those that %s --help lists",
			word, program);
	return EXIT_USAGE;
}

static int answer_program(const char *about, const struct command *const *commands, int argc,
			  char **argv)
{
	if (argc < 2) {
		print_usage(stderr, about, commands);
		return EXIT_USAGE;
	}
	if (!strcmp(argv[1], "--help") || !strcmp(argv[1], "-h")) {
		print_usage(stdout, about, commands);
		return EXIT_SUCCESS;
	}
	if (!strcmp(argv[1], "--version")) {
		printf("%s %s\n", program, INLAY_VERSION);
		return EXIT_SUCCESS;
	}
	for (const struct command *const *c = commands; *c; c++)
		if (!strcmp(argv[1], (*c)->name))
			return (*c)->run(*c, argc - 1, argv + 1);
	return refuse_command(argv[1], commands);
}

int program_run(const char *name, const char *about, const struct command *const *commands,
		int argc, char **argv)
{
	int status;

	program = name;
	log_setup(name, LOG_LEVEL_INFO);
	signal(SIGXFSZ, SIG_IGN); /* so that a file that grows too large is an error of write() */
	status = answer_program(about, commands, argc, argv);
	/* a full disk behind stdout is reported only here */
	if (fflush(stdout) || ferror(stdout)) {
		log_error("cannot write to standard output");
		return status ? status : EXIT_FAILURE;
	}
	return status;
}

static bool has_letter(const struct option_row *row)
{
	return !strcmp(row->name, "output") || !strcmp(row->name, "out");
}

static void print_rows(const struct option_row *rows)
{
	puts("\noptions:");
	for (; rows->name; rows++) {
		const int length = printf("  %s--%s%s%s", has_letter(rows) ? "-o, " : "",
					  rows->name, rows->argument ? " " : "",
					  rows->argument ? rows->argument : "");

		printf("%*s %s\n", length < HELP_COLUMN ? HELP_COLUMN - length : 1, "", rows->help);
	}
}

/* Answers --help and --version. */
static void command_answer(const struct command *command, int option, const struct option_row *rows)
{
	if (option == OPTION_VERSION) {
		printf("%s %s\n", program, INLAY_VERSION);
		return;
	}
	printf("usage: %s %s %s\n\n%s\n%s", program, command->name, command->usage,
	       command->summary, command->help ? command->help : "");
	if (rows->help)
		print_rows(rows);
}

/* Says why getopt_long() does not take a word. */
static int refuse_option(const struct command *command, const struct option *options, int answer,
			 const char *word)
{
	const char *names[OPTION_ROWS_MAX + 2], *near;
	size_t count = 0;
	char name[64];

	for (; options[count].name; count++) {
		if (optopt && options[count].val == optopt)
			return command_wrong(command,
					     answer == ':' ? "--%s has no value"
							   : "--%s takes no value",
					     options[count].name);
		names[count] = options[count].name;
	}
	if (optopt)
		return command_wrong(command, "unknown option -%c", optopt);
	snprintf(name, sizeof(name), "%.*s", (int)strcspn(word + 2, "="), word + 2);
	near = ini_nearest(name, names, count);
	return command_wrong(
		command, near ? "unknown option --%s, did you mean --%s?" : "unknown option --%s",
		name, near);
}

static int add_to_list(const char *option, struct option_list *list, struct fault *fault)
{
	if (list->count == OPTION_LIST_MAX)
		return fault_say(fault, -E2BIG, "%s: expected no more than %d of them", option,
				 OPTION_LIST_MAX);
	list->text[list->count++] = optarg;
	return 0;
}

static int take_row(const struct option_row *row, char *values, struct fault *fault)
{
	void *to = values + row->place;
	char name[64];

	snprintf(name, sizeof(name), "--%s", row->name);
	if (row->given)
		*(bool *)(values + row->given) = true;
	switch (row->kind) {
	case OPTION_TEXT:
		*(const char **)to = optarg;
		return 0;
	case OPTION_FLAG:
		*(bool *)to = true;
		return 0;
	case OPTION_INT:
		return option_int(name, optarg, (int)row->min, (int)row->max, to, fault);
	case OPTION_REAL:
		return option_real(name, optarg, row->min, row->max, to, fault);
	case OPTION_SIZE:
		return option_size(name, optarg, to, (int *)to + 1, fault);
	case OPTION_CHOICE:
		return option_choice(name, optarg, row->choices, to, fault);
	case OPTION_LIST:
		return add_to_list(name, to, fault);
	default:
		return row->take(to, name, optarg, fault);
	}
}

int command_read(const struct command *command, int argc, char **argv,
		 const struct option_row *rows, void *values)
{
	struct option options[OPTION_ROWS_MAX + 3] = {{.name = NULL}};
	struct fault fault = {.text = ""};
	const char *letters = ":";
	int count = 0, option;

	for (; rows[count].name && count < OPTION_ROWS_MAX; count++) {
		options[count] = (struct option){
			rows[count].name,
			rows[count].kind == OPTION_FLAG ? no_argument : required_argument, NULL,
			has_letter(&rows[count]) ? 'o' : OPTION_FIRST + count};
		letters = has_letter(&rows[count]) ? ":o:" : letters;
	}
	options[count] = (struct option){"help", no_argument, NULL, OPTION_HELP};
	options[count + 1] = (struct option){"version", no_argument, NULL, OPTION_VERSION};
	opterr = 0;
	optind = 0; /* begins anew */
	while ((option = getopt_long(argc, argv, letters, options, NULL)) != -1) {
		int k = 0;

		if (option == OPTION_HELP || option == OPTION_VERSION) {
			command_answer(command, option, rows);
			return EXIT_SUCCESS;
		}
		if (option == '?' || option == ':')
			return refuse_option(command, options, option, argv[optind - 1]);
		while (options[k].val != option)
			k++;
		if (take_row(&rows[k], values, &fault))
			return command_wrong(command, "%s", fault.text);
	}
	return COMMAND_GOES_ON;
}

int command_read_all(const struct command *command, int argc, char **argv,
		     const struct option_row *rows, void *values)
{
	const int status = command_read(command, argc, argv, rows, values);

	return status == COMMAND_GOES_ON && optind < argc
		       ? command_wrong(command, "\"%.60s\" is one argument too many", argv[optind])
		       : status;
}

int command_wrong(const struct command *command, const char *format, ...)
{
	char text[FAULT_TEXT_MAX];
	va_list args;

	va_start(args, format);
	vsnprintf(text, sizeof(text), format, args);
	va_end(args);
	log_error("%s: %s", command->name, text);
	return EXIT_USAGE;
}

int option_int(const char *option, const char *text, int min, int max, int *value,
	       struct fault *fault)
{
	char *end;
	long n;

	errno = 0;
	n = strtol(text, &end, 10);
	if (errno || end == text || *end || n < min || n > max)
		return fault_say(fault, -EINVAL,
				 "%s: \"%s\", expected a whole number from %d to %d", option, text,
				 min, max);
	*value = (int)n;
	return 0;
}

int option_real(const char *option, const char *text, double min, double max, double *value,
		struct fault *fault)
{
	double x;

	if (number_of(text, &x) < 0 || x < min || x > max)
		return fault_say(fault, -EINVAL, "%s: \"%s\", expected a number from %g to %g",
				 option, text, min, max);
	*value = x;
	return 0;
}

int option_reals(const char *option, const char *text, int least, int most, double min, double max,
		 double *value, struct fault *fault)
{
	const char *at = text;
	int count = 0;

	for (; count < most; at++) {
		double x;

		at += strspn(at, " ");
		if (number_read(&at, &x) || !(x >= min && x <= max) || (*at && *at != ','))
			break;
		value[count++] = x;
		if (!*at && count >= least)
			return count;
		if (!*at)
			break;
	}
	return fault_say(fault, -EINVAL,
			 "%s: \"%s\", expected %d to %d numbers from %g to %g with commas between",
			 option, text, least, most, min, max);
}

int option_size(const char *option, const char *text, int *width, int *height, struct fault *fault)
{
	int w, h;
	char rest;

	if (strlen(text) > 16 || sscanf(text, "%dx%d%c", &w, &h, &rest) != 2 || w < 1 || h < 1 ||
	    w > BASIS_SIDE_MAX || h > BASIS_SIDE_MAX)
		return fault_say(fault, -EINVAL,
				 "%s: \"%s\", expected a size such as 640x480, sides up to %d",
				 option, text, BASIS_SIDE_MAX);
	*width = w;
	*height = h;
	return 0;
}

int option_choice(const char *option, const char *text, const char *const *choices, int *value,
		  struct fault *fault)
{
	char list[256] = "";

	for (int k = 0; choices[k]; k++) {
		const size_t used = strlen(list);

		if (!strcmp(choices[k], text)) {
			*value = k;
			return 0;
		}
		snprintf(list + used, sizeof(list) - used, "%s%s", k ? ", " : "", choices[k]);
	}
	return fault_say(fault, -EINVAL, "%s: \"%s\", expected one of %s", option, text, list);
}
