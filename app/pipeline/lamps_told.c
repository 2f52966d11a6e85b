/* SPDX-License-Identifier: MIT */
#include "app/pipeline/lamps_told.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "hal/lights/lamp/lamp_find.h"
#include "hal/lights/lamp/lamp_light.h"
#include "hal/optics/vec.h"

/* A picture that is reduced to at most so many pixels each way shows half a degree. */
#define SIDE_MAX 256
#define APART (5 * M_PI / 180)
#define SPOTS 16

struct lamps_search {
	const struct dome *dome;
	struct lamp_light *taken; /* of one spot */
	struct lamp_finder finder;
	float *picture; /* [SIDE_MAX * SIDE_MAX], reduced */
	uint32_t *row;	/* [width]: of the frame */
	int width;
	float (*radiance)[3]; /* [lights] */
};

int lamps_search_create(struct lamps_search **out, const struct dome *dome,
			const struct dome_placed *placed)
{
	const struct lamps one = {.count = 1};
	struct lamps_search *s = calloc(1, sizeof(*s));

	*out = NULL;
	if (!s)
		return -ENOMEM;
	s->dome = dome;
	s->picture = malloc(sizeof(*s->picture) * SIDE_MAX * SIDE_MAX);
	s->radiance = calloc((size_t)dome->count, sizeof(*s->radiance));
	if (!s->picture || !s->radiance || lamp_light_create(&s->taken, dome, placed, &one)) {
		lamps_search_destroy(s);
		return -ENOMEM;
	}
	*out = s;
	return 0;
}

void lamps_search_destroy(struct lamps_search *s)
{
	if (!s)
		return;
	lamp_light_destroy(s->taken);
	lamp_finder_free(&s->finder);
	free(s->picture);
	free(s->row);
	free(s->radiance);
	free(s);
}

static void add_frame_row(struct lamps_search *s, const struct frame_reader *frame, int y, int side,
			  const float decode[256], float *to, int columns)
{
	const uint32_t *row = frame_reader_row(frame, 0, y, columns * side, s->row);

	for (int x = 0; x < columns * side; x++) {
		const uint32_t b = row[x] & 255, g = row[x] >> 8 & 255, r = row[x] >> 16 & 255;
		const uint32_t most = b > g ? b : g;

		to[x / side] += decode[most > r ? most : r];
	}
}

static void add_linear_row(const struct image *linear, int y, int side, float *to, int columns)
{
	const float *row = linear->f32 + 3 * (size_t)y * (size_t)linear->width;

	for (int x = 0; x < columns * side; x++)
		to[x / side] += fmaxf(fmaxf(row[3 * x], row[3 * x + 1]), row[3 * x + 2]);
}

/* Fills the picture with means of squares of pixels, and *lens with a lens of it. */
static int reduce(struct lamps_search *s, const struct lamps_light *light, struct lamp_picture *p,
		  struct fisheye *lens)
{
	const int width = light->frame ? light->frame->view.width : light->linear->width;
	const int height = light->frame ? light->frame->view.height : light->linear->height;
	const int side = ((width > height ? width : height) + SIDE_MAX - 1) / SIDE_MAX;
	float decode[256];

	if (width > s->width) {
		free(s->row);
		s->row = malloc((size_t)width * sizeof(*s->row));
		s->width = s->row ? width : 0;
		if (!s->row)
			return -ENOMEM;
	}
	*p = (struct lamp_picture){.light = s->picture,
				   .width = width / side,
				   .height = height / side,
				   .white = INFINITY,
				   .lens = lens};
	*lens = *light->lens;
	for (int i = 0; i < 2; i++) {
		lens->focal_px[i] /= side;
		lens->centre_px[i] /= side;
	}
	for (int code = 0; light->frame && code < 256; code++)
		decode[code] =
			(float)(transfer_curve_decode(light->curve, code / 255.0) / (side * side));
	memset(s->picture, 0, sizeof(*s->picture) * (size_t)(p->width * p->height));
	for (int y = 0; y < p->height * side; y++) {
		float *to = s->picture + y / side * p->width;

		if (light->frame)
			add_frame_row(s, light->frame, y, side, decode, to, p->width);
		else
			add_linear_row(light->linear, y, side, to, p->width);
	}
	return 0;
}

static bool is_named(const struct lamps *lamps, const struct lamp_spot *spot)
{
	for (int l = 0; l < lamps->count; l++) {
		double dir[3], radius;

		if (lamp_light_seen(lamps, l, dir, &radius) &&
		    vec_angle(dir, spot->dir) < APART + radius)
			return true;
	}
	return false;
}

static float mean_of(const float rgb[3])
{
	return (rgb[0] + rgb[1] + rgb[2]) / 3;
}

/* Takes what a spot gives a level ground out of the lights. */
static double take_spot(struct lamps_search *s, const struct lamp_spot *spot)
{
	struct lamps lamps = {.count = 1, .lamp = {{.radius = sin(spot->radius)}}};
	double power[1][3];

	memcpy(lamps.lamp[0].position, spot->dir, sizeof(spot->dir));
	lamp_light_aim(s->taken, &lamps);
	lamp_light_take(s->taken, s->radiance, power);
	return (power[0][0] + power[0][1] + power[0][2]) / 3 * spot->dir[2];
}

/* Finds the strongest spot that is not named, by the light that the lights have around it. */
static void weigh_spots(struct lamps_search *s, const struct lamps_light *light,
			const struct lamp_spot *spot, int spots, struct lamps_told *found)
{
	const double least = found->unnamed ? LAMPS_TOLD_UNTIL : LAMPS_TOLD_FROM;
	double all = 0;

	found->unnamed = false;
	found->share = 0;
	memcpy(s->radiance, light->distant, sizeof(*s->radiance) * (size_t)s->dome->count);
	for (int i = 0; i < s->dome->count; i++)
		all += (double)mean_of(light->radiance[i]) * s->dome->projected_sr[i];
	for (int k = 0; all > 0 && k < spots; k++) {
		double given;

		if (!(spot[k].dir[2] > 0) || is_named(light->lamps, &spot[k]))
			continue;
		given = take_spot(s, &spot[k]);
		if (given / all < least || given / all <= found->share)
			continue;
		found->unnamed = true;
		found->share = given / all;
		found->azimuth_deg = atan2(spot[k].dir[1], spot[k].dir[0]) * (180 / M_PI);
		found->azimuth_deg += found->azimuth_deg < 0 ? 360 : 0;
		found->height_deg = asin(spot[k].dir[2]) * (180 / M_PI);
	}
}

int lamps_search_look(struct lamps_search *s, const struct lamps_light *light,
		      struct lamps_told *found)
{
	struct lamp_spot spot[SPOTS];
	struct lamp_picture picture;
	struct fisheye lens;
	int spots = reduce(s, light, &picture, &lens);

	if (!spots)
		spots = lamp_find(&s->finder, &picture, spot, SPOTS);
	if (spots < 0)
		return spots;
	for (int l = 0; l < LAMPS_MAX; l++) {
		double dir[3], radius;

		found->missing[l] = l < light->lamps->count &&
				    !(lamp_light_seen(light->lamps, l, dir, &radius) &&
				      lamp_shines(&picture, dir, APART + radius));
	}
	weigh_spots(s, light, spot, spots, found);
	return 0;
}
