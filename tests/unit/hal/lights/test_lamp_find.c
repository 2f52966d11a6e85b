/* SPDX-License-Identifier: MIT */
/* Spots in pictures: where they are, how large and how strong. */
#include <string.h>

#include "hal/lights/lamp/lamp_find.h"
#include "hal/optics/vec.h"
#include "tests/support/calibrate/drawn_lamps.h"
#include "tests/support/chance.h"
#include "tests/support/expect.h"
#include "tests/support/test.h"

#define SIDE 300
#define SPOTS 8

static const struct fisheye_settings settings = {.field_deg = 90, .rotation_deg = {3, 2, -50}};
static const double origin[3];
static float light[SIDE * SIDE];

static int find(const struct drawn_lamp *lamp, int count, double sky, float white,
		struct lamp_spot spot[SPOTS])
{
	const struct drawn_room room = {lamp, count, sky};
	struct lamp_picture picture = {light, SIDE, SIDE, white, NULL};
	struct lamp_finder finder = {.pixels = 0};
	struct fisheye lens;
	struct image drawn;
	int found;

	assert_int_equal(fisheye_prepare(&lens, &settings, SIDE, SIDE, NULL), 0);
	draw_lamps(&drawn, &room, &lens, SIDE, origin, origin);
	for (int i = 0; i < SIDE * SIDE; i++)
		light[i] = fminf(drawn.f32[3 * i], white);
	image_free(&drawn);
	picture.lens = &lens;
	found = lamp_find(&finder, &picture, spot, SPOTS);
	lamp_finder_free(&finder);
	return found;
}

TEST("spots are where lamps are, as large and as strong")
{
	struct chance c = chance_begin("spots");

	for (int round = 0; round < 8; round++) {
		struct drawn_lamp lamp = {.radius = chance_real(&c, 0.01, 0.14), .radiance = 30};
		struct lamp_spot spot[SPOTS];
		const double flux = 2 * M_PI * (1 - sqrt(1 - lamp.radius * lamp.radius)) * 29.9;

		chance_direction(&c, 0.2, lamp.at);
		assert_int_equal(find(&lamp, 1, 0.1, INFINITY, spot), 1);
		expect_below(vec_angle(spot->dir, lamp.at), 0.05 * spot->pixel + 1e-3, "round %d",
			     round);
		expect_below(fabs(spot->flux / flux - 1), 0.05, "round %d", round);
		expect_that(!spot->clipped, "round %d", round);
		if (spot->resolved)
			expect_below(fabs(spot->radius / asin(lamp.radius) - 1), 0.1, "round %d",
				     round);
	}
}

TEST("clipped light has a place and a size")
{
	const struct drawn_lamp lamp = {{0.6, 0, 0.8}, 0.05, 30};
	struct lamp_spot spot[SPOTS];

	assert_int_equal(find(&lamp, 1, 0.1, 1, spot), 1);
	assert_true(spot->clipped);
	expect_below(vec_angle(spot->dir, lamp.at), 1e-3, "%s", "direction");
	expect_below(fabs(spot->radius / asin(0.05) - 1), 0.15, "%s", "radius");
}

TEST("windows and what is a little brighter are none")
{
	const struct drawn_lamp window = {{0.6, 0, 0.8}, 0.25, 5},
				dim = {{0.6, 0, 0.8}, 0.05, 0.35};
	struct lamp_spot spot[SPOTS];

	assert_int_equal(find(&window, 1, 0.1, INFINITY, spot), 0);
	assert_int_equal(find(&dim, 1, 0.1, INFINITY, spot), 0);
	assert_int_equal(find(NULL, 0, 0.1, INFINITY, spot), 0);
	assert_int_equal(find(NULL, 0, 0, INFINITY, spot), 0);
}

TEST("of many the strongest are kept, the strongest first")
{
	struct drawn_lamp lamp[3 * SPOTS];
	struct lamp_spot spot[SPOTS];

	for (int k = 0; k < 3 * SPOTS; k++) {
		const double azimuth = 2 * M_PI * (k * 7 % (3 * SPOTS)) / (3 * SPOTS);

		lamp[k] = (struct drawn_lamp){
			{0.8 * cos(azimuth), 0.8 * sin(azimuth), 0.6}, 0.02, 10 + k};
	}
	assert_int_equal(find(lamp, 3 * SPOTS, 0.1, INFINITY, spot), SPOTS);
	for (int k = 0; k < SPOTS; k++)
		expect_below(vec_angle(spot[k].dir, lamp[3 * SPOTS - 1 - k].at), 0.01, "spot %d",
			     k);
}

TEST("a light shines only where it stands out")
{
	const struct drawn_lamp lamp = {{0.6, 0, 0.8}, 0.05, 2};
	const double beside[3] = {0, 0.6, 0.8};
	struct lamp_spot spot[SPOTS];
	struct lamp_picture picture = {light, SIDE, SIDE, INFINITY, NULL};
	struct fisheye lens;

	find(&lamp, 1, 0.1, INFINITY, spot);
	assert_int_equal(fisheye_prepare(&lens, &settings, SIDE, SIDE, NULL), 0);
	picture.lens = &lens;
	assert_true(lamp_shines(&picture, lamp.at, 0.09));
	assert_false(lamp_shines(&picture, beside, 0.09));
}
