/* SPDX-License-Identifier: MIT */
/* How much a test tries. `make test-deep` sets INLAY_THOROUGH=1: statistics draw their whole
 * sample, and grids have all their points. Otherwise, and under a sanitizer, which makes everything
 * ten times as long, a test tries less of the same. */
#ifndef INLAY_TESTS_SUPPORT_THOROUGH_H
#define INLAY_TESTS_SUPPORT_THOROUGH_H

#include <stdbool.h>
#include <stdlib.h>

/* Whether a sanitizer watches. */
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define WATCHED 1
#else
#define WATCHED 0
#endif

static inline bool thorough(void)
{
	return !WATCHED && getenv("INLAY_THOROUGH");
}

#endif
