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
	bool angles, json; /* else a table */
};

#define AT(field) .place = offsetof(struct dome_choices, field)

static const struct option_row options[] = {
	LIGHTS_ROWS,
	{"angles", OPTION_FLAG, AT(angles)},
	{"json", OPTION_FLAG, AT(json)},
	{.name = NULL},
};

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

static int dome_command_run(const struct command *command, int argc, char **argv)
{
	struct dome_choices c = {.lights = {.frequency = 0}};
	struct fault fault = {.text = ""};
	struct dome dome;
	const int status = command_read(command, argc, argv, options, &c);

	if (status != COMMAND_GOES_ON)
		return status;
	if (!c.lights.frequency)
		return command_wrong(command, "--frequency is missing");
	if (c.angles && c.json)
		return command_wrong(command, "expected one of --angles and --json");
	if (optind < argc)
		return command_wrong(command, "\"%s\" is one argument too many", argv[optind]);
	if (create_dome(&c.lights, &dome, &fault) < 0) {
		log_error("%s", fault.text);
		return EXIT_FAILURE;
	}
	if (c.angles)
		angles_write(stdout, &dome);
	else if (c.json)
		print_json(&dome);
	else
		print_table(&dome);
	dome_free(&dome);
	return EXIT_SUCCESS;
}

const struct command dome_command = {
	.name = "dome",
	.usage = "--frequency F [options]",
	.summary = "print the lights of a dome",
	.help = "\n" LIGHTS_HELP "  --angles        one light a line: theta phi, radians\n"
		"  --json          everything: angles, directions, solid angles\n",
	.run = dome_command_run,
};
