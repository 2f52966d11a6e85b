/* SPDX-License-Identifier: MIT */
/* inlay-bake truth: the finished composite under a panorama and lamps, path traced. */
#include <errno.h>
#include <getopt.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bake/base/commands.h"
#include "bake/scene/survey.h"
#include "bake/sky/sky_eye.h"
#include "bake/truth/photograph.h"
#include "bake/truth/truth.h"
#include "bake/truth/truth_views.h"
#include "hal/base/log.h"
#include "hal/base/output.h"

#define FISHEYE_SIDE 1024
#define TRUTH_LAMPS_MAX 64
#define WORLD_MAX 1e6 /* world units, and radiance: floats keep a metre's tenth of so many */
#define SAMPLES 256

struct lamp_list {
	struct truth_lamp lamp[TRUTH_LAMPS_MAX];
	int count;
};

struct truth_choices {
	const char *pose;
	const char *output, *panorama, *background, *background_out, *fisheye_out, *fisheye_lens;
	double turn_deg, exposure, place[3];
	struct lamp_list lamps;
	bool fisheye_placed;
	struct truth_eye eye;
	int width, height;
	struct truth_settings truth;
};

#define AT(field) .place = offsetof(struct truth_choices, field)

static int read_lamp(void *field, const char *option, const char *text, struct fault *fault)
{
	struct lamp_list *list = field;
	double v[7];
	const int err = option_reals(option, text, 7, 7, -WORLD_MAX, WORLD_MAX, v, fault);

	if (err < 0)
		return err;
	if (list->count == TRUTH_LAMPS_MAX)
		return fault_say(fault, -EINVAL, "%s: at most %d", option, TRUTH_LAMPS_MAX);
	if (v[3] <= 0 || fmin(fmin(v[4], v[5]), v[6]) < 0)
		return fault_say(fault, -EINVAL,
				 "%s: \"%s\", expected a radius above 0 and no negative radiance",
				 option, text);
	list->lamp[list->count++] = (struct truth_lamp){
		.centre = v3_make((float)v[0], (float)v[1], (float)v[2]),
		.radius = (float)v[3],
		.radiance = rgb_make((float)v[4], (float)v[5], (float)v[6]),
	};
	return 0;
}

static int read_place(void *field, const char *option, const char *text, struct fault *fault)
{
	const int read = option_reals(option, text, 3, 3, -WORLD_MAX, WORLD_MAX, field, fault);

	return read < 0 ? read : 0;
}

static const struct option_row options[] = {
	{"output", OPTION_TEXT, AT(output)},
	{"panorama", OPTION_TEXT, AT(panorama)},
	{"lamp", OPTION_OTHER, AT(lamps), .take = read_lamp},
	{"turn", OPTION_REAL, AT(turn_deg), .min = -360, .max = 360},
	{"exposure", OPTION_REAL, AT(exposure), .min = 1e-9, .max = 1e9},
	{"background", OPTION_TEXT, AT(background)},
	{"size", OPTION_SIZE, AT(width)},
	{"background-out", OPTION_TEXT, AT(background_out)},
	{"fisheye-out", OPTION_TEXT, AT(fisheye_out)},
	{"fisheye", OPTION_OTHER, AT(place), .take = read_place,
	 .given = offsetof(struct truth_choices, fisheye_placed)},
	{"fisheye-lens", OPTION_TEXT, AT(fisheye_lens)},
	{"fisheye-size", OPTION_INT, AT(eye.side), .min = 8, .max = 8192},
	{"pose", OPTION_TEXT, AT(pose)},
	TRUTH_ROWS,
	{.name = NULL},
};

/* ---- pictures ---- */

static const struct transfer_curve srgb = {.named = TRANSFER_SRGB};

/* The panorama, or under lamps the real scene, as the camera delivers it: through its lens, in
 * 8-bit code values. */
static int photograph_real(const struct truth_choices *c, const struct scene *scene,
			   const struct sky *sky, struct image *coded)
{
	struct image linear = {.width = 0};
	int err = sky->lamp_count ? truth_see(scene, sky, NULL, &c->truth, &linear)
				  : truth_background(scene, &sky->panorama, &linear);

	if (err)
		return err;
	err = photograph_encode(&linear, &srgb, coded);
	image_free(&linear);
	return err;
}

static int get_background(const struct truth_choices *c, const struct scene *scene,
			  const struct sky *sky, struct image *linear, struct fault *fault)
{
	struct image picture = {.width = 0};
	int err;

	if (c->background) {
		err = photograph_read(c->background, scene, &picture, fault);
		if (err)
			return err;
	} else {
		err = photograph_real(c, scene, sky, &picture);
		if (err)
			return fault_say(fault, err, "%s: %s", c->output, strerror(-err));
	}
	if (picture.f32) {
		*linear = picture;
	} else {
		err = photograph_decode(&picture, &srgb, linear);
		image_free(&picture);
	}
	if (err)
		return fault_say(fault, err, "%s: %s", c->output, strerror(-err));
	return c->background_out ? photograph_write(c->background_out, linear, &srgb, fault) : 0;
}

