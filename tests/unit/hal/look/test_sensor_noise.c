/* SPDX-License-Identifier: MIT */
/* A camera's noise, measured: against noise that was put in; and the object's, against the
 * camera's. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "hal/compositor/compositor.h"
#include "hal/look/grain_tables.h"
#include "tests/support/basis/random_frame.h"
#include "tests/support/chance.h"
#include "tests/support/expect.h"
#include "tests/support/test.h"

#define WIDTH 160
#define HEIGHT 120

static const struct transfer_curve srgb = {.named = TRANSFER_SRGB};

/* What the simulated camera does with linear light. */
struct camera {
	double floor, slope; /* variance */
	double across;	     /* correlation of neighbours */
	double light;	     /* of the scene */
};

/* A ramp from 0 to white, with stripes, as the camera sees it. */
static void expose(const struct camera *camera, struct chance *chance, uint8_t *pixels)
{
	for (int y = 0; y < HEIGHT; y++) {
		double n[3] = {chance_normal(chance), chance_normal(chance), chance_normal(chance)};

		for (int x = 0; x < WIDTH; x++) {
			const double scene = camera->light * (0.02 + 0.8 * y / HEIGHT) *
					     (x / 5 % 2 ? 1 : 0.9);

			for (int c = 0; c < 3; c++) {
				const double sigma = sqrt(camera->floor + camera->slope * scene);
				const double r = camera->across;

				n[c] = x ? r * n[c] + sqrt(1 - r * r) * chance_normal(chance)
					 : n[c];
				pixels[4 * (y * WIDTH + x) + c] = (uint8_t)lround(
					255 *
					transfer_curve_encode(
						&srgb, fmin(fmax(scene + sigma * n[c], 0), 1)));
			}
		}
	}
}

static struct sensor_noise_model measure(const struct camera *camera, int frames, double walker)
{
	static uint8_t pixels[WIDTH * HEIGHT * 4];
	const struct picture picture = {pixels, 4, 4 * WIDTH, WIDTH, HEIGHT};
	struct chance chance = chance_begin("sensor noise");
	struct sensor_noise_model model = {.floor = {-1}};
	struct camera now = *camera;
	struct sensor_noise *noise;

	assert_int_equal(sensor_noise_create(&noise, WIDTH, HEIGHT, &srgb), 0);
	for (int f = 0; f < frames; f++) {
		now.light = camera->light * (f / 20 % 2 ? 1 : 0.8); /* a lamp that is switched */
		expose(&now, &chance, pixels);
		for (int y = 0; y < HEIGHT * walker; y++)
			for (int x = 0; x < 4 * 40; x++)
				pixels[4 * y * WIDTH + (x + 16 * f) % (4 * WIDTH)] =
					(uint8_t)chance_int(&chance, 0, 255);
		sensor_noise_watch(noise, &picture);
	}
	sensor_noise_fit(noise, &model);
	sensor_noise_destroy(noise);
	return model;
}

TEST("finds what was put in")
{
	static const struct camera cameras[] = {
		{1e-5, 2e-4, 0, 1}, {4e-5, 0, 0, 1}, {1e-6, 5e-4, 0, 1}, {1e-5, 2e-4, 0.5, 1}};

	for (size_t k = 0; k < sizeof(cameras) / sizeof(*cameras); k++) {
		const struct sensor_noise_model m = measure(&cameras[k], 150, 0.3);

		for (int c = 0; c < 3; c++) {
			for (double light = 0.05; light < 0.8; light += 0.15) {
				const double is = sqrt(m.floor[c] + m.slope[c] * light);
				const double should =
					sqrt(cameras[k].floor + cameras[k].slope * light);

				expect_at_least(is / should, 0.92, "camera %zu, light %g", k,
						light);
				expect_at_most(is / should, 1.08, "camera %zu, light %g", k, light);
			}
		}
		expect_below(fabs(m.across - cameras[k].across), 0.08, "camera %zu", k);
		expect_below(m.down + m.channels, 0.08, "camera %zu", k);
	}
}

TEST("waits for frames")
{
	const struct camera camera = {1e-5, 2e-4, 0, 1};

	assert_true(measure(&camera, 1, 0).floor[0] == -1);
}

TEST("a picture without noise gives none")
{
	const struct camera camera = {0, 0, 0, 1};
	const struct sensor_noise_model m = measure(&camera, 20, 0);

	assert_true(m.floor[0] == 0 && m.slope[0] == 0);
}

/* ---- the object's grain ---- */

TEST("tables have the correlations")
{
	static struct grain_tables tables;
	const struct sensor_noise_model m = {.across = 0.5, .down = 0.3, .channels = 0.4};
	struct grain grain = {.seed = 1};
	double sum = 0, own = 0, across = 0, down = 0, pair = 0;

	grain_tables_fit(&tables, &m, &grain);
	for (int y = 1; y < GRAIN_SIDE; y++)
		for (int x = 1; x < GRAIN_SIDE; x++) {
			const double n = tables.n[0][y][x];

			sum += n;
			own += n * n;
			across += n * tables.n[0][y][x - 1];
			down += n * tables.n[0][y - 1][x];
			pair += n * tables.n[1][y][x];
		}
	assert_true(fabs(sum) / (GRAIN_SIDE * GRAIN_SIDE) < 0.05 * GRAIN_ONE);
	assert_true(fabs(own / (GRAIN_SIDE * GRAIN_SIDE * GRAIN_ONE * GRAIN_ONE) - 1) < 0.04);
	assert_true(fabs(across / own - 0.5) < 0.03);
	assert_true(fabs(down / own - 0.3) < 0.03);
	assert_true(fabs(pair / own - 0.4) < 0.03);
}

