/* SPDX-License-Identifier: MIT */
/* Connected groups of people, and ghosts. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "hal/people/people_parts.h"

#define HAND 40		/* a group of fewer than (cells down / HAND)^2 cells is dropped */
#define HOLE 40		/* a hole of fewer than (cells down / HOLE)^2 cells is filled */
#define GHOST_SHARE 0.5 /* contrast along a ghost's outline, over that of the place */
#define LIGHT_SHARE 0.2 /* edge of its own along the outline of mere light, over the level there */
#define LOST_SHARE 0.7	/* of the watched cells: the camera has been moved */
#define LOST_MS 900e3	/* longer than visitors stand so near that they hide everything */

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

/* Joins the runs of a row, first..end - 1, with those of the row above, from..first - 1. reach: 1
 * where cells touch by their corners, too. */
static void join_rows(struct run *runs, int from, int first, int end, int reach)
{
	int above = from;

	for (int n = first; n < end; n++) {
		while (above < first && runs[above].right + reach < runs[n].left)
			above++;
		for (int a = above; a < first && runs[a].left <= runs[n].right + reach; a++)
			run_join(runs, a, n);
	}
}

/* Finds the runs of watched cells in the box that are people (or not) and joins them; label: of
 * each cell. */
static void find_runs(struct people *p, bool people, int reach)
{
	const struct box *box = &p->box;
	int from = 0, first = 0, count = 0;

	for (int y = box->top; y <= box->bottom; y++) {
		const int row = y * p->across;

		for (int x = box->left; x <= box->right; x++) {
			const bool is = p->watch[row + x] &&
					(p->verdict[row + x] == VERDICT_PERSON) == people;
			const bool goes_on = is && count > first &&
					     p->runs[count - 1].right == x - 1;

			p->label[row + x] = -1;
			if (!is)
				continue;
			if (!goes_on) {
				p->runs[count] = (struct run){y, x, x, count};
				count++;
			}
			p->runs[count - 1].right = x;
			p->label[row + x] = count - 1;
		}
		join_rows(p->runs, from, first, count, reach);
		from = first;
		first = count;
	}
	p->run_count = count;
}

/* Numbers the groups and measures them; label becomes the group. */
static void measure_groups(struct people *p)
{
	p->group_count = 0;
	for (int n = 0; n < p->run_count; n++) {
		const struct run *run = &p->runs[n];
		const int root = run_root(p->runs, n);
		struct group *g;
		int number;

		if (root == n)
			p->groups[p->group_count++] = (struct group){.left = p->across,
								     .top = run->y};
		number = root == n ? p->group_count - 1
				   : p->label[p->runs[root].y * p->across + p->runs[root].left];
		g = &p->groups[number];
		for (int x = run->left; x <= run->right; x++)
			p->label[run->y * p->across + x] = number;
		g->cells += run->right - run->left + 1;
		g->left = run->left < g->left ? run->left : g->left;
		g->right = run->right > g->right ? run->right : g->right;
		g->bottom = run->y;
		g->foot_x = 0.5 * (run->left + run->right + 1);
	}
}

/* ---- cleaning ---- */

/* Counts, in each column of three rows, the cells that are people. */
static void count_columns(const uint8_t *raw, int across, uint8_t *restrict count)
{
	const uint8_t *above = raw - across, *below = raw + across;

	for (int x = 0; x < across; x++)
		count[x] = (uint8_t)((above[x] == VERDICT_PERSON) + (raw[x] == VERDICT_PERSON) +
				     (below[x] == VERDICT_PERSON));
}

static void smooth_span(struct people *p, const struct span *span, const uint8_t *count)
{
	const int first = span->x ? span->x : 1;
	const int end = span->x + span->count < p->across ? span->x + span->count : p->across - 1;
	const uint8_t *raw = p->raw + span->y * p->across;
	uint8_t *verdict = p->verdict + span->y * p->across;

	for (int x = first; x < end; x++) {
		const int people = count[x - 1] + count[x] + count[x + 1];

		if (people >= 6)
			verdict[x] = VERDICT_PERSON;
		else if (people <= 2 && raw[x] == VERDICT_PERSON)
			verdict[x] = VERDICT_EMPTY;
	}
}

