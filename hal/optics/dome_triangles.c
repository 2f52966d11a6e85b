/* SPDX-License-Identifier: MIT */
#include "hal/optics/dome_parts.h"

#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "hal/optics/vec.h"

#define MEETING_MAX 16	 /* most cells at one corner */
#define HORIZON 1e-9	 /* corners below this height lie on the horizon and belong to the rim */
#define NEAR 1e-8	 /* corners of a cell nearer than this are one */
#define EQUAL 1e-11	 /* nodes whose cosines differ by less are equally far */
#define VOLUME_MIN 1e-14 /* triangles of a smaller volume are flat and dropped */

/* The nodes whose cells meet at a corner. */
struct corner_meeting {
	int count;
	int node[MEETING_MAX];
	double azimuth[MEETING_MAX];
};

struct hull_edge {
	int from, to;
};

/* det(a, b, c) */
static double corners_volume(const double a[3], const double b[3], const double c[3])
{
	const double ab[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
	const double ac[3] = {c[0] - a[0], c[1] - a[1], c[2] - a[2]};
	double normal[3];

	vec_cross(ab, ac, normal);
	return vec_dot(a, normal);
}

static int add_triangle(struct dome_triangles *t, int a, int b, int c)
{
	if (corners_volume(t->vertex[a], t->vertex[b], t->vertex[c]) < VOLUME_MIN)
		return 0;
	if (t->count == t->room) {
		const int room = t->room ? 2 * t->room : 1024;
		int(*corner)[3] = realloc(t->corner, (size_t)room * sizeof(*corner));

		if (!corner)
			return -ENOMEM;
		t->corner = corner;
		t->room = room;
	}
	t->corner[t->count][0] = a;
	t->corner[t->count][1] = b;
	t->corner[t->count++][2] = c;
	return 0;
}

/* ---- between nodes ---- */

/* Finds all nodes nearest to a corner of a cell, counter-clockwise around it. */
static void corner_meet(const struct dome_lookup *lookup, const double (*node)[3],
			const double corner[3], struct corner_meeting *m)
{
	const double axis[3] = {fabs(corner[0]) < 0.6, fabs(corner[0]) >= 0.6, 0};
	double best = -1, e1[3], e2[3];
	int count;
	const int *near = dome_lookup_candidates(lookup, corner, &count);

	vec_cross(axis, corner, e1);
	vec_cross(corner, e1, e2);
	for (int k = 0; k < count; k++)
		best = fmax(best, vec_dot(node[near[k]], corner));
	m->count = 0;
	for (int k = 0; k < count && m->count < MEETING_MAX; k++) {
		const double *there = node[near[k]];
		int at = m->count;
		double azimuth;

		if (vec_dot(there, corner) < best - EQUAL)
			continue;
		azimuth = atan2(vec_dot(there, e2), vec_dot(there, e1));
		for (; at > 0 && m->azimuth[at - 1] > azimuth; at--) {
			m->azimuth[at] = m->azimuth[at - 1];
			m->node[at] = m->node[at - 1];
		}
		m->azimuth[at] = azimuth;
		m->node[at] = near[k];
		m->count++;
	}
}

/* Adds the triangles of a corner, once: only if node has the least index of the nodes that meet
 * there. With four nodes or more on a circle, all triangles have that node as a corner. */
static int fan_out(struct dome_triangles *t, const struct corner_meeting *m, int node)
{
	int first = 0, ret = 0;

	for (int k = 1; k < m->count; k++)
		first = m->node[k] < m->node[first] ? k : first;
	if (m->node[first] != node)
		return 0;
	for (int k = 1; k + 1 < m->count && ret == 0; k++)
		ret = add_triangle(t, node, m->node[(first + k) % m->count],
				   m->node[(first + k + 1) % m->count]);
	return ret;
}

/* Whether an earlier corner of the same cell coincides with this one. */
static bool seen_before(const struct dome_cells *cells, int first, int corner)
{
	for (int k = first; k < corner; k++) {
		const double *a = cells->corner[k], *b = cells->corner[corner];
		const double apart[3] = {a[0] - b[0], a[1] - b[1], a[2] - b[2]};

		if (vec_length(apart) < NEAR)
			return true;
	}
	return false;
}

/* Adds the triangles between nodes: those of each corner at which cells meet above the horizon. */
static int join_nodes(struct dome_triangles *t, const struct dome_cells *cells,
		      const struct dome_lookup *lookup, const double (*node)[3], int count)
{
	for (int i = 0; i < count; i++)
		for (int k = cells->first[i]; k < cells->first[i + 1]; k++) {
			struct corner_meeting m;
			int ret;

			if (cells->corner[k][2] < HORIZON || seen_before(cells, cells->first[i], k))
				continue;
			corner_meet(lookup, node, cells->corner[k], &m);
			ret = fan_out(t, &m, i);
			if (ret < 0)
				return ret;
		}
	return 0;
}

/* ---- from the rim to the horizon ---- */

/* Order of edges for qsort(): the two directions of an edge compare equal. */
static int by_nodes(const void *pa, const void *pb)
{
	const struct hull_edge *a = pa, *b = pb;
	const int low[2] = {a->from < a->to ? a->from : a->to, b->from < b->to ? b->from : b->to};
	const int high[2] = {a->from + a->to - low[0], b->from + b->to - low[1]};

	return low[0] != low[1] ? low[0] - low[1] : high[0] - high[1];
}

/* The foot of a node: the vertex on the horizon below it; a node on the horizon is its own foot. */
static int foot_of(struct dome_triangles *t, int *foot, int node)
{
	double *at;

	if (t->vertex[node][2] == 0)
		return node;
	if (!foot[node]) {
		at = t->vertex[t->vertices];
		at[0] = t->vertex[node][0];
		at[1] = t->vertex[node][1];
		at[2] = 0;
		vec_normalize(at);
		t->owner[t->vertices] = node;
		foot[node] = t->vertices++;
	}
	return foot[node];
}

/* Adds the two triangles that stand below an edge of the rim; the hull is on the edge's left. */
static int edge_stand(struct dome_triangles *t, int *foot, const struct hull_edge *edge)
{
	const int a = edge->to, b = edge->from;
	const int below_a = foot_of(t, foot, a), below_b = foot_of(t, foot, b);
	int ret = 0;

	if (below_a != a)
		ret = add_triangle(t, a, below_b, below_a);
	if (ret == 0 && below_b != b)
		ret = add_triangle(t, a, b, below_b);
	return ret;
}

/* Finds the rim, the edges that exist in one direction only, and closes the gap below it. */
static int join_horizon(struct dome_triangles *t, int count)
{
	const int edges = 3 * t->count;
	struct hull_edge *edge = calloc((size_t)edges + 1, sizeof(*edge));
	int *foot = calloc((size_t)count, sizeof(*foot));
	int ret = edge && foot ? 0 : -ENOMEM;

	for (int k = 0; !ret && k < edges; k++)
		edge[k] = (struct hull_edge){t->corner[k / 3][k % 3],
					     t->corner[k / 3][(k + 1) % 3]};
	if (!ret)
		qsort(edge, (size_t)edges, sizeof(*edge), by_nodes);
	for (int k = 0; !ret && k < edges; k++) {
		if (k + 1 < edges && by_nodes(&edge[k], &edge[k + 1]) == 0)
			k++;
		else
			ret = edge_stand(t, foot, &edge[k]);
	}
	free(edge);
	free(foot);
	return ret;
}

int dome_triangles_create(struct dome_triangles *t, const struct dome_cells *cells,
			  const struct dome_lookup *lookup, const double (*node)[3], int count)
{
	int ret;

	*t = (struct dome_triangles){.vertices = count};
	t->vertex = calloc(2 * (size_t)count, sizeof(*t->vertex));
	t->owner = calloc(2 * (size_t)count, sizeof(*t->owner));
	if (!t->vertex || !t->owner)
		return -ENOMEM;
	for (int i = 0; i < count; i++) {
		memcpy(t->vertex[i], node[i], sizeof(t->vertex[i]));
		t->owner[i] = i;
	}
	ret = join_nodes(t, cells, lookup, node, count);
	return ret < 0 ? ret : join_horizon(t, count);
}

void dome_triangles_free(struct dome_triangles *t)
{
	free(t->vertex);
	free(t->owner);
	free(t->corner);
	*t = (struct dome_triangles){.vertices = 0};
}
