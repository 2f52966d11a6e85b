/* SPDX-License-Identifier: MIT */
/* Placed light: planes have the irradiance of the sky that the picture shows. */
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "hal/lights/exposures.h"
#include "hal/lights/sampler.h"
#include "hal/optics/dome_parts.h"
#include "hal/optics/vec.h"
#include "tests/support/expect.h"
#include "tests/support/test.h"
#include "tests/support/thorough.h"

#define SKY 0.2	    /* radiance of the even sky, in green */
#define SUN_TIMES 3 /* the sun gives a level plane so many times the sky's light */

/* Half a level of 8 bits at mid grey, as a share of the linear light there: sRGB 127.5 and 128. */
#define HALF_LEVEL 0.0088

struct placed_sky {
	struct dome dome;
	struct fisheye lens;
	struct light_sampler *sampler;
	struct image image;
	float (*radiance)[3];
};

/* Pixels that the horizon cuts are left out; they are a tenth of the smallest cells at 480. */
static int side_of(int f)
{
	return f < 18 ? 480 : 720;
}

static struct placed_sky placed_of(int f, int side, enum transfer curve)
{
	const struct light_sampler_settings settings = {
		.placed = true, .curve = {.named = curve}, .gain = 1};
	const struct fisheye_settings upright = {.field_deg = 90};
	struct placed_sky s = {.image = {.width = side, .height = side}};

	assert_int_equal(dome_create(&s.dome, f, NULL), 0);
	assert_int_equal(fisheye_prepare(&s.lens, &upright, side, side, NULL), 0);
	assert_int_equal(
		light_sampler_create(&s.sampler, &s.dome, &s.lens, side, side, &settings, NULL), 0);
	s.image.f32 = calloc((size_t)side * (size_t)side, 3 * sizeof(float));
	s.radiance = calloc((size_t)s.dome.count, sizeof(*s.radiance));
	assert_non_null(s.image.f32);
	assert_non_null(s.radiance);
	return s;
}

static void placed_free(struct placed_sky *s)
{
	light_sampler_destroy(s->sampler);
	dome_free(&s->dome);
	image_free(&s->image);
	free(s->radiance);
}

/* Paints an even sky. Its channels differ, so that their centroids do, too, under the sun. */
static void paint_even(struct placed_sky *s)
{
	for (int p = 0; p < s->image.width * s->image.height; p++)
		for (int c = 0; c < 3; c++)
			s->image.f32[3 * p + c] = (float)(SKY * (0.5 + 0.5 * c));
}

/* Adds a sun to the four pixels around its place, by bilinear weights: its irradiance of a plane
 * that it meets at a right angle. Its direction becomes that of the four together. */
static void paint_sun(struct placed_sky *s, double dir[3], double irradiance)
{
	double px[2], moment[3] = {0};
	int x0, y0;

	assert_true(fisheye_project(&s->lens, dir, px));
	x0 = (int)floor(px[0] - 0.5);
	y0 = (int)floor(px[1] - 0.5);
	for (int k = 0; k < 4; k++) {
		const int x = x0 + (k & 1), y = y0 + (k >> 1);
		const double centre[2] = {x + 0.5, y + 0.5};
		const double share = (1 - fabs(centre[0] - px[0])) * (1 - fabs(centre[1] - px[1]));
		double d[3];

		if (!fisheye_ray(&s->lens, centre, d) || d[2] < 0)
			continue;
		for (int c = 0; c < 3; c++) {
			moment[c] += share * d[c];
			s->image.f32[3 * (y * s->image.width + x) + c] +=
				(float)(share * irradiance / fisheye_pixel_sr(&s->lens, centre));
		}
	}
	memcpy(dir, moment, sizeof(moment));
}

/* Irradiance of a plane by the lights, each of which fills its cell evenly. No plane here sees a
 * cell only in part. */
static double plane_lit(const struct placed_sky *s, const double normal[3], int channel)
{
	double sum = 0;

	for (int i = 0; i < s->dome.count; i++) {
		double moment[3];

		dome_cells_moment(s->dome.cells, i, moment);
		sum += s->radiance[i][channel] * vec_dot(moment, normal);
	}
	return sum;
}

/* A plate that lies on the ground is as bright as the ground, which shows what is true. */
TEST("plate looks like the ground")
{
	static const int frequency[] = {1, 2, 4, 6, 9, 18};
	const int step = thorough() ? 1 : 3;

	for (unsigned n = 0; n < sizeof(frequency) / sizeof(*frequency); n++) {
		struct placed_sky s = placed_of(frequency[n], side_of(frequency[n]),
						TRANSFER_LINEAR);

		for (int height = 2; height <= 88; height += step * (height < 20 ? 1 : 7))
			for (int turn = 0; turn < 360; turn += step * 47) {
				const double h = height * M_PI / 180, a = turn * M_PI / 180;
				const double up[3] = {0, 0, 1};
				const double sun = SUN_TIMES * M_PI * SKY / sin(h);
				double d[3] = {cos(h) * cos(a), cos(h) * sin(a), sin(h)};

				paint_even(&s);
				paint_sun(&s, d, sun);
				assert_int_equal(
					light_sampler_read_linear(s.sampler, &s.image, s.radiance),
					0);
				for (int c = 0; c < 3; c++) {
					const double want = M_PI * SKY * (0.5 + 0.5 * c) +
							    sun * d[2];

					expect_below(fabs(plane_lit(&s, up, c) / want - 1),
						     HALF_LEVEL,
						     "f=%d, height %d, azimuth %d, channel %d",
						     frequency[n], height, turn, c);
				}
			}
		placed_free(&s);
	}
}

