/* SPDX-License-Identifier: MIT */
/* Shared by boards*; private to them. Plain C, without OpenCV's types. */
#ifndef INLAY_BAKE_CALIBRATE_OBSERVE_BOARDS_PARTS_H
#define INLAY_BAKE_CALIBRATE_OBSERVE_BOARDS_PARTS_H

#include <stdbool.h>

#include "bake/calibrate/observe/boards.h"

#define BOARD_POINTS_MAX (BOARD_SIDE_MAX * BOARD_SIDE_MAX)

/* A dictionary of markers. Those of OpenCV with as many bits and fewer markers are its
 * beginning. */
struct marker_set {
	const char *name;
	int bits; /* of a side, without the black border of one bit */
	int markers;
};

enum {
	BOARD_5X5, /* unless another is named */
	BOARD_4X4,
	BOARD_6X6,
	BOARD_7X7,
	BOARD_ORIGINAL,
	BOARD_16H5,
	BOARD_25H9,
	BOARD_36H10,
	BOARD_36H11,
	BOARD_DICTIONARIES
};

extern const struct marker_set marker_sets[BOARD_DICTIONARIES];

/* Points in a row. Those of a ChArUco board are the corners between its squares. */
int board_columns(const struct board *board);

/* Position of point k in the board's own axes, mm. */
void board_place(const struct board *board, int k, double mm[2]);

/* Number of the marker in the square at this column and row; -1: the square is black. */
int board_marker_at(const struct board *board, int column, int row);

int board_markers(const struct board *board); /* number of its white squares */

/* Whether bit (column, row) of a marker is white. */
bool board_marker_bit(int dictionary, int marker, int column, int row);

/*
 * Finds the board by OpenCV. px[board_points()] are our pixels; seen[] says which points were
 * found. Returns 0; -ENOENT with a fault that
 * continues the picture's name; -ENOMEM.
 */
int board_look(const struct board *board, const struct image *picture, double (*px)[2], bool *seen,
	       struct fault *fault);

#endif
