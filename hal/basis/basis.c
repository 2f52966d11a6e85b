/* SPDX-License-Identifier: MIT */
#include "hal/basis/basis.h"

#include <errno.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>

#include "hal/basis/basis_blocks.h"
#include "hal/basis/basis_chunks.h"
#include "hal/basis/basis_file.h"
#include "hal/basis/basis_glass.h"
#include "hal/basis/basis_names.h"
#include "hal/basis/basis_places.h"
#include "hal/basis/basis_store.h"

_Static_assert(sizeof(struct basis_info_chunk) == 104, "as on disk");
_Static_assert(sizeof(struct basis_light) == 32, "as on disk");
_Static_assert(sizeof(struct basis_coarse) == 12, "as on disk");
_Static_assert(sizeof(struct basis_block_entry) == 48, "as on disk");
_Static_assert(sizeof(struct basis_pose_name) == 32, "as on disk");
_Static_assert(sizeof(struct basis_pack) == 16, "as on disk");
_Static_assert(sizeof(struct basis_pack_part) == 24, "as on disk");
_Static_assert(sizeof(struct basis_glass) == 16, "as on disk");
_Static_assert(sizeof(struct basis_mirror) == 16, "as on disk");
_Static_assert(sizeof(struct basis_footprint) == 528, "as on disk");
_Static_assert(sizeof(struct basis_places) == 24, "as on disk");

/* Checks that no declared error is NaN, infinite or negative. */
static int check_errors(const struct basis_reader *r)
{
	const struct basis_info_chunk *info = &r->basis->info;
	const double errors[] = {info->column_cut, info->object_error, info->ratio_error,
				 info->sky_rms,	   info->sky_max,      info->cell_rms,
				 info->cell_max,   info->noise_levels};

	for (size_t i = 0; i < sizeof(errors) / sizeof(errors[0]); i++) {
		if (!(errors[i] >= 0 && isfinite(errors[i])))
			return basis_damaged(
				r, "declared error %zu is %g, expected a finite number, 0 or more",
				i, errors[i]);
	}
	return 0;
}

static int check_info(const struct basis_reader *r, const struct basis_chunk_map *map)
{
	struct basis_info_chunk *info = &r->basis->info;

	if (!map->info || map->info->bytes != sizeof(*info))
		return basis_damaged(r, "no INFO chunk of %zu bytes", sizeof(*info));
	memcpy(info, r->data + map->info->offset, sizeof(*info));
	if (info->width < 1 || info->width > BASIS_SIDE_MAX || info->height < 1 ||
	    info->height > BASIS_SIDE_MAX)
		return basis_damaged(r, "picture of %ux%u pixels, expected 1 to %d", info->width,
				     info->height, BASIS_SIDE_MAX);
	if (info->lights < 1 || info->lights > BASIS_LIGHTS_MAX)
		return basis_damaged(r, "%u lights, expected 1 to %d", info->lights,
				     BASIS_LIGHTS_MAX);
	if (info->grounds > BASIS_GROUNDS_MAX)
		return basis_damaged(r, "%u ground terms, expected at most %d", info->grounds,
				     BASIS_GROUNDS_MAX);
	if (info->poses < 1 || info->poses > BASIS_POSES_MAX || info->poses > map->count)
		return basis_damaged(r, "%u poses in %u chunks", info->poses, map->count);
	if (info->coarse < 1 || info->coarse > info->lights)
		return basis_damaged(r, "%u coarse lights, expected 1 to %u", info->coarse,
				     info->lights);
	if (info->light_shape == 1)
		return fault_say(r->fault, -ENOTSUP,
				 "%s: its lights are tents, expected cells: bake the scene again",
				 r->name);
	if (info->light_shape != 0 || info->reserved != 0)
		return basis_damaged(r, "light shape %u (and %u), expected 0 (and 0)",
				     info->light_shape, info->reserved);
	r->basis->tiles_across = (int)(info->width + BASIS_TILE - 1) / BASIS_TILE;
	r->basis->tiles_down = (int)(info->height + BASIS_TILE - 1) / BASIS_TILE;
	return check_errors(r);
}

/* Finds an array of exactly so many bytes. Where 0 bytes are expected the chunk may be absent, and
 * *at is NULL. */
static int chunk_array(const struct basis_reader *r, const struct basis_chunk_entry *chunk,
		       const char *name, uint64_t bytes, const void **at)
{
	const uint64_t found = chunk ? chunk->bytes : 0;

	if (found != bytes)
		return basis_damaged(r, "%s chunk of %llu bytes, expected %llu", name,
				     (unsigned long long)found, (unsigned long long)bytes);
	*at = bytes ? r->data + chunk->offset : NULL;
	return 0;
}

