/* SPDX-License-Identifier: MIT */
/* Weights between a dome's nodes: their sum, their continuity, and what they are at the nodes. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "hal/optics/dome.h"
#include "hal/optics/dome_parts.h"
#include "hal/optics/vec.h"
#include "tests/support/chance.h"
#include "tests/support/expect.h"
#include "tests/support/test.h"

struct faceted {
	struct dome dome;
	struct dome_facets *facets;
};

static struct faceted faceted_of(int frequency)
{
	struct faceted f = {.facets = NULL};

	assert_int_equal(dome_create(&f.dome, frequency, NULL), 0);
	assert_int_equal(dome_facets_create(&f.facets, f.dome.cells, f.dome.lookup,
					    (const double(*)[3])f.dome.direction, f.dome.count),
			 0);
	return f;
}

static void faceted_free(struct faceted *f)
{
	dome_facets_destroy(f->facets);
	dome_free(&f->dome);
}

/* The weights of a direction: at most three nodes, none negative, sum 1; the same from whatever
 * node and facet the search begins. */
static void weigh(const struct faceted *f, const double dir[3], double *all)
{
	int to[3], again[3], facet = -1, last = 0;
	double weight[3], same[3], sum = 0;
	int count = dome_facets_weights(f->facets, dome_cell_of(&f->dome, dir), &facet, dir, to,
					weight);

	memset(all, 0, (size_t)f->dome.count * sizeof(*all));
	assert_in_range(count, 1, 3);
	for (int k = 0; k < count; k++) {
		expect_that(weight[k] > 0 && all[to[k]] == 0, "k=%d", k);
		all[to[k]] = weight[k];
		sum += weight[k];
	}
	assert_true(fabs(sum - 1) < 1e-15);
	count = dome_facets_weights(f->facets, f->dome.count - 1, &last, dir, again, same);
	assert_true(count > 0);
	for (int k = 0; k < count; k++)
		expect_below(fabs(same[k] - all[again[k]]), 1e-9, "k=%d", k);
}

/* When a lamp moves, no weight changes by more than the step's share of the distance to the next
 * node. */
static void check_step(const struct faceted *f, struct chance *chance, double *here, double *there)
{
	const double step = 1e-6;
	double from[3], to[3], spacing = atan(2) / f->dome.frequency;

	chance_direction(chance, 0, from);
	if (chance_int(chance, 0, 4) == 0) { /* along the horizon */
		from[2] *= 1e-3;
		vec_normalize(from);
	}
	for (int x = 0; x < 3; x++)
		to[x] = from[x] + step * chance_real(chance, -1, 1);
	to[2] = fmax(to[2], 0);
	weigh(f, from, here);
	weigh(f, to, there);
	for (int i = 0; i < f->dome.count; i++)
		/* The two nearest nodes to any node are some distance apart. Where the horizon is
		 * near the rim a triangle may be flat, so that its height gives no bound. */
		expect_below(fabs(here[i] - there[i]), 4 * sqrt(3) * step / (0.5 * spacing), "i=%d",
			     i);
}

TEST("continuous everywhere")
{
	static const int frequency[] = {1, 2, 3, 4, 5, 8, 9, 12};
	struct chance chance = chance_begin("facets");

	for (int n = 0; n < 8; n++) {
		struct faceted f = faceted_of(frequency[n]);
		double *here = calloc((size_t)f.dome.count, sizeof(*here));
		double *there = calloc((size_t)f.dome.count, sizeof(*there));

		assert_true(here && there);
		for (int k = 0; k < 4000; k++)
			check_step(&f, &chance, here, there);
		free(here);
		free(there);
		faceted_free(&f);
	}
}

/* In the flat triangle of its nodes, the ray of a direction meets their weighted mean. */
TEST("linear between nodes")
{
	struct chance chance = chance_begin("facets");

	for (int n = 3; n <= 9; n++) {
		struct faceted f = faceted_of(n);
		int inside = 0;

		for (int k = 0; k < 4000; k++) {
			int to[3], facet = -1, count;
			double dir[3], weight[3], mean[3] = {0}, across[3];

			chance_direction(&chance, 0, dir);
			count = dome_facets_weights(f.facets, 0, &facet, dir, to, weight);
			for (int j = 0; j < count; j++)
				for (int x = 0; x < 3; x++)
					mean[x] += weight[j] * f.dome.direction[to[j]][x];
			vec_cross(mean, dir, across);
			/* Above all triangles with a foot on the horizon. */
			if (dir[2] > 1.2 * atan(2) / n) {
				expect_below(vec_length(across), 1e-14, "f=%d, k=%d", n, k);
				inside++;
			}
		}
		expect_above(inside, 1500, "f=%d", n);
		faceted_free(&f);
	}
}

TEST("whole at the nodes")
{
	for (int n = 1; n <= 12; n++) {
		struct faceted f = faceted_of(n);
		double *all = calloc((size_t)f.dome.count, sizeof(*all));

		assert_non_null(all);
		for (int i = 0; i < f.dome.count; i++) {
			weigh(&f, f.dome.direction[i], all);
			expect_below(fabs(all[i] - 1), 1e-9, "f=%d, i=%d", n, i);
		}
		free(all);
		faceted_free(&f);
	}
}

TEST("no direction")
{
	static const double none[][3] = {
		{0, 0, 0}, {NAN, 0, 1}, {0, 0, NAN}, {INFINITY, 0, 1}, {1, 0, -1e-300}};
	struct faceted f = faceted_of(3);
	int to[3], facet = -1;
	double weight[3];

	for (size_t k = 0; k < sizeof(none) / sizeof(*none); k++)
		expect_equal(dome_facets_weights(f.facets, 0, &facet, none[k], to, weight), 0,
			     "k=%zu", k);
	assert_true(dome_facets_weights(f.facets, 0, &facet, (double[]){1, 0, -0.0}, to, weight) >
		    0);
	faceted_free(&f);
}
