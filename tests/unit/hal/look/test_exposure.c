/* SPDX-License-Identifier: MIT */
/* A camera's exposure is followed, and light is not taken for it, in a room whose lamps light the
 * picture not quite as they light the fisheye. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "hal/look/exposure.h"
#include "hal/optics/vec.h"
#include "tests/support/chance.h"
#include "tests/support/expect.h"
#include "tests/support/test.h"

enum { WIDTH = 80, HEIGHT = 60, FREQUENCY = 3 };

struct filmed_room {
	struct dome dome;
	struct exposure *exposure;
	struct chance chance;
	float (*radiance)[3];
	float albedo[HEIGHT][WIDTH];
	uint8_t bgrx[HEIGHT][WIDTH][4];
};

static void room_open(struct filmed_room *r)
{
	const struct transfer_curve srgb = {.named = TRANSFER_SRGB};
	struct fault fault;

	memset(r, 0, sizeof(*r));
	r->chance.state = 3;
	assert_int_equal(dome_create(&r->dome, FREQUENCY, &fault), 0);
	assert_int_equal(exposure_create(&r->exposure, WIDTH, HEIGHT, &srgb, &r->dome), 0);
	r->radiance = calloc((size_t)r->dome.count, sizeof(*r->radiance));
	for (int i = 0; i < WIDTH * HEIGHT; i++)
		r->albedo[i / WIDTH][i % WIDTH] = (float)chance_real(&r->chance, 0.1, 0.5);
}

static void room_close(struct filmed_room *r)
{
	exposure_destroy(r->exposure);
	dome_free(&r->dome);
	free(r->radiance);
}

/* A lamp that goes round over an even sky. Irradiance of the picture is up to `near` more or less
 * than the fisheye's, by the lamp's direction; somebody hides `hidden` of the picture's columns. */
static void room_film(struct filmed_room *r, double turn, double lamp, double near, int hidden,
		      const double gain[3], double found[3])
{
	const double to[3] = {0.7 * cos(turn), 0.7 * sin(turn), 0.714};
	double here = 0;

	for (int i = 0; i < r->dome.count; i++) {
		const double *d = r->dome.direction[i];
		const double l = 0.12 + lamp * exp(-8 * (1 - vec_dot(d, to)));
		const double e = l * d[2] * r->dome.solid_angle_sr[i] / M_PI;

		for (int c = 0; c < 3; c++)
			r->radiance[i][c] = (float)l;
		here += e * (1 + near * d[0] - near * d[1] / 2);
	}
	for (int y = 0; y < HEIGHT; y++)
		for (int x = 0; x < WIDTH; x++)
			for (int c = 0; c < 3; c++) {
				const double b = (x < hidden ? 0.05 : (double)r->albedo[y][x]) *
						 here * gain[c] * 2;
				const double code = 255 * transfer_encode(TRANSFER_SRGB,
									  fmin(b, 1)) +
						    1.5 * chance_normal(&r->chance);

				r->bgrx[y][x][2 - c] = (uint8_t)lrint(fmin(fmax(code, 0), 255));
			}
	exposure_look(r->exposure,
		      &(struct picture){.origin = r->bgrx[0][0],
					.x_step = 4,
					.y_step = (ptrdiff_t)WIDTH * 4,
					.width = WIDTH,
					.height = HEIGHT},
		      (const float(*)[3])r->radiance);
	exposure_gain(r->exposure, found);
}

static void expect_gain(const double found[3], const double gain[3], double within, int frame)
{
	for (int c = 0; c < 3; c++)
		expect_that(fabs(found[c] / gain[c] - 1) < within, "frame %d channel %d: %g of %g",
			    frame, c, found[c], gain[c]);
}

/* Ten minutes' worth of turns at a constant exposure: lamps are not taken for it, nor does it
 * drift. */
TEST("light is not exposure")
{
	static const double one[3] = {1, 1, 1};
	struct filmed_room r;
	double found[3];

	room_open(&r);
	for (int n = 0; n < 1500; n++) {
		room_film(&r, n * 0.05, 0.8 + 0.4 * sin(n * 0.013), 0.1, 0, one, found);
		expect_gain(found, one, 0.02, n);
	}
	room_close(&r);
}

/* Steps are followed within two frames, while a lamp moves and somebody hides a quarter. */
TEST("steps are followed")
{
	static const double steps[][3] = {{1, 1, 1},	   {1.16, 1.16, 1.16}, {1.1, 1, 0.92},
					  {0.7, 0.7, 0.7}, {1.3, 1.1, 1.5},    {1, 1, 1}};
	struct filmed_room r;
	double found[3];

	room_open(&r);
	for (int n = 0; n < 400; n++)
		room_film(&r, n * 0.05, 0.8, 0.1, 0, steps[0], found);
	for (size_t k = 1; k < sizeof(steps) / sizeof(*steps); k++)
		for (int n = 0; n < 60; n++) {
			room_film(&r, n * 0.05, 0.8, 0.1, n < 30 ? WIDTH / 4 : 0, steps[k], found);
			if (n >= 2)
				expect_gain(found, steps[k], 0.03, n);
		}
	room_close(&r);
}

/* A slow change is followed, too. */
TEST("drift is followed")
{
	struct filmed_room r;
	double found[3];

	room_open(&r);
	for (int n = 0; n < 900; n++) {
		const double g = n < 300 ? 1 : 1 + 0.3 * (n - 300) / 600.0;
		const double gain[3] = {g, g, 2 - g};

		room_film(&r, n * 0.05, 0.8, 0.1, 0, gain, found);
		expect_gain(found, gain, 0.03, n);
	}
	room_close(&r);
}

/* Points at the camera's black level tell nothing. */
TEST("black is not seen")
{
	static const double one[3] = {1, 1, 1}, step[3] = {1.2, 1.2, 1.2};
	const struct transfer_curve raised = {.named = TRANSFER_SRGB, .black = 90};
	struct filmed_room r;
	double found[3];

	room_open(&r);
	exposure_destroy(r.exposure);
	assert_int_equal(exposure_create(&r.exposure, WIDTH, HEIGHT, &raised, &r.dome), 0);
	for (int n = 0; n < 60; n++)
		room_film(&r, 0, 0.1, 0, 0, n < 50 ? one : step, found);
	for (int c = 0; c < 3; c++)
		expect_that(found[c] > 1.05 && found[c] < 4, "channel %d: %g", c, found[c]);
	room_close(&r);
}

/* In the dark, and where all is clipped, there is nothing to follow. */
TEST("nothing is followed where nothing is seen")
{
	static const double one[3] = {1, 1, 1}, clipped[3] = {50, 50, 50}, dark[3] = {0, 0, 0};
	struct filmed_room r;
	double found[3];

	room_open(&r);
	for (int n = 0; n < 50; n++)
		room_film(&r, 0, 0.8, 0, 0, one, found);
	for (int n = 0; n < 50; n++)
		room_film(&r, 0, 0.8, 0, 0, n % 2 ? clipped : dark, found);
	expect_gain(found, one, 0.01, 100);
	memset(r.radiance, 0, (size_t)r.dome.count * sizeof(*r.radiance));
	exposure_look(r.exposure,
		      &(struct picture){.origin = r.bgrx[0][0],
					.x_step = 4,
					.y_step = (ptrdiff_t)WIDTH * 4,
					.width = WIDTH,
					.height = HEIGHT},
		      (const float(*)[3])r.radiance);
	exposure_gain(r.exposure, found);
	expect_gain(found, one, 0.01, 101);
	room_close(&r);
}
