/* SPDX-License-Identifier: MIT */
#include "hal/optics/dome_tents.h"

#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "hal/optics/dome_triangles.h"
#include "hal/optics/vec.h"

/* Points of Gauss quadrature per side of a facet, for integrals exact to 1e-14: in the largest
 * facets, those of the icosahedron, and in small ones. */
#define POINTS_MAX 20
#define POINTS_FEW 9
/* Least weight that is drawn: at 0 the density would be 0, and rounding could leave the light. */
#define INSIDE 1e-6
#define SMALL 0.15 /* facets of a smaller volume are small: about 30 degrees a side */
/* Relative tolerance of the sum of all solid angles. */
#define COVERED 1e-9

struct facet {
	int owner[3]; /* lights of its corners */
	double corner[3][3];
	double volume;		  /* of the parallelepiped of the three corners */
	double solid_angle_sr[3]; /* integral of each corner's weight */
	double projected_sr[3];
};

/* A facet's corner that belongs to a light: one piece of the light's support. */
struct tent_patch {
	int facet, corner;
	double azimuth;	      /* of the facet's middle around the node */
	double cumulative_sr; /* solid angle of the light's patches up to and including this one */
};

struct dome_tents {
	int facets, lights;
	struct facet *facet;
	/*
	 * [facets]: the dual basis of the corners. A point p = sum_k weight_k corner_k of the flat
	 * triangle has weight_k = edge_k . p; the ray of direction d meets it at
	 * d / (sum_k edge_k . d).
	 */
	double (*edge)[3][3];
	struct dome_lookup *lookup; /* finds facets */
	int *first; /* [lights + 1]: patches of light i are first[i] to first[i + 1] - 1 */
	struct tent_patch *patch;
	double *reach_rad; /* [lights] */
};

/* ---- facets ---- */

/* Gauss-Legendre quadrature on 0..1. */
struct gauss_rule {
	int points;
	double at[POINTS_MAX], weight[POINTS_MAX];
};

/* Finds the roots of the Legendre polynomial by Newton's method. */
static void fill_rule(struct gauss_rule *rule, int points)
{
	rule->points = points;
	for (int i = 0; i < points; i++) {
		double x = cos(M_PI * (i + 0.75) / (points + 0.5)), slope = 1;

		for (int step = 0; step < 8; step++) {
			double before = 1, here = x;

			for (int n = 2; n <= points; n++) {
				const double next = ((2 * n - 1) * x * here - (n - 1) * before) / n;

				before = here;
				here = next;
			}
			slope = points * (x * here - before) / (x * x - 1);
			x -= here / slope;
		}
		rule->at[i] = 0.5 * (1 - x);
		rule->weight[i] = 1 / ((1 - x * x) * slope * slope);
	}
}

/*
 * Integrates over the flat triangle. The solid angle of an element dA at the point p is
 *     volume / |p|^3 dA / (2 area)
 * The points are those of a unit square, one side of which collapses to corner 0.
 */
static void measure_facet(struct facet *f, const struct gauss_rule *rule)
{
	for (int n = 0; n < rule->points * rule->points; n++) {
		const int i = n / rule->points, j = n % rule->points;
		const double x = rule->at[i], y = rule->at[j];
		const double share[3] = {1 - x, x * (1 - y), x * y};
		double p[3], away, sr;

		for (int c = 0; c < 3; c++)
			p[c] = share[0] * f->corner[0][c] + share[1] * f->corner[1][c] +
			       share[2] * f->corner[2][c];
		away = vec_length(p);
		sr = rule->weight[i] * rule->weight[j] * x * f->volume / (away * away * away);
		for (int k = 0; k < 3; k++) {
			f->solid_angle_sr[k] += sr * share[k];
			f->projected_sr[k] += sr * share[k] * p[2] / away;
		}
	}
}

static void fill_facet(struct dome_tents *t, const struct dome_triangles *triangles, int number)
{
	struct facet *f = &t->facet[number];
	double(*edge)[3] = t->edge[number];

	for (int k = 0; k < 3; k++) {
		const int vertex = triangles->corner[number][k];

		f->owner[k] = triangles->owner[vertex];
		memcpy(f->corner[k], triangles->vertex[vertex], sizeof(f->corner[k]));
	}
	for (int k = 0; k < 3; k++)
		vec_cross(f->corner[(k + 1) % 3], f->corner[(k + 2) % 3], edge[k]);
	f->volume = vec_dot(f->corner[0], edge[0]);
	for (int k = 0; k < 3; k++)
		for (int x = 0; x < 3; x++)
			edge[k][x] /= f->volume;
}

