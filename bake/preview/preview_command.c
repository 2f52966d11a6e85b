/* SPDX-License-Identifier: MIT */
/* inlay-bake preview: the objects in a photograph of the place, within seconds, again and again. */
#include <errno.h>
#include <getopt.h>
#include <libyuv.h>
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bake/base/commands.h"
#include "bake/base/watch.h"
#include "bake/scene/survey.h"
#include "bake/truth/photograph.h"
#include "bake/truth/truth.h"
#include "config/config.h"
#include "hal/base/fault.h"
#include "hal/base/log.h"
#include "hal/base/output.h"
#include "hal/frame/frame.h"
#include "hal/lights/lamp/lamp_light.h"
#include "hal/lights/lights_file.h"
#include "hal/lights/sampler.h"
#include "hal/optics/dome.h"

struct preview_settings {
	const char *scene, *background, *output;
	const char *config; /* of the kiosk; NULL: none */
	/* Light colours of a dome, or a picture of the kiosk's fisheye (needs config); both NULL:
	 * an even sky. */
	const char *lights, *fisheye;
	int frequency;	 /* of that dome; -1: the scene's */
	double exposure; /* radiance of the even sky, or of 1 in lights */
	int samples;	 /* a pixel; 0: as many as make PREVIEW_RAYS, but PREVIEW_SAMPLES at most */
	const char *pose; /* name or number; NULL: the first */
	int threads;	  /* 0: one for each processor */
	bool quiet;	  /* prints nothing */
};

#define PREVIEW_RAYS 2500000 /* camera rays: some three seconds of a processor */
#define PREVIEW_SAMPLES 16

/* The sky as a panorama. Cells of frequency 9 are 7 degrees wide. */
#define SKY_WIDTH 512
#define EVEN_SKY_WIDTH 16

struct preview {
	const struct preview_settings *settings;
	struct config *config; /* NULL: none */
	struct scene *scene;
	struct transfer_curve curve;
	struct image sky_picture;
	struct truth_lamp lamp[LAMPS_MAX];
	int lamps;
	struct sky sky;
	struct image background; /* linear */
};

/* Checks that the output can be written and is none of the files that the settings name. */
static int preview_check(const struct preview_settings *s, struct fault *fault)
{
	const char *const read[] = {s->scene, s->background, s->config, s->lights, s->fisheye};
	const int kind = image_name_linear(s->output, fault);

	return kind < 0 ? kind : output_check(&s->output, 1, read, 5, fault);
}

/* ---- what is given ---- */

static int preview_read_config(struct preview *p, struct fault *fault)
{
	struct ini_report report = {.count = 0};
	int err;

	p->curve = (struct transfer_curve){.named = TRANSFER_SRGB};
	if (!p->settings->config)
		return 0;
	err = config_create(&p->config, NULL);
	if (err)
		return fault_say(fault, err, "%s: %s", p->settings->config, strerror(-err));
	err = config_read(p->config, p->settings->config, &report);
	if (!err)
		err = config_read_files(p->config, &report);
	if (err)
		*fault = report.first;
	else
		p->curve = config_background_curve(&p->config->background);
	return err;
}

static int preview_read_background(struct preview *p, struct fault *fault)
{
	const char *path = p->settings->background;
	struct image coded = {.width = 0};
	int err = photograph_read(path, p->scene, &coded, fault);

	if (err)
		return err;
	if (coded.f32) {
		p->background = coded;
		return 0;
	}
	err = photograph_decode(&coded, &p->curve, &p->background);
	image_free(&coded);
	return err ? fault_say(fault, err, "%s: %s", path, strerror(-err)) : 0;
}

/* ---- light ---- */

/* The radiance of each texel's direction; nothing below the horizon. */
static int paint_lights(const struct dome *dome, float (*radiance)[3], struct image *picture)
{
	const int err = image_create_f32(picture, SKY_WIDTH, SKY_WIDTH / 2);
	const struct panorama panorama = {.image = picture, .scale = 1};

	if (err)
		return err;
	memset(picture->f32, 0, 3 * sizeof(float) * SKY_WIDTH * (SKY_WIDTH / 2));
	for (int y = 0; y < SKY_WIDTH / 4; y++)
		for (int x = 0; x < SKY_WIDTH; x++) {
			float *texel = picture->f32 + 3 * (y * SKY_WIDTH + x);
			double d[3];
			int cell;

			panorama_direction(&panorama, x + 0.5, y + 0.5, d);
			cell = dome_cell_of(dome, d);
			for (int c = 0; cell >= 0 && c < 3; c++)
				texel[c] = radiance[cell][c];
		}
	return 0;
}

