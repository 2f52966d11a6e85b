/* SPDX-License-Identifier: MIT */
/*
 * Whether a group is before the object: by its depths where they are measured, else by the ground
 * under its feet, seen from the camera. A group keeps its order while it overlaps itself, unless it
 * passes the object by more than MARGIN.
 */
#include <math.h>

#include "hal/people/people_parts.h"

#define MARGIN 0.03f	/* of the object's distance from the camera */
#define ASKED_MOST 1024 /* so many cells of a group, about, are asked for their depth */
#define KNOWN_LEAST 4	/* with fewer known ones, or */
#define KNOWN_SHARE 0.2 /* a smaller share of those asked, depths tell nothing */

/* Where a point of the picture, in cells, lies on the ground, seen from above: its direction and
 * its distance from below the camera. False: above the horizon. */
static bool on_ground(const struct people *p, double x, double y, double *direction_rad, float *far)
{
	const double px[2] = {x * p->side, y * p->side};
	double origin[3], dir[3], t;

	if (tsai_ray(p->object.camera, px, origin, dir) || !(dir[2] * origin[2] < 0))
		return false;
	t = -origin[2] / dir[2];
	*direction_rad = atan2(dir[1], dir[0]);
	*far = (float)hypot(t * dir[0], t * dir[1]);
	return true;
}

/* ---- where the object's footprint is known ---- */

/* A square of the footprint, seen from the camera. */
struct sight {
	double first_rad, last_rad; /* from the middle of the footprint's directions */
	double far;
};

static double turn_between(double from_rad, double to_rad)
{
	return remainder(to_rad - from_rad, 2 * M_PI);
}

static struct sight see_square(const struct people *p, const double eye[2], int i, int j)
{
	const struct basis_footprint *foot = p->object.foot;
	struct sight sight = {INFINITY, -INFINITY, 0};

	for (int k = 0; k < 4; k++) {
		const double side = (double)foot->side;
		const double x = (double)foot->corner[0] + (i + k % 2) * side - eye[0];
		const double y = (double)foot->corner[1] + (j + k / 2) * side - eye[1];
		const double turn = turn_between(p->around_middle_rad, atan2(y, x));

		sight.first_rad = fmin(sight.first_rad, turn);
		sight.last_rad = fmax(sight.last_rad, turn);
		sight.far = fmax(sight.far, hypot(x, y));
	}
	return sight;
}

/* Whether a square is set and not all around it are, so that it may be the far side. */
static bool is_border(const struct basis_footprint *foot, int i, int j)
{
	const uint64_t row = foot->row[j];
	const uint64_t inner = j > 0 && j < BASIS_FOOT_SQUARES - 1
				       ? row & row << 1 & row >> 1 & foot->row[j - 1] &
						 foot->row[j + 1]
				       : 0;

	return (row & ~inner) >> i & 1;
}

/* The place of a turn from the middle in around_far. */
static int place_of(const struct people *p, double turn_rad)
{
	const double n = (turn_rad - p->around_first_rad) /
			 (p->around_last_rad - p->around_first_rad) * ORDER_DIRECTIONS;

	return n < 0 ? 0 : n > ORDER_DIRECTIONS - 1 ? ORDER_DIRECTIONS - 1 : (int)n;
}

static void mark_directions(struct people *p, const struct sight *sight)
{
	const int last = place_of(p, sight->last_rad);

	for (int n = place_of(p, sight->first_rad); n <= last; n++)
		p->around_far[n] = fmaxf(p->around_far[n], (float)sight->far);
}

/* Calls take() for each border square of the footprint. */
static void walk_border(struct people *p, const double eye[2],
			void (*take)(struct people *p, const struct sight *sight))
{
	for (int j = 0; j < BASIS_FOOT_SQUARES; j++)
		for (int i = 0; p->object.foot->row[j] && i < BASIS_FOOT_SQUARES; i++)
			if (is_border(p->object.foot, i, j)) {
				const struct sight sight = see_square(p, eye, i, j);

				take(p, &sight);
			}
}

static void widen_directions(struct people *p, const struct sight *sight)
{
	p->around_first_rad = fmin(p->around_first_rad, sight->first_rad);
	p->around_last_rad = fmax(p->around_last_rad, sight->last_rad);
}

static bool measure_footprint(struct people *p)
{
	const struct basis_footprint *foot = p->object.foot;
	const double px[2] = {0.5 * p->settings.width, 0.5 * p->settings.height};
	double eye[3], dir[3], middle[2];

	if (!foot || !(foot->side > 0) || !p->object.camera ||
	    tsai_ray(p->object.camera, px, eye, dir))
		return false;
	for (int k = 0; k < 2; k++)
		middle[k] = (double)foot->corner[k] +
			    0.5 * BASIS_FOOT_SQUARES * (double)foot->side - eye[k];
	p->around_middle_rad = atan2(middle[1], middle[0]);
	p->around_first_rad = INFINITY;
	p->around_last_rad = -INFINITY;
	walk_border(p, eye, widen_directions);
	if (!(p->around_last_rad > p->around_first_rad))
		return false;
	for (int n = 0; n < ORDER_DIRECTIONS; n++)
		p->around_far[n] = -1;
	walk_border(p, eye, mark_directions);
	return true;
}

