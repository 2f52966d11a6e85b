/* SPDX-License-Identifier: MIT */
/*
 * Watershed from the top: the picture is flooded from its brightest pixel downwards. What rises
 * alone is an island; where two islands meet, the lower one ends, and the light at which they meet
 * is that of its surroundings.
 */
#include "bake/calibrate/fisheye/lamps/lamps_spots.h"

#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "bake/calibrate/observe/plain_light.h"

#define LEVELS 4096
#define FLOOR 0.01     /* of the brightest pixel: darker pixels are not flooded */
#define LEAST 0.04     /* of the brightest pixel: least height of a spot */
#define STANDS_OUT 1.5 /* least brightness, in that of its surroundings */
#define ACROSS 0.06    /* largest diameter, of the picture's smaller side */
#define EDGE 0.3       /* of a spot's height: level of its edge */

/* Connected pixels flooded so far, as a union-find tree; its root is the brightest pixel. */
struct island {
	int parent; /* another pixel of the island; the root points to itself */
	int area;
	bool ended; /* too large, or met another: no spot any more */
};

struct flood {
	int width, height;
	float *light, most;
	struct island *island; /* [height][width] */
	int *order;	       /* pixels, the brightest first */
	int pixels;	       /* those of them above the floor */
	bool *taken;	       /* pixels that belong to a spot */
	int *queue;
	int area_most;
	struct spots *spots;
};

void spots_free(struct spots *spots)
{
	free(spots->spot);
	*spots = (struct spots){.spot = NULL};
}

static void flood_free(struct flood *flood)
{
	free(flood->light);
	free(flood->island);
	free(flood->order);
	free(flood->taken);
	free(flood->queue);
}

/* The square root resolves dark levels more finely. */
static int level_of_light(const struct flood *flood, float light)
{
	return (int)((LEVELS - 1) * sqrtf(fmaxf(light, 0) / flood->most));
}

/* Counting sort; pixels of a level keep their order. */
static void sort_pixels(struct flood *flood)
{
	const int count = flood->width * flood->height;
	int start[LEVELS + 1] = {0};

	for (int p = 0; p < count; p++)
		start[LEVELS - 1 - level_of_light(flood, flood->light[p]) + 1]++;
	for (int k = 0; k < LEVELS; k++)
		start[k + 1] += start[k];
	flood->pixels = start[LEVELS - (int)(LEVELS * sqrt(FLOOR))];
	for (int p = 0; p < count; p++)
		flood->order[start[LEVELS - 1 - level_of_light(flood, flood->light[p])]++] = p;
}

static int flood_create(struct flood *flood, const struct image *picture, struct spots *spots)
{
	const size_t count = (size_t)picture->width * (size_t)picture->height;
	const double across = ACROSS * fmin(picture->width, picture->height);

	*flood = (struct flood){
		.width = picture->width,
		.height = picture->height,
		.light = plain_light(picture),
		.island = calloc(count, sizeof(*flood->island)),
		.order = calloc(count, sizeof(*flood->order)),
		.taken = calloc(count, sizeof(*flood->taken)),
		.queue = calloc(count, sizeof(*flood->queue)),
		.area_most = (int)(M_PI / 4 * across * across) + 4,
		.spots = spots,
	};
	if (!flood->light || !flood->island || !flood->order || !flood->taken || !flood->queue)
		return -ENOMEM;
	for (size_t p = 0; p < count; p++)
		flood->most = fmaxf(flood->most, flood->light[p]);
	return 0;
}

/* ---- one spot ---- */

/* Returns the neighbours of a pixel in the picture. */
static int neighbours_of(const struct flood *flood, int p, int near[8])
{
	const int x = p % flood->width, y = p / flood->width;
	int count = 0;

	for (int dy = -1; dy <= 1; dy++)
		for (int dx = -1; dx <= 1; dx++)
			if ((dx || dy) && x + dx >= 0 && x + dx < flood->width && y + dy >= 0 &&
			    y + dy < flood->height)
				near[count++] = p + dy * flood->width + dx;
	return count;
}

/* Collects the pixels around a peak that are brighter than its edge level in the queue. Returns how
 * many; 0: too many, or cut by the picture's border. */
static int gather_island(struct flood *flood, int peak, double edge)
{
	int count = 1, near[8];
	bool cut = false;

	flood->queue[0] = peak;
	flood->taken[peak] = true;
	for (int at = 0; at < count && count <= flood->area_most; at++) {
		const int around = neighbours_of(flood, flood->queue[at], near);

		cut = cut || around < 8;
		for (int k = 0; k < around; k++)
			if (!flood->taken[near[k]] && flood->light[near[k]] > edge) {
				flood->taken[near[k]] = true;
				flood->queue[count++] = near[k];
			}
	}
	return cut || count > flood->area_most ? 0 : count;
}

