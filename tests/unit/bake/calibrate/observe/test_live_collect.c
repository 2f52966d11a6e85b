/* SPDX-License-Identifier: MIT */
/* Pictures of a board that is drawn in several places and shown by the simulated camera. */
#include <errno.h>
#include <math.h>
#include <string.h>

#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

#include "bake/calibrate/observe/live_collect.h"
#include "tests/support/calibrate/drawn_board.h"
#include "tests/support/expect.h"
#include "tests/support/own_folder.h"
#include "tests/support/test.h"

#define HELD 6 /* pictures of each place, 10 a second: 0.5 s from the first to the last */
#define PLACES 6

static char config[PATH_MAX];

static const char *numbered(int i)
{
	char name[16];

	snprintf(name, sizeof(name), "b%03d.png", i);
	return own_folder_path(name);
}

/* Draws the board as seen from an eye, in the middle of the picture unless `target` is elsewhere.
 */
static void draw_from(const struct board *board, const double eye[3], const double target[3],
		      struct image *picture)
{
	struct fault fault = {{0}};
	struct tsai_camera camera;
	const struct drawn_board drawn = {.board = board, .camera = &camera, .blur_px = 0.7};

	assert_int_equal(tsai_look_at(&camera, 320, 240, eye, target, 50, &fault), 0);
	assert_int_equal(drawn_board_draw(&drawn, picture), 0);
}

static void draw_place(const struct board *board, int place, struct image *picture)
{
	/* Eyes above the board, and what each looks at instead of the middle, in m. */
	static const double eyes[PLACES][2] = {{0, -0.3},   {0.3, -0.2}, {-0.3, -0.1},
					       {0.1, -0.4}, {-0.2, 0},	 {0.25, -0.35}};
	static const double shifts[PLACES][2] = {{0, 0},	{0.12, 0.08},	{-0.12, 0.08},
						 {0.12, -0.08}, {-0.12, -0.08}, {0, 0.1}};
	const double middle[3] = {0.1, -0.0625, 0};
	const double eye[3] = {middle[0] + eyes[place][0], middle[1] + eyes[place][1], 0.55};
	const double target[3] = {middle[0] + shifts[place][0], middle[1] + shifts[place][1], 0};

	draw_from(board, eye, target, picture);
}

/* Draws an empty picture, then each place HELD times. Returns the number of pictures. */
static int draw_all(const struct board *board)
{
	struct fault fault = {{0}};
	struct image picture;
	int count = 0;

	assert_int_equal(image_create_u8(&picture, 320, 240), 0);
	memset(picture.u8, 90, 3 * (size_t)320 * 240);
	assert_int_equal(image_write(numbered(count++), &picture, &fault), 0);
	image_free(&picture);
	for (int place = 0; place < PLACES; place++) {
		draw_place(board, place, &picture);
		for (int i = 0; i < HELD; i++)
			assert_int_equal(image_write(numbered(count++), &picture, &fault), 0);
		image_free(&picture);
	}
	return count;
}

static void write_config(const char *screen)
{
	FILE *file;

	snprintf(config, sizeof(config), "%s", own_folder_path("kiosk.conf"));
	file = fopen(config, "w");
	assert_non_null(file);
	fprintf(file,
		"[camera one]\ndriver=sim\nrate=10\nsim.source=files\nsim.file=b%%03d.png\n"
		"sim.clock=frames\nsim.loop=no\n[background]\ncamera=one\n[screen]\n%s",
		screen);
	assert_int_equal(fclose(file), 0);
}

static int collected(struct board *board, int views, struct observations *all,
		     struct image **pictures, int *count, struct fault *fault)
{
	const struct collect_settings settings = {.views = views, .patience_s = 60, .world = 1};
	struct live *live;
	int err;

	if (live_open(&live, config, LIVE_BACKGROUND, fault))
		fail_msg("%s", fault->text);
	err = live_collect(live, board, &settings, all, pictures, count, fault);
	live_close(live);
	return err;
}

/* Checks that the circles around the corners of the last view are green, the colour of a view that
 * was just taken. */
