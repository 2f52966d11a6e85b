/* SPDX-License-Identifier: MIT */
#include "tests/people/filmed.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "drivers/sim/sim.h"
#include "hal/frame/view.h"
#include "hal/lights/sampler.h"

enum { SKY_SIDE = 128 };
static const double sky_exposure = 0.16;

struct filmed_cameras {
	struct studio_view *place, *sky;
	struct light_sampler *sampler;
	struct sensor sensor, sky_sensor;
	struct studio_layer *sky_people;
	float *picture, *spread, *sky_picture; /* spread: two pictures */
	uint8_t *sky_bgrx;
};

static int open_sky(struct filmed_cameras *cameras, const struct dome *dome)
{
	const struct fisheye_settings lens = {.field_deg = 90};
	const struct light_sampler_settings settings = {
		.curve = {.named = TRANSFER_SRGB},
		.gain = 1 / sky_exposure,
	};
	struct sim_eye eye = {.width = SKY_SIDE, .height = SKY_SIDE, .fisheye = true};
	int err = fisheye_prepare(&eye.lens, &lens, SKY_SIDE, SKY_SIDE, NULL);

	if (!err)
		err = studio_view_create(&cameras->sky, &eye);
	if (!err)
		err = light_sampler_create(&cameras->sampler, dome, &eye.lens, SKY_SIDE, SKY_SIDE,
					   &settings, NULL);
	sensor_prepare(&cameras->sky_sensor, &(struct sensor_settings){
						     .exposure = sky_exposure,
						     .transfer = TRANSFER_SRGB,
						     .read_noise = 0.4,
						     .shot_noise = 1.2,
						     .seed = 7,
					     });
	return err;
}

void filmed_set_noise(struct filmed *filmed, double read_noise, double shot_noise, int seed)
{
	sensor_prepare(&filmed->cameras->sensor, &(struct sensor_settings){
							 .exposure = 1,
							 .transfer = TRANSFER_SRGB,
							 .read_noise = read_noise,
							 .shot_noise = shot_noise,
							 .seed = seed,
						 });
}

/* Samples along a side of a pixel. */
enum { PAINT_SIDE = 4 };

static void paint_pixel(struct studio_view *view, int x, int y,
			void (*paint)(const void *room, struct studio_hit *hit), const void *room)
{
	double old[3] = {0}, new[3] = {0}, factor[3];

	for (int i = 0; i < PAINT_SIDE * PAINT_SIDE; i++) {
		const double px[2] = {x + (i % PAINT_SIDE + 0.5) / PAINT_SIDE,
				      y + (i / PAINT_SIDE + 0.5) / PAINT_SIDE};
		double origin[3], dir[3];
		struct studio_hit hit;

		if (!eye_ray(studio_view_eye(view), px, origin, dir) ||
		    !studio_hit(origin, dir, &hit))
			continue;
		if (hit.emitted[0] > 0)
			return;
		for (int c = 0; c < 3; c++)
			old[c] += hit.albedo[c];
		paint(room, &hit);
		for (int c = 0; c < 3; c++)
			new[c] += hit.albedo[c];
	}
	for (int c = 0; c < 3; c++)
		factor[c] = old[c] > 0 ? new[c] / old[c] : 1;
	studio_view_paint(view, x, y, factor);
}

void filmed_paint(struct filmed *filmed, void (*paint)(const void *room, struct studio_hit *hit),
		  const void *room)
{
	struct studio_view *const views[] = {filmed->cameras->place, filmed->cameras->sky};

	for (int i = 0; i < 2; i++) {
		const struct sim_eye *eye = studio_view_eye(views[i]);

		for (int k = 0; k < eye->width * eye->height; k++)
			paint_pixel(views[i], k % eye->width, k / eye->width, paint, room);
	}
}

int filmed_open(struct filmed *filmed, const struct tsai_camera *camera, const struct dome *dome)
{
	struct sim_eye eye = {.width = camera->width, .height = camera->height, .camera = *camera};
	const size_t pixels = (size_t)camera->width * (size_t)camera->height;
	struct filmed_cameras *c = calloc(1, sizeof(*c));
	int err;

	memset(filmed, 0, sizeof(*filmed));
	filmed->cameras = c;
	if (!c)
		return -ENOMEM;
	filmed->width = camera->width;
	filmed->height = camera->height;
	filmed->ground = calloc(pixels, 3 * sizeof(float));
	filmed->people = calloc(pixels, sizeof(*filmed->people));
	filmed->bgrx = calloc(pixels, 4);
	filmed->light = calloc((size_t)dome->count, sizeof(*filmed->light));
	c->picture = calloc(pixels, 3 * sizeof(float));
	c->spread = calloc(pixels, 6 * sizeof(float));
	c->sky_picture = calloc((size_t)SKY_SIDE * SKY_SIDE, 3 * sizeof(float));
	c->sky_people = calloc((size_t)SKY_SIDE * SKY_SIDE, sizeof(*c->sky_people));
	c->sky_bgrx = calloc((size_t)SKY_SIDE * SKY_SIDE, 4);
	if (!filmed->ground || !filmed->people || !filmed->bgrx || !filmed->light || !c->picture ||
	    !c->spread || !c->sky_picture || !c->sky_people || !c->sky_bgrx)
		return -ENOMEM;
	filmed_set_noise(filmed, 0.5, 2, 3);
	err = studio_view_create(&c->place, &eye);
	return err ? err : open_sky(c, dome);
}

