/* SPDX-License-Identifier: MIT */
/* Rows of lamps that flicker are found in pictures with known ones, and nothing else is taken for
 * them. */
#include <math.h>
#include <string.h>

#include "hal/look/flicker.h"
#include "tests/support/chance.h"
#include "tests/support/expect.h"
#include "tests/support/test.h"

enum { WIDTH = 160, HEIGHT = 96, SHADES = 4096, NOISES = 8191 };

/* A place in light that changes, before which somebody may walk. */
struct filmed_rows {
	double depth, hz, fps; /* of the flicker, twice the mains' frequency; frames a second */
	double readout_s;
	double walker; /* share of the width that somebody hides, walking; 0: nobody */
	double lamp;   /* share by which a lamp that moves changes the light of the rows */
	struct chance chance;
	struct flicker *flicker;
	float albedo[HEIGHT][WIDTH];
	float shade[SHADES + 1], noise[NOISES]; /* codes by linear light; read in turn */
	uint8_t bgrx[HEIGHT][WIDTH][4];
	float expected[3];
};

static void rows_open(struct filmed_rows *r, const struct transfer_curve *curve)
{
	r->chance = chance_begin("flicker");
	assert_int_equal(flicker_create(&r->flicker, WIDTH, HEIGHT, curve), 0);
	for (int i = 0; i < WIDTH * HEIGHT; i++)
		r->albedo[i / WIDTH][i % WIDTH] = (float)chance_real(&r->chance, 0.1, 0.5);
	for (int i = 0; i <= SHADES; i++)
		r->shade[i] = (float)(255 * transfer_encode(TRANSFER_SRGB, (double)i / SHADES));
	for (int i = 0; i < NOISES; i++)
		r->noise[i] = (float)(1.5 * chance_normal(&r->chance));
}

static double true_row(const struct filmed_rows *r, int frame, int y)
{
	return 1 + r->depth * cos(2 * M_PI * r->hz * (frame / r->fps + r->readout_s * y / HEIGHT));
}

/* Films a frame; light[3]: that of the whole place, of which the flicker is told. */
static void rows_film(struct filmed_rows *r, int frame, const double light[3])
{
	const float place = (float)(fmod(frame * 0.02, 1.5) - 0.3) * WIDTH;
	const float beyond = place + (float)r->walker * WIDTH;
	int noise = chance_int(&r->chance, 0, NOISES - 1);

	for (int y = 0; y < HEIGHT; y++) {
		const double near = 1 + r->lamp * sin(frame * 0.02) * y / HEIGHT;
		const double row = near * true_row(r, frame, y) * SHADES;

		for (int x = 0; x < WIDTH; x++) {
			const bool hidden = (float)x > place && (float)x < beyond;
			const float albedo = hidden ? 0.05f : r->albedo[y][x];

			for (int c = 0; c < 3; c++) {
				const float b = fminf(albedo * (float)(row * light[c]), SHADES);
				const float code = r->shade[(int)b] + r->noise[noise];

				noise = (noise + 1) % NOISES;
				r->bgrx[y][x][2 - c] = (uint8_t)lrintf(fminf(fmaxf(code, 0), 255));
			}
		}
	}
	for (int c = 0; c < 3; c++)
		r->expected[c] = (float)light[c];
	flicker_look(r->flicker,
		     &(struct picture){.origin = r->bgrx[0][0],
				       .x_step = 4,
				       .y_step = (ptrdiff_t)WIDTH * 4,
				       .width = WIDTH,
				       .height = HEIGHT},
		     r->expected);
}

/* RMS of what rows are off. */
static double rows_off(const struct filmed_rows *r, int frame)
{
	const int32_t(*rows)[3] = flicker_rows(r->flicker);
	double square = 0;

	for (int y = 0; y < HEIGHT; y++)
		for (int c = 0; c < 3; c++) {
			const double d = (rows ? rows[y][c] / (double)FLICKER_ONE : 1) -
					 true_row(r, frame, y);

			square += d * d;
		}
	return sqrt(square / (3 * HEIGHT));
}

static const struct transfer_curve srgb = {.named = TRANSFER_SRGB};

/* At the rates of cameras and mains, while light changes slowly and in a step, and somebody walks
 * by: what is left of the flicker is a quarter at most, and a fiftieth of the light. */
