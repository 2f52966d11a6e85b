/* SPDX-License-Identifier: MIT */
/*
 * Each cell is made by itself. Around its node the sphere is projected onto the tangent plane,
 * where the great circle halfway between the node and another node is a straight line. A large
 * square is cut by the horizon and by the line of each near node. The nodes may lie anywhere; if
 * four lie on a circle, the fourth only yields a corner that exists already.
 */
#include "hal/optics/dome_parts.h"

#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "hal/optics/vec.h"

/* Corners of a cell. A cell of frequency 1 among those of DOME_FREQUENCY_MAX has that many along
 * each of its five or six sides. What does not fit makes the sum of all solid angles wrong, which
 * dome.c refuses. */
#define POLYGON_MAX 512
#define SQUARE 8.0 /* half the side of the first square: cells reach less than atan(8) = 83 deg */
#define SAME 1e-11 /* corners nearer than this are one */

struct polygon {
	int count;
	double at[POLYGON_MAX][2];
};

/* Cuts off the part of the polygon where a x + b y + c < 0. Most lines cut nothing, and most
 * polygons have six corners of POLYGON_MAX: neither is copied whole. */
static void polygon_cut(struct polygon *p, double a, double b, double c)
{
	double side[POLYGON_MAX];
	struct polygon out;
	bool whole = true;

	for (int i = 0; i < p->count; i++) {
		side[i] = a * p->at[i][0] + b * p->at[i][1] + c;
		whole &= side[i] >= 0;
	}
	if (whole)
		return;
	out.count = 0;
	for (int i = 0; i < p->count; i++) {
		const int after = (i + 1) % p->count;
		const double *here = p->at[i], *next = p->at[after], h = side[i], n = side[after];

		if (h >= 0 && out.count < POLYGON_MAX)
			memcpy(out.at[out.count++], here, sizeof(out.at[0]));
		if ((h > 0 && n < 0) || (h < 0 && n > 0)) {
			const double t = h / (h - n);

			if (out.count == POLYGON_MAX)
				break;
			out.at[out.count][0] = here[0] + t * (next[0] - here[0]);
			out.at[out.count][1] = here[1] + t * (next[1] - here[1]);
			out.count++;
		}
	}
	p->count = out.count;
	memcpy(p->at, out.at, (size_t)out.count * sizeof(out.at[0]));
}

/* Two unit vectors e1, e2 that make a right-handed frame e1, e2, n. */
static void tangent_frame(const double n[3], double e1[3], double e2[3])
{
	const double axis[3] = {fabs(n[0]) < 0.6, fabs(n[0]) >= 0.6, 0};

	vec_cross(axis, n, e1);
	vec_normalize(e1);
	vec_cross(n, e1, e2);
}

static void cut_by_node(struct polygon *p, const double node[3], const double other[3],
			const double e1[3], const double e2[3])
{
	double away[3]; /* d . (node - other) >= 0, d = node + x e1 + y e2 */

	for (int k = 0; k < 3; k++)
		away[k] = node[k] - other[k];
	polygon_cut(p, vec_dot(away, e1), vec_dot(away, e2), 0.5 * vec_dot(away, away));
}

/* Cuts by all nodes nearer than reach, in rad. */
static void cut_by_near(struct polygon *p, const double (*node)[3], int count, int i, double reach,
			const double e1[3], const double e2[3])
{
	const double nearest = cos(fmin(reach, M_PI));

	for (int k = 0; k < count; k++)
		if (k != i && vec_dot(node[i], node[k]) >= nearest)
			cut_by_node(p, node[i], node[k], e1, e2);
}

/* Projects the corners back to the sphere and merges those that coincide. Returns their number. */
static int lift_corners(const struct polygon *p, const double node[3], const double e1[3],
			const double e2[3], double (*corner)[3])
{
	int count = 0;

	for (int i = 0; i < p->count; i++) {
		const double *here = p->at[i], *before = p->at[(i + p->count - 1) % p->count];
		double *c = corner[count];

		if (hypot(here[0] - before[0], here[1] - before[1]) < SAME)
			continue;
		for (int k = 0; k < 3; k++)
			c[k] = node[k] + here[0] * e1[k] + here[1] * e2[k];
		if (fabs(c[2]) < SAME)
			c[2] = 0; /* on the horizon, apart from rounding */
		vec_normalize(c);
		count++;
	}
	return count;
}

/* Finds the outline and radius of cell i; returns the number of corners. All nodes that can touch
 * the cell are nearer than twice its radius: the search widens until reach covers that. */
