/* SPDX-License-Identifier: MIT */
/* The sun's place against known values, and the parts that it needs. */
#include <math.h>

#include "bake/sky/sky_parts.h"
#include "bake/sky/sun.h"
#include "hal/optics/vec.h"
#include "tests/support/expect.h"
#include "tests/support/test.h"

#define DEGREE (M_PI / 180)
#define close_to(is, should, within, ...) expect_below(fabs((is) - (should)), within, __VA_ARGS__)

TEST("days")
{
	assert_int_equal(sun_day((struct sun_date){1, 1}), 0);
	assert_int_equal(sun_day((struct sun_date){3, 1}), 59);
	assert_int_equal(sun_day((struct sun_date){2, 29}), 58);
	assert_int_equal(sun_day((struct sun_date){12, 31}), 364);
	assert_int_equal(sun_day((struct sun_date){2, 30}), -1);
	assert_int_equal(sun_day((struct sun_date){4, 31}), -1);
	assert_int_equal(sun_day((struct sun_date){13, 1}), -1);
	assert_int_equal(sun_day((struct sun_date){0, 1}), -1);
	assert_int_equal(sun_day((struct sun_date){5, 0}), -1);
}

/* Declinations at noon UT of 2023, from an almanac. */
TEST("declination")
{
	static const struct {
		struct sun_date date;
		double deg;
	} known[] = {
		{{1, 1}, -23.00}, {{2, 15}, -12.63}, {{3, 20}, -0.15}, {{5, 1}, 15.10},
		{{6, 21}, 23.44}, {{8, 15}, 14.00},  {{9, 23}, -0.02}, {{12, 21}, -23.44},
	};

	for (size_t k = 0; k < sizeof(known) / sizeof(*known); k++)
		close_to(sun_declination_rad(sun_day(known[k].date)) / DEGREE, known[k].deg, 0.5,
			 "k=%zu", k);
}

/* At noon the height is 90 - |latitude - declination|, and the sun is in the south or north. At
 * sunrise and sunset the azimuth is acos(sin declination / cos latitude) from north, and the hour
 * angle acos(-tan latitude tan declination). */
TEST("noon and sunrise")
{
	for (int latitude = -60; latitude <= 60; latitude += 15)
		for (int day = 0; day < 365; day += 13) {
			const double l = latitude * DEGREE, d = sun_declination_rad(day);
			const double half = acos(-tan(l) * tan(d)) / (15 * DEGREE);
			double noon[3], rise[3], set[3];

			sun_direction(l, d, 12, noon);
			close_to(asin(noon[2]), M_PI / 2 - fabs(l - d), 1e-9, "%d, %d", latitude,
				 day);
			close_to(noon[0], 0, 1e-12, "%d, %d", latitude, day);
			close_to(noon[1], sin(d - l), 1e-12, "%d, %d", latitude, day);
			sun_direction(l, d, 12 - half, rise);
			sun_direction(l, d, 12 + half, set);
			close_to(rise[2], 0, 1e-12, "%d, %d", latitude, day);
			close_to(atan2(rise[0], rise[1]), acos(sin(d) / cos(l)), 1e-9, "%d, %d",
				 latitude, day);
			close_to(set[0], -rise[0], 1e-12, "%d, %d", latitude, day);
			close_to(vec_dot(set, set), 1, 1e-12, "%d, %d", latitude, day);
		}
}

static bool part_near(const struct sky_parts *parts, double azimuth_deg, double height_deg,
		      double within_deg)
{
	const double a = azimuth_deg * DEGREE, h = height_deg * DEGREE;
	const double d[3] = {cos(h) * cos(a), cos(h) * sin(a), sin(h)};

	for (int k = 0; k < parts->count; k++)
		if (vec_angle(parts->part[k].direction, d) < within_deg * DEGREE)
			return true;
	return false;
}

/* North at 90 degrees is +Y: east is +X, south -Y. At the equinox and latitude 50 the sun rises in
 * the east, stands 40 degrees high in the south, and sets in the west. */
TEST("parts of a day")
{
	struct sun_path path = {.latitude_deg = 50,
				.north_deg = 90,
				.from = {3, 21},
				.to = {3, 21},
				.hours = {0, 24}};
	struct fault fault = {.text = ""};
	struct sky_parts parts;
	struct sky_need need;

	expect_success(sky_need_create(&need, 9, &fault), &fault);
	expect_above(sky_need_add_sun(&need, &path), 100, "pieces");
	expect_success(sky_parts_choose(&parts, &need, 2000, &fault), &fault);
	assert_true(part_near(&parts, 0, 2, 5));
	assert_true(part_near(&parts, -90, 40, 5));
	assert_true(part_near(&parts, 180, 2, 5));
	assert_false(part_near(&parts, 90, 40, 20)); /* the north */
	assert_false(part_near(&parts, -90, 60, 10));
	assert_in_range(parts.lights, 1000, 2000);
	sky_parts_free(&parts);
	sky_need_free(&need);
}

/* Over the turn of the year; only in the hours given; never in a polar night. */
TEST("dates and hours")
{
	struct sun_path path = {.latitude_deg = 50,
				.north_deg = 90,
				.from = {12, 20},
				.to = {1, 5},
				.hours = {8.5, 12}};
	struct fault fault = {.text = ""};
	struct sky_parts parts;
	struct sky_need need;

	expect_success(sky_need_create(&need, 9, &fault), &fault);
	expect_above(sky_need_add_sun(&need, &path), 10, "pieces");
	expect_success(sky_parts_choose(&parts, &need, 2000, &fault), &fault);
	assert_true(part_near(&parts, -90, 16.6, 6));
	assert_false(part_near(&parts, -120, 12, 15)); /* the afternoon */
	assert_false(part_near(&parts, -90, 40, 15));
	sky_parts_free(&parts);
	path.latitude_deg = 80;
	path.hours[0] = 0;
	assert_int_equal(sky_need_add_sun(&need, &path), 0);
	sky_need_free(&need);
}
