/* SPDX-License-Identifier: MIT */
/* The options that choose the lights of a dome, the same for all commands that have them. */
#ifndef INLAY_BAKE_SCENE_LIGHTS_OPTIONS_H
#define INLAY_BAKE_SCENE_LIGHTS_OPTIONS_H

#include "bake/scene/scene.h"

enum lights_option {
	LIGHTS_FREQUENCY = 300, /* above the commands' own and those of an encoding */
	LIGHTS_FINE
};

/* Entries of getopt_long()'s table. */
#define LIGHTS_OPTIONS                                                                             \
	{"frequency", required_argument, NULL, LIGHTS_FREQUENCY},                                  \
	{                                                                                          \
		"fine", required_argument, NULL, LIGHTS_FINE                                       \
	}

/* Parses one of these options and its argument. -EINVAL. */
int lights_option_take(struct scene_lights *lights, int option, const char *text,
		       struct fault *fault);

#endif
