/* SPDX-License-Identifier: MIT */
/*
 * The edge of a person. A cell or pixel C beside the edge mixes a person's colour F with the place's,
 * B: by least squares over the channels, each over its variance, its share is
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

static void add_cell(const struct people *p, bool person, int at, struct sides *sides)
{
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
static bool is_inner(const struct people *p, const uint8_t *verdict, int x, int y)
{
	const int at = y * p->across + x;
	const bool person = verdict[at] == VERDICT_PERSON;

	return x > 0 && y > 0 && x < p->across - 1 && y < p->down - 1 &&
	       (verdict[at - 1] == VERDICT_PERSON) == person &&
	       (verdict[at + 1] == VERDICT_PERSON) == person &&
	       (verdict[at - p->across] == VERDICT_PERSON) == person &&
	       (verdict[at + p->across] == VERDICT_PERSON) == person;
}

struct sides edges_around(const struct people *p, const uint8_t *verdict, int x, int y)
{
	struct sides sides = {.people = 0};

	for (int v = y - AROUND; v <= y + AROUND; v++)
		for (int u = x - AROUND; u <= x + AROUND; u++) {
			const int at = v * p->across + u;

			if (u >= 0 && v >= 0 && u < p->across && v < p->down && p->watch[at] &&
			    p->known[at] && (u != x || v != y) && is_inner(p, verdict, u, v))
				add_cell(p, verdict[at] == VERDICT_PERSON, at, &sides);
		}
	return sides;
}

float edges_light(const struct sides *sides, int c)
{
	return sides->place[c] > 0 ? sides->seen[c] / sides->place[c] : 1;
}

float edges_share(const struct people *p, const struct sides *sides, const float seen[3],
		  const float place[3])
{
	float along = 0, whole = 0;

	for (int c = 0; c < 3; c++) {
		const float apart = sides->person[c] / (float)sides->people - place[c];
		const float weight = 1 / (p->still[c] + p->shot[c] * place[c]);

		along += weight * apart * (seen[c] - place[c]);
		whole += weight * apart * apart;
	}
	return whole > 0 ? along / whole : 0;
}

/* A cell beside the edge; stays what it is where one side is not seen around it. */
static bool is_person(const struct people *p, int x, int y)
{
	const int at = y * p->across + x;
	const struct sides sides = edges_around(p, p->raw, x, y);
	float seen[3], place[3];

	if (!sides.people || !sides.others || !p->known[at])
		return p->raw[at] == VERDICT_PERSON;
	for (int c = 0; c < 3; c++) {
		seen[c] = p->seen[c][at];
		place[c] = edges_light(&sides, c) * p->place[c][at];
	}
	return edges_share(p, &sides, seen, place) > 0.5f;
}

static void refine_row(struct people *p, int y)
{
	for (int x = p->box.left; x <= p->box.right; x++) {
		const int at = y * p->across + x;

		if (!p->watch[at] || is_inner(p, p->raw, x, y))
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
