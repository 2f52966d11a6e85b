/* SPDX-License-Identifier: MIT */
/*
 * Boards: what is printed, what is looked for in a photograph, and where its points are in the
 * world.
 *
 * A board's own axes: x right, y down as printed and seen from the front, z into the board, so that
 * they are right-handed; the origin is the first inner corner. Lengths are in millimetres. The
 * square at the upper left is black, but for some of ChArUco's.
 */
#ifndef INLAY_BAKE_CALIBRATE_OBSERVE_BOARDS_H
#define INLAY_BAKE_CALIBRATE_OBSERVE_BOARDS_H

#include <stdbool.h>

#include "bake/calibrate/observe/observations.h"
#include "hal/base/fault.h"
#include "hal/image/image.h"

enum board_kind {
	BOARD_CHESS,   /* columns x rows of inner corners */
	BOARD_CHARUCO, /* columns x rows of squares, with markers: may be seen in part */
	BOARD_KIND_COUNT
};

extern const char *const board_kind_names[]; /* "chess", "charuco", NULL */

#define BOARD_SIDE_MAX 40
#define BOARD_NAME_MAX 96

struct board {
	enum board_kind kind;
	int columns, rows;
	double step_mm;	  /* side of a square */
	double marker_mm; /* ChArUco: side of a marker */
	/* ChArUco: index of the dictionary of its markers, 5x5 bits unless named; whether its
	 * squares are those of OpenCV before 4.6, which has a white one at the upper left if
	 * there is an even number of rows. */
	int dictionary;
	bool legacy;
	/*
	 * From the board's axes to the world of the scene:
	 *     world = rotation * board * unit + position
	 * board_parse() sets a board that lies on the ground: face up, rows along world X, its
	 * origin at the world's, and unit 0.001 (a scene in metres).
	 */
	double rotation[9], position[3], unit;
};

/* Parses "9x6:25mm", "chess:9x6:25mm" or "charuco:8x6:30mm:22mm", the last
 * perhaps with ":6x6" or ":DICT_6X6_250" for its dictionary and ":legacy" for the squares of OpenCV
 * before 4.6. Sides are 3 to BOARD_SIDE_MAX, steps are 0.1 to
 * 1000 mm, markers are smaller than squares. -EINVAL. */
int board_parse(struct board *board, const char *text, struct fault *fault);

/* Writes the board as text that board_parse() reads. */
void board_name(const struct board *board, char text[BOARD_NAME_MAX]);

int board_points(const struct board *board); /* number of points */

/* World position of point k, counted along rows from the first. */
void board_point(const struct board *board, int k, double world[3]);

/*
 * A chessboard whose numbers of corners are both odd or both even (not 9x6) looks the same after a
 * half turn. board_find() then assumes that its rows run to the right in the picture. That is
 * enough for a lens, but the world is off by a half turn if the board lies the other way round.
 */

/* Whether the board is black at a place in its own axes; else paper. */
bool board_ink(const struct board *board, double x_mm, double y_mm);

/*
 * Finds the board in an 8-bit picture and adds its points as a view called name; points are named
 * by column and row, the first being 1,1. Either all points are found or none; of ChArUco six or
 * more suffice. Boards seen
 * from behind or in a mirror are not found: pictures must be upright.
 *
 * Returns 0; -ENOENT: no such board (the fault says what was found instead, if known); -ERANGE:
 * another size than the pictures before; -ENOMEM. On failure nothing is added.
 */
int board_find(const struct board *board, const struct image *picture, const char *name,
	       struct observations *all, struct fault *fault);

/* Checks the name of a page: "a4", "a3", "letter". -EINVAL. */
int board_page_check(const char *page, struct fault *fault);

/* Writes a PDF of one page: the board at its true size, its name, and a ruler to check the printer.
 * -E2BIG: it does not fit on the page, the fault says what would; -EINVAL: no such page; -ENOMEM;
 * or the error of writing the file. */
int board_print(const struct board *board, const char *page, const char *path, struct fault *fault);

#endif