TEST("rows are followed")
{
	static const struct {
		double depth, hz, fps, readout_s, walker;
	} cases[] = {
		{0.2, 100, 30, 0.016, 0},    {0.2, 100, 30, 0.016, 0.3}, {0.06, 100, 30, 0.03, 0.2},
		{0.3, 100, 24, 0.01, 0.2},   {0.2, 120, 25, 0.016, 0.2}, {0.2, 120, 50, 0.02, 0.2},
		{0.2, 100, 15, 0.016, 0.25},
	};

	for (size_t k = 0; k < sizeof(cases) / sizeof(*cases); k++) {
		struct filmed_rows r = {.depth = cases[k].depth,
					.hz = cases[k].hz,
					.fps = cases[k].fps,
					.readout_s = cases[k].readout_s,
					.walker = cases[k].walker,
					.lamp = 0.1};
		double square = 0;

		rows_open(&r, &srgb);
		for (int n = 0; n < 150; n++) {
			const double l = (1 + 0.3 * sin(n * 0.03)) * (n < 80 ? 0.7 : 1.2);
			const double light[3] = {l, l, 0.9 * l};

			rows_film(&r, n, light);
			if (n >= 50)
				square += rows_off(&r, n) * rows_off(&r, n);
		}
		assert_non_null(flicker_rows(r.flicker));
		expect_below(sqrt(square / 100), fmax(0.25 * r.depth / M_SQRT2, 0.025), "case %zu",
			     k);
		flicker_destroy(r.flicker);
	}
}

/* Neither noise, nor people, nor lamps that move or are switched, nor exposure that is not
 * expected. */
TEST("nothing else is flicker")
{
	static const struct {
		double walker, lamp, step;
	} cases[] = {{0, 0, 1}, {0.35, 0, 1}, {0.2, 0.8, 1}, {0.2, 0.1, 2}};

	for (size_t k = 0; k < sizeof(cases) / sizeof(*cases); k++) {
		struct filmed_rows r = {
			.fps = 30, .walker = cases[k].walker, .lamp = cases[k].lamp};

		rows_open(&r, &srgb);
		for (int n = 0; n < 240; n++) {
			const double l = n / 40 % 2 ? 0.6 * cases[k].step : 0.6;
			const double light[3] = {l, l, l};

			rows_film(&r, n, light);
			expect_that(!flicker_rows(r.flicker), "case %zu, frame %d", k, n);
		}
		flicker_destroy(r.flicker);
	}
}

/* A pattern that stands still cannot be told from the place; when flicker ends, so do the rows. */
TEST("what stands still is the place")
{
	static const double light[3] = {0.8, 0.8, 0.8};
	struct filmed_rows r = {.depth = 0.2, .hz = 100, .fps = 25, .readout_s = 0.016};

	rows_open(&r, &srgb);
	for (int n = 0; n < 100; n++) {
		rows_film(&r, n, light);
		expect_that(!flicker_rows(r.flicker), "frame %d", n);
	}
	r.fps = 30;
	for (int n = 100; n < 200; n++)
		rows_film(&r, n, light);
	assert_non_null(flicker_rows(r.flicker));
	r.depth = 0;
	for (int n = 200; n < 330; n++) {
		rows_film(&r, n, light);
		if (n >= 220)
			expect_below(rows_off(&r, n), 0.02, "frame %d", n);
	}
	assert_null(flicker_rows(r.flicker));
	flicker_destroy(r.flicker);
}

/* A camera whose black is above the darkest code that counts; and a picture lower than its
 * bands. */
TEST("odd pictures")
{
	static const struct transfer_curve raised = {.named = TRANSFER_SRGB, .black = 60};
	static const double light[3] = {0.1, 0.1, 0.1};
	static const float one[3] = {1, 1, 1};
	static uint8_t few[4 * 3 * 5];
	struct filmed_rows r = {.depth = 0.3, .hz = 100, .fps = 30, .readout_s = 0.016};
	struct flicker *low;

	rows_open(&r, &raised);
	for (int n = 0; n < 100; n++)
		rows_film(&r, n, light);
	expect_below(rows_off(&r, 99), 1, "many points are black");
	flicker_destroy(r.flicker);
	assert_int_equal(flicker_create(&low, 5, 3, &srgb), 0);
	for (int n = 0; n < 60; n++) {
		memset(few, n % 3 ? 90 : 160, sizeof(few));
		flicker_look(low, &(struct picture){few, 4, 20, 5, 3}, one);
	}
	flicker_destroy(low);
	flicker_destroy(NULL);
}
