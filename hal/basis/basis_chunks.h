/* SPDX-License-Identifier: MIT */
/* Finds and checks the chunks of a basis file. Private to hal/basis. */
#ifndef INLAY_HAL_BASIS_BASIS_CHUNKS_H
#define INLAY_HAL_BASIS_BASIS_CHUNKS_H

#include "hal/basis/basis_reader.h"

/* The chunks of a pose; NULL: the file does not have it. */
struct basis_pose_chunks {
	const struct basis_chunk_entry *coverage, *peak, *blocks, *data, *exact_blocks, *exact_data,
		*pack, *glass, *mirror, *places;
};

struct basis_chunk_map {
	const struct basis_chunk_entry *table;
	uint32_t count;
	const struct basis_chunk_entry *info, *dome, *ground, *coarse, *names, *feet, *camera,
		*provenance;
	struct basis_pose_chunks *poses; /* of basis_find_pose_chunks(); the caller frees it */
};

/* Checks header, chunk table, gaps, and the checksums of all chunks that reader->part needs. Finds
 * the chunks that all poses share. -EBADMSG, -ENOTSUP, -ENOMEM. */
int basis_find_chunks(const struct basis_reader *reader, struct basis_chunk_map *map);

/* Finds the chunks of each of the basis->info.poses poses. -EBADMSG, -ENOMEM. */
int basis_find_pose_chunks(const struct basis_reader *reader, struct basis_chunk_map *map);

#endif
