/* SPDX-License-Identifier: MIT */
#include "bake/calibrate/fisheye/circle/fisheye_rim.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "bake/calibrate/estimate/order.h"
#include "hal/colour/transfer.h"

#define STEP_PX 0.5	  /* along a ray */
#define APART_PX 3.0	  /* distance of edges along the rim: neighbours share no pixels */
#define STAYS 4		  /* bright samples in a row that make an edge */
#define BORDER_PX 2.0	  /* edges nearer to the picture's border are not trusted */
#define DARK_SHARE 0.05	  /* least share of the picture that is dark surroundings */
#define BRIGHT_SHARE 0.90 /* quantile of the picture that counts as bright */
#define CONTRAST 0.04	  /* least step, relative to bright minus dark */
#define NOISES 6.0
#define BLOCK 8	       /* px; a smaller picture shows nothing */
#define DEVIATIONS 4.0 /* of a pixel's noise: several samples in a row never exceed it */
#define CLIPPED 0.9
/* The edge is where the ray falls most steeply between the means over SLOPE_PX inside and outside:
 * a blur moves the half of a step, but not that. Means over more pixels halve the error that noise
 * makes (0.1 px in low light), and double that of a sky that grows brighter inwards (0.15 px). */
#define SLOPE_PX 0.75
#define EDGE_REACH_PX 3.5 /* inwards from where the ray is bright: twice the blur of a bad focus */
#define ARM_PX 0.75	  /* distance of the three slopes whose parabola places the edge */
#define CLIPPED_MOST 0.4  /* largest share of the edges */

struct plane {
	int width, height;
	float *light; /* [height][width] */
	double dark, threshold;
	bool codes; /* 8-bit: the largest light is 1 */
};

struct rim_block {
	double mean, deviation;
};

static int by_mean(const void *a, const void *b)
{
	const double x = ((const struct rim_block *)a)->mean,
		     y = ((const struct rim_block *)b)->mean;

	return x < y ? -1 : x > y ? 1 : 0;
}

static struct rim_block measure_block(const struct plane *plane, int left, int top)
{
	struct rim_block block = {.mean = 0};
	double squares = 0;

	for (int k = 0; k < BLOCK * BLOCK; k++) {
		const int x = left + k % BLOCK, y = top + k / BLOCK;
		const double light = plane->light[(size_t)y * (size_t)plane->width + (size_t)x];

		block.mean += light / (BLOCK * BLOCK);
		squares += light * light / (BLOCK * BLOCK);
	}
	block.deviation = sqrt(fmax(squares - block.mean * block.mean, 0));
	return block;
}

/* Finds the largest light that noise makes of dark surroundings: from the darkest blocks, which
 * show noise even where the black level cuts most of it off and quantiles show none. */
static int find_noise(const struct plane *plane, double *most)
{
	const int columns = plane->width / BLOCK, rows = plane->height / BLOCK;
	const int dark = (int)(columns * rows * DARK_SHARE) + 1;
	struct rim_block *block = calloc((size_t)columns * (size_t)rows, sizeof(*block));

	if (!block)
		return -ENOMEM;
	for (int k = 0; k < columns * rows; k++)
		block[k] = measure_block(plane, k % columns * BLOCK, k / columns * BLOCK);
	qsort(block, (size_t)columns * (size_t)rows, sizeof(*block), by_mean);
	*most = 0;
	for (int k = 0; k < dark; k++)
		*most += (block[k].mean + DEVIATIONS * block[k].deviation) / dark;
	free(block);
	return 0;
}

/* Finds the darkness and the threshold of what is brighter than its noise, from quantiles of the
 * picture. */
static int find_threshold(struct plane *plane)
{
	const size_t count = (size_t)plane->width * (size_t)plane->height;
	float *sorted = malloc(count * sizeof(*sorted));
	double noise, bright, most;

	if (!sorted || find_noise(plane, &most)) {
		free(sorted);
		return -ENOMEM;
	}
	memcpy(sorted, plane->light, count * sizeof(*sorted));
	qsort(sorted, count, sizeof(*sorted), order_floats);
	plane->dark = sorted[(size_t)((double)count * DARK_SHARE)];
	noise = plane->dark - sorted[(size_t)((double)count * DARK_SHARE / 10)];
	bright = sorted[(size_t)((double)count * BRIGHT_SHARE)];
	plane->threshold = plane->dark + fmax(NOISES * noise, CONTRAST * (bright - plane->dark)) +
			   1e-6;
	plane->threshold = fmax(plane->threshold, most);
	free(sorted);
	return 0;
}

