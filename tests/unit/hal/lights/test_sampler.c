/* SPDX-License-Identifier: MIT */
/* The light sampler: energy, lamps, rims, flips, and pictures too small for the dome. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "hal/lights/sampler.h"
#include "hal/optics/panorama.h"
#include "hal/optics/vec.h"
#include "tests/support/chance.h"
#include "tests/support/expect.h"
#include "tests/support/thorough.h"

/* A dome, a lens and a picture of the sky. */
struct sampled_sky {
	struct dome dome;
	struct fisheye lens;
	int width, height;
	uint8_t *pixels; /* BGRX */
	float (*radiance)[3];
	struct light_sampler *sampler;
};

static const struct light_sampler_settings by_cell = {.curve = {.named = TRANSFER_SRGB}, .gain = 1};
static const struct fisheye_settings upright = {.field_deg = 90};

/* Codes are decoded to 1/65535, rounded; plus a little for single precision. */
static const double code_error = 0.5001 / 65535;

static struct sampled_sky sky_of(int f, const struct fisheye_settings *lens, int width, int height,
				 const struct light_sampler_settings *settings)
{
	struct sampled_sky s = {.width = width, .height = height};

	assert_int_equal(dome_create(&s.dome, f, NULL), 0);
	assert_int_equal(fisheye_prepare(&s.lens, lens, width, height, NULL), 0);
	s.pixels = calloc((size_t)width * height, 4);
	s.radiance = calloc((size_t)s.dome.count, sizeof(*s.radiance));
	assert_non_null(s.pixels);
	assert_non_null(s.radiance);
	assert_int_equal(
		light_sampler_create(&s.sampler, &s.dome, &s.lens, width, height, settings, NULL),
		0);
	return s;
}

static void sky_free(struct sampled_sky *s)
{
	light_sampler_destroy(s->sampler);
	dome_free(&s->dome);
	free(s->pixels);
	free(s->radiance);
}

static struct picture picture_of(const struct sampled_sky *s)
{
	return (struct picture){s->pixels, 4, 4 * (ptrdiff_t)s->width, s->width, s->height};
}

static double read_sky(struct sampled_sky *s)
{
	const struct picture picture = picture_of(s);
	double clipped = -1;

	assert_int_equal(light_sampler_read(s->sampler, &picture, s->radiance, &clipped), 0);
	return clipped;
}

/* Whether the centre of a pixel shows sky; its solid angle and direction. */
static bool shows_sky(const struct sampled_sky *s, int x, int y, double dir[3], double *sr)
{
	const double px[2] = {x + 0.5, y + 0.5};

	*sr = fisheye_pixel_sr(&s->lens, px);
	return fisheye_ray(&s->lens, px, dir) && dir[2] >= 0;
}

/* Paints the image circle; outside of it the picture is black, as real ones are. */
static void paint(struct sampled_sky *s, const uint8_t bgr[3])
{
	for (int y = 0; y < s->height; y++)
		for (int x = 0; x < s->width; x++) {
			double dir[3], sr;
			const bool sky = shows_sky(s, x, y, dir, &sr);

			for (int c = 0; c < 3; c++)
				s->pixels[4 * (y * s->width + x) + c] = sky ? bgr[c] : 0;
		}
}

static void constant_sky_is_exact(void **state)
{
	static const struct {
		int f, width, height;
	} cases[] = {{1, 120, 120}, {18, 320, 240}, {9, 61, 47},   {36, 16, 16},  {9, 1, 1},
		     {1, 480, 480}, {4, 480, 480},  {9, 480, 480}, {64, 480, 480}};

	(void)state;
	for (unsigned k = 0; k < (thorough() ? sizeof(cases) / sizeof(*cases) : 5); k++) {
		const uint8_t bgr[3] = {200, 100, 7};
		struct sampled_sky s = sky_of(cases[k].f, &upright, cases[k].width, cases[k].height,
					      &by_cell);

		paint(&s, bgr);
		expect_equal(read_sky(&s), 0, "k=%u", k);
		for (int i = 0; i < s.dome.count; i++)
			for (int c = 0; c < 3; c++) {
				const double want = transfer_decode(TRANSFER_SRGB,
								    bgr[2 - c] / 255.0);

				expect_below(fabs(s.radiance[i][c] - want), code_error,
					     "light %d of %d, channel %d, case %u", i, s.dome.count,
					     c, k);
				expect_equal(s.radiance[i][c], s.radiance[0][c],
					     "light %d of %d, channel %d, case %u", i, s.dome.count,
					     c, k);
			}
		sky_free(&s);
	}
}