/* Measures the light in a picture of the fisheye, as the kiosk does. */
static int sample_fisheye(const char *path, const struct config_fisheye *fisheye,
			  const struct dome *dome, float (*radiance)[3], struct fault *fault)
{
	struct light_sampler_settings settings = {
		.placed = true,
		.curve = config_fisheye_curve(fisheye),
		.gain = response_gain(&fisheye->measured, fisheye->gain),
	};
	struct light_sampler *sampler = NULL;
	struct canvas canvas = {.width = 0};
	struct image image = {.width = 0};
	struct picture picture;
	struct view view;
	struct fisheye lens;
	int err = image_read(path, &image, fault);

	memcpy(settings.colours, fisheye->measured.colours, sizeof(settings.colours));
	if (!err)
		err = fisheye_prepare(&lens, &fisheye->lens, image.width, image.height, fault);
	if (!err)
		err = light_sampler_create(&sampler, dome, &lens, image.width, image.height,
					   &settings, fault);
	if (!err && image.f32) {
		err = light_sampler_read_linear(sampler, &image, radiance);
	} else if (!err && !(err = canvas_create(&canvas, image.width, image.height))) {
		/* libyuv's RAW is R, G, B in memory. */
		RAWToARGB(image.u8, 3 * image.width, canvas.pixels, (int)canvas.stride, image.width,
			  image.height);
		view = (struct view){.width = image.width, .height = image.height};
		picture = view_picture(&view, canvas.pixels, canvas.stride);
		err = light_sampler_read(sampler, &picture, radiance, NULL);
	}
	if (err && !*fault->text)
		fault_say(fault, err, "%s: %s", path, strerror(-err));
	light_sampler_destroy(sampler);
	canvas_free(&canvas);
	image_free(&image);
	return err;
}

/* Takes the light of the configuration's lamps out of the dome's, and hangs them up. */
static int hang_lamps(struct preview *p, const struct dome *dome, float (*radiance)[3],
		      struct fault *fault)
{
	const struct lamps *lamps = &p->config->lamps;
	const double scale = p->settings->exposure * p->config->composite.gain;
	struct lamp_light *light;
	double power[LAMPS_MAX][3];
	struct dome_placed *placed;
	int err = dome_placed_create(&placed, dome);

	if (err != -ENOMEM)
		err = lamp_light_create(&light, dome, placed, lamps);
	if (!err) {
		lamp_light_take(light, radiance, power);
		lamp_light_destroy(light);
	}
	dome_placed_destroy(placed);
	if (err)
		return fault_say(fault, err, "%s: out of memory", p->settings->fisheye);
	for (int l = 0; l < lamps->count; l++) {
		const double *at = lamps->lamp[l].position;
		double direction[3], angle;
		struct truth_lamp *lamp = &p->lamp[p->lamps];

		if (!lamp_light_seen(lamps, l, direction, &angle))
			continue;
		lamp->centre = (struct v3){(float)at[0], (float)at[1], (float)at[2]};
		lamp->radius = (float)lamps->lamp[l].radius;
		for (int c = 0; c < 3; c++)
			lamp->radiance.c[c] =
				(float)(scale * power[l][c] / (2 * M_PI * (1 - cos(angle))));
		p->lamps++;
	}
	return 0;
}

/* The light of each cell of the scene's dome, from a file or a fisheye. */
static int preview_read_light(struct preview *p, struct fault *fault)
{
	const struct preview_settings *s = p->settings;
	const struct scene_lights lights = {.frequency = s->frequency};
	const char *path = s->lights ? s->lights : s->fisheye;
	float(*radiance)[3];
	struct dome dome;
	int err = scene_dome(p->scene, &lights, &dome, fault);

	if (err)
		return err;
	radiance = calloc((size_t)dome.count, sizeof(*radiance));
	if (!radiance)
		err = fault_say(fault, -ENOMEM, "%s: out of memory", path);
	else if (s->lights)
		err = lights_file_read(s->lights, radiance, dome.count, fault);
	else
		err = sample_fisheye(s->fisheye, &p->config->fisheye, &dome, radiance, fault);
	if (!err && !s->lights && p->config->lamps.count)
		err = hang_lamps(p, &dome, radiance, fault);
	if (!err && paint_lights(&dome, radiance, &p->sky_picture))
		err = fault_say(fault, -ENOMEM, "%s: out of memory", path);
	free(radiance);
	dome_free(&dome);
	return err;
}

