/* SPDX-License-Identifier: MIT */
#include "hal/mirror/mirror_map.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

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
static void fill_shares(mirror_light *share, double *sr, int side)
{
	for (int at = 0; at < side * side; at++) {
		const double *part = sr + (size_t)4 * (size_t)(at / side * side) + 2 * (at % side);
		const double parts[4] = {part[0], part[1], part[2 * side], part[2 * side + 1]};
		const double sum = parts[0] + parts[1] + parts[2] + parts[3];

		for (int k = 0; k < 4; k++)
			share[at][k] = sum > 0 ? (float)(parts[k] / sum) : 0.25F;
		sr[at] = sum;
	}
}

/* Returns zeroed memory for so many colours, aligned for the processor. */
static mirror_light *make_colours(size_t count)
{
	mirror_light *colours = aligned_alloc(64, (count * sizeof(*colours) + 63) / 64 * 64);

	return colours ? memset(colours, 0, count * sizeof(*colours)) : NULL;
}

static int allocate(struct mirror_map *map, double **sr)
{
	size_t texels = 0;

	for (int l = 0; l < BASIS_MIRROR_LEVELS; l++)
		texels += (size_t)side_of(l) * (size_t)side_of(l);
	*sr = malloc(MIRROR_TEXELS * sizeof(**sr));
	map->texel_sr = malloc(MIRROR_TEXELS * sizeof(*map->texel_sr));
	map->cell = malloc(MIRROR_TEXELS * sizeof(*map->cell));
	map->texel[0] = make_colours(texels);
	map->share[1] = make_colours(texels - MIRROR_TEXELS);
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

/* Its texels have 1 to 2 degrees; cells are several times as wide. */
#define LIGHTS_LEVEL 2

void mirror_map_fill(struct mirror_map *map, const double (*radiance)[3], const double more[3])
{
	map->least = LIGHTS_LEVEL;
	for (int at = 0; at < MIRROR_TEXELS >> 2 * LIGHTS_LEVEL; at++) {
		const double *of = radiance[mirror_cell(map, LIGHTS_LEVEL, at)];

		for (int c = 0; c < 3; c++)
			map->texel[LIGHTS_LEVEL][at][c] = mirror_clamp((float)(of[c] + more[c]));
	}
	mirror_map_finish(map);
}

void mirror_map_finish(struct mirror_map *map)
{
	for (int l = map->least + 1; l < BASIS_MIRROR_LEVELS; l++) {
		const int side = side_of(l);

		for (int at = 0; at < side * side; at++) {
			const mirror_light *part = map->texel[l - 1] +
						   (size_t)4 * (size_t)(at / side * side) +
						   2 * (at % side);
			const mirror_light share = map->share[l][at];

			map->texel[l][at] =
				(part[0] * share[0] + part[1] * share[1]) +
				(part[2 * side] * share[2] + part[2 * side + 1] * share[3]);
		}
	}
}

/* ---- looking ---- */

/* The two texels of a row or column that a place lies between, and the share of the second. */
struct between {
	int first, second;
	float share;
};

static inline struct between between_texels(uint32_t place, int level)
{
	/* in 1/2^16 texels */
	const int at = (int)(place << (BASIS_MIRROR_BITS - level)) - 32768;
	const int first = at >> 16, last = side_of(level) - 1;

	return (struct between){first < 0 ? 0 : first, first < last ? first + 1 : last,
				(float)(at & 65535) * 0x1p-16F};
}

static inline mirror_light look_level(const struct mirror_map *map, int level,
				      const struct basis_mirror *m)
{
	const struct between u = between_texels(m->u, level), v = between_texels(m->v, level);
	const mirror_light *upper = map->texel[level] + (v.first << (BASIS_MIRROR_BITS - level));
	const mirror_light *lower = map->texel[level] + (v.second << (BASIS_MIRROR_BITS - level));
	const mirror_light above = upper[u.first] * (1 - u.share) + upper[u.second] * u.share;
	const mirror_light below = lower[u.first] * (1 - u.share) + lower[u.second] * u.share;

	return above * (1 - v.share) + below * v.share;
}

mirror_light mirror_map_look(const struct mirror_map *map, const struct basis_mirror *m)
{
	const int least = map->least * BASIS_MIRROR_STEP;
	const int steps = m->level > least ? m->level : least, level = steps / BASIS_MIRROR_STEP;
	const float next = (float)(steps % BASIS_MIRROR_STEP) * (1.0F / BASIS_MIRROR_STEP);

	if (next == 0) /* the last level, and the sharpest mirrors */
		return look_level(map, level, m);
	return look_level(map, level, m) * (1 - next) + look_level(map, level + 1, m) * next;
}
