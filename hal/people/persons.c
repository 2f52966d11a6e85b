/* SPDX-License-Identifier: MIT */
/*
 * Persons, who keep their order while they are followed. Each has a box in the picture that moves
 * on from frame to frame. A group belongs to the persons whose boxes it overlaps; a group that is
 * nobody's is new. In a group of several, each is measured up to where the nearer of two ends;
 * where two overlap, the nearer one is measured and owns the cells of both boxes, and the other
 * moves on as before.
 *
 * A person's order is that of the ground under his feet. Feet that are hidden, or cloth like the
 * floor, end a body too high: then the head, at the height that he had before, tells where he
 * stands. The order changes only when the feet have been on the other side of the object, by
 * MARGIN, for OPPOSED_MS.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "hal/people/people_parts.h"

#define MARGIN 0.015f /* of the object's distance from the camera */
#define OPPOSED_MS                                                                                 \
	250 /* two steps of a walker take a second: his feet are on the ground in turns */
#define MISSED_MS 1500 /* and not longer hidden by another */
#define BODY_M 1.7     /* of somebody whose height is not known */
#define SLENDER 0.45f  /* width of a walker over his height: shoulders, or a step */
#define LOWEST_M 0.9f  /* what is lower stands on no feet of its own, or is a child */
#define TALLEST_M 2.1f
#define SHORT 0.8f     /* of his height: his feet are hidden */
#define BESIDE 0.7f    /* of both halves: two persons who are nearer overlap */
#define STACKED 0.25f  /* of his height: how far the feet of somebody behind reach below his head */
#define FALLS 0.2f     /* of his height: a foot so much lower than expected is another person's */
#define WALKED 0.5f    /* of half his width, by which he has moved if he is more than a stain */
#define DOUBLE 0.1f    /* of his height, by which the feet of two beside each other differ */
#define WIDER 1.3f     /* than he was: arms */
#define HELD_ROWS 0.6f /* share of a frame in the foot's row: feet step */
#define HELD_SPEED 0.3f
#define HEAD 4	     /* so many times as high is what is below a head, or more */
#define BOX_SHARE 10 /* a box overlaps a group that has this part of it */

/* What is measured of a person in a frame. */
struct body {
	int left, right, top, bottom; /* right < left: nothing */
	int cells;
};

static float step_s(const struct people *p)
{
	return (float)(p->step_ms * 1e-3);
}

static void predict(struct people *p)
{
	int kept = 0;

	for (int n = 0; n < p->crowd.persons; n++) {
		struct person *who = &p->crowd.person[n];

		who->x += who->speed[0] * step_s(p);
		who->foot += who->speed[1] * step_s(p);
		who->top += who->speed[1] * step_s(p);
		who->missed_ms += (int)p->step_ms;
		who->group = -1;
		who->over_object = false;
		if (who->missed_ms <= MISSED_MS)
			p->crowd.person[kept++] = *who;
	}
	p->crowd.persons = kept;
}

static struct box box_of(const struct people *p, const struct person *who)
{
	const struct box *all = &p->verdict.box;
	const struct box box = {(int)fmaxf(who->x - who->half, (float)all->left),
				(int)fminf(who->x + who->half, (float)all->right),
				(int)fmaxf(who->top, (float)all->top),
				(int)fminf(who->foot, (float)all->bottom)};

	return box;
}

/* The group of which most lies in a person's box. */
static void find_group(struct people *p, struct person *who)
{
	const struct box box = box_of(p, who);
	int most = 0;

	for (int n = 0; n < p->crowd.group_count; n++) {
		const struct group *g = &p->crowd.groups[n];
		int cells = 0;

		if (g->dropped || g->right < box.left || g->left > box.right ||
		    g->bottom < box.top || g->top > box.bottom)
			continue;
		for (int y = box.top; y <= box.bottom; y++)
			for (int x = box.left; x <= box.right; x++)
				cells += p->crowd.label[y * p->cells.across + x] == n;
		if (cells > most) {
			most = cells;
			who->group = n;
		}
	}
	if (BOX_SHARE * most < (box.right + 1 - box.left) * (box.bottom + 1 - box.top))
		who->group = -1;
}

