/* SPDX-License-Identifier: MIT */
/* Kernels of the light sampler: each instruction set against the C ones, colours against double
 * precision over the same pixels, and camera frames against pictures. */
#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "hal/base/processor.h"
#include "hal/lights/sampler_kernels.h"
#include "hal/lights/sampler_shares.h"
#include "tests/support/chance.h"
#include "tests/support/expect.h"
#include "tests/support/test.h"
#include "tests/support/thorough.h"

/* Table number i; NULL: this processor does not support it. */
static const struct sampler_kernels *table(int i)
{
	const struct sampler_kernels *kernels = sampler_kernels_all[i];

	return kernels && (kernels->needs & ~processor_features()) == 0 ? kernels : NULL;
}

/* ---- decoding ---- */

enum { WIDTH_MAX = 200, GUARD = 32, PLANE = WIDTH_MAX + 2 * GUARD };

static struct sampler_decode random_decode(struct chance *chance)
{
	struct sampler_decode decode;

	for (int i = 0; i < 256; i++) {
		decode.value[i] = (int16_t)chance_int(chance, INT16_MIN, INT16_MAX);
		decode.wide[i] = decode.value[i];
	}
	decode.white = (uint8_t)(chance_int(chance, 0, 2) ? 255 : chance_int(chance, 1, 255));
	return decode;
}

/* `clipped` per cent of the pixels have a channel at 255. */
static void check_decode(struct chance *chance, const struct sampler_kernels *kernels, int count,
			 int clipped)
{
	static int16_t want[SAMPLER_PLANES * PLANE], got[SAMPLER_PLANES * PLANE];
	const struct sampler_decode decode = random_decode(chance);
	uint32_t *bgrx = malloc(4 * (size_t)count + 1);
	bool any;

	assert_non_null(bgrx);
	for (int i = 0; i < count; i++) {
		bgrx[i] = 0;
		for (int c = 0; c < 3; c++)
			bgrx[i] |= (uint32_t)chance_int(chance, 0, 254) << 8 * c;
		if (chance_int(chance, 0, 99) < clipped)
			bgrx[i] |= UINT32_C(255) << 8 * chance_int(chance, 0, 2);
		bgrx[i] |= (uint32_t)(chance_bits(chance) & 255) << 24;
	}
	memset(want, 0x5a, sizeof(want));
	memset(got, 0x5a, sizeof(got));
	any = sampler_kernels_c.decode(&decode, bgrx, count, want + GUARD, PLANE);
	assert_int_equal(kernels->decode(&decode, bgrx, count, got + GUARD, PLANE), any);
	for (int k = 0; k < SAMPLER_PLANES * PLANE; k++)
		expect_equal(got[k], want[k], "%s, %d pixels, place %d of plane %d", kernels->name,
			     count, k % PLANE - GUARD, k / PLANE);
	free(bgrx);
}

/* A single clipped pixel, anywhere in rows of any length. */
TEST("a single clipped pixel is seen")
{
	static int16_t planes[SAMPLER_PLANES * PLANE];
	struct chance chance = chance_begin("sampler_kernels");
	struct sampler_decode decode = random_decode(&chance);
	uint32_t bgrx[WIDTH_MAX] = {0};

	decode.white = 255;
	for (int i = 0; sampler_kernels_all[i]; i++) {
		if (!table(i))
			continue;
		for (int count = 1; count <= WIDTH_MAX; count++)
			for (int at = 0; at < count; at++) {
				bgrx[at] = 0xff;
				expect_that(table(i)->decode(&decode, bgrx, count, planes + GUARD,
							     PLANE),
					    "%s, pixel %d of %d", table(i)->name, at, count);
				bgrx[at] = 0;
			}
	}
}

TEST("every table decodes alike")
{
	struct chance chance = chance_begin("sampler_kernels");

	for (int i = 1; sampler_kernels_all[i]; i++) {
		if (!table(i)) {
			print_message("# %s: not on this processor\n",
				      sampler_kernels_all[i]->name);
			continue;
		}
		for (int count = 0; count <= WIDTH_MAX; count++)
			for (int clipped = 0; clipped <= 100; clipped += 50)
				check_decode(&chance, table(i), count, clipped);
	}
}

