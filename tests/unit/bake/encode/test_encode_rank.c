/* SPDX-License-Identifier: MIT */
/* Patterns of full rank solve weighted least squares over the coarse lights; lights that have lost
 * weight count by the mean of their group. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>
#include <stdlib.h>

#include "bake/encode/encode_rank.h"
#include "tests/support/bake/encode_rig.h"
#include "tests/support/chance.h"

#define PIXELS 40 /* more than coarse lights, so that nothing is cut off */

struct rank_fit {
	struct encode_rig e;
	struct basis_groups groups;
	struct part part; /* only the fields that a metric reads */
	struct rank_metric metric;
	struct rank_patterns patterns;
	struct rank_scratch scratch;
	float *weight, *value; /* [lights], [lights][PIXELS] */
	double *left;	       /* [lights][PIXELS]: residual of value */
};

static void fit_begin(struct rank_fit *f, struct chance *chance)
{
	struct encode_settings *s;
	size_t n;

	*f = (struct rank_fit){.e = encode_rig_dome(6, 2)};
	s = &f->e.settings;
	n = (size_t)s->lights;
	assert_int_equal(basis_groups_create(&f->groups, s->gather, s->lights, s->coarse), 0);
	s->groups = &f->groups;
	f->part.pixels = PIXELS;
	f->part.weight = calloc(n, sizeof(float));
	f->part.own_share = calloc(n, sizeof(double));
	f->weight = calloc(n, sizeof(*f->weight));
	f->value = calloc(n * PIXELS, sizeof(*f->value));
	f->left = calloc(n * PIXELS, sizeof(*f->left));
	assert_true(f->part.weight && f->part.own_share && f->weight && f->value && f->left);
	for (int p = 0; p < PIXELS; p++)
		f->part.pixel_weight[p] = 1;
	for (size_t i = 0; i < n; i++) {
		f->part.own_share[i] = f->e.light[i].solid_angle_sr;
		f->part.weight[i] = (float)chance_real(chance, 0.5, 2);
		for (int p = 0; p < PIXELS; p++)
			f->value[i * PIXELS + (size_t)p] = (float)chance_real(chance, -1, 1);
	}
	basis_groups_share(&f->groups, f->part.own_share, f->part.own_share);
	f->part.share = f->part.own_share;
	assert_int_equal(rank_metric_create(&f->metric, s), 0);
	assert_int_equal(rank_patterns_create(&f->patterns, s), 0);
	assert_int_equal(rank_scratch_create(&f->scratch, s), 0);
}

static void fit_end(struct rank_fit *f)
{
	rank_metric_free(&f->metric);
	rank_patterns_free(&f->patterns);
	rank_scratch_free(&f->scratch);
	basis_groups_free(&f->groups);
	free(f->part.weight);
	free(f->part.own_share);
	free(f->weight);
	free(f->value);
	free(f->left);
	encode_rig_end(&f->e);
}

static void encode_rank_find(struct rank_fit *f)
{
	const int n = f->e.settings.lights;

	assert_int_equal(rank_metric_set(&f->metric, &f->e.settings, &f->part, f->weight), 0);
	rank_find(&f->patterns, &f->e.settings, &f->metric, &f->scratch, f->value, PIXELS,
		  RANK_MOST);
	assert_int_equal(f->patterns.count, f->e.settings.coarse);
	for (int i = 0; i < n; i++)
		for (int p = 0; p < PIXELS; p++) {
			double is = (double)f->value[i * PIXELS + p];

			for (int j = 0; j < f->patterns.count; j++)
				is -= (double)f->patterns.at_light[j * n + i] *
				      (double)f->patterns.coefficient[j * PIXELS + p];
			f->left[i * PIXELS + p] = is;
		}
}

/* RMS, over groups and pixels, of the mean residual of a group's lights. */
static double left_of_means(const struct rank_fit *f)
{
	double square = 0;

	for (int g = 0; g < f->groups.count; g++)
		for (int p = 0; p < PIXELS; p++) {
			double mean = 0;

			for (uint32_t k = f->groups.first[g]; k < f->groups.first[g + 1]; k++)
				mean += f->part.share[f->groups.light[k]] *
					f->left[f->groups.light[k] * PIXELS + p];
			square += mean * mean;
		}
	return sqrt(square / (f->groups.count * PIXELS));
}

/* At the minimum of the weighted squares their slope is 0, along every coarse light. */
static void is_least(const struct rank_fit *f, double mean_weight)
{
	const struct encode_settings *s = &f->e.settings;

	for (int p = 0; p < PIXELS; p++) {
		double slope[64] = {0}, size = 0;

		for (int g = 0; g < f->groups.count; g++) {
			const uint16_t *light = f->groups.light + f->groups.first[g];
			const int count = (int)(f->groups.first[g + 1] - f->groups.first[g]);
			double lost = 0, shares = 0, mean = 0;

			for (int k = 0; k < count; k++) {
				const int i = light[k];
				const double less = (double)f->part.weight[i] -
						    (double)f->weight[i];

				if (less <= 0)
					continue;
				lost += less;
				shares += f->part.share[i];
				mean += f->part.share[i] * f->left[i * PIXELS + p];
			}
			for (int k = 0; k < count; k++) {
				const int i = light[k];
				const bool in = f->part.weight[i] > f->weight[i];
				const double by = (double)f->weight[i] * f->left[i * PIXELS + p] +
						  (in ? mean_weight * lost * mean / shares *
								   f->part.share[i] / shares
						      : 0);

				for (int a = 0; a < 3; a++)
					slope[s->gather[i].index[a]] +=
						by * s->gather[i].weight[a] / BASIS_COARSE_ONE;
				size += fabs(by);
			}
		}
		for (int k = 0; k < s->coarse; k++)
			if (fabs(slope[k]) > 1e-3 * size)
				fail_msg("pixel %d, coarse light %d: slope %g of %g", p, k,
					 slope[k], size);
	}
}

static void lost_weight_goes_to_means(void **state)
{
	struct chance chance = chance_begin("ranks");
	struct rank_fit f;
	double with, without;

	(void)state;
	fit_begin(&f, &chance);
	for (int i = 0; i < f.e.settings.lights; i++)
		f.weight[i] = f.part.weight[i];
	encode_rank_find(&f);
	is_least(&f, 0);

	for (int i = 0; i < f.e.settings.lights; i++)
		f.weight[i] *= i % 3 ? 0.001F : 1.5F;
	f.part.share = NULL; /* a part without groups */
	encode_rank_find(&f);
	f.part.share = f.part.own_share;
	without = left_of_means(&f);
	is_least(&f, 0);

	encode_rank_find(&f);
	with = left_of_means(&f);
	is_least(&f, RANK_MEAN_WEIGHT);
	assert_true(with < 0.7 * without);
	fit_end(&f);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(lost_weight_goes_to_means),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
