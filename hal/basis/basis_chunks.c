/* SPDX-License-Identifier: MIT */
/* Reads header and chunk table of a basis file, finds the chunks and checks their checksums. */
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <xxhash.h>

#include "hal/basis/basis_chunks.h"
#include "hal/basis/basis_file.h"

_Static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "the file is read where it lies");
_Static_assert(sizeof(struct basis_file_header) == 32, "as on disk");
_Static_assert(sizeof(struct basis_chunk_entry) == 32, "as on disk");

static int hash_table(const struct basis_reader *r, struct basis_file_header *header,
		      const struct basis_chunk_map *map)
{
	XXH3_state_t *hash = XXH3_createState();

	if (!hash)
		return fault_say(r->fault, -ENOMEM, "%s: out of memory", r->name);
	header->checksum = 0;
	XXH3_64bits_reset(hash);
	XXH3_64bits_update(hash, header, sizeof(*header));
	XXH3_64bits_update(hash, map->table, map->count * sizeof(*map->table));
	header->checksum = XXH3_64bits_digest(hash);
	XXH3_freeState(hash);
	return 0;
}

static int check_header(const struct basis_reader *r, struct basis_chunk_map *map)
{
	struct basis_file_header header;
	uint64_t checksum;
	int ret = r->bytes < sizeof(header) ? 0 : basis_file_fetch(r, 0, sizeof(header));

	if (ret < 0)
		return ret;
	if (r->bytes < sizeof(header) || memcmp(r->data, BASIS_MAGIC, sizeof(header.magic)) != 0)
		return fault_say(
			r->fault, -EBADMSG,
			"%s: not a basis file (%zu bytes): expected one made by inlay-bake, which begins with \"%s\"",
			r->name, r->bytes, BASIS_MAGIC);
	memcpy(&header, r->data, sizeof(header));
	if (header.version != BASIS_VERSION && header.version != BASIS_VERSION_MIRROR)
		return fault_say(r->fault, -ENOTSUP,
				 "%s: basis file of version %u, expected version %d: bake it again",
				 r->name, header.version, BASIS_VERSION);
	if (header.file_bytes != r->bytes)
		return basis_damaged(r, "%zu bytes long, expected %llu (was it cut short?)",
				     r->bytes, (unsigned long long)header.file_bytes);
	if (header.chunk_count < 1 || header.chunk_count > BASIS_CHUNKS_MAX ||
	    header.chunk_count * sizeof(*map->table) > r->bytes - sizeof(header))
		return basis_damaged(r, "%u chunks, expected 1 to %d, and their table in the file",
				     header.chunk_count, BASIS_CHUNKS_MAX);
	map->table = (const struct basis_chunk_entry *)(r->data + sizeof(header));
	map->count = header.chunk_count;
	ret = basis_file_fetch(r, sizeof(header), map->count * sizeof(*map->table));
	if (ret < 0)
		return ret;
	checksum = header.checksum;
	ret = hash_table(r, &header, map);
	if (ret == 0 && header.checksum != checksum)
		return basis_damaged(r, "checksum of the chunk table is %016llx, expected %016llx",
				     (unsigned long long)header.checksum,
				     (unsigned long long)checksum);
	return ret;
}

static bool is_exact(const struct basis_chunk_entry *c)
{
	return c->type == BASIS_CHUNK_EXACT_BLOCKS || c->type == BASIS_CHUNK_EXACT_DATA;
}

static int check_gap(const struct basis_reader *r, uint64_t from, uint64_t to)
{
	const int ret = basis_file_fetch(r, from, to - from);

	if (ret < 0)
		return ret;
	return basis_all_zero(r->data + from, r->data + to) ? 0 : 1;
}

/* Does not keep packed poses in memory: they are many, and each is read when it is unpacked. */
static int check_sum(const struct basis_reader *r, const struct basis_chunk_entry *c, uint32_t i)
{
	const uint8_t *data = r->data + c->offset;
	void *owned = NULL;
	bool same;
	int ret;

	if (c->type == BASIS_CHUNK_PACK)
		ret = basis_file_borrow(r, c->offset, c->bytes, &data, &owned);
	else
		ret = basis_file_fetch(r, c->offset, c->bytes);
	if (ret < 0)
		return ret;
	same = XXH3_64bits(data, c->bytes) == c->checksum;
	free(owned);
	return same ? 0 : basis_damaged(r, "chunk %u does not have its checksum", i);
}

/* Checks bounds, order, gaps and checksums of all chunks, also of unknown types. The exact layer
 * may be many times as large as the rest; with BASIS_SHOWN it is not read. */
static int check_chunks(const struct basis_reader *r, const struct basis_chunk_map *map)
{
	uint64_t end = sizeof(struct basis_file_header) + map->count * sizeof(*map->table);
	int ret;

	for (uint32_t i = 0; i < map->count; i++) {
		const struct basis_chunk_entry *c = &map->table[i];

		if (c->offset % BASIS_PAGE || c->offset < end || c->offset > r->bytes ||
		    c->bytes > r->bytes - c->offset)
			return basis_damaged(
				r,
				"chunk %u of %llu bytes lies at byte %llu, expected a multiple of %d after the chunk before it and inside the file",
				i, (unsigned long long)c->bytes, (unsigned long long)c->offset,
				BASIS_PAGE);
		ret = check_gap(r, end, c->offset);
		if (ret)
			return ret < 0 ? ret
				       : basis_damaged(r, "bytes before chunk %u are not 0", i);
		end = c->offset + c->bytes;
		if (is_exact(c) && r->part == BASIS_SHOWN)
			continue;
		ret = check_sum(r, c, i);
		if (ret < 0)
			return ret;
	}
	ret = check_gap(r, end, r->bytes);
	return ret > 0 ? basis_damaged(r, "bytes after the last chunk are not %d", 0) : ret;
}