static int chunk_text(const struct basis_reader *r, const struct basis_chunk_entry *chunk,
		      const char *name, const char **at)
{
	*at = "";
	if (!chunk)
		return 0;
	*at = (const char *)(r->data + chunk->offset);
	if (chunk->bytes < 1 || memchr(*at, 0, chunk->bytes) != *at + chunk->bytes - 1)
		return basis_damaged(r, "%s chunk, expected a text that ends in its only NUL byte",
				     name);
	return 0;
}

static int check_lights(const struct basis_reader *r)
{
	for (uint32_t i = 0; i < r->basis->info.lights; i++) {
		const struct basis_light *light = &r->basis->lights[i];
		const double *d = light->direction;
		const double square = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];

		if (!(fabs(square - 1) < 1e-6))
			return basis_damaged(r, "direction %u (%g %g %g), expected length 1", i,
					     d[0], d[1], d[2]);
		if (!(light->solid_angle_sr >= 0 && light->solid_angle_sr <= 4 * M_PI))
			return basis_damaged(r, "solid angle %u is %g, expected 0 to 4 pi", i,
					     light->solid_angle_sr);
	}
	return 0;
}

static int check_ground_terms(const struct basis_reader *r)
{
	const size_t n = (size_t)r->basis->info.grounds * 3 * r->basis->info.lights;

	for (size_t i = 0; i < n; i++) {
		if (!(r->basis->ground[i] >= 0 && r->basis->ground[i] <= BASIS_GROUND_MAX))
			return basis_damaged(
				r, "value %zu of the ground terms is %g, expected 0 to %g", i,
				r->basis->ground[i], BASIS_GROUND_MAX);
	}
	return 0;
}

/* Checks that the coarse lights of each light ascend, unused ones last, and that its weights sum to
 * BASIS_COARSE_ONE. */
static int check_coarse(const struct basis_reader *r)
{
	const struct basis *basis = r->basis;

	for (uint32_t i = 0; basis->coarse && i < basis->info.lights; i++) {
		const struct basis_coarse *c = &basis->coarse[i];
		int sum = 0;

		for (int k = 0; k < 3; k++) {
			sum += c->weight[k];
			if (c->weight[k] == 0 ? c->index[k] != 0
					      : c->index[k] >= basis->info.coarse ||
							(k && (c->weight[k - 1] == 0 ||
							       c->index[k] <= c->index[k - 1])))
				return basis_damaged(
					r,
					"coarse light %u (weight %u) of light %u, expected ascending numbers below %u, or 0 where there are no more",
					c->index[k], c->weight[k], i, basis->info.coarse);
		}
		if (sum != BASIS_COARSE_ONE)
			return basis_damaged(r, "weights of light %u sum to %d, expected %d", i,
					     sum, BASIS_COARSE_ONE);
	}
	return 0;
}

static int read_names(const struct basis_reader *r, const struct basis_chunk_map *map)
{
	const uint32_t poses = r->basis->info.poses;
	const void *names = NULL;
	int ret;

	if (!map->names)
		return 0;
	ret = chunk_array(r, map->names, "POSE", poses * sizeof(*r->basis->names), &names);
	if (ret < 0)
		return ret;
	r->basis->names = names;
	ret = basis_names_check(names, poses);
	return ret == -EINVAL
		       ? basis_damaged(
				 r,
				 "names of poses, expected letters, digits, - and _, not digits alone, and no two alike")
		       : ret;
}

static int read_feet(const struct basis_reader *r, const struct basis_chunk_map *map)
{
	const uint32_t poses = r->basis->info.poses;
	const void *feet = NULL;
	uint32_t bad = 0;
	int ret;

	if (!map->feet)
		return 0;
	ret = chunk_array(r, map->feet, "FOOT", poses * sizeof(*r->basis->feet), &feet);
	if (ret < 0)
		return ret;
	r->basis->feet = feet;
	return basis_foot_check(feet, poses, &bad) == 0
		       ? 0
		       : basis_damaged(
				 r,
				 "footprint of pose %u, expected a finite corner, and squares above 0 where one is set",
				 bad);
}

static int check_peaks(const struct basis_reader *r, const float (*peak)[3])
{
	for (uint32_t i = 0; i <= r->basis->info.lights; i++) {
		for (int c = 0; c < 3; c++) {
			if (!(peak[i][c] >= 0 && isfinite(peak[i][c])))
				return basis_damaged(
					r, "peak %u is %g, expected a finite number, 0 or more", i,
					(double)peak[i][c]);
		}
	}
	return 0;
}

