/* SPDX-License-Identifier: MIT */
/* Integrates the studio's radiance over each light of a dome. */
#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "tests/support/studio_lights.h"

/*
 * The sky is divided into tiles of polar angle and azimuth, at most 0.35 degrees wide. If the
 * radiance at the four corners is nearly equal, their mean stands for the tile; otherwise the tile
 * is sampled FINE x FINE times. The corners suffice, because every emitter is far larger than a
 * tile. A tile that spans several Voronoi cells is divided among them by fine samples.
 */
enum { RINGS = 256, SECTORS = 1024, FINE = 10 };

struct studio_sight {
	int cell;
	double rgb[3];
};

struct light_integral {
	const struct dome *dome;
	const double *origin;
	const struct studio_lamps *lamps;
	double (*radiance)[3]; /* weighted sums, for each light */
	double *weights;       /* sums of the weights, sr */
};

static void polar_direction(double theta, double phi, double dir[3])
{
	dir[0] = sin(theta) * cos(phi);
	dir[1] = sin(theta) * sin(phi);
	dir[2] = fmax(cos(theta), 0); /* rounding must not put the horizon below 0 */
}

static void sight_look(const struct light_integral *in, double theta, double phi,
		       struct studio_sight *sight)
{
	double dir[3];

	polar_direction(theta, phi, dir);
	sight->cell = dome_cell_of(in->dome, dir);
	studio_radiance(in->origin, dir, in->lamps, sight->rgb);
}

static void integral_add(struct light_integral *in, int cell, const double rgb[3], double weight)
{
	if (cell < 0)
		return;
	for (int c = 0; c < 3; c++)
		in->radiance[cell][c] += weight * rgb[c];
	in->weights[cell] += weight;
}

static bool same_light(const struct studio_sight corners[4])
{
	for (int i = 1; i < 4; i++)
		for (int c = 0; c < 3; c++)
			if (fabs(corners[i].rgb[c] - corners[0].rgb[c]) > 0.02)
				return false;
	return true;
}

static bool same_cell(const struct studio_sight corners[4])
{
	return corners[0].cell == corners[1].cell && corners[0].cell == corners[2].cell &&
	       corners[0].cell == corners[3].cell;
}

static void add_finely(struct light_integral *in, const struct studio_sight corners[4], int ring,
		       int sector, const double mean[3])
{
	const double height = M_PI / 2 / RINGS / FINE, width = 2 * M_PI / SECTORS / FINE;
	const bool smooth = same_light(corners);
	const bool whole = same_cell(corners);

	for (int i = 0; i < FINE; i++) {
		const double theta = (ring * FINE + i + 0.5) * height;
		const double weight = (cos(theta - height / 2) - cos(theta + height / 2)) * width;

		for (int j = 0; j < FINE; j++) {
			const double phi = (sector * FINE + j + 0.5) * width;
			double dir[3], rgb[3];

			polar_direction(theta, phi, dir);
			if (!smooth)
				studio_radiance(in->origin, dir, in->lamps, rgb);
			integral_add(in, whole ? corners[0].cell : dome_cell_of(in->dome, dir),
				     smooth ? mean : rgb, weight);
		}
	}
}

static void integral_add_tile(struct light_integral *in, const struct studio_sight corners[4],
			      int ring, int sector)
{
	const double height = M_PI / 2 / RINGS, width = 2 * M_PI / SECTORS;
	const double weight = (cos(ring * height) - cos((ring + 1) * height)) * width;
	double mean[3];

	for (int c = 0; c < 3; c++)
		mean[c] = (corners[0].rgb[c] + corners[1].rgb[c] + corners[2].rgb[c] +
			   corners[3].rgb[c]) /
			  4;
	if (same_cell(corners) && same_light(corners))
		integral_add(in, corners[0].cell, mean, weight);
	else
		add_finely(in, corners, ring, sector, mean);
}

static void look_along_ring(const struct light_integral *in, int ring, struct studio_sight *sights)
{
	for (int sector = 0; sector <= SECTORS; sector++)
		sight_look(in, ring * M_PI / 2 / RINGS, sector * 2 * M_PI / SECTORS,
			   &sights[sector]);
}

int studio_lights(const struct dome *dome, const double origin[3], const struct studio_lamps *lamps,
		  double (*radiance)[3])
{
	struct light_integral in = {dome, origin, lamps, radiance, NULL};
	struct studio_sight *above = calloc(2 * (SECTORS + 1), sizeof(*above));
	struct studio_sight *below = above ? above + SECTORS + 1 : NULL;
	int err = 0;

	in.weights = calloc((size_t)dome->count, sizeof(*in.weights));
	if (!above || !in.weights) {
		err = -ENOMEM;
		goto out;
	}
	memset(radiance, 0, (size_t)dome->count * sizeof(*radiance));
	look_along_ring(&in, 0, above);
	for (int ring = 0; ring < RINGS; ring++) {
		look_along_ring(&in, ring + 1, below);
		for (int s = 0; s < SECTORS; s++) {
			const struct studio_sight corners[4] = {above[s], above[s + 1], below[s],
								below[s + 1]};

			integral_add_tile(&in, corners, ring, s);
		}
		memcpy(above, below, (SECTORS + 1) * sizeof(*above));
	}
	for (int i = 0; i < dome->count; i++)
		for (int c = 0; c < 3; c++)
			radiance[i][c] /= in.weights[i] > 0 ? in.weights[i] : 1;
out:
	free(above);
	free(in.weights);
	return err;
}