/* Whether a person of the same group, who was met before, stands in the same place. */
static bool is_double(const struct people *p, const struct person *who)
{
	for (const struct person *n = p->crowd.person; n < who; n++)
		if (n->group == who->group && who->group >= 0 &&
		    fabsf(n->x - who->x) < fminf(n->half, who->half) &&
		    fabsf(n->foot - who->foot) < DOUBLE * (n->foot - n->top))
			return true;
	return false;
}

/* Measures a group's cells in a box. */
static struct body measure(const struct people *p, int group, const struct box *in)
{
	const struct group *g = &p->crowd.groups[group];
	const int left = in->left > g->left ? in->left : g->left;
	const int right = in->right < g->right ? in->right : g->right;
	struct body body = {right, left - 1, g->bottom, g->top, 0};

	for (int y = in->top > g->top ? in->top : g->top; y <= in->bottom && y <= g->bottom; y++)
		for (int x = left; x <= right; x++) {
			if (p->crowd.label[y * p->cells.across + x] != group)
				continue;
			body.left = x < body.left ? x : body.left;
			body.right = x > body.right ? x : body.right;
			body.top = y < body.top ? y : body.top;
			body.bottom = y > body.bottom ? y : body.bottom;
			body.cells++;
		}
	return body;
}

/* The row of the head of somebody whose feet are in these columns and this row; 0 m: not known. */
static double head_row(const struct people *p, int left, int right, int bottom, float height_m)
{
	double direction;
	float far;

	if (!far_side_point(p, 0.5 * (left + right + 1), bottom + 1, 0, &direction, &far))
		return NAN;
	return far_side_row(p, direction, (double)far, height_m > 0 ? (double)height_m : BODY_M);
}

/* The width of a body that stands where this one does. */
static float usual_width(const struct people *p, const struct body *body)
{
	const double top = head_row(p, body->left, body->right, body->bottom, 0);

	return SLENDER *
	       (float)(top < body->bottom ? body->bottom + 1 - top : body->bottom + 1 - body->top);
}

/* ---- bodies in pieces ---- */

/* Whether a group that cloth like the ground has detached from its feet has them in another: below
 * it, or as a head is beside a shoulder; under half of the narrower one's width at least, and not
 * farther than a body is high. */
static bool stands_on(const struct people *p, const struct group *g, const struct group *feet)
{
	const int left = g->left > feet->left ? g->left : feet->left;
	const int right = g->right < feet->right ? g->right : feet->right;
	const int wide = g->right - g->left, feet_wide = feet->right - feet->left;

	return !feet->dropped &&
	       (feet->top > g->bottom || feet->bottom - g->bottom > HEAD * (g->bottom - g->top)) &&
	       2 * (right - left + 1) >= (wide < feet_wide ? wide : feet_wide) + 1 &&
	       g->bottom > head_row(p, feet->left, feet->right, feet->bottom, 0);
}

static bool is_watched(const struct people *p, int x, int y)
{
	return x >= 0 && y >= 0 && x < p->cells.across && y < p->cells.down &&
	       p->cells.watch[y * p->cells.across + x];
}

static void join_groups(struct people *p, int upper, int lower)
{
	struct group *g = &p->crowd.groups[upper], *feet = &p->crowd.groups[lower];

	for (int y = g->top; y <= g->bottom; y++)
		for (int x = g->left; x <= g->right; x++) {
			int *label = &p->crowd.label[y * p->cells.across + x];

			*label = *label == upper ? lower : *label;
		}
	feet->top = g->top < feet->top ? g->top : feet->top;
	feet->bottom = g->bottom > feet->bottom ? g->bottom : feet->bottom;
	feet->left = g->left < feet->left ? g->left : feet->left;
	feet->right = g->right > feet->right ? g->right : feet->right;
	feet->cells += g->cells;
	g->dropped = true;
}

/* Groups are listed by their tops: each is joined to the lowest that it stands on. */
static void join_bodies(struct people *p)
{
	for (int n = p->crowd.group_count - 1; n >= 0; n--) {
		int lowest = -1;

		for (int m = n + 1; m < p->crowd.group_count && !p->crowd.groups[n].dropped; m++)
			if (stands_on(p, &p->crowd.groups[n], &p->crowd.groups[m]) &&
			    (lowest < 0 ||
			     p->crowd.groups[m].bottom > p->crowd.groups[lowest].bottom))
				lowest = m;
		if (lowest >= 0)
			join_groups(p, n, lowest);
	}
}

