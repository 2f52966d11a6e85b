/* SPDX-License-Identifier: MIT */
/*
 * Whether a group is before the object: by the ground under its feet, seen from the camera. A group
 * keeps its order while it overlaps itself, unless its feet pass the object by more than MARGIN.
 */
#include <math.h>

#include "hal/people/people_parts.h"

#define MARGIN 0.03f /* of the object's distance from the camera */

/* Where a point of the picture, in cells, lies on the ground, seen from above: x, y, and its distance
 * from below the camera. False: above the horizon. */
static bool on_ground(const struct people *p, double x, double y, double ground[2], double *far)
{
	const double px[2] = {x * p->side, y * p->side};
	double origin[3], dir[3], t;

	if (tsai_ray(p->object.camera, px, origin, dir) || !(dir[2] * origin[2] < 0))
		return false;
	t = -origin[2] / dir[2];
	ground[0] = origin[0] + t * dir[0];
	ground[1] = origin[1] + t * dir[1];
	*far = hypot(t * dir[0], t * dir[1]);
	return true;
}

/* Where the ray over ground from the camera along direction d meets the object's outline. */
static bool meet_outline(const struct people *p, const double origin[3], const double d[2],
			 float *near, float *far)
{
	const double(*foot)[2] = p->object.foot;
	double enter = 0, leave = INFINITY;

	for (int i = 0; i < p->object.foot_count; i++) {
		const double *a = foot[i], *b = foot[(i + 1) % p->object.foot_count];
		const double n[2] = {b[1] - a[1], a[0] - b[0]}; /* outwards */
		const double rate = n[0] * d[0] + n[1] * d[1];
		const double room = n[0] * (a[0] - origin[0]) + n[1] * (a[1] - origin[1]);

		if (rate > 0)
			leave = fmin(leave, room / rate);
		else if (rate < 0)
			enter = fmax(enter, room / rate);
		else if (room < 0)
			return false;
	}
	*near = (float)enter;
	*far = (float)leave;
	return p->object.foot_count >= 3 && enter < leave;
}

/* The lowest covered cell of a column; -1: none. */
static int lowest_covered(const struct people *p, int column)
{
	const size_t width = (size_t)p->settings.width;

	for (int y = p->settings.height - 1; y >= 0; y--)
		for (int x = column * p->side; x < (column + 1) * p->side && x < (int)width; x++)
			if (p->object.coverage[(size_t)y * width + (size_t)x] > 32767)
				return y / p->side;
	return -1;
}

void order_measure_object(struct people *p)
{
	for (int x = 0; x < p->across; x++) {
		const int lowest = lowest_covered(p, x);
		double ground[2], far, origin[3], dir[3], px[2] = {0};

		p->object_near[x] = p->object_far[x] = -1;
		if (lowest < 0 || !p->object.camera ||
		    !on_ground(p, x + 0.5, lowest + 1, ground, &far))
			continue;
		p->object_near[x] = p->object_far[x] = (float)far;
		px[0] = (x + 0.5) * p->side;
		px[1] = (lowest + 1.0) * p->side;
		if (!p->object.foot_count || tsai_ray(p->object.camera, px, origin, dir))
			continue;
		dir[2] = hypot(dir[0], dir[1]);
		dir[0] /= dir[2];
		dir[1] /= dir[2];
		if (!meet_outline(p, origin, dir, &p->object_near[x], &p->object_far[x]))
			p->object_near[x] = p->object_far[x] = (float)far;
	}
}

/* The column nearest to x where the object is; -1: it is nowhere. */
static int object_column(const struct people *p, int x)
{
	for (int step = 0; step < p->across; step++) {
		if (x - step >= 0 && x - step < p->across && p->object_near[x - step] >= 0)
			return x - step;
		if (x + step >= 0 && x + step < p->across && p->object_near[x + step] >= 0)
			return x + step;
	}
	return -1;
}

bool order_is_front(const struct people *p, const struct group *g)
{
	const int column = object_column(p, (int)g->foot_x);
	double ground[2], far;
	float border;

	if (column < 0)
		return false;
	if (g->foot_y == p->down - 1)
		return true; /* the feet are nearer than the picture shows */
	if (!on_ground(p, g->foot_x, g->foot_y + 1, ground, &far))
		return false;
	border = p->object_far[column];
	if (g->before[1] > g->before[0])
		border += MARGIN * border;
	else if (g->before[0])
		border -= MARGIN * border;
	return (float)far < border;
}