static void grow_box(struct box *box, const struct span *span, const uint8_t *verdict)
{
	for (int x = span->x; x < span->x + span->count; x++) {
		if (verdict[x] != VERDICT_PERSON)
			continue;
		box->left = x < box->left ? x : box->left;
		box->right = x > box->right ? x : box->right;
		box->top = span->y < box->top ? span->y : box->top;
		box->bottom = span->y;
	}
}

/* Whether a cell of three rows differs from the place, or there are no three. */
static bool may_hold_people(const struct people *p, int y)
{
	const int *last = p->last_differs;

	return y == 0 || y == p->down - 1 || (last[y - 1] & last[y] & last[y + 1]) >= 0;
}

/* A cell becomes what most of the nine around it are; the picture's first and last rows stay. Finds
 * the box of those that are people. */
static void smooth(struct people *p)
{
	p->box = (struct box){p->across, -1, p->down, -1};
	memcpy(p->raw, p->verdict, (size_t)p->cells);
	for (int y = 0; y < p->down; y++) {
		const bool inner = y > 0 && y < p->down - 1;

		if (!may_hold_people(p, y))
			continue;
		if (inner)
			count_columns(p->raw + y * p->across, p->across, p->count);
		for (int s = p->row_span[y]; s < p->row_span[y + 1]; s++) {
			if (inner)
				smooth_span(p, &p->spans[s], p->count);
			grow_box(&p->box, &p->spans[s], p->verdict + y * p->across);
		}
	}
}

/* Fills holes that are small and do not reach the edge of the box, or of what is watched. */
static void fill_holes(struct people *p)
{
	const int most = (p->down / HOLE) * (p->down / HOLE);
	const struct box *box = &p->box;

	find_runs(p, false, 0);
	measure_groups(p);
	for (int y = box->top; y <= box->bottom; y++)
		for (int x = box->left; x <= box->right; x++) {
			const int at = y * p->across + x;
			const bool edge = y == box->top || y == box->bottom || x == box->left ||
					  x == box->right || !p->watch[at - 1] ||
					  !p->watch[at + 1] || !p->watch[at - p->across] ||
					  !p->watch[at + p->across];

			if (edge && p->label[at] >= 0)
				p->groups[p->label[at]].cells += most;
		}
	for (int y = box->top; y <= box->bottom; y++)
		for (int x = box->left; x <= box->right; x++) {
			const int at = y * p->across + x;

			if (p->label[at] >= 0 && p->groups[p->label[at]].cells < most)
				p->verdict[at] = VERDICT_PERSON;
		}
}

/* ---- ghosts ---- */

/* Contrast between a cell and its neighbour, in what is seen and in the place, and what is seen of
 * it that the place in the cell's own light does not explain. */
static void add_edge(const struct people *p, struct group *g, int at, int other)
{
	if (!p->known[other])
		return;
	for (int c = 0; c < 3; c++) {
		g->edge_now += (double)fabsf(p->seen[c][at] - p->seen[c][other]);
		g->edge_place += (double)fabsf(p->place[c][at] - p->place[c][other]);
		g->edge_own += (double)fabsf(p->seen[c][other] - p->place[c][other] *
									 p->seen[c][at] /
									 (p->place[c][at] + 1));
		g->edge_level += (double)p->seen[c][other];
	}
}

static int label_at(const struct people *p, int x, int y)
{
	const struct box *box = &p->box;

	return x < box->left || x > box->right || y < box->top || y > box->bottom
		       ? -1
		       : p->label[y * p->across + x];
}

/* A ghost is where the place was learned while somebody stood there: the place has an edge along
 * the group's outline, and what is seen has none. Light has no edge of its own: what is seen goes
 * on there as the place does. */
static void find_ghosts(struct people *p)
{
	const struct box *box = &p->box;

	for (int y = box->top; y <= box->bottom; y++)
		for (int x = box->left; x <= box->right; x++) {
			const int at = y * p->across + x, own = p->label[at];

			if (own < 0)
				continue;
			for (int n = 0; n < 4; n++) {
				const int u = x + (n == 0) - (n == 1), v = y + (n == 2) - (n == 3);
				const int next = v * p->across + u;

				if (u >= 0 && v >= 0 && u < p->across && v < p->down &&
				    p->watch[next] && label_at(p, u, v) != own)
					add_edge(p, &p->groups[own], at, next);
			}
		}
}