/* ---- on the ground ---- */

/* Where a body stands: by its lower end, or by its head where that tells more. */
struct stand {
	double direction_rad;
	float far;	/* < 0: it is not known */
	float height_m; /* 0: it is not known */
};

static struct stand stand_of(const struct people *p, const struct person *who,
			     const struct body *body)
{
	const double x = 0.5 * (body->left + body->right + 1);
	const bool head = is_watched(p, (int)x, body->top - 1);
	struct stand stand = {0, -1, 0};
	float far;

	if (!far_side_point(p, x, body->bottom + 1, 0, &stand.direction_rad, &far))
		return stand;
	stand.far = far;
	if (!head)
		return stand;
	stand.height_m = (float)far_side_height(p, x, body->top, (double)far);
	if ((who->height_m > 0 && stand.height_m < SHORT * who->height_m) ||
	    stand.height_m > TALLEST_M) {
		const double height = who->height_m > 0 ? (double)who->height_m : BODY_M;

		stand.height_m = 0;
		if (far_side_point(p, x, body->top, height, &stand.direction_rad, &far))
			stand.far = far;
	}
	return stand;
}

static void find_order(struct people *p, int n, const struct body *body)
{
	struct person *who = &p->crowd.person[n];
	const struct stand stand = stand_of(p, who, body);
	const float border = far_side_at(p, (double)who->x, stand.direction_rad);
	const float lean = !who->placed ? 0 : who->front ? MARGIN : -MARGIN;
	const bool cut = body->bottom == p->cells.down - 1;
	bool front = border >= 0 && (cut || (stand.far >= 0 && stand.far < border * (1 + lean)));

	if (stand.height_m > LOWEST_M)
		who->height_m += (stand.height_m - who->height_m) *
				 (who->height_m > 0 ? stand.height_m > who->height_m ? 0.2f : 0.05f
						    : 1);
	if (!who->placed)
		who->front = front;
	who->placed = true;
	who->opposed_ms = front == who->front ? 0 : who->opposed_ms + (int)p->step_ms;
	if (who->opposed_ms > (who->over_object ? OPPOSED_MS : 0)) {
		who->front = front;
		who->opposed_ms = 0;
	}
}

/* ---- one frame ---- */

static void take_body(struct people *p, struct person *who, const struct body *body, bool alone)
{
	const float x = 0.5f * (float)(body->left + body->right + 1), s = step_s(p);
	const float foot = (float)body->bottom + 1;
	const bool is_other = foot - who->foot > FALLS * (who->foot - who->top);

	if (s > 0 && who->missed_ms > 0) {
		const float seconds = (float)who->missed_ms * 1e-3f;

		who->speed[0] += HELD_SPEED * (x - who->x) / seconds;
		who->speed[1] += HELD_SPEED * HELD_ROWS * (foot - who->foot) / seconds;
	}
	if (is_other) {
		who->placed = false;
		who->height_m = 0;
		who->foot = foot;
		who->top = (float)body->top;
		who->speed[0] = who->speed[1] = 0;
	}
	who->x = x;
	who->foot += HELD_ROWS * (foot - who->foot);
	who->missed_ms = 0;
	who->walked |= fmaxf(fabsf(x - who->began_x), fabsf(who->foot - who->began_foot)) >
		       WALKED * who->half;
	if (alone) {
		who->half = 0.5f * (float)(body->right + 1 - body->left);
		who->top = (float)body->top;
	} else {
		const double head = head_row(p, body->left, body->right, body->bottom,
					     who->height_m);

		who->top = head < who->foot - 1 ? (float)head : who->top;
	}
}

static void begin_person(struct people *p, int group)
{
	const struct group *g = &p->crowd.groups[group];
	struct person *who = &p->crowd.person[p->crowd.persons];

	if (p->crowd.persons == PERSONS_MAX)
		return;
	*who = (struct person){.x = 0.5f * (float)(g->left + g->right + 1),
			       .half = 0.5f * (float)(g->right + 1 - g->left),
			       .top = (float)g->top,
			       .foot = (float)g->bottom + 1,
			       .group = group};
	who->began_x = who->x;
	who->began_foot = who->foot;
	p->crowd.persons++;
}