/* ---- where it is not: the lowest cell of each column that the object covers ---- */

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

static void measure_columns(struct people *p)
{
	for (int x = 0; x < p->across; x++) {
		const int lowest = p->object.camera ? lowest_covered(p, x) : -1;
		double direction;

		if (lowest < 0 || !on_ground(p, x + 0.5, lowest + 1, &direction, &p->object_far[x]))
			p->object_far[x] = -1;
	}
}

void order_measure_object(struct people *p)
{
	p->around = measure_footprint(p);
	if (!p->around)
		measure_columns(p);
}

/* ---- groups ---- */

/* The value nearest to place n that is not negative; -1: there is none. */
static float nearest_far(const float *far, int count, int n)
{
	for (int step = 0; step < count; step++) {
		if (n - step >= 0 && n - step < count && far[n - step] >= 0)
			return far[n - step];
		if (n + step >= 0 && n + step < count && far[n + step] >= 0)
			return far[n + step];
	}
	return -1;
}

/* The object's far side in a direction, or in that nearest to it where the object is; x: in cells,
 * for an object whose footprint is not known. */
static float far_side(const struct people *p, double x, double direction_rad)
{
	if (!p->around)
		return nearest_far(p->object_far, p->across, (int)x);
	return nearest_far(p->around_far, ORDER_DIRECTIONS,
			   place_of(p, turn_between(p->around_middle_rad, direction_rad)));
}

/* Where the far side is for a group that was on one side of it. */
static float leaning(const struct group *g, float border)
{
	if (g->before[1] > g->before[0])
		border += MARGIN * border;
	else if (g->before[0])
		border -= MARGIN * border;
	return border;
}

/* ---- by depth ---- */

/* Where what a cell shows is, seen from above: its direction and its distance from the camera.
 * False: its depth is not known. */
static bool cell_by_depth(const struct people *p, const struct depth_map *map, int x, int y,
			  double *direction_rad, float *far)
{
	const double *axis = &p->object.camera->rotation[6];
	const double px[2] = {(x + 0.5) * p->side, (y + 0.5) * p->side};
	const int u = (int)(px[0] * map->width / p->settings.width);
	const int v = (int)(px[1] * map->height / p->settings.height);
	const double depth = depth_map_at(map, u < map->width ? u : map->width - 1,
					  v < map->height ? v : map->height - 1);
	double origin[3], dir[3], t;

	if (!(depth > 0) || tsai_ray(p->object.camera, px, origin, dir))
		return false;
	t = depth / (axis[0] * dir[0] + axis[1] * dir[1] + axis[2] * dir[2]);
	*direction_rad = atan2(dir[1], dir[0]);
	*far = (float)(t * hypot(dir[0], dir[1]));
	return true;
}

enum told { TOLD_NOTHING, TOLD_BEHIND, TOLD_FRONT };

/* On which side of the object most of a group's cells are: at its outline the cameras may
 * differ. */
static enum told ask_depth(const struct people *p, const struct depth_map *map,
			   const struct group *g)
{
	const int own = (int)(g - p->groups);
	int step = 1, asked = 0, known = 0, nearer = 0;

	while (step * step * ASKED_MOST < g->cells)
		step++;
	for (int y = g->top; y <= g->bottom; y += step)
		for (int x = g->left; x <= g->right; x += step) {
			double direction;
			float far;

			if (p->label[y * p->across + x] != own)
				continue;
			asked++;
			if (!cell_by_depth(p, map, x, y, &direction, &far))
				continue;
			known++;
			nearer += far < leaning(g, far_side(p, x, direction));
		}
	if (known < KNOWN_LEAST || known < KNOWN_SHARE * asked)
		return TOLD_NOTHING;
	return 2 * nearer > known ? TOLD_FRONT : TOLD_BEHIND;
}

/* ---- by the feet ---- */

static bool stands_before(const struct people *p, const struct group *g)
{
	double direction = p->around_middle_rad;
	float far = 0, border;
	bool stands = on_ground(p, g->foot_x, g->foot_y + 1, &direction, &far);

	border = far_side(p, g->foot_x, direction);
	if (border < 0)
		return false;
	if (g->foot_y == p->down - 1)
		return true; /* the feet are nearer than the picture shows */
	return stands && far < leaning(g, border);
}

bool order_is_front(struct people *p, const struct group *g)
{
	const struct depth_map *map;
	enum told told;

	if (!p->object.camera)
		return false;
	map = depths_of_background(p);
	told = map ? ask_depth(p, map, g) : TOLD_NOTHING;
	return told == TOLD_NOTHING ? stands_before(p, g) : told == TOLD_FRONT;
}
