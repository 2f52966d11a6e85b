/* SPDX-License-Identifier: MIT */
/* Cells are larger in larger pictures; who is seen has the same outline, in pixels. */
#include <stdlib.h>
#include <string.h>

#include "hal/people/people_parts.h"
#include "tests/support/expect.h"
#include "tests/support/test.h"

#define LEARNING 6 /* frames, half a second apart: a place is known after two seconds */

/* Pixels of the picture's middle half are cloth, from a column and a row that no cell begins at. */
static bool is_cloth(const struct picture *picture, int x, int y)
{
	return x > picture->width / 4 + 4 && x < picture->width * 3 / 4 &&
	       y > picture->height / 4 + 2 && y < picture->height * 3 / 4;
}

/* A grey floor, and red cloth on it. */
static void draw(const struct picture *picture, uint8_t *pixels, bool cloth)
{
	static const uint8_t colours[2][3] = {{120, 125, 130}, {40, 50, 180}};
	const ptrdiff_t begin = picture->origin - pixels;

	for (int y = 0; y < picture->height; y++)
		for (int x = 0; x < picture->width; x++)
			memcpy(pixels + begin + y * picture->y_step + x * picture->x_step,
			       colours[cloth && is_cloth(picture, x, y)], 3);
}

static int count_wrong(const struct people *p, const struct picture *picture)
{
	const struct veil *veil = people_veil(p);
	int wrong = 0;

	assert_non_null(veil);
	for (int y = 0; y < picture->height; y++)
		for (int x = 0; x < picture->width; x++) {
			const int tile = y / BASIS_TILE * p->tiles_across + x / BASIS_TILE;
			const bool seen =
				veil->tile[tile] &&
				veil->anybody[(size_t)y * (size_t)picture->width + (size_t)x] > 127;

			wrong += seen != is_cloth(picture, x, y);
		}
	return wrong;
}

/* mirrored: the picture's rows are read from their ends. */
static void outlines(int width, int height, int side, bool mirrored)
{
	const size_t pixels = (size_t)width * (size_t)height;
	struct dome dome;
	struct people_settings settings = {
		.width = width, .height = height, .curve = {.named = TRANSFER_SRGB}, .dome = &dome};
	uint8_t *bgrx = calloc(pixels, 4), *touched = calloc(pixels, 1);
	uint16_t *coverage = calloc(pixels, sizeof(*coverage));
	const struct people_object object = {.coverage = coverage, .touched = touched};
	const struct picture picture = {.origin = mirrored ? bgrx + 4 * (width - 1) : bgrx,
					.x_step = mirrored ? -4 : 4,
					.y_step = (ptrdiff_t)width * 4,
					.width = width,
					.height = height};
	float light[64][3];
	struct people *p;

	assert_true(bgrx && touched && coverage);
	memset(touched, 1, pixels);
	for (int n = 0; n < 64 * 3; n++)
		light[n / 3][n % 3] = 1;
	assert_int_equal(dome_create(&dome, 1, NULL), 0);
	assert_true(dome.count <= 64);
	assert_int_equal(people_create(&p, &settings, NULL), 0);
	expect_equal(p->cells.side, side, "side of a cell in %dx%d", width, height);
	people_place(p, &object);
	for (int n = 0; n <= LEARNING; n++) {
		draw(&picture, bgrx, n == LEARNING);
		people_look(p, &picture, (const float(*)[3])light, (n + 1) * INT64_C(500000000));
	}
	/* Corners are rounded, by a cell at most. */
	expect_at_most(count_wrong(p, &picture), 4 * side * side, "wrong pixels, %dx%d", width,
		       height);
	people_destroy(p);
	dome_free(&dome);
	free(bgrx);
	free(touched);
	free(coverage);
}

TEST("outlines are as sharp in large pictures")
{
	outlines(320, 240, 2, false);
	outlines(648, 484, 4, true);
	outlines(1920, 1080, 8, false);
	outlines(1924, 1076, 8, true);
	outlines(3840, 2160, 16, false);
}
