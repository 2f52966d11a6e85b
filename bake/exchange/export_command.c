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

struct export_choices {
	const char *msi, *radiance, *blender; /* where to; one is given */
	bool of_scene;			      /* options of a scene were given */
	int threads;			      /* of --msi; 0: not given */
	struct scene_lights lights;
	const char *pose; /* NULL: the first */
	int width, height;
};

#define AT(field) .place = offsetof(struct export_choices, field)
#define OF_SCENE .given = offsetof(struct export_choices, of_scene)

static const struct option_row options[] = {
	{"msi", OPTION_TEXT, AT(msi)},
	{"radiance", OPTION_TEXT, AT(radiance)},
	{"blender", OPTION_TEXT, AT(blender)},
	LIGHTS_ROWS,
	{"size", OPTION_SIZE, AT(width), OF_SCENE},
	{"pose", OPTION_TEXT, AT(pose), OF_SCENE},
	{"threads", OPTION_INT, AT(threads), .min = 1, .max = 1024},
	{.name = NULL},
};

static int export_msi(const char *path, const struct export_choices *c, struct fault *fault)
{
	const struct basis_layer *layer;
	struct thesis *thesis = NULL;
	struct pool *pool = NULL;
	struct basis basis;
	int err = output_check(&c->msi, 1, &path, 1, fault);

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
		err = msi_write(c->msi, thesis, (int)basis.info.width, (int)basis.info.height,
				(int)basis.info.lights, fault);
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
		err = c->blender ? export_blender(scene, &dome, c->blender, fault)
				 : export_radiance(scene, &dome, c->radiance, fault);
		dome_free(&dome);
	}
	scene_close(scene);
	return err;
}

/* What is missing or contradictory in the options, or NULL. */
static const char *wrong_usage(const struct export_choices *c)
{
	if (!c->msi && !c->radiance && !c->blender)
		return "expected --msi OUT.msi, --radiance DIR or --blender DIR";
	if (!!c->msi + !!c->radiance + !!c->blender > 1)
		return "expected one of --msi, --radiance and --blender";
	if (c->threads && !c->msi)
		return "--threads is of --msi";
	if (c->msi && (c->of_scene || c->lights.frequency >= 0 || c->lights.fine))
		return "--frequency, --fine, --size and --pose are of a scene, not of --msi";
	return NULL;
}

static int export_command_run(const struct command *command, int argc, char **argv)
{
	struct export_choices c = {.lights = {.frequency = -1}};
	struct fault fault = {.text = ""};
	const int status = command_read(command, argc, argv, options, &c);

	if (status != COMMAND_GOES_ON)
		return status;
	if (wrong_usage(&c))
		return command_wrong(command, "%s", wrong_usage(&c));
	if (optind + 1 != argc)
		return command_wrong(command,
				     c.msi ? "expected one basis file" : "expected one scene file");
	if (c.msi ? export_msi(argv[optind], &c, &fault) : export_scene(argv[optind], &c, &fault)) {
		log_error("%s", fault.text);
		return EXIT_FAILURE;
	}
	return EXIT_SUCCESS;
}

const struct command export_command = {
	.name = "export",
	.usage = "BASIS.inlay --msi OUT.msi | SCENE --radiance DIR | SCENE --blender DIR [options]",
	.summary = "write a basis as the thesis's program reads it, or a job for a renderer",
	.help = "\n"
		"  --msi FILE      a byte for each light and channel of each pixel of object or shadow\n"
		"  --threads T     default: one for each processor\n\n"
		"Prints the light rate that belongs to it. The angles are those of inlay-bake dome\n"
		"--angles. Of the exact layer, where the file has one.\n\n"
		"  --radiance DIR  a folder in which \"make -j4\" renders all pictures of import\n"
		"  --blender DIR   a folder for \"blender -b -P DIR/render.py -- --samples 256\"\n" LIGHTS_HELP
		"  --size WxH      of the pictures\n"
		"  --pose P        of the scene: number, from 0, or name; 0\n\n"
		"Both jobs keep pictures that are there, and say at last how inlay-bake import takes them.\n",
	.run = export_command_run,
};
