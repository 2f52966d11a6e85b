/* SPDX-License-Identifier: MIT */
/* The state that all parts of the reader share. Private to hal/basis. */
#ifndef INLAY_HAL_BASIS_BASIS_READER_H
#define INLAY_HAL_BASIS_BASIS_READER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "hal/basis/basis.h"

struct basis_file;

struct basis_reader {
	struct basis *basis;
	const uint8_t *data;
	size_t bytes;
	const char *name;
	enum basis_part part;
	const struct basis_file *file; /* NULL: data is the caller's memory, complete */
	struct fault *fault;
};

/* Sets the fault to "NAME: damaged basis file: ..." and returns -EBADMSG. */
int basis_damaged(const struct basis_reader *reader, const char *format, ...)
	__attribute__((format(printf, 2, 3)));

/* Whether all bytes from..to - 1 are 0. Padding is checked too, so every byte of a file is. */
bool basis_all_zero(const uint8_t *from, const uint8_t *to);

/* Limit against decompression bombs. `made` bytes of memory may come from `held` bytes of a file if
 *     made <= BASIS_MADE_FREE  or  made - BASIS_MADE_FREE < BASIS_MADE_TIMES * held
 * BASIS_MADE_FREE is enough for a picture of 3840x2160 pixels. Baked files stay below a tenth of
 * BASIS_MADE_TIMES. */
#define BASIS_MADE_FREE ((uint64_t)16 << 20)
#define BASIS_MADE_TIMES 64

static inline bool basis_is_bomb(uint64_t made, uint64_t held)
{
	return made > BASIS_MADE_FREE && (made - BASIS_MADE_FREE) / BASIS_MADE_TIMES >= held;
}

#endif
