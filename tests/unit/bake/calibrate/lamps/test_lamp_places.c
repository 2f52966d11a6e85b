/* SPDX-License-Identifier: MIT */
/* Lamps are found at their places, and what cannot be known is doubted. */
#include <math.h>
#include <string.h>

#include "bake/calibrate/lamps/lamp_places.h"
#include "tests/support/calibrate/drawn_lamps.h"
#include "tests/support/chance.h"
#include "tests/support/expect.h"
#include "tests/support/test.h"
#include "tests/support/thorough.h"

#define SIDE 256
#define TURN (0.5 * M_PI / 180)

static const struct fisheye_settings settings = {.field_deg = 90, .rotation_deg = {2, -3, 40}};

/* A room with lamps, and the fisheye at places. */
struct shot {
	struct drawn_room room[SIGHT_PLACES_MAX]; /* as it is for each picture */
	double said[SIGHT_PLACES_MAX][3], is[SIGHT_PLACES_MAX][3], turn[SIGHT_PLACES_MAX][3];
	int places;
	double exposure; /* of 8-bit pictures; 0: linear light */
};

static struct observations seen;
static struct lamp_places found;

/* Returns whether the result is trusted. */
static bool find(const struct shot *shot)
{
	struct fault fault = {.text = ""};

	lamp_places_free(&found);
	observations_free(&seen);
	found = (struct lamp_places){.deviation = {.px = 0.5, .place_m = 0.01, .turn = TURN},
				     .tolerance = 0.05};
	assert_int_equal(fisheye_prepare(&found.lens, &settings, SIDE, SIDE, &fault), 0);
	seen.width = seen.height = SIDE;
	for (int k = 0; k < shot->places; k++) {
		const struct transfer_curve srgb = {.named = TRANSFER_SRGB};
		struct image picture;

		found.sight[k].name = "picture";
		memcpy(found.sight[k].at, shot->said[k], sizeof(shot->said[k]));
		draw_lamps(&picture, &shot->room[k], &found.lens, SIDE, shot->is[k], shot->turn[k]);
		if (shot->exposure > 0)
			encode_lamps(&picture, shot->exposure);
		assert_int_equal(lamp_sight_look(&found.sight[k], &picture, &srgb, &found.lens), 0);
		image_free(&picture);
		found.sights++;
	}
	assert_int_equal(lamp_places_find(&found, &seen, &fault), 0);
	return found.finding.verdict.trusted;
}

static int find_end(void **state)
{
	(void)state;
	lamp_places_free(&found);
	observations_free(&seen);
	return 0;
}
TEST_GROUP(NULL, find_end);

/* The same room from places that are as they are said to be. */
static struct shot plain_shot(const struct drawn_lamp *lamp, int lamps, int places)
{
	static const double at[SIGHT_PLACES_MAX][3] = {
		{0, 0, 0}, {1, 0, 0}, {0.2, 0.9, 0}, {-0.7, 0.5, 0.3}};
	struct shot shot = {.places = places};

	for (int k = 0; k < places; k++) {
		shot.room[k] = (struct drawn_room){lamp, lamps, 0.1};
		memcpy(shot.said[k], at[k], sizeof(at[k]));
		memcpy(shot.is[k], at[k], sizeof(at[k]));
	}
	return shot;
}

static double length_of(const double a[3], const double b[3])
{
	return hypot(hypot(a[0] - b[0], a[1] - b[1]), a[2] - b[2]);
}

/* The lamp that was found nearest to a true one, or -1. */
static int nearest_found(const struct drawn_lamp *lamp, double *off)
{
	int which = -1;

	*off = INFINITY;
	for (int i = 0; i < found.lamps.count; i++) {
		const double apart = length_of(found.lamps.lamp[i].position, lamp->at);

		if (apart < *off) {
			*off = apart;
			which = i;
		}
	}
	return which;
}

