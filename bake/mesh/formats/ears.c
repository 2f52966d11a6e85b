/* SPDX-License-Identifier: MIT */
#include "bake/mesh/formats/soup.h"

#include <errno.h>
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#define SECOND_LOOKS 16 /* a corner, at polygons that cross themselves */
#define BITS 64

/* Corners of the polygon that is left are a ring; those of a cell of the grid begin at cell[k] and
 * are cell_count[k]. */
struct ears {
	const double (*at)[2];
	int count; /* of the ring */
	int *next, *before;
	uint64_t *look; /* a bit for each corner that may have become an ear */
	int words;
	int *cell, *cell_count, *member, *place; /* place: of a corner in member */
	int side;				 /* cells in a row */
	double low[2], step[2];
};

static double twice_area(const double (*at)[2], int a, int b, int c)
{
	return (at[b][0] - at[a][0]) * (at[c][1] - at[a][1]) -
	       (at[b][1] - at[a][1]) * (at[c][0] - at[a][0]);
}

bool ears_convex(const double (*at)[2], int count)
{
	for (int k = 0; k < count; k++)
		if (twice_area(at, k, (k + 1) % count, (k + 2) % count) < 0)
			return false;
	return true;
}

/* ---- the grid ---- */

static int column_of(const struct ears *e, int axis, double at)
{
	const double column = (at - e->low[axis]) / e->step[axis];

	return column > 0 ? (int)fmin(column, e->side - 1) : 0; /* 0 also where it is none */
}

static int cell_of(const struct ears *e, int corner)
{
	return e->side * column_of(e, 1, e->at[corner][1]) + column_of(e, 0, e->at[corner][0]);
}

static void grid_fill(struct ears *e)
{
	double high[2] = {-INFINITY, -INFINITY};
	int begin = 0;

	for (int axis = 0; axis < 2; axis++) {
		e->low[axis] = INFINITY;
		for (int k = 0; k < e->count; k++) {
			e->low[axis] = fmin(e->low[axis], e->at[k][axis]);
			high[axis] = fmax(high[axis], e->at[k][axis]);
		}
		e->step[axis] = (high[axis] - e->low[axis]) / e->side;
	}
	for (int k = 0; k < e->count; k++)
		e->cell[cell_of(e, k)]++;
	for (int c = 0; c < e->side * e->side; c++) {
		const int members = e->cell[c];

		e->cell[c] = begin;
		begin += members;
	}
	for (int k = 0; k < e->count; k++) {
		const int c = cell_of(e, k);

		e->place[k] = e->cell[c] + e->cell_count[c]++;
		e->member[e->place[k]] = k;
	}
}

static void grid_remove(struct ears *e, int corner)
{
	const int c = cell_of(e, corner), last = e->member[e->cell[c] + --e->cell_count[c]];

	e->member[e->place[corner]] = last;
	e->place[last] = e->place[corner];
}

/* ---- ears ---- */

static bool same_place(const struct ears *e, int a, int b)
{
	return e->at[a][0] == e->at[b][0] && e->at[a][1] == e->at[b][1];
}

static bool stands_in(const struct ears *e, int q, const int ear[3])
{
	for (int k = 0; k < 3; k++)
		if (q == ear[k] || same_place(e, q, ear[k]))
			return false;
	for (int k = 0; k < 3; k++)
		if (twice_area(e->at, ear[k], ear[(k + 1) % 3], q) < 0)
			return false;
	return true;
}

/* The columns that a triangle may touch between two heights. Its sides are cut at both, and a
 * column more on each side makes up for rounding. */
static void find_columns(const struct ears *e, const int ear[3], double bottom, double top,
			 int column[2])
{
	double left = INFINITY, right = -INFINITY;

	for (int k = 0; k < 3; k++) {
		const double *a = e->at[ear[k]], *b = e->at[ear[(k + 1) % 3]];
		const double low = fmin(a[1], b[1]), high = fmax(a[1], b[1]);

		if (low > top || high < bottom)
			continue;
		for (int end = 0; end < 2; end++) {
			const double y = fmin(fmax(end ? top : bottom, low), high);
			const double x = b[1] != a[1]
						 ? a[0] + (b[0] - a[0]) * (y - a[1]) / (b[1] - a[1])
						 : (end ? b[0] : a[0]);

			left = fmin(left, x);
			right = fmax(right, x);
		}
	}
	column[0] = column_of(e, 0, left) - 1;
	column[1] = column_of(e, 0, right) + 1;
	column[0] = column[0] < 0 ? 0 : column[0];
	column[1] = column[1] < e->side ? column[1] : e->side - 1;
}

