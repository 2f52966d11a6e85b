/* SPDX-License-Identifier: MIT */
/* Exposures in turn, with a camera that rounds the numbers it is given. */
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "app/camera/eye.h"
#include "tests/support/test.h"

static struct {
	double step; /* it rounds to multiples of this; 0: it takes any number */
	int asked;
	double last;
} fake;

static int fake_control(struct camera *camera, const char *name, const char *value, double *taken,
			struct fault *fault)
{
	const double wanted = strtod(value, NULL);

	(void)camera;
	(void)fault;
	assert_string_equal(name, "exposure");
	fake.asked++;
	fake.last = fake.step > 0 ? round(wanted / fake.step) * fake.step : wanted;
	if (fake.last != wanted)
		*taken = fake.last;
	return 0;
}

static const struct camera_ops fake_ops = {.name = "fake", .control = fake_control};

static struct config_fisheye config;
static struct source source;
static struct exposing exposing;

static void test_exposing_begin(double step, double first, double second, double third)
{
	memset(&fake, 0, sizeof(fake));
	fake.step = step;
	config = (struct config_fisheye){.exposures = {first, second, third},
					 .exposure_control = "exposure",
					 .exposure_delay = 0};
	source = (struct source){.settings.name = "eye", .opening.count = 1};
	source.camera = (struct camera){.ops = &fake_ops, .state = &fake, .on_demand = true};
	exposing_start(&exposing, &config);
}

/* Exposure of picture n. */
static int picture(uint32_t n)
{
	source.sequence = n;
	return exposing_take(&exposing, &source, 0);
}

static void is_about(double value, double expected)
{
	if (!(fabs(value - expected) < 1e-9))
		fail_msg("%g, expected %g", value, expected);
}

TEST("what is taken as it is keeps its ratio")
{
	test_exposing_begin(0, 16, 5, 2);
	for (uint32_t n = 0; n < 9; n++)
		(void)picture(n);
	assert_int_equal(fake.asked, 9);
	is_about(exposing.ratio[0], 1);
	is_about(exposing.ratio[1], 5 / 16.);
	is_about(exposing.ratio[2], 2 / 16.);
}

/* 17, 7 and 2 become 18, 6 and 3. No picture is measured with the ratio of another one. */
TEST("what is rounded has another ratio")
{
	static const double taken[] = {18, 6, 3};
	int seen = 0;

	test_exposing_begin(3, 17, 7, 2);
	for (uint32_t n = 0; n < 12; n++) {
		const int exposure = picture(n);

		if (exposure < 0)
			continue;
		is_about(exposing.used[exposure], taken[exposure]);
		seen |= 1 << exposure;
	}
	assert_int_equal(seen, 7);
	assert_false(exposing.single);
	for (int k = 0; k < 3; k++)
		is_about(exposing.ratio[k], taken[k] / 18);
}

TEST("two that become one are given up")
{
	for (int which = 0; which < 2; which++) {
		test_exposing_begin(10, which ? 40 : 11, which ? 11 : 7, which ? 4 : 1);
		for (uint32_t n = 0; n < 9; n++)
			(void)picture(n);
		assert_true(exposing.single);
		is_about(fake.last, which ? 40 : 10); /* the longest exposure stays */
		assert_non_null(strstr(exposing.said.text, "it makes 10 of an exposure of 11"));
		for (int k = 1; k < 3; k++)
			assert_true(exposing.ratio[k] < exposing.ratio[k - 1]);
	}
}