static void black_level_and_gain(void **state)
{
	const struct light_sampler_settings settings = {
		.curve = {.named = TRANSFER_BT709, .black = 19}, .gain = 2.5};
	const uint8_t codes[][3] = {{19, 18, 0}, {255, 137, 20}};
	struct sampled_sky s = sky_of(4, &upright, 120, 120, &settings);

	(void)state;
	for (int k = 0; k < 2; k++) {
		paint(&s, codes[k]);
		read_sky(&s);
		for (int c = 0; c < 3; c++) {
			const double code = fmax(0, (codes[k][2 - c] - 19) / 236.0);
			const double want = 2.5 * transfer_decode(TRANSFER_BT709, code);

			expect_at_most(fabs(s.radiance[7][c] - want), 2.5 * code_error,
				       "channel %d, codes %zu", c, (size_t)k);
		}
	}
	sky_free(&s);
}

/* A colour matrix for each light, whose negative results become 0, and a measured curve. */
static void colours_and_a_measured_curve(void **state)
{
	struct light_sampler_settings settings = {
		.curve = {.measured = true, .black = 8.5},
		.gain = 1.5,
		.colours = {0.8, 0.3, -0.1, 0, 1, 0, -2, 0.5, 0.5},
	};
	const uint8_t bgr[3] = {60, 120, 200};
	double linear[3];
	struct sampled_sky s;

	(void)state;
	for (int k = 0; k < TRANSFER_KNOTS; k++)
		settings.curve.knot[k] = pow((double)k / (TRANSFER_KNOTS - 1), 1.8);
	s = sky_of(4, &upright, 120, 120, &settings);
	paint(&s, bgr);
	read_sky(&s);
	for (int c = 0; c < 3; c++)
		linear[c] = pow((bgr[2 - c] - 8.5) / 246.5, 1.8);
	for (int r = 0; r < 3; r++) {
		double want = 0;

		for (int c = 0; c < 3; c++)
			want += 1.5 * settings.colours[3 * r + c] * linear[c];
		expect_below(fabs(s.radiance[7][r] - fmax(want, 0)), 2e-3, "channel %d", r);
	}
	assert_true(s.radiance[7][2] == 0);
	sky_free(&s);
}

static void fill_noise(struct sampled_sky *s, struct chance *chance)
{
	for (int k = 0; k < 4 * s->width * s->height; k++)
		s->pixels[k] = (uint8_t)chance_int(chance, 0, 254);
}

/* sum over lights of light * solid angle = sum over pixels of light * solid angle */
static void conserves_energy(void **state)
{
	static const int frequency[] = {2, 18, 4, 9};
	const struct fisheye_settings squashed = {
		.focal_px = {150, 75}, .centre_px = {243, 118}, .field_deg = 90};
	struct chance chance = chance_begin("sampler");

	(void)state;
	for (int k = 0; k < (thorough() ? 8 : 4); k++) {
		struct sampled_sky s = sky_of(frequency[k / 2], k % 2 ? &squashed : &upright, 480,
					      k % 2 ? 240 : 480, &by_cell);
		double lights = 0, pixels = 0;

		fill_noise(&s, &chance);
		read_sky(&s);
		for (int i = 0; i < s.dome.count; i++)
			lights += s.dome.solid_angle_sr[i] * s.radiance[i][1];
		for (int y = 0; y < s.height; y++)
			for (int x = 0; x < s.width; x++) {
				double dir[3], sr;

				if (shows_sky(&s, x, y, dir, &sr))
					pixels += sr * transfer_decode(
							       TRANSFER_SRGB,
							       s.pixels[4 * (y * s.width + x) + 1] /
								       255.0);
			}
		/* A pixel at the rim counts as sky or not as a whole, in both sums, but its cell
		 * does not. Over 54 seeds the mean is off by -1.6e-4 at most, and deviates by 7e-5.
		 */
		expect_below(fabs(lights / pixels - 1), 5e-4, "lens %d", (int)k);
		sky_free(&s);
	}
}