/* ---- adding ---- */

enum { STRIDE = 4096, SPANS = 40 };

struct sums_case {
	int16_t *planes;
	uint16_t *weight;
	struct sampler_span span[SPANS];
	int spans;
};

/* `extreme`: all inputs at the ends of their ranges, so that anything that can overflow does. */
static struct sums_case make_sums(struct chance *chance, bool extreme)
{
	struct sums_case s = {.spans = chance_int(chance, 1, SPANS)};
	size_t weights = 0;

	for (int k = 0; k < s.spans; k++) {
		const int most = chance_int(chance, 0, 3) ? 5 : SAMPLER_CHUNKS_MAX;
		const int chunks = extreme ? SAMPLER_CHUNKS_MAX : chance_int(chance, 1, most);

		s.span[k].chunks = (uint32_t)chunks;
		s.span[k].offset = (uint32_t)chance_int(chance, 0, STRIDE - chunks * SAMPLER_CHUNK);
		weights += (size_t)chunks * SAMPLER_CHUNK;
	}
	s.planes = malloc(SAMPLER_PLANES * STRIDE * sizeof(*s.planes));
	s.weight = aligned_alloc(64, (weights * sizeof(*s.weight) + 63) / 64 * 64);
	assert_non_null(s.planes);
	assert_non_null(s.weight);
	for (int i = 0; i < SAMPLER_PLANES * STRIDE; i++)
		s.planes[i] = (int16_t)(extreme ? INT16_MIN
						: chance_int(chance, INT16_MIN, INT16_MAX));
	for (size_t i = 0; i < weights; i++)
		s.weight[i] = (uint16_t)(extreme ? 32767 : chance_int(chance, 0, 32767));
	return s;
}

/* From the definition, independently of the C kernels. */
static void true_sums(const struct sums_case *s, int planes, int64_t sum[SAMPLER_PLANES])
{
	for (int c = 0; c < SAMPLER_PLANES; c++) {
		const uint16_t *weight = s->weight;

		sum[c] = 0;
		for (int k = 0; c < planes && k < s->spans; k++)
			for (unsigned i = 0; i < s->span[k].chunks * SAMPLER_CHUNK; i++)
				sum[c] += (int64_t)s->planes[c * STRIDE + (int)s->span[k].offset +
							     (int)i] *
					  *weight++;
	}
}

TEST("every table adds alike")
{
	struct chance chance = chance_begin("sampler_kernels");

	for (int i = 0; sampler_kernels_all[i]; i++)
		for (int n = 0; table(i) && n < 60; n++) {
			struct sums_case s = make_sums(&chance, n == 0);

			for (int planes = 3; planes <= SAMPLER_PLANES; planes++) {
				int64_t want[SAMPLER_PLANES], got[SAMPLER_PLANES];

				true_sums(&s, planes, want);
				table(i)->add(s.planes, planes, STRIDE, s.span, s.spans, s.weight,
					      got);
				for (int p = 0; p < planes; p++)
					expect_that(got[p] == want[p],
						    "table %d, plane %d of %d: %lld, expected %lld",
						    i, p, planes, (long long)got[p],
						    (long long)want[p]);
			}
			free(s.planes);
			free(s.weight);
		}
}

/* ---- colours ---- */

struct sampled_eye {
	struct dome dome;
	struct fisheye lens;
	int width, height;
	struct canvas canvas;
	struct light_sampler *sampler;
	float (*radiance)[3];
};

static const struct fisheye_settings upright = {.field_deg = 90};

static struct sampled_eye eye_of(int f, const struct fisheye_settings *lens, int width, int height)
{
	const struct light_sampler_settings settings = {
		.curve = {.named = TRANSFER_SRGB, .black = 11}, .gain = 1.5};
	struct sampled_eye e = {.width = width, .height = height};