/* ---- all of it ---- */

static void count_before(struct people *p)
{
	const struct box *box = &p->box;

	for (int y = box->top; y <= box->bottom; y++)
		for (int x = box->left; x <= box->right; x++) {
			const int at = y * p->across + x;

			if (p->label[at] >= 0 && p->order_before[at])
				p->groups[p->label[at]].before[p->order_before[at] - 1]++;
		}
}

/* Whether a group that clothes like the ground behind them have detached from its feet has them in
 * another below: no farther down than the higher of both is high, and under half of the narrower
 * one's width at least. */
static bool stands_on(const struct group *g, const struct group *feet)
{
	const int left = g->left > feet->left ? g->left : feet->left;
	const int right = g->right < feet->right ? g->right : feet->right;
	const int wide = g->right - g->left, feet_wide = feet->right - feet->left;
	const int high = g->bottom - g->top, feet_high = feet->bottom - feet->top;

	return !feet->dropped && feet->top > g->bottom &&
	       feet->top - g->bottom <= (high > feet_high ? high : feet_high) + 1 &&
	       2 * (right - left + 1) >= (wide < feet_wide ? wide : feet_wide) + 1;
}

/* Groups are listed by their tops, so those below have their feet already when asked from the
 * end. */
static void find_feet(struct people *p)
{
	for (int n = p->group_count - 1; n >= 0; n--) {
		struct group *g = &p->groups[n];

		g->foot_y = g->bottom;
		for (int m = n + 1; m < p->group_count; m++)
			if (stands_on(g, &p->groups[m]) && p->groups[m].foot_y > g->foot_y) {
				g->foot_y = p->groups[m].foot_y;
				g->foot_x = p->groups[m].foot_x;
			}
	}
}

static void settle_groups(struct people *p)
{
	const int least = (p->down / HAND + 1) * (p->down / HAND + 1);

	for (int n = 0; n < p->group_count; n++) {
		struct group *g = &p->groups[n];

		g->ghost = g->edge_now < GHOST_SHARE * g->edge_place;
		g->dropped = g->cells < least || g->ghost ||
			     g->edge_own < LIGHT_SHARE * g->edge_level;
	}
	find_feet(p);
	for (int n = 0; n < p->group_count; n++) {
		struct group *g = &p->groups[n];

		g->front = !g->dropped && order_is_front(p, g);
		p->report.parts += !g->dropped;
		p->report.in_front += g->front;
	}
}

/* Writes the order of each cell; a ghost's cells become the empty place, small groups nothing. */
static int write_order(struct people *p)
{
	const struct box *box = &p->box;
	int people = 0;

	memset(p->order, 0, (size_t)p->cells);
	for (int y = box->top; y <= box->bottom; y++)
		for (int x = box->left; x <= box->right; x++) {
			const int at = y * p->across + x;
			const struct group *g = p->label[at] < 0 ? NULL : &p->groups[p->label[at]];

			if (!g)
				continue;
			p->order[at] = g->dropped ? 0 : g->front ? 2 : 1;
			people += !g->dropped;
			if (g->ghost)
				place_adopt(p, at);
			else if (g->dropped)
				p->verdict[at] = VERDICT_EMPTY;
		}
	return people;
}

void groups_find(struct people *p)
{
	uint8_t *before = p->order_before;
	int people = 0;

	p->order_before = p->order;
	p->order = before;
	smooth(p);
	if (p->box.right >= 0) {
		fill_holes(p);
		edges_refine(p);
	}
	find_runs(p, true, 1);
	measure_groups(p);
	count_before(p);
	find_ghosts(p);
	settle_groups(p);
	people = write_order(p);
	p->visited = people > 0;
	p->still_ms = people > LOST_SHARE * p->watched ? p->still_ms + p->step_ms : 0;
	if (p->still_ms > LOST_MS) {
		place_forget(p);
		p->still_ms = 0;
		p->visited = false;
	}
}
