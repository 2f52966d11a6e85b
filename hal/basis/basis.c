#include "hal/basis/basis.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>
#include <xxhash.h>

#include "hal/basis/basis_reader.h"

_Static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "the file is read where it lies");
_Static_assert(sizeof(struct basis_file_header) == 32, "as on disk");
_Static_assert(sizeof(struct basis_chunk_entry) == 32, "as on disk");
_Static_assert(sizeof(struct basis_info_chunk) == 56, "as on disk");
_Static_assert(sizeof(struct basis_light) == 32, "as on disk");
_Static_assert(sizeof(struct basis_block_entry) == 40, "as on disk");

/* Where the chunks lie; NULL until found. */
struct chunk_map {
	const struct basis_chunk_entry *table;
	uint32_t count;
	const struct basis_chunk_entry *info, *dome, *ground, *camera, *provenance;
	struct pose_chunks {
		const struct basis_chunk_entry *coverage, *blocks, *data, *peak;
	} * poses;
};

int basis_damaged(const struct basis_reader *reader, const char *format, ...)
{
	char text[FAULT_TEXT_MAX / 2];
	va_list args;

	va_start(args, format);
	vsnprintf(text, sizeof(text), format, args);
	va_end(args);
	return fault_say(reader->fault, -EBADMSG, "%s: damaged basis file: %s", reader->name, text);
}

static int check_header(const struct basis_reader *r, struct chunk_map *map)
{
	struct basis_file_header header;
	XXH3_state_t *hash;
	size_t table_bytes;
	uint64_t checksum;

	if (r->bytes < sizeof(header) || memcmp(r->data, BASIS_MAGIC, sizeof(header.magic)) != 0)
		return fault_say(r->fault, -EBADMSG,
				 "%s: not a basis file (%zu bytes): expected one made by "
				 "inlay-bake, which begins with \"%s\"",
				 r->name, r->bytes, BASIS_MAGIC);
	memcpy(&header, r->data, sizeof(header));
	if (header.version != BASIS_VERSION)
		return fault_say(r->fault, -ENOTSUP,
				 "%s: basis file of version %u, expected version %d", r->name,
				 header.version, BASIS_VERSION);
	if (header.file_bytes != r->bytes)
		return basis_damaged(r, "%zu bytes long, expected %llu (was it cut short?)",
				     r->bytes, (unsigned long long)header.file_bytes);
	table_bytes = (size_t)header.chunk_count * sizeof(*map->table);
	if (header.chunk_count < 1 || header.chunk_count > BASIS_CHUNKS_MAX ||
	    table_bytes > r->bytes - sizeof(header))
		return basis_damaged(r, "%u chunks, expected 1 to %d, and their table in the file",
				     header.chunk_count, BASIS_CHUNKS_MAX);
	map->table = (const struct basis_chunk_entry *)(r->data + sizeof(header));
	map->count = header.chunk_count;

	checksum = header.checksum;
	header.checksum = 0;
	hash = XXH3_createState();
	if (!hash)
		return fault_say(r->fault, -ENOMEM, "%s: out of memory", r->name);
	XXH3_64bits_reset(hash);
	XXH3_64bits_update(hash, &header, sizeof(header));
	XXH3_64bits_update(hash, map->table, table_bytes);
	header.checksum = XXH3_64bits_digest(hash);
	XXH3_freeState(hash);
	if (header.checksum != checksum)
		return basis_damaged(r, "checksum of the chunk table is %016llx, expected %016llx",
				     (unsigned long long)header.checksum,
				     (unsigned long long)checksum);
	return 0;
}