/* A lens of each model whose hemisphere fills the picture. */
static struct fisheye_settings lens_of_model(int model)
{
	return (struct fisheye_settings){
		.field_deg = 90, .model = model, .polynomial = {0.06, -0.02, 0.004, -0.0003}};
}

static void every_model_is_exact(void **state)
{
	struct chance chance = chance_begin("sampler");

	(void)state;
	for (int k = 0; k < FISHEYE_MODEL_COUNT; k++) {
		const struct fisheye_settings lens = lens_of_model(k);
		const uint8_t bgr[3] = {200, 100, 7};
		struct sampled_sky s = sky_of(9, &lens, 320, 320, &by_cell);
		double lights = 0, pixels = 0;

		paint(&s, bgr);
		expect_equal(read_sky(&s), 0, "k=%d", k);
		for (int i = 0; i < s.dome.count; i++)
			for (int c = 0; c < 3; c++)
				expect_that(s.radiance[i][c] == s.radiance[0][c] &&
						    fabs(s.radiance[i][c] -
							 transfer_decode(TRANSFER_SRGB,
									 bgr[2 - c] / 255.0)) <
							    code_error,
					    "k=%d, i=%d, c=%d", k, i, c);
		fill_noise(&s, &chance);
		read_sky(&s);
		for (int i = 0; i < s.dome.count; i++)
			lights += s.dome.solid_angle_sr[i] * s.radiance[i][1];
		for (int p = 0; p < s.width * s.height; p++) {
			double dir[3], sr;

			if (shows_sky(&s, p % s.width, p / s.width, dir, &sr))
				pixels += sr * transfer_decode(TRANSFER_SRGB,
							       s.pixels[4 * p + 1] / 255.0);
		}
		/* Half-covered pixels are left out; at an orthographic rim they hold many
		 * degrees. */
		expect_below(fabs(lights / pixels - 1), k == FISHEYE_ORTHOGRAPHIC ? 0.05 : 2e-3,
			     "k=%d", k);
		sky_free(&s);
	}
}

/* Vignetting is compensated: an even sky stays even. */
static void falloff_is_made_up_for(void **state)
{
	(void)state;
	for (int k = 0; k < FISHEYE_MODEL_COUNT; k++) {
		struct fisheye_settings lens = lens_of_model(k);
		struct image image;
		struct sampled_sky s;

		memcpy(lens.falloff, (double[]){-0.35, 0.08, -0.012}, sizeof(lens.falloff));
		s = sky_of(9, &lens, 320, 320, &by_cell);
		image = (struct image){.width = 320, .height = 320};
		image.f32 = calloc(320 * 320, 3 * sizeof(float));
		assert_non_null(image.f32);
		for (int p = 0; p < 320 * 320; p++) {
			const double px[2] = {p % 320 + 0.5, p / 320 + 0.5};

			for (int c = 0; c < 3; c++)
				image.f32[3 * p + c] =
					(float)((c + 1) * fisheye_falloff(&s.lens, px));
		}
		assert_int_equal(light_sampler_read_linear(s.sampler, &image, s.radiance), 0);
		for (int i = 0; i < s.dome.count; i++)
			for (int c = 0; c < 3; c++)
				expect_below(fabs(s.radiance[i][c] / (c + 1) - 1), 1e-4,
					     "light %d, channel %d", i, c);
		image_free(&image);
		sky_free(&s);
	}
}

/* One bright pixel anywhere in the sky: all of its energy arrives in the cells that it lies in. */
static void never_misses_a_lamp(void **state)
{
	struct sampled_sky cell = sky_of(9, &upright, 240, 240, &by_cell);
	int lamps = 0;

	(void)state;
	for (int y = 3; y < 240; y += 7)
		for (int x = 3; x < 240; x += 7) {
			uint8_t *pixel = cell.pixels + 4 * (y * 240 + x);
			double dir[3], sr, energy = 0;

			if (!shows_sky(&cell, x, y, dir, &sr) || dir[2] < 0.05)
				continue;
			lamps++;
			pixel[0] = pixel[1] = pixel[2] = 255;
			read_sky(&cell);
			for (int i = 0; i < cell.dome.count; i++)
				energy += cell.radiance[i][0] * cell.dome.solid_angle_sr[i];
			/* cells at the rim miss the pixels that lie partly outside the sky */
			expect_below(fabs(energy / sr - 1), dir[2] > 0.15 ? 0.01 : 0.05,
				     "lamp at (%g, %g, %g)", dir[0], dir[1], dir[2]);
			pixel[0] = pixel[1] = pixel[2] = 0;
		}
	assert_true(lamps > 500);
	sky_free(&cell);
}

