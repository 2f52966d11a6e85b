/* SPDX-License-Identifier: MIT */
#include "tests/people/filmed.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "drivers/sim/sensor.h"
#include "drivers/sim/spread.h"
#include "hal/frame/view.h"
#include "hal/lights/sampler.h"

enum { SKY_SIDE = 128 };
static const double sky_exposure = 0.16;
static const float wall_depth = 0.9f; /* m */

struct filmed_cameras {
	struct studio_view *place, *sky;
	struct studio_view
		*elsewhere; /* of the depth camera; NULL: it is in the background's place */
	struct studio_layer *elsewhere_people;
	struct light_sampler *sampler;
	struct sensor sensor, sky_sensor;
	struct studio_layer *sky_people;
	float *picture, *spread, *sky_picture; /* spread: two pictures */
	float *depth;			       /* before the depth camera's noise, m */
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
	filmed->behind = calloc(pixels, sizeof(*filmed->behind));
	filmed->before = calloc(pixels, sizeof(*filmed->before));
	filmed->bgrx = calloc(pixels, 4);
	filmed->depth = calloc(pixels, 2);
	filmed->light = calloc((size_t)dome->count, sizeof(*filmed->light));
	c->picture = calloc(pixels, 3 * sizeof(float));
	c->spread = calloc(pixels, 6 * sizeof(float));
	c->depth = calloc(pixels, sizeof(float));
	c->sky_picture = calloc((size_t)SKY_SIDE * SKY_SIDE, 3 * sizeof(float));
	c->sky_people = calloc((size_t)SKY_SIDE * SKY_SIDE, sizeof(*c->sky_people));
	c->sky_bgrx = calloc((size_t)SKY_SIDE * SKY_SIDE, 4);
	if (!filmed->ground || !filmed->behind || !filmed->before || !filmed->bgrx ||
	    !filmed->light || !filmed->depth || !c->depth || !c->picture || !c->spread ||
	    !c->sky_picture || !c->sky_people || !c->sky_bgrx)
		return -ENOMEM;
	sensor_prepare(&c->sensor, &(struct sensor_settings){
					   .exposure = 1,
					   .transfer = TRANSFER_SRGB,
					   .read_noise = 0.5,
					   .shot_noise = 2,
					   .seed = 3,
				   });
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

/* A low wall before everything: grey, lit as the ground that it hides. */
static void build_wall(struct filmed *filmed, const struct filmed_moment *moment)
{
	const struct studio_layer nothing = {.walker = -1};

	for (int y = moment->wall_y; moment->wall_y && y < filmed->height; y++)
		for (int x = moment->wall_x; x < filmed->width; x++) {
			const int k = y * filmed->width + x;

			for (int c = 0; c < 3; c++)
				filmed->ground[3 * k + c] *= 0.7f;
			filmed->behind[k] = filmed->before[k] = nothing;
		}
}

int filmed_see_from(struct filmed *filmed, const struct tsai_camera *depth_camera)
{
	const struct sim_eye eye = {
		.width = filmed->width, .height = filmed->height, .camera = *depth_camera};
	struct filmed_cameras *c = filmed->cameras;

	c->elsewhere_people = calloc((size_t)filmed->width * (size_t)filmed->height,
				     sizeof(*c->elsewhere_people));
	return c->elsewhere_people ? studio_view_create(&c->elsewhere, &eye) : -ENOMEM;
}

static void see_depth(struct filmed *filmed, const struct filmed_moment *moment,
		      const struct studio_lamps *lamps)
{
	struct filmed_cameras *c = filmed->cameras;

	if (c->elsewhere) {
		studio_people_draw(c->elsewhere, lamps, moment->walker, moment->walkers,
				   c->elsewhere_people);
		studio_view_depth(c->elsewhere, lamps, c->depth);
		studio_people_depth(c->elsewhere, c->elsewhere_people, c->depth);
		return;
	}
	studio_view_depth(c->place, lamps, c->depth);
	studio_people_depth(c->place, filmed->behind, c->depth);
	studio_people_depth(c->place, filmed->before, c->depth);
}

static void measure_depth(struct filmed *filmed, const struct filmed_moment *moment,
			  const struct studio_lamps *lamps)
{
	struct filmed_cameras *c = filmed->cameras;
	const struct sensor_depth sensor = {moment->depth_noise_mm, 5};

	see_depth(filmed, moment, lamps);
	for (int y = moment->wall_y; moment->wall_y && y < filmed->height; y++)
		for (int x = moment->wall_x; x < filmed->width; x++)
			c->depth[y * filmed->width + x] = wall_depth;
	sensor_measure(&sensor, (uint64_t)moment->number, c->depth, filmed->width, filmed->height,
		       filmed->depth);
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
	struct studio_lamps lamps = studio_lamps(moment->time_s, moment->switch_s);
	const size_t pixels = (size_t)filmed->width * (size_t)filmed->height;
	struct walker split[2][WALKER_STYLES];
	int count[2] = {0, 0};

	for (int i = 0; i < moment->walkers; i++)
		split[moment->before[i]][count[moment->before[i]]++] = moment->walker[i];
	if (!moment->all_flicker)
		lamps.mains = moment->mains;
	studio_view_render(c->place, &lamps, filmed->ground);
	studio_people_shade(c->place, &lamps, moment->walker, moment->walkers, filmed->ground);
	studio_people_draw(c->place, &lamps, split[0], count[0], filmed->behind);
	studio_people_draw(c->place, &lamps, split[1], count[1], filmed->before);
	build_wall(filmed, moment);
	if (moment->depth_noise_mm > 0)
		measure_depth(filmed, moment, &lamps);
	for (size_t k = 0; k < pixels; k++) {
		const double row = moment->all_flicker
					   ? filmed_row(moment, (int)(k / (size_t)filmed->width),
							filmed->height)
					   : 1;

		expose(&filmed->ground[3 * k], moment->exposure, row);
		expose(filmed->behind[k].rgb, moment->exposure, row);
		expose(filmed->before[k].rgb, moment->exposure, row);
	}
	memcpy(c->picture, filmed->ground, pixels * 3 * sizeof(float));
	studio_people_over(c->place, filmed->behind, c->picture);
	studio_people_over(c->place, filmed->before, c->picture);
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
		free(c->depth);
		studio_view_destroy(c->elsewhere);
		free(c->elsewhere_people);
		free(c);
	}
	free(filmed->ground);
	free(filmed->behind);
	free(filmed->before);
	free(filmed->bgrx);
	free(filmed->depth);
	free(filmed->light);
	memset(filmed, 0, sizeof(*filmed));
}
