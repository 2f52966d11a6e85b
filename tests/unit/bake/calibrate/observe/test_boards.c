/* SPDX-License-Identifier: MIT */
/* Boards: drawn through known cameras and found again; photographs from Debian. */
#include <errno.h>
#include <string.h>
#include <unistd.h>

#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "bake/calibrate/observe/gather.h"
#include "tests/support/calibrate/drawn_board.h"
#include "tests/support/expect.h"
#include "tests/support/own_folder.h"
#include "tests/support/test.h"
#include "tests/support/thorough.h"

#define PHOTOGRAPHS "/usr/share/doc/opencv-doc/examples/data/"

static struct board parsed(const char *text)
{
	struct board board;
	struct fault fault = {{0}};

	if (board_parse(&board, text, &fault))
		fail_msg("%s", fault.text);
	return board;
}

/* ---- words and points ---- */

TEST("parse")
{
	static const char *const right[][2] = {
		{"9x6:25mm", "chess:9x6:25mm"},
		{"chess:3x40:0.5mm", "chess:3x40:0.5mm"},
		{"charuco:8x6:30mm:22.5mm", "charuco:8x6:30mm:22.5mm"},
		{"charuco:8x6:30mm:22mm:DICT_5X5_100", "charuco:8x6:30mm:22mm"},
		{"charuco:8x6:30mm:22mm:dict_6x6_250:legacy", "charuco:8x6:30mm:22mm:6x6:legacy"},
		{"charuco:8x6:30mm:22mm:LEGACY:7x7", "charuco:8x6:30mm:22mm:7x7:legacy"},
		{"charuco:8x6:30mm:22mm:DICT_ARUCO_ORIGINAL", "charuco:8x6:30mm:22mm:original"},
		{"charuco:8x6:30mm:22mm:DICT_APRILTAG_36h11",
		 "charuco:8x6:30mm:22mm:apriltag_36h11"},
	};
	static const char *const wrong[] = {
		"",
		"9x6",
		"9x6:25",
		"9x6:25cm",
		"9x6:25mm:",
		"9x6:25mm:20mm",
		"9x6:-25mm",
		"9x6: 25mm",
		"9x6:nanmm",
		"9x6:1e9mm",
		"9x6:0mm",
		"2x6:25mm",
		"9x41:25mm",
		"9x99999999999999999999:25mm",
		"-9x6:25mm",
		"squares:9x6:25mm",
		"chess",
		"charuco:8x6:30mm",
		"charuco:8x6:30mm:30mm",
		"charuco:8x6:30mm:22mm:1mm",
		"charuco:8x6:30mm:22mm:8x8",
		"charuco:8x6:30mm:22mm:6x6_200",
		"charuco:8x6:30mm:22mm:6x6_250:",
		"charuco:12x10:30mm:22mm:6x6_50",
		"charuco:9x8:30mm:22mm:apriltag_16h5",
		"9x6:25mm:legacy",
	};
	char name[BOARD_NAME_MAX];
	struct fault fault;

	for (size_t i = 0; i < sizeof(right) / sizeof(right[0]); i++) {
		struct board board = parsed(right[i][0]);

		board_name(&board, name);
		assert_string_equal(name, right[i][1]);
	}
	for (size_t i = 0; i < sizeof(wrong) / sizeof(wrong[0]); i++) {
		struct board board;

		fault.text[0] = 0;
		expect_equal(board_parse(&board, wrong[i], &fault), -EINVAL, "i=%zu", i);
		assert_non_null(strstr(fault.text, "expected"));
	}
}

static void assert_place(const char *spec, int k, double x, double y)
{
	struct board board = parsed(spec);
	double world[3];

	board_point(&board, k, world);
	assert_float_equal(world[0], x, 1e-12);
	assert_float_equal(world[1], y, 1e-12);
	assert_float_equal(world[2], 0, 1e-12);
}

