/* SPDX-License-Identifier: MIT */
#include "hal/mirror/mirror_look.h"

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

	for (int l = 1; l < BASIS_MIRROR_LEVELS; l++)
		texels += (size_t)side_of(l) * (size_t)side_of(l);
	*sr = malloc(MIRROR_TEXELS * sizeof(**sr));
	map->texel_sr = malloc(MIRROR_TEXELS * sizeof(*map->texel_sr));
	map->cell = malloc(MIRROR_TEXELS * sizeof(*map->cell));
	map->texel = make_colours((BASIS_MIRROR_SIDE + 1) * (size_t)MIRROR_STRIDE);
	map->span = calloc(2 * BASIS_MIRROR_SIDE, sizeof(*map->span));
	map->share[1] = make_colours(texels);
	if (!*sr || !map->texel_sr || !map->cell || !map->texel || !map->span || !map->share[1])
		return -ENOMEM;
	for (int l = 2; l < BASIS_MIRROR_LEVELS; l++)
		map->share[l] = map->share[l - 1] + (size_t)side_of(l - 1) * (size_t)side_of(l - 1);
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
		for (int l = 0; l < BASIS_MIRROR_LEVELS; l++)
			for (int y = 0; y < side_of(l); y++)
				mirror_spans(map, l)[y].end = (uint16_t)side_of(l);
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
	free(map->texel);
	free(map->span);
	free(map->share[1]);
	free(map->texel_sr);
	free(map->cell);
	*map = (struct mirror_map){.cell = NULL};
}

/* ---- what is filled ---- */

static void widen_span(struct mirror_span *span, int first, int end)
{
	const bool none = span->first == span->end;

	span->first = (uint16_t)(none || first < span->first ? first : span->first);
	span->end = (uint16_t)(none || end > span->end ? end : span->end);
}

static void read_look(struct mirror_map *map, int least, const struct basis_mirror *m)
{
	struct mirror_place place[2];

	mirror_look_places(m, least, place);
	for (int k = 0; k < 2; k++) {
		const struct mirror_place *p = &place[k];
		struct mirror_span *span = mirror_spans(map, p->level) + p->y;

		for (int y = 0; y <= (p->down > 0); y++)
			widen_span(&span[y], p->x, p->x + 1 + (p->right > 0));
	}
}

/* Whether a texel counts in the one that it is a part of. */
static bool texel_weighs(const struct mirror_map *map, int level, int x, int y)
{
	const int whole = y / 2 * side_of(level + 1) + x / 2;

	return map->share[level + 1][whole][y % 2 * 2 + x % 2] > 0;
}

/* Widens the spans of a level's parts, but for those without weight at the ends. */
static void read_parts(struct mirror_map *map, int level)
{
	for (int y = 0; y < 2 * side_of(level); y++) {
		const struct mirror_span *whole = &mirror_spans(map, level)[y / 2];
		int first = 2 * whole->first, end = 2 * whole->end;

		while (first < end && !texel_weighs(map, level - 1, first, y))
			first++;
		while (first < end && !texel_weighs(map, level - 1, end - 1, y))
			end--;
		if (first < end)
			widen_span(&mirror_spans(map, level - 1)[y], first, end);
	}
}

void mirror_map_limit(struct mirror_map *map, int least, const struct basis *basis, const int *pose,
		      int poses)
{
	memset(map->span, 0, 2 * BASIS_MIRROR_SIDE * sizeof(*map->span));
	for (int k = 0; k < poses; k++)
		for (size_t i = 0; i < basis->poses[pose[k]].mirror_count; i++)
			read_look(map, least, &basis->poses[pose[k]].mirror[i]);
	for (int l = BASIS_MIRROR_LEVELS - 1; l > least; l--)
		read_parts(map, l);
}

/* ---- filling ---- */

void mirror_map_fill(struct mirror_map *map, const double (*radiance)[3], const double more[3])
{
	map->least = MIRROR_LIGHTS_LEVEL;
	for (int y = 0; y < side_of(map->least); y++) {
		const struct mirror_span span = mirror_spans(map, map->least)[y];
		mirror_light *row = mirror_texels(map, map->least) + y * MIRROR_STRIDE;

		for (int x = span.first; x < span.end; x++) {
			const double *light = radiance[mirror_cell(map, map->least, x, y)];

			for (int c = 0; c < 3; c++)
				row[x][c] = (float)(light[c] + more[c]);
			row[x] = mirror_clamp(row[x]);
		}
	}
	mirror_map_finish(map);
}

void mirror_map_finish(struct mirror_map *map)
{
	for (int l = map->least + 1; l < BASIS_MIRROR_LEVELS; l++)
		for (int y = 0; y < side_of(l); y++) {
			const struct mirror_span span = mirror_spans(map, l)[y];
			const mirror_light *share = map->share[l] + y * side_of(l);
			const mirror_light *part = mirror_texels(map, l - 1) +
						   2 * y * MIRROR_STRIDE;
			const mirror_light *below = part + MIRROR_STRIDE;
			mirror_light *row = mirror_texels(map, l) + y * MIRROR_STRIDE;

			for (int x = span.first; x < span.end; x++)
				row[x] = (part[2 * x] * share[x][0] +
					  part[2 * x + 1] * share[x][1]) +
					 (below[2 * x] * share[x][2] +
					  below[2 * x + 1] * share[x][3]);
		}
}
