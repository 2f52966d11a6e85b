/* SPDX-License-Identifier: MIT */
/* The options that choose the lights of a dome, the same for all commands that have them. */
#ifndef INLAY_BAKE_SCENE_LIGHTS_OPTIONS_H
#define INLAY_BAKE_SCENE_LIGHTS_OPTIONS_H

#include "bake/scene/scene.h"
#include "hal/options/options.h"

/* Rows of a command whose AT(lights) is a struct scene_lights. */
/* clang-format off */
#define LIGHTS_ROWS										   \
	{"frequency", OPTION_INT, AT(lights.frequency), .min = 1, .max = DOME_FREQUENCY_MAX},	   \
	{"fine", OPTION_TEXT, AT(lights.fine)}
/* clang-format on */

#define LIGHTS_HELP                                                                                   \
	"  --frequency F   of the dome, 1 to 72; 9 makes 406 lights; else the scene's\n"              \
	"  --fine PARTS    where lights are finer: \"azimuth height radius frequency\" in degrees,\n" \
	"                  with commas between, or a file of such lines (inlay-scene(5)); \"\":\n"    \
	"                  nowhere\n"

#endif
