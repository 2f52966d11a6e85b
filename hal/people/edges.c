/* SPDX-License-Identifier: MIT */
/*
 * The edge of a person. A cell or pixel C beside the edge mixes a person's colour F with the
 * place's, B: by least squares over the channels, each over its variance, its share is
 *
 *     alpha = <C - B, F - B> / <F - B, F - B>
 *
 * F is the mean of the person's cells around, B the place in the light of the cells around that are
 * not a person's. From a half on a cell is the person's.
 */
#include <string.h>

#include "hal/people/people_parts.h"

#define AROUND 2 /* cells on each side */
#define PASSES 2 /* cells by which an edge may move */

enum { SIDE_NONE, SIDE_OTHER, SIDE_PERSON }; /* none: it touches the edge, or is not known */

/* Marks cells x..end - 1 of a row that has one above and one below, none of them at the picture's
 * edge. */
static void mark_row(const struct people *p, const uint8_t *whose, int y, int x, int end)
{
	const int row = y * p->cells.across;
	const uint8_t *own = whose + row, *above = own - p->cells.across,
		      *below = own + p->cells.across;
	const uint8_t *watch = p->cells.watch + row, *known = p->place.known + row;
	uint8_t *restrict side = p->outline.side_of + row;

	for (; x < end; x++) {
		const uint8_t person = own[x] == WHOSE_PERSON;
		const int alike = ((own[x - 1] == WHOSE_PERSON) == person) &
				  ((own[x + 1] == WHOSE_PERSON) == person) &
				  ((above[x] == WHOSE_PERSON) == person) &
				  ((below[x] == WHOSE_PERSON) == person);

		side[x] = (uint8_t)((alike & (watch[x] != 0) & (known[x] != 0))
					    ? SIDE_OTHER + person
					    : SIDE_NONE);
	}
}

void edges_mark(struct people *p, const uint8_t *whose)
{
	const int reach = AROUND + 1; /* cells beside the box are asked for those around them */
	const int left = p->verdict.box.left - reach, end = p->verdict.box.right + reach + 1;
	const int bottom = p->verdict.box.bottom + reach;

	for (int y = p->verdict.box.top - reach; y <= bottom; y++)
		if (y > 0 && y < p->cells.down - 1)
			mark_row(p, whose, y, left > 1 ? left : 1,
				 end < p->cells.across - 1 ? end : p->cells.across - 1);
}

struct sides edges_around(const struct people *p, int x, int y)
{
	float person[3] = {0}, seen[3] = {0}, place[3] = {0};
	int people = 0, others = 0;
	struct sides sides;

	for (int v = y - AROUND; v <= y + AROUND; v++)
		for (int u = x - AROUND; u <= x + AROUND; u++) {
			const int at = v * p->cells.across + u;

			/* Those at the picture's edge are never marked. */
			if (u < 0 || v < 0 || u >= p->cells.across || v >= p->cells.down ||
			    p->outline.side_of[at] == SIDE_NONE || (u == x && v == y))
				continue;
			if (p->outline.side_of[at] == SIDE_PERSON) {
				people++;
				for (int c = 0; c < 3; c++)
					person[c] += p->cells.seen[c][at];
				continue;
			}
			others++;
			for (int c = 0; c < 3; c++) {
				seen[c] += p->cells.seen[c][at];
				place[c] += p->place.expected[c][at];
			}
		}
	sides.both = people && others;
	for (int c = 0; c < 3; c++) {
		sides.person[c] = people ? person[c] / (float)people : 0;
		sides.light[c] = place[c] > 0 ? seen[c] / place[c] : 1;
	}
	return sides;
}

void edges_share(const struct people *p, const struct sides *sides,
		 const float seen[3][PIXEL_LANES], const float place[3][PIXEL_LANES],
		 float *restrict share)
{
	float along[PIXEL_LANES] = {0}, whole[PIXEL_LANES] = {0};

	for (int c = 0; c < 3; c++) {
		const float person = sides->person[c], still = p->cells.still[c],
			    shot = p->cells.shot[c];

		for (int k = 0; k < PIXEL_LANES; k++) {
			const float apart = person - place[c][k];
			const float weighted = apart / (still + shot * place[c][k]);

			along[k] += weighted * (seen[c][k] - place[c][k]);
			whole[k] += weighted * apart;
		}
	}
	for (int k = 0; k < PIXEL_LANES; k++)
		share[k] = along[k] / (whole[k] > 0 ? whole[k] : 1);
}

/* A cell beside the edge; stays what it is where one side is not seen around it. */
static bool is_person(const struct people *p, int x, int y)
{
	const int at = y * p->cells.across + x;
	const struct sides sides = edges_around(p, x, y);
	float seen[3][PIXEL_LANES] = {{0}}, place[3][PIXEL_LANES] = {{0}}, share[PIXEL_LANES];

	if (!sides.both || !p->place.known[at])
		return p->verdict.copy[at] == WHOSE_PERSON;
	for (int c = 0; c < 3; c++) {
		seen[c][0] = p->cells.seen[c][at];
		place[c][0] = sides.light[c] * p->place.expected[c][at];
	}
	edges_share(p, &sides, seen, place, share);
	return share[0] > 0.5f;
}

static void refine_row(struct people *p, int y)
{
	for (int x = p->verdict.box.left; x <= p->verdict.box.right; x++) {
		const int at = y * p->cells.across + x;

		if (!p->cells.watch[at] || p->outline.side_of[at] != SIDE_NONE)
			continue;
		if (is_person(p, x, y))
			p->verdict.of[at] = WHOSE_PERSON;
		else if (p->verdict.copy[at] == WHOSE_PERSON)
			p->verdict.of[at] = WHOSE_SHADOW;
	}
}

void edges_refine(struct people *p)
{
	const struct box *box = &p->verdict.box;
	/* The rows beside the box are asked about. */
	const int begin = box->top > 0 ? box->top - 1 : 0;
	const int end = box->bottom + 2 < p->cells.down ? box->bottom + 2 : p->cells.down;

	for (int pass = 0; pass < PASSES; pass++) {
		memcpy(p->verdict.copy + begin * p->cells.across,
		       p->verdict.of + begin * p->cells.across,
		       (size_t)(end - begin) * (size_t)p->cells.across);
		edges_mark(p, p->verdict.copy);
		for (int y = box->top; y <= box->bottom; y++)
			refine_row(p, y);
	}
}
