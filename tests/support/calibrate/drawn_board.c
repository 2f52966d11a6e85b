/* SPDX-License-Identifier: MIT */
#include "tests/support/calibrate/drawn_board.h"

#include <math.h>
#include <stdlib.h>

#include "hal/colour/transfer.h"
#include "tests/support/chance.h"

/* Linear light at a point of the picture, in px. */
static double drawn_board_light(const struct drawn_board *drawn, const double px[2])
{
	const struct board *b = drawn->board;
	const double *r = b->rotation, wall = 0.2;
	double origin[3], dir[3], at[3], far[3], mm[2];
	double columns, rows;

	if (tsai_ray(drawn->camera, px, origin, dir))
		return wall;
	/* Camera centre and ray in the board's axes. */
	for (int i = 0; i < 3; i++) {
		at[i] = far[i] = 0;
		for (int j = 0; j < 3; j++) {
			at[i] += r[3 * j + i] * (origin[j] - b->position[j]) / b->unit;
			far[i] += r[3 * j + i] * dir[j];
		}
	}
	if (fabs(far[2]) < 1e-12 || -at[2] / far[2] <= 0 || at[2] >= 0)
		return wall;
	for (int i = 0; i < 2; i++)
		mm[i] = at[i] - at[2] / far[2] * far[i];
	if (board_ink(b, mm[0], mm[1]))
		return drawn->paper > 0 ? drawn->ink : 0.03;
	columns = b->columns;
	rows = b->rows + 1;
	if (mm[0] < -2 * b->step_mm || mm[1] < -2 * b->step_mm ||
	    mm[0] > (columns + 1) * b->step_mm || mm[1] > rows * b->step_mm)
		return wall;
	return drawn->paper > 0 ? drawn->paper : 0.8;
}

static double drawn_board_pixel(const struct drawn_board *drawn, int x, int y)
{
	enum { SIDE = 16 };
	static const double first[5][2] = {
		{0.5, 0.5}, {0.02, 0.02}, {0.98, 0.02}, {0.02, 0.98}, {0.98, 0.98}};
	double light = 0, sum = 0;
	bool even = true;

	for (int i = 0; i < 5; i++) {
		const double px[2] = {x + first[i][0], y + first[i][1]};
		const double one = drawn_board_light(drawn, px);

		even = even && (i == 0 || one == light);
		light = one;
	}
	if (even)
		return light;
	for (int i = 0; i < SIDE; i++)
		for (int j = 0; j < SIDE; j++) {
			/* The grid is sheared, so that an edge along a row crosses its samples one by one. */
			const double px[2] = {x + (i + (j + 0.5) / SIDE) / SIDE,
					      y + (j + (i + 0.5) / SIDE) / SIDE};

			sum += drawn_board_light(drawn, px);
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
	int err = image_create_u8(picture, width, height);

	for (int y = 0; !err && y < height; y++)
		for (int x = 0; x < width; x++)
			light[(ptrdiff_t)y * width + x] = drawn_board_pixel(drawn, x, y);
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
