/* SPDX-License-Identifier: MIT */
/* inlay-bake export: a basis in the thesis's own format, or a scene as a job for another renderer.
 */
#include <errno.h>
#include <getopt.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bake/base/commands.h"
#include "bake/exchange/export_blender.h"
#include "bake/exchange/export_radiance.h"
#include "bake/exchange/msi.h"
#include "bake/scene/lights_options.h"
#include "hal/base/log.h"
#include "hal/base/output.h"

enum { MSI = 1, RADIANCE, BLENDER, ENDIAN, LONG, SIZE, POSE, RAYS, SUNS, THREADS };

static const char *const endian_names[] = {"little", "big", NULL};

static const struct option options[] = {
	{"msi", required_argument, NULL, MSI},
	{"radiance", required_argument, NULL, RADIANCE},
	{"blender", required_argument, NULL, BLENDER},
	{"endian", required_argument, NULL, ENDIAN},
	{"long", required_argument, NULL, LONG},
	LIGHTS_OPTIONS,
	{"size", required_argument, NULL, SIZE},
	{"pose", required_argument, NULL, POSE},
	{"rays", required_argument, NULL, RAYS},
	{"suns", required_argument, NULL, SUNS},
	{"threads", required_argument, NULL, THREADS},
	OPTIONS_OF_ALL,
	{NULL, 0, NULL, 0},
};

struct export_choices {
	int what; /* MSI, RADIANCE or BLENDER; 0: not given */
	const char *to;
	bool of_msi, of_scene, of_radiance; /* options of that target alone were given */
	int endian, long_bytes, threads;
	struct scene_lights lights;
	const char *pose; /* NULL: the first */
	int width, height;
	struct export_radiance_settings radiance;
};

static int take_target(struct export_choices *c, int option, struct fault *fault)
{
	if (c->what)
		return fault_say(fault, -EINVAL, "expected one of --msi, --radiance and --blender");
	c->what = option;
	c->to = optarg;
	return 0;
}

static int take_msi(struct export_choices *c, int option, struct fault *fault)
{
	c->of_msi = true;
	switch (option) {
	case ENDIAN:
		return option_choice("--endian", optarg, endian_names, &c->endian, fault);
	case LONG:
		if (strcmp(optarg, "4") != 0 && strcmp(optarg, "8") != 0)
			return fault_say(fault, -EINVAL, "--long: \"%s\", expected 4 or 8", optarg);
		c->long_bytes = atoi(optarg);
		return 0;
	default:
		return option_int("--threads", optarg, 1, 1024, &c->threads, fault);
	}
}

static int take_scene(struct export_choices *c, int option, struct fault *fault)
{
	c->of_scene = true;
	switch (option) {
	case SIZE:
		return option_size("--size", optarg, &c->width, &c->height, fault);
	case POSE:
		c->pose = optarg;
		return 0;
	default:
		return lights_option_take(&c->lights, option, optarg, fault);
	}
}

static int export_command_take(void *choices, int option, struct fault *fault)
{
	struct export_choices *c = choices;

	switch (option) {
	case MSI:
	case RADIANCE:
	case BLENDER:
		return take_target(c, option, fault);
	case RAYS:
		c->of_radiance = true;
		return option_int("--rays", optarg, 1, EXPORT_RAYS_MAX, &c->radiance.rays, fault);
	case SUNS:
		c->of_radiance = true;
		return option_int("--suns", optarg, 1, EXPORT_SUNS_MAX, &c->radiance.suns, fault);
	case LIGHTS_FREQUENCY:
	case LIGHTS_FINE:
	case SIZE:
	case POSE:
		return take_scene(c, option, fault);
	default:
		return take_msi(c, option, fault);
	}
}

static int export_msi(const char *path, const struct export_choices *c, struct fault *fault)
{
	const struct msi_variant variant = {c->endian == 1, c->long_bytes};
	const struct basis_layer *layer;
	struct thesis *thesis = NULL;
	struct pool *pool = NULL;
	struct basis basis;
	int err = output_check(&c->to, 1, &path, 1, fault);

	if (!err)
		err = basis_open(&basis, path, BASIS_ALL, fault);
	if (err)
		return err;
	layer = basis.poses[0].exact.tiles ? &basis.poses[0].exact : &basis.poses[0].shown;
	err = pool_create(&pool, c->threads);
	if (err)
		fault_say(fault, err, "cannot start threads: %s", strerror(-err));
	else
		err = thesis_create(&thesis, &basis, layer, pool, fault);
	if (!err)
		err = msi_write(c->to, thesis, (int)basis.info.width, (int)basis.info.height,
				(int)basis.info.lights, &variant, fault);
	if (!err)
		printf("rate = %.9g\n", thesis_rate(thesis));
	thesis_destroy(thesis);
	pool_destroy(pool);
	basis_close(&basis);
	return err;
}

