/* SPDX-License-Identifier: MIT */
#include "bake/tiles/coarse.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

/* The triangle around a direction has its corners among this many nearest coarse nodes: a node has
 * at most six neighbours. */
#define NEAR 8
/* Weights and volumes below this are 0, but for rounding. */
#define ROUNDING 1e-9

struct corners {
	int node[3];
	double weight[3]; /* >= 0, sum 1 */
	double miss;	  /* chord between the direction and the weighted mean; 0: the direction is
			     in the triangle */
	double perimeter;
};

static double coarse_dot(const double a[3], const double b[3])
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static double triple_product(const double a[3], const double b[3], const double c[3])
{
	return a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) +
	       a[2] * (b[0] * c[1] - b[1] * c[0]);
}

static double chord(const double a[3], const double b[3])
{
	return sqrt(fmax(2 - 2 * coarse_dot(a, b), 0));
}

/* Finds the NEAR nearest nodes, nearest first. Returns their number. */
static int near_nodes(const struct dome *dome, const double dir[3], int out[NEAR])
{
	double closeness[NEAR];
	int count = 0;

	for (int k = 0; k < dome->count; k++) {
		const double is = coarse_dot(dome->direction[k], dir);
		int at = count < NEAR ? count : NEAR;

		while (at > 0 && closeness[at - 1] < is) {
			if (at < NEAR) {
				closeness[at] = closeness[at - 1];
				out[at] = out[at - 1];
			}
			at--;
		}
		if (at == NEAR)
			continue;
		closeness[at] = is;
		out[at] = k;
		count += count < NEAR;
	}
	return count;
}

/* Computes the weights of three nodes, and their miss. Returns false if they lie on one great
 * circle. */
static bool weigh_triangle(const struct dome *dome, const double dir[3], struct corners *c)
{
	const double *a = dome->direction[c->node[0]], *b = dome->direction[c->node[1]];
	const double *d = dome->direction[c->node[2]];
	const double volume = triple_product(a, b, d);
	double sum = 0, mean[3] = {0, 0, 0};

	if (fabs(volume) < ROUNDING)
		return false;
	c->weight[0] = triple_product(dir, b, d) / volume;
	c->weight[1] = triple_product(a, dir, d) / volume;
	c->weight[2] = triple_product(a, b, dir) / volume;
	for (int k = 0; k < 3; k++) {
		c->weight[k] = c->weight[k] < ROUNDING ? 0 : c->weight[k];
		sum += c->weight[k];
	}
	if (!(sum > 0))
		return false;
	for (int k = 0; k < 3; k++) {
		c->weight[k] /= sum;
		for (int x = 0; x < 3; x++)
			mean[x] += c->weight[k] * dome->direction[c->node[k]][x];
	}
	sum = sqrt(coarse_dot(mean, mean));
	for (int x = 0; x < 3; x++)
		mean[x] /= sum;
	c->miss = chord(mean, dir);
	if (c->miss < 1e-7)
		c->miss = 0;
	c->perimeter = chord(a, b) + chord(b, d) + chord(d, a);
	return true;
}

static void choose_triangle(const struct dome *dome, const double dir[3], struct corners *best)
{
	int near[NEAR];
	const int count = near_nodes(dome, dir, near);

	best->miss = INFINITY;
	for (int i = 0; i < count; i++)
		for (int j = i + 1; j < count; j++)
			for (int k = j + 1; k < count; k++) {
				struct corners c = {.node = {near[i], near[j], near[k]}};

				if (!weigh_triangle(dome, dir, &c))
					continue;
				if (c.miss < best->miss ||
				    (c.miss == best->miss && c.perimeter < best->perimeter))
					*best = c;
			}
}

/* Rounds the weights down to integers; the largest gets the remainder, so that the sum is kept. */
static void store_weights(const struct corners *c, struct basis_coarse *to)
{
	int weight[3], left = BASIS_COARSE_ONE, largest = 0, used = 0;
	int order[3] = {0, 1, 2};

	for (int k = 0; k < 3; k++) {
		weight[k] = (int)(c->weight[k] * BASIS_COARSE_ONE);
		left -= weight[k];
		if (c->weight[k] > c->weight[largest])
			largest = k;
	}
	weight[largest] += left;
	for (int pass = 0; pass < 2; pass++)
		for (int k = 0; k < 2; k++)
			if (c->node[order[k]] > c->node[order[k + 1]]) {
				const int swap = order[k];

				order[k] = order[k + 1];
				order[k + 1] = swap;
			}
	memset(to, 0, sizeof(*to));
	for (int k = 0; k < 3; k++) {
		if (!weight[order[k]])
			continue;
		to->index[used] = (uint16_t)c->node[order[k]];
		to->weight[used++] = (uint16_t)weight[order[k]];
	}
}

void coarse_fill(const struct dome *fine, const struct dome *coarse, struct basis_coarse *gather)
{
	for (int i = 0; i < fine->count; i++) {
		struct corners best = {.miss = 0};

		choose_triangle(coarse, fine->direction[i], &best);
		store_weights(&best, &gather[i]);
	}
}
