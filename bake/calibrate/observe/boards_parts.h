/* SPDX-License-Identifier: MIT */
/* What the files of boards share. Private to boards*; plain C, so that no OpenCV is seen here. */
#ifndef INLAY_BAKE_CALIBRATE_OBSERVE_BOARDS_PARTS_H
#define INLAY_BAKE_CALIBRATE_OBSERVE_BOARDS_PARTS_H

#include <stdbool.h>

#include "bake/calibrate/observe/boards.h"

#define BOARD_POINTS_MAX (BOARD_SIDE_MAX * BOARD_SIDE_MAX)
#define BOARD_MARKER_BITS 5 /* a side, without the black rim of one bit around them */

/* A circle's radius in steps. */
#define BOARD_CIRCLE_RADIUS 0.25

/* Points in a row; those of a ChArUco board lie between its squares. */
int board_columns(const struct board *board);

/* Place of point k in the board's own axes, mm. */
void board_place(const struct board *board, int k, double mm[2]);

/* Number of the marker in the square at this column and row; -1: it is black. */
int board_marker_at(const struct board *board, int column, int row);

/* Whether bit (column, row) of a marker is white. */
bool board_marker_bit(int marker, int column, int row);

/*
 * Looks for the board. px[board_points()] in our pixels, seen[] which of them were found. 0;
 * -ENOENT with a fault that begins after the picture's name; -ENOMEM.
 */
int board_look(const struct board *board, const struct image *picture, double (*px)[2], bool *seen,
	       struct fault *fault);

#endif
