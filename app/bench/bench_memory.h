/* SPDX-License-Identifier: MIT */
/* How fast memory can be read at all. For bench alone. */
#ifndef INLAY_APP_BENCH_BENCH_MEMORY_H
#define INLAY_APP_BENCH_BENCH_MEMORY_H

#include <stddef.h>
#include <stdint.h>

#include "hal/base/pool.h"

/* Memory to be read, every page of it present. */
struct bench_reading {
	uint8_t *data;
	size_t bytes;
};

int reading_create(struct bench_reading *reading, size_t bytes); /* -ENOMEM */
void reading_free(struct bench_reading *reading);		 /* idempotent; zeroed is fine */

/* Reads the first bytes once, front to back, with the widest vectors of the processor; each thread
 * of the pool reads parts. Returns the exclusive or of all words, so that the compiler cannot leave
 * the reading out. */
uint64_t reading_run(const struct bench_reading *reading, size_t bytes, struct pool *pool);

/* Name of those vectors: "avx512f", ... */
const char *reading_vectors(void);

#endif