/* Creates the lookup of facets. A cap around the middle that holds the corners holds the facet. */
static int index_facets(struct dome_tents *t)
{
	double(*middle)[3] = calloc((size_t)t->facets, sizeof(*middle));
	double *radius = calloc((size_t)t->facets, sizeof(*radius));
	int ret = middle && radius ? 0 : -ENOMEM;

	for (int n = 0; !ret && n < t->facets; n++) {
		const struct facet *f = &t->facet[n];

		for (int x = 0; x < 3; x++)
			middle[n][x] = f->corner[0][x] + f->corner[1][x] + f->corner[2][x];
		vec_normalize(middle[n]);
		for (int k = 0; k < 3; k++)
			radius[n] = fmax(radius[n], vec_angle(middle[n], f->corner[k]));
	}
	if (!ret)
		ret = dome_lookup_create(&t->lookup, radius, (const double(*)[3])middle, t->facets);
	free(middle);
	free(radius);
	return ret;
}

/* ---- lights ---- */

static double azimuth_around(const double node[3], const struct facet *f)
{
	const double axis[3] = {fabs(node[0]) < 0.6, fabs(node[0]) >= 0.6, 0};
	double e1[3], e2[3], middle[3];

	vec_cross(axis, node, e1);
	vec_cross(node, e1, e2);
	for (int x = 0; x < 3; x++)
		middle[x] = f->corner[0][x] + f->corner[1][x] + f->corner[2][x];
	return atan2(vec_dot(middle, e2), vec_dot(middle, e1));
}

static int by_azimuth(const void *pa, const void *pb)
{
	const struct tent_patch *a = pa, *b = pb;

	if (a->azimuth != b->azimuth)
		return a->azimuth < b->azimuth ? -1 : 1;
	if (a->facet != b->facet)
		return a->facet < b->facet ? -1 : 1;
	return a->corner - b->corner;
}

static void finish_light(struct dome_tents *t, int light, const double node[3])
{
	struct tent_patch *own = t->patch + t->first[light];
	const int count = t->first[light + 1] - t->first[light];
	double sum = 0;

	for (int k = 0; k < count; k++)
		own[k].azimuth = azimuth_around(node, &t->facet[own[k].facet]);
	qsort(own, (size_t)count, sizeof(*own), by_azimuth);
	for (int k = 0; k < count; k++) {
		const struct facet *f = &t->facet[own[k].facet];

		sum += f->solid_angle_sr[own[k].corner];
		own[k].cumulative_sr = sum;
		for (int c = 0; c < 3; c++)
			t->reach_rad[light] = fmax(t->reach_rad[light],
						   vec_angle(node, f->corner[c]));
	}
}

static int fill_lights(struct dome_tents *t, const double (*node)[3])
{
	int *next = calloc((size_t)t->lights + 1, sizeof(*next));

	t->first = calloc((size_t)t->lights + 1, sizeof(*t->first));
	t->patch = calloc(3 * (size_t)t->facets, sizeof(*t->patch));
	t->reach_rad = calloc((size_t)t->lights, sizeof(*t->reach_rad));
	if (!next || !t->first || !t->patch || !t->reach_rad) {
		free(next);
		return -ENOMEM;
	}
	for (int n = 0; n < 3 * t->facets; n++)
		t->first[t->facet[n / 3].owner[n % 3] + 1]++;
	for (int i = 0; i < t->lights; i++) {
		t->first[i + 1] += t->first[i];
		next[i + 1] = t->first[i + 1];
	}
	for (int n = 0; n < 3 * t->facets; n++) {
		const int light = t->facet[n / 3].owner[n % 3];

		t->patch[next[light]++] = (struct tent_patch){.facet = n / 3, .corner = n % 3};
	}
	for (int i = 0; i < t->lights; i++)
		finish_light(t, i, node[i]);
	free(next);
	return 0;
}