/* On the ground, face up: rows along X, columns against Y. */
TEST("points")
{
	struct board board;

	assert_place("9x6:25mm", 0, 0, 0);
	assert_place("9x6:25mm", 8, 0.2, 0);
	assert_place("9x6:25mm", 53, 0.2, -0.125);
	assert_place("charuco:8x6:30mm:22mm", 7, 0, -0.03);
	board = parsed("charuco:8x6:30mm:22mm");
	assert_int_equal(board_points(&board), 35);
	board = parsed("9x6:25mm");
	assert_int_equal(board_points(&board), 54);
}

/* ---- drawn ---- */

struct trial {
	const char *board;
	int width, height;
	double blur_px, noise;
	double kappa; /* kappa1 f^2 */
	/* Place of the eye; `away` in half diagonals of the board. */
	double tilt_deg, turn_deg, away;
	double rms_px, worst_px; /* largest errors allowed */
	int least;		 /* number of points at least; 0: all */
};

static struct tsai_camera camera_of(const struct trial *trial, const struct board *board)
{
	const double tilt = trial->tilt_deg * M_PI / 180, turn = trial->turn_deg * M_PI / 180;
	struct fault fault = {{0}};
	struct tsai_camera camera;
	double first[3], last[3], target[3], eye[3], away;

	board_point(board, 0, first);
	board_point(board, board_points(board) - 1, last);
	for (int i = 0; i < 3; i++)
		target[i] = (first[i] + last[i]) / 2;
	away = trial->away * hypot(last[0] - first[0], last[1] - first[1]) / 2;
	eye[0] = target[0] + away * sin(tilt) * cos(turn);
	eye[1] = target[1] + away * sin(tilt) * sin(turn);
	eye[2] = target[2] + away * cos(tilt);
	if (tsai_look_at(&camera, trial->width, trial->height, eye, target, 50, &fault))
		fail_msg("%s", fault.text);
	camera.kappa1 = trial->kappa / (camera.focal * camera.focal);
	return camera;
}

/* Each point found has the right name, and is where the camera sees it. */
static void find_drawn(const struct trial *trial)
{
	struct board board = parsed(trial->board);
	const struct tsai_camera camera = camera_of(trial, &board);
	const struct drawn_board drawn = {.board = &board,
					  .camera = &camera,
					  .blur_px = trial->blur_px,
					  .noise = trial->noise,
					  .seed = 1};
	struct observations all = {0};
	struct fault fault = {{0}};
	struct image picture;
	double squares = 0, worst = 0;

	assert_int_equal(drawn_board_draw(&drawn, &picture), 0);
	if (board_find(&board, &picture, "drawn/board", &all, &fault))
		fail_msg("%s tilt %g turn %g: %s", trial->board, trial->tilt_deg, trial->turn_deg,
			 fault.text);
	assert_int_equal(all.views, 1);
	assert_int_equal(all.width, trial->width);
	if (trial->least)
		assert_in_range(all.count, trial->least, board_points(&board));
	else
		assert_int_equal(all.count, board_points(&board));
	assert_int_equal(all.view[0].count, all.count);
	assert_memory_equal(all.point[0].name, "board ", 6);
	for (int k = 0; k < all.count; k++) {
		double px[2], away;

		assert_int_equal(tsai_project(&camera, all.point[k].world, px), 0);
		away = hypot(all.point[k].px[0] - px[0], all.point[k].px[1] - px[1]);
		squares += away * away;
		worst = fmax(worst, away);
	}
	print_message(
		"# %s %dx%d blur %g noise %g kappa %g tilt %g turn %g: RMS %.4f px, worst %.3f px, %d points\n",
		trial->board, trial->width, trial->height, trial->blur_px, trial->noise,
		trial->kappa, trial->tilt_deg, trial->turn_deg, sqrt(squares / all.count), worst,
		all.count);
	assert_true(sqrt(squares / all.count) < trial->rms_px);
	assert_true(worst < trial->worst_px);
	observations_free(&all);
	image_free(&picture);
}

