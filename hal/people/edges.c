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
static void mark_row(const struct people *p, const uint8_t *verdict, int y, int x, int end)
{
	const int row = y * p->across;
	const uint8_t *own = verdict + row, *above = own - p->across, *below = own + p->across;
	const uint8_t *watch = p->watch + row, *known = p->known + row;
	uint8_t *restrict side = p->side_of + row;

	for (; x < end; x++) {
		const uint8_t person = own[x] == VERDICT_PERSON;
		const int alike = ((own[x - 1] == VERDICT_PERSON) == person) &
				  ((own[x + 1] == VERDICT_PERSON) == person) &
				  ((above[x] == VERDICT_PERSON) == person) &
				  ((below[x] == VERDICT_PERSON) == person);

		side[x] = (uint8_t)((alike & (watch[x] != 0) & (known[x] != 0))
					    ? SIDE_OTHER + person
					    : SIDE_NONE);
	}
}

void edges_mark(struct people *p, const uint8_t *verdict)
{
	const int reach = AROUND + 1; /* cells beside the box are asked for those around them */
	const int left = p->box.left - reach, end = p->box.right + reach + 1;
	const int bottom = p->box.bottom + reach;

	for (int y = p->box.top - reach; y <= bottom; y++)
		if (y > 0 && y < p->down - 1)
			mark_row(p, verdict, y, left > 1 ? left : 1,
				 end < p->across - 1 ? end : p->across - 1);
}

struct sides edges_around(const struct people *p, int x, int y)
{
	float person[3] = {0}, seen[3] = {0}, place[3] = {0};
	int people = 0, others = 0;
	struct sides sides;

	for (int v = y - AROUND; v <= y + AROUND; v++)
		for (int u = x - AROUND; u <= x + AROUND; u++) {
			const int at = v * p->across + u;

			/* Those at the picture's edge are never marked. */
			if (u < 0 || v < 0 || u >= p->across || v >= p->down ||
			    p->side_of[at] == SIDE_NONE || (u == x && v == y))
				continue;
			if (p->side_of[at] == SIDE_PERSON) {
				people++;
				for (int c = 0; c < 3; c++)
					person[c] += p->seen[c][at];
				continue;
			}
			others++;
			for (int c = 0; c < 3; c++) {
				seen[c] += p->seen[c][at];
				place[c] += p->place[c][at];
			}
		}
	sides.told = people && others;
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
		const float person = sides->person[c], still = p->still[c], shot = p->shot[c];

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
	const int at = y * p->across + x;
	const struct sides sides = edges_around(p, x, y);
	float seen[3][PIXEL_LANES] = {{0}}, place[3][PIXEL_LANES] = {{0}}, share[PIXEL_LANES];

	if (!sides.told || !p->known[at])
		return p->raw[at] == VERDICT_PERSON;
	for (int c = 0; c < 3; c++) {
		seen[c][0] = p->seen[c][at];
		place[c][0] = sides.light[c] * p->place[c][at];
	}
	edges_share(p, &sides, seen, place, share);
	return share[0] > 0.5f;
}

static void refine_row(struct people *p, int y)
{
	for (int x = p->box.left; x <= p->box.right; x++) {
		const int at = y * p->across + x;

		if (!p->watch[at] || p->side_of[at] != SIDE_NONE)
			continue;
		if (is_person(p, x, y))
			p->verdict[at] = VERDICT_PERSON;
		else if (p->raw[at] == VERDICT_PERSON)
			p->verdict[at] = VERDICT_SHADED;
	}
}

void edges_refine(struct people *p)
{
	const struct box *box = &p->box;
	/* The rows beside the box are asked about. */
	const int begin = box->top > 0 ? box->top - 1 : 0;
	const int end = box->bottom + 2 < p->down ? box->bottom + 2 : p->down;

	for (int pass = 0; pass < PASSES; pass++) {
		memcpy(p->raw + begin * p->across, p->verdict + begin * p->across,
		       (size_t)(end - begin) * (size_t)p->across);
		edges_mark(p, p->raw);
		for (int y = box->top; y <= box->bottom; y++)
			refine_row(p, y);
	}
}
