/* SPDX-License-Identifier: MIT */
/* Several exposures of one sky merged into one light: the sampler's part, the merge, and which
 * exposure a frame has. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "hal/lights/exposures.h"
#include "hal/lights/pixel_noise.h"
#include "hal/lights/sampler.h"
#include "tests/support/chance.h"
#include "tests/support/expect.h"
#include "tests/support/test.h"

enum { LIGHTS = 40, COUNT = 3, PIXELS = 64 };

static const double ratio[COUNT] = {1, 1 / 16.0, 1 / 256.0};
static const struct transfer_curve curve = {.named = TRANSFER_SRGB};

/* What the sampler returns for the lights in one exposure. */
struct taken_lights {
	float sampled[LIGHTS][3], excess[LIGHTS][3], clipped[LIGHTS];
};

/* A cell, part of which is a lamp. */
struct cell {
	double dim[3], lamp[3], share;
};

struct merged {
	float radiance[LIGHTS][3], left[LIGHTS];
};

static struct light_exposures *create(double gain)
{
	float pixels[LIGHTS];
	struct light_exposures *e;

	for (int i = 0; i < LIGHTS; i++)
		pixels[i] = PIXELS + (float)i;
	assert_int_equal(light_exposures_create(&e, LIGHTS), 0);
	light_exposures_measured(e, ratio, COUNT, &curve, gain, pixels);
	return e;
}

/* Exposes cells without noise; a channel clips at white. */
static void expose(const struct light_exposures *e, int k, const struct cell *cell,
		   struct taken_lights *f)
{
	const double above = light_exposures_longer(e, k);

	for (int i = 0; i < LIGHTS; i++) {
		const struct cell *at = &cell[i];
		bool lamp = false, dim = false;

		for (int c = 0; c < 3; c++) {
			const double d = fmin(at->dim[c] * ratio[k], 1);
			const double l = fmin(at->lamp[c] * ratio[k], 1);

			dim |= d >= 1;
			lamp |= l >= 1;
			f->sampled[i][c] = (float)(d + at->share * (l - d));
			f->excess[i][c] = (float)((1 - at->share) * fmax(d - above, 0) +
						  at->share * fmax(l - above, 0));
		}
		f->clipped[i] = (float)((dim ? 1 - at->share : 0) + (lamp ? at->share : 0));
	}
}

static void exposures_take(struct light_exposures *e, int k, const struct taken_lights *f,
			   struct merged *m)
{
	light_exposures_take(e, k, (const float(*)[3])f->sampled, (const float(*)[3])f->excess,
			     f->clipped, m->radiance, m->left);
}

static bool fits(const struct light_exposures *e, int k, const struct taken_lights *f)
{
	return light_exposures_fit(e, k, (const float(*)[3])f->sampled, f->clipped);
}

static void exposures_show(struct light_exposures *e, int k, const struct cell *cell,
			   struct merged *m)
{
	struct taken_lights f;

	expose(e, k, cell, &f);
	exposures_take(e, k, &f, m);
}

static double truth(const struct cell *cell, int c)
{
	return cell->dim[c] + cell->share * (cell->lamp[c] - cell->dim[c]);
}

static void exposures_fill(struct cell *cell, double dim, double lamp, double share)
{
	for (int i = 0; i < LIGHTS; i++)
		cell[i] = (struct cell){{dim, dim / 2, dim / 4}, {lamp, lamp / 2, lamp / 4}, share};
}

/* ---- the merge ---- */

/* Exposure times are powers of two, so that nothing rounds: the merge must not either. */
TEST("a constant sky is exact")
{
	static const double levels[] = {0, 0.0009765625, 0.125, 0.75, 2, 24, 200};
	struct cell cell[LIGHTS];
	struct merged m;

	for (size_t n = 0; n < sizeof(levels) / sizeof(*levels); n++) {
		struct light_exposures *e = create(1);

		exposures_fill(cell, levels[n], 0, 0);
		for (int turn = 0; turn < 2; turn++) {
			for (int k = 0; k < COUNT; k++) {
				exposures_show(e, k, cell, &m);
				if (!turn && k + 1 < COUNT)
					continue;
				for (int i = 0; i < LIGHTS; i++) {
					expect_equal(m.left[i], 0, "n=%zu, turn=%d, k=%d, i=%d", n,
						     turn, k, i);
					for (int c = 0; c < 3; c++)
						expect_equal(m.radiance[i][c],
							     (float)cell[i].dim[c],
							     "n=%zu, turn=%d, k=%d, i=%d, c=%d", n,
							     turn, k, i, c);
				}
			}
		}
		light_exposures_destroy(e);
	}
}

