/* SPDX-License-Identifier: MIT */
/* Where pictures and marks are placed: every pixel of a cell is written, and none outside. */
#include <math.h>
#include <string.h>

#include "app/view/layout.h"
#include "app/view/show.h"
#include "tests/support/chance.h"
#include "tests/support/expect.h"
#include "tests/support/test.h"

#define UNTOUCHED 77

TEST("quarters tile the screen")
{
	static const int sizes[][2] = {{640, 480}, {641, 481}, {1, 1}, {2, 1}, {1280, 801}};

	for (size_t s = 0; s < sizeof(sizes) / sizeof(*sizes); s++) {
		struct display_buffer screen = {.width = sizes[s][0], .height = sizes[s][1]};
		int area = 0;

		for (int q = 0; q < 4; q++) {
			struct layout_box box = layout_quarter(&screen, q);

			area += box.width * box.height;
			expect_equal(box.x, q % 2 ? screen.width / 2 : 0, "s=%zu, q=%d", s, q);
			expect_equal(box.y, q / 2 ? screen.height / 2 : 0, "s=%zu, q=%d", s, q);
			expect_at_most(box.x + box.width, screen.width, "s=%zu, q=%d", s, q);
			expect_at_most(box.y + box.height, screen.height, "s=%zu, q=%d", s, q);
		}
		expect_equal(area, screen.width * screen.height, "s=%zu", s);
	}
}

TEST("boxes keep the shape")
{
	static const struct layout_box cell = {100, 50, 800, 600};
	struct layout_box box = layout_box(&cell, 640, 480, 1, SCALE_NONE);

	assert_int_equal(box.x, 180);
	assert_int_equal(box.y, 110);
	assert_int_equal(box.width, 640);
	assert_int_equal(box.height, 480);
	assert_true(layout_in_place(&cell, &box, 640, 480));
	box = layout_box(&cell, 640, 480, 1, SCALE_FIT);
	assert_int_equal(box.width, 800);
	assert_int_equal(box.height, 600);
	assert_false(layout_in_place(&cell, &box, 640, 480));
	box = layout_box(&cell, 400, 100, 1, SCALE_FIT); /* wide: black above and below */
	assert_int_equal(box.width, 800);
	assert_int_equal(box.height, 200);
	assert_int_equal(box.y, 250);
	/* Lines were doubled, as every other one is missing. */
	box = layout_box(&cell, 360, 243, 2, SCALE_NONE);
	assert_int_equal(box.width, 360);
	assert_int_equal(box.height, 486);
	box = layout_box(&cell, 720, 486, 2, SCALE_NONE); /* too tall: fitted, not cut */
	assert_int_equal(box.height, 600);
	assert_int_equal(box.width, 444);
	/* Larger than the screen: cut on both sides. */
	box = layout_box(&cell, 1000, 700, 1, SCALE_NONE);
	assert_int_equal(box.x, 0);
	assert_int_equal(box.y, 0);
	assert_int_equal(box.width, 1000);
	assert_false(layout_in_place(&cell, &box, 1000, 700));
}

/* A picture whose pixel (x, y) holds x, y, 1, 255. */
static struct canvas coordinates(int width, int height)
{
	struct canvas canvas;

	assert_int_equal(canvas_create(&canvas, width, height), 0);
	for (int y = 0; y < height; y++) {
		for (int x = 0; x < width; x++) {
			uint8_t *p = canvas.pixels + (size_t)y * canvas.stride + 4 * (size_t)x;

			p[0] = (uint8_t)x;
			p[1] = (uint8_t)y;
			p[2] = 1;
			p[3] = 255;
		}
	}
	return canvas;
}