/* The mean of the channels in linear light; 8-bit pictures are decoded as sRGB. NULL: out of
 * memory. */
static float *plain_light(const struct image *picture)
{
	const size_t count = (size_t)picture->width * (size_t)picture->height;
	float *light = malloc(count * sizeof(*light));
	double decode[256];

	if (!light)
		return NULL;
	for (int code = 0; code < 256; code++)
		decode[code] = transfer_decode(TRANSFER_SRGB, code / 255.0);
	for (size_t p = 0; p < count; p++) {
		double sum = 0;

		for (size_t c = 0; c < 3; c++)
			sum += picture->u8 ? decode[picture->u8[3 * p + c]]
					   : (double)picture->f32[3 * p + c];
		light[p] = (float)(sum / 3);
	}
	return light;
}

static int take_light(struct plane *plane, const struct image *picture)
{
	*plane = (struct plane){
		.width = picture->width, .height = picture->height, .codes = picture->u8 != NULL};
	plane->light = plain_light(picture);
	if (!plane->light)
		return -ENOMEM;
	return find_threshold(plane);
}

static double light_at(const struct plane *plane, double x, double y)
{
	const double fx = fmin(fmax(x - 0.5, 0), plane->width - 1.001);
	const double fy = fmin(fmax(y - 0.5, 0), plane->height - 1.001);
	const int column = (int)fx, row = (int)fy;
	const double u = fx - column, v = fy - row;
	const float *at = plane->light + (size_t)row * (size_t)plane->width + column;
	const double above = at[0] + u * (at[1] - at[0]);
	const double below = at[plane->width] + u * (at[plane->width + 1] - at[plane->width]);

	return above + v * (below - above);
}

/* Finds the middle of the bright part: of the columns and rows with enough bright pixels. */
static bool find_middle(const struct plane *plane, double middle[2])
{
	for (int axis = 0; axis < 2; axis++) {
		const int lines = axis ? plane->height : plane->width;
		const int along = axis ? plane->width : plane->height;
		int first = -1, last = -1;

		for (int i = 0; i < lines; i++) {
			int bright = 0;

			for (int k = 0; k < along; k++) {
				const int x = axis ? k : i, y = axis ? i : k;

				bright += plane->light[(size_t)y * (size_t)plane->width + x] >
					  plane->threshold;
			}
			if (bright * 50 < along)
				continue;
			first = first < 0 ? i : first;
			last = i;
		}
		if (first < 0)
			return false;
		middle[axis] = (first + last + 1) / 2.0;
	}
	return true;
}

struct ray {
	double from[2], along[2]; /* outwards from the middle; along is a unit vector */
	double length;		  /* to the picture's edge */
};

static double on_ray(const struct plane *plane, const struct ray *ray, double at)
{
	return light_at(plane, ray->from[0] + at * ray->along[0],
			ray->from[1] + at * ray->along[1]);
}

static double mean_on_ray(const struct plane *plane, const struct ray *ray, double from, double to)
{
	double sum = 0;
	int count = 0;

	for (double at = from; at <= to; at += STEP_PX) {
		sum += on_ray(plane, ray, at);
		count++;
	}
	return sum / count;
}

static double ray_reach(const struct plane *plane, const struct ray *ray)
{
	const double size[2] = {plane->width, plane->height};
	double length = INFINITY;

	for (int i = 0; i < 2; i++) {
		if (ray->along[i] > 1e-12)
			length = fmin(length, (size[i] - ray->from[i]) / ray->along[i]);
		if (ray->along[i] < -1e-12)
			length = fmin(length, -ray->from[i] / ray->along[i]);
	}
	return length;
}

