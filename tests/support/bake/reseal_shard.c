/* SPDX-License-Identifier: MIT */
#include "tests/support/bake/reseal_shard.h"

#include <stdbool.h>
#include <stdio.h>
#include <string.h>
#include <xxhash.h>

#include "bake/tiles/shard_format.h"

/* Arrays and texts of the plan, in the order of the file. */
#define RESEAL_PIECES 6

/* Adds the plan to the header's hash. False: the plan's sizes lead out of the file. */
static bool reseal_plan(const struct shard_header *h, const uint8_t *at, size_t left,
			uint64_t *hash, size_t *used)
{
	const double n = h->info.lights, terms = 3.0 * h->info.grounds * n; /* no overflow */
	const double piece[RESEAL_PIECES] = {
		n * sizeof(struct basis_light),
		terms * sizeof(double),
		h->has_gather ? n * sizeof(struct basis_coarse) : 0,
		h->has_names ? h->info.poses * (double)sizeof(struct basis_pose_name) : 0,
		PLAN_TEXT_MAX,
		PLAN_TEXT_MAX,
	};

	*used = 0;
	for (int k = 0; k < RESEAL_PIECES; k++) {
		if (piece[k] > (double)(left - *used))
			return false;
		*hash = XXH3_64bits_withSeed(at + *used, (size_t)piece[k], *hash);
		*used += (size_t)piece[k];
	}
	return true;
}

void reseal_shard(uint8_t *data, size_t bytes)
{
	struct shard_header h;
	struct shard_record record;
	uint64_t hash;
	size_t at = sizeof(h), used;

	if (bytes < sizeof(h))
		return;
	memcpy(&h, data, sizeof(h));
	memcpy(h.magic, SHARD_MAGIC, sizeof(h.magic));
	memset(h.program, 0, sizeof(h.program));
	snprintf(h.program, sizeof(h.program), "%s", INLAY_VERSION);
	h.basis_version = BASIS_VERSION;
	h.account_bytes = sizeof(struct tile_account);
	h.checksum = 0;
	hash = XXH3_64bits(&h, sizeof(h));
	if (!reseal_plan(&h, data + at, bytes - at, &hash, &used))
		return;
	h.checksum = hash;
	memcpy(data, &h, sizeof(h));
	for (at += used; bytes - at >= sizeof(record); at += sizeof(record) + record.bytes) {
		memcpy(&record, data + at, sizeof(record));
		if (record.bytes > bytes - at - sizeof(record))
			return;
		record.checksum = 0;
		record.checksum = XXH3_64bits_withSeed(data + at + sizeof(record), record.bytes,
						       XXH3_64bits(&record, sizeof(record)));
		memcpy(data + at, &record, sizeof(record));
	}
}
