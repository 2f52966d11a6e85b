/* SPDX-License-Identifier: MIT */
#include "bake/mesh/formats/soup.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#define SECOND_LOOKS 16 /* at all corners, of a polygon that crosses itself */

/* Corners of the polygon that is left are a ring. */
struct ears {
	const double (*at)[2];
	int count; /* of the ring */
	int *next, *before;
	bool *no_ear; /* a corner was none when it was looked at, and its neighbours are the same */
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

/* Whether no other corner lies in the triangle of a corner and its neighbours. */
static bool is_ear(const struct ears *e, int corner)
{
	const int ear[3] = {e->before[corner], corner, e->next[corner]};

	if (!(twice_area(e->at, ear[0], ear[1], ear[2]) > 0))
		return false;
	for (int q = e->next[ear[2]]; q != ear[0]; q = e->next[q])
		if (stands_in(e, q, ear))
			return false;
	return true;
}

static void cut_off(struct ears *e, int corner)
{
	const int before = e->before[corner], next = e->next[corner];

	e->next[before] = next;
	e->before[next] = before;
	e->count--;
	e->no_ear[before] = e->no_ear[next] = false;
}

static void ears_cut_all(struct ears *e, int (*triangle)[3])
{
	const size_t corners = (size_t)e->count;
	int at = 1, made = 0, passed = 0, looks = SECOND_LOOKS;
	bool fresh = true; /* nothing has been cut off since all corners were looked at */

	while (e->count >= 3) {
		if (passed < e->count && (e->no_ear[at] || !is_ear(e, at))) {
			e->no_ear[at] = true;
			at = e->next[at];
			passed++;
			continue;
		}
		if (passed == e->count && !fresh && looks-- > 0) {
			memset(e->no_ear, 0, corners * sizeof(*e->no_ear));
			fresh = true;
			passed = 0;
			continue;
		}
		memcpy(triangle[made++], (int[]){e->before[at], at, e->next[at]},
		       sizeof(*triangle));
		cut_off(e, at);
		at = e->next[at];
		fresh = false;
		passed = 0;
	}
}

int ears_cut(const double (*at)[2], int count, int (*triangle)[3])
{
	const size_t corners = (size_t)count;
	struct ears e = {.at = at,
			 .count = count,
			 .next = calloc(corners, sizeof(*e.next)),
			 .before = calloc(corners, sizeof(*e.before)),
			 .no_ear = calloc(corners, sizeof(*e.no_ear))};
	const int err = e.next && e.before && e.no_ear ? 0 : -ENOMEM;

	for (int k = 0; k < count && !err; k++) {
		e.next[k] = (k + 1) % count;
		e.before[k] = (k + count - 1) % count;
	}
	if (!err)
		ears_cut_all(&e, triangle);
	free(e.next);
	free(e.before);
	free(e.no_ear);
	return err;
}
