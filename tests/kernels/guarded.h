/* SPDX-License-Identifier: MIT */
/* Memory that ends at a page that may not be touched, so that a kernel that reads or writes beyond
 * its end is killed. The bytes before it have known values, which guarded_intact() checks. */
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

void guarded_create(struct guarded *g,
		    size_t capacity); /* ends the program where memory is short */

/* The last `bytes` bytes; the bytes before them are set to known values. Aligned as far as the size
 * is. */
void *guarded_take(struct guarded *g, size_t bytes);

bool guarded_intact(const struct guarded *g,
		    size_t bytes); /* whether the bytes before the last ones are unchanged */

void guarded_free(struct guarded *g);

#endif
