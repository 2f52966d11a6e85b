/* SPDX-License-Identifier: MIT */
#include "bake/trace/transport.h"

#include <errno.h>
#include <stdlib.h>

#include "bake/base/random.h"

/* A table has at most this many directions, 3 MB, so that it stays in the processor's cache. */
#define TABLE_MAX (1 << 18)
/* Least and largest depth, the number of directions in a cell. All pixels share them, so the
 * visible share of a partly hidden cell is wrong by about 1 / depth, in all pixels alike. */
#define DEPTH_MIN 32
#define DEPTH_MAX (1 << 15)

static struct v3 cells_narrow(const double d[3])
{
	return v3_make((float)d[0], (float)d[1], (float)d[2]);
}

static float reach_of(const struct dome *dome, int light)
{
	const double reach = dome_cell_reach_rad(dome, light);

	return reach < M_PI / 2 ? (float)sin(reach) * 1.001f + 1e-6f : 1;
}

/* ---- directions ---- */

/* The unit square is divided into this many strips each way. The density within a square is taken
 * as constant, as it varies little even within a cell. */
#define SQUARES 16

/*
 * Cumulative distribution for warping the unit square, so that dome_cell_sample() draws directions
 * with another density: u by the marginal all[], then v by part[] of u's strip. Each is a sum from
 * 0 to its total.
 */
struct warp {
	double all[SQUARES + 1];
	double part[SQUARES][SQUARES + 1];
};

/* Makes a warp whose density is even in projected solid angle. */
static void make_warp(const struct dome *dome, int light, struct warp *warp)
{
	warp->all[0] = 0;
	for (int j = 0; j < SQUARES; j++) {
		warp->part[j][0] = 0;
		for (int k = 0; k < SQUARES; k++) {
			double d[3];

			dome_cell_sample(dome, light, (j + 0.5) / SQUARES, (k + 0.5) / SQUARES, d);
			warp->part[j][k + 1] = warp->part[j][k] + d[2];
		}
		warp->all[j + 1] = warp->all[j] + warp->part[j][SQUARES];
	}
}

/* Inverts the cumulative sums: returns the place in 0..1 at which they reach the share x of their
 * total. *square becomes the index of the square in which it lies. */
static double reach_share(const double sum[SQUARES + 1], double x, int *square)
{
	const double want = x * sum[SQUARES];
	int k = 0;

	while (k < SQUARES - 1 && sum[k + 1] <= want)
		k++;
	*square = k;
	return fmin((k + (want - sum[k]) / (sum[k + 1] - sum[k])) / SQUARES, 0x1.fffffep-1);
}

static void draw_warped(const struct dome *dome, int light, const struct warp *warp,
			const double point[2], double d[3])
{
	int strip, square;
	const double u = reach_share(warp->all, point[0], &strip);

	dome_cell_sample(dome, light, u, reach_share(warp->part[strip], point[1], &square), d);
}

static void fill_directions(struct cells *cells, int place)
{
	const int cell = cells->order[place];
	const uint64_t scramble = random_hash((uint64_t)cell, 0xce11, 0);
	struct warp ground;

	make_warp(cells->dome, cell, &ground);
	for (int k = 0; k < cells->depth; k++) {
		const size_t at = (size_t)k * (size_t)cells->count + (size_t)place;
		double point[2], d[3];

		sobol_point((uint32_t)k, scramble, point);
		dome_cell_sample(cells->dome, cell, point[0], point[1], d);
		cells->uniform[at] = cells_narrow(d);
		draw_warped(cells->dome, cell, &ground, point, d);
		cells->ground[at] = cells_narrow(d);
	}
}

/* ---- order ---- */

struct cell_place {
	uint32_t key;
	int cell;
};

static int compare_places(const void *a, const void *b)
{
	const struct cell_place *left = a, *right = b;

	if (left->key != right->key)
		return left->key < right->key ? -1 : 1;
	return left->cell < right->cell ? -1 : 1;
}

/* Returns the place along Hilbert's curve of a point of a grid of 2^15 x 2^15. */
static uint32_t hilbert_key(uint32_t x, uint32_t y)
{
	const uint32_t last = (UINT32_C(1) << 15) - 1;
	uint32_t along = 0;

	for (uint32_t s = UINT32_C(1) << 14; s; s >>= 1) {
		const uint32_t right = (x & s) != 0, up = (y & s) != 0;

		along += s * s * ((3 * right) ^ up);
		if (!up) {
			const uint32_t swap = x;

			x = right ? last - y : y;
			y = right ? last - swap : swap;
		}
	}
	return along;
}

/* Orders cells along Hilbert's curve in an equal-area projection of the sky. */
static int set_order(struct cells *cells)
{
	const size_t count = (size_t)cells->count;
	struct cell_place *places = malloc(count * sizeof(*places));

	if (!places)
		return -ENOMEM;
	for (int i = 0; i < cells->count; i++) {
		const struct v3 d = cells->node[i];
		const float scale = 1 / sqrtf(1 + d.z);

		places[i].cell = i;
		places[i].key = hilbert_key((uint32_t)((d.x * scale + 1) * 16383.5f),
					    (uint32_t)((d.y * scale + 1) * 16383.5f));
	}
	qsort(places, count, sizeof(*places), compare_places);
	for (size_t i = 0; i < count; i++)
		cells->order[i] = places[i].cell;
	free(places);
	return 0;
}

/* ---- all of it ---- */

int cells_create(struct cells *cells, const struct dome *dome)
{
	const size_t count = (size_t)dome->count;
	size_t all;
	int err;

	*cells = (struct cells){.dome = dome, .count = dome->count, .depth = DEPTH_MAX};
	while ((int64_t)cells->depth * cells->count > TABLE_MAX && cells->depth > DEPTH_MIN)
		cells->depth /= 2;
	all = count * (size_t)cells->depth;
	cells->order = malloc(count * sizeof(*cells->order));
	cells->node = malloc(count * sizeof(*cells->node));
	cells->sr = malloc(count * sizeof(*cells->sr));
	cells->share = malloc(count * sizeof(*cells->share));
	cells->shown = malloc(count * sizeof(*cells->shown));
	cells->reach = malloc(count * sizeof(*cells->reach));
	cells->uniform = malloc(all * sizeof(*cells->uniform));
	cells->ground = malloc(all * sizeof(*cells->ground));
	if (!cells->order || !cells->node || !cells->sr || !cells->share || !cells->shown ||
	    !cells->reach || !cells->uniform || !cells->ground) {
		cells_free(cells);
		return -ENOMEM;
	}
	for (int i = 0; i < cells->count; i++) {
		cells->node[i] = cells_narrow(dome->direction[i]);
		cells->sr[i] = (float)dome->solid_angle_sr[i];
		cells->share[i] = (float)(dome->projected_sr[i] / M_PI);
		cells->shown[i] = cells->share[i];
		cells->reach[i] = reach_of(dome, i);
	}
	err = set_order(cells);
	if (err) {
		cells_free(cells);
		return err;
	}
	for (int place = 0; place < cells->count; place++)
		fill_directions(cells, place);
	return 0;
}

void cells_free(struct cells *cells)
{
	free(cells->order);
	free(cells->node);
	free(cells->sr);
	free(cells->share);
	free(cells->shown);
	free(cells->reach);
	free(cells->uniform);
	free(cells->ground);
	*cells = (struct cells){.count = 0};
}
