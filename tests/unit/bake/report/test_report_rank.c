/* SPDX-License-Identifier: MIT */
/* A report calls one choice better than another, or both equal: by noise and spread of times. */
#include "bake/report/report_rank.h"
#include "tests/support/expect.h"
#include "tests/support/test.h"

/* A result whose quartiles are 2 % from its median. */
static struct report_result result(double ms, double rms)
{
	return (struct report_result){
		.ms = ms, .ms_low = 0.98 * ms, .ms_high = 1.02 * ms, .rms = rms};
}

/* Whether a beats b. */
static bool beats(struct report_result a, struct report_result b, double noise)
{
	const struct report_result both[] = {a, b};

	return report_is_front(both, 2, 0, noise) && !report_is_front(both, 2, 1, noise);
}

TEST("errors within the noise are equal")
{
	/* 1.3^2 - 1.2^2 = 0.25 = 0.5^2 */
	assert_true(beats(result(1, 1.2), result(1, 1.3), 0.49));
	assert_false(beats(result(1, 1.2), result(1, 1.3), 0.51));
	assert_false(beats(result(1, 1.2), result(1, 1.2), 0));
	/* without noise they are equal up to 1 % */
	assert_false(beats(result(1, 1), result(1, 1.009), 0));
	assert_true(beats(result(1, 1), result(1, 1.011), 0));
}

TEST("times within their spread are equal")
{
	struct report_result wide = result(1.06, 1), close = result(1.045, 1);

	assert_true(beats(result(1, 1), wide, 0));
	wide.ms_low = 1.01; /* the quartiles overlap */
	assert_false(beats(result(1, 1), wide, 0));
	close.ms_low = close.ms_high = close.ms;
	assert_false(beats(result(1, 1), close, 0));
}

TEST("what is better in nothing is not in front")
{
	const struct report_result results[] = {
		result(1, 3),	     /* the fastest */
		result(2, 1),	     /* the nearest */
		result(2, 3),	     /* beaten by both */
		result(1.5, 2),	     /* between them */
		result(1.51, 2.005), /* as that one */
		result(1.5, 3),	     /* as near as the fastest */
	};
	static const bool front[] = {true, true, false, true, true, false};

	for (int k = 0; k < 6; k++)
		expect_equal(report_is_front(results, 6, k, 0.2), front[k], "k=%d", k);
}
