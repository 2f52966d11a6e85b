/* SPDX-License-Identifier: MIT */
/* inlay-bake pictures: one picture for each light, path traced, as any renderer would deliver
 * them. */
#include <errno.h>
#include <getopt.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bake/base/commands.h"
#include "bake/base/progress.h"
#include "bake/exchange/pictures.h"
#include "bake/scene/lights_options.h"
#include "bake/truth/truth.h"
#include "hal/base/log.h"
#include "hal/base/output.h"

struct pictures_choices {
	const char *object, *ground, *alone, *coverage, *pose;
	struct scene_lights lights;
	int width, height;
	struct truth_settings truth;
};

#define AT(field) .place = offsetof(struct pictures_choices, field)

static const struct option_row options[] = {
	{"object", OPTION_OTHER, AT(object), .take = picture_pattern_take},
	{"ground", OPTION_OTHER, AT(ground), .take = picture_pattern_take},
	{"alone", OPTION_OTHER, AT(alone), .take = picture_pattern_take},
	{"coverage", OPTION_TEXT, AT(coverage)},
	LIGHTS_ROWS,
	TRUTH_ROWS,
	{"size", OPTION_SIZE, AT(width)},
	{"pose", OPTION_TEXT, AT(pose)},
	{.name = NULL},
};

static int write_numbered(const char *pattern, int number, const struct image *picture,
			  struct fault *fault)
{
	char name[PATH_MAX];
	const int err = picture_name(pattern, number, name, sizeof(name));

	return err ? fault_say(fault, err, "%s: the name is too long", pattern)
		   : image_write(name, picture, fault);
}

static int write_light_pictures(const struct pictures_choices *c, int light,
				const struct truth_pictures *pictures, struct fault *fault)
{
	int err = write_numbered(c->object, light, &pictures->with, fault);

	if (!err)
		err = write_numbered(c->ground, light, &pictures->without, fault);
	if (!err && c->alone)
		err = write_numbered(c->alone, light, &pictures->alone, fault);
	if (!err && !light)
		err = image_write(c->coverage, &pictures->coverage, fault);
	return err;
}

static int render_lights(const struct pictures_choices *c, const struct scene *scene,
			 const struct dome *dome, struct fault *fault)
{
	struct truth_settings settings = c->truth;
	struct progress progress;
	int err = 0;

	settings.bounces = scene->file->render.bounces;
	settings.quiet = true;
	progress_begin(&progress, "lights", dome->count, c->truth.quiet);
	for (int i = 0; !err && i < dome->count; i++) {
		struct truth_pictures pictures;
		struct sky sky;

		sky_of_light(&sky, dome, i);
		err = truth_pictures(scene, &sky, &settings, &pictures, fault);
		if (!err)
			err = write_light_pictures(c, i, &pictures, fault);
		truth_pictures_free(&pictures);
		progress_show(&progress, i + 1, 0);
	}
	progress_end(&progress);
	return err;
}

/* Checks all names before the first of many pictures is rendered. */
static int check_names(const char *path, const struct pictures_choices *c, struct fault *fault)
{
	const char *const names[] = {c->object, c->ground, c->alone, c->coverage};
	char first[3][PATH_MAX];
	const char *outputs[4] = {NULL, NULL, NULL, c->coverage};

	for (int i = 0; i < 4; i++) {
		const int kind = names[i] ? image_name_linear(names[i], fault) : 1;

		if (kind < 0)
			return kind;
		if (!kind)
			return fault_say(
				fault, -ENOTSUP,
				"%s: would round what lights do alone, expected an ending of .pfm or .hdr",
				names[i]);
	}
	for (int i = 0; i < 3; i++) {
		if (names[i] && picture_name(names[i], 0, first[i], sizeof(first[i])))
			return fault_say(fault, -ENAMETOOLONG, "%s: the name is too long",
					 names[i]);
		outputs[i] = names[i] ? first[i] : NULL;
	}
	return output_check(outputs, 4, &path, 1, fault);
}

static int run_pictures(const char *path, const struct pictures_choices *c, struct fault *fault)
{
	struct scene *scene;
	struct dome dome;
	int err = check_names(path, c, fault);

	if (!err)
		err = scene_open(&scene, path, c->width, c->height, fault);
	if (err)
		return err;
	err = scene_find_pose(scene, c->pose, fault);
	if (!err)
		err = scene_dome(scene, &c->lights, &dome, fault);
	if (!err) {
		err = render_lights(c, scene, &dome, fault);
		dome_free(&dome);
	}
	scene_close(scene);
	return err;
}

static int pictures_command_run(const struct command *command, int argc, char **argv)
{
	struct pictures_choices c = {.lights = {.frequency = -1},
				     .truth = {.samples = 64, .seed = 1}};
	struct fault fault = {.text = ""};
	const int status = command_read(command, argc, argv, options, &c);

	if (status != COMMAND_GOES_ON)
		return status;
	if (optind + 1 != argc)
		return command_wrong(command, "expected one scene file");
	if (!c.object || !c.ground || !c.coverage)
		return command_wrong(command, "--object, --ground and --coverage are all needed");
	if (run_pictures(argv[optind], &c, &fault) < 0) {
		log_error("%s", fault.text);
		return EXIT_FAILURE;
	}
	return EXIT_SUCCESS;
}

const struct command pictures_command = {
	.name = "pictures",
	.usage = "SCENE --object 'o%03d.pfm' --ground 'g%03d.pfm' --coverage C.pfm [options]",
	.summary = "path trace the scene under each light alone, for import",
	.help = "\n  --object PATTERN    objects and ground, one picture a light, from 0\n"
		"  --ground PATTERN    ground alone\n"
		"  --alone PATTERN     what is seen of the objects, over black\n"
		"  --coverage FILE     the objects' share of each pixel\n"
		"  --frequency F       of the dome; default: as the scene says\n"
		"  --fine PARTS        where lights are finer: a file or a list (inlay-scene(5))\n"
		"  --samples S         a pixel; 64\n  --size WxH          of the pictures\n"
		"  --pose P            of the scene: number, from 0, or name; 0\n"
		"  --seed K            of all random numbers\n"
		"  --threads T         default: one for each processor\n"
		"  --quiet             print nothing but errors\n\n"
		"Linear light (.pfm, .hdr) of lights of radiance 1. Shares nothing with render but meshes,\n"
		"materials and camera: what inlay-bake import makes of the pictures is held against it.\n",
	.run = pictures_command_run,
};
