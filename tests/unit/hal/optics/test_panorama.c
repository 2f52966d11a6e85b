/* SPDX-License-Identifier: MIT */
/* The panorama: its orientation, and the solid angle of a row. */
#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "hal/optics/panorama.h"
#include "hal/optics/vec.h"
#include "tests/support/chance.h"
#include "tests/support/expect.h"
#include "tests/support/own_folder.h"
#include "tests/support/test.h"

#define WIDTH 64
#define HEIGHT 32

static float pixels[HEIGHT][WIDTH][3];
static const struct image image = {.width = WIDTH, .height = HEIGHT, .f32 = &pixels[0][0][0]};

static void fill_random(struct chance *chance)
{
	for (int y = 0; y < HEIGHT; y++)
		for (int x = 0; x < WIDTH; x++)
			for (int c = 0; c < 3; c++)
				pixels[y][x][c] = (float)chance_real(chance, 0, 10);
}

static void check_direction(const struct panorama *p, double x, double y, double dx, double dy,
			    double dz)
{
	double dir[3];

	panorama_direction(p, x, y, dir);
	assert_true(fabs(dir[0] - dx) < 1e-15 && fabs(dir[1] - dy) < 1e-15 &&
		    fabs(dir[2] - dz) < 1e-15);
}

TEST("seen from inside")
{
	struct panorama p = {&image, 0, 1};

	check_direction(&p, WIDTH / 2, HEIGHT / 2, 1, 0, 0);
	check_direction(&p, 3 * WIDTH / 4, HEIGHT / 2, 0, -1, 0); /* to the right of +X */
	check_direction(&p, WIDTH / 4, HEIGHT / 2, 0, 1, 0);
	check_direction(&p, 0, HEIGHT / 2, -1, 0, 0);
	check_direction(&p, 17, 0, 0, 0, 1);
	check_direction(&p, 17, HEIGHT, 0, 0, -1);
	/* Counter-clockwise as seen from above: what was at +X is now at +Y. */
	p.turn_rad = M_PI / 2;
	check_direction(&p, WIDTH / 2, HEIGHT / 2, 0, 1, 0);
}

TEST("pixel centres are exact")
{
	struct chance chance = chance_begin("panorama");

	fill_random(&chance);
	for (int n = 0; n < 20; n++) {
		const struct panorama p = {&image, chance_real(&chance, -20, 20), 2.5};

		for (int y = 0; y < HEIGHT; y++)
			for (int x = 0; x < WIDTH; x++) {
				double dir[3], rgb[3];

				panorama_direction(&p, x + 0.5, y + 0.5, dir);
				for (int k = 0; k < 3; k++)
					dir[k] *= 7;
				panorama_radiance(&p, dir, rgb);
				for (int c = 0; c < 3; c++)
					expect_below(fabs(rgb[c] - 2.5 * pixels[y][x][c]), 1e-9,
						     "n=%d, y=%d, x=%d, c=%d", n, y, x, c);
			}
	}
}

TEST("bilinear across the seam")
{
	const struct panorama p = {&image, 0, 1};
	struct chance chance = chance_begin("panorama");

	fill_random(&chance);
	for (int n = 0; n < 5000; n++) {
		const double x = chance_real(&chance, -0.5,
					     0.5); /* between the last column and the first */
		const double y = chance_real(&chance, 0.5, HEIGHT - 0.5001);
		const int row = (int)(y - 0.5);
		const double s = x + 0.5, t = y - 0.5 - row;
		double dir[3], rgb[3];

		panorama_direction(&p, x, y, dir);
		panorama_radiance(&p, dir, rgb);
		for (int c = 0; c < 3; c++) {
			const double above = (1 - s) * pixels[row][WIDTH - 1][c] +
					     s * pixels[row][0][c];
			const double below = (1 - s) * pixels[row + 1][WIDTH - 1][c] +
					     s * pixels[row + 1][0][c];

			expect_below(fabs(rgb[c] - ((1 - t) * above + t * below)), 1e-9,
				     "n=%d, c=%d", n, c);
		}
	}
}

TEST("poles are clamped")
{
	const struct panorama p = {&image, 0, 1};
	double rgb[3];

	for (int y = 0; y < HEIGHT; y++)
		for (int x = 0; x < WIDTH; x++)
			pixels[y][x][0] = pixels[y][x][1] = pixels[y][x][2] = (float)y;
	panorama_radiance(&p, (double[]){0, 0, 1}, rgb);
	assert_true(rgb[0] == 0);
	panorama_radiance(&p, (double[]){0, 0, -1}, rgb);
	assert_true(rgb[1] == HEIGHT - 1);
	panorama_radiance(&p, (double[]){1e-5, 0, 1}, rgb);
	assert_true(rgb[2] == 0);
}

TEST("rows sum to the sphere")
{
	const struct panorama p = {&image, 0, 1};
	double sum = 0, upper = 0;

	for (int y = 0; y < HEIGHT; y++) {
		const double want = 2 * M_PI *
				    (cos(M_PI * y / HEIGHT) - cos(M_PI * (y + 1) / HEIGHT));

		expect_below(fabs(panorama_row_sr(&p, y) - want), 1e-14, "y=%d", y);
		sum += panorama_row_sr(&p, y);
		if (y < HEIGHT / 2)
			upper += panorama_row_sr(&p, y);
	}
	assert_true(fabs(sum - 4 * M_PI) < 1e-12);
	assert_true(fabs(upper - 2 * M_PI) < 1e-12);
}

TEST("no direction is dark")
{
	const struct panorama p = {&image, 0, 1}, spun = {&image, 1e300, 1};
	double rgb[3] = {1, 1, 1};

	panorama_radiance(&p, (double[]){NAN, 0, 1}, rgb);
	assert_true(rgb[0] == 0 && rgb[1] == 0 && rgb[2] == 0);
	panorama_radiance(&spun, (double[]){1, 0, 1}, rgb);
	assert_true(rgb[0] == 0);
}

/* The message names what makes a picture no panorama. */
TEST("read from files")
{
	static const struct {
		int width, height;
		bool linear;
		const char *expected; /* part of the message; NULL: accepted */
	} cases[] = {
		{64, 32, true, NULL},
		{65, 32, true, NULL}, /* a size that somebody scaled by hand */
		{16, 16, true, "16 x 16 pixels, expected twice as wide as high"},
		{64, 32, false, "expected linear light"},
	};

	for (size_t k = 0; k < sizeof(cases) / sizeof(*cases); k++) {
		const char *path = own_folder_path(cases[k].linear ? "p.pfm" : "p.png");
		struct fault fault = {.text = ""};
		struct image picture;
		int err = cases[k].linear
				  ? image_create_f32(&picture, cases[k].width, cases[k].height)
				  : image_create_u8(&picture, cases[k].width, cases[k].height);

		expect_equal(err, 0, "k=%zu", k);
		assert_int_equal(image_write(path, &picture, &fault), 0);
		image_free(&picture);
		err = panorama_read(&picture, path, &fault);
		expect_equal(err, cases[k].expected ? -EINVAL : 0, "k=%zu", k);
		assert_non_null(strstr(fault.text, cases[k].expected ? cases[k].expected : ""));
		image_free(&picture);
		assert_int_equal(unlink(path), 0);
	}
}

TEST_GROUP(own_folder_make, own_folder_remove);
