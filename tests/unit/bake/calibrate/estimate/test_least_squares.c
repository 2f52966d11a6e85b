/* SPDX-License-Identifier: MIT */
/* Least squares: problems with known solution and known uncertainty. */
#include <errno.h>
#include <math.h>
#include <string.h>

#include "bake/calibrate/estimate/least_squares.h"
#include "tests/support/chance.h"
#include "tests/support/expect.h"
#include "tests/support/test.h"

#define POINTS_MAX 400

static double gauss(struct chance *chance)
{
	return sqrt(-2 * log(chance_real(chance, 1e-300, 1))) *
	       cos(2 * M_PI * chance_real(chance, 0, 1));
}

/* y = a exp(b t) + c at t = 0..1; in pairs, the second number is y + t. */
struct decay {
	int count;
	double seen[POINTS_MAX];
	bool given_b_negative; /* no residuals for b > 0 */
	double blind;	       /* factor of the last parameter's effect */
};

static bool decay_residuals(void *context, const double *x, double *residual)
{
	const struct decay *d = context;

	if (d->given_b_negative && x[1] > 0)
		return false;
	for (int i = 0; i < d->count; i++) {
		const double t = (double)i / d->count;

		residual[i] = x[0] * exp(x[1] * t) + d->blind * x[2] - d->seen[i];
	}
	return true;
}

static void decay_slopes(void *context, const double *x, double *jacobian)
{
	const struct decay *d = context;

	for (int i = 0; i < d->count; i++) {
		const double t = (double)i / d->count;

		jacobian[3 * i] = exp(x[1] * t);
		jacobian[3 * i + 1] = x[0] * t * exp(x[1] * t);
		jacobian[3 * i + 2] = d->blind;
	}
}

static const double ones[] = {1, 1, 1};
static const double truth[] = {3, -2, 0.5};

static struct least_squares decay_problem(struct decay *d)
{
	return (struct least_squares){.parameters = 3,
				      .residuals = d->count,
				      .evaluate = decay_residuals,
				      .differentiate = decay_slopes,
				      .context = d,
				      .scale = ones,
				      .group = 1};
}

static void observe(struct decay *d, int count, double noise, struct chance *chance)
{
	const double zero[POINTS_MAX] = {0};

	*d = (struct decay){.count = count, .blind = 1};
	memcpy(d->seen, zero, sizeof(zero));
	decay_residuals(d, truth, d->seen);
	for (int i = 0; i < count; i++)
		d->seen[i] += noise > 0 ? noise * gauss(chance) : 0;
}

TEST("without noise")
{
	struct chance chance = chance_begin("least squares");

	for (int way = 0; way < 4; way++) {
		struct least_squares_fit fit;
		struct decay d;
		struct least_squares problem;
		double x[3] = {1, -0.5, 0};

		observe(&d, 50, 0, &chance);
		problem = decay_problem(&d);
		if (way & 1)
			problem.differentiate = NULL;
		if (way & 2)
			problem.loss_scale = 2.4;
		assert_int_equal(least_squares_solve(&problem, x, &fit, NULL), 0);
		for (int k = 0; k < 3; k++)
			expect_below(fabs(x[k] - truth[k]), 1e-11, "way=%d, k=%d", way, k);
		expect_below(fit.sigma, 1e-12, "way=%d", way);
		if (way <
		    /* the residuals are rounding errors, of which a robust loss may leave out
		     * some */
		    2)
			expect_equal(fit.freedom, 47, "way=%d", way);
		least_squares_free(&fit);
		least_squares_free(&fit);
	}
}

/* Far from 0 and in tiny units the result must be the same. */
TEST("whatever the units")
{
	static const double small[] = {1e-9, 1, 1e-9};
	struct chance chance = chance_begin("least squares");
	struct least_squares problem;
	struct least_squares_fit fit;
	struct decay d;
	double x[3] = {1e-9, -0.5, 0};

	observe(&d, 50, 0, &chance);
	for (int i = 0; i < d.count; i++)
		d.seen[i] *= 1e-9;
	problem = decay_problem(&d);
	problem.scale = small;
	assert_int_equal(least_squares_solve(&problem, x, &fit, NULL), 0);
	assert_true(fabs(x[0] / 3e-9 - 1) < 1e-9 && fabs(x[1] / -2 - 1) < 1e-9);
	least_squares_free(&fit);
}

/* A straight line, whose covariance has a closed form. */
TEST("covariance of a line")
{
	static const bool fixed[] = {false, true, false};
	struct chance chance = chance_begin("least squares");
	struct least_squares problem;
	struct least_squares_fit fit;
	struct decay d;
	double x[3] = {1, -2, 0}, s = 0, se = 0, see = 0;

	observe(&d, 40, 0.1, &chance);
	problem = decay_problem(&d);
	problem.fixed = fixed; /* b is held: a and c are linear */
	assert_int_equal(least_squares_solve(&problem, x, &fit, NULL), 0);
	for (int i = 0; i < d.count; i++) {
		const double e = exp(-2.0 * i / d.count);

		s += 1;
		se += e;
		see += e * e;
	}
	assert_true(x[1] == -2 && fit.freedom == 38);
	assert_true(fabs(fit.covariance[0] / (fit.sigma * fit.sigma * s / (s * see - se * se)) -
			 1) < 1e-9);
	assert_true(fabs(fit.covariance[8] / (fit.sigma * fit.sigma * see / (s * see - se * se)) -
			 1) < 1e-9);
	assert_true(fabs(fit.covariance[2] / (fit.sigma * fit.sigma * -se / (s * see - se * se)) -
			 1) < 1e-9);
	for (int k = 0; k < 3; k++)
		expect_that(fit.covariance[3 + k] == 0 && fit.covariance[3 * k + 1] == 0, "k=%d",
			    k);
	least_squares_free(&fit);
}

