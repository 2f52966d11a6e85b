/* SPDX-License-Identifier: MIT */
#include "app/bench/bench_memory.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>

#include "hal/base/processor.h"

#define HUGE_PAGE ((size_t)2 << 20)
#define STEP 512 /* bytes of one round of the loop */

typedef uint64_t wide __attribute__((vector_size(64)));

/* The same loop for several instruction sets: 64 bytes are one or more registers. */
#define READER(name, attributes)                                                                   \
	attributes static uint64_t name(const uint8_t *data, size_t bytes)                         \
	{                                                                                          \
		const wide *v = (const wide *)(const void *)data;                                  \
		wide sum[8] = {{0}};                                                               \
		uint64_t all = 0;                                                                  \
                                                                                                   \
		for (size_t n = bytes / STEP; n; n--, v += 8) {                                    \
			for (int k = 0; k < 8; k++)                                                \
				sum[k] ^= v[k];                                                    \
		}                                                                                  \
		for (int k = 0; k < 64; k++)                                                       \
			all ^= sum[k / 8][k % 8];                                                  \
		return all;                                                                        \
	}

READER(read_plain, )
#if defined(__x86_64__)
READER(read_avx2, __attribute__((target("avx2"))))
READER(read_avx512, __attribute__((target("avx512f"))))
#endif

struct reading_kernel {
	const char *name;
	uint64_t (*read)(const uint8_t *data, size_t bytes);
};

static struct reading_kernel choose_reader(void)
{
#if defined(__x86_64__)
	if (processor_features() & PROCESSOR_AVX512)
		return (struct reading_kernel){"avx512f", read_avx512};
	if (processor_features() & PROCESSOR_AVX2)
		return (struct reading_kernel){"avx2", read_avx2};
#endif
	return (struct reading_kernel){"baseline", read_plain};
}

const char *reading_vectors(void)
{
	return choose_reader().name;
}

int reading_create(struct bench_reading *reading, size_t bytes)
{
	*reading = (struct bench_reading){.bytes = (bytes + HUGE_PAGE) & ~(HUGE_PAGE - 1)};
	reading->data = aligned_alloc(HUGE_PAGE, reading->bytes);
	if (!reading->data) {
		reading->bytes = 0;
		return -ENOMEM;
	}
	/* Large pages keep walks through page tables out of the bound. A kernel without them does
	 * not matter. */
	(void)madvise(reading->data, reading->bytes, MADV_HUGEPAGE);
	memset(reading->data, 1, reading->bytes);
	return 0;
}

void reading_free(struct bench_reading *reading)
{
	free(reading->data);
	*reading = (struct bench_reading){.data = NULL};
}

struct reading_job {
	const uint8_t *data;
	size_t bytes;
	int parts;
	struct reading_kernel reader;
	uint64_t sum[POOL_THREADS_MAX];
};

static void read_part(void *context, int item, int worker)
{
	struct reading_job *w = context;
	const size_t steps = w->bytes / STEP;
	const size_t first = steps * (size_t)item / (size_t)w->parts;
	const size_t end = steps * ((size_t)item + 1) / (size_t)w->parts;

	w->sum[worker] ^= w->reader.read(w->data + first * STEP, (end - first) * STEP);
}

uint64_t reading_run(const struct bench_reading *reading, size_t bytes, struct pool *pool)
{
	struct reading_job w = {.data = reading->data, .parts = 1, .reader = choose_reader()};
	uint64_t all = 0;

	w.bytes = (bytes + STEP - 1) / STEP * STEP;
	w.bytes = w.bytes < reading->bytes ? w.bytes : reading->bytes;
	if (pool_threads(pool) > 1)
		w.parts = pool_threads(pool) * 4;
	pool_run(pool, w.parts, read_part, &w);
	for (int k = 0; k < pool_threads(pool); k++)
		all ^= w.sum[k];
	return all;
}