/* A camera whose exposures differ from those it was asked for reports them with its first pictures.
 */
TEST("other ratios count from the next frame")
{
	static const double wanted[COUNT] = {1, 0.3, 0.03};
	struct light_exposures *e = create(1);
	struct cell cell[LIGHTS];
	struct merged m;

	exposures_fill(cell, 2, 0, 0); /* the first exposure clips */
	light_exposures_ratios(e, wanted);
	exposures_show(e, 1, cell, &m);
	assert_true(m.radiance[0][0] != 2);
	light_exposures_ratios(e, ratio);
	exposures_show(e, 1, cell, &m);
	assert_true(m.radiance[0][0] == 2);
	light_exposures_destroy(e);
}

/* One exposure passes unchanged, bit by bit. */
TEST("one exposure is untouched")
{
	static const double one[] = {1};
	struct light_exposures *e;
	float pixels[LIGHTS];
	struct chance chance = chance_begin("one exposure");
	struct taken_lights f;
	struct merged m;

	assert_int_equal(light_exposures_create(&e, LIGHTS), 0);
	for (int i = 0; i < LIGHTS; i++) {
		pixels[i] = 9;
		f.clipped[i] = i % 3 ? 0 : 0.25f;
		for (int c = 0; c < 3; c++)
			f.sampled[i][c] = (float)chance_real(&chance, 0, 3);
	}
	light_exposures_measured(e, one, 1, &curve, 3, pixels);
	for (int turn = 0; turn < 2; turn++) {
		exposures_take(e, 0, &f, &m);
		assert_memory_equal(m.radiance, f.sampled, sizeof(f.sampled));
		assert_memory_equal(m.left, f.clipped, sizeof(f.clipped));
		expect_that(fits(e, 0, &f), "turn=%d", turn);
	}
	light_exposures_destroy(e);
}

/* A small lamp in a dim cell, from brightnesses that no exposure clips to those that all clip. */
TEST("a lamp is found in the shortest")
{
	struct cell cell[LIGHTS];
	struct merged m;
	struct light_exposures *e = create(1);

	exposures_fill(cell, 0.1, 0.1, 0);
	for (int i = 0; i < LIGHTS; i++)
		for (int c = 0; c < 3; c++) {
			cell[i].lamp[c] = 0.2 * pow(1.25, i) / (c + 1);
			cell[i].share = 0.05;
		}
	for (int k = 0; k < COUNT; k++)
		exposures_show(e, k, cell, &m);
	for (int i = 0; i < LIGHTS; i++) {
		const bool lost = cell[i].lamp[0] >= 256;

		expect_equal((m.left[i] > 0), lost, "i=%d", i);
		expect_that(!lost || fabs((double)m.left[i] - 0.05) < 1e-6, "i=%d", i);
		for (int c = 0; c < 3; c++) {
			const double is = (double)m.radiance[i][c], want = truth(&cell[i], c);

			if (cell[i].lamp[c] < 256)
				expect_below(fabs(is - want), 1e-5 * want, "i=%d, c=%d", i, c);
			else
				expect_that(is < want && is > 0.05 * 255, "i=%d, c=%d", i, c);
		}
	}
	assert_true(light_exposures_white(e) == 256);
	light_exposures_destroy(e);
}

/* The mean of pixels with noise as the model has it. */
static double noisy(struct chance *chance, double light, int k)
{
	const struct pixel_noise noise = pixel_noise_of(&curve);
	double sum = 0;

	for (int n = 0; n < 12; n++)
		sum += chance_real(chance, -1, 1);
	return light * ratio[k] +
	       sum / 2 * sqrt((noise.floor + noise.slope * light * ratio[k]) / PIXELS);
}

