/* SPDX-License-Identifier: MIT */
#include "hal/optics/dome_parts.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>

#include "hal/optics/vec.h"

/* Larger than all rounding of angles and positions on the map; a superfluous candidate is harmless.
 */
#define SLACK 1e-9

struct dome_lookup {
	int side;
	int *first;	/* [side * side + 1] */
	int *candidate; /* ascending within a grid cell */
};

/* A cap that holds a grid cell. The cell is a spherical polygon, because side is even and no cell
 * lies across two quadrants; a cap smaller than a hemisphere that holds its corners holds all of
 * it. */
struct grid_cap {
	double centre[3];
	double radius_rad; /* negative: the cell lies below the horizon */
};

/* The inverse of dome_map(). */
static void map_direction(double u, double v, double dir[3])
{
	dir[0] = u;
	dir[1] = v;
	dir[2] = 1 - fabs(u) - fabs(v);
	vec_normalize(dir);
}

static void grid_cap_fill(struct grid_cap *cap, int x, int y, int side)
{
	const double step = 2.0 / side, u = x * step - 1, v = y * step - 1;
	const double nearest_u = fmin(fabs(u), fabs(u + step));
	const double nearest_v = fmin(fabs(v), fabs(v + step));
	double closest = 1;

	map_direction(u + 0.5 * step, v + 0.5 * step, cap->centre);
	for (int k = 0; k < 4; k++) {
		double corner[3];

		map_direction(u + (k & 1) * step, v + (k >> 1) * step, corner);
		closest = fmin(closest, vec_dot(corner, cap->centre));
	}
	cap->radius_rad = nearest_u + nearest_v > 1 + SLACK ? -1 : acos(closest);
}

/* Visits, for each item, the grid cells that its cap can touch. next NULL: counts the item in
 * first[cell + 1]; else writes it at candidate[next[cell]++]. */
static void lookup_visit(struct dome_lookup *l, const struct grid_cap *caps, const double *radius,
			 const double (*node)[3], int count, int *next)
{
	for (int i = 0; i < count; i++) {
		const double half = DOME_MAP_STRETCH * radius[i] + SLACK;
		double uv[2];
		int x1, y1;

		dome_map(node[i], uv);
		x1 = dome_map_cell(uv[0] + half, l->side);
		y1 = dome_map_cell(uv[1] + half, l->side);
		for (int y = dome_map_cell(uv[1] - half, l->side); y <= y1; y++)
			for (int x = dome_map_cell(uv[0] - half, l->side); x <= x1; x++) {
				const int cell = y * l->side + x;
				const struct grid_cap *cap = &caps[cell];
				const double reach = cap->radius_rad + radius[i] + SLACK;

				if (cap->radius_rad < 0 ||
				    (reach < M_PI && vec_dot(cap->centre, node[i]) < cos(reach)))
					continue;
				if (next)
					l->candidate[next[cell]++] = i;
				else
					l->first[cell + 1]++;
			}
	}
}

int dome_lookup_create(struct dome_lookup **out, const double *radius, const double (*centre)[3],
		       int count)
{
	struct dome_lookup *l = calloc(1, sizeof(*l));
	struct grid_cap *caps = NULL;
	int *next = NULL;
	int total, ret = -ENOMEM;

	if (!l)
		return -ENOMEM;
	l->side = 2 * (int)ceil(sqrt(count)); /* about two grid cells for each node */
	total = l->side * l->side;
	caps = calloc((size_t)total, sizeof(*caps));
	next = calloc((size_t)total, sizeof(*next));
	l->first = calloc((size_t)total + 1, sizeof(*l->first));
	if (!caps || !next || !l->first)
		goto out;
	for (int i = 0; i < total; i++)
		grid_cap_fill(&caps[i], i % l->side, i / l->side, l->side);
	lookup_visit(l, caps, radius, centre, count, NULL);
	for (int i = 0; i < total; i++) {
		l->first[i + 1] += l->first[i];
		next[i] = l->first[i];
	}
	l->candidate = calloc((size_t)l->first[total], sizeof(*l->candidate));
	if (!l->candidate)
		goto out;
	lookup_visit(l, caps, radius, centre, count, next);
	*out = l;
	l = NULL;
	ret = 0;
out:
	free(caps);
	free(next);
	dome_lookup_destroy(l);
	return ret;
}

void dome_lookup_destroy(struct dome_lookup *l)
{
	if (!l)
		return;
	free(l->first);
	free(l->candidate);
	free(l);
}

const int *dome_lookup_candidates(const struct dome_lookup *l, const double dir[3], int *count)
{
	double uv[2];
	int cell;

	*count = 0;
	if (!(dir[2] >= 0) || !dome_map(dir, uv))
		return l->candidate;
	cell = dome_map_cell(uv[1], l->side) * l->side + dome_map_cell(uv[0], l->side);
	*count = l->first[cell + 1] - l->first[cell];
	return l->candidate + l->first[cell];
}

int dome_lookup_find(const struct dome_lookup *l, const double (*node)[3], const double dir[3])
{
	double best = -INFINITY;
	int count, found = -1;
	const int *candidate = dome_lookup_candidates(l, dir, &count);

	for (int k = 0; k < count; k++) {
		const double near = vec_dot(node[candidate[k]], dir);

		if (near > best) {
			best = near;
			found = candidate[k];
		}
	}
	return found;
}
