/* SPDX-License-Identifier: MIT */
/* All times are int64 nanoseconds of CLOCK_MONOTONIC, never floating point. */
#ifndef INLAY_HAL_BASE_CLOCK_H
#define INLAY_HAL_BASE_CLOCK_H

#include <stdint.h>
#include <time.h>

#define NS_PER_S INT64_C(1000000000)
#define NS_PER_MS INT64_C(1000000)

static inline int64_t clock_now_ns(void)
{
	struct timespec t;

	clock_gettime(CLOCK_MONOTONIC, &t);
	return (int64_t)t.tv_sec * NS_PER_S + t.tv_nsec;
}

#endif