	assert_int_equal(dome_create(&e.dome, f, NULL), 0);
	assert_int_equal(fisheye_prepare(&e.lens, lens, width, height, NULL), 0);
	assert_int_equal(canvas_create(&e.canvas, width, height), 0);
	assert_int_equal(
		light_sampler_create(&e.sampler, &e.dome, &e.lens, width, height, &settings, NULL),
		0);
	e.radiance = calloc((size_t)e.dome.count, sizeof(*e.radiance));
	assert_non_null(e.radiance);
	return e;
}

static void eye_free(struct sampled_eye *e)
{
	light_sampler_destroy(e->sampler);
	dome_free(&e->dome);
	canvas_free(&e->canvas);
	free(e->radiance);
}

static struct picture picture_of(const struct sampled_eye *e)
{
	const struct view whole = {.width = e->width, .height = e->height, .squash = 1};

	return view_picture(&whole, e->canvas.pixels, e->canvas.stride);
}

static uint8_t *pixel_at(const struct sampled_eye *e, int x, int y)
{
	return e->canvas.pixels + (size_t)y * e->canvas.stride + 4 * (size_t)x;
}

/* Kinds of pictures: noise; noise with few bright pixels; the hardest: only pixels of small weight.
 */
enum { NOISE, SPARKS, SMALL_SHARES, SKIES };

static void paint(struct sampled_eye *e, struct chance *chance, int sky,
		  const struct sampler_shares *shares)
{
	for (int y = 0; y < e->height; y++)
		for (int x = 0; x < e->width; x++) {
			const bool lit = sky == NOISE ||
					 (sky == SPARKS && chance_int(chance, 0, 49) == 0);

			for (int c = 0; c < 3; c++)
				pixel_at(e, x,
					 y)[c] = (uint8_t)(lit ? chance_int(chance, 0, 255) : 0);
		}
	for (size_t k = 0; sky == SMALL_SHARES && k < shares->runs; k++) {
		const struct sampler_run *run = &shares->run[k];
		const float *weight = shares->weight + run->first;

		/* the first pixel of a row in a cell, most of which lies in another one */
		if (run->count > 1 && weight[0] < weight[1] / 4)
			memset(pixel_at(e, run->x, run->y), 255, 3);
	}
}

/* The colours in double precision over the same pixels and shares. */
static void true_colours(const struct sampled_eye *e, const struct sampler_shares *shares,
			 double (*colour)[3])
{
	double *whole = calloc((size_t)e->dome.count, sizeof(*whole));

	assert_non_null(whole);
	memset(colour, 0, (size_t)e->dome.count * sizeof(*colour));
	for (size_t k = 0; k < shares->runs; k++) {
		const struct sampler_run *run = &shares->run[k];

		for (int i = 0; i < run->count; i++) {
			const double weight = (double)shares->weight[run->first + (size_t)i];
			const uint8_t *bgr = pixel_at(e, run->x + i, run->y);

			whole[run->light] += weight;
			for (int c = 0; c < 3; c++)
				colour[run->light][c] += weight *
							 transfer_decode(TRANSFER_SRGB,
									 (bgr[2 - c] - 11) / 244.0);
		}
	}
	for (int i = 0; i < e->dome.count; i++)
		for (int c = 0; c < 3; c++)
			colour[i][c] = whole[i] > 0 ? colour[i][c] / whole[i] : 0;
	free(whole);
}

/* Largest error as a share of its bound. */
static double check_colours(struct sampled_eye *e, const struct sampler_shares *shares)
{
	const struct picture picture = picture_of(e);
	double(*want)[3] = calloc((size_t)e->dome.count, sizeof(*want));
	double worst = 0;

	assert_non_null(want);
	true_colours(e, shares, want);
	assert_int_equal(light_sampler_read(e->sampler, &picture, e->radiance, NULL), 0);
	for (int i = 0; i < e->dome.count; i++)
		for (int c = 0; c < 3; c++) {
			const double error = fabs((double)e->radiance[i][c] / 1.5 - want[i][c]);

			worst = fmax(worst, error / (ldexp(want[i][c], -14) + ldexp(1, -16)));
		}
	free(want);
	return worst;
}

