/* SPDX-License-Identifier: MIT */
/*
 * The edge of a person, cell by cell. A cell C beside the edge mixes a person's colour F with the
 * place's, B: by least squares over the channels, each over its variance, its share is
 *
 *     alpha = <C - B, F - B> / <F - B, F - B>
 *
 * F is the mean of the person's cells around, B the place in the light of the cells around that are
 * not a person's. From a half on the cell is the person's.
 */
#include <string.h>

#include "hal/people/people_parts.h"

#define AROUND 2 /* cells on each side */
#define PASSES 2 /* cells by which an edge may move */

/* Sums over the cells around one. */
struct sides {
	float person[3], seen[3], place[3];
	int people, others;
};

static void add_cell(const struct people *p, int at, struct sides *sides)
{
	const bool person = p->raw[at] == VERDICT_PERSON;

	for (int c = 0; c < 3; c++) {
		if (person) {
			sides->person[c] += p->seen[c][at];
		} else {
			sides->seen[c] += p->seen[c][at];
			sides->place[c] += p->place[c][at];
		}
	}
	sides->people += person;
	sides->others += !person;
}

/* Whether all four neighbours are as the cell. */
static bool is_inner(const struct people *p, int x, int y)
{
	const int at = y * p->across + x;
	const bool person = p->raw[at] == VERDICT_PERSON;

	return x > 0 && y > 0 && x < p->across - 1 && y < p->down - 1 &&
	       (p->raw[at - 1] == VERDICT_PERSON) == person &&
	       (p->raw[at + 1] == VERDICT_PERSON) == person &&
	       (p->raw[at - p->across] == VERDICT_PERSON) == person &&
	       (p->raw[at + p->across] == VERDICT_PERSON) == person;
}

/* What is around a cell, of cells that do not touch the edge. */
static struct sides look_around(const struct people *p, int x, int y)
{
	struct sides sides = {.people = 0};

	for (int v = y - AROUND; v <= y + AROUND; v++)
		for (int u = x - AROUND; u <= x + AROUND; u++) {
			const int at = v * p->across + u;

			if (u >= 0 && v >= 0 && u < p->across && v < p->down && p->watch[at] &&
			    p->known[at] && (u != x || v != y) && is_inner(p, u, v))
				add_cell(p, at, &sides);
		}
	return sides;
}

/* A cell beside the edge; stays what it is where one side is not seen around it. */
static bool is_person(const struct people *p, int x, int y)
{
	const int at = y * p->across + x;
	const struct sides sides = look_around(p, x, y);
	float along = 0, whole = 0;

	if (!sides.people || !sides.others || !p->known[at])
		return p->raw[at] == VERDICT_PERSON;
	for (int c = 0; c < 3; c++) {
		const float ratio = sides.place[c] > 0 ? sides.seen[c] / sides.place[c] : 1;
		const float place = ratio * p->place[c][at];
		const float apart = sides.person[c] / (float)sides.people - place;
		const float weight = 1 / (p->still[c] + p->shot[c] * place);

		along += weight * apart * (p->seen[c][at] - place);
		whole += weight * apart * apart;
	}
	return along > 0.5f * whole;
}

static void refine_row(struct people *p, int y)
{
	for (int x = p->box.left; x <= p->box.right; x++) {
		const int at = y * p->across + x;

		if (!p->watch[at] || is_inner(p, x, y))
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
		for (int y = box->top; y <= box->bottom; y++)
			refine_row(p, y);
	}
}