static int preview_make_sky(struct preview *p, struct fault *fault)
{
	const struct preview_settings *s = p->settings;
	const double gain = p->config ? p->config->composite.gain : 1;
	struct panorama panorama = {.image = &p->sky_picture, .scale = s->exposure * gain};
	int err;

	if (s->lights || s->fisheye) {
		err = preview_read_light(p, fault);
	} else {
		err = image_create_f32(&p->sky_picture, EVEN_SKY_WIDTH, EVEN_SKY_WIDTH / 2);
		for (int i = 0; !err && i < 3 * EVEN_SKY_WIDTH * (EVEN_SKY_WIDTH / 2); i++)
			p->sky_picture.f32[i] = 1;
		if (err)
			fault_say(fault, err, "%s: %s", s->output, strerror(-err));
	}
	if (!err)
		err = sky_create(&p->sky, &panorama, s->lights ? s->lights : s->fisheye, fault);
	p->sky.lamps = p->lamp;
	p->sky.lamp_count = p->lamps;
	return err;
}

/* ---- the picture ---- */

static int preview_trace(struct preview *p, struct fault *fault)
{
	const struct preview_settings *s = p->settings;
	const struct tsai_camera *camera = &p->scene->camera;
	const double pixels = (double)camera->width * camera->height;
	const struct truth_settings truth = {
		.samples = s->samples ? s->samples
				      : (int)fmax(1, fmin(PREVIEW_SAMPLES, PREVIEW_RAYS / pixels)),
		.bounces = 1,
		.seed = 1,
		.threads = s->threads,
		.quiet = s->quiet,
	};
	struct truth_report report = {.rays = 0};
	struct image out = {.width = 0};
	int err = truth_run(p->scene, &p->sky, &p->background, &truth, &out, &report, fault);

	if (!err)
		err = photograph_write(s->output, &out, &p->curve, fault);
	image_free(&out);
	if (!err && !s->quiet)
		printf("%s: %d x %d pixels, %d %s a pixel, time %.1f s\n", s->output, camera->width,
		       camera->height, truth.samples, truth.samples == 1 ? "sample" : "samples",
		       report.seconds);
	return err;
}

/* Makes the picture, which appears whole or not at all. Prints a line for each object and one for
 * the picture. Errors of its files; -EINVAL: a picture or lights that do not fit the scene;
 * -ENODATA: the camera sees no object. */
static int preview_run(const struct preview_settings *settings, struct fault *fault)
{
	struct preview p = {.settings = settings};
	int err = scene_open(&p.scene, settings->scene, 0, 0, fault);

	if (!err)
		err = scene_find_pose(p.scene, settings->pose, fault);
	if (!err)
		err = preview_read_config(&p, fault);
	if (!err)
		err = preview_read_background(&p, fault);
	if (!err)
		err = preview_make_sky(&p, fault);
	if (!err)
		err = survey_say(p.scene, settings->quiet ? NULL : stdout, fault);
	if (!err)
		err = preview_trace(&p, fault);
	sky_free(&p.sky);
	image_free(&p.sky_picture);
	image_free(&p.background);
	config_destroy(p.config);
	scene_close(p.scene);
	return err;
}

struct preview_choices {
	struct preview_settings preview;
	bool watch;
};

#define AT(field) .place = offsetof(struct preview_choices, field)