TEST("drawn chess")
{
	for (int turn = -180; turn < 180; turn += thorough() ? 60 : 180)
		find_drawn(
			&(struct trial){"9x6:25mm", 640, 480, 0, 0, 0, 30, turn, 5, 0.05, 0.2, 0});
	find_drawn(&(struct trial){"9x6:25mm", 640, 480, 0, 0, -0.3, 20, 250, 4.5, 0.05, 0.2, 0});
	find_drawn(&(struct trial){"9x6:25mm", 640, 480, 1, 2, 0.2, 40, 290, 4.5, 0.05, 0.2, 0});
	find_drawn(&(struct trial){"9x6:25mm", 640, 480, 2, 5, 0, 10, 270, 4.5, 0.1, 0.4, 0});
	find_drawn(&(struct trial){"9x6:25mm", 320, 240, 0, 0, 0, 30, 270, 4.5, 0.05, 0.2, 0});
	find_drawn(&(struct trial){"6x9:25mm", 640, 480, 0, 0, 0, 30, 300, 5, 0.05, 0.2, 0});
}

/* Boards that look the same upside down, seen upright and turned to either side. */
TEST("drawn ambiguous")
{
	for (int turn = 200; turn <= 340; turn += thorough() ? 70 : 140) {
		find_drawn(
			&(struct trial){"9x7:25mm", 640, 480, 0, 0, 0, 30, turn, 5, 0.05, 0.2, 0});
		find_drawn(
			&(struct trial){"8x6:25mm", 640, 480, 0, 0, 0, 30, turn, 5, 0.05, 0.2, 0});
	}
	find_drawn(&(struct trial){"7x7:25mm", 640, 480, 0, 0, 0, 30, 290, 5, 0.05, 0.2, 0});
	find_drawn(&(struct trial){"6x6:25mm", 640, 480, 0, 0, 0, 30, 250, 5, 0.05, 0.2, 0});
}

TEST("drawn charuco")
{
	static const char board[] = "charuco:8x6:30mm:22mm";

	for (int turn = -180; turn < 180; turn += thorough() ? 60 : 180)
		find_drawn(&(struct trial){board, 640, 480, 0, 0, 0, 30, turn, 5, 0.05, 0.2, 0});
	find_drawn(&(struct trial){board, 640, 480, 1, 2, -0.3, 30, 250, 4.5, 0.05, 0.2, 0});
	find_drawn(&(struct trial){"charuco:7x5:30mm:20mm", 640, 480, 0, 0, 0, 30, 200, 5, 0.05,
				   0.2, 0});
	/* so near that only a part is in the picture */
	find_drawn(&(struct trial){board, 640, 480, 0.7, 1, 0, 20, 270, 1.6, 0.05, 0.2, 6});
}

/* ---- markers of any dictionary ---- */

static void draw_markers(const char *spec, struct image *picture)
{
	struct board board = parsed(spec);
	const struct trial trial = {spec, 640, 480, .tilt_deg = 25, .turn_deg = 250, .away = 3.5};
	const struct tsai_camera camera = camera_of(&trial, &board);
	const struct drawn_board drawn = {.board = &board, .camera = &camera, .blur_px = 0.7};

	assert_int_equal(drawn_board_draw(&drawn, picture), 0);
}

static void find_markers(const char *spec)
{
	struct observations all = {0};
	struct fault fault = {{0}};
	struct image picture;
	const struct board board = parsed(spec);

	draw_markers(spec, &picture);
	if (board_find(&board, &picture, "drawn", &all, &fault))
		fail_msg("%s: %s", spec, fault.text);
	expect_equal(all.count, board_points(&board), "%s", spec);
	observations_free(&all);
	image_free(&picture);
}

TEST("any markers")
{
	static const char *const words[] = {
		"",	   ":4x4",	  ":6x6",	 ":7x7",	":original",
		":legacy", ":4x4:legacy", ":6x6:legacy", ":7x7:legacy", ":original:legacy"};

	for (size_t i = 0; i < sizeof(words) / sizeof(words[0]); i += thorough() ? 1 : 4) {
		char spec[BOARD_NAME_MAX];

		snprintf(spec, sizeof(spec), "charuco:8x6:30mm:22mm%s", words[i]);
		find_markers(spec);
	}
	find_markers("charuco:8x7:30mm:22mm:legacy");
	find_markers("charuco:7x6:30mm:22mm:4x4:legacy");
}