static int export_scene(const char *path, const struct export_choices *c, struct fault *fault)
{
	struct scene *scene;
	struct dome dome;
	int err = scene_open(&scene, path, c->width, c->height, fault);

	if (err)
		return err;
	err = scene_find_pose(scene, c->pose, fault);
	if (!err)
		err = scene_dome(scene, &c->lights, &dome, fault);
	if (!err) {
		err = c->what == BLENDER
			      ? export_blender(scene, &dome, c->to, fault)
			      : export_radiance(scene, &dome, c->to, &c->radiance, fault);
		dome_free(&dome);
	}
	scene_close(scene);
	return err;
}

/* What is missing or contradictory in the options, or NULL. */
static const char *wrong_usage(const struct export_choices *c)
{
	if (!c->what)
		return "expected --msi OUT.msi, --radiance DIR or --blender DIR";
	if (c->of_msi && c->what != MSI)
		return "--endian, --long and --threads are of --msi";
	if (c->of_scene && c->what == MSI)
		return "--frequency, --size and --pose are of a scene, not of --msi";
	if (c->of_radiance && c->what != RADIANCE)
		return "--rays and --suns are of --radiance";
	return NULL;
}

static int export_command_run(const struct bake_command *command, int argc, char **argv)
{
	struct export_choices c = {
		.long_bytes = 8, .lights = {.frequency = -1}, .radiance = EXPORT_RADIANCE_DEFAULTS};
	struct fault fault = {.text = ""};
	const int status = command_options(command, argc, argv, options, export_command_take, &c);

	if (status != COMMAND_GOES_ON)
		return status;
	if (wrong_usage(&c))
		return command_wrong(command, "%s", wrong_usage(&c));
	if (optind + 1 != argc)
		return command_wrong(command, c.what == MSI ? "expected one basis file"
							    : "expected one scene file");
	if (c.what == MSI ? export_msi(argv[optind], &c, &fault)
			  : export_scene(argv[optind], &c, &fault)) {
		log_error("%s", fault.text);
		return EXIT_FAILURE;
	}
	return EXIT_SUCCESS;
}

const struct bake_command export_command = {
	.name = "export",
	.usage = "BASIS.inlay --msi OUT.msi [--endian little|big] [--long 4|8] [--threads T]\n"
		 "           SCENE --radiance DIR [--rays K] [--suns S] [--frequency F]\n"
		 "           [--size WxH] [--pose P]\n"
		 "           SCENE --blender DIR [--frequency F] [--size WxH] [--pose P]",
	.summary = "write a basis as the thesis's program reads it, or a job for a renderer",
	.help = "\n"
		"  --msi FILE      a byte for each light and channel of each pixel of object or shadow\n"
		"  --endian E      of the machine that will read it: little or big\n"
		"  --long N        bytes of its long: 4 or 8\n"
		"  --threads T     default: one for each processor\n\n"
		"Prints the light rate that belongs to it. The angles are those of inlay-bake dome\n"
		"--angles. Of the exact layer, where the file has one.\n\n"
		"  --radiance DIR  a folder in which \"make -j4\" renders all pictures of import\n"
		"  --rays K        K x K rays a pixel; 4\n"
		"  --suns S        a cell is made of so many small suns; 64\n"
		"  --blender DIR   a folder for \"blender -b -P DIR/render.py -- --samples 256\"\n"
		"  --frequency F   of the dome; default: as the scene says\n"
		"  --fine PARTS    where lights are finer: a file or a list (inlay-scene(5))\n"
		"  --size WxH      of the pictures\n"
		"  --pose P        of the scene: number, from 0, or name; 0\n\n"
		"Both jobs keep pictures that are there, and say at last how inlay-bake import takes them.\n",
	.run = export_command_run,
};
