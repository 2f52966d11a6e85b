/* SPDX-License-Identifier: MIT */
#include <signal.h>
#include <stdio.h>
#include <string.h>

#include "app/commands.h"
#include "hal/base/log.h"
#include "hal/ini/ini.h"

static const struct command *const commands[] = {&command_run,	&command_control, &command_still,
						 &command_grab, &command_devices, &command_check,
						 &command_bench};

#define COMMAND_COUNT (sizeof(commands) / sizeof(*commands))

static void print_commands(FILE *stream)
{
	fputs("usage: inlay COMMAND [options]\n\n"
	      "Stands a virtual object in a live picture, lit by the light that is there.\n\n"
	      "commands:\n",
	      stream);
	for (size_t i = 0; i < COMMAND_COUNT; i++)
		fprintf(stream, "  %-10s %s\n", commands[i]->name, commands[i]->purpose);
	fputs("\n  inlay COMMAND --help   the command's options\n"
	      "  inlay --version        the version\n\n"
	      "exit codes: 0 done, 1 failed, 2 wrong usage\n",
	      stream);
}

static int refuse_command(const char *word)
{
	const char *names[COMMAND_COUNT], *near;

	for (size_t i = 0; i < COMMAND_COUNT; i++)
		names[i] = commands[i]->name;
	near = ini_nearest(word, names, COMMAND_COUNT);
	if (near)
		log_error("unknown command \"%.60s\", did you mean \"%s\"?", word, near);
	else
		log_error(
			"unknown command \"%.60s\", expected one of those that inlay --help lists",
			word);
	return EXIT_USAGE;
}

/* Checks that the output has arrived: a full disk behind ">" is a failure. */
static int end_output(int code)
{
	if (fflush(stdout) || ferror(stdout)) {
		log_error("cannot write to standard output");
		return code == EXIT_DONE ? EXIT_FAILED : code;
	}
	return code;
}

int main(int argc, char **argv)
{
	log_setup("inlay", LOG_LEVEL_INFO);
	signal(SIGXFSZ, SIG_IGN); /* a write beyond the file size limit then returns an error */
	if (argc < 2) {
		print_commands(stderr);
		return EXIT_USAGE;
	}
	if (!strcmp(argv[1], "--help") || !strcmp(argv[1], "-h")) {
		print_commands(stdout);
		return end_output(EXIT_DONE);
	}
	if (!strcmp(argv[1], "--version")) {
		puts("inlay " INLAY_VERSION);
		return end_output(EXIT_DONE);
	}
	for (size_t i = 0; i < COMMAND_COUNT; i++) {
		if (!strcmp(argv[1], commands[i]->name))
			return end_output(commands[i]->run(argc - 1, argv + 1));
	}
	return refuse_command(argv[1]);
}
