/* SPDX-License-Identifier: MIT */
#include "tests/support/calibrate/fisheye_photographs.h"

#include <math.h>
#include <stdbool.h>
#include <stdint.h>

#include "hal/colour/transfer.h"
#include "hal/optics/vec.h"

/* A board in the camera's axes: its middle, and its own axes as boards.h defines them. */
struct held_board {
	const struct board *board;
	double middle_mm[3], x[3], y[3], z[3];
};

static struct held_board held_board(const struct board *board, double theta, double phi,
				    struct chance *chance)
{
	const double distance_mm = chance_real(chance, 130, 170);
	struct held_board held = {.board = board,
				  .z = {sin(theta) * cos(phi), sin(theta) * sin(phi), cos(theta)}};

	for (int i = 0; i < 3; i++)
		held.middle_mm[i] = distance_mm * held.z[i];
	for (int i = 0; i < 3; i++)
		held.z[i] += chance_real(chance, -0.35, 0.35);
	vec_normalize(held.z);
	vec_cross((double[]){0, 1, 0}, held.z, held.x);
	vec_normalize(held.x);
	vec_cross(held.z, held.x, held.y);
	return held;
}

static double fisheye_photograph_light(const struct held_board *held, const struct fisheye *lens,
				       const double px[2])
{
	const struct board *b = held->board;
	const double wall = 0.2, step = b->step_mm;
	double ray[3], along, x, y;

	if (!fisheye_ray(lens, px, ray))
		return 0;
	along = vec_dot(ray, held->z);
	if (along <= 1e-3)
		return wall;
	along = vec_dot(held->middle_mm, held->z) / along;
	for (int i = 0; i < 3; i++)
		ray[i] = along * ray[i] - held->middle_mm[i];
	x = vec_dot(ray, held->x) + (b->columns - 1) * step / 2;
	y = vec_dot(ray, held->y) + (b->rows - 1) * step / 2;
	if (board_ink(b, x, y))
		return 0.03;
	return x < -2 * step || y < -2 * step || x > (b->columns + 1) * step ||
			       y > (b->rows + 1) * step
		       ? wall
		       : 0.8;
}

/* Light of a pixel: the mean over it, or its first corner where all four corners are equal. */
static double fisheye_photograph_pixel(const struct held_board *held, const struct fisheye *lens,
				       int x, int y)
{
	enum { SIDE = 8 };
	const double first = fisheye_photograph_light(held, lens, (double[]){x, y});
	bool even = true;
	double sum = 0;

	for (int k = 1; k < 4 && even; k++)
		even = fisheye_photograph_light(held, lens, (double[]){x + k % 2, y + k / 2}) ==
		       first;
	for (int k = 0; k < SIDE * SIDE && !even; k++) {
		const double i = k % SIDE, j = k / SIDE;
		const double px[2] = {x + (i + (j + 0.5) / SIDE) / SIDE,
				      y + (j + (i + 0.5) / SIDE) / SIDE};

		sum += fisheye_photograph_light(held, lens, px);
	}
	return even ? first : sum / (SIDE * SIDE);
}

int fisheye_photograph_board(struct image *image, const struct board *board,
			     const struct fisheye *lens, int k, struct chance *chance)
{
	const struct held_board held = held_board(board, k ? 0.8 : 0.1,
						  2 * M_PI * k / (FISHEYE_PHOTOGRAPHS - 1), chance);
	const int err = image_create_u8(image, FISHEYE_PHOTOGRAPH_WIDTH, FISHEYE_PHOTOGRAPH_HEIGHT);

	for (int p = 0; !err && p < FISHEYE_PHOTOGRAPH_WIDTH * FISHEYE_PHOTOGRAPH_HEIGHT; p++) {
		const double light = fisheye_photograph_pixel(
			&held, lens, p % FISHEYE_PHOTOGRAPH_WIDTH, p / FISHEYE_PHOTOGRAPH_WIDTH);
		const double code = 255 * transfer_encode(TRANSFER_SRGB, light) +
				    chance_normal(chance);

		for (int c = 0; c < 3; c++)
			image->u8[3 * p + c] = (uint8_t)fmin(fmax(rint(code), 0), 255);
	}
	return err;
}
