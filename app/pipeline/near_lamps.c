/* SPDX-License-Identifier: MIT */
#include "app/pipeline/near_lamps.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "hal/lights/lamp_find.h"
#include "hal/lights/lamp_light.h"
#include "hal/optics/vec.h"

/* A picture that is reduced to at most so many pixels each way shows a direction to half a degree. */
#define SIDE_MAX 256
#define APART (5 * M_PI / 180)
#define AFAR_M 1000

struct near_search {
	const struct dome *dome;
	struct lamp_finder finder;
	float *picture; /* [SIDE_MAX * SIDE_MAX], reduced */
	uint32_t *row;	/* [width]: of the frame */
	int width;
	float (*light)[3]; /* [lights] */
};

int near_search_create(struct near_search **out, const struct dome *dome)
{
	struct near_search *s = calloc(1, sizeof(*s));

	*out = NULL;
	if (!s)
		return -ENOMEM;
	s->dome = dome;
	s->picture = malloc(sizeof(*s->picture) * SIDE_MAX * SIDE_MAX);
	s->light = calloc((size_t)dome->count, sizeof(*s->light));
	if (!s->picture || !s->light) {
		near_search_destroy(s);
		return -ENOMEM;
	}
	*out = s;
	return 0;
}

void near_search_destroy(struct near_search *s)
{
	if (!s)
		return;
	lamp_finder_free(&s->finder);
	free(s->picture);
	free(s->row);
	free(s->light);
	free(s);
}

static void add_frame_row(struct near_search *s, const struct frame_reader *frame, int y, int side,
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
static int reduce(struct near_search *s, const struct near_light *light, struct lamp_picture *p,
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

/* Where a named lamp is seen, and how large it is. */
static double named_direction(const struct lamps *lamps, int lamp, double dir[3])
{
	double distance;

	for (int i = 0; i < 3; i++)
		dir[i] = lamps->lamp[lamp].position[i] - lamps->fisheye[i];
	distance = vec_normalize(dir);
	return distance > 0 ? asin(fmin(lamps->lamp[lamp].radius / distance, 1)) : 0;
}

static bool is_named(const struct lamps *lamps, const struct lamp_spot *spot)
{
	for (int l = 0; l < lamps->count; l++) {
		double dir[3];
		const double radius = named_direction(lamps, l, dir);

		if (vec_angle(dir, spot->dir) < APART + radius)
			return true;
	}
	return false;
}

static double mean_of(const double rgb[3])
{
	return (rgb[0] + rgb[1] + rgb[2]) / 3;
}

/* The strongest spot that is not named, by the light that the lights have around it. */
static int weigh_spots(struct near_search *s, const struct near_light *light,
		       const struct lamp_spot *spot, int spots, struct near_lamps *found)
{
	const double least = found->unnamed ? NEAR_LAMPS_UNTIL : NEAR_LAMPS_FROM;
	struct lamps far = {.count = 0};
	struct lamp_light *taken;
	double power[LAMPS_MAX][3], all = 0;

	found->unnamed = false;
	found->share = 0;
	for (int k = 0; k < spots && far.count < LAMPS_MAX; k++) {
		struct lamp *lamp = &far.lamp[far.count];

		if (spot[k].dir[2] <= 0 || is_named(light->lamps, &spot[k]))
			continue;
		for (int i = 0; i < 3; i++)
			lamp->position[i] = AFAR_M * spot[k].dir[i];
		lamp->radius = AFAR_M * sin(spot[k].radius);
		far.count++;
	}
	if (!far.count)
		return 0;
	if (lamp_light_create(&taken, s->dome, &far))
		return -ENOMEM;
	memcpy(s->light, light->distant, sizeof(*s->light) * (size_t)s->dome->count);
	lamp_light_take(taken, s->light, power);
	lamp_light_destroy(taken);
	for (int i = 0; i < s->dome->count; i++) {
		const double rgb[3] = {light->radiance[i][0], light->radiance[i][1],
				       light->radiance[i][2]};

		all += mean_of(rgb) * s->dome->projected_sr[i];
	}
	for (int k = 0; all > 0 && k < far.count; k++) {
		const double *at = far.lamp[k].position;
		const double share = mean_of(power[k]) * at[2] / AFAR_M / all;

		if (share < least || share <= found->share)
			continue;
		found->unnamed = true;
		found->share = share;
		found->azimuth_deg = atan2(at[1], at[0]) * (180 / M_PI);
		found->azimuth_deg += found->azimuth_deg < 0 ? 360 : 0;
		found->height_deg = asin(at[2] / AFAR_M) * (180 / M_PI);
	}
	return 0;
}

int near_search_look(struct near_search *s, const struct near_light *light,
		     struct near_lamps *found)
{
	struct lamp_spot spot[2 * LAMPS_MAX];
	struct lamp_picture picture;
	struct fisheye lens;
	int spots = reduce(s, light, &picture, &lens);

	if (!spots)
		spots = lamp_find(&s->finder, &picture, spot, 2 * LAMPS_MAX);
	if (spots < 0)
		return spots;
	for (int l = 0; l < LAMPS_MAX; l++) {
		double dir[3];
		const double radius = l < light->lamps->count
					      ? named_direction(light->lamps, l, dir)
					      : 0;

		found->missing[l] = l < light->lamps->count &&
				    !lamp_shines(&picture, dir, APART + radius);
	}
	return weigh_spots(s, light, spot, spots, found);
}