static struct drawn_lamp chance_lamp(struct chance *c)
{
	struct drawn_lamp lamp = {.radius = chance_real(c, 0.03, 0.12)};
	const double distance = chance_real(c, 1, 4);

	chance_direction(c, 0.3, lamp.at);
	for (int i = 0; i < 3; i++)
		lamp.at[i] *= distance;
	lamp.radiance = chance_real(c, 10, 100);
	return lamp;
}

/* Lamps whose discs touch in a picture are one spot. */
static bool lamps_are_apart(const struct drawn_lamp *lamp, int lamps)
{
	for (int i = 0; i < lamps; i++)
		for (int j = 0; j < i; j++)
			if (length_of(lamp[i].at, lamp[j].at) < 0.6)
				return false;
	return true;
}

TEST("lamps of rooms at random are placed, or doubted")
{
	struct chance c = chance_begin("lamps");
	const int rooms = thorough() ? 200 : 8;
	double square = 0, relative = 0, most = 0;
	int trusted = 0, lamps = 0;

	for (int room = 0; room < rooms; room++) {
		struct drawn_lamp lamp[4];
		const int count = chance_int(&c, 1, 4);
		struct shot shot = plain_shot(lamp, count, chance_int(&c, 2, 3));

		do
			for (int i = 0; i < count; i++)
				lamp[i] = chance_lamp(&c);
		while (!lamps_are_apart(lamp, count));
		shot.exposure = room % 2 ? 0 : 0.5;
		for (int k = 0; k < shot.places; k++)
			for (int i = 0; i < 3; i++) {
				shot.is[k][i] += chance_real(&c, -0.01, 0.01);
				shot.turn[k][i] = chance_real(&c, -TURN, TURN);
			}
		if (!find(&shot)) {
			print_message("room %d of %d lamps, %d places: %s\n", room, count,
				      shot.places, found.finding.verdict.reason);
			continue;
		}
		trusted++;
		for (int i = 0; i < count; i++) {
			static const double origin[3];
			const double distance = length_of(lamp[i].at, origin);
			const double size = lamp[i].radius / distance;
			double off;
			const int which = nearest_found(&lamp[i], &off);

			/* A hundredth of the sky's light, unless it is clipped, may be left out. */
			if (off > 0.5 && lamp[i].radiance * size * size < 0.01)
				continue;
			expect_that(which >= 0, "lamp %d of room %d", i, room);
			expect_below(off, 3.5 * found.deviation_m[which], "lamp %d of room %d", i,
				     room);
			square += off * off;
			relative += off * off / (distance * distance);
			most = fmax(most, off / distance);
			lamps++;
		}
		expect_at_most(found.lamps.count, count, "room %d", room);
	}
	print_message(
		"%d of %d rooms trusted: %d lamps off by %.3f m RMS, %.1f %% of their distance, %.1f %% at most\n",
		trusted, rooms, lamps, sqrt(square / lamps), 100 * sqrt(relative / lamps),
		100 * most);
	expect_at_least(trusted, rooms / 4, "of %d rooms", rooms);
	expect_below(sqrt(relative / lamps), 0.03, "of %d lamps", lamps);
}

/* ---- what cannot be known ---- */

static const struct drawn_lamp two[] = {{{1.2, 0.5, 1.8}, 0.08, 40}, {{-0.6, -1, 2}, 0.06, 50}};

static void assert_doubt(const struct shot *shot, const char *words)
{
	if (find(shot))
		fail_msg("trusted, expected: %s", words);
	if (!strstr(found.finding.verdict.reason, words))
		fail_msg("\"%s\", expected: %s", found.finding.verdict.reason, words);
}

