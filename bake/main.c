/* inlay-bake: the offline side of inlay. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bake/options.h"
#include "hal/log.h"

static const struct command *const commands[] = {
	&dome_command, &render_command, &info_command, &truth_command, &report_command,
};

#define COMMANDS (sizeof(commands) / sizeof(commands[0]))

static void print_usage(FILE *stream)
{
	fprintf(stream, "usage: inlay-bake COMMAND ...\n\n");
	for (size_t k = 0; k < COMMANDS; k++)
		fprintf(stream, "  %-8s %s\n", commands[k]->name, commands[k]->summary);
	fprintf(stream, "\ninlay-bake COMMAND --help says more; inlay-bake --version.\n");
}

int main(int argc, char **argv)
{
	log_setup("inlay-bake", LOG_LEVEL_INFO);
	if (argc < 2) {
		print_usage(stderr);
		return EXIT_USAGE;
	}
	if (!strcmp(argv[1], "--help") || !strcmp(argv[1], "-h")) {
		print_usage(stdout);
		return EXIT_SUCCESS;
	}
	if (!strcmp(argv[1], "--version")) {
		printf("inlay-bake %s\n", INLAY_VERSION);
		return EXIT_SUCCESS;
	}
	for (size_t k = 0; k < COMMANDS; k++)
		if (!strcmp(argv[1], commands[k]->name)) {
			const int status = commands[k]->run(commands[k], argc - 1, argv + 1);

			/* a full disk under stdout shows only now */
			if (fflush(stdout) || ferror(stdout)) {
				log_error("standard output cannot be written");
				return EXIT_FAILURE;
			}
			return status;
		}
	fprintf(stderr, "inlay-bake: there is no command \"%s\"\n", argv[1]);
	print_usage(stderr);
	return EXIT_USAGE;
}
