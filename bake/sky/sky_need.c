/* SPDX-License-Identifier: MIT */
#include "bake/sky/sky_need.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define SUBSAMPLES 3 /* samples along each side of a panorama's texel */
#define COSINE 0.05  /* least: light along the ground still reaches what stands on it */

void sky_need_free(struct sky_need *need)
{
	for (int l = 0; l < need->levels; l++) {
		dome_free(&need->level[l]);
		free(need->cell[l]);
	}
	free(need->even);
	free(need->share);
	free(need->moved);
	free(need->irradiance);
	free(need->now);
	free(need->sum);
	*need = (struct sky_need){.levels = 0};
}

static int need_levels(struct sky_need *need, int frequency, struct fault *fault)
{
	int err = 0;

	for (int f = frequency; !err && (f <= DOME_FREQUENCY_MAX || f == frequency); f *= 2)
		err = dome_create(&need->level[need->levels++], f, fault);
	return err;
}

static int need_pieces(struct sky_need *need)
{
	const struct dome *last = sky_need_pieces(need);
	const size_t pieces = (size_t)last->count, cells = (size_t)need->level[0].count;

	need->even = calloc(pieces, sizeof(*need->even));
	need->share = calloc(pieces, sizeof(*need->share));
	need->irradiance = calloc(pieces, sizeof(*need->irradiance));
	need->sum = calloc(pieces, sizeof(*need->sum));
	need->moved = calloc(cells, sizeof(*need->moved));
	need->now = calloc(cells, sizeof(*need->now));
	if (!need->even || !need->share || !need->irradiance || !need->sum || !need->moved ||
	    !need->now)
		return -ENOMEM;
	for (int l = 0; l < need->levels; l++) {
		need->cell[l] = calloc(pieces, sizeof(*need->cell[l]));
		if (!need->cell[l])
			return -ENOMEM;
		for (int i = 0; i < last->count; i++)
			need->cell[l][i] = dome_cell_of(&need->level[l], last->direction[i]);
	}
	for (int i = 0; i < last->count; i++)
		need->even[i] = last->solid_angle_sr[i] * fmax(last->direction[i][2], COSINE);
	return 0;
}

int sky_need_create(struct sky_need *need, int frequency, struct fault *fault)
{
	int err;

	*need = (struct sky_need){.levels = 0};
	err = need_levels(need, frequency, fault);
	if (!err && need_pieces(need))
		err = fault_say(fault, -ENOMEM, "not enough memory for the sky");
	if (err)
		sky_need_free(need);
	return err;
}

const struct dome *sky_need_pieces(const struct sky_need *need)
{
	return &need->level[need->levels - 1];
}

/* Adds m of each cell at a level to now. */
static void need_compare(struct sky_need *need, int l, double all)
{
	const int pieces = sky_need_pieces(need)->count;
	const double spacing = SKY_SPACING_RAD / need->level[l].frequency;

	memset(need->sum, 0, (size_t)need->level[l].count * sizeof(*need->sum));
	for (int i = 0; i < pieces; i++) {
		double *const s = need->sum[need->cell[l][i]];

		s[0] += need->irradiance[i];
		s[1] += need->even[i];
	}
	for (int i = 0; i < pieces; i++) {
		const double *const s = need->sum[need->cell[l][i]];
		const double mean = s[0] / s[1] * need->even[i];

		need->now[need->cell[0][i]][l] += 0.5 * fabs(need->irradiance[i] - mean) / all *
						  spacing;
	}
}

void sky_need_add(struct sky_need *need, double least)
{
	const int pieces = sky_need_pieces(need)->count, cells = need->level[0].count;
	double all = 0;

	for (int i = 0; i < pieces; i++)
		all += need->irradiance[i];
	all = fmax(all, least);
	if (!(all > 0))
		return;
	memset(need->now, 0, (size_t)cells * sizeof(*need->now));
	for (int l = 0; l < need->levels; l++)
		need_compare(need, l, all);
	for (int i = 0; i < cells; i++)
		for (int l = 0; l < need->levels; l++)
			need->moved[i][l] = fmax(need->moved[i][l], need->now[i][l]);
	for (int i = 0; i < pieces; i++)
		need->share[i] = fmax(need->share[i], need->irradiance[i] / all);
}

void sky_need_add_panorama(struct sky_need *need, const struct panorama *panorama)
{
	const struct image *image = panorama->image;
	const struct dome *last = sky_need_pieces(need);

	memset(need->irradiance, 0, (size_t)last->count * sizeof(*need->irradiance));
	for (int y = 0; y < (image->height + 1) / 2 * SUBSAMPLES; y++) {
		const double sr = panorama_row_sr(panorama, y / SUBSAMPLES) / image->width /
				  (SUBSAMPLES * SUBSAMPLES);

		for (int x = 0; x < image->width * SUBSAMPLES; x++) {
			double d[3], rgb[3];
			int piece;

			panorama_direction(panorama, (x + 0.5) / SUBSAMPLES, (y + 0.5) / SUBSAMPLES,
					   d);
			piece = dome_cell_of(last, d);
			if (piece < 0)
				continue;
			panorama_radiance(panorama, d, rgb);
			need->irradiance[piece] += (rgb[0] + rgb[1] + rgb[2]) / 3 *
						   fmax(d[2], COSINE) * sr;
		}
	}
	sky_need_add(need, 0);
}
