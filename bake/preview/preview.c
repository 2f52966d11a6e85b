/* SPDX-License-Identifier: MIT */
#include "bake/preview/preview.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "bake/scene/survey.h"
#include "bake/truth/photograph.h"
#include "bake/truth/truth.h"
#include "config/config.h"
#include "hal/base/output.h"
#include "hal/lights/lights_file.h"

/* The sky as a panorama. Cells of frequency 9 are 7 degrees wide. */
#define SKY_WIDTH 512
#define EVEN_SKY_WIDTH 16

struct preview {
	const struct preview_settings *settings;
	struct scene *scene;
	struct transfer_curve curve;
	double gain;
	struct image sky_picture;
	struct sky sky;
	struct image background; /* linear */
};

int preview_check(const struct preview_settings *s, struct fault *fault)
{
	const char *const read[] = {s->scene, s->background, s->config, s->lights};
	const int kind = image_name_linear(s->output, fault);

	return kind < 0 ? kind : output_check(&s->output, 1, read, 4, fault);
}

/* ---- what is given ---- */

static int preview_read_config(struct preview *p, struct fault *fault)
{
	struct ini_report report = {.count = 0};
	struct config *config = NULL;
	int err;

	p->curve = (struct transfer_curve){.named = TRANSFER_SRGB};
	p->gain = 1;
	if (!p->settings->config)
		return 0;
	err = config_create(&config, NULL);
	if (err)
		return fault_say(fault, err, "%s: %s", p->settings->config, strerror(-err));
	err = config_read(config, p->settings->config, &report);
	if (!err)
		err = config_read_files(config, &report);
	if (!err) {
		p->curve = config_background_curve(&config->background);
		p->gain = config->composite.gain;
	} else {
		*fault = report.first;
	}
	config_destroy(config);
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
			double d[3], weight[3];
			int light[3], count;

			panorama_direction(&panorama, x + 0.5, y + 0.5, d);
			count = dome_weights(dome, d, light, weight);
			for (int k = 0; k < count; k++)
				for (int c = 0; c < 3; c++)
					texel[c] += (float)weight[k] * radiance[light[k]][c];
		}
	return 0;
}

static int preview_read_lights(struct preview *p, struct fault *fault)
{
	const struct preview_settings *s = p->settings;
	const struct scene_lights lights = {s->frequency, -1, -1, NULL};
	float(*radiance)[3];
	struct dome dome;
	int err = scene_dome(p->scene, &lights, &dome, fault);

	if (err)
		return err;
	radiance = calloc((size_t)dome.count, sizeof(*radiance));
	if (!radiance)
		err = fault_say(fault, -ENOMEM, "%s: out of memory", s->lights);
	else
		err = lights_file_read(s->lights, radiance, dome.count, fault);
	if (!err && paint_lights(&dome, radiance, &p->sky_picture))
		err = fault_say(fault, -ENOMEM, "%s: out of memory", s->lights);
	free(radiance);
	dome_free(&dome);
	return err;
}

static int preview_make_sky(struct preview *p, struct fault *fault)
{
	const struct preview_settings *s = p->settings;
	struct panorama panorama = {.image = &p->sky_picture, .scale = s->exposure * p->gain};
	int err;

	if (s->lights) {
		err = preview_read_lights(p, fault);
	} else {
		err = image_create_f32(&p->sky_picture, EVEN_SKY_WIDTH, EVEN_SKY_WIDTH / 2);
		for (int i = 0; !err && i < 3 * EVEN_SKY_WIDTH * (EVEN_SKY_WIDTH / 2); i++)
			p->sky_picture.f32[i] = 1;
		if (err)
			fault_say(fault, err, "%s: %s", s->output, strerror(-err));
	}
	return err ? err : sky_create(&p->sky, &panorama, s->lights, fault);
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

int preview_run(const struct preview_settings *settings, struct fault *fault)
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
	scene_close(p.scene);
	return err;
}
