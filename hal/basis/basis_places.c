/* SPDX-License-Identifier: MIT */
#include "hal/basis/basis_places.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <zstd.h>

#define LEVEL 9 /* of zstd; higher ones make a depth map 1 % smaller */

/* The sum of the left and upper neighbour less the one between them: a plane's 1 / distance changes
 * evenly over the picture. Outside it is 0. */
static uint16_t expected(const uint16_t *map, int width, int x, int y)
{
	const uint16_t *at = map + (size_t)y * (size_t)width + x;
	const uint16_t left = x ? at[-1] : 0, up = y ? at[-width] : 0;

	return (uint16_t)(left + up - (x && y ? at[-width - 1] : 0));
}

/* ---- reading ---- */

bool basis_has_places(const struct basis *basis, int pose)
{
	return basis->poses[pose].places != NULL;
}

int basis_find_places(const struct basis_reader *r, const struct basis_chunk_entry *chunk,
		      struct basis_pose *pose)
{
	const struct basis_places *places;
	uint64_t bytes = sizeof(*places);

	if (!chunk)
		return 0;
	places = (const void *)(r->data + chunk->offset);
	for (int s = 0; s < BASIS_SURFACES && chunk->bytes >= sizeof(*places); s++) {
		bytes += places->bytes[s];
		if (!(places->nearest[s] >= 0 && isfinite(places->nearest[s])))
			return basis_damaged(r, "nearest place at %g, expected 0 or more",
					     (double)places->nearest[s]);
	}
	if (chunk->bytes != bytes)
		return basis_damaged(r, "PLAC chunk of %llu bytes, expected %llu",
				     (unsigned long long)chunk->bytes, (unsigned long long)bytes);
	pose->places = places;
	return 0;
}

/* Turns the differences of packed bytes into distances. */
static void unfold(const uint8_t *raw, uint16_t *map, double nearest, int width, int height,
		   float *distance)
{
	const size_t pixels = (size_t)width * (size_t)height;
	size_t at = 0;

	for (int y = 0; y < height; y++)
		for (int x = 0; x < width; x++, at++) {
			map[at] = (uint16_t)(expected(map, width, x, y) +
					     (raw[at] << 8 | raw[pixels + at]));
			distance[at] = map[at] ? (float)(nearest * BASIS_PLACE_ONE / map[at]) : 0;
		}
}

int basis_places_read(const struct basis *basis, int pose, enum basis_surface surface,
		      float *distance)
{
	const struct basis_places *places = basis->poses[pose].places;
	const int width = (int)basis->info.width, height = (int)basis->info.height;
	const size_t pixels = (size_t)width * (size_t)height;
	const uint8_t *packed = (const uint8_t *)(places + 1);
	uint8_t *raw;
	int ret = 0;

	if (!places)
		return -ENODATA;
	if (!places->bytes[surface]) {
		memset(distance, 0, pixels * sizeof(*distance));
		return 0;
	}
	raw = malloc(4 * pixels);
	if (!raw)
		return -ENOMEM;
	for (int s = 0; s < (int)surface; s++)
		packed += places->bytes[s];
	if (ZSTD_decompress(raw, 2 * pixels, packed, places->bytes[surface]) != 2 * pixels)
		ret = -EBADMSG;
	else
		unfold(raw, (uint16_t *)(void *)(raw + 2 * pixels),
		       (double)places->nearest[surface], width, height, distance);
	free(raw);
	return ret;
}

/* ---- writing ---- */

static float nearest_of(const float *distance, size_t pixels)
{
	float nearest = 0;

	for (size_t at = 0; at < pixels; at++)
		if (distance[at] > 0 && (nearest == 0 || distance[at] < nearest))
			nearest = distance[at];
	return nearest;
}

/* Upper bytes of all differences, then their lower bytes. */
static void fold(const float *distance, double nearest, int width, int height, uint16_t *map,
		 uint8_t *raw)
{
	const size_t pixels = (size_t)width * (size_t)height;
	size_t at = 0;

	for (int y = 0; y < height; y++)
		for (int x = 0; x < width; x++, at++) {
			uint16_t difference;

			map[at] = distance[at] > 0
					  ? (uint16_t)fmax(lrint(BASIS_PLACE_ONE * nearest /
								 (double)distance[at]),
							   1)
					  : 0;
			difference = (uint16_t)(map[at] - expected(map, width, x, y));
			raw[at] = (uint8_t)(difference >> 8);
			raw[pixels + at] = (uint8_t)difference;
		}
}

int basis_places_pack(const float *const distance[BASIS_SURFACES], int width, int height,
		      void **chunk, size_t *bytes)
{
	const size_t pixels = (size_t)width * (size_t)height, most = ZSTD_compressBound(2 * pixels);
	struct basis_places head = {.bytes = {0}};
	uint8_t *raw = malloc(4 * pixels), *out = malloc(sizeof(head) + BASIS_SURFACES * most);
	int ret = raw && out ? 0 : -ENOMEM;

	*bytes = sizeof(head);
	for (int s = 0; !ret && s < BASIS_SURFACES; s++) {
		size_t done;

		head.nearest[s] = nearest_of(distance[s], pixels);
		if (head.nearest[s] == 0)
			continue;
		fold(distance[s], (double)head.nearest[s], width, height,
		     (uint16_t *)(void *)(raw + 2 * pixels), raw);
		done = ZSTD_compress(out + *bytes, most, raw, 2 * pixels, LEVEL);
		ret = ZSTD_isError(done) || done > UINT32_MAX ? -ENOMEM : 0;
		head.bytes[s] = (uint32_t)done;
		*bytes += done;
	}
	free(raw);
	if (ret) {
		free(out);
		return ret;
	}
	memcpy(out, &head, sizeof(head));
	*chunk = out;
	return 0;
}

/* ---- footprints ---- */

static bool is_possible(const struct basis_footprint *foot)
{
	uint64_t any = 0;

	for (int j = 0; j < BASIS_FOOT_SQUARES; j++)
		any |= foot->row[j];
	return fabsf(foot->corner[0]) <= BASIS_FOOT_MOST &&
	       fabsf(foot->corner[1]) <= BASIS_FOOT_MOST && foot->side >= 0 &&
	       foot->side <= BASIS_FOOT_MOST && (foot->side > 0 || !any) && foot->reserved == 0;
}

int basis_foot_check(const struct basis_footprint *feet, uint32_t count, uint32_t *bad)
{
	for (uint32_t p = 0; p < count; p++)
		if (!is_possible(&feet[p])) {
			*bad = p;
			return -EINVAL;
		}
	return 0;
}
