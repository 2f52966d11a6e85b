/* SPDX-License-Identifier: MIT */
/* inlay-bake dome: the lights of a dome. */
#include <errno.h>
#include <getopt.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "bake/base/angles.h"
#include "bake/base/commands.h"
#include "bake/scene/lights_options.h"
#include "hal/base/json.h"
#include "hal/base/log.h"
#include "hal/optics/dome.h"

enum { ANGLES = 1, JSON };

static const struct option options[] = {
	LIGHTS_OPTIONS,
	{"angles", no_argument, NULL, ANGLES},
	{"json", no_argument, NULL, JSON},
	OPTIONS_OF_ALL,
	{NULL, 0, NULL, 0},
};

static void print_table(const struct dome *dome)
{
	printf("# %d lights: frequency %d\n", dome->count, dome->frequency);
	printf("# light theta_rad phi_rad solid_angle_sr\n");
	for (int i = 0; i < dome->count; i++) {
		double theta, phi;

		dome_angles(dome, i, &theta, &phi);
		printf("%d %.9f %.9f %.12g\n", i, theta, phi, dome->solid_angle_sr[i]);
	}
}

static void print_json(const struct dome *dome)
{
	struct json json;

	json_begin(&json, stdout);
	json_number(&json, "frequency", dome->frequency);
	json_number(&json, "count", dome->count);
	json_array(&json, "lights");
	for (int i = 0; i < dome->count; i++) {
		double theta, phi;

		dome_angles(dome, i, &theta, &phi);
		json_object_line(&json, NULL);
		json_number(&json, "theta_rad", theta);
		json_number(&json, "phi_rad", phi);
		json_numbers(&json, "direction", dome->direction[i], 3);
		json_number(&json, "solid_angle_sr", dome->solid_angle_sr[i]);
		json_number(&json, "projected_sr", dome->projected_sr[i]);
		json_end(&json);
	}
	json_end(&json);
	json_end(&json);
}

struct dome_choices {
	struct scene_lights lights;
	int form; /* ANGLES, JSON; 0: a summary */
};

static int dome_command_take(void *choices, int option, struct fault *fault)
{
	struct dome_choices *c = choices;

	switch (option) {
	case LIGHTS_FREQUENCY:
	case LIGHTS_FINE:
		return lights_option_take(&c->lights, option, optarg, fault);
	default:
		if (c->form && c->form != option)
			return fault_say(fault, -EINVAL, "expected one of --angles and --json");
		c->form = option;
		return 0;
	}
}

static int create_dome(const struct scene_lights *lights, struct dome *dome, struct fault *fault)
{
	struct fine_list fine = {.count = 0};
	int err = 0;

	if (lights->fine && *lights->fine)
		err = fine_list_read(&fine, "--fine", lights->fine, NULL, fault);
	if (!err)
		err = fine_list_dome(&fine, lights->frequency, dome, fault);
	fine_list_free(&fine);
	return err;
}

static int dome_command_run(const struct bake_command *command, int argc, char **argv)
{
	struct dome_choices c = {.lights = {.frequency = 0}};
	struct fault fault = {.text = ""};
	struct dome dome;
	const int status = command_options(command, argc, argv, options, dome_command_take, &c);

	if (status != COMMAND_GOES_ON)
		return status;
	if (!c.lights.frequency)
		return command_wrong(command, "--frequency is missing");
	if (optind < argc)
		return command_wrong(command, "\"%s\" is one argument too many", argv[optind]);
	if (create_dome(&c.lights, &dome, &fault) < 0) {
		log_error("%s", fault.text);
		return EXIT_FAILURE;
	}
	if (c.form == ANGLES)
		angles_write(stdout, &dome);
	else if (c.form == JSON)
		print_json(&dome);
	else
		print_table(&dome);
	dome_free(&dome);
	return EXIT_SUCCESS;
}

const struct bake_command dome_command = {
	.name = "dome",
	.usage = "--frequency F [--fine PARTS] [--angles | --json]",
	.summary = "print the lights of a dome",
	.help = "\n  --frequency F   1 to 72; 9 makes 406 lights\n"
		"  --fine PARTS    where lights are finer: \"azimuth height radius frequency\" in degrees,\n"
		"                  separated by commas, or a file of such lines (inlay-scene(5))\n"
		"  --angles        one light a line: theta phi, radians\n"
		"  --json          everything: angles, directions, solid angles\n",
	.run = dome_command_run,
};
