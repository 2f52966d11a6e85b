/* SPDX-License-Identifier: MIT */
#include "bake/calibrate/observe/boards.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "bake/calibrate/observe/boards_parts.h"
#include "hal/base/number.h"

#define SIDE_MIN 3
#define STEP_MIN_MM 0.1
#define STEP_MAX_MM 1000.0
#define EXPECTED "expected a board such as 9x6:25mm, chess:9x6:25mm or charuco:8x6:30mm:22mm"
#define EXPECTED_MARKERS                                                                           \
	"expected markers of 4x4, 5x5, 6x6, 7x7, original, apriltag_16h5, apriltag_25h9, "         \
	"apriltag_36h10 or apriltag_36h11, or legacy"

const char *const board_kind_names[] = {"chess", "charuco", NULL};

_Static_assert(sizeof(board_kind_names) / sizeof(board_kind_names[0]) == BOARD_KIND_COUNT + 1,
	       "a name for each kind");

/* ---- in words ---- */

static bool take_kind(const char **text, enum board_kind *kind)
{
	*kind = BOARD_CHESS;
	if (**text >= '0' && **text <= '9')
		return true;
	for (int i = 0; board_kind_names[i]; i++) {
		const size_t length = strlen(board_kind_names[i]);

		if (strncmp(*text, board_kind_names[i], length) || (*text)[length] != ':')
			continue;
		*kind = (enum board_kind)i;
		*text += length + 1;
		return true;
	}
	return false;
}

static bool take_side(const char **text, char follows, int *side)
{
	char *end;
	long number;

	if (**text < '0' || **text > '9')
		return false;
	number = strtol(*text, &end, 10);
	if (*end != follows || number < SIDE_MIN || number > BOARD_SIDE_MAX)
		return false;
	*side = (int)number;
	*text = end + 1;
	return true;
}

/* Parses "25mm"; the text goes on with a colon or ends. */
static bool take_length(const char **text, double *mm)
{
	const char *end = *text;

	if (*end < '0' || *end > '9' || number_read(&end, mm))
		return false;
	if (strncmp(end, "mm", 2) || (end[2] && end[2] != ':') || !(*mm >= STEP_MIN_MM) ||
	    !(*mm <= STEP_MAX_MM))
		return false;
	*text = end + 2 + (end[2] == ':');
	return true;
}

/* Parses the rest of a dictionary's name, "" or "_250"; 0: it is none. */
static int markers_named(const char *rest, size_t length, int all)
{
	static const int sizes[] = {50, 100, 250, 1000};

	if (!length)
		return all;
	for (size_t i = 0; i < sizeof(sizes) / sizeof(sizes[0]); i++) {
		char size[8];

		if (length == (size_t)snprintf(size, sizeof(size), "_%d", sizes[i]) &&
		    !strncmp(rest, size, length))
			return sizes[i];
	}
	return 0;
}

/* Parses "6x6", "DICT_6X6_250" or "aruco_original". Returns how many markers it names; 0: none. */
static int take_dictionary(const char *word, size_t length, int *dictionary)
{
	static const char *const before[] = {"dict_", "aruco_"};

	for (size_t i = 0; i < sizeof(before) / sizeof(before[0]); i++) {
		const size_t skip = strlen(before[i]);

		if (length > skip && !strncasecmp(word, before[i], skip)) {
			word += skip;
			length -= skip;
		}
	}
	for (int d = 0; d < BOARD_DICTIONARIES; d++) {
		const char *name = marker_sets[d].name;
		const size_t own = strlen(name);

		if (length < own || strncasecmp(word, name, own))
			continue;
		*dictionary = d;
		if (d >= BOARD_ORIGINAL)
			return length == own ? marker_sets[d].markers : 0;
		return markers_named(word + own, length - own, marker_sets[d].markers);
	}
	return 0;
}

/* Parses the words after a ChArUco board's marker: a dictionary, "legacy". */
static int take_words(struct board *board, const char *text, const char *at, struct fault *fault)
{
	while (*at) {
		const size_t length = strcspn(at, ":");
		int markers;

		if (length == strlen("legacy") && !strncasecmp(at, "legacy", length)) {
			board->legacy = true;
		} else {
			markers = take_dictionary(at, length, &board->dictionary);
			if (!markers)
				return fault_say(fault, -EINVAL, "\"%s\": " EXPECTED_MARKERS, text);
			if (markers < board_markers(board))
				return fault_say(
					fault, -EINVAL,
					"\"%s\": %d markers, expected a dictionary that has as many as the board, %d",
					text, markers, board_markers(board));
		}
		at += length + (at[length] == ':');
	}
	return 0;
}

