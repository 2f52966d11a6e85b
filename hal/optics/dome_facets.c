/* SPDX-License-Identifier: MIT */
#include "hal/optics/dome_parts.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "hal/optics/vec.h"

/* Relative tolerance of the sum of all solid angles. */
#define COVERED 1e-9

/*
 * edge is the dual basis of the corners. A point p = sum_k weight_k corner_k of the flat triangle
 * has weight_k = edge_k . p; the ray of direction d meets it at d / (sum_k edge_k . d).
 */
struct facet {
	int owner[3]; /* nodes of its corners */
	double edge[3][3];
};

struct dome_facets {
	int count;
	struct facet *facet;
	struct dome_lookup *lookup; /* finds facets */
	int *first;  /* [nodes + 1]: node i has around[first[i] .. first[i + 1] - 1] */
	int *around; /* facets */
};

static void facet_fill(struct facet *f, const struct dome_triangles *triangles, int number,
		       const double corner[3][3])
{
	double volume;

	for (int k = 0; k < 3; k++) {
		f->owner[k] = triangles->owner[triangles->corner[number][k]];
		vec_cross(corner[(k + 1) % 3], corner[(k + 2) % 3], f->edge[k]);
	}
	volume = vec_dot(corner[0], f->edge[0]);
	for (int k = 0; k < 3; k++)
		for (int x = 0; x < 3; x++)
			f->edge[k][x] /= volume;
}

/* Fills all facets. A cap around the middle that holds the corners holds the facet. */
static int fill_all(struct dome_facets *t, const struct dome_triangles *triangles)
{
	double(*middle)[3] = calloc((size_t)t->count, sizeof(*middle));
	double *radius = calloc((size_t)t->count, sizeof(*radius)), sum = 0;
	int ret = middle && radius ? 0 : -ENOMEM;

	for (int n = 0; !ret && n < t->count; n++) {
		double corner[3][3];

		for (int k = 0; k < 3; k++)
			memcpy(corner[k], triangles->vertex[triangles->corner[n][k]],
			       sizeof(corner[k]));
		facet_fill(&t->facet[n], triangles, n, (const double(*)[3])corner);
		sum += dome_triangle_sr(corner[0], corner[1], corner[2]);
		for (int x = 0; x < 3; x++)
			middle[n][x] = corner[0][x] + corner[1][x] + corner[2][x];
		vec_normalize(middle[n]);
		for (int k = 0; k < 3; k++)
			radius[n] = fmax(radius[n], vec_angle(middle[n], corner[k]));
	}
	if (!ret && !(fabs(sum / (2 * M_PI) - 1) < COVERED))
		ret = -EINVAL;
	if (!ret)
		ret = dome_lookup_create(&t->lookup, radius, (const double(*)[3])middle, t->count);
	free(middle);
	free(radius);
	return ret;
}

/* Lists the facets around each node. */
static void list_around(struct dome_facets *t, int nodes)
{
	for (int n = 0; n < 3 * t->count; n++)
		t->first[t->facet[n / 3].owner[n % 3] + 1]++;
	for (int i = 0; i < nodes; i++)
		t->first[i + 1] += t->first[i];
	/* Backwards, each facet takes its nodes' last free places: that ends at the first. */
	for (int n = 3 * t->count - 1; n >= 0; n--)
		t->around[--t->first[t->facet[n / 3].owner[n % 3] + 1]] = n / 3;
	memmove(t->first, t->first + 1, (size_t)nodes * sizeof(*t->first));
	t->first[nodes] = 3 * t->count;
}

int dome_facets_create(struct dome_facets **facets, const struct dome_cells *cells,
		       const struct dome_lookup *lookup, const double (*node)[3], int count)
{
	struct dome_facets *t = calloc(1, sizeof(*t));
	struct dome_triangles triangles;
	int ret;

	if (!t)
		return -ENOMEM;
	ret = dome_triangles_create(&triangles, cells, lookup, node, count);
	if (ret == 0) {
		t->count = triangles.count;
		t->facet = calloc((size_t)t->count, sizeof(*t->facet));
		t->first = calloc((size_t)count + 1, sizeof(*t->first));
		t->around = calloc(3 * (size_t)t->count, sizeof(*t->around));
		ret = t->facet && t->first && t->around ? fill_all(t, &triangles) : -ENOMEM;
	}
	dome_triangles_free(&triangles);
	if (ret < 0) {
		dome_facets_destroy(t);
		return ret;
	}
	list_around(t, count);
	*facets = t;
	return 0;
}

void dome_facets_destroy(struct dome_facets *t)
{
	if (!t)
		return;
	free(t->facet);
	free(t->first);
	free(t->around);
	dome_lookup_destroy(t->lookup);
	free(t);
}

/* Weights of a facet's corners for dir, not normalised to sum 1. Returns the least, or -INFINITY
 * where dir points away from the facet. */
static double facet_weigh(const struct facet *f, const double dir[3], double share[3])
{
	for (int k = 0; k < 3; k++)
		share[k] = vec_dot(f->edge[k], dir);
	return share[0] + share[1] + share[2] > 0 ? fmin(share[0], fmin(share[1], share[2]))
						  : -INFINITY;
}

/* The facet that holds dir: the last one tried, one around the node, or any. Rounding may put a
 * direction on an edge outside of both facets; then the nearer one holds it. -1: none. */
static int facet_find(const struct dome_facets *t, int node, int last, const double dir[3])
{
	double share[3], best = -INFINITY;
	const int *candidate;
	int count, found = -1;

	if (last >= 0 && facet_weigh(&t->facet[last], dir, share) >= 0)
		return last;
	for (int n = t->first[node]; n < t->first[node + 1]; n++)
		if (facet_weigh(&t->facet[t->around[n]], dir, share) >= 0)
			return t->around[n];
	candidate = dome_lookup_candidates(t->lookup, dir, &count);
	for (int n = 0; n < count && best < 0; n++) {
		const double least = facet_weigh(&t->facet[candidate[n]], dir, share);

		if (least > best) {
			best = least;
			found = candidate[n];
		}
	}
	return found;
}

int dome_facets_weights(const struct dome_facets *t, int node, int *facet, const double dir[3],
			int to[3], double weight[3])
{
	double share[3], sum = 0;
	int count = 0;

	*facet = facet_find(t, node, *facet, dir);
	if (*facet < 0)
		return 0;
	facet_weigh(&t->facet[*facet], dir, share);
	for (int k = 0; k < 3; k++)
		sum += fmax(share[k], 0);
	for (int k = 0; k < 3; k++) {
		const int owner = t->facet[*facet].owner[k];
		int at = 0;

		if (!(share[k] > 0))
			continue;
		while (at < count && to[at] != owner)
			at++;
		if (at == count) {
			to[count] = owner;
			weight[count++] = 0;
		}
		weight[at] += share[k] / sum;
	}
	return count;
}
