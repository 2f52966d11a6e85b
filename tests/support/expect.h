/* SPDX-License-Identifier: MIT */
/*
 * Checks inside loops, whose failure names the case. Each takes a printf format with its arguments,
 * which are evaluated only when the check fails:
 *
 *	expect_below(fabs(is - should), 0.5, "light %d of tile %d", light, tile);
 *
 * fails the test with "fabs(is - should) is 0.71, expected below 0.5: light 3 of tile 7
 * (INLAY_SEED=20261120)". Values are compared as double; NaN fails. cmocka's own macros that begin
 * with expect_ are for mocks.
 */
#ifndef INLAY_TESTS_SUPPORT_EXPECT_H
#define INLAY_TESTS_SUPPORT_EXPECT_H

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

/* value == should, exactly; integers up to 2^53 */
#define expect_equal(value, should, ...) expect_compared(value, ==, should, "equal to", __VA_ARGS__)

#define expect_compared(value, relation, limit, words, ...)                                        \
	do {                                                                                       \
		const double expect_value_ = (double)(value), expect_limit_ = (double)(limit);     \
                                                                                                   \
		if (!(expect_value_ relation expect_limit_))                                       \
			expect_fail_number(__FILE__, __LINE__, #value, expect_value_, words,       \
					   expect_limit_, __VA_ARGS__);                            \
	} while (0)

/* What the macros call. */
__attribute__((format(printf, 4, 5))) void expect_fail(const char *file, int line, const char *what,
						       const char *format, ...);
__attribute__((format(printf, 7, 8))) void expect_fail_number(const char *file, int line,
							      const char *what, double value,
							      const char *words, double limit,
							      const char *format, ...);

#endif