/* Bounds, order, gaps and checksums of all chunks, of unknown types too. */
static int check_chunks(const struct basis_reader *r, const struct chunk_map *map)
{
	uint64_t end = sizeof(struct basis_file_header) + map->count * sizeof(*map->table);

	for (uint32_t i = 0; i < map->count; i++) {
		const struct basis_chunk_entry *c = &map->table[i];

		if (c->offset % BASIS_PAGE || c->offset < end || c->offset > r->bytes ||
		    c->bytes > r->bytes - c->offset)
			return basis_damaged(r,
					     "chunk %u of %llu bytes lies at byte %llu, expected a "
					     "multiple of %d after the chunk before it and inside "
					     "the file",
					     i, (unsigned long long)c->bytes,
					     (unsigned long long)c->offset, BASIS_PAGE);
		if (!basis_all_zero(r->data + end, r->data + c->offset))
			return basis_damaged(r, "bytes before chunk %u are not 0", i);
		if (XXH3_64bits(r->data + c->offset, c->bytes) != c->checksum)
			return basis_damaged(r, "chunk %u does not have its checksum", i);
		end = c->offset + c->bytes;
	}
	if (!basis_all_zero(r->data + end, r->data + r->bytes))
		return basis_damaged(r, "bytes after the last chunk are not %d", 0);
	return 0;
}

static const struct basis_chunk_entry **shared_slot(struct chunk_map *map, uint32_t type)
{
	switch (type) {
	case BASIS_CHUNK_INFO:
		return &map->info;
	case BASIS_CHUNK_DOME:
		return &map->dome;
	case BASIS_CHUNK_GROUND:
		return &map->ground;
	case BASIS_CHUNK_CAMERA:
		return &map->camera;
	case BASIS_CHUNK_PROVENANCE:
		return &map->provenance;
	default:
		return NULL;
	}
}

static const struct basis_chunk_entry **pose_slot(struct pose_chunks *pose, uint32_t type)
{
	switch (type) {
	case BASIS_CHUNK_COVERAGE:
		return &pose->coverage;
	case BASIS_CHUNK_BLOCKS:
		return &pose->blocks;
	case BASIS_CHUNK_DATA:
		return &pose->data;
	case BASIS_CHUNK_PEAK:
		return &pose->peak;
	default:
		return NULL;
	}
}

static int take(const struct basis_reader *r, const struct chunk_map *map, uint32_t i,
		const struct basis_chunk_entry **slot)
{
	if (*slot)
		return basis_damaged(r, "chunk %u occurs twice", i);
	*slot = &map->table[i];
	return 0;
}

static int find_shared(const struct basis_reader *r, struct chunk_map *map)
{
	for (uint32_t i = 0; i < map->count; i++) {
		const struct basis_chunk_entry **slot = shared_slot(map, map->table[i].type);
		int ret;

		if (!slot)
			continue;
		if (map->table[i].pose != 0)
			return basis_damaged(r, "chunk %u belongs to pose %u, expected 0", i,
					     map->table[i].pose);
		ret = take(r, map, i, slot);
		if (ret < 0)
			return ret;
	}
	if (!map->info || map->info->bytes != sizeof(struct basis_info_chunk))
		return basis_damaged(r, "no INFO chunk of %zu bytes",
				     sizeof(struct basis_info_chunk));
	return 0;
}

static int check_info(const struct basis_reader *r, const struct chunk_map *map)
{
	struct basis_info_chunk *info = &r->basis->info;

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
	if (info->poses < 1 || info->poses > map->count)
		return basis_damaged(r, "%u poses in %u chunks", info->poses, map->count);
	if (info->reserved)
		return basis_damaged(r, "reserved field is %u, expected 0", info->reserved);
	if (!(info->object_error >= 0 && isfinite(info->object_error)) ||
	    !(info->ratio_error >= 0 && isfinite(info->ratio_error)) ||
	    !(info->noise_levels >= 0 && isfinite(info->noise_levels)))
		return basis_damaged(r, "declared errors %g, %g, %g, expected finite numbers",
				     info->object_error, info->ratio_error, info->noise_levels);
	r->basis->tiles_across = (int)(info->width + BASIS_TILE - 1) / BASIS_TILE;
	r->basis->tiles_down = (int)(info->height + BASIS_TILE - 1) / BASIS_TILE;
	return 0;
}

