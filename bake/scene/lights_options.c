/* SPDX-License-Identifier: MIT */
#include "bake/scene/lights_options.h"

#include "bake/base/options.h"

int lights_option_take(struct scene_lights *lights, int option, const char *text,
		       struct fault *fault)
{
	switch (option) {
	case LIGHTS_FREQUENCY:
		return option_int("--frequency", text, 1, DOME_FREQUENCY_MAX, &lights->frequency,
				  fault);
	default:
		lights->fine = text;
		return 0;
	}
}
