/* SPDX-License-Identifier: MIT */
/* Groups of lights: which lights are in a group, and what counts as common to them. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "bake/tiles/coarse.h"
#include "hal/basis/basis_groups.h"
#include "tests/support/chance.h"
#include "tests/support/expect.h"
#include "tests/support/test.h"

#define FINE 8
#define COARSE 3

struct domes {
	struct dome fine, few;
	struct basis_coarse *gather;
	struct basis_groups groups;
	double *weight, *share;
	double (*x)[4];
};

static int groups_begin(void **state)
{
	struct domes *d = calloc(1, sizeof(*d));
	struct fault fault;
	size_t n;

	assert_int_equal(dome_create(&d->fine, FINE, &fault), 0);
	assert_int_equal(dome_create(&d->few, COARSE, &fault), 0);
	n = (size_t)d->fine.count;
	d->gather = calloc(n, sizeof(*d->gather));
	d->weight = calloc(n, sizeof(*d->weight));
	d->share = calloc(n, sizeof(*d->share));
	d->x = calloc(n, sizeof(*d->x));
	coarse_fill(&d->fine, &d->few, d->gather);
	assert_int_equal(basis_groups_create(&d->groups, d->gather, d->fine.count, d->few.count),
			 0);
	for (size_t i = 0; i < n; i++)
		d->weight[i] = d->fine.solid_angle_sr[i];
	basis_groups_share(&d->groups, d->weight, d->share);
	*state = d;
	return 0;
}

static int groups_end(void **state)
{
	struct domes *d = *state;

	basis_groups_free(&d->groups);
	dome_free(&d->fine);
	dome_free(&d->few);
	free(d->gather);
	free(d->weight);
	free(d->share);
	free(d->x);
	free(d);
	return 0;
}

/* Each light is in exactly one group: that of the coarse light with its largest weight. */
TEST_BETWEEN("all lights are in groups", groups_begin, groups_end)
{
	const struct domes *d = *state;
	const struct basis_groups *g = &d->groups;
	int met = 0;

	assert_int_equal(g->count, d->few.count);
	assert_int_equal(g->first[0], 0);
	assert_int_equal(g->first[g->count], d->fine.count);
	for (int k = 0; k < g->count; k++) {
		double sum = 0;

		for (uint32_t n = g->first[k]; n < g->first[k + 1]; n++, met++) {
			const struct basis_coarse *to = &d->gather[g->light[n]];
			int most = 0, of_k = 0;

			for (int j = 0; j < 3; j++) {
				most = to->weight[j] > most ? to->weight[j] : most;
				of_k = to->weight[j] && to->index[j] == k ? to->weight[j] : of_k;
			}
			expect_equal(of_k, most, "k=%d, n=%u", k, n);
			expect_equal(g->of[g->light[n]], k, "k=%d, n=%u", k, n);
			expect_that(n == g->first[k] || g->light[n] > g->light[n - 1], "k=%d, n=%u",
				    k, n);
			sum += d->share[g->light[n]];
		}
		if (g->first[k] < g->first[k + 1])
			expect_below(fabs(sum - 1), 1e-12, "k=%d", k);
	}
	assert_int_equal(met, d->fine.count);
}

TEST("own lights have no groups")
{
	struct basis_groups none;

	assert_int_equal(basis_groups_create(&none, NULL, 6, 6), 0);
	assert_int_equal(none.count, 0);
	basis_groups_free(&none);
	basis_groups_free(&none);
}

static const double any[3] = {1e9, 1e9, 1e9};

static int size_of(const struct domes *d, int k)
{
	return (int)(d->groups.first[k + 1] - d->groups.first[k]);
}

/* An even sky is common to all lights. A lamp or two among three or more lights change nothing, and
 * one light has nothing in common with dark ones. */
TEST_BETWEEN("a lamp is not common", groups_begin, groups_end)
{
	struct domes *d = *state;
	double even[3];

	for (int k = 0; k < d->groups.count; k++) {
		const uint16_t *light = d->groups.light + d->groups.first[k];
		const int size = size_of(d, k);

		for (int lamps = 0; lamps < (size > 3 ? 3 : size); lamps++) {
			for (int n = 0; n < size; n++)
				for (int c = 0; c < 3; c++)
					d->x[light[n]][c] = d->share[light[n]] * (c + 1) *
							    (n < lamps ? 1000 * (n + 1) : 1);
			basis_group_even(&d->groups, k, d->share, (const double(*)[4])d->x, any,
					 even);
			for (int c = 0; c < 3; c++)
				expect_below(fabs(even[c] - (c + 1)), 1e-9, "k=%d, lamps=%d, c=%d",
					     k, lamps, c);
		}
		for (int n = 0; n < size; n++)
			for (int c = 0; c < 3; c++)
				d->x[light[n]][c] = n ? 0 : 1;
		basis_group_even(&d->groups, k, d->share, (const double(*)[4])d->x, any, even);
		expect_equal(even[0], (size > 1 ? 0 : 1), "k=%d", k);
	}
}

/* In any light, S is not negative, at most what the whole group sends, and within its limit. */
TEST_BETWEEN("even light is bounded", groups_begin, groups_end)
{
	struct chance chance = chance_begin("groups");
	struct domes *d = *state;

	for (int run = 0; run < 3000; run++) {
		const int k = chance_int(&chance, 0, d->groups.count - 1), size = size_of(d, k);
		const uint16_t *light = d->groups.light + d->groups.first[k];
		const double most[3] = {chance_real(&chance, 0, 1), 0, 1e9};
		double all[3] = {0}, even[3];

		for (int n = 0; n < size; n++)
			for (int c = 0; c < 3; c++) {
				const double size_of_it = ldexp(1, chance_int(&chance, -60, 20));

				d->x[light[n]][c] = chance_int(&chance, 0, 3) * size_of_it;
				all[c] += d->x[light[n]][c];
			}
		basis_group_even(&d->groups, k, d->share, (const double(*)[4])d->x, most, even);
		for (int c = 0; c < 3; c++)
			expect_that(even[c] >= 0 && even[c] <= all[c] && even[c] <= most[c],
				    "run=%d, c=%d", run, c);
	}
}

/* Where no light of a group can arrive, no light has a share, and nothing is divided by zero. */
TEST_BETWEEN("groups without weight", groups_begin, groups_end)
{
	struct domes *d = *state;
	double even[3];

	memset(d->weight, 0, (size_t)d->fine.count * sizeof(*d->weight));
	basis_groups_share(&d->groups, d->weight, d->share);
	for (int i = 0; i < d->fine.count; i++) {
		expect_equal(d->share[i], 0, "i=%d", i);
		d->x[i][0] = d->x[i][1] = d->x[i][2] = 0;
	}
	basis_group_even(&d->groups, 0, d->share, (const double(*)[4])d->x, any, even);
	assert_true(even[0] == 0 && even[1] == 0 && even[2] == 0);
}

/* cut_group = max(cut, min(cut * sqrt(N / K), BASIS_GROUP_CUT)) */
TEST("cuts of groups")
{
	const struct basis_groups many = {.lights = 6400, .count = 400}, none = {.lights = 400};

	assert_true(fabs(basis_group_cut(&many, 0.0001) - 0.0004) < 1e-15);
	assert_true(basis_group_cut(&many, 0.0005) == BASIS_GROUP_CUT);
	assert_true(basis_group_cut(&many, 0.003) == 0.003);
	assert_true(basis_group_cut(&many, 0) == 0);
	assert_true(basis_group_cut(&none, 0.0005) == 0.0005);
}