static int find_pose_chunks(const struct basis_reader *r, struct chunk_map *map)
{
	const uint32_t poses = r->basis->info.poses;

	map->poses = calloc(poses, sizeof(*map->poses));
	r->basis->poses = calloc(poses, sizeof(*r->basis->poses));
	if (!map->poses || !r->basis->poses)
		return fault_say(r->fault, -ENOMEM, "%s: out of memory", r->name);
	for (uint32_t i = 0; i < map->count; i++) {
		const struct basis_chunk_entry *c = &map->table[i];
		struct pose_chunks unknown = {0};
		struct pose_chunks *pose = c->pose < poses ? &map->poses[c->pose] : &unknown;
		const struct basis_chunk_entry **slot = pose_slot(pose, c->type);
		int ret;

		if (!slot)
			continue;
		if (pose == &unknown)
			return basis_damaged(r, "chunk %u belongs to pose %u of %u", i, c->pose,
					     poses);
		ret = take(r, map, i, slot);
		if (ret < 0)
			return ret;
	}
	return 0;
}

/* An array of exactly so many bytes; NULL is returned for an absent or empty chunk of 0 bytes. */
static int array(const struct basis_reader *r, const struct basis_chunk_entry *chunk,
		 const char *name, uint64_t bytes, const void **at)
{
	const uint64_t found = chunk ? chunk->bytes : 0;

	if (found != bytes)
		return basis_damaged(r, "%s chunk of %llu bytes, expected %llu", name,
				     (unsigned long long)found, (unsigned long long)bytes);
	*at = bytes ? r->data + chunk->offset : NULL;
	return 0;
}

static int text(const struct basis_reader *r, const struct basis_chunk_entry *chunk,
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
		if (!(light->solid_angle_sr >= 0 && isfinite(light->solid_angle_sr)))
			return basis_damaged(r, "solid angle %u is %g, expected 0 or more", i,
					     light->solid_angle_sr);
	}
	return 0;
}

static int check_ground(const struct basis_reader *r)
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

static int check_peaks(const struct basis_reader *r, const float (*peak)[3])
{
	for (uint32_t i = 0; i <= r->basis->info.lights; i++) {
		for (int c = 0; c < 3; c++) {
			if (!(peak[i][c] >= 0 && isfinite(peak[i][c])))
				return basis_damaged(r,
						     "peak %u is %g, expected a finite number, "
						     "0 or more",
						     i, (double)peak[i][c]);
		}
	}
	return 0;
}

static int read_shared(const struct basis_reader *r, const struct chunk_map *map)
{
	struct basis *basis = r->basis;
	const uint64_t n = basis->info.lights;
	const void *lights = NULL, *ground = NULL;
	int ret;

	ret = array(r, map->dome, "DOME", n * sizeof(*basis->lights), &lights);
	if (ret == 0)
		ret = array(r, map->ground, "GRND",
			    basis->info.grounds * 3 * n * sizeof(*basis->ground), &ground);
	if (ret == 0)
		ret = text(r, map->camera, "CAMR", &basis->camera);
	if (ret == 0)
		ret = text(r, map->provenance, "PROV", &basis->provenance);
	if (ret < 0)
		return ret;
	basis->lights = lights;
	basis->ground = ground;
	ret = check_lights(r);
	return ret < 0 ? ret : check_ground(r);
}

static int read_pose(const struct basis_reader *r, const struct pose_chunks *chunks, int index)
{
	struct basis *basis = r->basis;
	struct basis_pose *pose = &basis->poses[index];
	const uint64_t pixels = (uint64_t)basis->info.width * basis->info.height;
	struct basis_blocks_chunk blocks = {0};
	const void *coverage = NULL, *peak = NULL;
	int ret;

	ret = array(r, chunks->coverage, "COVR", pixels * sizeof(*pose->coverage), &coverage);
	if (ret == 0)
		ret = array(r, chunks->peak, "PEAK",
			    (basis->info.lights + UINT64_C(1)) * sizeof(*pose->peak), &peak);
	if (ret < 0)
		return ret;
	pose->coverage = coverage;
	pose->peak = peak;
	ret = check_peaks(r, pose->peak);
	if (ret < 0)
		return ret;
	if (!chunks->blocks || !chunks->data)
		return basis_damaged(r, "pose %d has no BLCK and DATA chunks", index);
	blocks.count = chunks->blocks->bytes / sizeof(*blocks.entries);
	if (chunks->blocks->bytes % sizeof(*blocks.entries) || blocks.count > INT_MAX)
		return basis_damaged(r, "BLCK chunk of %llu bytes, expected a multiple of %zu",
				     (unsigned long long)chunks->blocks->bytes,
				     sizeof(*blocks.entries));
	blocks.entries = (const void *)(r->data + chunks->blocks->offset);
	blocks.data = r->data + chunks->data->offset;
	blocks.data_bytes = chunks->data->bytes;
	return basis_read_blocks(r, index, &blocks);
}

