/* SPDX-License-Identifier: MIT */
#include "tests/kernels/guarded.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#define FRONT 256
#define KNOWN 0xa5

void guarded_create(struct guarded *g, size_t capacity)
{
	const size_t page = (size_t)sysconf(_SC_PAGESIZE);
	const size_t inside = (capacity + FRONT + page - 1) / page * page;

	g->capacity = capacity;
	g->map_bytes = inside + page;
	g->map = mmap(NULL, g->map_bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1,
		      0);
	if (g->map == MAP_FAILED || mprotect(g->map + inside, page, PROT_NONE) < 0) {
		perror("test_kernels: mmap");
		exit(1);
	}
	g->end = g->map + inside;
}

void *guarded_take(struct guarded *g, size_t bytes)
{
	if (bytes > g->capacity) {
		fprintf(stderr, "test_kernels: %zu bytes of %zu\n", bytes, g->capacity);
		exit(1);
	}
	memset(g->end - bytes - FRONT, KNOWN, FRONT);
	return g->end - bytes;
}

bool guarded_intact(const struct guarded *g, size_t bytes)
{
	for (const uint8_t *p = g->end - bytes - FRONT; p < g->end - bytes; p++) {
		if (*p != KNOWN)
			return false;
	}
	return true;
}

void guarded_free(struct guarded *g)
{
	munmap(g->map, g->map_bytes);
}