/* ---- what is none ---- */

static void assert_none(const char *spec, const struct image *picture, const char *says)
{
	struct board board = parsed(spec);
	struct observations all = {0};
	struct fault fault = {{0}};

	assert_int_equal(board_find(&board, picture, "some.png", &all, &fault), -ENOENT);
	if (!strstr(fault.text, says) || strncmp(fault.text, "some.png: ", 10) ||
	    !strstr(fault.text, spec))
		fail_msg("\"%s\" does not say \"%s\"", fault.text, says);
	assert_int_equal(all.count, 0);
	assert_int_equal(all.views, 0);
	observations_free(&all);
}

static void boards_draw(const struct trial *trial, struct image *picture)
{
	struct board board = parsed(trial->board);
	const struct tsai_camera camera = camera_of(trial, &board);
	const struct drawn_board drawn = {
		.board = &board, .camera = &camera, .blur_px = trial->blur_px};

	assert_int_equal(drawn_board_draw(&drawn, picture), 0);
}

TEST("other size")
{
	static const char *const wanted[] = {"chess:8x5:25mm", "chess:10x7:25mm", "chess:9x5:25mm",
					     "chess:8x6:25mm", "chess:10x6:25mm", "chess:5x4:25mm"};
	struct image picture;

	boards_draw(&(struct trial){"9x6:25mm", 640, 480, .blur_px = 0.7, .tilt_deg = 20,
				    .turn_deg = 260, .away = 5},
		    &picture);
	for (size_t i = 0; i < sizeof(wanted) / sizeof(wanted[0]); i += thorough() ? 1 : 3)
		assert_none(wanted[i], &picture, "holds a chessboard of 9x6 inner corners");
	assert_none("charuco:8x6:30mm:22mm", &picture, "no marker");
	image_free(&picture);
}

/* A board whose markers are other ones than its text names is not found, and says how to name
 * them. */
TEST("other markers")
{
	static const char *const cases[][3] = {
		{"charuco:8x6:30mm:22mm:4x4", "charuco:8x6:30mm:22mm:6x6", "no marker of 6x6"},
		{"charuco:8x6:30mm:22mm", "charuco:8x6:30mm:22mm:legacy", "are not 5x5 (:6x6)"},
		{"charuco:8x6:30mm:22mm:7x7:legacy", "charuco:8x6:30mm:22mm:7x7",
		 "24 markers of 7x7 are to be seen, but not beside each other"},
		{"charuco:8x6:30mm:22mm", "charuco:6x8:30mm:22mm",
		 "upper left square is white (:legacy)"},
	};

	for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
		struct image picture;

		draw_markers(cases[i][0], &picture);
		assert_none(cases[i][1], &picture, cases[i][2]);
		image_free(&picture);
	}
}

TEST("no board")
{
	struct image picture;

	assert_int_equal(image_create_u8(&picture, 640, 480), 0);
	for (int level = 0; level < 256; level += 255) {
		memset(picture.u8, level, (size_t)640 * 480 * 3);
		assert_none("chess:9x6:25mm", &picture, "no chessboard");
		assert_none("charuco:8x6:30mm:22mm", &picture, "no marker");
	}
	image_free(&picture);
	/* pictures too small for any board */
	for (int side = 1; side < 20; side += thorough() ? 6 : 18) {
		assert_int_equal(image_create_u8(&picture, side, side), 0);
		memset(picture.u8, 99, (size_t)side * (size_t)side * 3);
		assert_none("chess:9x6:25mm", &picture, "expected");
		assert_none("charuco:8x6:30mm:22mm", &picture, "expected");
		image_free(&picture);
	}
	/* blurred beyond recognition; and tiny */
	boards_draw(&(struct trial){"9x6:25mm", 640, 480, .blur_px = 25, .tilt_deg = 20,
				    .turn_deg = 260, .away = 5},
		    &picture);
	assert_none("chess:9x6:25mm", &picture, "expected");
	image_free(&picture);
	boards_draw(&(struct trial){"9x6:25mm", 640, 480, .blur_px = 0.7, .tilt_deg = 20,
				    .turn_deg = 260, .away = 120},
		    &picture);
	assert_none("chess:9x6:25mm", &picture, "expected");
	image_free(&picture);
}

