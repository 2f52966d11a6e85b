/* SPDX-License-Identifier: MIT */
#include "bake/base/options.h"

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

static const char *program = "inlay-bake";

static void print_usage(FILE *stream, const struct bake_command *const *commands)
{
	fprintf(stream, "usage: %s COMMAND ...\n\n", program);
	for (; *commands; commands++)
		fprintf(stream, "  %-8s %s\n", (*commands)->name, (*commands)->summary);
	fprintf(stream, "\n%s COMMAND --help says more; %s --version.\n", program, program);
}

static int run_command(const struct bake_command *command, int argc, char **argv)
{
	const int status = command->run(command, argc, argv);

	/* a full disk behind stdout is reported only here */
	if (fflush(stdout) || ferror(stdout)) {
		log_error("standard output cannot be written");
		return EXIT_FAILURE;
	}
	return status;
}

int program_run(const char *name, const struct bake_command *const *commands, int argc, char **argv)
{
	program = name;
	log_setup(name, LOG_LEVEL_INFO);
	signal(SIGXFSZ, SIG_IGN); /* so that a file that grows too large is an error of write() */
	if (argc < 2) {
		print_usage(stderr, commands);
		return EXIT_USAGE;
	}
	if (!strcmp(argv[1], "--help") || !strcmp(argv[1], "-h")) {
		print_usage(stdout, commands);
		return EXIT_SUCCESS;
	}
	if (!strcmp(argv[1], "--version")) {
		printf("%s %s\n", program, INLAY_VERSION);
		return EXIT_SUCCESS;
	}
	for (const struct bake_command *const *c = commands; *c; c++)
		if (!strcmp(argv[1], (*c)->name))
			return run_command(*c, argc - 1, argv + 1);
	log_error("there is no command \"%s\"", argv[1]);
	print_usage(stderr, commands);
	return EXIT_USAGE;
}

static bool has_output(const struct option *options)
{
	while (options->name && options->val != 'o')
		options++;
	return options->name;
}

/* Answers --help, --version and unknown options. Returns the exit status. */
static int command_answer(const struct bake_command *command, int option)
{
	if (option == OPTION_VERSION) {
		printf("%s %s\n", program, INLAY_VERSION);
		return EXIT_SUCCESS;
	}
	if (option == OPTION_HELP) {
		printf("usage: %s %s %s\n\n%s\n%s", program, command->name, command->usage,
		       command->summary, command->help);
		return EXIT_SUCCESS;
	}
	fprintf(stderr, "usage: %s %s %s\n", program, command->name, command->usage);
	return EXIT_USAGE;
}

int command_options(const struct bake_command *command, int argc, char **argv,
		    const struct option *options,
		    int (*take)(void *choices, int option, struct fault *fault), void *choices)
{
	const char *letters = has_output(options) ? "o:" : "";
	struct fault fault = {.text = ""};
	int option;

	argv[0] = (char *)program; /* getopt_long() begins its messages with it */
	while ((option = getopt_long(argc, argv, letters, options, NULL)) != -1) {
		if (option == OPTION_HELP || option == OPTION_VERSION || option == '?')
			return command_answer(command, option);
		if (take(choices, option, &fault))
			return command_wrong(command, "%s", fault.text);
	}
	return COMMAND_GOES_ON;
}

struct row_reader {
	const struct option_row *rows;
	struct option options[OPTION_ROWS_MAX + 3]; /* help, version, end */
	char *values;
};

static int option_row_take(void *context, int option, struct fault *fault)
{
	const struct row_reader *reader = context;
	const struct option_row *row = reader->rows;
	char name[64];
	void *to;

	while (reader->options[row - reader->rows].val != option)
		row++;
	to = reader->values + row->place;
	if (row->given)
		*(bool *)(reader->values + row->given) = true;
	snprintf(name, sizeof(name), "--%s", row->name);
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
	default:
		return row->take(to, name, optarg, fault);
	}
}

int command_read(const struct bake_command *command, int argc, char **argv,
		 const struct option_row *rows, void *values)
{
	static const struct option all[] = {OPTIONS_OF_ALL, {NULL, 0, NULL, 0}};
	struct row_reader reader = {.rows = rows, .values = values};
	int count = 0;

	for (; rows[count].name && count < OPTION_ROWS_MAX; count++)
		reader.options[count] = (struct option){
			rows[count].name,
			rows[count].kind == OPTION_FLAG ? no_argument : required_argument, NULL,
			strcmp(rows[count].name, "output") ? count + 1 : 'o'};
	memcpy(reader.options + count, all, sizeof(all));
	return command_options(command, argc, argv, reader.options, option_row_take, &reader);
}

int command_wrong(const struct bake_command *command, const char *format, ...)
{
	char text[FAULT_TEXT_MAX];
	va_list args;

	va_start(args, format);
	vsnprintf(text, sizeof(text), format, args);
	va_end(args);
	log_error("%s", text);
	return command_answer(command, '?');
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