/* The merge is no worse than the best exposure alone, and has no bias. */
TEST("weights follow the noise")
{
	enum { TURNS = 200 };
	struct chance chance = chance_begin("weights");
	const double light = 0.4;
	double squares = 0, alone = 0, sum = 0;
	int count = 0;

	for (int turn = 0; turn < TURNS; turn++) {
		struct light_exposures *e = create(1);
		struct taken_lights f = {.clipped = {0}};
		struct merged m;

		for (int k = 0; k < COUNT; k++) {
			for (int i = 0; i < LIGHTS; i++)
				for (int c = 0; c < 3; c++)
					f.sampled[i][c] = (float)noisy(&chance, light, k);
			if (k == 0)
				for (int i = 0; i < LIGHTS; i++)
					alone += pow((double)f.sampled[i][0] - light, 2);
			exposures_take(e, k, &f, &m);
		}
		for (int i = 0; i < LIGHTS; i++, count++) {
			squares += pow((double)m.radiance[i][0] - light, 2);
			sum += (double)m.radiance[i][0] - light;
		}
		light_exposures_destroy(e);
	}
	assert_true(squares < alone);
	assert_true(fabs(sum / count) < 4 * sqrt(squares / count / count));
}

/* ---- what changes ---- */

static void must_be(const struct merged *m, const struct cell *cell)
{
	for (int i = 0; i < LIGHTS; i++)
		for (int c = 0; c < 3; c++)
			expect_at_most(fabs((double)m->radiance[i][c] - truth(&cell[i], c)),
				       1e-4 * truth(&cell[i], c) + 1e-5, "i=%d, c=%d", i, c);
}

/* A switched lamp is followed at once where the frame shows it unclipped, else within one round of
 * exposures. */
TEST("a switched lamp is followed")
{
	struct cell off[LIGHTS], on[LIGHTS];
	struct merged m;

	exposures_fill(off, 0.3, 0.3, 0);
	exposures_fill(on, 0.3, 40, 0.1);
	for (int first = 0; first < COUNT; first++) {
		struct light_exposures *e = create(1);

		for (int k = 0; k < COUNT; k++)
			exposures_show(e, k, off, &m);
		must_be(&m, off);
		for (int k = 0; k < COUNT; k++) {
			exposures_show(e, (first + k) % COUNT, on, &m);
			for (int i = 0; i < LIGHTS; i++) /* brighter from the first frame on */
				expect_above(m.radiance[i][0], 0.3f, "first=%d, k=%d, i=%d", first,
					     k, i);
		}
		must_be(&m, on);
		for (int k = 0; k < COUNT; k++)
			exposures_show(e, (first + k) % COUNT, off, &m);
		must_be(&m, off);
		light_exposures_destroy(e);
	}
}

/* Exposure times that are 5 % wrong still give steady light. */
TEST("exposures that are off do not flicker")
{
	struct light_exposures *e = create(1);
	struct cell cell[LIGHTS], seen[LIGHTS];
	struct merged before = {.left = {0}}, m;

	for (int i = 0; i < LIGHTS; i++)
		cell[i] = (struct cell){{0.02 * i, 0.5, 3}, {0.02 * i, 0.5, 3}, 0};
	for (int turn = 0; turn < 4; turn++) {
		for (int k = 0; k < COUNT; k++) {
			memcpy(seen, cell, sizeof(seen));
			for (int i = 0; i < LIGHTS; i++)
				for (int c = 0; c < 3; c++)
					seen[i].dim[c] = seen[i].lamp[c] = cell[i].dim[c] *
									   (1 + 0.05 * k);
			exposures_show(e, k, seen, &m);
			if (turn > 1)
				assert_memory_equal(&before, &m, sizeof(m));
			before = m;
		}
	}
	light_exposures_destroy(e);
}

/* ---- whose frame it is ---- */

TEST("wrong exposures are noticed")
{
	static const double dims[] = {0.02, 0.2, 0.6, 3};

	for (size_t n = 0; n < sizeof(dims) / sizeof(*dims); n++) {
		for (int lamp = 0; lamp < 2; lamp++) {
			struct light_exposures *e = create(1);
			struct cell cell[LIGHTS];
			struct merged m;
			struct taken_lights f;

			exposures_fill(cell, dims[n], dims[n], 0);
			for (int i = 0; lamp && i < 4; i++)
				cell[i] = (struct cell){
					{dims[n], dims[n], dims[n]}, {90, 80, 70}, 0.02};
			expose(e, 1, cell, &f);
			expect_that(fits(e, 0, &f), "n=%zu, lamp=%d", n,
				    lamp); /* nothing is known yet */
			for (int k = 0; k < COUNT; k++)
				exposures_show(e, k, cell, &m);
			for (int is = 0; is < COUNT; is++) {
				expose(e, is, cell, &f);
				for (int said = 0; said < COUNT; said++) {
					/* Cells that are dark in both exposures do not tell them
					 * apart. */
					const bool dark = dims[n] < 0.1 && !lamp && is && said;

					if (dark || (is && said && dims[n] < 0.5))
						continue;
					if (fits(e, said, &f) != (is == said))
						fail_msg("light %g, lamp %d: %d for %d", dims[n],
							 lamp, is, said);
				}
				expect_that(fits(e, is, &f), "n=%zu, lamp=%d, is=%d", n, lamp, is);
			}
			light_exposures_destroy(e);
		}
	}
}

