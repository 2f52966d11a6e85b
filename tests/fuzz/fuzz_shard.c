/* SPDX-License-Identifier: MIT */
/* Any bytes as a share of a bake, as they are and with the name of this program and right
 * checksums: refused in a sentence, or tiles that belong to it up to the last.
 *
 * reaches: shard.c:create_plan shard.c:shard_take_peaks shard.c:shard_take_tile shard.c:list_blocks
 * shard.c:shard_check_tile basis_blocks.c:check_block basis_blocks.c:check_patterns
 * basis_blocks.c:check_record basis_blocks.c:check_pairs finished_tile.c:finished_tile_keep
 */
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "bake/tiles/shard.h"
#include "tests/support/as_file.h"
#include "tests/support/bake/reseal_shard.h"

static void read_tiles(struct shard *shard)
{
	struct fault fault = {.text = ""};
	const int tiles = plan_tiles(&shard->plan);
	struct finished_tile tile;
	int next = 0;

	for (int pose = 0; next == 0 && pose < (int)shard->plan.info.poses; pose++) {
		while ((next = shard_next(shard, &tile, &fault)) == 1) {
			if (tile.pose != pose || tile.tile < 0 || tile.tile >= tiles ||
			    ((int64_t)pose * tiles + tile.tile) % shard->place.count !=
				    shard->place.index)
				abort();
			finished_tile_free(&tile);
		}
		if (next ? !fault.text[0] : !shard->peak)
			abort();
	}
}

static void read_shard(const uint8_t *data, size_t bytes)
{
	struct fault fault = {.text = ""};
	struct shard shard;

	if (shard_open(&shard, as_file(data, bytes), &fault) == 0) {
		if (!shard_same_bake(&shard, &shard))
			abort();
		read_tiles(&shard);
	} else if (!fault.text[0] || shard.stream) {
		abort();
	}
	shard_close(&shard);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t bytes)
{
	uint8_t *copy = malloc(bytes + 1);

	if (!copy)
		abort();
	read_shard(data, bytes);
	memcpy(copy, data, bytes);
	reseal_shard(copy, bytes);
	read_shard(copy, bytes);
	free(copy);
	return 0;
}
