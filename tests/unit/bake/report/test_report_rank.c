/* SPDX-License-Identifier: MIT */
/* A report calls one choice better than another, or both equal: by noise, spread of times,
 * order. */
#include "bake/report/report_rank.h"
#include "tests/support/expect.h"
#include "tests/support/test.h"

/* A result whose quartiles are 2 % from its median. */
static struct report_result result(double ms, double rms, double noise)
{
	return (struct report_result){
		.ms = ms, .ms_low = 0.98 * ms, .ms_high = 1.02 * ms, .rms = rms, .noise = noise};
}

TEST("errors within the noise are equal")
{
	/* 1.3^2 - 1.2^2 = 0.25 = 0.5^2 */
	const struct report_result a = result(1, 1.2, 0.49), b = result(1, 1.3, 0.49);
	const struct report_result c = result(1, 1.2, 0.51), d = result(1, 1.3, 0.51);
	const struct report_result quiet = result(1, 1.2, 0), loud = result(1, 1.3, 0.51);

	assert_true(report_is_nearer(&a, &b));
	assert_false(report_is_nearer(&b, &a));
	assert_false(report_is_nearer(&c, &d));
	assert_false(report_is_nearer(&d, &c));
	assert_false(report_is_nearer(&quiet, &loud)); /* the larger noise counts */
	assert_false(report_is_nearer(&a, &a));
}

/* Without noise, errors are equal up to 1 %. */
TEST("errors without noise are told apart")
{
	const struct report_result a = result(1, 1, 0), b = result(1, 1.009, 0),
				   c = result(1, 1.011, 0);

	assert_false(report_is_nearer(&a, &b));
	assert_true(report_is_nearer(&a, &c));
}

TEST("times within their spread are equal")
{
	const struct report_result a = result(1, 1, 0), b = result(1.06, 1, 0);
	struct report_result wide = b, close = result(1.045, 1, 0);

	assert_true(report_is_faster(&a, &b));
	assert_false(report_is_faster(&b, &a));
	wide.ms_low = 1.01; /* the quartiles overlap */
	assert_false(report_is_faster(&a, &wide));
	close.ms_low = close.ms_high = close.ms;
	assert_false(report_is_faster(&a, &close));
}

TEST("what is better in nothing is not in front")
{
	const struct report_result results[] = {
		result(1, 3, 0.2),	  /* the fastest */
		result(2, 1, 0.2),	  /* the nearest */
		result(2, 3, 0.2),	  /* beaten by both */
		result(1.5, 2, 0.2),	  /* between them */
		result(1.51, 2.005, 0.2), /* as that one */
		result(1.5, 3, 0.2),	  /* as near as the fastest */
	};
	static const bool front[] = {true, true, false, true, true, false};

	for (int k = 0; k < 6; k++)
		expect_equal(report_is_front(results, 6, k), front[k], "k=%d", k);
}

TEST("chosen is the fastest of the nearest")
{
	/* 2.1^2 - 2^2 = 0.41 < 0.7^2 < 2.3^2 - 2^2: the first three are equally near */
	const struct report_result results[] = {result(3, 2, 0.7), result(2, 2.1, 0.7),
						result(2.01, 2, 0.7), result(1, 2.3, 0.7)};
	static const bool expected[] = {true, true, true, false};
	bool near[4];

	assert_int_equal(report_choose(results, 4, near), 1);
	for (int k = 0; k < 4; k++)
		expect_equal(near[k], expected[k], "k=%d", k);
	/* among two that are as fast the first one is preferred */
	assert_int_equal(report_choose(results + 1, 2, near), 0);
	assert_int_equal(report_choose(results, 1, near), 0);
	assert_int_equal(report_choose(results, 0, near), -1);
}
