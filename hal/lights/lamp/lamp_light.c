/* SPDX-License-Identifier: MIT */
#include "hal/lights/lamp/lamp_light.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "hal/optics/vec.h"

/* A lamp may be so far from where it is said to be: 5 cm at 2 m. */
#define OFF_RAD 0.026

/* Points of a lamp's disc: a spiral, each turned by the golden angle against the one before. */
enum { DISC_POINTS = 64, TERMS = 3 };
#define GOLDEN_RAD 2.39996

/* Light beside a lamp is taken as a tenth of its own, and a lamp as OFF_RAD off: with the terms in
 * these units, by how much the sum of squares grows with the square of the last two. */
#define PRIOR 0.01
/* The sampler shares out the light of a lamp in several cells as the shares here do to a tenth: a
 * lamp of 1.7 degrees on cells of 1.8. */
#define MOST_OF_FIT 1.1
#define LEAST 1e-9 /* a lamp of no cell has no power */

/* A cell's light is shared with cells whose node is at most a spacing away, 1.73 times the reach of
 * the cells of a hexagonal net; this has some room. The surroundings are two rows of cells more. */
#define SHARED 1.9
#define AROUND 5.4
/* So many tell their median well, and qsort() takes no memory for them. */
#define AROUND_MOST 250

struct lamp_cells {
	int *cell; /* the lamp's, then those around it */
	int own, around;
	double (*share)[TERMS];	 /* [own]: b, OFF_RAD db/du, OFF_RAD db/dv */
	double (*fitted)[TERMS]; /* [own]: the terms are the sum of fitted x */
	float *excess;		 /* [own] */
};

struct lamp_light {
	const struct dome *dome; /* borrowed, as placed */
	const struct dome_placed *placed;
	int lamps;
	struct lamp_cells cells[LAMPS_MAX];
	int *owner; /* [lights]: the lamp that a cell belongs to; -1: none */
	float sorted[AROUND_MOST];
};

/* How far a cell's node is from the disc of a lamp in a direction (unit), as a multiple of the
 * cell's reach. */
static double apart_from(const struct dome *dome, int cell, const double direction[3],
			 double radius_rad)
{
	const double off = vec_angle(dome->direction[cell], direction) - radius_rad - OFF_RAD;

	return off / dome_cell_reach_rad(dome, cell);
}

bool lamp_light_seen(const struct lamps *lamps, int lamp, double direction[3], double *radius_rad)
{
	double distance;

	for (int k = 0; k < 3; k++)
		direction[k] = lamps->lamp[lamp].position[k] - lamps->fisheye[k];
	distance = vec_normalize(direction);
	*radius_rad = asin(fmin(lamps->lamp[lamp].radius / distance, 1));
	return distance > 0 && direction[2] > 0;
}

/* Finds the lamp that each cell belongs to: the nearest; -1: none. */
static void find_owners(const struct dome *dome, const struct lamps *lamps, int *owner)
{
	for (int i = 0; i < dome->count; i++) {
		double least = SHARED;

		owner[i] = -1;
		for (int l = 0; l < lamps->count; l++) {
			double direction[3], radius;
			const double apart = lamp_light_seen(lamps, l, direction, &radius)
						     ? apart_from(dome, i, direction, radius)
						     : INFINITY;

			if (apart < least) {
				least = apart;
				owner[i] = l;
			}
		}
	}
}

/* ---- what a lamp gives its cells ---- */

/*
 * Adds to share[k][term] a multiple of what the cells get of a disc of this radius around dir. As
 * the sampler does, the light in a cell is shared from its centroid.
 */
static void add_disc(struct lamp_cells *cells, const struct dome *dome,
		     const struct dome_placed *placed, const double dir[3], double radius_rad,
		     int term, double multiple)
{
	double point[DISC_POINTS][3], across[2][3];
	int cell[DISC_POINTS], facet = -1;

	vec_across(dir, across);
	for (int n = 0; n < DISC_POINTS; n++) {
		const double out = sin(radius_rad) * sqrt((n + 0.5) / DISC_POINTS);

		for (int k = 0; k < 3; k++)
			point[n][k] = dir[k] + out * (cos(GOLDEN_RAD * n) * across[0][k] +
						      sin(GOLDEN_RAD * n) * across[1][k]);
		point[n][2] = fmax(point[n][2], 0);
		vec_normalize(point[n]);
		cell[n] = dome_cell_of(dome, point[n]);
	}
	for (int n = 0; n < DISC_POINTS; n++) {
		double at[3] = {0}, weight[3];
		int to[3], points = 0, count;

		for (int m = n; m < DISC_POINTS; m++) {
			if (cell[m] != cell[n] || cell[n] < 0)
				continue;
			for (int k = 0; k < 3; k++)
				at[k] += point[m][k];
			points++;
			cell[m] = m > n ? -1 : cell[m];
		}
		vec_normalize(at);
		if (placed && points) {
			count = dome_placed_share(placed, cell[n], &facet, at, to, weight);
		} else {
			count = points > 0;
			to[0] = cell[n];
			weight[0] = 1;
		}
		for (int k = 0; k < cells->own; k++)
			for (int m = 0; m < count; m++)
				if (cells->cell[k] == to[m])
					cells->share[k][term] += multiple * weight[m] * points /
								 DISC_POINTS;
	}
}

static void add_shares(struct lamp_cells *cells, const struct dome *dome,
		       const struct dome_placed *placed, const double dir[3], double radius_rad)
{
	double across[2][3];

	add_disc(cells, dome, placed, dir, radius_rad, 0, 1);
	vec_across(dir, across);
	for (int n = 0; n < 4; n++) {
		double off[3];

		for (int k = 0; k < 3; k++)
			off[k] = dir[k] + (n % 2 ? -OFF_RAD : OFF_RAD) * across[n / 2][k];
		vec_normalize(off);
		add_disc(cells, dome, placed, off, radius_rad, 1 + n / 2, n % 2 ? -0.5 : 0.5);
	}
}