TEST("each pixel of a cell is written")
{
	struct chance chance = chance_begin("each_pixel_of_a_cell_is_written");
	enum { WIDTH = 90, HEIGHT = 70 };
	static uint8_t pixels[HEIGHT][WIDTH][4];
	const struct display_buffer screen = {&pixels[0][0][0], sizeof(pixels[0]), WIDTH, HEIGHT,
					      0};

	for (int run = 0; run < 300; run++) {
		struct layout_box cell = {chance_int(&chance, 0, 40), chance_int(&chance, 0, 30),
					  chance_int(&chance, 1, 50), chance_int(&chance, 1, 40)};
		struct canvas canvas = coordinates(chance_int(&chance, 1, 100),
						   chance_int(&chance, 1, 100));
		struct view view = {.width = canvas.width, .height = canvas.height, .squash = 1};
		struct picture picture = view_picture(&view, canvas.pixels, canvas.stride);
		enum config_scale how = run % 2 ? SCALE_FIT : SCALE_NONE;
		double squash = run % 5 == 4 ? 2 : 1;
		struct layout_box box = layout_box(&cell, canvas.width, canvas.height, squash, how);
		struct scaler scaler = {.scratch = NULL};

		memset(pixels, UNTOUCHED, sizeof(pixels));
		assert_int_equal(layout_place(&screen, &cell, &picture, squash, how, &scaler, NULL),
				 0);
		for (int y = 0; y < HEIGHT; y++) {
			for (int x = 0; x < WIDTH; x++) {
				const uint8_t *p = pixels[y][x];
				bool in_cell = x >= cell.x && x < cell.x + cell.width &&
					       y >= cell.y && y < cell.y + cell.height;
				bool in_box = in_cell && x >= box.x && x < box.x + box.width &&
					      y >= box.y && y < box.y + box.height;

				expect_equal(p[2],
					     !in_cell ? UNTOUCHED
					     : in_box ? 1
						      : 0,
					     "run=%d, y=%d, x=%d", run, y, x);
				if (in_box && box.width == canvas.width &&
				    box.height == canvas.height) {
					expect_equal(p[0], x - box.x, "run=%d, y=%d, x=%d", run, y,
						     x);
					expect_equal(p[1], y - box.y, "run=%d, y=%d, x=%d", run, y,
						     x);
				}
			}
		}
		scaler_free(&scaler);
		canvas_free(&canvas);
	}
}

/* ---- the line of a split picture ---- */

TEST("a line is always seen")
{
	struct chance chance = chance_begin("a_line_is_always_seen");

	for (int run = 0; run < 1000; run++) {
		struct layout_box cell = {chance_int(&chance, 0, 40), chance_int(&chance, 0, 30),
					  chance_int(&chance, 1, 2000),
					  chance_int(&chance, 1, 2000)};
		enum config_scale how = run % 2 ? SCALE_FIT : SCALE_NONE;
		struct layout_box box = layout_box(&cell, chance_int(&chance, 1, 3000),
						   chance_int(&chance, 1, 3000), 1, how);
		double split = run % 3 ? chance_real(&chance, 0, 1) : run % 2;
		struct layout_span line = layout_line(&cell, &box, split);
		int left = box.x > cell.x ? box.x : cell.x;
		int width = box.width < cell.width ? box.width : cell.width;

		expect_at_least(line.from, left, "run=%d", run);
		expect_at_most(line.to, left + width, "run=%d", run);
		expect_at_least(line.to - line.from, (width < 3 ? width : 3), "run=%d", run);
		if (split == 0)
			expect_equal(line.from, left, "run=%d", run);
		if (split == 1)
			expect_equal(line.to, left + width, "run=%d", run);
	}
}

/* Two halves and the line between them write what the whole would write, except for the line. */
TEST("two halves are the whole")
{
	struct chance chance = chance_begin("two_halves_are_the_whole");
	enum { WIDTH = 90, HEIGHT = 70 };
	static uint8_t all[HEIGHT][WIDTH][4], halves[HEIGHT][WIDTH][4];
	const struct display_buffer one = {&all[0][0][0], sizeof(all[0]), WIDTH, HEIGHT, 0};
	const struct display_buffer two = {&halves[0][0][0], sizeof(all[0]), WIDTH, HEIGHT, 0};

	for (int run = 0; run < 300; run++) {
		struct layout_box cell = {chance_int(&chance, 0, 40), chance_int(&chance, 0, 30),
					  chance_int(&chance, 1, 50), chance_int(&chance, 1, 40)};
		struct canvas canvas = coordinates(chance_int(&chance, 1, 100),
						   chance_int(&chance, 1, 100));
		struct view view = {.width = canvas.width,
				    .height = canvas.height,
				    .hflip = run % 4 / 2,
				    .squash = 1};
		struct picture picture = view_picture(&view, canvas.pixels, canvas.stride);
		enum config_scale how = run % 2 ? SCALE_FIT : SCALE_NONE;
		struct layout_box box = layout_box(&cell, canvas.width, canvas.height, 1, how);
		struct layout_span line = layout_line(&cell, &box, chance_real(&chance, 0, 1));
		struct scaler scaler = {.scratch = NULL};

		memset(all, UNTOUCHED, sizeof(all));
		memset(halves, UNTOUCHED, sizeof(halves));
		assert_int_equal(layout_place(&one, &cell, &picture, 1, how, &scaler, NULL), 0);
		layout_border(&two, &cell, &box);
		assert_int_equal(layout_fill(&two, &cell, &box,
					     &(struct layout_span){-100, line.from}, &picture,
					     &scaler, NULL),
				 0);
		assert_int_equal(layout_fill(&two, &cell, &box,
					     &(struct layout_span){line.to, 1000}, &picture,
					     &scaler, NULL),
				 0);
		for (int y = 0; y < HEIGHT; y++) {
			bool in_rows = y >= cell.y && y >= box.y && y < cell.y + cell.height &&
				       y < box.y + box.height;

			for (int x = line.from; in_rows && x < line.to; x++) {
				expect_equal(halves[y][x][2], UNTOUCHED, "run=%d, y=%d, x=%d", run,
					     y, x);
				memcpy(halves[y][x], all[y][x], 4);
			}
		}
		expect_same_picture(&halves[0][0][0], &all[0][0][0], sizeof(all[0]), sizeof(all),
				    "run %d", run);
		layout_draw_line(&two, &cell, &box, &line);
		for (int y = 0; y < HEIGHT; y++) {
			for (int x = 0; x < WIDTH; x++) {
				bool in_line = x >= line.from && x < line.to && y >= cell.y &&
					       y >= box.y && y < cell.y + cell.height &&
					       y < box.y + box.height;

				if (!in_line)
					expect_same_picture(halves[y][x], all[y][x], 4, 4,
							    "of the pixel at (%d, %d), run %d", x,
							    y, run);
			}
		}
		scaler_free(&scaler);
		canvas_free(&canvas);
	}
}