static int keep_spot(struct flood *flood, int peak, double surroundings)
{
	const double height = flood->light[peak] - surroundings;
	const double edge = surroundings + EDGE * height;
	struct spots *spots = flood->spots;
	double light = 0, x = 0, y = 0;
	struct spot *grown;
	int count;

	if (flood->taken[peak] || height < LEAST * flood->most ||
	    flood->light[peak] < STANDS_OUT * surroundings)
		return 0;
	count = gather_island(flood, peak, edge);
	if (!count)
		return 0;
	for (int k = 0; k < count; k++) {
		const int p = flood->queue[k];
		const double above = flood->light[p] - edge;

		light += above;
		x += above * (p % flood->width + 0.5);
		y += above * (p / flood->width + 0.5);
	}
	grown = realloc(spots->spot, ((size_t)spots->count + 1) * sizeof(*grown));
	if (!grown)
		return -ENOMEM;
	spots->spot = grown;
	spots->spot[spots->count++] = (struct spot){
		.px = {x / light, y / light}, .radius_px = sqrt(count / M_PI), .light = light};
	return 0;
}

/* ---- the flood ---- */

static int first_of(struct flood *flood, int p)
{
	struct island *island = flood->island;

	while (island[p].parent != p) {
		island[p].parent = island[island[p].parent].parent;
		p = island[p].parent;
	}
	return p;
}

static int end_island(struct flood *flood, int first, double surroundings)
{
	const bool ended = flood->island[first].ended;

	flood->island[first].ended = true;
	return ended ? 0 : keep_spot(flood, first, surroundings);
}

static bool stands_out(const struct flood *flood, int first, double surroundings)
{
	return flood->light[first] >= STANDS_OUT * surroundings &&
	       flood->light[first] - surroundings >= LEAST * flood->most;
}

/* Joins the two islands that meet at a pixel of this light; the brighter root stays the root. */
static int join_islands(struct flood *flood, int a, int b, double light)
{
	struct island *island = flood->island;
	const int high = flood->light[a] >= flood->light[b] ? a : b, low = high == a ? b : a;
	/* A bump on the flank of the higher island does not end it. */
	const bool bump = !island[low].ended && !stands_out(flood, low, light);
	int err = 0;

	if (!bump) {
		err = end_island(flood, low, light);
		if (!err)
			err = end_island(flood, high, light);
	}
	island[low].parent = high;
	island[high].area += island[low].area;
	return err;
}

static int raise_pixel(struct flood *flood, int p)
{
	struct island *island = flood->island;
	int near[8], own = p, err = 0;
	const int around = neighbours_of(flood, p, near);

	island[p] = (struct island){.parent = p, .area = 1};
	for (int k = 0; k < around && !err; k++) {
		int other;

		if (!island[near[k]].area)
			continue;
		other = first_of(flood, near[k]);
		if (other == own)
			continue;
		err = join_islands(flood, own, other, flood->light[p]);
		own = first_of(flood, own);
	}
	if (!err && !island[own].ended && island[own].area > flood->area_most)
		err = end_island(flood, own, flood->light[p]);
	return err;
}

static int flood_run(struct flood *flood)
{
	const double floor = FLOOR * flood->most;
	int err = 0;

	sort_pixels(flood);
	for (int k = 0; k < flood->pixels && !err; k++)
		err = raise_pixel(flood, flood->order[k]);
	for (int k = 0; k < flood->pixels && !err; k++)
		if (first_of(flood, flood->order[k]) == flood->order[k])
			err = end_island(flood, flood->order[k], floor);
	return err;
}

static int by_light(const void *a, const void *b)
{
	const double x = ((const struct spot *)a)->light, y = ((const struct spot *)b)->light;

	return x < y ? 1 : x > y ? -1 : 0;
}

int spots_find(struct spots *spots, const struct image *picture)
{
	struct flood flood;
	int err;

	*spots = (struct spots){.spot = NULL};
	err = flood_create(&flood, picture, spots);
	if (!err && flood.most > 0)
		err = flood_run(&flood);
	flood_free(&flood);
	if (err)
		spots_free(spots);
	if (spots->count)
		qsort(spots->spot, (size_t)spots->count, sizeof(*spots->spot), by_light);
	spots->count = spots->count < SPOTS_MAX ? spots->count : SPOTS_MAX;
	return err;
}