static int measure_light(struct filmed *filmed, const struct filmed_moment *moment,
			 const struct studio_lamps *lamps)
{
	struct filmed_cameras *c = filmed->cameras;
	const struct view whole = {.width = SKY_SIDE, .height = SKY_SIDE, .squash = 1};
	struct picture picture;

	studio_view_render(c->sky, lamps, c->sky_picture);
	studio_people_draw(c->sky, lamps, moment->walker, moment->walkers, c->sky_people);
	studio_people_over(c->sky, c->sky_people, c->sky_picture);
	sensor_expose(&c->sky_sensor, (uint64_t)moment->number, c->sky_picture,
		      (size_t)SKY_SIDE * SKY_SIDE, c->sky_bgrx);
	picture = view_picture(&whole, c->sky_bgrx, (size_t)SKY_SIDE * 4);
	return light_sampler_read(c->sampler, &picture, filmed->light, NULL);
}

static void expose(float *rgb, const double exposure[3], double row)
{
	for (int c = 0; c < 3; c++)
		rgb[c] *= (float)(exposure[c] * row);
}

double filmed_row(const struct filmed_moment *moment, int y, int height)
{
	return mains_row(&moment->mains, moment->time_s, y, height);
}

static void take(struct filmed *filmed, const struct filmed_moment *moment, const float *rgb,
		 uint64_t number, uint8_t *bgrx)
{
	struct filmed_cameras *c = filmed->cameras;
	const size_t pixels = (size_t)filmed->width * (size_t)filmed->height;

	if (moment->edge_spread_px > 0) {
		spread_edges(rgb, filmed->width, filmed->height, moment->edge_spread_px,
			     c->spread + 3 * pixels, c->spread);
		rgb = c->spread;
	}
	sensor_expose(&c->sensor, number, rgb, pixels, bgrx);
}

void filmed_take_other(struct filmed *filmed, const struct filmed_moment *moment, const float *rgb,
		       uint8_t *bgrx)
{
	take(filmed, moment, rgb, (uint64_t)moment->number + (UINT64_C(1) << 24), bgrx);
}

int filmed_take(struct filmed *filmed, const struct filmed_moment *moment)
{
	struct filmed_cameras *c = filmed->cameras;
	struct studio_lamps lamps = moment->lamps ? *moment->lamps
						  : studio_lamps(moment->time_s, moment->switch_s);
	const size_t pixels = (size_t)filmed->width * (size_t)filmed->height;

	if (!moment->all_flicker)
		lamps.mains = moment->mains;
	studio_view_render(c->place, &lamps, filmed->ground);
	studio_people_shade(c->place, &lamps, moment->walker, moment->walkers, filmed->ground);
	studio_people_draw(c->place, &lamps, moment->walker, moment->walkers, filmed->people);
	for (size_t k = 0; k < pixels; k++) {
		const double row = moment->all_flicker
					   ? filmed_row(moment, (int)(k / (size_t)filmed->width),
							filmed->height)
					   : 1;

		expose(&filmed->ground[3 * k], moment->exposure, row);
		expose(filmed->people[k].rgb, moment->exposure, row);
	}
	memcpy(c->picture, filmed->ground, pixels * 3 * sizeof(float));
	studio_people_over(c->place, filmed->people, c->picture);
	take(filmed, moment, c->picture, (uint64_t)moment->number, filmed->bgrx);
	lamps.mains.depth = 0; /* the fisheye sees the mean */
	return measure_light(filmed, moment, &lamps);
}

void filmed_close(struct filmed *filmed)
{
	struct filmed_cameras *c = filmed->cameras;

	if (c) {
		studio_view_destroy(c->place);
		studio_view_destroy(c->sky);
		light_sampler_destroy(c->sampler);
		free(c->picture);
		free(c->spread);
		free(c->sky_picture);
		free(c->sky_people);
		free(c->sky_bgrx);
		free(c);
	}
	free(filmed->ground);
	free(filmed->people);
	free(filmed->bgrx);
	free(filmed->light);
	memset(filmed, 0, sizeof(*filmed));
}
