/* SPDX-License-Identifier: MIT */
/*
 * Memory whose end lies on a page that may not be touched, so that whoever reads or writes beyond
 * it is killed, and that has known bytes before it.
 */
#ifndef INLAY_TESTS_KERNELS_GUARDED_H
#define INLAY_TESTS_KERNELS_GUARDED_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct guarded {
	uint8_t *map; /* private */
	size_t map_bytes, capacity;
	uint8_t *end;
};

void guarded_create(struct guarded *g, size_t capacity); /* ends the program where it cannot */

/* The last bytes of it; what is before them is filled with known ones. As aligned as its size. */
void *guarded_take(struct guarded *g, size_t bytes);

bool guarded_intact(const struct guarded *g, size_t bytes); /* what is before the last bytes */

void guarded_free(struct guarded *g);

#endif