static int read_shared(const struct basis_reader *r, const struct basis_chunk_map *map)
{
	struct basis *basis = r->basis;
	const uint64_t n = basis->info.lights;
	const void *lights = NULL, *ground = NULL, *coarse = NULL;
	int ret;

	ret = chunk_array(r, map->dome, "DOME", n * sizeof(*basis->lights), &lights);
	if (ret == 0)
		ret = chunk_array(r, map->ground, "GRND",
				  basis->info.grounds * 3 * n * sizeof(*basis->ground), &ground);
	if (ret == 0)
		ret = chunk_array(r, map->coarse, "COAR",
				  basis->info.coarse < n ? n * sizeof(*basis->coarse) : 0, &coarse);
	if (ret == 0)
		ret = read_names(r, map);
	if (ret == 0)
		ret = read_feet(r, map);
	if (ret == 0)
		ret = chunk_text(r, map->camera, "CAMR", &basis->camera);
	if (ret == 0)
		ret = chunk_text(r, map->provenance, "PROV", &basis->provenance);
	if (ret < 0)
		return ret;
	basis->lights = lights;
	basis->ground = ground;
	basis->coarse = coarse;
	ret = check_lights(r);
	if (ret == 0)
		ret = check_ground_terms(r);
	return ret < 0 ? ret : check_coarse(r);
}

static int read_layer(const struct basis_reader *r, const struct basis_chunk_entry *blocks,
		      const struct basis_chunk_entry *data, int pose, bool exact)
{
	struct basis_blocks_chunk chunk = {.pose = pose, .exact = exact};
	struct basis_pose *to = &r->basis->poses[pose];

	chunk.count = blocks->bytes / sizeof(*chunk.entries);
	if (blocks->bytes % sizeof(*chunk.entries) || chunk.count > INT_MAX)
		return basis_damaged(r, "%s chunk of %llu bytes, expected a multiple of %zu",
				     exact ? "BLCX" : "BLCK", (unsigned long long)blocks->bytes,
				     sizeof(*chunk.entries));
	chunk.entries = (const void *)(r->data + blocks->offset);
	chunk.data = r->data + data->offset;
	chunk.data_bytes = data->bytes;
	return basis_read_blocks(r, &chunk, exact ? &to->exact : &to->shown);
}

static int add_packed(const struct basis_reader *r, const struct basis_pose_chunks *chunks,
		      int index)
{
	struct basis *basis = r->basis;
	int ret = 0;

	if (!basis->store)
		ret = basis_store_create(&basis->store, r, basis->poses);
	return ret < 0 ? ret
		       : basis_store_add(basis->store, r, index, chunks->blocks, chunks->pack);
}

static int read_pose(const struct basis_reader *r, const struct basis_pose_chunks *chunks,
		     int index)
{
	struct basis *basis = r->basis;
	struct basis_pose *pose = &basis->poses[index];
	const uint64_t pixels = (uint64_t)basis->info.width * basis->info.height;
	const void *coverage = NULL, *peak = NULL;
	int ret = 0;

	if (!chunks->pack)
		ret = chunk_array(r, chunks->coverage, "COVR", pixels * sizeof(*pose->coverage),
				  &coverage);
	if (ret == 0)
		ret = chunk_array(r, chunks->peak, "PEAK",
				  (basis->info.lights + UINT64_C(1)) * sizeof(*pose->peak), &peak);
	if (ret < 0)
		return ret;
	pose->coverage = coverage;
	pose->peak = peak;
	ret = check_peaks(r, pose->peak);
	if (ret == 0)
		ret = chunks->pack ? add_packed(r, chunks, index)
				   : read_layer(r, chunks->blocks, chunks->data, index, false);
	if (ret == 0 && chunks->exact_blocks && r->part != BASIS_SHOWN)
		ret = read_layer(r, chunks->exact_blocks, chunks->exact_data, index, true);
	if (ret == 0)
		ret = basis_read_glass(r, chunks->glass, pose);
	if (ret == 0)
		ret = basis_read_mirror(r, chunks->mirror, pose);
	return ret < 0 ? ret : basis_find_places(r, chunks->places, pose);
}

/* Checks the memory that the size of the picture asks for against the size of the file: zstd packs
 * zeros to almost nothing, and lists of tiles are not in the file. pack_open() checks payloads. */