/* A smooth sky that is brightest on one side, so that mirrored lights would be wrong. */
static double sky_radiance(const double dir[3], int channel)
{
	return 0.5 + 0.2 * dir[0] - 0.15 * dir[1] + 0.1 * channel * dir[2] +
	       0.1 * sin(5 * dir[0] + 2 * dir[1]);
}

/* Mean of the sky over each cell, by random directions and their nearest nodes. */
static void true_means(const struct dome *dome, struct chance *chance, double (*mean)[3])
{
	double *hits = calloc((size_t)dome->count, sizeof(*hits));

	assert_non_null(hits);
	memset(mean, 0, (size_t)dome->count * sizeof(*mean));
	for (int n = 0; n < 3000000; n++) {
		double dir[3], best = -1;
		int found = 0;

		chance_direction(chance, 0, dir);
		for (int i = 0; i < dome->count; i++) {
			const double near = vec_dot(dir, dome->direction[i]);

			if (near > best) {
				best = near;
				found = i;
			}
		}
		hits[found]++;
		for (int c = 0; c < 3; c++)
			mean[found][c] += sky_radiance(dir, c);
	}
	for (int i = 0; i < dome->count; i++)
		for (int c = 0; c < 3; c++)
			mean[i][c] /= hits[i];
	free(hits);
}

static void render(const struct sampled_sky *s, struct image *image)
{
	image->width = s->width;
	image->height = s->height;
	image->u8 = NULL;
	image->f32 = calloc((size_t)s->width * s->height, 3 * sizeof(float));
	assert_non_null(image->f32);
	for (int y = 0; y < s->height; y++)
		for (int x = 0; x < s->width; x++) {
			double dir[3], sr;

			if (!shows_sky(s, x, y, dir, &sr))
				continue;
			for (int c = 0; c < 3; c++)
				image->f32[3 * (y * s->width + x) + c] = (float)sky_radiance(dir,
											     c);
		}
}

static void means_of_a_known_sky(void **state)
{
	const struct fisheye_settings tilted = {
		.focal_px = {130, 110}, .rotation_deg = {8, -5, 200}, .field_deg = 110};
	struct chance chance = chance_begin("sampler");
	static double mean[86][3];

	(void)state;
	for (int k = 0; k < 2; k++) {
		struct sampled_sky s = sky_of(4, k ? &tilted : &upright, 640, 480, &by_cell);
		struct image image;

		if (k == 0)
			true_means(&s.dome, &chance, mean);
		render(&s, &image);
		assert_int_equal(light_sampler_read_linear(s.sampler, &image, s.radiance), 0);
		for (int i = 0; i < s.dome.count; i++)
			for (int c = 0; c < 3; c++)
				expect_below(fabs(s.radiance[i][c] - mean[i][c]), 3e-3,
					     "light %d, channel %d, lens %d", i, c, (int)k);
		free(image.f32);
		sky_free(&s);
	}
}

/* Most cells of this dome are smaller than a pixel, and some lie between all sub-pixels: they show
 * the sky at their nodes, off by what it changes within a pixel. */
static void nodes_of_a_known_sky(void **state)
{
	struct sampled_sky s = sky_of(DOME_FREQUENCY_MAX, &upright, 24, 24, &by_cell);
	struct image image;

	(void)state;
	render(&s, &image);
	assert_int_equal(light_sampler_read_linear(s.sampler, &image, s.radiance), 0);
	for (int i = 0; i < s.dome.count; i++) {
		const double *d = s.dome.direction[i];

		for (int c = 0; c < 3; c++)
			expect_below(fabs(s.radiance[i][c] - sky_radiance(d, c)), 0.1, "i=%d, c=%d",
				     i, c);
	}
	free(image.f32);
	sky_free(&s);
}