/* Until a shorter exposure has been seen, a lamp that clips in the longest may have any brightness
 * in it. Every exposure fits that shows the unclipped cells as they are. */
TEST("a clipped lamp may be of any brightness")
{
	static const double lamps[] = {2, 20, 300};

	for (size_t n = 0; n < sizeof(lamps) / sizeof(*lamps); n++) {
		const double l = lamps[n];

		for (int k = 1; k < COUNT; k++) {
			struct light_exposures *e = create(1);
			struct cell cell[LIGHTS];
			struct merged m;
			struct taken_lights f;

			exposures_fill(cell, 0.5, 0.5, 0);
			for (int i = 0; i < 6; i++)
				cell[i] = (struct cell){{0.5, 0.5, 0.5}, {l, l, l}, 0.4};
			exposures_show(e, 0, cell, &m);
			expose(e, k, cell, &f);
			expect_that(fits(e, k, &f), "n=%zu, k=%d", n, k);
			assert_false(fits(e, 0, &f));
			expose(e, 0, cell, &f);
			expect_that(fits(e, 0, &f), "n=%zu, k=%d", n, k);
			assert_false(fits(e, k, &f));
			light_exposures_destroy(e);
		}
	}
}

/* The room gets four times brighter or darker. The exposures follow within two rounds, and none is
 * mistaken for another. */
TEST("a change of the whole room is taken")
{
	for (int up = 0; up < 2; up++) {
		struct light_exposures *e = create(1);
		struct cell cell[LIGHTS];
		struct merged m;
		struct taken_lights f;
		int taken = 0;

		exposures_fill(cell, 0.2, 0.2, 0);
		for (int k = 0; k < COUNT; k++)
			exposures_show(e, k, cell, &m);
		exposures_fill(cell, up ? 0.8 : 0.05, 0, 0);
		for (int frame = 0; frame < 2 * COUNT; frame++) {
			expose(e, frame % COUNT, cell, &f);
			if (!fits(e, frame % COUNT, &f))
				continue;
			exposures_take(e, frame % COUNT, &f, &m);
			taken++;
		}
		expect_at_least(taken, COUNT, "up=%d", up);
		must_be(&m, cell);
		light_exposures_destroy(e);
	}
}

/* ---- the sampler's part ---- */

/* Light that is believed, that which a longer exposure does not believe, and clipped light, against
 * sums over the pixels. */
