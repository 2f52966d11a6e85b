/* SPDX-License-Identifier: MIT */
/* How far the object reaches over the ground, seen from the camera. */
#include <math.h>

#include "hal/people/people_parts.h"

bool far_side_point(const struct people *p, double x, double y, double height,
		    double *direction_rad, float *far)
{
	const double px[2] = {x * p->cells.side, y * p->cells.side};
	double origin[3], dir[3], t;

	if (tsai_ray(p->object.camera, px, origin, dir))
		return false;
	t = (height - origin[2]) / dir[2];
	*direction_rad = atan2(dir[1], dir[0]);
	*far = (float)hypot(t * dir[0], t * dir[1]);
	return t > 0 && t < INFINITY;
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
		const double turn = turn_between(p->crowd.far_side.middle_rad, atan2(y, x));

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
	const double n = (turn_rad - p->crowd.far_side.first_rad) /
			 (p->crowd.far_side.last_rad - p->crowd.far_side.first_rad) *
			 FAR_DIRECTIONS;

	return n < 0 ? 0 : n > FAR_DIRECTIONS - 1 ? FAR_DIRECTIONS - 1 : (int)n;
}

static void mark_directions(struct people *p, const struct sight *sight)
{
	const int last = place_of(p, sight->last_rad);

	for (int n = place_of(p, sight->first_rad); n <= last; n++)
		p->crowd.far_side.around[n] = fmaxf(p->crowd.far_side.around[n], (float)sight->far);
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
	p->crowd.far_side.first_rad = fmin(p->crowd.far_side.first_rad, sight->first_rad);
	p->crowd.far_side.last_rad = fmax(p->crowd.far_side.last_rad, sight->last_rad);
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
	p->crowd.far_side.middle_rad = atan2(middle[1], middle[0]);
	p->crowd.far_side.first_rad = INFINITY;
	p->crowd.far_side.last_rad = -INFINITY;
	walk_border(p, eye, widen_directions);
	if (!(p->crowd.far_side.last_rad > p->crowd.far_side.first_rad))
		return false;
	for (int n = 0; n < FAR_DIRECTIONS; n++)
		p->crowd.far_side.around[n] = -1;
	walk_border(p, eye, mark_directions);
	return true;
}

/* ---- where it is not: the lowest cell of each column that the object covers ---- */

/* The lowest covered cell of a column; -1: none. */
static int lowest_covered(const struct people *p, int column)
{
	const size_t width = (size_t)p->settings.width;

	for (int y = p->settings.height - 1; y >= 0; y--)
		for (int x = column * p->cells.side;
		     x < (column + 1) * p->cells.side && x < (int)width; x++)
			if (p->object.coverage[(size_t)y * width + (size_t)x] > 32767)
				return y / p->cells.side;
	return -1;
}

static void measure_columns(struct people *p)
{
	for (int x = 0; x < p->cells.across; x++) {
		const int lowest = p->object.camera ? lowest_covered(p, x) : -1;
		double direction;

		if (lowest < 0 || !far_side_point(p, x + 0.5, lowest + 1, 0, &direction,
						  &p->crowd.far_side.column[x]))
			p->crowd.far_side.column[x] = -1;
	}
}

void far_side_measure(struct people *p)
{
	p->crowd.far_side.is_known = measure_footprint(p);
	if (!p->crowd.far_side.is_known)
		measure_columns(p);
}

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
float far_side_at(const struct people *p, double x, double direction_rad)
{
	if (!p->crowd.far_side.is_known)
		return nearest_far(p->crowd.far_side.column, p->cells.across, (int)x);
	return nearest_far(p->crowd.far_side.around, FAR_DIRECTIONS,
			   place_of(p, turn_between(p->crowd.far_side.middle_rad, direction_rad)));
}

/* ---- bodies ---- */

double far_side_height(const struct people *p, double x, double y, double far)
{
	const double px[2] = {x * p->cells.side, y * p->cells.side};
	double origin[3], dir[3];

	if (tsai_ray(p->object.camera, px, origin, dir))
		return NAN;
	return origin[2] + dir[2] * far / hypot(dir[0], dir[1]);
}

double far_side_row(const struct people *p, double direction_rad, double far, double height)
{
	const double middle[2] = {0.5 * p->settings.width, 0.5 * p->settings.height};
	double eye[3], dir[3], world[3], px[2];

	if (tsai_ray(p->object.camera, middle, eye, dir))
		return NAN;
	world[0] = eye[0] + far * cos(direction_rad);
	world[1] = eye[1] + far * sin(direction_rad);
	world[2] = height;
	return tsai_project(p->object.camera, world, px) ? NAN : px[1] / p->cells.side;
}