static const struct option_row options[] = {
	{"output", OPTION_TEXT, AT(preview.output)},
	{"background", OPTION_TEXT, AT(preview.background)},
	{"config", OPTION_TEXT, AT(preview.config)},
	{"lights", OPTION_TEXT, AT(preview.lights)},
	{"fisheye", OPTION_TEXT, AT(preview.fisheye)},
	{"frequency", OPTION_INT, AT(preview.frequency), .min = 1, .max = DOME_FREQUENCY_MAX},
	{"exposure", OPTION_REAL, AT(preview.exposure), .min = 1e-9, .max = 1e9},
	{"samples", OPTION_INT, AT(preview.samples), .min = 1, .max = 65536},
	{"pose", OPTION_TEXT, AT(preview.pose)},
	{"threads", OPTION_INT, AT(preview.threads), .min = 1, .max = 1024},
	{"watch", OPTION_FLAG, AT(watch)},
	{"quiet", OPTION_FLAG, AT(preview.quiet)},
	{.name = NULL},
};

/* Makes one picture. Returns the exit code. */
static int preview_once(const struct preview_settings *settings)
{
	struct fault fault = {.text = ""};
	const int err = preview_run(settings, &fault);

	fflush(stdout);
	if (!err)
		return EXIT_SUCCESS;
	log_error("%s", fault.text);
	return err == -ENODATA ? EXIT_MISSED : EXIT_FAILURE;
}

/* Makes a picture of each state of the files, and goes on until it is ended. An error is said, and
 * leaves the picture before. */
static int preview_watch(const struct preview_settings *settings)
{
	struct fault fault = {.text = ""};
	struct watch *watch;
	int err = watch_create(&watch, &fault);

	if (err) {
		log_error("%s", fault.text);
		return EXIT_FAILURE;
	}
	while (!err) {
		watch_begin(watch);
		(void)preview_once(settings);
		err = watch_end(watch, &fault);
		if (!err)
			(void)watch_wait(watch, -1);
	}
	log_error("%s", fault.text);
	watch_destroy(watch);
	return EXIT_FAILURE;
}

static int preview_command_run(const struct command *command, int argc, char **argv)
{
	struct preview_choices c = {.preview = {.frequency = -1, .exposure = 1}};
	struct fault fault = {.text = ""};
	const int status = command_read(command, argc, argv, options, &c);

	if (status != COMMAND_GOES_ON)
		return status;
	if (optind + 1 != argc)
		return command_wrong(command, "expected one scene file");
	if (!c.preview.background)
		return command_wrong(command, "--background IMG is missing");
	if (!c.preview.output)
		return command_wrong(command, "-o OUT.png is missing");
	if (c.preview.lights && c.preview.fisheye)
		return command_wrong(command, "--lights and --fisheye exclude each other");
	if (c.preview.fisheye && !c.preview.config)
		return command_wrong(command, "--fisheye goes with --config, which has its lens");
	if (c.preview.frequency >= 0 && !c.preview.lights && !c.preview.fisheye)
		return command_wrong(command, "--frequency goes with --lights and --fisheye");
	c.preview.scene = argv[optind];
	if (preview_check(&c.preview, &fault)) {
		log_error("%s", fault.text);
		return EXIT_FAILURE;
	}
	return c.watch ? preview_watch(&c.preview) : preview_once(&c.preview);
}

const struct command preview_command = {
	.name = "preview",
	.usage = "SCENE --background IMG -o OUT.png [options]",
	.summary = "show the object in a photograph of the place, within seconds",
	.help = "\n"
		"  --background IMG  what the camera sees: upright, as inlay grab takes it, and of\n"
		"                    the camera's size\n"
		"  -o FILE           .png: code values like the photograph's; .pfm, .hdr: linear light\n"
		"  --watch           make it again whenever the scene file or a file that it names changes,\n"
		"                    until ended; the picture is replaced whole\n"
		"  --config FILE     the kiosk's: [fisheye] and [background] without their views, [lamp NAME] of the\n"
		"                    fisheye's light, and [composite] gain; else sRGB and 1\n"
		"  --lights FILE     light colours, as inlay still --lights-out writes them\n"
		"  --fisheye IMG     or what the fisheye sees, upright; else the sky is even\n"
		"  --frequency F     of the dome whose lights these are; else that of the scene\n"
		"  --exposure E      radiance of the even sky, or of 1 in the light; 1\n"
		"  --samples S       camera rays a pixel; else as many as take seconds\n"
		"  --pose P          of the scene: number, from 0, or name\n"
		"  --threads T       default: one for each processor\n"
		"  --quiet           print nothing but errors\n\n"
		"Exit code 3: the camera sees no object, and there is no picture.\n",
	.run = preview_command_run,
};
