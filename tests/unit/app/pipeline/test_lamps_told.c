/* SPDX-License-Identifier: MIT */
/* Lamps that are missing or not named, in pictures of a room. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "app/pipeline/lamps_told.h"
#include "hal/lights/lamp/lamp_light.h"
#include "hal/lights/sampler.h"
#include "hal/optics/dome.h"
#include "tests/support/calibrate/drawn_lamps.h"
#include "tests/support/expect.h"
#include "tests/support/test.h"

#define SIDE 320 /* more than the side that a picture is reduced to */

static const struct fisheye_settings settings = {.field_deg = 90};
static struct dome dome;
static struct fisheye lens;
static struct light_sampler *sampler;
static struct lamps_search *search;
static struct dome_placed *placed;
static float (*radiance)[3], (*distant)[3];
static bool no_places; /* of the basis: lamps are not taken out of the light */

static int search_begin(void **state)
{
	const struct light_sampler_settings sampling = {.placed = true, .gain = 1};

	(void)state;
	assert_int_equal(dome_create(&dome, 9, NULL), 0);
	assert_int_equal(fisheye_prepare(&lens, &settings, SIDE, SIDE, NULL), 0);
	assert_int_equal(light_sampler_create(&sampler, &dome, &lens, SIDE, SIDE, &sampling, NULL),
			 0);
	assert_int_equal(dome_placed_create(&placed, &dome), 0);
	assert_int_equal(lamps_search_create(&search, &dome, placed), 0);
	radiance = calloc((size_t)dome.count, sizeof(*radiance));
	distant = calloc((size_t)dome.count, sizeof(*distant));
	assert_true(radiance && distant);
	return 0;
}

static int search_end(void **state)
{
	(void)state;
	lamps_search_destroy(search);
	light_sampler_destroy(sampler);
	dome_placed_destroy(placed);
	dome_free(&dome);
	free(radiance);
	free(distant);
	return 0;
}
TEST_GROUP(search_begin, search_end);

/* What is said of a room with lamps, of which the configuration names some. As 8 bits as well. */
static struct lamps_told look(const struct drawn_lamp *lamp, int count, const struct lamps *named,
			      struct lamps_told found)
{
	static const double origin[3];
	const struct drawn_room room = {lamp, count, 0.1};
	const struct transfer_curve curve = {.named = TRANSFER_SRGB};
	struct lamps_told in_codes = found;
	struct lamps_light light = {.lens = &lens,
				    .curve = &curve,
				    .radiance = (const float(*)[3])radiance,
				    .distant = (const float(*)[3])distant,
				    .lamps = named};
	struct canvas canvas = {.pixels = NULL};
	struct lamp_light *taken;
	struct image picture;
	struct picture codes;
	struct frame_reader reader;
	double power[LAMPS_MAX][3];

	draw_lamps(&picture, &room, &lens, SIDE, origin, origin);
	assert_int_equal(light_sampler_read_linear(sampler, &picture, radiance), 0);
	memcpy(distant, radiance, sizeof(*distant) * (size_t)dome.count);
	assert_int_equal(lamp_light_create(&taken, &dome, placed, named), 0);
	if (!no_places)
		lamp_light_take(taken, distant, power);
	lamp_light_destroy(taken);
	light.linear = &picture;
	assert_int_equal(lamps_search_look(search, &light, &found), 0);
	encode_lamps(&picture, 1);
	assert_int_equal(canvas_create(&canvas, SIDE, SIDE), 0);
	for (int i = 0; i < SIDE * SIDE; i++)
		memcpy(canvas.pixels + (size_t)(i / SIDE) * canvas.stride + 4 * (i % SIDE),
		       picture.u8 + 3 * i, 3);
	codes = view_picture(&(struct view){.width = SIDE, .height = SIDE}, canvas.pixels,
			     canvas.stride);
	reader = frame_reader_of(&codes);
	light.linear = NULL;
	light.frame = &reader;
	assert_int_equal(lamps_search_look(search, &light, &in_codes), 0);
	assert_int_equal(in_codes.unnamed, found.unnamed);
	assert_memory_equal(in_codes.missing, found.missing, sizeof(found.missing));
	expect_below(fabs(in_codes.share - found.share), 0.2 * found.share + 1e-9, "%d lamps",
		     count);
	image_free(&picture);
	canvas_free(&canvas);
	return found;
}

static const struct lamps_told nothing;
/* It gives a level ground pi 50 (0.08 / 2.22)^2 sin 54 degrees = 0.17, the sky 0.31. */
static const struct drawn_lamp strong = {{1.2, 0.5, 1.8}, 0.08, 50};
static const struct lamps named = {1, {{{1.2, 0.5, 1.8}, 0.08}}, {0, 0, 0}};

TEST("a lamp that is named and shines is not spoken of")
{
	const struct lamps_told found = look(&strong, 1, &named, nothing);

	assert_false(found.unnamed);
	assert_false(found.missing[0]);
	no_places = true;
	assert_false(look(&strong, 1, &named, nothing).unnamed);
	no_places = false;
}

TEST("a lamp that is not named is, with its share of the light")
{
	const struct lamps none = {.count = 0};
	const struct lamps_told found = look(&strong, 1, &none, nothing);

	assert_true(found.unnamed);
	expect_below(fabs(found.azimuth_deg - 22.6), 0.5, "%s", "azimuth");
	expect_below(fabs(found.height_deg - 54.2), 0.5, "%s", "height");
	expect_below(fabs(found.share - 0.17 / (0.17 + 0.314)), 0.03, "%s", "share");
}

TEST("a named lamp beside it takes nothing of that")
{
	const struct drawn_lamp lamp[] = {strong, {{-1, 0.3, 1.5}, 0.06, 60}};
	const struct lamps_told found = look(lamp, 2, &named, nothing);

	assert_true(found.unnamed);
	assert_false(found.missing[0]);
	expect_below(fabs(found.azimuth_deg - 163.3), 0.5, "%s", "azimuth");
}

TEST("a lamp that is off, or hangs 10 degrees from there, is missing")
{
	const struct drawn_lamp moved = {{1.2, 0.9, 1.7}, 0.08, 50};

	assert_true(look(NULL, 0, &named, nothing).missing[0]);
	assert_true(look(&moved, 1, &named, nothing).missing[0]);
	assert_true(look(&moved, 1, &named, nothing).unnamed);
	assert_false(look(&strong, 1, &named, nothing).missing[1]);
}

TEST("weak lights, windows and an even sky are not lamps")
{
	const struct drawn_lamp weak = {{1.2, 0.5, 1.8}, 0.03, 20}, window = {{-2, 0, 2}, 0.8, 5};
	const struct lamps none = {.count = 0};

	assert_false(look(&weak, 1, &none, nothing).unnamed);
	assert_false(look(&window, 1, &none, nothing).unnamed);
	assert_false(look(NULL, 0, &none, nothing).unnamed);
}

/* What was said stays said until the light has become clearly weaker. */
TEST("a light at the threshold does not come and go")
{
	const double share = (LAMPS_TOLD_FROM + LAMPS_TOLD_UNTIL) / 2;
	const double light = 0.1 * share / (1 - share); /* over pi, beside the sky's 0.1 */
	const struct drawn_lamp lamp = {{0, 0, 2}, 0.08, light / (0.04 * 0.04)};
	const struct lamps none = {.count = 0};
	const struct lamps_told before = {.unnamed = true, .share = 0.1};

	assert_false(look(&lamp, 1, &none, nothing).unnamed);
	assert_true(look(&lamp, 1, &none, before).unnamed);
}