/* Returns the first place, from outside, from which on the ray is bright; below 0: none. */
static double first_bright(const struct plane *plane, const struct ray *ray)
{
	int bright = 0;

	for (double at = ray->length; at > 4; at -= STEP_PX) {
		bright = on_ray(plane, ray, at) > plane->threshold ? bright + 1 : 0;
		if (bright == STAYS)
			return at + (STAYS - 1) * STEP_PX;
	}
	return -1;
}

/* How much the ray darkens outwards at a place. */
static double fall_at(const struct plane *plane, const struct ray *ray, double at)
{
	return mean_on_ray(plane, ray, at - SLOPE_PX, at - STEP_PX / 2) -
	       mean_on_ray(plane, ray, at + STEP_PX / 2, at + SLOPE_PX);
}

/* Places the edge where the ray falls most steeply. */
static bool refine_edge(const struct plane *plane, const struct ray *ray, double rough,
			struct rim_edge *edge)
{
	double steepest = 0, place = 0, inner, outer, bend;

	for (double at = rough + 1.5; at > rough - EDGE_REACH_PX; at -= STEP_PX / 2) {
		const double fall = fall_at(plane, ray, at);

		place = fall > steepest ? at : place;
		steepest = fmax(fall, steepest);
	}
	inner = fall_at(plane, ray, place - ARM_PX);
	outer = fall_at(plane, ray, place + ARM_PX);
	bend = inner + outer - 2 * steepest;
	if (steepest < plane->threshold - plane->dark || !(bend < 0))
		return false;
	place += ARM_PX / 2 * (inner - outer) / bend;
	for (int i = 0; i < 2; i++)
		edge->px[i] = ray->from[i] + place * ray->along[i];
	edge->clipped = plane->codes && mean_on_ray(plane, ray, rough - 2.5, rough - 1.5) > CLIPPED;
	return true;
}

static void look_along(const struct plane *plane, const struct ray *ray, struct rim *rim)
{
	const double rough = first_bright(plane, ray);

	if (rough < 0)
		return;
	if (rough > ray->length - BORDER_PX)
		rim->cut++;
	else if (refine_edge(plane, ray, rough, &rim->edge[rim->count]))
		rim->count++;
}

static int look_along_rays(const struct plane *plane, const double middle[2], struct rim *rim)
{
	const double around = M_PI * (plane->width + plane->height) / 2;

	rim->rays = (int)(around / APART_PX) + 8;
	rim->edge = calloc((size_t)rim->rays, sizeof(*rim->edge));
	if (!rim->edge)
		return -ENOMEM;
	for (int k = 0; k < rim->rays; k++) {
		const double phi = 2 * M_PI * k / rim->rays;
		struct ray ray = {{middle[0], middle[1]}, {cos(phi), sin(phi)}, 0};

		ray.length = ray_reach(plane, &ray);
		look_along(plane, &ray, rim);
	}
	return 0;
}

/* Where white is clipped, half of the step lies too far out: drops such edges unless they are
 * many. */
static void drop_clipped(struct rim *rim)
{
	int kept = 0, clipped = 0;

	for (int k = 0; k < rim->count; k++)
		clipped += rim->edge[k].clipped;
	if (clipped > CLIPPED_MOST * rim->count)
		return;
	for (int k = 0; k < rim->count; k++)
		if (!rim->edge[k].clipped)
			rim->edge[kept++] = rim->edge[k];
	rim->count = kept;
}

int rim_find(struct rim *rim, const struct image *picture, const double middle[2])
{
	struct plane plane;
	double own[2] = {0, 0};
	int err;

	*rim = (struct rim){.edge = NULL};
	if (picture->width < 16 || picture->height < 16)
		return 0;
	err = take_light(&plane, picture);
	if (!err && middle)
		memcpy(own, middle, sizeof(own));
	if (!err && (middle || find_middle(&plane, own)))
		err = look_along_rays(&plane, own, rim);
	if (!err)
		drop_clipped(rim);
	free(plane.light);
	return err;
}

void rim_free(struct rim *rim)
{
	free(rim->edge);
	*rim = (struct rim){.edge = NULL};
}