/* ---- marks ---- */

static struct fisheye lens_of(int width, int height)
{
	struct fisheye_settings settings = {.field_deg = 90};
	struct fisheye lens;

	assert_int_equal(fisheye_prepare(&lens, &settings, width, height, NULL), 0);
	return lens;
}

static bool is_colour(const struct canvas *canvas, int x, int y, const uint8_t bgr[3])
{
	return !memcmp(canvas->pixels + (size_t)y * canvas->stride + 4 * (size_t)x, bgr, 3);
}

/* By r = f theta, computed here independently: a dot lies on each light. */
TEST("marks lie on the lights")
{
	static const uint8_t used_bgr[3] = MARK_USED_BGR, unused_bgr[3] = MARK_UNUSED_BGR;
	enum { SIDE = 480 };
	struct canvas canvas;
	struct dome dome;
	struct fisheye lens = lens_of(SIDE, SIDE);
	bool used[46];
	double focal = SIDE / 2 / (M_PI / 2);

	assert_int_equal(dome_create(&dome, 3, NULL), 0);
	assert_int_equal(dome.count, 46);
	for (int i = 0; i < 46; i++)
		used[i] = i % 3 == 0;
	assert_int_equal(canvas_create(&canvas, SIDE, SIDE), 0);
	memset(canvas.pixels, UNTOUCHED, canvas.stride * SIDE);
	marks_draw(&canvas, &dome, &lens, used, 4);
	for (int i = 0; i < 46; i++) {
		const double *d = dome.direction[i];
		double theta = acos(d[2]), phi = atan2(d[1], d[0]);
		double x = SIDE / 2.0 + focal * theta * cos(phi);
		double y = SIDE / 2.0 + focal * theta * sin(phi);

		if (theta > 1.5) /* on the horizon half of a mark is outside */
			continue;
		expect_that(is_colour(&canvas, (int)x, (int)y, used[i] ? used_bgr : unused_bgr),
			    "i=%d", i);
	}
	canvas_free(&canvas);
	dome_free(&dome);
}

TEST("marks are squares of their size")
{
	static const uint8_t used_bgr[3] = MARK_USED_BGR;
	static const int sides[] = {40, 243, 480, 1080};

	assert_int_equal(mark_side_px(243, 1000), 2);
	assert_int_equal(mark_side_px(480, 480), 4);
	assert_int_equal(mark_side_px(480, 120), 12); /* 3 pixels of the screen */
	assert_int_equal(mark_side_px(120, 120), 3);
	for (size_t s = 0; s < sizeof(sides) / sizeof(*sides); s++) {
		struct fisheye lens = lens_of(sides[s], sides[s]);
		const bool used[6] = {true, true, true, true, true, true};
		struct canvas canvas;
		struct dome dome;
		int coloured = 0, side = mark_side_px(sides[s], sides[s]);

		assert_int_equal(dome_create(&dome, 1, NULL), 0);
		expect_equal(dome.count, 6, "s=%zu", s);
		dome.count = 1; /* only the zenith: in the middle */
		assert_int_equal(canvas_create(&canvas, sides[s], sides[s]), 0);
		memset(canvas.pixels, UNTOUCHED, canvas.stride * (size_t)sides[s]);
		marks_draw(&canvas, &dome, &lens, used, side);
		for (int y = 0; y < canvas.height; y++) {
			for (int x = 0; x < canvas.width; x++)
				coloured += is_colour(&canvas, x, y, used_bgr);
		}
		expect_equal(coloured, side * side, "s=%zu", s);
		canvas_free(&canvas);
		dome.count = 6;
		dome_free(&dome);
	}
}
