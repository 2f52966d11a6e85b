/* SPDX-License-Identifier: MIT */
/*
 * Checks inside loops, whose failure names the case. Each takes a printf format with its arguments,
 * which are evaluated only when the check fails:
 *
 *	expect_below(fabs(is - should), 0.5, "light %d of tile %d", light, tile);
 *
 * fails the test with "fabs(is - should) is 0.71, expected below 0.5: light 3 of tile 7
 * (INLAY_SEED=20261120)". Values are compared as long double, which holds every int64_t; NaN fails.
 * cmocka's own macros that begin with expect_ are for mocks.
 */
#ifndef INLAY_TESTS_SUPPORT_EXPECT_H
#define INLAY_TESTS_SUPPORT_EXPECT_H

#include <stddef.h>
#include <stdint.h>

#include "hal/base/fault.h"

#define expect_that(condition, ...)                                                                \
	do {                                                                                       \
		if (!(condition))                                                                  \
			expect_fail(__FILE__, __LINE__, #condition " is false", __VA_ARGS__);      \
	} while (0)

/* value < limit */
#define expect_below(value, limit, ...) expect_compared(value, <, limit, "below", __VA_ARGS__)

/* value <= limit */
#define expect_at_most(value, limit, ...) expect_compared(value, <=, limit, "at most", __VA_ARGS__)

/* value > limit */
#define expect_above(value, limit, ...) expect_compared(value, >, limit, "above", __VA_ARGS__)

/* value >= limit */
#define expect_at_least(value, limit, ...)                                                         \
	expect_compared(value, >=, limit, "at least", __VA_ARGS__)

/* value == should, exactly */
#define expect_equal(value, should, ...) expect_compared(value, ==, should, "equal to", __VA_ARGS__)

#define expect_compared(value, relation, limit, words, ...)                                        \
	do {                                                                                       \
		const long double expect_value_ = (value), expect_limit_ = (limit);                \
                                                                                                   \
		if (!(expect_value_ relation expect_limit_))                                       \
			expect_fail_number(__FILE__, __LINE__, #value, expect_value_, words,       \
					   expect_limit_, __VA_ARGS__);                            \
	} while (0)

/* Two pictures of 4 bytes a pixel are the same, byte by byte; the failure names the first pixel and
 * channel (0 to 3, as in memory) that differ. stride and bytes are of each picture. */
#define expect_same_picture(is, should, stride, bytes, ...)                                        \
	expect_picture(__FILE__, __LINE__, is, should, stride, bytes, __VA_ARGS__)

/* Fails the test with the fault's text where err is not 0. */
#define expect_success(err, fault) expect_no_fault(__FILE__, __LINE__, err, fault)

/* What the macros call. */
void expect_no_fault(const char *file, int line, int err, const struct fault *fault);
__attribute__((format(printf, 7, 8))) void expect_picture(const char *file, int line,
							  const uint8_t *is, const uint8_t *should,
							  size_t stride, size_t bytes,
							  const char *format, ...);
__attribute__((format(printf, 4, 5))) void expect_fail(const char *file, int line, const char *what,
						       const char *format, ...);
__attribute__((format(printf, 7, 8))) void expect_fail_number(const char *file, int line,
							      const char *what, long double value,
							      const char *words, long double limit,
							      const char *format, ...);

#endif
