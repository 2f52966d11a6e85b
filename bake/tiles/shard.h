/* SPDX-License-Identifier: MIT */
/*
 * Shards: each is a file with every count-th finished tile of a bake, counted through all poses.
 * All shards together make the same basis file as one run, bit for bit.
 *
 * A shard can be read only by the program version that wrote it, for the same version of basis
 * files, on a machine of the same byte order.
 */
#ifndef INLAY_BAKE_TILES_SHARD_H
#define INLAY_BAKE_TILES_SHARD_H

#include <stdbool.h>

#include "bake/tiles/finished_tile.h"
#include "bake/tiles/plan.h"
#include "hal/base/fault.h"

#define SHARDS_MAX 4096

/* The tiles of a shard: those whose number n, counted through all poses, has n % count == index. */
struct shard_place {
	int index, count;
};

/* Returns the first tile of a pose that belongs to a shard. tiles: number of tiles of a pose. */
int shard_first(const struct shard_place *place, int tiles, int pose);

/* ---- writing ---- */

struct shard_writer;

/* Begins a shard file, which appears at path when it is finished. */
int shard_writer_open(struct shard_writer **writer, const struct plan *plan,
		      const struct shard_place *place, const char *path, struct fault *fault);

/* Adds the shard's next tile: by poses, ascending in each. */
int shard_writer_add(struct shard_writer *writer, const struct finished_tile *tile,
		     struct fault *fault);

/* Ends a pose after the shard's last tile of it, even if it has none. */
int shard_writer_pose_end(struct shard_writer *writer, const float (*peak)[3],
			  const struct basis_footprint *foot, struct fault *fault);

/* Finishes the file after the last pose. Frees the writer, also on failure. */
int shard_writer_finish(struct shard_writer *writer, struct fault *fault);

/* Drops the file and frees the writer. NULL is harmless. */
void shard_writer_abandon(struct shard_writer *writer);

/* ---- reading ---- */

struct shard {
	struct plan plan;
	struct shard_place place;
	/* Peaks and footprint of the last pose that was read to its end. */
	float (*peak)[3]; /* [lights + 1]; NULL: there is none yet */
	struct basis_footprint foot;
	/* private */
	struct shard_stream *stream;
};

/* Opens a shard and reads its plan. -EBADMSG: it is no shard, damaged, or cut off; -ENOTSUP: it is
 * of another version; -ENOENT ... On failure nothing stays open. */
int shard_open(struct shard *shard, const char *path, struct fault *fault);

/* Reads the next tile, which the caller frees. Returns 1, or 0 if the pose has no more tiles; peak
 * and foot are then set. -EBADMSG: the shard is damaged, or has no more poses; -ENOMEM. */
int shard_next(struct shard *shard, struct finished_tile *tile, struct fault *fault);

/* Tells whether two shards belong to the same bake. */
bool shard_same_bake(const struct shard *a, const struct shard *b);

void shard_close(struct shard *shard); /* idempotent; zeroed is fine */

#endif