/* A picture of another size cannot be of the same camera. */
TEST("other picture")
{
	struct board board = parsed("9x6:25mm");
	struct observations all = {.width = 640, .height = 480};
	struct fault fault = {{0}};
	struct image picture;

	assert_int_equal(image_create_u8(&picture, 320, 240), 0);
	assert_int_equal(board_find(&board, &picture, "b.png", &all, &fault), -ERANGE);
	assert_string_equal(fault.text,
			    "b.png: is 320x240, expected 640x480 as the others: skipped");
	image_free(&picture);
}

/* The size that most photographs have counts, though another one comes first; one that is cut off
 * is left out. */
TEST("misfits")
{
	static const struct {
		const char *name;
		int width, height;
		double turn_deg;
	} photographs[] = {{"a.png", 320, 240, 10},
			   {"b.png", 640, 480, 100},
			   {"c.png", 640, 480, 190},
			   {"d.png", 640, 480, 280}};
	struct board board = parsed("9x6:25mm");
	struct gathering all = {.picture = NULL};
	struct fault fault = {{0}};
	char pattern[PATH_MAX], *patterns[] = {pattern};

	for (int k = 0; k < 4; k++) {
		const struct trial trial = {
			"9x6:25mm",	photographs[k].width, photographs[k].height,
			.blur_px = 0.7, .tilt_deg = 20,	      .turn_deg = photographs[k].turn_deg,
			.away = 5};
		struct image picture;

		boards_draw(&trial, &picture);
		assert_int_equal(
			image_write(own_folder_path(photographs[k].name), &picture, &fault), 0);
		image_free(&picture);
	}
	assert_int_equal(truncate(own_folder_path("d.png"), 2000), 0);
	snprintf(pattern, sizeof(pattern), "%s", own_folder_path("?.png"));
	if (gather_images(&all, patterns, 1, &board, &fault))
		fail_msg("%s", fault.text);
	assert_int_equal(all.seen.width, 640);
	assert_int_equal(all.seen.views, 2);
	assert_int_equal(all.pictures, 2);
	assert_int_equal(all.boardlesses, 2);
	gather_free(&all);
	for (int k = 0; k < 4; k++)
		assert_int_equal(unlink(own_folder_path(photographs[k].name)), 0);
}

/* ---- printed ---- */

#define DPI 150

/* Least squares for the board's axes on the page: px = origin + mm * scale. */
static double scale_of(const struct board *board, const struct observations *all, int axis)
{
	double n = 0, mm1 = 0, mm2 = 0, px1 = 0, cross = 0;

	for (int k = 0; k < all->count; k++) {
		/* the board lies on the ground: its y is -Y of the world */
		const double mm = (axis ? -1 : 1) * all->point[k].world[axis] / board->unit;

		n++;
		mm1 += mm;
		mm2 += mm * mm;
		px1 += all->point[k].px[axis];
		cross += mm * all->point[k].px[axis];
	}
	return (n * cross - mm1 * px1) / (n * mm2 - mm1 * mm1);
}

/* The printed page has the right size, and the board on it has its points in place, not mirrored.
 */
