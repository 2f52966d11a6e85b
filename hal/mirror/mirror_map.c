/* SPDX-License-Identifier: MIT */
#include "hal/mirror/mirror_map.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>

#include "hal/optics/dome.h"
#include "hal/optics/sky_square.h"

/* ---- creation ---- */

static int side_of(int level)
{
	return BASIS_MIRROR_SIDE >> level;
}

/* Fills directions' cells and solid angles. */
static void fill_texels(struct mirror_map *map, const struct dome *dome)
{
	for (int at = 0; at < MIRROR_TEXELS; at++) {
		const double place[2] = {(at % BASIS_MIRROR_SIDE + 0.5) / BASIS_MIRROR_SIDE,
					 (at / BASIS_MIRROR_SIDE + 0.5) / BASIS_MIRROR_SIDE};
		double d[3];

		map->texel_sr[at] = sky_square_direction(place, d) / MIRROR_TEXELS;
		map->cell[at] = (uint16_t)dome_cell_of(dome, d);
	}
}

/* Fills the shares of a level. sr[2 * side][2 * side] becomes [side][side], its solid angles. */
static void fill_shares(uint16_t (*share)[4], double *sr, int side)
{
	for (int at = 0; at < side * side; at++) {
		const double *part = sr + (size_t)4 * (size_t)(at / side * side) + 2 * (at % side);
		const double parts[4] = {part[0], part[1], part[2 * side], part[2 * side + 1]};
		const double sum = parts[0] + parts[1] + parts[2] + parts[3];
		int left = 65536;

		for (int k = 0; k < 3; k++) {
			share[at][k] = (uint16_t)lrint(65536 * parts[k] / sum);
			left -= share[at][k];
		}
		share[at][3] = (uint16_t)left;
		sr[at] = sum;
	}
}

static int allocate(struct mirror_map *map, double **sr)
{
	size_t texels = 0;

	for (int l = 0; l < BASIS_MIRROR_LEVELS; l++)
		texels += (size_t)side_of(l) * (size_t)side_of(l);
	*sr = malloc(MIRROR_TEXELS * sizeof(**sr));
	map->texel_sr = malloc(MIRROR_TEXELS * sizeof(*map->texel_sr));
	map->cell = malloc(MIRROR_TEXELS * sizeof(*map->cell));
	map->texel[0] = calloc(texels, sizeof(*map->texel[0]));
	map->share[1] = calloc(texels - MIRROR_TEXELS, sizeof(*map->share[1]));
	if (!*sr || !map->texel_sr || !map->cell || !map->texel[0] || !map->share[1])
		return -ENOMEM;
	for (int l = 1; l < BASIS_MIRROR_LEVELS; l++) {
		const size_t before = (size_t)side_of(l - 1) * (size_t)side_of(l - 1);

		map->texel[l] = map->texel[l - 1] + before;
		if (l > 1)
			map->share[l] = map->share[l - 1] + before;
	}
	return 0;
}

int mirror_map_create(struct mirror_map *map, const struct basis *basis, struct fault *fault)
{
	const int stride = (int)(sizeof(*basis->lights) / sizeof(double));
	double *sr = NULL;
	struct dome dome;
	int ret;

	*map = (struct mirror_map){.cell = NULL};
	ret = dome_create_nodes(&dome, basis->lights->direction, stride, (int)basis->info.lights,
				(int)basis->info.dome_frequency, fault);
	if (ret < 0)
		return ret;
	ret = allocate(map, &sr);
	if (ret == 0) {
		fill_texels(map, &dome);
		for (int at = 0; at < MIRROR_TEXELS; at++)
			sr[at] = map->texel_sr[at];
		for (int l = 1; l < BASIS_MIRROR_LEVELS; l++)
			fill_shares(map->share[l], sr, side_of(l));
	} else {
		mirror_map_free(map);
		fault_say(fault, ret, "not enough memory for mirrors");
	}
	free(sr);
	dome_free(&dome);
	return ret;
}

void mirror_map_free(struct mirror_map *map)
{
	free(map->texel[0]);
	free(map->share[1]);
	free(map->texel_sr);
	free(map->cell);
	*map = (struct mirror_map){.cell = NULL};
}

/* ---- filling ---- */

uint32_t mirror_texel_of(double light)
{
	const double texel = ldexp(light, MIRROR_ONE_BITS);

	return texel > 0 ? (uint32_t)fmin(floor(texel + 0.5), UINT32_MAX) : 0;
}

void mirror_map_fill(struct mirror_map *map, const double (*radiance)[3], const double more[3])
{
	for (int at = 0; at < MIRROR_TEXELS; at++)
		for (int c = 0; c < 3; c++)
			map->texel[0][at].light[c] =
				mirror_texel_of(radiance[map->cell[at]][c] + more[c]);
	mirror_map_finish(map);
}

void mirror_map_finish(struct mirror_map *map)
{
	for (int l = 1; l < BASIS_MIRROR_LEVELS; l++) {
		const int side = side_of(l);

		for (int at = 0; at < side * side; at++) {
			const struct mirror_texel *part =
				map->texel[l - 1] + (size_t)4 * (size_t)(at / side * side) +
				2 * (at % side);
			const uint16_t *share = map->share[l][at];

			for (int c = 0; c < 4; c++)
				map->texel[l][at].light[c] =
					(uint32_t)(((uint64_t)part[0].light[c] * share[0] +
						    (uint64_t)part[1].light[c] * share[1] +
						    (uint64_t)part[2 * side].light[c] * share[2] +
						    (uint64_t)part[2 * side + 1].light[c] *
							    share[3] +
						    32768) >>
						   16);
		}
	}
}

/* ---- looking ---- */

/* The two texels of a row or column that a place lies between, and the share of the second. */
struct between {
	int first, second;
	uint32_t share; /* 256 = 1 */
};

static inline struct between between_texels(uint32_t place, int side)
{
	const int at = (int)((place * (uint32_t)side) >> 8) - 128; /* in 1/256 texels */
	const int first = at >> 8;

	return (struct between){first < 0 ? 0 : first, first + 1 < side ? first + 1 : side - 1,
				(uint32_t)at & 255};
}

/* Adds weight times the light between four texels; 65536 * weight = 1. */
static inline void look_level(const struct mirror_map *map, int level,
			      const struct basis_mirror *m, uint64_t weight, uint64_t light[3])
{
	const int side = side_of(level);
	const struct between u = between_texels(m->u, side), v = between_texels(m->v, side);
	const struct mirror_texel *row[2] = {map->texel[level] + (size_t)(v.first * side),
					     map->texel[level] + (size_t)(v.second * side)};
	const uint64_t part[2][2] = {
		{weight * ((256 - v.share) * (256 - u.share)), weight * ((256 - v.share) * u.share)},
		{weight * (v.share * (256 - u.share)), weight * (v.share * u.share)}};

	for (int c = 0; c < 3; c++)
		light[c] += part[0][0] * row[0][u.first].light[c] +
			    part[0][1] * row[0][u.second].light[c] +
			    part[1][0] * row[1][u.first].light[c] +
			    part[1][1] * row[1][u.second].light[c];
}

void mirror_map_look(const struct mirror_map *map, const struct basis_mirror *m, uint64_t light[3])
{
	const int level = m->level / BASIS_MIRROR_STEP;
	const uint32_t next = m->level % BASIS_MIRROR_STEP;

	light[0] = light[1] = light[2] = 0;
	look_level(map, level, m, BASIS_MIRROR_STEP - next, light);
	if (next)
		look_level(map, level + 1, m, next, light);
}