static void linear_and_8_bit_agree(void **state)
{
	const struct light_sampler_settings settings = {.curve = {.named = TRANSFER_LINEAR},
							.gain = 1.7};
	struct chance chance = chance_begin("sampler");
	struct sampled_sky s = sky_of(9, &upright, 200, 160, &settings);
	struct image image = {
		.width = 200, .height = 160, .f32 = calloc(200 * 160, 3 * sizeof(float))};
	float(*linear)[3] = calloc((size_t)s.dome.count, sizeof(*linear));

	(void)state;
	assert_non_null(image.f32);
	assert_non_null(linear);
	fill_noise(&s, &chance);
	for (int k = 0; k < 200 * 160; k++)
		for (int c = 0; c < 3; c++)
			image.f32[3 * k + c] = s.pixels[4 * k + 2 - c] / 255.0f;
	read_sky(&s);
	assert_int_equal(light_sampler_read_linear(s.sampler, &image, linear), 0);
	for (int i = 0; i < s.dome.count; i++)
		for (int c = 0; c < 3; c++)
			expect_below(fabs(linear[i][c] - s.radiance[i][c]), 1e-6,
				     "light %d, channel %d", i, c);
	image.width = 199;
	assert_int_equal(light_sampler_read_linear(s.sampler, &image, linear), -EINVAL);
	free(image.f32);
	free(linear);
	sky_free(&s);
}

static void flips_are_free(void **state)
{
	struct chance chance = chance_begin("sampler");
	struct sampled_sky s = sky_of(6, &upright, 99, 80, &by_cell);
	float(*want)[3] = calloc((size_t)s.dome.count, sizeof(*want));
	uint8_t *stored = calloc(99 * 80, 4);
	const size_t bytes = (size_t)s.dome.count * sizeof(*want);

	(void)state;
	assert_non_null(want);
	assert_non_null(stored);
	fill_noise(&s, &chance);
	read_sky(&s);
	memcpy(want, s.radiance, bytes);
	for (int flips = 0; flips < 4; flips++) {
		const struct view view = {0, 0, 99, 80, flips & 1, flips & 2, 1};
		struct picture picture;

		/* As a camera that is mounted that way stores the picture. */
		for (int y = 0; y < 80; y++)
			for (int x = 0; x < 99; x++)
				memcpy(stored + 4 * ((flips & 2 ? 79 - y : y) * 99 +
						     (flips & 1 ? 98 - x : x)),
				       s.pixels + 4 * (y * 99 + x), 4);
		picture = view_picture(&view, stored, 4 * 99);
		memset(s.radiance, 0, bytes);
		assert_int_equal(light_sampler_read(s.sampler, &picture, s.radiance, NULL), 0);
		assert_memory_equal(s.radiance, want, bytes);
	}
	free(want);
	free(stored);
	sky_free(&s);
}

/* A lens of 60 degrees does not see the cells near the horizon. */
static void outside_the_field_is_dark(void **state)
{
	const struct fisheye_settings narrow = {.field_deg = 60};
	struct sampled_sky s = sky_of(9, &narrow, 300, 300, &by_cell);
	int unseen = 0;

	(void)state;
	memset(s.pixels, 200, 4 * 300 * 300);
	read_sky(&s);
	for (int i = 0; i < s.dome.count; i++) {
		double corner[32][3], theta, phi;
		const int count = dome_cell_corners(&s.dome, i, corner, 32);
		double nearest;

		dome_angles(&s.dome, i, &theta, &phi);
		nearest = theta;
		for (int k = 0; k < count; k++)
			nearest = fmin(nearest, acos(corner[k][2]));
		unseen += s.radiance[i][0] == 0;
		/* a pixel is 0.4 degrees */
		if (nearest > 60.01 * M_PI / 180)
			expect_equal(s.radiance[i][0], 0, "i=%d", i);
		if (nearest < 59 * M_PI / 180)
			expect_above(s.radiance[i][0], 0, "i=%d", i);
	}
	assert_true(unseen > 100);
	sky_free(&s);
}

/* An image circle that the picture cuts off: the sky outside is not seen. */
static void cropped_circle(void **state)
{
	const struct fisheye_settings wide = {
		.focal_px = {100, 100}, .centre_px = {160, 60}, .field_deg = 90};
	struct sampled_sky s = sky_of(9, &wide, 320, 120, &by_cell);

	(void)state;
	memset(s.pixels, 200, 4 * 320 * 120);
	read_sky(&s);
	for (int i = 0; i < s.dome.count; i++) {
		double px[2];

		expect_that(fisheye_project(&s.lens, s.dome.direction[i], px), "i=%d", i);
		if (px[1] > 1 && px[1] < 119)
			expect_above(s.radiance[i][0], 0, "i=%d", i);
		if (px[1] < -20 || px[1] > 140)
			expect_equal(s.radiance[i][0], 0, "i=%d", i);
	}
	sky_free(&s);
}

