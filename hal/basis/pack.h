/* SPDX-License-Identifier: MIT */
/*
 * A pose's coverage and payloads as they lie in a PACK chunk (basis_format.h): each array is turned
 * into what differs from its neighbours, sorted by kind, and compressed by zstd. Private to
 * hal/basis.
 */
#ifndef INLAY_HAL_BASIS_PACK_H
#define INLAY_HAL_BASIS_PACK_H

#include <stdint.h>

#include "hal/basis/basis_reader.h"

struct basis_blocks_chunk; /* basis_blocks.h */

/* ---- packing ---- */

struct packer;

int packer_create(struct packer **packer, int coarse);

/* The next payload of the pose. -ENOMEM. */
int packer_add(struct packer *packer, const struct basis_block_entry *entry, const void *payload);

/* Ends the pose: the whole chunk, owned by the packer, until the next packer_add(). */
int packer_finish(struct packer *packer, const uint16_t *coverage, size_t pixels,
		  const void **chunk, size_t *bytes);

void packer_destroy(struct packer *packer); /* NULL is harmless */

/* ---- and back ---- */

/* A chunk taken apart; its numbers are checked against the pose's block list. */
struct pack {
	const struct basis_pack_part *part;
	int parts;
	uint64_t data_bytes; /* of the payloads, as block entries count */
	/* private */
	const struct basis_block_entry *entries;
	int coarse;
	const uint8_t *coverage;
	size_t coverage_bytes;
	struct pack_place *place; /* [parts] */
};

/* blocks: the pose's list, whose shapes have been checked (basis_check_shapes()). -EBADMSG,
 * -ENOMEM.
 */
int pack_open(struct pack *pack, const struct basis_reader *reader, const void *chunk, size_t bytes,
	      const struct basis_blocks_chunk *blocks);
void pack_close(struct pack *pack); /* zeroed is fine */

/* coverage: [pixels]. -EBADMSG: not so many, or not zstd's. */
int pack_coverage(const struct pack *pack, uint16_t *coverage, size_t pixels);

/* Writes the payloads of a part where they belong; data: [data_bytes]. Parts may be unpacked by
 * several threads. -EBADMSG, -ENOMEM. */
int pack_unpack(const struct pack *pack, int part, uint8_t *data);

#endif