TEST("colours are within the bound")
{
	static const struct {
		int f, width, height;
	} cases[] = {{4, 480, 480}, {9, 200, 150}, {18, 320, 240}, {36, 320, 320}, {24, 33, 65}};
	struct chance chance = chance_begin("sampler_kernels");

	for (unsigned k = 0; k < sizeof(cases) / sizeof(*cases); k++) {
		struct sampled_eye e = eye_of(cases[k].f, &upright, cases[k].width,
					      cases[k].height);
		struct sampler_shares shares;
		double worst = 0;

		assert_int_equal(
			sampler_shares_create(&shares, &e.dome, &e.lens, e.width, e.height, NULL),
			0);
		for (int sky = 0; sky < SKIES; sky++) {
			paint(&e, &chance, sky, &shares);
			worst = fmax(worst, check_colours(&e, &shares));
		}
		print_message("# f=%d, %dx%d: errors take up to %.2f of the bound\n", cases[k].f,
			      e.width, e.height, worst);
		expect_at_most(worst, 1, "f=%d, %dx%d", cases[k].f, e.width, e.height);
		sampler_shares_free(&shares);
		eye_free(&e);
	}
}

/* Away from the rim the weights of a pixel add up to its solid angle, though the lens is asked at
 * some pixels only; and a light that has a whole pixel is that of its corners (inside all
 * sub-pixels), though most corners are not looked up. */
TEST("pixels are shared out whole")
{
	enum { SIDE = 480 };

	for (int model = 0; model < FISHEYE_MODEL_COUNT; model++) {
		const struct fisheye_settings settings = {
			.field_deg = 90,
			.model = model,
			.rotation_deg = {3, -2, 40},
			.polynomial = {0.06, -0.02, 0.004, -0.0003}};
		double *whole = calloc(SIDE * SIDE, sizeof(*whole));
		struct sampler_shares shares;
		struct fisheye lens;
		struct dome dome;

		assert_non_null(whole);
		assert_int_equal(dome_create(&dome, 9, NULL), 0);
		assert_int_equal(fisheye_prepare(&lens, &settings, SIDE, SIDE, NULL), 0);
		assert_int_equal(sampler_shares_create(&shares, &dome, &lens, SIDE, SIDE, NULL), 0);
		for (size_t k = 0; k < shares.runs; k++)
			for (int i = 0; i < shares.run[k].count; i++) {
				const int x = shares.run[k].x + i, y = shares.run[k].y;
				const double px[2] = {x + 0.5, y + 0.5};
				const double share =
					(double)shares.weight[shares.run[k].first + (size_t)i] /
					fisheye_pixel_sr(&lens, px);

				whole[y * SIDE + x] += share;
				for (int c = 0; c < 4 && share > 0.999; c++) {
					const double corner[2] = {x + 0.15 + 0.7 * (c & 1),
								  y + 0.15 + 0.7 * (c >> 1)};
					double dir[3];

					if (fisheye_ray(&lens, corner, dir) && dir[2] > 0)
						expect_equal(dome_cell_of(&dome, dir),
							     shares.run[k].light,
							     "model %d, pixel %d %d, corner %d",
							     model, x, y, c);
				}
			}
		for (int p = 0; p < SIDE * SIDE; p++)
			if (hypot(p % SIDE - SIDE / 2, p / SIDE - SIDE / 2) < 0.48 * SIDE - 20)
				expect_below(fabs(whole[p] - 1), 2e-6, "model %d, pixel %d %d",
					     model, p % SIDE, p / SIDE);
		sampler_shares_free(&shares);
		dome_free(&dome);
		free(whole);
	}
}

