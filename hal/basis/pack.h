/* SPDX-License-Identifier: MIT */
/*
 * Packs coverage and payloads of a pose into a PACK chunk (basis_format.h), and back: arrays become
 * differences between neighbours, are sorted by kind, and compressed by zstd. Private to hal/basis.
 */
#ifndef INLAY_HAL_BASIS_PACK_H
#define INLAY_HAL_BASIS_PACK_H

#include <stdint.h>

#include "hal/basis/basis_reader.h"

struct basis_blocks_chunk; /* basis_blocks.h */

/* ---- packing ---- */

struct packer;

int packer_create(struct packer **packer, int coarse);

/* Adds the next payload of the pose. -ENOMEM. */
int packer_add(struct packer *packer, const struct basis_block_entry *entry, const void *payload);

/* Ends the pose and returns its chunk, which the packer owns until the next packer_add(). */
int packer_finish(struct packer *packer, const uint16_t *coverage, size_t pixels,
		  const void **chunk, size_t *bytes);

void packer_destroy(struct packer *packer); /* NULL is harmless */

/* ---- unpacking ---- */

/* An open chunk, whose numbers are checked against the block list of the pose. */
struct pack {
	const struct basis_pack_part *part;
	int parts;
	uint64_t data_bytes; /* of all payloads, as the block entries say */
	/* private */
	const struct basis_block_entry *entries;
	int coarse;
	const uint8_t *coverage;
	size_t coverage_bytes;
	struct pack_place *place; /* [parts] */
};

/* blocks: the list of the pose, already checked by basis_check_shapes(). chunk must stay. -EBADMSG,
 * -ENOMEM. */
int pack_open(struct pack *pack, const struct basis_reader *reader, const void *chunk, size_t bytes,
	      const struct basis_blocks_chunk *blocks);
void pack_close(struct pack *pack); /* zeroed is fine */

/* coverage: [pixels]. -EBADMSG: another number of pixels, or damaged. */
int pack_coverage(const struct pack *pack, uint16_t *coverage, size_t pixels);

/* Unpacks the payloads of a part to their places in data [data_bytes]. Several threads may unpack
 * different parts. -EBADMSG, -ENOMEM. */
int pack_unpack(const struct pack *pack, int part, uint8_t *data);

#endif
