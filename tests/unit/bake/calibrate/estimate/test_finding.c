/* SPDX-License-Identifier: MIT */
/* Estimates, verdicts and findings, which all calibrations hand to their reports. */
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "bake/calibrate/estimate/finding.h"
#include "tests/support/test.h"

/* f and Tz with correlation 0.9; a held parameter; one that cannot be told. */
static struct estimate some_estimate(void)
{
	static const char *const name[] = {"focal", "translation z", "aspect", "kappa1"};
	struct estimate e;

	assert_int_equal(estimate_create(&e, 4), 0);
	for (int k = 0; k < 4; k++)
		snprintf(e.parameter[k].name, sizeof(e.parameter[k].name), "%s", name[k]);
	e.parameter[2].fixed = true;
	e.covariance[0] = 4;
	e.covariance[5] = 9;
	e.covariance[1] = e.covariance[4] = 0.9 * 2 * 3;
	e.covariance[15] = INFINITY;
	return e;
}

TEST("estimate")
{
	struct estimate e = some_estimate();

	assert_int_equal(estimate_find(&e, "aspect"), 2);
	assert_int_equal(estimate_find(&e, "focal length"), -1);
	assert_true(estimate_deviation(&e, 0) == 2 && estimate_deviation(&e, 1) == 3);
	assert_true(estimate_deviation(&e, 2) == 0 && isinf(estimate_deviation(&e, 3)));
	assert_true(fabs(estimate_correlation(&e, 0, 1) - 0.9) < 1e-15);
	assert_true(estimate_correlation(&e, 1, 0) == estimate_correlation(&e, 0, 1));
	assert_true(estimate_correlation(&e, 0, 2) == 0);
	assert_true(isnan(estimate_correlation(&e, 0, 3)));
	estimate_free(&e);
	estimate_free(&e);
	assert_int_equal(estimate_create(&e, 0), 0);
	assert_int_equal(estimate_find(&e, ""), -1);
	estimate_free(&e);
}

TEST("verdict")
{
	struct verdict v;
	char text[600], little[10];
	char endless[1000];

	verdict_begin(&v);
	verdict_sentence(&v, text, sizeof(text));
	assert_true(v.trusted);
	assert_string_equal(text, "trusted");
	verdict_doubt(&v, "spread them", "all points lie on a line");
	verdict_doubt(&v, "take more", "there are few points");
	verdict_sentence(&v, text, sizeof(text));
	assert_false(v.trusted);
	assert_string_equal(text, "all points lie on a line; spread them");
	verdict_sentence(&v, little, sizeof(little));
	assert_string_equal(little, "all point");
	memset(endless, 'x', sizeof(endless) - 1);
	endless[sizeof(endless) - 1] = '\0';
	verdict_begin(&v);
	verdict_doubt(&v, endless, "%s", endless);
	assert_int_equal(strlen(v.reason), sizeof(v.reason) - 1);
	assert_int_equal(strlen(v.remedy), sizeof(v.remedy) - 1);
}

TEST("finding")
{
	const double world[3] = {1, 2, 3}, px[2] = {4, 5};
	struct observations seen = {.width = 64, .height = 48};
	struct finding f;
	int status;
	pid_t child;

	assert_int_equal(finding_create(&f, "camera", &seen), 0); /* without points */
	finding_free(&f);
	assert_int_equal(observations_begin_view(&seen, "here"), 0);
	assert_int_equal(observations_add(&seen, world, px, "point %d", 7), 0);
	assert_int_equal(finding_create(&f, "camera", &seen), 0);
	assert_true(f.verdict.trusted);
	assert_int_equal(f.width, 64);
	assert_ptr_equal(f.seen, &seen);
	assert_string_equal(seen.point[0].name, "point 7");
	for (int k = 0; k < FINDING_FIGURES_MAX; k++)
		finding_add(&f, "key", "a figure", "px", k);
	assert_int_equal(f.figures, FINDING_FIGURES_MAX);
	assert_true(f.figure[FINDING_FIGURES_MAX - 1].value == FINDING_FIGURES_MAX - 1);
	child = fork();
	if (child == 0) {
		(void)!freopen("/dev/null", "w", stderr);
		signal(SIGABRT, SIG_DFL);
		finding_add(&f, "key", "one too many", "px", 0);
		_exit(0);
	}
	assert_int_equal(waitpid(child, &status, 0), child);
	assert_true(WIFSIGNALED(status) && WTERMSIG(status) == SIGABRT);
	finding_free(&f);
	finding_free(&f);
	observations_free(&seen);
}
