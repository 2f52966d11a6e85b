/* SPDX-License-Identifier: MIT */
/* How fast memory can be read at all, and what copying a picture takes. For bench alone. */
#ifndef INLAY_APP_BENCH_BENCH_MEMORY_H
#define INLAY_APP_BENCH_BENCH_MEMORY_H

#include <stddef.h>
#include <stdint.h>

#include "hal/base/pool.h"

/* Memory to read, none of it shared. */
struct bench_reading {
	uint8_t *data;
	size_t bytes;
};

int reading_create(struct bench_reading *reading, size_t bytes); /* -ENOMEM */
void reading_free(struct bench_reading *reading);		 /* idempotent; zeroed is fine */

/* Reads the first bytes of it once, front to back, with the widest vectors that the processor has,
 * each of the pool's threads a part. Returns what was in it, xor-ed, so that nothing can be left
 * out. */
uint64_t reading_run(const struct bench_reading *reading, size_t bytes, struct pool *pool);

/* What its vectors are called: "avx512f", ... */
const char *reading_vectors(void);

#endif
