/* SPDX-License-Identifier: MIT */
/* Placed light: planes have the irradiance of the sky that the picture shows. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "hal/lights/sampler.h"
#include "hal/optics/dome_cells.h"
#include "hal/optics/vec.h"
#include "tests/support/expect.h"

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

static struct placed_sky placed_of(int f)
{
	const struct light_sampler_settings settings = {
		.placed = true, .curve = {.named = TRANSFER_LINEAR}, .gain = 1};
	const struct fisheye_settings upright = {.field_deg = 90};
	/* Pixels that the horizon cuts are left out; they are a tenth of the smallest cells at 480. */
	const int side = f < 18 ? 480 : 720;
	struct placed_sky s = {.image = {.width = side, .height = side}};

	assert_int_equal(dome_create(&s.dome, f, DOME_ANGLES, NULL), 0);
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

/* Adds a sun to the four pixels around its place, by bilinear weights: its irradiance of a plane that
 * it meets at a right angle. Its direction becomes that of the four together. */
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

/* Irradiance of a plane by the lights, each of which fills its cell evenly. No plane here sees a cell
 * only in part. */
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
static void plate_looks_like_the_ground(void **state)
{
	static const int frequency[] = {1, 2, 4, 6, 9, 18};

	(void)state;
	for (unsigned n = 0; n < sizeof(frequency) / sizeof(*frequency); n++) {
		struct placed_sky s = placed_of(frequency[n]);

		for (int height = 2; height <= 88; height += height < 20 ? 1 : 7)
			for (int turn = 0; turn < 360; turn += 47) {
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
static void planes_that_face_the_sun_are_as_bright(void **state)
{
	static const struct {
		int f, lowest;
		double error;
	} cases[] = {{4, 14, 0.05}, {9, 6, 0.015}, {18, 4, 0.01}};

	(void)state;
	for (unsigned n = 0; n < sizeof(cases) / sizeof(*cases); n++) {
		struct placed_sky s = placed_of(cases[n].f);

		memset(s.image.f32, 0,
		       (size_t)s.image.width * (size_t)s.image.height * 3 * sizeof(float));
		for (int height = cases[n].lowest; height <= 88; height += 5)
			for (int turn = 0; turn < 360; turn += 47) {
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
static void light_moves_without_steps(void **state)
{
	struct placed_sky s = placed_of(4);
	float(*before)[3] = calloc((size_t)s.dome.count, sizeof(*before));

	(void)state;
	assert_non_null(before);
	paint_even(&s);
	assert_int_equal(light_sampler_read_linear(s.sampler, &s.image, s.radiance), 0);
	for (int i = 0; i < s.dome.count; i++)
		for (int c = 0; c < 3; c++)
			expect_below(fabs(s.radiance[i][c] / (SKY * (0.5 + 0.5 * c)) - 1), 1e-6,
				     "light %d", i);
	memset(s.image.f32, 0, (size_t)s.image.width * (size_t)s.image.height * 3 * sizeof(float));
	for (int step = 0; step <= 600; step++) {
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

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(plate_looks_like_the_ground),
		cmocka_unit_test(planes_that_face_the_sun_are_as_bright),
		cmocka_unit_test(light_moves_without_steps),
	};

	return cmocka_run_group_tests_name("placed light", tests, NULL, NULL);
}
