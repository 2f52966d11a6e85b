/* SPDX-License-Identifier: MIT */
/* The options of path tracing, the same for truth and pictures. */
#ifndef INLAY_BAKE_TRUTH_TRUTH_OPTIONS_H
#define INLAY_BAKE_TRUTH_TRUTH_OPTIONS_H

#include "bake/truth/truth.h"

enum truth_option {
	TRUTH_SAMPLES = 400, /* above the commands' own and those of the lights */
	TRUTH_SEED,
	TRUTH_THREADS,
	TRUTH_QUIET
};

/* For getopt_long(). */
#define TRUTH_OPTIONS                                                                              \
	{"samples", required_argument, NULL, TRUTH_SAMPLES},                                       \
		{"seed", required_argument, NULL, TRUTH_SEED},                                     \
		{"threads", required_argument, NULL, TRUTH_THREADS},                               \
	{                                                                                          \
		"quiet", no_argument, NULL, TRUTH_QUIET                                            \
	}

/* Takes one of these options with its argument. -EINVAL. */
int truth_option_take(struct truth_settings *settings, int option, const char *text,
		      struct fault *fault);

#endif
