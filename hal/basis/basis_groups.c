#include "hal/basis/basis_groups.h"

#include <errno.h>
#include <stdlib.h>

/* How often what stands out is left out: of what is left, more may. */
#define PASSES 3

/* The coarse light that it gives most to, the first of equals. */
static uint16_t group_of(const struct basis_coarse *gather)
{
	int most = 0;

	for (int k = 1; k < 3; k++)
		most = gather->weight[k] > gather->weight[most] ? k : most;
	return gather->index[most];
}

/* Counted, and filled in from the end. */
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

/* Lights of a channel that do not stand out yet. */
struct even {
	double sum; /* of x / q */
	int count;
};

/* x / q > 3 (sum - x / q) / (count - 1), without a division by what may be 0. */
static double limit_of(const struct even *e)
{
	return 3 * e->sum / (e->count + 2);
}

void basis_group_even(const struct basis_groups *g, int group, const double *share,
		      const double (*x)[4], const double most[3], double even[3])
{
	const uint16_t *light = g->light + g->first[group];
	const int count = (int)(g->first[group + 1] - g->first[group]);
	struct even is[3] = {{0}};
	double all[3] = {0};

	for (int n = 0; n < count; n++) {
		const double q = share[light[n]];

		for (int c = 0; c < 3 && q > 0; c++) {
			is[c].sum += x[light[n]][c] / q;
			is[c].count++;
			all[c] += x[light[n]][c];
		}
	}
	for (int c = 0; c < 3; c++) {
		for (int pass = 0; pass < PASSES && is[c].count > 1; pass++) {
			const double limit = limit_of(&is[c]);
			struct even next = {0};

			for (int n = 0; n < count; n++) {
				const double q = share[light[n]], own = x[light[n]][c];

				if (q > 0 && own <= limit * q) {
					next.sum += own / q;
					next.count++;
				}
			}
			if (next.count == is[c].count)
				break;
			is[c] = next;
		}
		even[c] = is[c].count ? is[c].sum / is[c].count : 0;
		even[c] = even[c] < all[c] ? even[c] : all[c];
		even[c] = even[c] < most[c] ? even[c] : most[c];
	}
}