/* Whether no other corner lies in the triangle of a corner and its neighbours. */
static bool is_ear(const struct ears *e, int corner)
{
	const int ear[3] = {e->before[corner], corner, e->next[corner]};
	const double *a = e->at[ear[0]], *b = e->at[ear[1]], *c = e->at[ear[2]];
	int first, last;

	if (!(twice_area(e->at, ear[0], ear[1], ear[2]) > 0))
		return false;
	first = column_of(e, 1, fmin(a[1], fmin(b[1], c[1])));
	last = column_of(e, 1, fmax(a[1], fmax(b[1], c[1])));
	for (int row = first; row <= last; row++) {
		/* a row more on each side makes up for rounding */
		const double bottom = e->low[1] + (row - 1) * e->step[1];
		int column[2];

		find_columns(e, ear, bottom, bottom + 3 * e->step[1], column);
		for (int cell = e->side * row + column[0]; cell <= e->side * row + column[1];
		     cell++)
			for (int k = 0; k < e->cell_count[cell]; k++)
				if (stands_in(e, e->member[e->cell[cell] + k], ear))
					return false;
	}
	return true;
}

/* ---- the order ---- */

static void look_at(struct ears *e, int corner, bool again)
{
	const uint64_t bit = (uint64_t)1 << corner % BITS;

	if (again)
		e->look[corner / BITS] |= bit;
	else
		e->look[corner / BITS] &= ~bit;
}

/* The next corner, in the polygon's order, that is to be looked at; -1: none. */
static int next_look(const struct ears *e, int from)
{
	const uint64_t here = e->look[from / BITS] >> from % BITS;

	if (here)
		return from + __builtin_ctzll(here);
	for (int k = 1; k <= e->words; k++) {
		const int word = (from / BITS + k) % e->words;

		if (e->look[word])
			return word * BITS + __builtin_ctzll(e->look[word]);
	}
	return -1;
}

static void cut_off(struct ears *e, int corner)
{
	const int before = e->before[corner], next = e->next[corner];

	e->next[before] = next;
	e->before[next] = before;
	e->count--;
	look_at(e, corner, false);
	look_at(e, before, true);
	look_at(e, next, true);
	grid_remove(e, corner);
}

static void ears_cut_all(struct ears *e, int (*triangle)[3])
{
	int64_t looks = (int64_t)SECOND_LOOKS * e->count;
	int at = 1, made = 0;
	bool fresh = true; /* nothing has been cut off since all corners were looked at */

	for (int k = 0; k < e->count; k++)
		look_at(e, k, true);
	while (e->count >= 3) {
		const int seen = next_look(e, at);
		const int corner = seen < 0 ? at : seen;

		if (seen >= 0 && !is_ear(e, corner)) {
			look_at(e, corner, false);
			at = e->next[corner];
			continue;
		}
		if (seen < 0 && !fresh && looks > e->count) {
			looks -= e->count;
			fresh = true;
			for (int k = 0, c = at; k < e->count; k++, c = e->next[c])
				look_at(e, c, true);
			continue;
		}
		memcpy(triangle[made++], (int[]){e->before[corner], corner, e->next[corner]},
		       sizeof(*triangle));
		at = e->next[corner];
		cut_off(e, corner);
		fresh = false;
	}
}

int ears_cut(const double (*at)[2], int count, int (*triangle)[3])
{
	const int side = (int)sqrt(count / 2.0) + 1, words = (count + BITS - 1) / BITS;
	const size_t cells = (size_t)side * (size_t)side, corners = (size_t)count;
	int *numbers = calloc(2 * cells + 4 * corners, sizeof(*numbers));
	struct ears e = {.at = at, .count = count, .words = words, .side = side};
	int err = -ENOMEM;

	e.look = calloc((size_t)words, sizeof(*e.look));
	if (numbers && e.look) {
		e.cell = numbers;
		e.cell_count = e.cell + cells;
		e.member = e.cell_count + cells;
		e.place = e.member + corners;
		e.next = e.place + corners;
		e.before = e.next + corners;
		for (int k = 0; k < count; k++) {
			e.next[k] = (k + 1) % count;
			e.before[k] = (k + count - 1) % count;
		}
		grid_fill(&e);
		ears_cut_all(&e, triangle);
		err = 0;
	}
	free(numbers);
	free(e.look);
	return err;
}