/* Planes that face the sun have its light, wherever in a cell it stands, above the middles of the
 * lowest cells. */
TEST("planes that face the sun are as bright")
{
	static const struct {
		int f, lowest;
		double error;
	} cases[] = {{4, 14, 0.05}, {9, 6, 0.015}, {18, 4, 0.01}};
	const int step = thorough() ? 1 : 3;

	for (unsigned n = 0; n < sizeof(cases) / sizeof(*cases); n++) {
		struct placed_sky s = placed_of(cases[n].f, side_of(cases[n].f), TRANSFER_LINEAR);

		memset(s.image.f32, 0,
		       (size_t)s.image.width * (size_t)s.image.height * 3 * sizeof(float));
		for (int height = cases[n].lowest; height <= 88; height += step * 5)
			for (int turn = 0; turn < 360; turn += step * 47) {
				const double h = height * M_PI / 180, a = turn * M_PI / 180;
				double d[3] = {cos(h) * cos(a), cos(h) * sin(a), sin(h)};

				memset(s.image.f32, 0,
				       (size_t)s.image.width * (size_t)s.image.height * 3 *
					       sizeof(float));
				paint_sun(&s, d, 1);
				assert_int_equal(
					light_sampler_read_linear(s.sampler, &s.image, s.radiance),
					0);
				for (int i = 0; i < s.dome.count; i++)
					expect_that(s.radiance[i][1] >= 0, "light %d", i);
				expect_below(fabs(plane_lit(&s, d, 1) - 1), cases[n].error,
					     "f=%d, height %d, azimuth %d", cases[n].f, height,
					     turn);
			}
		placed_free(&s);
	}
}

/* Even light stays even to the bit, and a sun that moves moves its light without steps. */
TEST("light moves without steps")
{
	struct placed_sky s = placed_of(4, side_of(4), TRANSFER_LINEAR);
	float(*before)[3] = calloc((size_t)s.dome.count, sizeof(*before));

	assert_non_null(before);
	paint_even(&s);
	assert_int_equal(light_sampler_read_linear(s.sampler, &s.image, s.radiance), 0);
	for (int i = 0; i < s.dome.count; i++)
		for (int c = 0; c < 3; c++)
			expect_below(fabs(s.radiance[i][c] / (SKY * (0.5 + 0.5 * c)) - 1), 1e-6,
				     "light %d", i);
	memset(s.image.f32, 0, (size_t)s.image.width * (size_t)s.image.height * 3 * sizeof(float));
	for (int step = 0; step <= (thorough() ? 600 : 150); step++) {
		const double h = (3 + 0.2 * step / 2) * M_PI / 180, a = 0.4 + 0.002 * step;
		double d[3] = {cos(h) * cos(a), cos(h) * sin(a), sin(h)}, moved = 0, all = 0;

		memcpy(before, s.radiance, (size_t)s.dome.count * sizeof(*before));
		memset(s.image.f32, 0,
		       (size_t)s.image.width * (size_t)s.image.height * 3 * sizeof(float));
		paint_sun(&s, d, 1);
		assert_int_equal(light_sampler_read_linear(s.sampler, &s.image, s.radiance), 0);
		for (int i = 0; i < s.dome.count; i++) {
			moved += fabs((double)(s.radiance[i][1] - before[i][1])) *
				 s.dome.solid_angle_sr[i];
			all += s.radiance[i][1] * s.dome.solid_angle_sr[i];
		}
		/* a step is 0.15 degrees or less, a cell 16 degrees wide: 2 * 0.15 / 16 */
		if (step)
			expect_below(moved / all, 0.08, "step %d", step);
	}
	free(before);
	placed_free(&s);
}

/* ---- exposures ---- */

enum { TAKEN = 3, TAKEN_SIDE = 240 };

static const double taken_ratio[TAKEN] = {1, 1 / 16.0, 1 / 256.0};

/* An 8-bit camera that takes the same sky in exposures, and what is merged of them. */
struct taken_sky {
	struct placed_sky sky;
	struct light_exposures *exposures;
	uint8_t codes[4 * TAKEN_SIDE * TAKEN_SIDE];
	float (*merged)[3];
	float *left;
};