TEST("the sampler tells what is believed")
{
	enum { SIDE = 96 };
	const struct light_sampler_settings settings = {.curve = curve, .gain = 2};
	const struct fisheye_settings lens_settings = {.field_deg = 90};
	static uint8_t pixels[SIDE][SIDE][4];
	const struct view view = {.width = SIDE, .height = SIDE, .squash = 1};
	const struct picture picture = view_picture(&view, &pixels[0][0][0], sizeof(pixels[0]));
	struct chance chance = chance_begin("above");
	struct light_sampler *sampler;
	struct fisheye lens;
	struct dome dome;
	struct pixel_white white;
	struct image image;
	double clipped;
	const double longer = 0.25;

	pixel_white_fill(&white, &curve);
	assert_int_equal(dome_create(&dome, 3, NULL), 0);
	assert_int_equal(fisheye_prepare(&lens, &lens_settings, SIDE, SIDE, NULL), 0);
	assert_int_equal(light_sampler_create(&sampler, &dome, &lens, SIDE, SIDE, &settings, NULL),
			 0);
	assert_int_equal(image_create_f32(&image, SIDE, SIDE), 0);
	for (int y = 0; y < SIDE; y++)
		for (int x = 0; x < SIDE; x++)
			for (int c = 0; c < 3; c++) {
				/* no pixel of the right half clips */
				const int code = chance_int(&chance, 0, x < SIDE / 2 ? 255 : 254);
				const double v = transfer_curve_decode(&curve, code / 255.0);

				pixels[y][x][2 - c] = (uint8_t)code;
				image.f32[3 * (y * SIDE + x) + c] =
					(float)(v - longer * pixel_white_soft(&white, v / longer));
			}
	{
		float(*plain)[3] = calloc((size_t)dome.count, sizeof(*plain));
		float(*again)[3] = calloc((size_t)dome.count, sizeof(*again));
		float(*want)[3] = calloc((size_t)dome.count, sizeof(*want));
		double share = 0;

		assert_true(plain && again && want);
		assert_int_equal(light_sampler_read(sampler, &picture, plain, NULL), 0);
		light_sampler_exposure(sampler, longer, false);
		assert_int_equal(light_sampler_read(sampler, &picture, again, &clipped), 0);
		assert_memory_equal(plain, again, (size_t)dome.count * sizeof(*plain));
		for (int i = 0; i < dome.count; i++) {
			const float q = light_sampler_clipped(sampler)[i];

			share += (double)q * dome.solid_angle_sr[i] / (2 * M_PI);
			expect_that(q >= 0 && q < 0.2f, "i=%d", i);
			if (dome.direction[i][0] > 0.5)
				expect_equal(q, 0, "i=%d", i);
		}
		assert_true(share > 0 && fabs(share - clipped) < 1e-9);
		memcpy(again, light_sampler_excess(sampler), (size_t)dome.count * sizeof(*again));
		assert_int_equal(light_sampler_read_linear(sampler, &image, want), 0);
		for (int i = 0; i < dome.count; i++)
			for (int c = 0; c < 3; c++)
				expect_below(fabs((double)again[i][c] - (double)want[i][c]), 2e-4,
					     "i=%d, c=%d", i, c);
		/* the same picture, with a shorter exposure to come */
		for (int k = 0; k < 3 * SIDE * SIDE; k++)
			image.f32[k] =
				(float)white.soft[pixels[k / 3 / SIDE][k / 3 % SIDE][2 - k % 3]];
		light_sampler_exposure(sampler, 1, true);
		assert_int_equal(light_sampler_read(sampler, &picture, again, NULL), 0);
		for (int i = 0; i < dome.count; i++)
			expect_that(light_sampler_clipped(sampler)[i] > 0.2f, "i=%d", i);
		assert_int_equal(light_sampler_read_linear(sampler, &image, want), 0);
		for (int i = 0; i < dome.count; i++)
			for (int c = 0; c < 3; c++)
				expect_below(fabs((double)again[i][c] - (double)want[i][c]), 2e-4,
					     "i=%d, c=%d", i, c);
		free(plain);
		free(again);
		free(want);
	}
	image_free(&image);
	light_sampler_destroy(sampler);
	dome_free(&dome);
}

/* Code values are believed up to code 217, and not at all from 248 on; in between soft() grows ever
 * more slowly. */
TEST("soft white is smooth")
{
	struct pixel_white white;
	double before = 1;

	pixel_white_fill(&white, &curve);
	assert_in_range(white.code, 216, 218);
	for (int c = 1; c < 256; c++) {
		const double step = white.light[c] - white.light[c - 1];
		const double slope = (white.soft[c] - white.soft[c - 1]) / step;
		const double middle = (white.light[c] + white.light[c - 1]) / 2;

		if (c < white.code)
			assert_true(white.soft[c] == white.light[c]);
		if (c > 248)
			assert_true(slope == 0);
		if (c >= white.code) {
			expect_at_most(slope, before, "c=%d", c);
			before = slope;
		}
		expect_below(fabs(pixel_white_soft(&white, middle) -
				  (white.soft[c] + white.soft[c - 1]) / 2),
			     1e-12, "c=%d", c);
		expect_below(fabs(pixel_white_soft(&white, white.light[c]) - white.soft[c]), 1e-12,
			     "c=%d", c);
	}
	assert_true(pixel_white_soft(&white, 7) == white.soft[255]);
	assert_true(pixel_white_soft(&white, 0.3) == 0.3);
}

enum { SKY = 160 };

