/* SPDX-License-Identifier: MIT */
/* Connected groups of cells that are people's; and what is taken for people and is nobody. */
#include <math.h>
#include <string.h>

#include "hal/people/people_parts.h"

#define HAND 40		 /* a group of fewer than (cells down / HAND)^2 cells is dropped */
#define GHOST_SHARE 0.5	 /* contrast along a ghost's outline, over that of the place */
#define LIGHT_SHARE 0.1	 /* edge of its own along the outline of mere light, over the level there */
#define CROWDED 0.7	 /* of the watched cells: the camera has been moved */
#define CROWDED_MS 900e3 /* longer than visitors stand so near that they hide everything */

/* ---- connected cells ---- */

static int run_root(struct run *runs, int n)
{
	while (runs[n].parent != n) {
		runs[n].parent = runs[runs[n].parent].parent;
		n = runs[n].parent;
	}
	return n;
}

static void run_join(struct run *runs, int a, int b)
{
	a = run_root(runs, a);
	b = run_root(runs, b);
	if (a < b)
		runs[b].parent = a;
	else
		runs[a].parent = b;
}

/* Joins the runs of a row, first..end - 1, with those of the row above, from..first - 1, that they
 * touch, if only by a corner. */
static void join_rows(struct run *runs, int from, int first, int end)
{
	int above = from;

	for (int n = first; n < end; n++) {
		while (above < first && runs[above].right + 1 < runs[n].left)
			above++;
		for (int a = above; a < first && runs[a].left <= runs[n].right + 1; a++)
			run_join(runs, a, n);
	}
}

/* Finds the runs of watched cells in the box that are people, and joins them; label becomes the
 * run. */
static void find_runs(struct people *p)
{
	const struct box *box = &p->verdict.box;
	int from = 0, first = 0, count = 0;

	for (int y = box->top; y <= box->bottom; y++) {
		const int row = y * p->cells.across;

		for (int x = box->left; x <= box->right; x++) {
			const bool is = p->cells.watch[row + x] &&
					p->verdict.of[row + x] == WHOSE_PERSON;
			const bool goes_on = is && count > first &&
					     p->crowd.runs[count - 1].right == x - 1;

			p->crowd.label[row + x] = -1;
			if (!is)
				continue;
			if (!goes_on) {
				p->crowd.runs[count] = (struct run){y, x, x, count};
				count++;
			}
			p->crowd.runs[count - 1].right = x;
			p->crowd.label[row + x] = count - 1;
		}
		join_rows(p->crowd.runs, from, first, count);
		from = first;
		first = count;
	}
	p->crowd.run_count = count;
}

/* Numbers the groups and measures them; label becomes the group. */
static void measure_groups(struct people *p)
{
	p->crowd.group_count = 0;
	for (int n = 0; n < p->crowd.run_count; n++) {
		const struct run *run = &p->crowd.runs[n];
		const int root = run_root(p->crowd.runs, n);
		struct group *g;
		int number;

		if (root == n)
			p->crowd.groups[p->crowd.group_count++] =
				(struct group){.left = p->cells.across, .top = run->y};
		number = root == n ? p->crowd.group_count - 1
				   : p->crowd.label[p->crowd.runs[root].y * p->cells.across +
						    p->crowd.runs[root].left];
		g = &p->crowd.groups[number];
		for (int x = run->left; x <= run->right; x++)
			p->crowd.label[run->y * p->cells.across + x] = number;
		g->cells += run->right - run->left + 1;
		g->left = run->left < g->left ? run->left : g->left;
		g->right = run->right > g->right ? run->right : g->right;
		g->bottom = run->y;
	}
}

/* ---- ghosts ---- */

/* Contrast between a cell and its neighbour, in what is seen and in the place, and what is seen of
 * it that the place in the cell's own light does not explain. */
static void add_edge(const struct people *p, struct group *g, int at, int other)
{
	if (!p->place.known[other])
		return;
	for (int c = 0; c < 3; c++) {
		const float *seen = p->cells.seen[c], *place = p->place.expected[c];

		g->edge_now += (double)fabsf(seen[at] - seen[other]);
		g->edge_place += (double)fabsf(place[at] - place[other]);
		g->edge_own +=
			(double)fabsf(seen[other] - place[other] * seen[at] / (place[at] + 1));
		g->edge_level += (double)seen[other];
	}
}