static void taken_begin(struct taken_sky *t, int f)
{
	const struct transfer_curve curve = {.named = TRANSFER_SRGB};
	float *pixels;
	int values;

	t->sky = placed_of(f, TAKEN_SIDE, curve.named);
	values = t->sky.dome.count * light_sampler_parts(t->sky.sampler);
	expect_that(values > t->sky.dome.count, "%d values", values);
	t->merged = calloc((size_t)values, sizeof(*t->merged));
	t->left = calloc((size_t)values, sizeof(*t->left));
	pixels = calloc((size_t)t->sky.dome.count, sizeof(*pixels));
	assert_true(t->merged && t->left && pixels);
	for (int i = 0; i < t->sky.dome.count; i++)
		pixels[i] = 64;
	assert_int_equal(light_exposures_create(&t->exposures, t->sky.dome.count), 0);
	light_exposures_parts(t->exposures, light_sampler_parts(t->sky.sampler));
	light_exposures_measured(t->exposures, taken_ratio, TAKEN, &curve, 1, pixels);
	free(pixels);
}

static void taken_end(struct taken_sky *t)
{
	placed_free(&t->sky);
	light_exposures_destroy(t->exposures);
	free(t->merged);
	free(t->left);
}

/* Merges what the camera shows in an exposure, and places it. */
static void taken_show(struct taken_sky *t, int which, float (*lights)[3])
{
	const struct view whole = {.width = TAKEN_SIDE, .height = TAKEN_SIDE, .squash = 1};
	const struct picture picture = view_picture(&whole, t->codes, 4 * TAKEN_SIDE);
	struct light_sampler *sampler = t->sky.sampler;

	for (int p = 0; p < TAKEN_SIDE * TAKEN_SIDE; p++)
		for (int c = 0; c < 3; c++) {
			const double seen = (double)t->sky.image.f32[3 * p + c];
			const double shown = fmin(seen * taken_ratio[which], 1);

			t->codes[4 * p + 2 - c] =
				(uint8_t)lrint(255 * transfer_encode(TRANSFER_SRGB, shown));
		}
	light_sampler_exposure(sampler, light_exposures_longer(t->exposures, which),
			       light_exposures_shorter(t->exposures, which));
	assert_int_equal(light_sampler_read(sampler, &picture, NULL, NULL), 0);
	light_exposures_take(t->exposures, which, light_sampler_measured(sampler),
			     light_sampler_excess(sampler), light_sampler_clipped(sampler),
			     t->merged, t->left);
	light_sampler_place(sampler, (const float(*)[3])t->merged, lights);
}

/* Paints stripes, which give the light around the lamp another place in its cell. They are darker
 * than where a long exposure is no longer believed, else the rounding of the next one would show:
 * there is no noise here that hides it. */
static void paint_stripes(struct placed_sky *s)
{
	for (int p = 0; p < s->image.width * s->image.height; p++)
		for (int c = 0; c < 3; c++)
			s->image.f32[3 * p + c] = p % s->image.width / 24 % 2 ? 0.6f : 0.02f;
}

/* How far lights are apart, as a share of all their light. */
static double lights_apart(const struct placed_sky *s, const float (*a)[3], const float (*b)[3])
{
	double apart = 0, all = 0;

	for (int i = 0; i < s->dome.count; i++) {
		apart += s->dome.solid_angle_sr[i] * fabs((double)(a[i][1] - b[i][1]));
		all += s->dome.solid_angle_sr[i] * (double)b[i][1];
	}
	return apart / all;
}

/* A lamp that clips in the long exposures is placed as by a camera that never clips, and its light
 * stays where it is from one exposure to the next. */
TEST("a clipped lamp keeps its place")
{
	static struct taken_sky t;
	float(*want)[3], (*now)[3], (*before)[3];
	const int step = thorough() ? 1 : 3;

	taken_begin(&t, 4);
	want = t.sky.radiance;
	now = calloc((size_t)t.sky.dome.count, sizeof(*now));
	before = calloc((size_t)t.sky.dome.count, sizeof(*now));
	assert_true(now && before);
	for (int height = 15; height <= 75; height += step * 6)
		for (int turn = 0; turn < 360; turn += step * 47) {
			const double h = height * M_PI / 180, a = turn * M_PI / 180;
			double d[3] = {cos(h) * cos(a), cos(h) * sin(a), sin(h)};

			paint_stripes(&t.sky);
			paint_sun(&t.sky, d, 0.05);
			assert_int_equal(
				light_sampler_read_linear(t.sky.sampler, &t.sky.image, want), 0);
			light_exposures_begin(t.exposures);
			for (int k = 0; k < 3 * TAKEN; k++) {
				taken_show(&t, k % TAKEN, now);
				if (k < TAKEN - 1)
					continue;
				/* Codes of 8 bits are off by up to 0.8 %. Lights that are placed
				 * before they are merged are off by 1.7 %, and flicker. */
				expect_below(lights_apart(&t.sky, (const float(*)[3])now,
							  (const float(*)[3])want),
					     0.01, "height %d, azimuth %d, frame %d", height, turn,
					     k);
				if (k >= TAKEN)
					expect_below(lights_apart(&t.sky, (const float(*)[3])now,
								  (const float(*)[3])before),
						     1e-5, "height %d, azimuth %d, frame %d",
						     height, turn, k);
				memcpy(before, now, (size_t)t.sky.dome.count * sizeof(*now));
			}
		}
	free(now);
	free(before);
	taken_end(&t);
}