static void clipped_share(void **state)
{
	struct sampled_sky s = sky_of(9, &upright, 480, 480, &by_cell);
	double want = 0;

	(void)state;
	memset(s.pixels, 254, 4 * 480 * 480);
	assert_true(read_sky(&s) == 0);
	for (int y = 100; y < 200; y++)
		for (int x = 150; x < 350; x++) {
			double dir[3], sr;

			s.pixels[4 * (y * 480 + x) + x % 3] = 255; /* any one of the channels */
			if (shows_sky(&s, x, y, dir, &sr))
				want += sr / (2 * M_PI);
		}
	assert_true(fabs(read_sky(&s) / want - 1) < 2e-3);
	for (int k = 0; k < 480 * 480; k++) /* the fourth byte has no meaning */
		memcpy(s.pixels + 4 * k, (uint8_t[]){128, 127, 0, 255}, 4);
	assert_true(read_sky(&s) == 0);
	memset(s.pixels, 255, 4 * 480 * 480);
	assert_true(fabs(read_sky(&s) - 1) < 1e-12);
	sky_free(&s);
}

/* ---- real skies ---- */

/* Light of each cell by direct integration over the panorama, each pixel in several parts, without
 * lens and sampler. */
static void integrate_panorama(const struct panorama *p, const struct dome *dome, double (*mean)[3])
{
	const int parts = thorough() ? 4 : 2;
	double *sum_sr = calloc((size_t)dome->count, sizeof(*sum_sr));

	assert_non_null(sum_sr);
	memset(mean, 0, (size_t)dome->count * sizeof(*mean));
	for (int y = 0; y < parts * p->image->height / 2; y++)
		for (int x = 0; x < parts * p->image->width; x++) {
			const float *pixel =
				p->image->f32 +
				3 * ((size_t)(y / parts) * p->image->width + x / parts);
			double dir[3], sr;
			int light;

			panorama_direction(p, (x + 0.5) / parts, (y + 0.5) / parts, dir);
			light = dome_cell_of(dome, dir);
			sr = hypot(dir[0], dir[1]);
			sum_sr[light] += sr;
			for (int c = 0; c < 3; c++)
				mean[light][c] += sr * pixel[c];
		}
	for (int i = 0; i < dome->count; i++)
		for (int c = 0; c < 3; c++)
			mean[i][c] /= sum_sr[i];
	free(sum_sr);
}

/* The fisheye picture of the panorama; each pixel is the mean of several points. */
static void photograph(const struct sampled_sky *s, const struct panorama *p, struct image *image)
{
	const int parts = thorough() ? 4 : 2;

	for (int y = 0; y < s->height; y++)
		for (int x = 0; x < s->width; x++)
			for (int k = 0; k < parts * parts; k++) {
				const double px[2] = {x + (k % parts + 0.5) / parts,
						      y + (k / parts + 0.5) / parts};
				double dir[3], rgb[3];

				if (!fisheye_ray(&s->lens, px, dir))
					continue;
				panorama_radiance(p, dir, rgb);
				for (int c = 0; c < 3; c++)
					image->f32[3 * (y * s->width + x) + c] +=
						(float)(rgb[c] / (parts * parts));
			}
}

