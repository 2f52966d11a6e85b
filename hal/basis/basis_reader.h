/* What the parts of the reader share. Private to hal/basis. */
#ifndef INLAY_HAL_BASIS_BASIS_READER_H
#define INLAY_HAL_BASIS_BASIS_READER_H

#include <stdbool.h>

#include "hal/basis/basis.h"

struct basis_reader {
	struct basis *basis;
	const uint8_t *data;
	size_t bytes;
	const char *name;
	struct fault *fault;
};

/* Says "NAME: damaged basis file: ..." and returns -EBADMSG. */
int basis_damaged(const struct basis_reader *reader, const char *format, ...)
	__attribute__((format(printf, 2, 3)));

/* Padding is checked so that no byte of a file is beyond its checks. */
bool basis_all_zero(const uint8_t *from, const uint8_t *to);

/* A pose's block list and payloads, as found in the file. */
struct basis_blocks_chunk {
	const struct basis_block_entry *entries;
	size_t count;
	const uint8_t *data;
	size_t data_bytes;
};

/* Checks every block of a pose and fills pose->blocks and pose->tiles. -EBADMSG, -ENOMEM. */
int basis_read_blocks(const struct basis_reader *reader, int pose,
		      const struct basis_blocks_chunk *chunk);

#endif
