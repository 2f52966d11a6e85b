/* SPDX-License-Identifier: MIT */
/*
 * Boards: what is printed, what is looked for in a photograph, and where its points are in the
 * world.
 *
 * A board's own axes: x right, y down as printed and seen from the front, z into the board, so that
 * it is right-handed; the origin is the first inner corner (chessboard, ChArUco) or the first
 * circle. Lengths are in millimetres. The square at the upper left is black.
 */
#ifndef INLAY_BAKE_CALIBRATE_OBSERVE_BOARDS_H
#define INLAY_BAKE_CALIBRATE_OBSERVE_BOARDS_H

#include <stdbool.h>

#include "bake/calibrate/observe/observations.h"
#include "hal/base/fault.h"
#include "hal/image/image.h"

enum board_kind {
	BOARD_CHESS,   /* columns x rows of inner corners */
	BOARD_CIRCLES, /* asymmetric circles: columns x rows as OpenCV counts them */
	BOARD_CHARUCO, /* columns x rows of squares, with markers: may be seen in part */
	BOARD_KIND_COUNT
};

extern const char *const board_kind_names[]; /* "chess", "circles", "charuco", NULL */

#define BOARD_SIDE_MAX 40
#define BOARD_NAME_MAX 64

struct board {
	enum board_kind kind;
	int columns, rows;
	double step_mm;	  /* side of a square; between rows of circles, which is half of what lies
			     between neighbours along a row */
	double marker_mm; /* ChArUco: side of a marker */
	/*
	 * From the board's axes to the world of the scene: world = rotation * board * unit +
	 * position. Set by board_parse() to what a board lying on the ground is: its face up, its
	 * rows along world X, its origin at the world's, and unit 0.001 (a scene in metres).
	 */
	double rotation[9], position[3], unit;
};

/* "9x6:25mm", "chess:9x6:25mm", "circles:4x11:20mm", "charuco:8x6:30mm:22mm"; sides of 3 to
 * BOARD_SIDE_MAX, circles in an odd number of rows, steps of 0.1 to 1000 mm, markers smaller than
 * squares. -EINVAL. */
int board_parse(struct board *board, const char *text, struct fault *fault);

/* The same in words that board_parse() reads. */
void board_name(const struct board *board, char text[BOARD_NAME_MAX]);

int board_points(const struct board *board); /* how many it has */

/* World place of point k, counted along rows from the first. */
void board_point(const struct board *board, int k, double world[3]);

/*
 * Whether it looks the same upside down: chessboards whose numbers of corners are both odd or both
 * even (9x6 is not one of them). board_find() then takes it to
 * be as it was held: its rows running to the right in the picture. That is enough for a lens, and
 * a half turn wrong for the world if the board lies the other way round.
 */
bool board_ambiguous(const struct board *board);

/* What is printed at a place in the board's own axes: black, or paper. */
bool board_ink(const struct board *board, double x_mm, double y_mm);

/*
 * Finds the board in an 8-bit picture and adds what it finds as a view called name; points are
 * named by column and row, the first being 1,1. All points are found or none; of ChArUco six or
 * more. Seen from behind, or in a mirror, no board is found as it is: pictures are upright.
 *
 * Centres of circles are those of their images, which perspective and distortion shift away from
 * the images of their centres: by f r^2 sin(2 tilt) / (2 Z^2) px at first order (r the radius, Z
 * the distance, f in px), some hundredths of a pixel for small circles. Corners have no such bias.
 *
 * 0; -ENOENT: there is no such board in it (the fault says what was found instead, where that is
 * known); -EINVAL: its size is not that of the pictures before it; -ENOMEM. On failure nothing is
 * added.
 */
int board_find(const struct board *board, const struct image *picture, const char *name,
	       struct observations *all, struct fault *fault);

/* Whether there is such a page: "a4", "a3", "letter". -EINVAL. */
int board_page_check(const char *page, struct fault *fault);

/* A PDF of one page, the board at its true size, with its name and a ruler to check the printer.
 * -E2BIG: it does not fit on the page, the fault says what would; -EINVAL: no such page; -ENOMEM,
 * or what keeps the file from being written. */
int board_print(const struct board *board, const char *page, const char *path, struct fault *fault);

#endif