int board_parse(struct board *board, const char *text, struct fault *fault)
{
	const char *at = text;
	bool right;

	*board = (struct board){.rotation = {1, 0, 0, 0, -1, 0, 0, 0, -1}, .unit = 0.001};
	right = take_kind(&at, &board->kind) && take_side(&at, 'x', &board->columns) &&
		take_side(&at, ':', &board->rows) && take_length(&at, &board->step_mm);
	if (right && board->kind == BOARD_CHARUCO)
		right = take_length(&at, &board->marker_mm);
	if (!right || (*at && board->kind != BOARD_CHARUCO) || text[strlen(text) - 1] == ':')
		return fault_say(fault, -EINVAL,
				 "\"%s\": " EXPECTED " (sides %d to %d, lengths %g to %g mm)", text,
				 SIDE_MIN, BOARD_SIDE_MAX, STEP_MIN_MM, STEP_MAX_MM);
	if (board->kind == BOARD_CHARUCO && board->marker_mm >= board->step_mm)
		return fault_say(fault, -EINVAL,
				 "\"%s\": expected markers smaller than the squares of %g mm", text,
				 board->step_mm);
	return take_words(board, text, at, fault);
}

void board_name(const struct board *board, char text[BOARD_NAME_MAX])
{
	int length = snprintf(text, BOARD_NAME_MAX, "%s:%dx%d:%.10gmm",
			      board_kind_names[board->kind], board->columns, board->rows,
			      board->step_mm);

	if (board->kind != BOARD_CHARUCO)
		return;
	length += snprintf(text + length, (size_t)(BOARD_NAME_MAX - length), ":%.10gmm",
			   board->marker_mm);
	snprintf(text + length, (size_t)(BOARD_NAME_MAX - length), "%s%s%s",
		 board->dictionary > 0 ? ":" : "",
		 board->dictionary > 0 ? marker_sets[board->dictionary].name : "",
		 board->legacy ? ":legacy" : "");
}

/* ---- points ---- */

int board_columns(const struct board *board)
{
	return board->kind == BOARD_CHARUCO ? board->columns - 1 : board->columns;
}

int board_points(const struct board *board)
{
	const int rows = board->kind == BOARD_CHARUCO ? board->rows - 1 : board->rows;

	return board_columns(board) * rows;
}

void board_place(const struct board *board, int k, double mm[2])
{
	const int column = k % board_columns(board), row = k / board_columns(board);

	mm[0] = board->step_mm * column;
	mm[1] = board->step_mm * row;
}

void board_point(const struct board *board, int k, double world[3])
{
	double mm[2];

	board_place(board, k, mm);
	for (int i = 0; i < 3; i++)
		world[i] = board->unit * (board->rotation[3 * i] * mm[0] +
					  board->rotation[3 * i + 1] * mm[1]) +
			   board->position[i];
}

/* ---- what is printed ---- */

/* 1: a white square is at the upper left; 0: a black one. Rows begin with either in turn. */
static int first_square(const struct board *board)
{
	return board->kind == BOARD_CHARUCO && board->legacy && board->rows % 2 == 0;
}

int board_marker_at(const struct board *board, int column, int row)
{
	const int before = row * board->columns + column, first = first_square(board);

	if ((column + row + first) % 2 == 0)
		return -1;
	return board->columns % 2 ? (before + first) / 2 : row * (board->columns / 2) + column / 2;
}

int board_markers(const struct board *board)
{
	return (board->columns * board->rows + first_square(board)) / 2;
}

/* x, y: from the upper left corner of the marker's square, 0..1. */
static bool marker_ink(const struct board *board, int marker, double x, double y)
{
	const double side = board->marker_mm / board->step_mm;
	const int bits = marker_sets[board->dictionary].bits;
	const int column = (int)floor((x - (1 - side) / 2) / side * (bits + 2)) - 1;
	const int row = (int)floor((y - (1 - side) / 2) / side * (bits + 2)) - 1;

	if (column < -1 || row < -1 || column > bits || row > bits)
		return false;
	if (column < 0 || row < 0 || column == bits || row == bits)
		return true;
	return !board_marker_bit(board->dictionary, marker, column, row);
}

bool board_ink(const struct board *board, double x_mm, double y_mm)
{
	const double x = x_mm / board->step_mm + 1, y = y_mm / board->step_mm + 1;
	/* a chessboard has one square more than corners a side */
	const int more = board->kind == BOARD_CHESS;
	const int column = (int)floor(x), row = (int)floor(y);

	if (column < 0 || row < 0 || column >= board->columns + more || row >= board->rows + more)
		return false;
	if ((column + row + first_square(board)) % 2 == 0)
		return true;
	return board->kind == BOARD_CHARUCO &&
	       marker_ink(board, board_marker_at(board, column, row), x - column, y - row);
}