static void check_marks(const struct image *shown, const struct observations *all)
{
	const struct observed_view *view = &all->view[all->views - 1];

	for (int i = 1; i < view->count; i++) { /* the first corner has a larger circle */
		const double *px = all->point[view->first + i].px;
		int green = 0;

		for (int y = -3; y <= 3; y++)
			for (int x = -3; x <= 3; x++) {
				const uint8_t *rgb = shown->u8 +
						     3 * (((int)px[1] + y) * 320 + (int)px[0] + x);

				green += rgb[1] > rgb[0] + 60 && rgb[1] > rgb[2] + 60;
			}
		expect_at_least(green, 8, "i=%d", i);
	}
}

TEST("collect")
{
	struct observations all = {0};
	struct fault fault = {{0}};
	struct image *pictures, shown;
	struct board board;
	int count, drawn;

	assert_int_equal(board_parse(&board, "9x6:25mm", &fault), 0);
	drawn = draw_all(&board);
	write_config("driver=file\ndevice=now.png\n");
	if (collected(&board, 3, &all, &pictures, &count, &fault))
		fail_msg("%s", fault.text);
	assert_int_equal(count, 3);
	assert_int_equal(all.views, 3);
	assert_int_equal(all.count, 3 * 54);
	assert_string_equal(all.view[2].name, "place 3");
	/* each picture holds the board where its view says */
	for (int i = 0; i < count; i++) {
		struct observations again = {0};

		assert_int_equal(board_find(&board, &pictures[i], "again", &again, &fault), 0);
		for (int k = 0; k < 54; k++)
			expect_equal(again.point[k].px[0], all.point[54 * i + k].px[0],
				     "i=%d, k=%d", i, k);
		observations_free(&again);
		image_free(&pictures[i]);
	}
	free(pictures);
	assert_int_equal(image_read(own_folder_path("now.png"), &shown, &fault), 0);
	assert_int_equal(shown.width, 320);
	assert_int_equal(shown.height, 240);
	check_marks(&shown, &all);
	image_free(&shown);
	observations_free(&all);
	/* The camera ends before there are enough pictures; the screen has failed before. */
	write_config("driver=file\ndevice=nowhere/now.png\n");
	assert_int_equal(collected(&board, 50, &all, &pictures, &count, &fault), -ENODEV);
	assert_null(pictures);
	assert_int_equal(count, 0);
	assert_in_range(all.views, 4, PLACES);
	observations_free(&all);
	write_config("driver=nothing\n");
	assert_int_equal(collected(&board, 3, &all, &pictures, &count, &fault), -EINVAL);
	assert_non_null(strstr(fault.text, "there is no driver \"nothing\""));
	for (int i = 0; i < drawn; i++)
		unlink(numbered(i));
	unlink(own_folder_path("now.png"));
	unlink(config);
}

/* A board that turns about its middle is in a new place each time, but not when it turns back. Its
 * screen does not open, which does not stop the collection. */
TEST("tilts")
{
	/* angle of the eye around the board's middle, in degrees; 0 is above */
	static const double tilts[] = {0, 30, 2, -30, 28, 0};
	const double middle[3] = {0.1, -0.0625, 0};
	struct observations all = {0};
	struct fault fault = {{0}};
	struct image *pictures, picture;
	struct board board;
	int count, drawn = 0;

	assert_int_equal(board_parse(&board, "9x6:25mm", &fault), 0);
	for (size_t k = 0; k < sizeof(tilts) / sizeof(tilts[0]); k++) {
		const double angle = tilts[k] * M_PI / 180;
		const double eye[3] = {middle[0], middle[1] - 0.55 * sin(angle) - 1e-6,
				       0.55 * cos(angle)};

		draw_from(&board, eye, middle, &picture);
		for (int i = 0; i < HELD; i++)
			assert_int_equal(image_write(numbered(drawn++), &picture, &fault), 0);
		image_free(&picture);
	}
	write_config("driver=file\ndevice=screen.txt\n");
	assert_int_equal(collected(&board, 4, &all, &pictures, &count, &fault), -ENODEV);
	assert_int_equal(all.views, 3);
	observations_free(&all);
	for (int i = 0; i < drawn; i++)
		unlink(numbered(i));
	unlink(config);
}

TEST_GROUP(own_folder_make, own_folder_remove);
