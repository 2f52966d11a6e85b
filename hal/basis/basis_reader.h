/* SPDX-License-Identifier: MIT */
/* What the parts of the reader share. Private to hal/basis. */
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

#endif