TEST("what is plain is trusted, in 8 bits as well")
{
	struct shot shot = plain_shot(two, 2, 3);

	for (int bits = 0; bits < 2; bits++, shot.exposure = 0.5) {
		assert_true(find(&shot));
		assert_int_equal(found.lamps.count, 2);
		for (int i = 0; i < 2; i++) {
			double off;
			const int which = nearest_found(&two[i], &off);

			expect_below(off, 0.01, "lamp %d", i);
			expect_that(found.radius_known[which] == !bits, "lamp %d", i);
			if (!bits)
				expect_below(fabs(found.lamps.lamp[which].radius - two[i].radius),
					     0.1 * two[i].radius, "lamp %d", i);
		}
	}
}

TEST("a lamp that moved, or was switched, is doubted")
{
	const struct drawn_lamp moved[] = {two[0], {{-0.1, -1.2, 1.7}, 0.06, 50}};
	struct shot shot = plain_shot(two, 2, 3);

	shot.room[2].lamp = moved;
	assert_doubt(&shot, "moved or was hidden");
	shot.room[2].lamp = two;
	shot.room[2].lamps = 1;
	assert_doubt(&shot, "is not seen from one place");
	shot = plain_shot(two, 2, 2);
	shot.room[1].lamp = moved;
	assert_doubt(&shot, "moved or was hidden");
}

TEST("a fisheye that was turned, or laid elsewhere, is doubted")
{
	struct shot shot = plain_shot(two, 2, 3);

	shot.turn[1][2] = 0.2;
	assert_doubt(&shot, "");
	shot = plain_shot(two, 2, 3);
	shot.is[1][1] += 0.3;
	assert_doubt(&shot, "");
}

TEST("a lamp in line with the places is doubted")
{
	const struct drawn_lamp lamp[] = {two[1], {{3, 0.05, 0.15}, 0.06, 300}};
	struct shot shot = plain_shot(lamp, 2, 2);

	assert_doubt(&shot, "lies in line with the places");
}

/* Two lamps in the plane of two places meet crosswise as well. */
TEST("what can be taken together in two ways is doubted")
{
	const struct drawn_lamp row[] = {{{0.2, 0, 2}, 0.06, 50}, {{0.9, 0, 2.1}, 0.06, 50}};
	struct shot shot = plain_shot(row, 2, 2);

	assert_doubt(&shot, "more than one way");
	assert_non_null(strstr(found.finding.verdict.remedy, "third place"));
	shot = plain_shot(row, 2, 3);
	assert_true(find(&shot));
	assert_int_equal(found.lamps.count, 2);
}

TEST("light from afar stays light from afar")
{
	const struct drawn_lamp sun[] = {{{600, 300, 500}, 4, 3000}, two[0]};
	struct shot shot = plain_shot(sun, 2, 3);

	assert_true(find(&shot));
	assert_int_equal(found.lamps.count, 1);
	expect_below(length_of(found.lamps.lamp[0].position, two[0].at), 0.01, "%s", "the lamp");
	shot = plain_shot(sun, 1, 3);
	assert_doubt(&shot, "no light is near");
	/* Places that are too close tell nothing of it. */
	for (int k = 0; k < 3; k++)
		for (int i = 0; i < 3; i++) {
			shot.said[k][i] *= 0.1;
			shot.is[k][i] *= 0.1;
		}
	assert_doubt(&shot, "shows no parallax");
}

TEST("reflections in the floor and windows are left out")
{
	const struct drawn_lamp lamp[] = {
		two[0], {{1.2, 0.5, -1.8}, 0.08, 30}, {{-3, 0, 2}, 1.2, 5}};
	struct shot shot = plain_shot(lamp, 3, 3);

	for (int k = 0; k < 3; k++)
		shot.said[k][2] = shot.is[k][2] += 0.5;
	assert_true(find(&shot));
	assert_int_equal(found.lamps.count, 1);
	expect_below(length_of(found.lamps.lamp[0].position, two[0].at), 0.02, "%s", "the lamp");
}

TEST("a picture without lamps is doubted")
{
	struct shot shot = plain_shot(two, 2, 3);

	shot.room[1].lamps = 0;
	assert_doubt(&shot, "no lamp is to be seen");
}
