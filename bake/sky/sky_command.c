/* SPDX-License-Identifier: MIT */
/* inlay-bake sky: the parts of a dome that should be finer under a panorama. */
#include <getopt.h>
#include <math.h>
#include <stdlib.h>

#include "bake/base/commands.h"
#include "bake/sky/fine_list.h"
#include "bake/sky/sky_parts.h"
#include "hal/base/log.h"
#include "hal/base/output.h"

enum { FREQUENCY = 1, TURN, MOST };

static const struct option options[] = {
	{"output", required_argument, NULL, 'o'},
	{"frequency", required_argument, NULL, FREQUENCY},
	{"turn", required_argument, NULL, TURN},
	{"most", required_argument, NULL, MOST},
	OPTIONS_OF_ALL,
	{NULL, 0, NULL, 0},
};

struct sky_choices {
	const char *output;
	int frequency, most;
	double turn_deg;
};

static int sky_command_take(void *choices, int option, struct fault *fault)
{
	struct sky_choices *c = choices;

	switch (option) {
	case FREQUENCY:
		return option_int("--frequency", optarg, 1, DOME_FREQUENCY_MAX / 2, &c->frequency,
				  fault);
	case TURN:
		return option_real("--turn", optarg, -360, 360, &c->turn_deg, fault);
	case MOST:
		return option_int("--most", optarg, 1, DOME_LIGHTS_MAX, &c->most, fault);
	default:
		c->output = optarg;
		return 0;
	}
}

static int write_parts(const struct sky_choices *c, const char *path, const struct sky_parts *parts,
		       struct fault *fault)
{
	struct output out;
	const int err = output_open(&out, c->output, fault);

	if (err)
		return err;
	fprintf(out.stream, "# %s", path);
	if (c->turn_deg != 0)
		fprintf(out.stream, ", turned by %g degrees", c->turn_deg);
	fprintf(out.stream, ": %d lights, with frequency %d elsewhere\n", parts->lights,
		c->frequency);
	for (int k = 0; k < parts->count; k++)
		fine_list_write(out.stream, &parts->part[k]);
	return output_commit(&out, fault);
}

static int run_sky(const struct sky_choices *c, const char *path, struct fault *fault)
{
	struct image picture = {.width = 0};
	struct panorama panorama = {
		.image = &picture, .turn_rad = c->turn_deg * (M_PI / 180), .scale = 1};
	struct sky_parts parts = {.count = 0};
	int err = output_check(&c->output, 1, &path, 1, fault);

	if (!err)
		err = panorama_read(&picture, path, fault);
	if (!err)
		err = sky_parts_choose(&parts, &panorama, c->frequency, c->most, fault);
	if (!err)
		err = write_parts(c, path, &parts, fault);
	if (!err && parts.limited)
		log_info("%s: would be finer with more than %d lights", c->output, c->most);
	else if (!err && !parts.count)
		log_info("%s: no light is strong and small: a whole dome does", c->output);
	sky_parts_free(&parts);
	image_free(&picture);
	return err;
}

static int sky_command_run(const struct bake_command *command, int argc, char **argv)
{
	struct sky_choices c = {.frequency = 9, .most = 1000};
	struct fault fault = {.text = ""};
	const int status = command_options(command, argc, argv, options, sky_command_take, &c);

	if (status != COMMAND_GOES_ON)
		return status;
	if (optind + 1 != argc)
		return command_wrong(command, "expected one panorama");
	if (!c.output)
		return command_wrong(command, "-o FINE is missing");
	if (run_sky(&c, argv[optind], &fault) < 0) {
		log_error("%s", fault.text);
		return EXIT_FAILURE;
	}
	return EXIT_SUCCESS;
}

const struct bake_command sky_command = {
	.name = "sky",
	.usage = "PANORAMA [--frequency F] [--turn DEG] [--most N] -o FINE",
	.summary = "choose where lights should be finer under a panorama",
	.help = "\n"
		"  -o FINE         the list of parts, for \"fine\" in [dome] and for --fine\n"
		"  --frequency F   of the dome elsewhere, 1 to 36; 9\n"
		"  --turn DEG      turn the panorama about the vertical, counter-clockwise\n"
		"  --most N        lights in all; 1000\n",
	.run = sky_command_run,
};