/* The right shares of 1,000 runs lie within one and two deviations. */
TEST("deviations are honest")
{
	struct chance chance = chance_begin("least squares");
	const int runs = 1000;

	for (int robust = 0; robust < 2; robust++) {
		int one = 0, two = 0;

		for (int run = 0; run < runs; run++) {
			struct least_squares problem;
			struct least_squares_fit fit;
			struct decay d;
			double x[3] = {1, -0.5, 0}, z;

			observe(&d, 200, 0.02, &chance);
			problem = decay_problem(&d);
			problem.loss_scale = robust ? 2.4 : 0;
			assert_int_equal(least_squares_solve(&problem, x, &fit, NULL), 0);
			z = fabs(x[1] - truth[1]) / sqrt(fit.covariance[4]);
			one += z < 1;
			two += z < 1.96;
			least_squares_free(&fit);
		}
		/* five deviations of the binomial distribution */
		expect_below(fabs(one - 0.683 * runs), 5 * sqrt(runs * 0.683 * 0.317), "robust=%d",
			     robust);
		expect_below(fabs(two - 0.95 * runs), 5 * sqrt(runs * 0.95 * 0.05), "robust=%d",
			     robust);
	}
}

TEST("names outliers")
{
	struct chance chance = chance_begin("least squares");
	struct least_squares problem;
	struct least_squares_fit fit;
	struct decay d;
	double x[3] = {1, -0.5, 0};

	observe(&d, 100, 0.01, &chance);
	for (int i = 0; i < 100; i += 7)
		d.seen[i] += i & 1 ? 2 : 5;
	problem = decay_problem(&d);
	problem.loss_scale = 2.4;
	assert_int_equal(least_squares_solve(&problem, x, &fit, NULL), 0);
	for (int k = 0; k < 3; k++)
		expect_below(fabs(x[k] - truth[k]), 6 * sqrt(fit.covariance[4 * k]), "k=%d", k);
	for (int i = 0; i < 100; i++)
		expect_equal((fit.weight[i] < 0.1), (i % 7 == 0), "i=%d", i);
	assert_true(fit.sigma > 0.006 && fit.sigma < 0.015);
	least_squares_free(&fit);
}

TEST("steps back from where nothing is")
{
	struct chance chance = chance_begin("least squares");
	struct least_squares problem;
	struct least_squares_fit fit;
	struct decay d;
	double x[3] = {1, -1e-9, 0};

	observe(&d, 50, 0, &chance);
	d.given_b_negative = true;
	problem = decay_problem(&d);
	problem.differentiate = NULL;
	assert_int_equal(least_squares_solve(&problem, x, &fit, NULL), 0);
	assert_true(fabs(x[1] + 2) < 1e-9);
	least_squares_free(&fit);
	x[1] = 1;
	assert_int_equal(least_squares_solve(&problem, x, &fit, NULL), -EDOM);
	least_squares_free(&fit);
	x[1] = NAN;
	assert_int_equal(least_squares_solve(&problem, x, &fit, NULL), -EDOM);
	least_squares_free(&fit);
}

TEST("says what cannot be told apart")
{
	static const char *const names[] = {"height", "rate", "ground"};
	struct chance chance = chance_begin("least squares");
	struct fault fault = {""};
	struct least_squares problem;
	struct least_squares_fit fit;
	struct decay d;
	double x[3] = {3, 0, 0.5};
	static const bool fixed[] = {false, true, false};

	observe(&d, 50, 0.1, &chance);
	problem = decay_problem(&d);
	problem.name = names;
	problem.fixed = fixed; /* rate 0: height and ground are the same parameter */
	assert_int_equal(least_squares_solve(&problem, x, &fit, &fault), -ERANGE);
	assert_non_null(strstr(fault.text, "height"));
	assert_non_null(strstr(fault.text, "ground"));
	assert_true(isinf(fit.condition) && isinf(fit.covariance[0]) && isinf(fit.covariance[8]));
	least_squares_free(&fit);

	observe(&d, 50, 0.1, &chance);
	d.blind = 0; /* the ground has no effect */
	problem = decay_problem(&d);
	problem.name = names;
	x[1] = -1;
	assert_int_equal(least_squares_solve(&problem, x, &fit, &fault), -ERANGE);
	assert_non_null(strstr(fault.text, "ground from ground"));
	assert_true(isfinite(fit.covariance[0]) && isinf(fit.covariance[8]));
	least_squares_free(&fit);
}

TEST("refuses")
{
	struct chance chance = chance_begin("least squares");
	struct least_squares problem;
	struct least_squares_fit fit;
	struct decay d;
	double x[3] = {1, -1, 0};

	observe(&d, 2, 0, &chance);
	problem = decay_problem(&d);
	assert_int_equal(least_squares_solve(&problem, x, &fit, NULL), -EINVAL);
	least_squares_free(&fit);
	/* As many points as parameters: solved, but without any knowledge of the error. */
	observe(&d, 3, 0, &chance);
	problem = decay_problem(&d);
	assert_int_equal(least_squares_solve(&problem, x, &fit, NULL), 0);
	assert_true(fit.freedom == 0 && fit.sigma == 0 && fabs(x[0] - 3) < 1e-9);
	least_squares_free(&fit);
	problem.group = 2;
	assert_int_equal(least_squares_solve(&problem, x, &fit, NULL), -EINVAL);
	least_squares_free(&fit);
}
