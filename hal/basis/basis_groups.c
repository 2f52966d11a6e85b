/* SPDX-License-Identifier: MIT */
#include "hal/basis/basis_groups.h"

#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>

/* Largest number of rounds that remove outliers; each round may reveal more. */
#define PASSES 3

/* Returns the coarse light with the largest weight, the first of equals. */
static uint16_t group_of(const struct basis_coarse *gather)
{
	int most = 0;

	for (int k = 1; k < 3; k++)
		most = gather->weight[k] > gather->weight[most] ? k : most;
	return gather->index[most];
}

/* Counting sort, filled from the end. */
static void sort_by_group(struct basis_groups *g)
{
	for (int i = 0; i < g->lights; i++)
		g->first[g->of[i]]++;
	for (int k = 1; k <= g->count; k++)
		g->first[k] += g->first[k - 1];
	for (int i = g->lights - 1; i >= 0; i--)
		g->light[--g->first[g->of[i]]] = (uint16_t)i;
}

int basis_groups_create(struct basis_groups *g, const struct basis_coarse *gather, int lights,
			int coarse)
{
	*g = (struct basis_groups){.lights = lights, .count = gather ? coarse : 0};
	if (!gather)
		return 0;
	g->of = calloc((size_t)lights, sizeof(*g->of));
	g->first = calloc((size_t)coarse + 1, sizeof(*g->first));
	g->light = calloc((size_t)lights, sizeof(*g->light));
	if (!g->of || !g->first || !g->light) {
		basis_groups_free(g);
		return -ENOMEM;
	}
	for (int i = 0; i < lights; i++)
		g->of[i] = group_of(&gather[i]);
	sort_by_group(g);
	return 0;
}

void basis_groups_free(struct basis_groups *g)
{
	free(g->of);
	free(g->first);
	free(g->light);
	*g = (struct basis_groups){.count = 0};
}

void basis_groups_share(const struct basis_groups *g, const double *weight, double *share)
{
	for (int k = 0; k < g->count; k++) {
		double sum = 0;

		for (uint32_t n = g->first[k]; n < g->first[k + 1]; n++)
			sum += weight[g->light[n]];
		for (uint32_t n = g->first[k]; n < g->first[k + 1]; n++)
			share[g->light[n]] = sum > 0 ? weight[g->light[n]] / sum : 0;
	}
}

/* Sums over the lights that are no outliers, for each channel. Four channels, as x has, fill two
 * vectors of doubles. */
struct even {
	double sum[4]; /* of x / q */
	double count[4];
};

/* Limit of x / q: a light is an outlier if
 *     x / q > 3 (sum - x / q) / (count - 1)  <=>  x / q > 3 sum / (count + 2)
 * A single light is no outlier: its limit stays. */
static void lower_limits(const struct even *e, double limit[4])
{
	for (int c = 0; c < 4; c++)
		limit[c] = e->count[c] > 1 ? 3 * e->sum[c] / (e->count[c] + 2) : limit[c];
}

static inline void even_add(struct even *e, const double x[4], double per_share,
			    const double limit[4])
{
	for (int c = 0; c < 4; c++) {
		const double value = x[c] * per_share;
		const bool keep = value <= limit[c];

		e->sum[c] += keep ? value : 0;
		e->count[c] += keep;
	}
}

static bool same_lights(const struct even *a, const struct even *b)
{
	return a->count[0] == b->count[0] && a->count[1] == b->count[1] &&
	       a->count[2] == b->count[2];
}

double basis_group_cut(const struct basis_groups *groups, double column_cut)
{
	const double more = groups->count ? sqrt((double)groups->lights / groups->count) : 1;

	return fmax(column_cut, fmin(more * column_cut, BASIS_GROUP_CUT));
}

void basis_group_even(const struct basis_groups *g, int group, const double *share,
		      const double (*x)[4], const double most[3], double even[3])
{
	const uint32_t first = g->first[group], end = g->first[group + 1];
	struct even is = {.sum = {0}};
	double limit[4] = {HUGE_VAL, HUGE_VAL, HUGE_VAL, HUGE_VAL}, all[3] = {0};

	for (uint32_t n = first; n < end; n++) {
		const int i = g->light[n];

		if (share[i] <= 0)
			continue;
		even_add(&is, x[i], 1 / share[i], limit);
		for (int c = 0; c < 3; c++)
			all[c] += x[i][c];
	}
	for (int pass = 0; pass < PASSES; pass++) {
		struct even next = {.sum = {0}};
		bool same;

		lower_limits(&is, limit);
		for (uint32_t n = first; n < end; n++)
			if (share[g->light[n]] > 0)
				even_add(&next, x[g->light[n]], 1 / share[g->light[n]], limit);
		same = same_lights(&is, &next);
		is = next;
		if (same)
			break;
	}
	for (int c = 0; c < 3; c++) {
		even[c] = is.count[c] > 0 ? is.sum[c] / is.count[c] : 0;
		even[c] = even[c] < all[c] ? even[c] : all[c];
		even[c] = even[c] < most[c] ? even[c] : most[c];
	}
}
