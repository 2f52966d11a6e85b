/* SPDX-License-Identifier: MIT */
/* What the parts of the reader share. Private to hal/basis. */
#ifndef INLAY_HAL_BASIS_BASIS_READER_H
#define INLAY_HAL_BASIS_BASIS_READER_H

#include <stdbool.h>

#include "hal/basis/basis.h"

struct basis_file;

struct basis_reader {
	struct basis *basis;
	const uint8_t *data;
	size_t bytes;
	const char *name;
	enum basis_part part;
	const struct basis_file *file; /* NULL: data is the caller's memory, and all there */
	struct fault *fault;
};

/* Says "NAME: damaged basis file: ..." and returns -EBADMSG. */
int basis_damaged(const struct basis_reader *reader, const char *format, ...)
	__attribute__((format(printf, 2, 3)));

/* Padding is checked so that no byte of a file is beyond its checks. */
bool basis_all_zero(const uint8_t *from, const uint8_t *to);

/* A small file may not take much memory: whatever is made of `held` bytes of a file, beyond what a
 * picture of 3840x2160 pixels needs, is at most so many times as long. Files of a bake stay below
 * a tenth of that. */
#define BASIS_MADE_FREE ((uint64_t)16 << 20)
#define BASIS_MADE_TIMES 64

static inline bool basis_is_bomb(uint64_t made, uint64_t held)
{
	return made > BASIS_MADE_FREE && (made - BASIS_MADE_FREE) / BASIS_MADE_TIMES >= held;
}

/* Where the chunks lie; NULL for those that the file does not have. */
struct basis_pose_chunks {
	const struct basis_chunk_entry *coverage, *peak, *blocks, *data, *exact_blocks, *exact_data,
		*pack, *glass;
};

struct basis_chunk_map {
	const struct basis_chunk_entry *table;
	uint32_t count;
	const struct basis_chunk_entry *info, *dome, *ground, *coarse, *names, *camera, *provenance;
	struct basis_pose_chunks *poses; /* by basis_find_pose_chunks(); to be freed */
};

/* Checks header, chunk table, gaps and the checksums of all chunks that reader->part needs, and
 * finds those that poses share. -EBADMSG, -ENOTSUP, -ENOMEM. */
int basis_find_chunks(const struct basis_reader *reader, struct basis_chunk_map *map);

/* Those of each of basis->info.poses poses. -EBADMSG, -ENOMEM. */
int basis_find_pose_chunks(const struct basis_reader *reader, struct basis_chunk_map *map);

/* Checks what is seen through the object of a pose, and fills it in. chunk may be NULL. -EBADMSG.
 */
int basis_read_glass(const struct basis_reader *reader, const struct basis_chunk_entry *chunk,
		     struct basis_pose *pose);

/* A layer's block list and payloads, as found in the file. */
struct basis_blocks_chunk {
	const struct basis_block_entry *entries;
	size_t count;
	const uint8_t *data;
	size_t data_bytes;
	int pose;
	bool exact;
};

/* Checks the list alone, of payloads that lie one behind the other: whatever basis_layout() asks
 * for is in its range, and data_bytes is right. -EBADMSG. */
int basis_check_shapes(const struct basis_reader *reader, const struct basis_blocks_chunk *chunk);

/* Checks every block of a layer and fills it. -EBADMSG, -ENOMEM. */
int basis_read_blocks(const struct basis_reader *reader, const struct basis_blocks_chunk *chunk,
		      struct basis_layer *layer);

#endif
