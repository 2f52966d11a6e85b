/* SPDX-License-Identifier: MIT */
#include "app/pipeline/near_lamps.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "hal/lights/lamp/lamp_find.h"
#include "hal/lights/lamp/lamp_light.h"
#include "hal/optics/vec.h"

/* A picture that is reduced to at most so many pixels each way shows a direction to half a degree. */
#define SIDE_MAX 256
#define APART (5 * M_PI / 180)
/* Surroundings of so many cells tell their median well; qsort() needs memory for more than 1 KB. */
#define AROUND_MAX 250
#define SPOTS 16

struct near_search {
	const struct dome *dome;
	struct lamp_finder finder;
	float *picture; /* [SIDE_MAX * SIDE_MAX], reduced */
	uint32_t *row;	/* [width]: of the frame */
	int width;
	int *owner; /* [lights] */
};

int near_search_create(struct near_search **out, const struct dome *dome)
{
	struct near_search *s = calloc(1, sizeof(*s));

	*out = NULL;
	if (!s)
		return -ENOMEM;
	s->dome = dome;
	s->picture = malloc(sizeof(*s->picture) * SIDE_MAX * SIDE_MAX);
	s->owner = calloc((size_t)dome->count, sizeof(*s->owner));
	if (!s->picture || !s->owner) {
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
	free(s->owner);
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

static float mean_of(const float rgb[3])
{
	return (rgb[0] + rgb[1] + rgb[2]) / 3;
}

static int compare_floats(const void *a, const void *b)
{
	const float x = *(const float *)a, y = *(const float *)b;

	return (x > y) - (x < y);
}

/* Finds the spot that each cell's light belongs to: the nearest; -1: none. */
static void find_owners(struct near_search *s, const struct lamp_spot *spot, int spots)
{
	for (int i = 0; i < s->dome->count; i++) {
		double least = LAMP_LIGHT_SHARED;

		s->owner[i] = -1;
		for (int k = 0; k < spots; k++) {
			const double apart = lamp_light_apart(s->dome, i, spot[k].dir,
							      spot[k].radius);

			if (apart < least) {
				least = apart;
				s->owner[i] = k;
			}
		}
	}
}

/* What a spot gives a level ground, of what is brighter in its cells than the surroundings. */
static double spot_light(const struct near_search *s, const float (*radiance)[3],
			 const struct lamp_spot *spot, int k)
{
	float around[AROUND_MAX], median = 0;
	double sum = 0;
	int count = 0;

	for (int i = 0; i < s->dome->count && count < AROUND_MAX; i++)
		if (s->owner[i] < 0 &&
		    lamp_light_apart(s->dome, i, spot[k].dir, spot[k].radius) < LAMP_LIGHT_AROUND)
			around[count++] = mean_of(radiance[i]);
	qsort(around, (size_t)count, sizeof(*around), compare_floats);
	if (count)
		median = around[count / 2];
	for (int i = 0; i < s->dome->count; i++)
		if (s->owner[i] == k)
			sum += (double)fmaxf(0, mean_of(radiance[i]) - median) *
			       s->dome->solid_angle_sr[i];
	return sum * spot[k].dir[2];
}

/* Finds the strongest spot that is not named, by the light that the lights have around it. */
static void weigh_spots(struct near_search *s, const struct near_light *light,
			struct lamp_spot *spot, int spots, struct near_lamps *found)
{
	const double least = found->unnamed ? NEAR_LAMPS_UNTIL : NEAR_LAMPS_FROM;
	double all = 0;
	int count = 0;

	found->unnamed = false;
	found->share = 0;
	for (int k = 0; k < spots; k++)
		if (spot[k].dir[2] > 0 && !is_named(light->lamps, &spot[k]))
			spot[count++] = spot[k];
	find_owners(s, spot, count);
	for (int i = 0; i < s->dome->count; i++)
		all += (double)mean_of(light->radiance[i]) * s->dome->projected_sr[i];
	for (int k = 0; all > 0 && k < count; k++) {
		const double share = spot_light(s, light->distant, spot, k) / all;

		if (share < least || share <= found->share)
			continue;
		found->unnamed = true;
		found->share = share;
		found->azimuth_deg = atan2(spot[k].dir[1], spot[k].dir[0]) * (180 / M_PI);
		found->azimuth_deg += found->azimuth_deg < 0 ? 360 : 0;
		found->height_deg = asin(spot[k].dir[2]) * (180 / M_PI);
	}
}

int near_search_look(struct near_search *s, const struct near_light *light,
		     struct near_lamps *found)
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
		double dir[3];
		const double radius = l < light->lamps->count
					      ? named_direction(light->lamps, l, dir)
					      : 0;

		found->missing[l] = l < light->lamps->count &&
				    !lamp_shines(&picture, dir, APART + radius);
	}
	weigh_spots(s, light, spot, spots, found);
	return 0;
}
