/* SPDX-License-Identifier: MIT */
/*
 * A share of a bake: every count-th tile of all poses', finished, in a file of its own. All shards
 * together make the basis file that one run would make, bit for bit.
 *
 * A shard is read by the program version that wrote it, for the same version of basis files, on a
 * machine of the same byte order.
 */
#ifndef INLAY_BAKE_TILES_SHARD_H
#define INLAY_BAKE_TILES_SHARD_H

#include <stdbool.h>

#include "bake/tiles/finished_tile.h"
#include "bake/tiles/plan.h"
#include "hal/base/fault.h"

#define SHARDS_MAX 4096

/* Tiles whose number n, counted through all poses, has n % count == index. */
struct shard_place {
	int index, count;
};

/* The first of a pose's tiles that is in a shard, counted from the pose's first; tiles: of a pose.
 */
int shard_first(const struct shard_place *place, int tiles, int pose);

/* ---- writing ---- */

struct shard_writer;

/* The file appears when it is whole. */
int shard_writer_open(struct shard_writer **writer, const struct plan *plan,
		      const struct shard_place *place, const char *path, struct fault *fault);

/* Its tiles in the order of poses, and ascending. */
int shard_writer_add(struct shard_writer *writer, const struct finished_tile *tile,
		     struct fault *fault);

/* After its last tile of each pose, were it none. */
int shard_writer_pose_end(struct shard_writer *writer, const float (*peak)[3], struct fault *fault);

/* After the last pose. Frees the writer, also on failure. */
int shard_writer_finish(struct shard_writer *writer, struct fault *fault);

void shard_writer_abandon(struct shard_writer *writer); /* NULL is harmless */

/* ---- reading ---- */

struct shard {
	struct plan plan;
	struct shard_place place;
	float (*peak)[3]; /* [lights + 1], of the pose whose last tile was read last */
	/* private */
	struct shard_stream *stream;
};

/* -EBADMSG: no shard, damaged, cut off; -ENOTSUP: of another version; -ENOENT ... Nothing is left
 * open on failure. */
int shard_open(struct shard *shard, const char *path, struct fault *fault);

/* The next tile, to be freed by the caller. 1; 0: that was the last of its pose, and peak is known;
 * -EBADMSG, also after the last pose. */
int shard_next(struct shard *shard, struct finished_tile *tile, struct fault *fault);

/* Whether both belong to the same bake. */
bool shard_same_bake(const struct shard *a, const struct shard *b);

void shard_close(struct shard *shard); /* idempotent; zeroed is fine */

#endif
