/* SPDX-License-Identifier: MIT */
/* Patterns of full rank solve weighted least squares over the coarse lights, and fewer patterns
 * leave what truncating the weighted decomposition must leave. */
#include <math.h>
#include <stdlib.h>

#include "bake/encode/encode_rank.h"
#include "tests/support/bake/encode_rig.h"
#include "tests/support/chance.h"
#include "tests/support/expect.h"
#include "tests/support/test.h"

#define PIXELS 40 /* more than coarse lights, so that nothing is cut off */

struct rank_fit {
	struct encode_rig e;
	struct part part; /* only the fields that weights are read from */
	struct rank_patterns patterns;
	struct rank_finder finder;
	float *value; /* [lights][PIXELS] */
	double *left; /* [lights][PIXELS]: residual of value */
};

static void rank_fit_begin(struct rank_fit *f, struct chance *chance, int frequency, int coarse)
{
	const struct encode_settings *s;
	size_t n;

	*f = (struct rank_fit){.e = encode_rig_dome(frequency, coarse)};
	s = &f->e.settings;
	n = (size_t)s->lights;
	f->part.pixels = PIXELS;
	f->part.limit.weight = calloc(n, sizeof(float));
	f->value = calloc(n * PIXELS, sizeof(*f->value));
	f->left = calloc(n * PIXELS, sizeof(*f->left));
	assert_true(f->part.limit.weight && f->value && f->left);
	for (int p = 0; p < PIXELS; p++)
		f->part.limit.pixel_weight[p] = (float)chance_real(chance, 0.5, 2);
	for (size_t i = 0; i < n; i++) {
		f->part.limit.weight[i] = (float)chance_real(chance, 0.5, 2);
		for (int p = 0; p < PIXELS; p++)
			f->value[i * PIXELS + (size_t)p] = (float)chance_real(chance, -1, 1);
	}
	assert_int_equal(rank_patterns_create(&f->patterns, s), 0);
	assert_int_equal(rank_finder_create(&f->finder, s), 0);
}

static void rank_fit_end(struct rank_fit *f)
{
	rank_patterns_free(&f->patterns);
	rank_finder_free(&f->finder);
	free(f->part.limit.weight);
	free(f->value);
	free(f->left);
	encode_rig_end(&f->e);
}

/* Returns the weighted sum of squares that so many patterns leave. */
static double rank_fit_find(struct rank_fit *f, int most)
{
	const int n = f->e.settings.lights;
	double square = 0;

	assert_int_equal(rank_weigh(&f->finder, &f->part), 0);
	rank_find(&f->patterns, &f->finder, f->value, PIXELS, most);
	assert_int_equal(f->patterns.count,
			 most < f->e.settings.coarse ? most : f->e.settings.coarse);
	for (int i = 0; i < n; i++)
		for (int p = 0; p < PIXELS; p++) {
			double is = (double)f->value[i * PIXELS + p];

			for (int j = 0; j < f->patterns.count; j++)
				is -= (double)f->patterns.at_light[j * n + i] *
				      (double)f->patterns.coefficient[j * PIXELS + p];
			f->left[i * PIXELS + p] = is;
			square +=
				(double)(f->part.limit.weight[i] * f->part.limit.pixel_weight[p]) *
				is * is;
		}
	return square;
}

/* At the minimum of the weighted squares their slope is 0, along every coarse light. */
TEST("full rank is least squares")
{
	struct chance chance = chance_begin("ranks");
	const struct encode_settings *s;
	struct rank_fit f;

	rank_fit_begin(&f, &chance, 6, 2);
	s = &f.e.settings;
	rank_fit_find(&f, RANK_MOST);
	for (int p = 0; p < PIXELS; p++) {
		double slope[64] = {0}, size = 0;

		for (int i = 0; i < s->lights; i++) {
			const double by = (double)f.part.limit.weight[i] * f.left[i * PIXELS + p];

			for (int a = 0; a < 3; a++)
				slope[s->gather[i].index[a]] += by * s->gather[i].weight[a] /
								BASIS_COARSE_ONE;
			size += fabs(by);
		}
		for (int k = 0; k < s->coarse; k++)
			expect_below(fabs(slope[k]), 1e-3 * size, "pixel %d, coarse light %d", p,
				     k);
	}
	rank_fit_end(&f);
}

/* Each pattern takes away at least its share of what is left: the first j of m leave at most
 * 1 - j / m of all, as singular values fall. */
TEST("patterns come in order")
{
	struct chance chance = chance_begin("ranks in order");
	struct rank_fit f;
	double all = 0, before;

	rank_fit_begin(&f, &chance, 2, 2);
	for (int i = 0; i < f.e.settings.lights; i++)
		for (int p = 0; p < PIXELS; p++)
			all += (double)(f.part.limit.weight[i] * f.part.limit.pixel_weight[p] *
					f.value[i * PIXELS + p] * f.value[i * PIXELS + p]);
	before = all;
	for (int j = 1; j <= f.e.settings.coarse; j++) {
		const double square = rank_fit_find(&f, j);

		expect_at_most(square,
			       1.01 * all * (1 - (double)j / f.e.settings.coarse) + 1e-6 * all,
			       "%d patterns", j);
		expect_below(square, before, "%d patterns", j);
		before = square;
	}
	rank_fit_end(&f);
}