static int label_at(const struct people *p, int x, int y)
{
	const struct box *box = &p->verdict.box;

	return x < box->left || x > box->right || y < box->top || y > box->bottom
		       ? -1
		       : p->crowd.label[y * p->cells.across + x];
}

/* A ghost is where the place was learned while somebody stood there: the place has an edge along
 * the group's outline, and what is seen has none. Light has no edge of its own: what is seen goes
 * on there as the place does. */
static void measure_edges(struct people *p)
{
	const struct box *box = &p->verdict.box;

	for (int y = box->top; y <= box->bottom; y++)
		for (int x = box->left; x <= box->right; x++) {
			const int at = y * p->cells.across + x, own = p->crowd.label[at];

			if (own < 0)
				continue;
			for (int n = 0; n < 4; n++) {
				const int u = x + (n == 0) - (n == 1), v = y + (n == 2) - (n == 3);
				const int next = v * p->cells.across + u;

				if (u >= 0 && v >= 0 && u < p->cells.across && v < p->cells.down &&
				    p->cells.watch[next] && label_at(p, u, v) != own)
					add_edge(p, &p->crowd.groups[own], at, next);
			}
		}
}

static void drop_nobody(struct people *p)
{
	const int least = (p->cells.down / HAND + 1) * (p->cells.down / HAND + 1);

	for (int n = 0; n < p->crowd.group_count; n++) {
		struct group *g = &p->crowd.groups[n];

		g->ghost = g->edge_now < GHOST_SHARE * g->edge_place;
		g->dropped = g->cells < least || g->ghost ||
			     g->edge_own < LIGHT_SHARE * g->edge_level;
	}
}

/* A ghost's cells become the empty place, and those of other dropped groups nobody's. */
static int clear_dropped(struct people *p)
{
	const struct box *box = &p->verdict.box;
	int people = 0;

	for (int y = box->top; y <= box->bottom; y++)
		for (int x = box->left; x <= box->right; x++) {
			const int at = y * p->cells.across + x;
			const struct group *g;

			if (p->crowd.label[at] < 0)
				continue;
			g = &p->crowd.groups[p->crowd.label[at]];
			people += !g->dropped;
			if (!g->dropped)
				continue;
			p->crowd.label[at] = -1;
			p->verdict.of[at] = WHOSE_SHADOW; /* which teaches nothing */
			if (g->ghost)
				place_adopt(p, at);
		}
	return people;
}

/* ---- all of it ---- */

void groups_find(struct people *p)
{
	const struct box *box = &p->verdict.box;
	int people;

	p->crowd.group_count = 0;
	if (box->right < 0) {
		p->crowd.crowded_ms = 0;
		return;
	}
	edges_refine(p);
	find_runs(p);
	measure_groups(p);
	measure_edges(p);
	drop_nobody(p);
	people = clear_dropped(p);
	p->visited = people > 0;
	p->crowd.crowded_ms = people > CROWDED * p->cells.watched ? p->crowd.crowded_ms + p->step_ms
								  : 0;
	if (p->crowd.crowded_ms > CROWDED_MS) {
		place_forget(p);
		p->crowd.crowded_ms = 0;
		p->crowd.group_count = 0;
		p->visited = false;
	}
}

void groups_order(struct people *p)
{
	const struct box *box = &p->verdict.box;

	uint8_t order[PERSONS_MAX];
	const bool sure = (double)p->nudge.sure >= PEOPLE_SURE_LEAST;

	memset(p->crowd.order, 0, (size_t)p->cells.count);
	if (!p->visited)
		return;
	for (int n = 0; n < p->crowd.persons; n++) {
		const struct person *who = &p->crowd.person[n];

		order[n] = !sure && !who->walked ? 0 : who->front ? 2 : 1;
	}
	for (int y = box->top; y <= box->bottom; y++)
		for (int x = box->left; x <= box->right; x++) {
			const int at = y * p->cells.across + x, person = p->crowd.label[at];

			if (person >= 0)
				p->crowd.order[at] = order[person];
		}
}