/* A sky with a lamp that fades into it, in units of the longest exposure's white. */
static double sky_light(double even, double peak, int x, int y)
{
	const double far = hypot(x - 0.6 * SKY, y - 0.45 * SKY) / SKY;

	return even + peak * exp(-far * far / 0.02);
}

/* A camera of 8 bits with noise, which compresses light from code 247 on, and delivers none above
 * top. */
static uint8_t camera_code(struct chance *chance, double light, double top)
{
	double code = 255 * transfer_encode(TRANSFER_SRGB, fmin(light, 1.2));

	if (code > 247)
		code = 247 + 8 * tanh((code - 247) / 8);
	return (uint8_t)fmin(fmax(rint(code + PIXEL_NOISE_CODES * chance_normal(chance)), 0), top);
}

/* Mean of all lights by solid angle, of green. */
static double mean_light(const struct dome *dome, float (*radiance)[3])
{
	double sum = 0;

	for (int i = 0; i < dome->count; i++)
		sum += dome->solid_angle_sr[i] * (double)radiance[i][1];
	return sum / (2 * M_PI);
}

/* Three exposures of a camera that compresses near white, with noise: the merged irradiance. */
TEST("light near white is not lost")
{
	static const struct {
		double even, peak; /* the sky's light and the lamp's */
	} skies[] = {{0.3, 0.5}, {0.3, 0.8}, {0.3, 3}, {0.3, 40}, {0.8, 3}, {0.95, 3}, {1.1, 3}};
	const struct light_sampler_settings settings = {.curve = curve, .gain = 1};
	const struct fisheye_settings lens_settings = {.field_deg = 90};
	static uint8_t pixels[SKY][SKY][4];
	const struct view view = {.width = SKY, .height = SKY, .squash = 1};
	const struct picture picture = view_picture(&view, &pixels[0][0][0], sizeof(pixels[0]));
	static float sampled[200][3], truth[200][3], left[200], counts[200];
	struct chance chance = chance_begin("near white");
	struct light_exposures *e;
	struct light_sampler *sampler;
	struct fisheye lens;
	struct dome dome;
	struct image image;

	assert_int_equal(dome_create(&dome, 4, NULL), 0);
	assert_in_range(dome.count, 1, 200);
	assert_int_equal(fisheye_prepare(&lens, &lens_settings, SKY, SKY, NULL), 0);
	assert_int_equal(light_sampler_create(&sampler, &dome, &lens, SKY, SKY, &settings, NULL),
			 0);
	assert_int_equal(image_create_f32(&image, SKY, SKY), 0);
	assert_int_equal(light_exposures_create(&e, dome.count), 0);
	for (int i = 0; i < dome.count; i++)
		counts[i] = (float)(0.785 * SKY * SKY / dome.count);
	for (size_t n = 0; n < 2 * sizeof(skies) / sizeof(*skies); n++) {
		const size_t p = n / 2;
		double off;

		light_exposures_measured(e, ratio, COUNT, &curve, 1, counts);
		for (int k = 0; k < COUNT; k++) {
			for (int y = 0; y < SKY; y++)
				for (int x = 0; x < SKY; x++)
					for (int c = 0; c < 3; c++) {
						const double light = sky_light(skies[p].even,
									       skies[p].peak, x, y);

						image.f32[3 * (y * SKY + x) + c] = (float)light;
						pixels[y][x][2 - c] =
							camera_code(&chance, light * ratio[k],
								    n % 2 ? 250 : 255);
					}
			light_sampler_exposure(sampler, light_exposures_longer(e, k),
					       light_exposures_shorter(e, k));
			assert_int_equal(light_sampler_read(sampler, &picture, sampled, NULL), 0);
			light_exposures_take(e, k, (const float(*)[3])sampled,
					     light_sampler_excess(sampler),
					     light_sampler_clipped(sampler), sampled, left);
		}
		light_sampler_exposure(sampler, 1, false);
		assert_int_equal(light_sampler_read_linear(sampler, &image, truth), 0);
		off = mean_light(&dome, sampled) / mean_light(&dome, truth) - 1;
		print_message("sky of %g, lamp of %g, codes to %d: irradiance off by %.2f %%\n",
			      skies[p].even, skies[p].peak, n % 2 ? 250 : 255, 100 * off);
		expect_below(fabs(off), 0.005, "n=%zu", n);
	}
	image_free(&image);
	light_exposures_destroy(e);
	light_sampler_destroy(sampler);
	dome_free(&dome);
}
