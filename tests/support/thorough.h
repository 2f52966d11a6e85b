/* SPDX-License-Identifier: MIT */
/*
 * How much a test tries. `make test-thorough` sets INLAY_THOROUGH=1: statistics draw their whole
 * sample, and grids have all their points. Otherwise, and under a sanitizer, which makes everything
 * ten times as slow, a test tries a part of the same.
 */
#ifndef INLAY_TESTS_SUPPORT_THOROUGH_H
#define INLAY_TESTS_SUPPORT_THOROUGH_H

#include <stdbool.h>

/* 1 where the address or thread sanitizer is compiled in, else 0. */
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define SANITIZED 1
#else
#define SANITIZED 0
#endif

bool thorough(void);

#endif
