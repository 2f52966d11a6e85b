#include "bake/options.h"

#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "hal/basis/basis_format.h"

int command_answer(const struct command *command, int option)
{
	if (option == OPTION_VERSION) {
		printf("inlay-bake %s\n", INLAY_VERSION);
		return EXIT_SUCCESS;
	}
	if (option == OPTION_HELP) {
		printf("usage: inlay-bake %s %s\n\n%s\n%s", command->name, command->usage,
		       command->summary, command->help);
		return EXIT_SUCCESS;
	}
	fprintf(stderr, "usage: inlay-bake %s %s\n", command->name, command->usage);
	return EXIT_USAGE;
}

int command_wrong(const struct command *command, const char *format, ...)
{
	va_list args;

	fprintf(stderr, "inlay-bake: ");
	va_start(args, format);
	vfprintf(stderr, format, args);
	va_end(args);
	fputc('\n', stderr);
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
	char *end;
	double x;

	x = strtod(text, &end);
	if (end == text || *end || !isfinite(x) || x < min || x > max)
		return fault_say(fault, -EINVAL, "%s: \"%s\", expected a number from %g to %g",
				 option, text, min, max);
	*value = x;
	return 0;
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