static const struct basis_chunk_entry **shared_slot(struct basis_chunk_map *map, uint32_t type)
{
	switch (type) {
	case BASIS_CHUNK_INFO:
		return &map->info;
	case BASIS_CHUNK_DOME:
		return &map->dome;
	case BASIS_CHUNK_GROUND:
		return &map->ground;
	case BASIS_CHUNK_COARSE:
		return &map->coarse;
	case BASIS_CHUNK_POSES:
		return &map->names;
	case BASIS_CHUNK_FOOT:
		return &map->feet;
	case BASIS_CHUNK_CAMERA:
		return &map->camera;
	case BASIS_CHUNK_PROVENANCE:
		return &map->provenance;
	default:
		return NULL;
	}
}

static const struct basis_chunk_entry **pose_slot(struct basis_pose_chunks *pose, uint32_t type)
{
	switch (type) {
	case BASIS_CHUNK_COVERAGE:
		return &pose->coverage;
	case BASIS_CHUNK_PEAK:
		return &pose->peak;
	case BASIS_CHUNK_GLASS:
		return &pose->glass;
	case BASIS_CHUNK_MIRROR:
		return &pose->mirror;
	case BASIS_CHUNK_PLACES:
		return &pose->places;
	case BASIS_CHUNK_BLOCKS:
		return &pose->blocks;
	case BASIS_CHUNK_DATA:
		return &pose->data;
	case BASIS_CHUNK_PACK:
		return &pose->pack;
	case BASIS_CHUNK_EXACT_BLOCKS:
		return &pose->exact_blocks;
	case BASIS_CHUNK_EXACT_DATA:
		return &pose->exact_data;
	default:
		return NULL;
	}
}

static int slot_take(const struct basis_reader *r, const struct basis_chunk_map *map, uint32_t i,
		     const struct basis_chunk_entry **slot)
{
	if (*slot)
		return basis_damaged(r, "chunk %u occurs twice", i);
	*slot = &map->table[i];
	return 0;
}

static int find_shared(const struct basis_reader *r, struct basis_chunk_map *map)
{
	for (uint32_t i = 0; i < map->count; i++) {
		const struct basis_chunk_entry **slot = shared_slot(map, map->table[i].type);
		int ret;

		if (!slot)
			continue;
		if (map->table[i].pose != 0)
			return basis_damaged(r, "chunk %u belongs to pose %u, expected 0", i,
					     map->table[i].pose);
		ret = slot_take(r, map, i, slot);
		if (ret < 0)
			return ret;
	}
	return 0;
}

int basis_find_chunks(const struct basis_reader *r, struct basis_chunk_map *map)
{
	int ret = check_header(r, map);

	if (ret == 0)
		ret = check_chunks(r, map);
	return ret < 0 ? ret : find_shared(r, map);
}

static int check_pose_chunks(const struct basis_reader *r, const struct basis_pose_chunks *pose,
			     uint32_t index)
{
	if (!pose->blocks || (!pose->data && !pose->pack))
		return basis_damaged(r, "pose %u has no BLCK and DATA chunks", index);
	if (pose->pack && (pose->data || pose->coverage))
		return basis_damaged(r, "pose %u has PACK, and DATA or COVR; expected one of them",
				     index);
	if (!pose->exact_blocks != !pose->exact_data)
		return basis_damaged(r, "pose %u has one of BLCX and DATX, expected both or none",
				     index);
	if (!pose->exact_blocks && r->part == BASIS_WITH_EXACT)
		return fault_say(r->fault, -ENODATA,
				 "%s: pose %u has no exact layer, expected a file baked with one",
				 r->name, index);
	return 0;
}

int basis_find_pose_chunks(const struct basis_reader *r, struct basis_chunk_map *map)
{
	const uint32_t poses = r->basis->info.poses;
	int ret;

	map->poses = calloc(poses, sizeof(*map->poses));
	if (!map->poses)
		return fault_say(r->fault, -ENOMEM, "%s: out of memory", r->name);
	for (uint32_t i = 0; i < map->count; i++) {
		const struct basis_chunk_entry *c = &map->table[i];
		struct basis_pose_chunks unknown = {0};
		struct basis_pose_chunks *pose = c->pose < poses ? &map->poses[c->pose] : &unknown;
		const struct basis_chunk_entry **slot = pose_slot(pose, c->type);

		if (!slot)
			continue;
		if (pose == &unknown)
			return basis_damaged(r, "chunk %u belongs to pose %u of %u", i, c->pose,
					     poses);
		ret = slot_take(r, map, i, slot);
		if (ret < 0)
			return ret;
	}
	for (uint32_t p = 0; p < poses; p++) {
		ret = check_pose_chunks(r, &map->poses[p], p);
		if (ret < 0)
			return ret;
	}
	return 0;
}
