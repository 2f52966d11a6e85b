/* SPDX-License-Identifier: MIT */
/* inlay-bake truth: the finished composite under a panorama, path traced. */
#include <errno.h>
#include <getopt.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bake/base/commands.h"
#include "bake/scene/survey.h"
#include "bake/truth/photograph.h"
#include "bake/truth/truth_options.h"
#include "bake/truth/truth_views.h"
#include "hal/base/log.h"
#include "hal/base/output.h"

#define FISHEYE_SIDE 1024
#define SAMPLES 256

struct truth_choices {
	const char *pose;
	const char *output, *panorama, *background, *background_out, *fisheye_out;
	double turn_deg, exposure;
	int width, height, fisheye_side;
	struct truth_settings truth;
};

#define AT(field) .place = offsetof(struct truth_choices, field)

static const struct option_row options[] = {
	{"output", OPTION_TEXT, AT(output)},
	{"panorama", OPTION_TEXT, AT(panorama)},
	{"turn", OPTION_REAL, AT(turn_deg), .min = -360, .max = 360},
	{"exposure", OPTION_REAL, AT(exposure), .min = 1e-9, .max = 1e9},
	{"background", OPTION_TEXT, AT(background)},
	{"size", OPTION_SIZE, AT(width)},
	{"background-out", OPTION_TEXT, AT(background_out)},
	{"fisheye-out", OPTION_TEXT, AT(fisheye_out)},
	{"fisheye-size", OPTION_INT, AT(fisheye_side), .min = 8, .max = 8192},
	{"pose", OPTION_TEXT, AT(pose)},
	TRUTH_ROWS,
	{.name = NULL},
};

/* ---- pictures ---- */

static const struct transfer_curve srgb = {.named = TRANSFER_SRGB};

/* The panorama as the camera delivers it: through its lens, in 8-bit code values. */
static int photograph_panorama(const struct scene *scene, const struct panorama *panorama,
			       struct image *coded)
{
	struct image linear;
	int err = truth_background(scene, panorama, &linear);

	if (err)
		return err;
	err = photograph_encode(&linear, &srgb, coded);
	image_free(&linear);
	return err;
}

static int get_background(const struct truth_choices *c, const struct scene *scene,
			  const struct panorama *panorama, struct image *linear,
			  struct fault *fault)
{
	struct image picture = {.width = 0};
	int err;

	if (c->background) {
		err = photograph_read(c->background, scene, &picture, fault);
		if (err)
			return err;
	} else {
		err = photograph_panorama(scene, panorama, &picture);
		if (err)
			return fault_say(fault, err, "%s: %s", c->output, strerror(-err));
	}
	if (c->background_out && picture.u8)
		err = image_write(c->background_out, &picture, fault);
	else if (c->background_out)
		err = photograph_write(c->background_out, &picture, &srgb, fault);
	if (err)
		goto free_picture;
	if (picture.f32) {
		*linear = picture;
		return 0;
	}
	err = photograph_decode(&picture, &srgb, linear);
	if (err)
		fault_say(fault, err, "%s: %s", c->output, strerror(-err));
free_picture:
	image_free(&picture);
	return err;
}

static int write_fisheye(const struct truth_choices *c, const struct panorama *panorama,
			 struct fault *fault)
{
	struct image picture = {.width = 0};
	int err = truth_fisheye(panorama, c->fisheye_side, &picture);

	if (err)
		return fault_say(fault, err, "%s: %s", c->fisheye_out, strerror(-err));
	err = photograph_write(c->fisheye_out, &picture, &srgb, fault);
	image_free(&picture);
	return err;
}

/* ---- the command ---- */