static int check_made(const struct basis_reader *r, const struct basis_chunk_map *map)
{
	const struct basis_info_chunk *info = &r->basis->info;
	const uint64_t tiles = (uint64_t)r->basis->tiles_across * (uint64_t)r->basis->tiles_down;
	uint64_t layers = 0, made = 0;

	for (uint32_t p = 0; p < info->poses; p++) {
		const struct basis_pose_chunks *pose = &map->poses[p];

		layers += !pose->pack + (pose->exact_blocks && r->part != BASIS_SHOWN);
		if (pose->pack) /* packed poses share this memory: few are unpacked at once */
			made = tiles * sizeof(struct basis_tile) +
			       (uint64_t)info->width * info->height * sizeof(uint16_t);
	}
	made += layers * tiles * sizeof(struct basis_tile);
	return basis_is_bomb(made, r->bytes)
		       ? basis_damaged(
				 r,
				 "%u poses of %ux%u pixels take %llu bytes of memory, expected at most %d times the file's %zu",
				 info->poses, info->width, info->height, (unsigned long long)made,
				 BASIS_MADE_TIMES, r->bytes)
		       : 0;
}

static int read_poses(const struct basis_reader *r, struct basis_chunk_map *map)
{
	const uint32_t poses = r->basis->info.poses;
	int ret;

	r->basis->poses = calloc(poses, sizeof(*r->basis->poses));
	if (!r->basis->poses)
		return fault_say(r->fault, -ENOMEM, "%s: out of memory", r->name);
	ret = basis_find_pose_chunks(r, map);
	if (ret == 0)
		ret = check_made(r, map);
	for (uint32_t p = 0; ret == 0 && p < poses; p++)
		ret = read_pose(r, &map->poses[p], (int)p);
	free(map->poses);
	if (ret == 0 && r->basis->store)
		ret = basis_store_check(r->basis->store, r);
	if (ret == 0)
		ret = basis_pose_load(r->basis, 0, r->fault);
	return ret;
}

static int basis_read_all(const struct basis_reader *r)
{
	struct basis_chunk_map map = {0};
	int ret = basis_find_chunks(r, &map);

	if (ret == 0)
		ret = check_info(r, &map);
	if (ret == 0)
		ret = read_shared(r, &map);
	return ret < 0 ? ret : read_poses(r, &map);
}

static int basis_open_data(struct basis *basis, const struct basis_reader *reader)
{
	const int ret = basis_read_all(reader);

	if (ret < 0)
		basis_close(basis);
	return ret;
}

int basis_open_memory(struct basis *basis, const void *data, size_t bytes, const char *name,
		      enum basis_part part, struct fault *fault)
{
	memset(basis, 0, sizeof(*basis));
	if ((uintptr_t)data % BASIS_ALIGN)
		return fault_say(fault, -EINVAL, "%s: memory is not aligned to %d bytes", name,
				 BASIS_ALIGN);
	return basis_open_data(basis, &(struct basis_reader){.basis = basis,
							     .data = data,
							     .bytes = bytes,
							     .name = name,
							     .part = part,
							     .fault = fault});
}

int basis_open(struct basis *basis, const char *path, enum basis_part part, struct fault *fault)
{
	struct basis_file file;
	int ret;

	memset(basis, 0, sizeof(*basis));
	ret = basis_file_open(&file, path, part, fault);
	if (ret < 0)
		return ret;
	ret = basis_open_data(basis, &(struct basis_reader){.basis = basis,
							    .data = file.memory,
							    .bytes = file.bytes,
							    .name = path,
							    .part = part,
							    .file = &file,
							    .fault = fault});
	if (ret == 0) {
		(void)mprotect(file.memory, file.bytes, PROT_READ);
		basis->map = file.memory;
		basis->map_bytes = file.bytes;
		file.memory = NULL;
	}
	basis_file_close(&file);
	return ret;
}

void basis_close(struct basis *basis)
{
	basis_store_destroy(basis->store);
	for (uint32_t p = 0; basis->poses && p < basis->info.poses; p++) {
		free(basis->poses[p].shown.tiles);
		free(basis->poses[p].shown.blocks);
		free(basis->poses[p].exact.tiles);
		free(basis->poses[p].exact.blocks);
	}
	free(basis->poses);
	if (basis->map)
		munmap(basis->map, basis->map_bytes);
	memset(basis, 0, sizeof(*basis));
}

long basis_pose_mirrored(const struct basis_pose *pose)
{
	long pixels = 0;

	for (size_t i = 0; i < pose->mirror_count; i++) {
		const struct basis_mirror *m = &pose->mirror[i];

		pixels += !i || m->x != m[-1].x || m->y != m[-1].y;
	}
	return pixels;
}

bool basis_is_preview(const struct basis *basis)
{
	return strstr(basis->provenance, "\n" BASIS_PREVIEW_LINE) != NULL;
}

const double *basis_ground(const struct basis *basis, int ground, int channel)
{
	return basis->ground + ((size_t)ground * 3 + (size_t)channel) * basis->info.lights;
}