enum beside {
	BESIDE_APART,
	BESIDE_LEFT,
	BESIDE_RIGHT,
	BESIDE_ABOVE,
	BESIDE_BELOW,
	BESIDE_OVERLAPS
};

/* Where another person of a group is, seen from one. */
static enum beside where_is(const struct person *who, const struct person *other)
{
	const float apart = other->x - who->x, both = BESIDE * (who->half + other->half);

	if (other->group != who->group)
		return BESIDE_APART;
	if (fabsf(apart) >= both)
		return apart > 0 ? BESIDE_RIGHT : BESIDE_LEFT;
	if (other->foot - who->top < STACKED * (who->foot - who->top))
		return BESIDE_ABOVE;
	if (who->foot - other->top < STACKED * (other->foot - other->top))
		return BESIDE_BELOW;
	return BESIDE_OVERLAPS;
}

/* Whether the second of two persons who overlap is the nearer one. */
static bool is_hidden_by(const struct people *p, int n, int m)
{
	const float own = p->crowd.person[n].foot, other = p->crowd.person[m].foot;

	return own < other || (own == other && m < n);
}

/* The column between two persons beside each other: where the nearer one ends, who hides the other
 * where they meet. */
static float edge_between(const struct person *who, const struct person *other)
{
	const struct person *nearer = who->foot > other->foot ? who : other;
	const struct person *farther = nearer == who ? other : who;
	const float edge = nearer->x + (farther->x > nearer->x ? nearer->half : -nearer->half);

	return farther->x > nearer->x ? fminf(edge, farther->x) : fmaxf(edge, farther->x);
}

/* What of a group is a person's: up to those beside him, below the feet
 * of those above him. *alone: nobody else is in the group. False: another hides him. */
static bool territory(const struct people *p, int n, struct box *own, bool *alone)
{
	const struct person *who = &p->crowd.person[n];
	const struct group *g = &p->crowd.groups[who->group];

	*own = (struct box){g->left, g->right, g->top, g->bottom};
	*alone = true;
	for (int m = 0; m < p->crowd.persons; m++) {
		const struct person *other = &p->crowd.person[m];
		const enum beside where = m == n ? BESIDE_APART : where_is(who, other);
		const int between = (int)edge_between(who, other);

		*alone &= where == BESIDE_APART;
		if (where == BESIDE_OVERLAPS && is_hidden_by(p, n, m))
			return false;
		if (where == BESIDE_OVERLAPS) {
			own->left = (int)fmaxf((float)own->left, who->x - WIDER * who->half);
			own->right = (int)fminf((float)own->right, who->x + WIDER * who->half);
		}
		if (where == BESIDE_RIGHT && between < own->right)
			own->right = between;
		if (where == BESIDE_LEFT && between >= own->left)
			own->left = between + 1;
		if (where == BESIDE_ABOVE && (int)who->top > own->top)
			own->top = (int)who->top;
		if (where == BESIDE_BELOW && (int)other->top - 1 < own->bottom)
			own->bottom = (int)other->top - 1;
	}
	return true;
}

/* How far from his middle a person's hands and feet reach, in a wide step, too. */
static float reach_of(const struct people *p, const struct person *who)
{
	const struct body body = {(int)(who->x - who->half), (int)(who->x + who->half),
				  (int)who->top, (int)who->foot - 1, 0};

	return fmaxf(1.4f * who->half, 0.8f * usual_width(p, &body));
}

static bool holds(const struct person *who, float x, float y)
{
	return fabsf(x - who->x) <= fminf(who->reach, 1.15f * who->half) && y >= who->top - 1 &&
	       y <= who->foot;
}

/* The owner of a group's cell is the nearest person whose box holds it, or else the one beside
 * whom it is. */
