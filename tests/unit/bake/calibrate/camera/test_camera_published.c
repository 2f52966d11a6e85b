/* SPDX-License-Identifier: MIT */
/* R. Willson's coplanar data and the results that he published: a hard case, because f and Tz can
 * hardly be told apart. */
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bake/calibrate/camera/camera.h"
#include "tests/support/expect.h"
#include "tests/support/test.h"

/* The camera that made the data, whose pixels were 0.023 mm wide. */
static const struct {
	const char *name;
	double value;
} truth[] = {
	{"focal", 270 / 0.023},	 {"kappa1", -6e-4 * 0.023 * 0.023},
	{"centre x", 262},	 {"centre y", 212},
	{"translation x", 150},	 {"translation y", -75},
	{"translation z", 6600},
};

static void calibrate(struct observations *seen, struct camera_solution *solution)
{
	const struct points_convention convention = {.pixel_centre = 0.5};
	const char *shared = getenv("INLAY_SHARED_DATA");
	struct camera_task task = camera_task_default();
	struct fault fault = {""};
	char path[512];
	int err;

	snprintf(path, sizeof(path), "%s/tsai/coplanar.dat", shared ? shared : "../shared/data");
	err = observations_read(seen, path, &convention, &fault);
	if (err == -ENOENT) {
		print_message("%s is missing\n", path);
		skip();
	}
	assert_int_equal(err, 0);
	assert_int_equal(seen->count, 100);
	task.width = 576;
	task.height = 480;
	task.centre_given = true;
	task.centre_px[0] = 258;
	task.centre_px[1] = 204;
	task.aspect_given = true; /* fixed, as his program fixes it for one plane */
	task.distortion = TSAI_UNDISTORTS;
	task.unit_mm = 1;
	task.z_down = true;
	assert_int_equal(camera_calibrate(seen, &task, solution, &fault), 0);
	assert_true(solution->solved);
}

static double figure(const struct finding *finding, const char *key)
{
	for (int k = 0; k < finding->figures; k++)
		if (!strcmp(finding->figure[k].key, key))
			return finding->figure[k].value;
	fail_msg("there is no figure %s", key);
	return NAN;
}

TEST("full")
{
	struct observations seen = {0};
	struct camera_solution solution;
	const struct estimate *estimate = &solution.finding.estimate;
	const struct parameter *p;

	calibrate(&seen, &solution);
	assert_true(figure(&solution.finding, "normalised_calibration_error") <= 0.231899);
	assert_true(figure(&solution.finding, "distorted_error_mean") <= 0.096750);
	/* the data have noise of 0.1 px, and f and Tz can hardly be told apart */
	assert_true(estimate->sigma > 0.07 && estimate->sigma < 0.11);
	assert_true(figure(&solution.finding, "focal_depth_correlation") > 0.999);
	for (unsigned k = 0; k < sizeof(truth) / sizeof(*truth); k++) {
		const int at = estimate_find(estimate, truth[k].name);

		expect_at_least(at, 0, "k=%u", k);
		p = &estimate->parameter[at];
		assert_false(p->fixed);
		expect_below(fabs(p->value - truth[k].value), 3 * estimate_deviation(estimate, at),
			     "k=%u", k);
	}
	/* f is uncertain by some per cent, and reported so; places in the picture are not */
	p = &estimate->parameter[estimate_find(estimate, "focal")];
	assert_true(estimate_deviation(estimate, 0) > 0.02 * p->value);
	assert_true(figure(&solution.finding, "object_error_px") < 0.5);
	assert_true(solution.finding.verdict.trusted);
	assert_true(estimate->parameter[estimate_find(estimate, "aspect")].fixed);
	camera_solution_free(&solution);
	observations_free(&seen);
}