static void print_and_find(const char *spec, const char *page, double width_mm, double height_mm)
{
	struct board board = parsed(spec);
	struct observations all = {0};
	struct fault fault = {{0}};
	struct image picture;
	char command[2 * PATH_MAX + 64], pdf[PATH_MAX], png[PATH_MAX];

	snprintf(pdf, sizeof(pdf), "%s", own_folder_path("board.pdf"));
	snprintf(png, sizeof(png), "%s", own_folder_path("board.png"));
	if (board_print(&board, page, pdf, &fault))
		fail_msg("%s", fault.text);
	snprintf(command, sizeof(command), "pdftoppm -singlefile -r %d -png '%s' '%.*s'", DPI, pdf,
		 (int)strlen(png) - 4, png);
	assert_int_equal(system(command), 0);
	assert_int_equal(image_read(png, &picture, &fault), 0);
	assert_float_equal(picture.width, width_mm / 25.4 * DPI, 1.5);
	assert_float_equal(picture.height, height_mm / 25.4 * DPI, 1.5);
	if (board_find(&board, &picture, png, &all, &fault))
		fail_msg("%s", fault.text);
	assert_int_equal(all.count, board_points(&board));
	for (int axis = 0; axis < 2; axis++) {
		const double step_mm = scale_of(&board, &all, axis) * board.step_mm / DPI * 25.4;

		print_message("# %s on %s: step %.4f mm\n", spec, page, step_mm);
		assert_float_equal(step_mm, board.step_mm, 0.01);
	}
	observations_free(&all);
	image_free(&picture);
	unlink(pdf);
	unlink(png);
}

TEST("printed")
{
	print_and_find("charuco:7x9:26mm:19mm", "a4", 210, 297);
	print_and_find("6x9:24mm", "letter", 215.9, 279.4);
	if (thorough())
		print_and_find("charuco:8x6:40mm:30mm", "a3", 420, 297);
}

TEST("not printed")
{
	struct board board = parsed("9x6:30mm");
	struct fault fault;

	assert_int_equal(board_print(&board, "a4", own_folder_path("b.pdf"), &fault), -E2BIG);
	assert_string_equal(
		fault.text,
		"chess:9x6:30mm does not fit on a4: expected a step of at most 25.7 mm");
	print_and_find("9x6:25.7mm", "a4", 297, 210);
	assert_int_equal(board_print(&board, "a5", own_folder_path("b.pdf"), &fault), -EINVAL);
	assert_non_null(strstr(fault.text, "expected a4, a3 or letter"));
	assert_int_equal(board_print(&board, "a3", own_folder_path("none/b.pdf"), &fault), -ENOENT);
}

/* ---- photographs ---- */

TEST("photographs")
{
	static const char *const sides[] = {"left", "right"};
	struct board board = parsed("9x6:25mm");
	struct observations all = {0};
	struct fault fault = {{0}};
	struct image picture;
	const int cameras = thorough() ? 2 : 1;

	if (access(PHOTOGRAPHS, R_OK)) {
		print_message("# no " PHOTOGRAPHS " (Debian's opencv-doc)\n");
		skip();
	}
	for (int i = 0; i < 14 * cameras; i++) {
		char path[128];

		snprintf(path, sizeof(path), PHOTOGRAPHS "%s%02d.jpg", sides[i / 14], i % 14 + 1);
		if (access(path, R_OK)) {
			expect_equal(i % 14 + 1, 10, "i=%d", i); /* there is no tenth */
			continue;
		}
		assert_int_equal(image_read(path, &picture, &fault), 0);
		if (board_find(&board, &picture, path, &all, &fault))
			fail_msg("%s", fault.text);
		image_free(&picture);
	}
	assert_int_equal(all.views, 13 * cameras);
	assert_int_equal(all.count, 13 * cameras * 54);
	assert_string_equal(all.point[1].name, "left01.jpg 2,1");
	observations_free(&all);
	assert_int_equal(image_read(PHOTOGRAPHS "left01.jpg", &picture, &fault), 0);
	assert_none("chess:8x5:25mm", &picture, "holds a chessboard of 9x6 inner corners");
	image_free(&picture);
	assert_int_equal(image_read(PHOTOGRAPHS "fruits.jpg", &picture, &fault), 0);
	assert_none("chess:9x6:25mm", &picture, "no chessboard");
	image_free(&picture);
}

TEST_GROUP(own_folder_make, own_folder_remove);
