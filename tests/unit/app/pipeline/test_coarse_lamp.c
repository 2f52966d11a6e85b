/* SPDX-License-Identifier: MIT */
/* Lamps where the dome is coarse: what counts as one, where finer lights would not help, and that
 * what is said does not flicker. */
#include <math.h>

#include "app/pipeline/coarse_lamp.h"
#include "hal/optics/vec.h"
#include "tests/support/expect.h"
#include "tests/support/test.h"

#define DEGREE (M_PI / 180)

static struct dome dome;
static float radiance[DOME_LIGHTS_MAX][3];

static void begin(int frequency, const struct dome_fine *fine)
{
	struct fault fault = {.text = ""};
	int wrong;

	dome_free(&dome);
	expect_success(dome_create_fine(&dome, frequency, fine, fine ? 1 : 0, &wrong, &fault),
		       &fault);
	for (int i = 0; i < dome.count; i++)
		for (int c = 0; c < 3; c++)
			radiance[i][c] = 1;
}

static void towards(double azimuth_deg, double height_deg, double d[3])
{
	d[0] = cos(height_deg * DEGREE) * cos(azimuth_deg * DEGREE);
	d[1] = cos(height_deg * DEGREE) * sin(azimuth_deg * DEGREE);
	d[2] = sin(height_deg * DEGREE);
}

/* Adds a lamp that gives the ground a share of all light, beside the even sky's pi. */
static int add_lamp(double azimuth_deg, double height_deg, double share)
{
	double d[3];
	int light;

	towards(azimuth_deg, height_deg, d);
	light = dome_cell_of(&dome, d);
	for (int c = 0; c < 3; c++)
		radiance[light][c] =
			(float)(1 + share / (1 - share) * M_PI / dome.projected_sr[light]);
	return light;
}

static struct coarse_lamp found(void)
{
	struct coarse_lamp lamp = {.there = false};

	coarse_lamp_find(&lamp, &dome, (const float(*)[3])radiance);
	return lamp;
}

TEST("even skies have none")
{
	for (int f = 1; f <= 9; f++) {
		begin(f, NULL);
		assert_false(found().there);
		for (int i = 0; i < dome.count; i++)
			radiance[i][0] = radiance[i][1] = radiance[i][2] = 0;
		assert_false(found().there); /* in the dark */
	}
}

TEST("lamp is found")
{
	struct coarse_lamp lamp;
	double lamp_at[3], cell[3];
	int light;

	begin(9, NULL);
	light = add_lamp(134, 22, 0.5);
	lamp = found();
	assert_true(lamp.there);
	expect_below(fabs(lamp.share - 0.5), 0.01, "share");
	towards(lamp.azimuth_deg, lamp.height_deg, lamp_at);
	for (int k = 0; k < 3; k++)
		cell[k] = dome.direction[light][k];
	expect_below(vec_angle(lamp_at, cell), 1e-6, "direction");
	add_lamp(-60, 50, 0.6); /* the stronger of two is named */
	expect_below(fabs(found().azimuth_deg + 60), 5, "azimuth");
}

/* A window that fills a cell and all around it is no lamp: nothing would be sharper. */
TEST("wide light is none")
{
	double d[3];

	begin(3, NULL);
	towards(40, 50, d);
	for (int i = 0; i < dome.count; i++)
		for (int c = 0; c < 3; c++)
			radiance[i][c] = vec_angle(dome.direction[i], d) < 45 * DEGREE ? 100 : 1;
	assert_false(found().there);
}

TEST("fine parts need nothing")
{
	struct dome_fine fine = {.radius_rad = 3 * DEGREE, .frequency = 36};

	towards(134, 22, fine.direction);
	begin(9, &fine);
	add_lamp(134, 22, 0.5);
	assert_false(found().there);
	add_lamp(-60, 50, 0.4); /* the weaker one is in a coarse cell */
	assert_true(found().there);
	expect_below(fabs(found().azimuth_deg + 60), 5, "azimuth");
	begin(36, NULL);
	add_lamp(134, 22, 0.5);
	assert_false(found().there);
	begin(18, NULL);
	for (int azimuth = -180; azimuth < 180; azimuth += 17) {
		begin(18, NULL);
		add_lamp(azimuth, 10 + (azimuth + 180) / 5, 0.5);
		expect_that(found().there, "azimuth=%d", azimuth);
	}
}

TEST("does not flicker")
{
	struct coarse_lamp lamp = {.there = false};

	begin(9, NULL);
	for (int k = 0; k < 20; k++) {
		add_lamp(134, 22, k % 2 ? 0.19 : 0.16);
		coarse_lamp_find(&lamp, &dome, (const float(*)[3])radiance);
		assert_false(lamp.there);
	}
	for (int k = 0; k < 20; k++) {
		add_lamp(134, 22, k % 2 ? 0.15 : 0.23);
		coarse_lamp_find(&lamp, &dome, (const float(*)[3])radiance);
		assert_true(lamp.there);
	}
	add_lamp(134, 22, 0.1);
	coarse_lamp_find(&lamp, &dome, (const float(*)[3])radiance);
	assert_false(lamp.there);
	assert_true(lamp.share == 0);
	dome_free(&dome);
}