/* ---- creation ---- */

static int tents_fill(struct dome_tents *t, const struct dome_triangles *triangles,
		      const double (*node)[3])
{
	struct gauss_rule many, few;
	double sum = 0;
	int ret;

	t->facets = triangles->count;
	t->facet = calloc((size_t)t->facets, sizeof(*t->facet));
	t->edge = calloc((size_t)t->facets, sizeof(*t->edge));
	if (!t->facet || !t->edge)
		return -ENOMEM;
	fill_rule(&many, POINTS_MAX);
	fill_rule(&few, POINTS_FEW);
	for (int n = 0; n < t->facets; n++) {
		fill_facet(t, triangles, n);
		measure_facet(&t->facet[n], t->facet[n].volume < SMALL ? &few : &many);
		for (int k = 0; k < 3; k++)
			sum += t->facet[n].solid_angle_sr[k];
	}
	if (!(fabs(sum / (2 * M_PI) - 1) < COVERED))
		return -EINVAL;
	ret = index_facets(t);
	return ret < 0 ? ret : fill_lights(t, node);
}

int dome_tents_create(struct dome_tents **tents, const struct dome_cells *cells,
		      const struct dome_lookup *lookup, const double (*node)[3], int count)
{
	struct dome_tents *t = calloc(1, sizeof(*t));
	struct dome_triangles triangles;
	int ret;

	if (!t)
		return -ENOMEM;
	t->lights = count;
	ret = dome_triangles_create(&triangles, cells, lookup, node, count);
	if (ret == 0)
		ret = tents_fill(t, &triangles, node);
	dome_triangles_free(&triangles);
	if (ret < 0)
		dome_tents_destroy(t);
	else
		*tents = t;
	return ret;
}

void dome_tents_destroy(struct dome_tents *t)
{
	if (!t)
		return;
	free(t->facet);
	free(t->edge);
	free(t->first);
	free(t->patch);
	free(t->reach_rad);
	dome_lookup_destroy(t->lookup);
	free(t);
}

/* ---- weights of a direction ---- */

/* Weights of a facet's corners for dir, not normalised to sum 1. */
static void facet_weigh(const struct dome_tents *t, int facet, const double dir[3], double share[3])
{
	for (int k = 0; k < 3; k++)
		share[k] = vec_dot(t->edge[facet][k], dir);
}

/* The facet nearest to dir, for a direction on an edge that rounding puts outside of both
 * facets. */
static int nearest_facet(const struct dome_tents *t, const int *candidate, int count,
			 const double dir[3])
{
	double best = -INFINITY;
	int found = -1;

	for (int n = 0; n < count; n++) {
		double share[3], least;

		facet_weigh(t, candidate[n], dir, share);
		least = fmin(share[0], fmin(share[1], share[2]));
		if (share[0] + share[1] + share[2] > 0 && least > best) {
			best = least;
			found = candidate[n];
		}
	}
	return found;
}

/* The facet that holds dir; -1 below the horizon and for an invalid dir. share: weights >= 0, not
 * normalised; *sum: their sum. The ray meets the facet at dir / *sum. */
static int find_facet(const struct dome_tents *t, const double dir[3], double share[3], double *sum)
{
	int count, found = -1;
	const int *candidate = dome_lookup_candidates(t->lookup, dir, &count);

	for (int n = 0; n < count && found < 0; n++) {
		facet_weigh(t, candidate[n], dir, share);
		if (share[0] >= 0 && share[1] >= 0 && share[2] >= 0)
			found = candidate[n];
	}
	if (found < 0 && count > 0) {
		found = nearest_facet(t, candidate, count, dir);
		if (found >= 0)
			facet_weigh(t, found, dir, share);
	}
	*sum = 0;
	for (int k = 0; found >= 0 && k < 3; k++) {
		share[k] = share[k] > 0 ? share[k] : 0;
		*sum += share[k];
	}
	return *sum > 0 ? found : -1;
}

