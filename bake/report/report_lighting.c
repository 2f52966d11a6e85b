/* SPDX-License-Identifier: MIT */
#include "bake/report/report_bake.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "bake/report/report_parts.h"
#include "bake/truth/truth.h"
#include "bake/truth/truth_views.h"
#include "hal/measure/measure.h"

#define MADE_WIDTH 1024 /* pixels across of made panoramas */

static int read_panorama(struct report_lighting *l, const struct report_lighting_settings *s,
			 struct fault *fault)
{
	int err;

	if (!s->path) {
		snprintf(l->name, sizeof(l->name), "%s", report_sky_names[s->made]);
		err = report_sky_make(&l->image, s->made, MADE_WIDTH);
		return err ? fault_say(fault, err, "%s: %s", l->name, strerror(-err)) : 0;
	}
	lighting_name(s->path, l->name, sizeof(l->name));
	return panorama_read(&l->image, s->path, fault);
}

static int lighting_expose(struct report_lighting *l, struct sky *sky, struct fault *fault)
{
	int err;

	l->panorama = (struct panorama){.image = &l->image, .scale = 1};
	err = sky_create(sky, &l->panorama, l->name, fault);
	if (err)
		return err;
	l->panorama.scale = REPORT_WHITE / (double)rgb_peak(sky->ground);
	sky_free(sky);
	return sky_create(sky, &l->panorama, l->name, fault);
}

/* Fills the background as the camera delivers it: in 8 bits. */
static int lighting_photograph(struct report_lighting *l, const struct scene *scene)
{
	struct image seen = {.width = 0};
	const int err = truth_background(scene, &l->panorama, &seen);

	if (err)
		return err;
	for (int y = 0; y < seen.height; y++) {
		for (int x = 0; x < seen.width; x++) {
			uint8_t *to = l->background.pixels + (size_t)y * l->background.stride +
				      (size_t)x * 4;
			const float *v = seen.f32 +
					 3 * ((size_t)y * (size_t)seen.width + (size_t)x);

			for (int c = 0; c < 3; c++)
				to[2 - c] = (uint8_t)lround(
					255 * transfer_encode(TRANSFER_SRGB, (double)v[c]));
			to[3] = 255;
		}
	}
	image_free(&seen);
	return 0;
}

/* The background in linear light, for truth_run(). */
static int background_light(const struct report_lighting *l, struct image *linear)
{
	const int err = image_create_f32(linear, l->background.width, l->background.height);

	if (err)
		return err;
	for (int y = 0; y < linear->height; y++) {
		for (int x = 0; x < linear->width; x++) {
			const uint8_t *from = l->background.pixels +
					      (size_t)y * l->background.stride + (size_t)x * 4;
			float *to = linear->f32 +
				    3 * ((size_t)y * (size_t)linear->width + (size_t)x);

			for (int c = 0; c < 3; c++)
				to[c] = (float)transfer_decode(TRANSFER_SRGB, from[2 - c] / 255.0);
		}
	}
	return 0;
}

/* Traces the truth in two halves with different random numbers. Their difference tells its noise,
 * which the spread within a run overestimates, as its samples are spread evenly. */
static int lighting_trace(struct report_lighting *l, const struct scene *scene,
			  const struct sky *sky, const struct report_lighting_settings *s,
			  struct fault *fault)
{
	const size_t values = 3 * (size_t)scene->camera.width * (size_t)scene->camera.height;
	struct image background = {.width = 0}, out[2] = {{.width = 0}, {.width = 0}};
	int err = background_light(l, &background);

	l->truth = calloc(values, sizeof(*l->truth));
	for (int h = 0; h < 2; h++)
		l->half[h] = calloc(values, sizeof(*l->half[h]));
	if (err || !l->truth || !l->half[0] || !l->half[1])
		err = fault_say(fault, -ENOMEM, "not enough memory for a picture");
	for (int h = 0; !err && h < 2; h++) {
		const struct truth_settings settings = {.samples = (s->truth_samples + 1) / 2,
							.bounces = scene->file->render.bounces,
							.seed = s->seed + h,
							.threads = s->threads,
							.quiet = s->quiet};
		struct truth_report report;

		err = truth_run(scene, sky, &background, &settings, &out[h], &report, fault);
	}
	for (size_t k = 0; !err && k < values; k++) {
		const double a = (double)out[0].f32[k], b = (double)out[1].f32[k];

		l->half[0][k] = 255 * transfer_encode(TRANSFER_SRGB, a);
		l->half[1][k] = 255 * transfer_encode(TRANSFER_SRGB, b);
		l->truth[k] = 255 * transfer_encode(TRANSFER_SRGB, (a + b) / 2);
	}
	image_free(&out[0]);
	image_free(&out[1]);
	image_free(&background);
	return err;
}

int report_lighting_open(struct report_lighting *l, const struct scene *scene,
			 const struct report_lighting_settings *s, struct fault *fault)
{
	const int width = scene->camera.width, height = scene->camera.height;
	const struct view whole = {.width = width, .height = height, .squash = 1};
	struct sky sky = {.width = 0};
	int err;

	*l = (struct report_lighting){.truth = NULL};
	err = read_panorama(l, s, fault);
	if (!err)
		err = lighting_expose(l, &sky, fault);
	if (err)
		goto release;
	err = truth_fisheye(&l->panorama, s->fisheye_side, &l->fisheye);
	if (!err)
		err = canvas_create(&l->background, width, height);
	if (!err)
		err = canvas_create(&l->composite, width, height);
	if (!err)
		err = lighting_photograph(l, scene);
	if (err) {
		fault_say(fault, err, "%s: %s", l->name, strerror(-err));
		goto release;
	}
	l->background_picture = view_picture(&whole, l->background.pixels, l->background.stride);
	err = lighting_trace(l, scene, &sky, s, fault);
release:
	sky_free(&sky);
	return err;
}

void report_lighting_close(struct report_lighting *l)
{
	free(l->truth);
	free(l->half[0]);
	free(l->half[1]);
	canvas_free(&l->composite);
	canvas_free(&l->background);
	mirror_map_free(&l->mirror);
	image_free(&l->fisheye);
	image_free(&l->image);
	*l = (struct report_lighting){.truth = NULL};
}