/* Says what making the table takes: README.md quotes it. */
TEST("tables are made")
{
	static const int sides[] = {480, 1024, 2048};

	for (int k = 0; k < (thorough() ? 3 : 1); k++) {
		const struct light_sampler_settings settings = {
			.placed = true, .curve = {.named = TRANSFER_SRGB}, .gain = 1};
		struct light_sampler *sampler;
		struct fisheye lens;
		struct dome dome;
		clock_t start;

		assert_int_equal(dome_create(&dome, 9, NULL), 0);
		assert_int_equal(fisheye_prepare(&lens, &upright, sides[k], sides[k], NULL), 0);
		start = clock();
		assert_int_equal(light_sampler_create(&sampler, &dome, &lens, sides[k], sides[k],
						      &settings, NULL),
				 0);
		print_message("# table of %d x %d: %.2f s of processor\n", sides[k], sides[k],
			      (double)(clock() - start) / CLOCKS_PER_SEC);
		light_sampler_destroy(sampler);
		dome_free(&dome);
	}
}

/* ---- frames ---- */

static void check_frame(struct sampled_eye *e, const struct frame *frame, const struct view *view,
			struct pool *pool)
{
	const size_t bytes = (size_t)e->dome.count * sizeof(*e->radiance);
	float(*want)[3] = malloc(bytes);
	const struct picture picture = picture_of(e);
	struct frame_reader reader;
	double clipped[2];

	assert_non_null(want);
	assert_int_equal(frame_reader_open(&reader, frame, view, NULL), 0);
	frame_reader_make(&reader, 0, 0, e->width, e->height, e->canvas.pixels, e->canvas.stride);
	assert_int_equal(light_sampler_read(e->sampler, &picture, want, &clipped[0]), 0);
	memset(e->radiance, 0, bytes);
	assert_int_equal(
		light_sampler_read_frame(e->sampler, &reader, pool, e->radiance, &clipped[1]), 0);
	assert_memory_equal(e->radiance, want, bytes);
	assert_true(clipped[0] == clipped[1] && clipped[0] > 0);
	reader.view.width--;
	assert_int_equal(light_sampler_read_frame(e->sampler, &reader, pool, e->radiance, NULL),
			 -EINVAL);
	free(want);
}

/* A camera's frame, mounted in any way, gives the same light as the picture made of it, with any
 * number of threads. */
TEST("frames give what pictures give")
{
	static const enum pixel_format formats[] = {PIXEL_YUYV, PIXEL_NV12, PIXEL_BGR24, PIXEL_BGRX,
						    PIXEL_GREY};
	struct chance chance = chance_begin("sampler_kernels");
	struct sampled_eye e = eye_of(9, &upright, 181, 143);
	uint8_t *memory = malloc(4 * 200 * 150);

	assert_non_null(memory);
	for (size_t i = 0; i < 4 * 200 * 150; i++)
		memory[i] = (uint8_t)chance_int(&chance, 0, 255);
	for (unsigned k = 0; k < 4 * sizeof(formats) / sizeof(*formats); k++) {
		const size_t stride = frame_plane_stride(formats[k / 4], 0, 200);
		const struct frame frame = {
			.format = formats[k / 4],
			.width = 200,
			.height = 150,
			.matrix = MATRIX_BT709,
			.planes = {{memory, stride, stride * 150},
				   {memory + 7, 200, (size_t)200 * 75}},
		};
		const struct view view = {13, 5, 181, 143, k & 1, k & 2, 1};
		struct pool *pool;

		assert_int_equal(pool_create(&pool, 1 + (int)(k % 3)), 0);
		check_frame(&e, &frame, &view, k % 3 ? pool : NULL);
		pool_destroy(pool);
	}
	free(memory);
	eye_free(&e);
}

/* A wide picture under few lights: a light's rows are longer than the longest span. */
TEST("long rows")
{
	struct chance chance = chance_begin("sampler_kernels");
	const struct fisheye_settings wide = {.focal_px = {1600, 5}, .field_deg = 90};
	struct sampled_eye e = eye_of(1, &wide, 5040, 17);
	struct sampler_shares shares;

	assert_int_equal(sampler_shares_create(&shares, &e.dome, &e.lens, e.width, e.height, NULL),
			 0);
	paint(&e, &chance, NOISE, &shares);
	assert_true(check_colours(&e, &shares) <= 1);
	sampler_shares_free(&shares);
	eye_free(&e);
}