static int write_fisheye(const struct truth_choices *c, const struct scene *scene,
			 const struct sky *sky, struct fault *fault)
{
	struct image picture = {.width = 0};
	int err = sky->lamp_count ? truth_see(scene, sky, &c->eye, &c->truth, &picture)
				  : truth_fisheye(&sky->panorama, c->eye.side, &picture);

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
	int err = c->panorama ? sky_create(&sky, panorama, c->panorama, fault) : 0;

	sky.lamps = c->lamps.lamp;
	sky.lamp_count = c->lamps.count;
	if (!err)
		err = get_background(c, scene, &sky, &background, fault);
	if (!err && c->fisheye_out)
		err = write_fisheye(c, scene, &sky, fault);
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
	const char *const read[] = {path, c->panorama, c->background, c->fisheye_lens};

	for (int i = 0; i < 3; i++) {
		const int kind = names[i] ? image_name_linear(names[i], fault) : 0;

		if (kind < 0)
			return kind;
	}
	return output_check(names, 3, read, 4, fault);
}

static int prepare_eye(struct truth_choices *c, struct fault *fault)
{
	struct fisheye_settings settings = {.field_deg = 90};
	const int err = c->fisheye_lens ? sky_eye_lens(&settings, c->fisheye_lens, fault) : 0;

	c->eye.place = v3_make((float)c->place[0], (float)c->place[1], (float)c->place[2]);
	return err ? err
		   : fisheye_prepare(&c->eye.lens, &settings, c->eye.side, c->eye.side, fault);
}

static int run_truth(const char *path, struct truth_choices *c, struct fault *fault)
{
	struct image picture = {.width = 0};
	struct panorama panorama = {.image = &picture};
	struct scene *scene;
	int err = check_names(path, c, fault);

	if (!err)
		err = prepare_eye(c, fault);
	if (!err)
		err = scene_open(&scene, path, c->width, c->height, fault);
	if (err)
		return err;
	c->truth.bounces = scene->file->render.bounces;
	err = scene_find_pose(scene, c->pose, fault);
	if (!err)
		err = survey_say(scene, NULL, fault);
	if (!err && c->panorama)
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
		.eye.side = FISHEYE_SIDE,
		.truth = {.samples = SAMPLES, .seed = 1},
	};
	struct fault fault = {.text = ""};
	const int status = command_read(command, argc, argv, options, &c);
	int err;

	if (status != COMMAND_GOES_ON)
		return status;
	if (optind + 1 != argc)
		return command_wrong(command, "expected one scene file");
	if (!c.panorama && !c.lamps.count)
		return command_wrong(command, "--panorama or --lamp is missing");
	if ((c.fisheye_placed || c.fisheye_lens) && !(c.lamps.count && c.fisheye_out))
		return command_wrong(
			command, "--fisheye and --fisheye-lens go with --lamp and --fisheye-out");
	if (!c.output)
		return command_wrong(command, "-o OUT is missing");
	err = run_truth(argv[optind], &c, &fault);
	if (err)
		log_error("%s", fault.text);
	return !err ? EXIT_SUCCESS : err == -ENODATA ? EXIT_MISSED : EXIT_FAILURE;
}

const struct command truth_command = {
	.name = "truth",
	.usage = "SCENE [--panorama P.hdr] [--lamp LAMP]... -o OUT.png|.pfm [options]",
	.summary = "path trace the finished composite under a panorama and lamps",
	.help = "\n  --panorama P        equirectangular, linear light; its upper half shines\n"
		"  --lamp LAMP         X,Y,Z,RADIUS,R,G,B: a sphere, in world units, and its\n"
		"                      radiance; it blocks no light; may be given again\n"
		"  -o FILE             .png: 8-bit sRGB; .pfm, .hdr: linear light\n"
		"  --turn DEG          turn the panorama about the vertical, counter-clockwise\n"
		"  --exposure E        radiance of 1 in the panorama; 1\n"
		"  --background IMG    the real picture; default: the panorama through the camera, or\n"
		"                      under lamps the scene without objects, in 8-bit code values\n"
		"  --samples S         a pixel; 256\n"
		"  --size WxH          of the picture\n"
		"  --background-out F  write the background that was used\n"
		"  --fisheye-out F     what a perfect fisheye camera at the origin sees\n"
		"  --fisheye X,Y,Z     under lamps: its place\n"
		"  --fisheye-lens F    under lamps: its lens, as inlay-calibrate fisheye writes it\n"
		"  --fisheye-size N    its side in pixels; 1024\n"
		"  --pose P            of the scene: number, from 0, or name\n"
		"  --seed K            of all random numbers\n"
		"  --threads T         default: one for each processor\n"
		"  --quiet             print nothing but errors\n\n"
		"Exit code 3: the camera sees no object, and there is no picture.\n",
	.run = truth_command_run,
};
