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
	case LIGHTS_DIVISION:
		return option_choice("--division", text, dome_division_names, &lights->division,
				     fault);
	case LIGHTS_FINE:
		lights->fine = text;
		return 0;
	default:
		return option_choice("--lights", text, dome_shape_names, &lights->shape, fault);
	}
}