static int trace_composite(const struct truth_choices *c, const struct scene *scene,
			   const struct panorama *panorama, struct fault *fault)
{
	struct image background = {.width = 0}, out = {.width = 0};
	struct truth_report report = {.rays = 0};
	struct sky sky = {.width = 0};
	/* comes first because it checks the panorama: nothing is written before that */
	int err = sky_create(&sky, panorama, c->panorama, fault);

	if (!err)
		err = get_background(c, scene, panorama, &background, fault);
	if (!err && c->fisheye_out)
		err = write_fisheye(c, panorama, fault);
	if (!err)
		err = truth_run(scene, &sky, &background, &c->truth, &out, &report, fault);
	if (!err)
		err = photograph_write(c->output, &out, &srgb, fault);
	if (!err && !c->truth.quiet)
		printf("%s: rays %llu (%.2f million/s), time %.1f s, noise %.2f levels\n",
		       c->output, (unsigned long long)report.rays,
		       (double)report.rays / report.seconds * 1e-6, report.seconds,
		       report.noise_levels);
	sky_free(&sky);
	image_free(&out);
	image_free(&background);
	return err;
}

/* Checks the names of outputs before minutes are spent on rendering. */
static int check_names(const char *path, const struct truth_choices *c, struct fault *fault)
{
	const char *const names[] = {c->output, c->background_out, c->fisheye_out};
	const char *const read[] = {path, c->panorama, c->background};

	for (int i = 0; i < 3; i++) {
		const int kind = names[i] ? image_name_linear(names[i], fault) : 0;

		if (kind < 0)
			return kind;
	}
	return output_check(names, 3, read, 3, fault);
}

static int run_truth(const char *path, struct truth_choices *c, struct fault *fault)
{
	struct image picture = {.width = 0};
	struct panorama panorama = {.image = &picture};
	struct scene *scene;
	int err = check_names(path, c, fault);

	if (!err)
		err = scene_open(&scene, path, c->width, c->height, fault);
	if (err)
		return err;
	c->truth.bounces = scene->file->render.bounces;
	err = scene_find_pose(scene, c->pose, fault);
	if (!err)
		err = survey_say(scene, NULL, fault);
	if (!err)
		err = panorama_read(&picture, c->panorama, fault);
	panorama.turn_rad = c->turn_deg * (M_PI / 180);
	panorama.scale = c->exposure;
	if (!err)
		err = trace_composite(c, scene, &panorama, fault);
	image_free(&picture);
	scene_close(scene);
	return err;
}

static int truth_command_run(const struct command *command, int argc, char **argv)
{
	struct truth_choices c = {
		.exposure = 1,
		.fisheye_side = FISHEYE_SIDE,
		.truth = {.samples = SAMPLES, .seed = 1},
	};
	struct fault fault = {.text = ""};
	const int status = command_read(command, argc, argv, options, &c);
	int err;

	if (status != COMMAND_GOES_ON)
		return status;
	if (optind + 1 != argc)
		return command_wrong(command, "expected one scene file");
	if (!c.panorama)
		return command_wrong(command, "--panorama is missing");
	if (!c.output)
		return command_wrong(command, "-o OUT is missing");
	err = run_truth(argv[optind], &c, &fault);
	if (err)
		log_error("%s", fault.text);
	return !err ? EXIT_SUCCESS : err == -ENODATA ? EXIT_MISSED : EXIT_FAILURE;
}

const struct command truth_command = {
	.name = "truth",
	.usage = "SCENE --panorama P.hdr -o OUT.png|.pfm [options]",
	.summary = "path trace the finished composite under a panorama",
	.help = "\n  --panorama P        equirectangular, linear light; its upper half shines\n"
		"  -o FILE             .png: 8-bit sRGB; .pfm, .hdr: linear light\n"
		"  --turn DEG          turn the panorama about the vertical, counter-clockwise\n"
		"  --exposure E        radiance of 1 in the panorama; 1\n"
		"  --background IMG    the real picture; default: the panorama through the camera,\n"
		"                      in 8-bit code values\n  --samples S         a pixel; 256\n"
		"  --size WxH          of the picture\n"
		"  --background-out F  write the background that was used\n"
		"  --fisheye-out F     what a perfect fisheye camera at the origin sees\n"
		"  --fisheye-size N    its side in pixels; 1024\n"
		"  --pose P            of the scene: number, from 0, or name\n"
		"  --seed K            of all random numbers\n"
		"  --threads T         default: one for each processor\n"
		"  --quiet             print nothing but errors\n\n"
		"Exit code 3: the camera sees no object, and there is no picture.\n",
	.run = truth_command_run,
};
