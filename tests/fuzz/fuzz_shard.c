/* Any bytes as a share of a bake: refused in a sentence, or tiles that belong to it up to the last.
 */
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <unistd.h>

#include "bake/shard.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t bytes);

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

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t bytes)
{
	static int file = -1;
	struct fault fault = {.text = ""};
	struct shard shard;
	char path[64];

	if (file < 0)
		file = memfd_create("shard", MFD_CLOEXEC);
	if (file < 0 || ftruncate(file, 0) || pwrite(file, data, bytes, 0) != (ssize_t)bytes)
		abort();
	snprintf(path, sizeof(path), "/proc/self/fd/%d", file);
	if (shard_open(&shard, path, &fault) == 0) {
		if (!shard_same_bake(&shard, &shard))
			abort();
		read_tiles(&shard);
	} else if (!fault.text[0] || shard.stream) {
		abort();
	}
	shard_close(&shard);
	return 0;
}
