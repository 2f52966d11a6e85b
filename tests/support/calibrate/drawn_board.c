/* SPDX-License-Identifier: MIT */
#include "tests/support/calibrate/drawn_board.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>

#include "hal/colour/transfer.h"
#include "tests/support/chance.h"

#define WALL 0.2 /* linear light */

/* A point of the board's plane, in mm. */
struct board_place {
	bool seen; /* false: the ray misses the plane's front */
	double mm[2];
};

/* What a point of the picture, in px, shows. */
static struct board_place drawn_board_place(const struct drawn_board *drawn, double x, double y)
{
	const struct board *b = drawn->board;
	const double *r = b->rotation, px[2] = {x, y};
	struct board_place place = {.seen = false};
	double origin[3], dir[3], at[3], far[3];

	if (tsai_ray(drawn->camera, px, origin, dir))
		return place;
	/* Camera centre and ray in the board's axes. */
	for (int i = 0; i < 3; i++) {
		at[i] = far[i] = 0;
		for (int j = 0; j < 3; j++) {
			at[i] += r[3 * j + i] * (origin[j] - b->position[j]) / b->unit;
			far[i] += r[3 * j + i] * dir[j];
		}
	}
	place.seen = fabs(far[2]) >= 1e-12 && -at[2] / far[2] > 0 && at[2] < 0;
	for (int i = 0; place.seen && i < 2; i++)
		place.mm[i] = at[i] - at[2] / far[2] * far[i];
	return place;
}

/* Linear light of a place. */
static double drawn_board_light(const struct drawn_board *drawn, const struct board_place *place)
{
	const struct board *b = drawn->board;
	const double *mm = place->mm, rows = b->rows + 1;
	const double columns = b->columns;

	if (!place->seen)
		return WALL;
	if (board_ink(b, mm[0], mm[1]))
		return drawn->paper > 0 ? drawn->ink : 0.03;
	if (mm[0] < -2 * b->step_mm || mm[1] < -2 * b->step_mm ||
	    mm[0] > (columns + 1) * b->step_mm || mm[1] > rows * b->step_mm)
		return WALL;
	return drawn->paper > 0 ? drawn->paper : 0.8;
}

/* Mean light of a pixel from the places of its corners, two upper and two lower. Places between
 * them are interpolated, which in a pixel is off by less than the samples are apart. */
static double drawn_board_pixel(const struct drawn_board *drawn, const struct board_place *upper,
				const struct board_place *lower)
{
	enum { SIDE = 8 };
	const double first = drawn_board_light(drawn, upper);
	struct board_place place = {.seen = upper[0].seen && upper[1].seen && lower[0].seen &&
					    lower[1].seen};
	double sum = 0;

	if (!place.seen || (drawn_board_light(drawn, upper + 1) == first &&
			    drawn_board_light(drawn, lower) == first &&
			    drawn_board_light(drawn, lower + 1) == first))
		return first;
	for (int i = 0; i < SIDE; i++)
		for (int j = 0; j < SIDE; j++) {
			/* The grid is sheared, so that an edge along a row crosses its samples one
			 * by one. */
			const double s = (i + (j + 0.5) / SIDE) / SIDE;
			const double t = (j + (i + 0.5) / SIDE) / SIDE;

			for (int k = 0; k < 2; k++)
				place.mm[k] =
					(1 - t) * ((1 - s) * upper[0].mm[k] + s * upper[1].mm[k]) +
					t * ((1 - s) * lower[0].mm[k] + s * lower[1].mm[k]);
			sum += drawn_board_light(drawn, &place);
		}
	return sum / (SIDE * SIDE);
}

/* Blurs light[height][width]: first the rows, then the columns. */
static void drawn_board_blur(double *light, int width, int height, double sigma)
{
	const int reach = (int)ceil(4 * sigma);
	double *line = malloc(sizeof(*line) * (size_t)(width > height ? width : height));
	double *weight = malloc(sizeof(*weight) * (size_t)(reach + 1));

	for (int k = 0; k <= reach; k++)
		weight[k] = exp(-0.5 * k * k / (sigma * sigma));
	for (int pass = 0; pass < 2; pass++) {
		const int lines = pass ? width : height, length = pass ? height : width;
		const int step = pass ? width : 1, next = pass ? 1 : width;

		for (int l = 0; l < lines; l++) {
			double *at = light + (ptrdiff_t)l * next;

			for (int i = 0; i < length; i++) {
				double sum = 0, weights = 0;

				for (int k = -reach; k <= reach; k++) {
					const double w = weight[abs(k)];

					if (i + k < 0 || i + k >= length)
						continue;
					sum += w * at[(ptrdiff_t)(i + k) * step];
					weights += w;
				}
				line[i] = sum / weights;
			}
			for (int i = 0; i < length; i++)
				at[(ptrdiff_t)i * step] = line[i];
		}
	}
	free(weight);
	free(line);
}

int drawn_board_draw(const struct drawn_board *drawn, struct image *picture)
{
	const int width = drawn->camera->width, height = drawn->camera->height;
	double *light = malloc(sizeof(*light) * (size_t)width * (size_t)height);
	struct chance chance = {drawn->seed};
	struct board_place *corner = calloc(2 * ((size_t)width + 1), sizeof(*corner));
	int err = image_create_u8(picture, width, height);

	for (int y = 0; !err && y <= height; y++) {
		struct board_place *lower = corner + y % 2 * (width + 1);
		const struct board_place *upper = corner + (y + 1) % 2 * (width + 1);

		for (int x = 0; x <= width; x++)
			lower[x] = drawn_board_place(drawn, x, y);
		for (int x = 0; y > 0 && x < width; x++)
			light[(ptrdiff_t)(y - 1) * width + x] = drawn_board_pixel(drawn, upper + x,
										  lower + x);
	}
	free(corner);
	if (!err && drawn->blur_px > 0)
		drawn_board_blur(light, width, height, drawn->blur_px);
	for (ptrdiff_t i = 0; !err && i < (ptrdiff_t)width * height; i++) {
		double code = 255 * transfer_encode(TRANSFER_SRGB, light[i]);

		if (drawn->noise > 0)
			code += drawn->noise * chance_normal(&chance);
		for (int c = 0; c < 3; c++)
			picture->u8[3 * i + c] = (uint8_t)lround(fmin(fmax(code, 0), 255));
	}
	free(light);
	return err;
}