static int owner_of(const struct people *p, int group, int x, int y)
{
	int owner = -1, beside = -1;
	float least = INFINITY;

	for (int n = 0; n < p->crowd.persons; n++) {
		const struct person *who = &p->crowd.person[n];
		const float off = fabsf((float)x + 0.5f - who->x) / (who->half + 1);

		if (who->group != group)
			continue;
		if (holds(who, (float)x + 0.5f, (float)y + 0.5f) &&
		    (owner < 0 || who->foot > p->crowd.person[owner].foot))
			owner = n;
		if (off < least) {
			least = off;
			beside = n;
		}
	}
	return owner >= 0 ? owner : beside;
}

static void label_owners(struct people *p)
{
	const struct box *box = &p->verdict.box;

	for (int n = 0; n < p->crowd.persons; n++)
		p->crowd.person[n].reach = 0.8f * reach_of(p, &p->crowd.person[n]);

	for (int y = box->top; y <= box->bottom; y++)
		for (int x = box->left; x <= box->right; x++) {
			const int at = y * p->cells.across + x, group = p->crowd.label[at];

			if (group < 0)
				continue;
			p->crowd.label[at] = owner_of(p, group, x, y);
			if (p->crowd.label[at] >= 0)
				p->crowd.person[p->crowd.label[at]].over_object |=
					p->crowd.covered[at] != 0;
		}
}

/* Without a calibrated camera nobody is in front. */
static void follow_nobody(struct people *p)
{
	const struct box *box = &p->verdict.box;

	p->crowd.persons = 1;
	p->crowd.person[0] = (struct person){.front = false};
	for (int y = box->top; y <= box->bottom; y++)
		for (int x = box->left; x <= box->right; x++) {
			int *label = &p->crowd.label[y * p->cells.across + x];

			*label = *label < 0 ? -1 : 0;
		}
	for (int n = 0; n < p->crowd.group_count; n++)
		p->report.parts += !p->crowd.groups[n].dropped;
}

/* Measures everybody, and makes newcomers known. */
static void meet_groups(struct people *p, struct body body[PERSONS_MAX])
{
	for (int n = 0; n < p->crowd.group_count; n++) {
		bool known = p->crowd.groups[n].dropped;

		for (int m = 0; m < p->crowd.persons; m++)
			known |= p->crowd.person[m].group == n;
		if (!known)
			begin_person(p, n);
	}
	for (int n = 0; n < p->crowd.persons; n++) {
		struct person *who = &p->crowd.person[n];
		struct box own;
		bool alone;

		body[n] = (struct body){0, -1, 0, 0, 0};
		if (who->group < 0)
			continue;
		if (territory(p, n, &own, &alone) || !who->placed)
			body[n] = measure(p, who->group, &own);
		if (body[n].right >= body[n].left)
			take_body(p, who, &body[n], alone);
	}
}

void persons_follow(struct people *p)
{
	struct body body[PERSONS_MAX];

	if (p->visited && !p->object.camera) {
		follow_nobody(p);
		return;
	}
	predict(p);
	if (!p->visited)
		return;
	depths_move(p);
	join_bodies(p);
	for (int n = 0; n < p->crowd.persons; n++) {
		find_group(p, &p->crowd.person[n]);
		if (is_double(p, &p->crowd.person[n]))
			p->crowd.person[n--] = p->crowd.person[--p->crowd.persons];
	}
	meet_groups(p, body);
	for (int n = 0; n < p->crowd.persons; n++)
		for (int m = 0; m < p->crowd.persons; m++)
			p->crowd.person[n].walked |= p->crowd.person[m].walked &&
						     p->crowd.person[m].group ==
							     p->crowd.person[n].group;
	label_owners(p);
	for (int n = 0; n < p->crowd.persons; n++) {
		struct person *who = &p->crowd.person[n];
		const struct box *box = &p->verdict.box;
		const float lean = !who->placed ? 0 : who->front ? MARGIN : -MARGIN;
		const enum told told = p->crowd.depth ? depths_ask(p, n, box, lean) : TOLD_NOTHING;

		if (told != TOLD_NOTHING) {
			who->front = told == TOLD_FRONT;
			who->placed = true;
		} else if (who->group >= 0 && body[n].right >= body[n].left) {
			find_order(p, n, &body[n]);
		}
		p->report.parts += who->group >= 0;
		p->report.in_front += who->group >= 0 && who->front;
	}
}