static void check_real_sky(const char *folder, const char *name)
{
	const struct fisheye_settings turned = {.rotation_deg = {0, 0, 70}, .field_deg = 100};
	struct sampled_sky s = sky_of(9, &turned, 640, 640, &by_cell);
	double(*want)[3] = calloc((size_t)s.dome.count, sizeof(*want));
	struct image image,
		photo = {.width = 640, .height = 640, .f32 = calloc(640 * 640, 3 * sizeof(float))};
	const struct panorama p = {&image, 0.8, 1};
	double scale = 0, error = 0, lights = 0, truth = 0;
	char path[1024];

	assert_non_null(want);
	assert_non_null(photo.f32);
	snprintf(path, sizeof(path), "%s/hdri/%s", folder, name);
	assert_int_equal(image_read(path, &image, NULL), 0);
	integrate_panorama(&p, &s.dome, want);
	photograph(&s, &p, &photo);
	assert_int_equal(light_sampler_read_linear(s.sampler, &photo, s.radiance), 0);
	for (int i = 0; i < s.dome.count; i++)
		for (int c = 0; c < 3; c++) {
			const double sr = s.dome.solid_angle_sr[i];

			lights += sr * s.radiance[i][c];
			truth += sr * want[i][c];
			error += sr * fabs(s.radiance[i][c] - want[i][c]);
			scale += sr * want[i][c];
		}
	print_message("# %s: whole sky off by %.3f %%, lights on average by %.2f %%\n", name,
		      100 * fabs(lights / truth - 1), 100 * error / scale);
	assert_true(fabs(lights / truth - 1) < 5e-3);
	assert_true(error / scale < 0.02);
	image_free(&image);
	free(photo.f32);
	free(want);
	sky_free(&s);
}

static void real_skies(void **state)
{
	static const char *const names[] = {"st_fagans_interior_1k.hdr", "venice_sunset_1k.hdr",
					    "studio_small_03_1k.hdr"};
	const char *folder = getenv("INLAY_SHARED_DATA");
	char path[1024];

	(void)state;
	if (!folder)
		folder = "../shared/data";
	for (unsigned i = 0; i < (thorough() ? sizeof(names) / sizeof(*names) : 1); i++) {
		snprintf(path, sizeof(path), "%s/hdri/%s", folder, names[i]);
		if (access(path, R_OK) != 0) {
			print_message("# %s is missing; INLAY_SHARED_DATA names its folder\n",
				      path);
			skip();
		}
		check_real_sky(folder, names[i]);
	}
}

static void refused(void **state)
{
	static const struct light_sampler_settings bad[] = {
		{.curve = {.named = TRANSFER_COUNT}, .gain = 1},
		{.curve = {.named = TRANSFER_SRGB, .black = -1}, .gain = 1},
		{.curve = {.named = TRANSFER_SRGB, .black = 255}, .gain = 1},
		{.curve = {.measured = true}, .gain = 1},
		{.gain = 1, .colours = {[7] = INFINITY}},
		{.curve = {.named = TRANSFER_SRGB}, .gain = -1},
		{.curve = {.named = TRANSFER_SRGB}, .gain = NAN},
		{.curve = {.named = TRANSFER_SRGB}, .gain = INFINITY},
	};
	struct sampled_sky s = sky_of(2, &upright, 64, 48, &by_cell);
	struct picture picture = picture_of(&s);
	struct light_sampler *sampler;

	(void)state;
	for (unsigned k = 0; k < sizeof(bad) / sizeof(*bad); k++) {
		struct fault fault = {""};

		expect_equal(
			light_sampler_create(&sampler, &s.dome, &s.lens, 64, 48, &bad[k], &fault),
			-EINVAL, "k=%u", k);
		expect_above(strlen(fault.text), 0, "k=%u", k);
		assert_null(sampler);
	}
	assert_int_equal(light_sampler_create(&sampler, &s.dome, &s.lens, 64, 0, &by_cell, NULL),
			 -EINVAL);
	picture.height = 47;
	assert_int_equal(light_sampler_read(s.sampler, &picture, s.radiance, NULL), -EINVAL);
	light_sampler_destroy(NULL);
	sky_free(&s);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(constant_sky_is_exact),
		cmocka_unit_test(black_level_and_gain),
		cmocka_unit_test(colours_and_a_measured_curve),
		cmocka_unit_test(conserves_energy),
		cmocka_unit_test(every_model_is_exact),
		cmocka_unit_test(falloff_is_made_up_for),
		cmocka_unit_test(never_misses_a_lamp),
		cmocka_unit_test(means_of_a_known_sky),
		cmocka_unit_test(nodes_of_a_known_sky),
		cmocka_unit_test(linear_and_8_bit_agree),
		cmocka_unit_test(flips_are_free),
		cmocka_unit_test(outside_the_field_is_dark),
		cmocka_unit_test(cropped_circle),
		cmocka_unit_test(clipped_share),
		cmocka_unit_test(real_skies),
		cmocka_unit_test(refused),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