/* Lists the lights of a facet with shares, which are divided by their sum. */
static int facet_lights(const struct dome_tents *t, int facet, const double share[3], double sum,
			int light[3], double weight[3])
{
	int count = 0;

	for (int k = 0; facet >= 0 && k < 3; k++) {
		const int owner = t->facet[facet].owner[k];
		int at = 0;

		if (!(share[k] > 0))
			continue;
		while (at < count && light[at] != owner)
			at++;
		if (at == count) {
			light[count] = owner;
			weight[count++] = 0;
		}
		weight[at] += share[k] / sum;
	}
	return count;
}

int dome_tents_weights(const struct dome_tents *t, const double dir[3], int light[3],
		       double weight[3])
{
	double share[3], sum;
	const int facet = find_facet(t, dir, share, &sum);

	return facet_lights(t, facet, share, sum, light, weight);
}

/* Whether a facet holds dir; then lists its lights. */
static int facet_try(const struct dome_tents *t, int facet, const double dir[3], int light[3],
		     double weight[3])
{
	double share[3];

	facet_weigh(t, facet, dir, share);
	if (!(share[0] >= 0 && share[1] >= 0 && share[2] >= 0))
		return 0;
	return facet_lights(t, facet, share, share[0] + share[1] + share[2], light, weight);
}

int dome_tents_weights_near(const struct dome_tents *t, int node, int *facet, const double dir[3],
			    int light[3], double weight[3])
{
	int count = *facet < 0 ? 0 : facet_try(t, *facet, dir, light, weight);

	for (int n = t->first[node]; n < t->first[node + 1] && !count; n++) {
		*facet = t->patch[n].facet;
		count = facet_try(t, *facet, dir, light, weight);
	}
	return count ? count : dome_tents_weights(t, dir, light, weight);
}

/* ---- integrals and samples of a light ---- */

void dome_tents_measure(const struct dome_tents *t, int light, double *solid_angle_sr,
			double *projected_sr)
{
	*projected_sr = 0;
	for (int k = t->first[light]; k < t->first[light + 1]; k++)
		*projected_sr += t->facet[t->patch[k].facet].projected_sr[t->patch[k].corner];
	*solid_angle_sr = t->patch[t->first[light + 1] - 1].cumulative_sr;
}

double dome_tents_reach_rad(const struct dome_tents *t, int light)
{
	return t->reach_rad[light];
}

/*
 * Chooses a patch by its solid angle, and in its flat triangle a point whose density per area is
 * the corner's weight x: uniform along the far side, and x with density 6 x (1 - x). The code
 * inverts its integral 3 x^2 - 2 x^3 = v.
 */
void dome_tents_sample(const struct dome_tents *t, int light, double u, double v, double dir[3])
{
	const struct tent_patch *own = t->patch + t->first[light];
	const int last = t->first[light + 1] - t->first[light] - 1;
	const double wanted = u * own[last].cumulative_sr;
	const double x = fmax(0.5 - sin(asin(fmin(fmax(1 - 2 * v, -1), 1)) / 3), INSIDE);
	const struct facet *f;
	double below = 0, along;
	int n = 0, k;

	while (n < last && own[n].cumulative_sr <= wanted)
		below = own[n++].cumulative_sr;
	along = fmin((wanted - below) / (own[n].cumulative_sr - below), 1);
	f = &t->facet[own[n].facet];
	k = own[n].corner;
	for (int c = 0; c < 3; c++)
		dir[c] = x * f->corner[k][c] + (1 - x) * ((1 - along) * f->corner[(k + 1) % 3][c] +
							  along * f->corner[(k + 2) % 3][c]);
	dir[2] = fmax(dir[2], 0);
	vec_normalize(dir);
}

/* Density of the samples above: per area 3 x / area, times dA / dsr = 2 area |p|^3 / volume. */
double dome_tents_density(const struct dome_tents *t, int light, const double dir[3])
{
	const double whole_sr = t->patch[t->first[light + 1] - 1].cumulative_sr;
	double share[3], sum, density = 0, away;
	const int facet = find_facet(t, dir, share, &sum);
	const struct facet *f = t->facet + (facet < 0 ? 0 : facet);

	if (facet < 0)
		return 0;
	away = vec_length(dir) / sum;
	for (int k = 0; k < 3; k++)
		if (f->owner[k] == light)
			density += share[k] / sum * f->solid_angle_sr[k];
	return density * 6 * away * away * away / (f->volume * whole_sr);
}