#define FRAMES 64

/* Composites the same noisy background many times, and compares, pixel by pixel, the variance of
 * the result with that of a camera that sees the same light. */
TEST("object has the cameras noise")
{
	const struct synthetic_options options = {.width = 80,
						  .height = 48,
						  .lights = 12,
						  .grounds = 1,
						  .columns = -1,
						  .object_share = 0.5,
						  .ground_share = 0.5,
						  .peak = 0.3,
						  .seed = 5};
	const struct sensor_noise_model m = {.floor = {1e-5, 1e-5, 1e-5},
					     .slope = {2e-4, 2e-4, 2e-4}};
	struct compositor_settings settings = {.gain = 1, .object = true};
	struct chance chance = chance_begin("grain");
	static struct grain_tables tables;
	static double sum[80 * 48], squares[80 * 48];
	struct grain grain;
	double is[2] = {0}, should[2] = {0}, before = 0;
	struct synthetic s;
	struct random_frame f;
	double *scene;

	synthetic_open(&s, &options);
	random_frame_begin(&f, &s.basis, NULL, &chance);
	grain_tables_fit(&tables, &m, &grain);
	scene = calloc(80 * 48, sizeof(*scene));
	assert_non_null(scene);
	for (int p = 0; p < 80 * 48; p++)
		scene[p] = chance_real(&chance, 0.1, 0.7);
	for (int pass = 0; pass < 2; pass++) { /* without grain, with it */
		memset(sum, 0, sizeof(sum));
		memset(squares, 0, sizeof(squares));
		for (int n = 0; n < FRAMES; n++) {
			for (int p = 0; p < 80 * 48; p++)
				for (size_t c = 0; c < 3; c++)
					f.background[(size_t)(p / 80) * f.stride +
						     (size_t)(p % 80) * 4 + c] = (uint8_t)
						lround(255 *
						       transfer_curve_encode(
							       &srgb,
							       scene[p] +
								       sqrt(1e-5 +
									    2e-4 * scene[p]) *
									       chance_normal(
										       &chance)));
			grain.seed = (uint64_t)n;
			settings.grain = pass ? &grain : NULL;
			compositor_set(f.compositor, &settings);
			random_frame_run(&f, 0);
			for (int p = 0; p < 80 * 48; p++) {
				const double light = transfer_curve_decode(
					&srgb, f.out[(size_t)(p / 80) * f.stride +
						     (size_t)(p % 80) * 4 + 1] /
						       255.0);

				sum[p] += light / FRAMES;
				squares[p] += light * light / (FRAMES - 1);
			}
		}
		for (int p = 0; p < 80 * 48; p++) {
			const double variance = squares[p] -
						sum[p] * sum[p] * FRAMES / (FRAMES - 1);
			const int covered = s.basis.poses[0].coverage[p] > 0;

			if (sum[p] < 0.05 || sum[p] > 0.9)
				continue;
			if (!pass) {
				before += covered ? variance : 0;
				continue;
			}
			/* Rounding to code values adds its own. */
			is[covered] += variance;
			should[covered] += 1e-5 + 2e-4 * sum[p];
		}
	}
	print_message(
		"# object's noise to the camera's: %.3f (%.3f without grain), ground's: %.3f\n",
		sqrt(is[1] / should[1]), sqrt(before / should[1]), sqrt(is[0] / should[0]));
	assert_true(sqrt(is[1] / should[1]) > 0.95 && sqrt(is[1] / should[1]) < 1.06);
	assert_true(sqrt(is[0] / should[0]) > 0.95 && sqrt(is[0] / should[0]) < 1.06);
	free(scene);
	random_frame_end(&f);
	synthetic_close(&s);
}

TEST("same frame same bytes")
{
	const struct synthetic_options options = {.width = 61,
						  .height = 50,
						  .lights = 12,
						  .grounds = 1,
						  .columns = -1,
						  .object_share = 0.5,
						  .ground_share = 0.5,
						  .seed = 6};
	const struct sensor_noise_model m = {.floor = {1e-4, 1e-4, 1e-4}};
	static struct grain_tables tables;
	struct chance chance = chance_begin("grain");
	struct compositor_settings settings = {.gain = 1, .object = true};
	struct grain grain = {.seed = 7};
	struct synthetic s;
	struct random_frame f;
	struct pool *pool;
	uint8_t *first;

	assert_int_equal(pool_create(&pool, 3), 0);
	synthetic_open(&s, &options);
	grain_tables_fit(&tables, &m, &grain);
	settings.grain = &grain;
	random_frame_begin(&f, &s.basis, pool, &chance);
	compositor_set(f.compositor, &settings);
	random_frame_run(&f, 0);
	first = malloc(f.bytes);
	assert_non_null(first);
	memcpy(first, f.out, f.bytes);
	random_frame_run(&f, 0);
	expect_same_picture(f.out, first, f.stride, f.bytes, "the same frame again");
	grain.seed = 8;
	random_frame_run(&f, 0);
	assert_true(memcmp(f.out, first, f.bytes) != 0);
	free(first);
	random_frame_end(&f);
	synthetic_close(&s);
	pool_destroy(pool);
}
