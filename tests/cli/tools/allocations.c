/* SPDX-License-Identifier: MIT */
/*
 * Loaded before a program (LD_PRELOAD), counts its heap allocations by the turns of its event loop:
 * the loop begins with the first epoll_wait(); what is allocated from a second and SETTLING_TURNS
 * turns later (a busy machine makes few in a second) until the last epoll_wait() is counted. Says
 * so at the end in the file that ALLOCATIONS names:
 *     before NUMBER after NUMBER turns NUMBER
 */
#include <dlfcn.h>
#include <malloc.h>
#include <stdatomic.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/epoll.h>
#include <time.h>

#define SETTLING_NS INT64_C(1000000000)
#define SETTLING_TURNS 60

/* glibc's own functions, under their other names, because dlsym() itself allocates. */
void *__libc_malloc(size_t bytes);
void *__libc_calloc(size_t count, size_t bytes);
void *__libc_realloc(void *old, size_t bytes);
void *__libc_memalign(size_t alignment, size_t bytes);

static atomic_llong before, after, after_at_last_turn, turns;
static atomic_int_fast64_t settled_ns; /* 0: the loop has not begun */

static int64_t now_ns(void)
{
	struct timespec t;

	clock_gettime(CLOCK_MONOTONIC, &t);
	return (int64_t)t.tv_sec * 1000000000 + t.tv_nsec;
}

static void note(void)
{
	int64_t settled = settled_ns;

	if (settled && turns >= SETTLING_TURNS && now_ns() >= settled)
		after++;
	else
		before++;
}

void *malloc(size_t bytes)
{
	note();
	return __libc_malloc(bytes);
}

void *calloc(size_t count, size_t bytes)
{
	note();
	return __libc_calloc(count, bytes);
}

void *realloc(void *old, size_t bytes)
{
	note();
	return __libc_realloc(old, bytes);
}

void *memalign(size_t alignment, size_t bytes)
{
	note();
	return __libc_memalign(alignment, bytes);
}

void *aligned_alloc(size_t alignment, size_t bytes)
{
	note();
	return __libc_memalign(alignment, bytes);
}

int posix_memalign(void **out, size_t alignment, size_t bytes)
{
	note();
	*out = __libc_memalign(alignment, bytes);
	return *out ? 0 : 12; /* ENOMEM, which is returned and not set in errno */
}

int epoll_wait(int epoll, struct epoll_event *events, int room, int timeout)
{
	static int (*real)(int, struct epoll_event *, int, int);

	if (!real)
		*(void **)&real = dlsym(RTLD_NEXT, "epoll_wait");
	if (!settled_ns)
		settled_ns = now_ns() + SETTLING_NS;
	turns++;
	after_at_last_turn = after;
	return real(epoll, events, room, timeout);
}

__attribute__((destructor)) static void tell(void)
{
	const char *path = getenv("ALLOCATIONS");
	FILE *stream = path ? fopen(path, "w") : NULL;

	if (!stream)
		return;
	fprintf(stream, "before %lld after %lld turns %lld\n", before, after_at_last_turn, turns);
	fclose(stream);
}