/* fitted = (B'B + prior)^-1 B' */
static void solve_terms(struct lamp_cells *cells)
{
	double normal[TERMS][TERMS] = {{LEAST}, {0, PRIOR}, {0, 0, PRIOR}}, row[TERMS];

	for (int a = 0; a < TERMS * TERMS; a++)
		for (int k = 0; k < cells->own; k++)
			normal[a / TERMS][a % TERMS] += cells->share[k][a / TERMS] *
							cells->share[k][a % TERMS];
	for (int a = 0; a < TERMS; a++) {
		/* a row of the inverse of a symmetric matrix */
		vec_cross(normal[(a + 1) % TERMS], normal[(a + 2) % TERMS], row);
		for (int k = 0; k < cells->own; k++)
			cells->fitted[k][a] = vec_dot(row, cells->share[k]) /
					      vec_dot(row, normal[a]);
	}
}

static void list_cells(struct lamp_cells *cells, const struct dome *dome,
		       const struct dome_placed *placed, const struct lamps *lamps, int lamp,
		       const int *owner)
{
	double direction[3], radius;

	cells->own = cells->around = 0;
	if (!lamp_light_seen(lamps, lamp, direction, &radius))
		return;
	for (int i = 0; i < dome->count; i++)
		if (owner[i] == lamp)
			cells->cell[cells->own++] = i;
	memset(cells->share, 0, sizeof(*cells->share) * (size_t)cells->own);
	add_shares(cells, dome, placed, direction, radius);
	for (int i = 0; i < dome->count && cells->around < AROUND_MOST; i++)
		if (owner[i] < 0 && apart_from(dome, i, direction, radius) < AROUND)
			cells->cell[cells->own + cells->around++] = i;
	solve_terms(cells);
}

void lamp_light_aim(struct lamp_light *light, const struct lamps *lamps)
{
	find_owners(light->dome, lamps, light->owner);
	for (int l = 0; l < light->lamps; l++)
		list_cells(&light->cells[l], light->dome, light->placed, lamps, l, light->owner);
}

int lamp_light_create(struct lamp_light **out, const struct dome *dome,
		      const struct dome_placed *placed, const struct lamps *lamps)
{
	const size_t n = (size_t)dome->count;
	struct lamp_light *light = calloc(1, sizeof(*light));
	bool whole;

	*out = NULL;
	if (!light)
		return -ENOMEM;
	light->dome = dome;
	light->placed = placed;
	light->lamps = lamps->count;
	light->owner = calloc(n, sizeof(*light->owner));
	whole = light->owner;
	for (int l = 0; l < lamps->count; l++) {
		struct lamp_cells *cells = &light->cells[l];

		cells->cell = calloc(n, sizeof(*cells->cell));
		cells->share = calloc(n, sizeof(*cells->share));
		cells->fitted = calloc(n, sizeof(*cells->fitted));
		cells->excess = calloc(n, sizeof(*cells->excess));
		whole = whole && cells->cell && cells->share && cells->fitted && cells->excess;
	}
	if (!whole) {
		lamp_light_destroy(light);
		return -ENOMEM;
	}
	lamp_light_aim(light, lamps);
	*out = light;
	return 0;
}

void lamp_light_destroy(struct lamp_light *light)
{
	if (!light)
		return;
	for (int l = 0; l < light->lamps; l++) {
		free(light->cells[l].cell);
		free(light->cells[l].share);
		free(light->cells[l].fitted);
		free(light->cells[l].excess);
	}
	free(light->owner);
	free(light);
}

static int compare_floats(const void *a, const void *b)
{
	const float x = *(const float *)a, y = *(const float *)b;

	return (x > y) - (x < y);
}

static float median_around(struct lamp_light *light, const struct lamp_cells *cells,
			   const float (*radiance)[3], int c)
{
	const int n = cells->around;

	if (!n)
		return 0;
	for (int k = 0; k < n; k++)
		light->sorted[k] = radiance[cells->cell[cells->own + k]][c];
	qsort(light->sorted, (size_t)n, sizeof(*light->sorted), compare_floats);
	return (light->sorted[(n - 1) / 2] + light->sorted[n / 2]) / 2;
}

/* Returns P of a channel. */
static double take_lamp(struct lamp_light *light, const struct lamp_cells *cells,
			float (*radiance)[3], int c)
{
	const float around = median_around(light, cells, (const float(*)[3])radiance, c);
	double fit[TERMS] = {0}, power = 0;

	for (int k = 0; k < cells->own; k++) {
		const int i = cells->cell[k];

		cells->excess[k] = fmaxf(radiance[i][c] - around, 0);
		for (int a = 0; a < TERMS; a++)
			fit[a] += cells->fitted[k][a] * light->dome->solid_angle_sr[i] *
				  (double)cells->excess[k];
	}
	for (int k = 0; k < cells->own; k++) {
		const int i = cells->cell[k];
		const double expected = MOST_OF_FIT * vec_dot(fit, cells->share[k]) /
					light->dome->solid_angle_sr[i];
		const double taken = fmin(fmax(expected, 0), (double)cells->excess[k]);

		power += light->dome->solid_angle_sr[i] * taken;
		radiance[i][c] -= (float)taken;
	}
	return power;
}

void lamp_light_take(struct lamp_light *light, float (*radiance)[3], double (*power)[3])
{
	for (int l = 0; l < light->lamps; l++)
		for (int c = 0; c < 3; c++)
			power[l][c] = take_lamp(light, &light->cells[l], radiance, c);
}