static int find_cell(const double (*node)[3], int nodes, int i, double spacing_rad,
		     double (*corner)[3], double *radius)
{
	double e1[3], e2[3];

	tangent_frame(node[i], e1, e2);
	for (double reach = 2 * spacing_rad;; reach *= 2) {
		static const double square[4][2] = {
			{-SQUARE, -SQUARE}, {SQUARE, -SQUARE}, {SQUARE, SQUARE}, {-SQUARE, SQUARE}};
		struct polygon p;
		int count;

		p.count = 4;
		memcpy(p.at, square, sizeof(square));
		polygon_cut(&p, e1[2], e2[2], node[i][2]);
		cut_by_near(&p, node, nodes, i, reach, e1, e2);
		count = lift_corners(&p, node[i], e1, e2, corner);
		*radius = 0;
		for (int k = 0; k < count; k++)
			*radius = fmax(*radius, vec_angle(corner[k], node[i]));
		if (reach > M_PI || 2 * *radius < reach)
			return count;
	}
}

/* Van Oosterom and Strackee, "The solid angle of a plane triangle", 1983:
 *     tan(sr / 2) = det(a, b, c) / (1 + a . b + b . c + c . a)
 * The determinant is that of a, b - a, c - a, whose digits do not cancel in small triangles. */
double dome_triangle_sr(const double a[3], const double b[3], const double c[3])
{
	const double ab[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
	const double ac[3] = {c[0] - a[0], c[1] - a[1], c[2] - a[2]};
	double normal[3];

	vec_cross(ab, ac, normal);
	return 2 * atan2(vec_dot(a, normal), 1 + vec_dot(a, b) + vec_dot(b, c) + vec_dot(c, a));
}

static void measure_cell(struct dome_cells *cells, const double node[3], int i)
{
	double sum = 0;

	for (int k = cells->first[i]; k < cells->first[i + 1]; k++) {
		const int next = k + 1 < cells->first[i + 1] ? k + 1 : cells->first[i];
		const double sr = dome_triangle_sr(node, cells->corner[k], cells->corner[next]);

		sum += fmax(sr, 0); /* rounding: sr may be below 0 if the node is on the outline */
		cells->cumulative_sr[k] = sum;
	}
}

int dome_cells_create(struct dome_cells **out, const double (*node)[3], int count,
		      double spacing_rad)
{
	struct dome_cells *cells = calloc(1, sizeof(*cells));
	int ret = -ENOMEM, room = 16 * count + POLYGON_MAX;

	if (!cells)
		return -ENOMEM;
	cells->first = calloc((size_t)count + 1, sizeof(*cells->first));
	cells->radius = calloc((size_t)count, sizeof(*cells->radius));
	cells->corner = calloc((size_t)room, sizeof(*cells->corner));
	cells->cumulative_sr = calloc((size_t)room, sizeof(*cells->cumulative_sr));
	if (!cells->first || !cells->radius || !cells->corner || !cells->cumulative_sr)
		goto destroy;
	for (int i = 0; i < count; i++) {
		const int first = cells->first[i];

		if (first + POLYGON_MAX > room) { /* 16 a cell; those of a dome have about six */
			ret = -EINVAL;
			goto destroy;
		}
		cells->first[i + 1] = first + find_cell(node, count, i, spacing_rad,
							cells->corner + first, &cells->radius[i]);
		measure_cell(cells, node[i], i);
	}
	*out = cells;
	return 0;

destroy:
	dome_cells_destroy(cells);
	return ret;
}

void dome_cells_destroy(struct dome_cells *cells)
{
	if (!cells)
		return;
	free(cells->first);
	free(cells->radius);
	free(cells->corner);
	free(cells->cumulative_sr);
	free(cells);
}

/*
 * Lambert's formula, over the edges (a, b) of the cell:
 *     1/2 sum angle(a, b) n,   n = a x b / |a x b|
 * The cross product is computed as a x (b - a), whose digits do not cancel in short edges.
 */
void dome_cells_moment(const struct dome_cells *cells, int i, double moment[3])
{
	memset(moment, 0, 3 * sizeof(*moment));
	for (int k = cells->first[i]; k < cells->first[i + 1]; k++) {
		const double *a = cells->corner[k];
		const double *b =
			cells->corner[k + 1 < cells->first[i + 1] ? k + 1 : cells->first[i]];
		const double ab[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
		double normal[3], length, half;

		vec_cross(a, ab, normal);
		length = vec_length(normal);
		if (!(length > 0))
			continue;
		half = 0.5 * atan2(length, vec_dot(a, b)) / length;
		for (int c = 0; c < 3; c++)
			moment[c] += half * normal[c];
	}
}