static int read_all(const struct basis_reader *r)
{
	struct chunk_map map = {0};
	int ret = check_header(r, &map);

	if (ret == 0)
		ret = check_chunks(r, &map);
	if (ret == 0)
		ret = find_shared(r, &map);
	if (ret == 0)
		ret = check_info(r, &map);
	if (ret == 0)
		ret = find_pose_chunks(r, &map);
	if (ret == 0)
		ret = read_shared(r, &map);
	for (uint32_t p = 0; ret == 0 && p < r->basis->info.poses; p++)
		ret = read_pose(r, &map.poses[p], (int)p);
	free(map.poses);
	return ret;
}

int basis_open_memory(struct basis *basis, const void *data, size_t bytes, const char *name,
		      struct fault *fault)
{
	const struct basis_reader reader = {basis, data, bytes, name, fault};
	int ret;

	memset(basis, 0, sizeof(*basis));
	if ((uintptr_t)data % BASIS_ALIGN)
		return fault_say(fault, -EINVAL, "%s: memory is not aligned to %d bytes", name,
				 BASIS_ALIGN);
	ret = read_all(&reader);
	if (ret < 0)
		basis_close(basis);
	return ret;
}

static int map_file(int fd, const char *path, void **map, size_t *bytes, struct fault *fault)
{
	struct stat s;
	int err;

	if (fstat(fd, &s) < 0) {
		err = -errno;
		return fault_say(fault, err, "%s: cannot be read: %s", path, strerror(-err));
	}
	if (!S_ISREG(s.st_mode))
		return fault_say(fault, -EINVAL, "%s: not a plain file, expected a basis file",
				 path);
	if (s.st_size == 0)
		return fault_say(fault, -EBADMSG, "%s: empty, expected a basis file", path);
	if ((uintmax_t)s.st_size > SIZE_MAX)
		return fault_say(fault, -EFBIG, "%s: too large for this machine", path);
	*bytes = (size_t)s.st_size;
	*map = mmap(NULL, *bytes, PROT_READ, MAP_PRIVATE, fd, 0);
	if (*map == MAP_FAILED) {
		err = -errno;
		*map = NULL;
		return fault_say(fault, err, "%s: cannot be mapped: %s", path, strerror(-err));
	}
	return 0;
}

int basis_open(struct basis *basis, const char *path, struct fault *fault)
{
	size_t bytes = 0;
	void *map = NULL;
	int fd, ret;

	memset(basis, 0, sizeof(*basis));
	fd = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
	if (fd < 0) {
		ret = -errno;
		return fault_say(fault, ret, "%s: cannot be opened: %s", path, strerror(-ret));
	}
	ret = map_file(fd, path, &map, &bytes, fault);
	close(fd);
	if (ret < 0)
		return ret;
	(void)madvise(map, bytes, MADV_WILLNEED); /* all of it is checked now */
	ret = basis_open_memory(basis, map, bytes, path, fault);
	if (ret < 0) {
		munmap(map, bytes);
		return ret;
	}
	basis->map = map;
	basis->map_bytes = bytes;
	return 0;
}

void basis_close(struct basis *basis)
{
	for (uint32_t p = 0; basis->poses && p < basis->info.poses; p++) {
		free(basis->poses[p].tiles);
		free(basis->poses[p].blocks);
	}
	free(basis->poses);
	if (basis->map)
		munmap(basis->map, basis->map_bytes);
	memset(basis, 0, sizeof(*basis));
}

const double *basis_ground(const struct basis *basis, int ground, int channel)
{
	return basis->ground + ((size_t)ground * 3 + (size_t)channel) * basis->info.lights;
}
