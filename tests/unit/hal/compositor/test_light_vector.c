/* SPDX-License-Identifier: MIT */
/* Light vectors of many lights: Y, what coarse lights gather, is exact in any order of sums; other
 * sums run in the order that is written down; and threads that share the work change nothing. */
#include <float.h>
#include <math.h>
#include <string.h>

#include "hal/compositor/kernels/fixed.h"
#include "hal/compositor/light/light_vector.h"
#include "tests/support/basis/random_frame.h"
#include "tests/support/chance.h"
#include "tests/support/expect.h"
#include "tests/support/test.h"
#include "tests/support/thorough.h"

static const struct synthetic_options many = {
	.width = 20,
	.height = 17,
	.lights = 2503,
	.coarse = 90,
	.patterns = 3,
	.columns = 20,
	.layers = 1,
	.grounds = 3,
	.column_cut = 0.0005,
	.object_share = 0.4,
	.ground_share = 0.4,
	.stand_in_share = 0.3,
	.peak = 1,
	.bounce = 0.3,
	.seed = 4,
};

static void test_vector_fill(struct light_selection *s, struct chance *chance, double top)
{
	for (int i = 0; i < s->count; i++)
		for (int c = 0; c < 3; c++)
			s->radiance[i][c] = top * chance_real(chance, 0, 1) *
					    (chance_int(chance, 0, 9) ? 1 : 0);
}

/* X as an integer. */
static int64_t x_of(const struct light_vector *v, int i, int c)
{
	const double x = v->sent[i].amount[c] / v->unit[c];

	assert_true(x >= 0 && x == floor(x) && x < 0x1p46);
	return (int64_t)x;
}

static int64_t y_of(const struct light_vector *v, int c, int k)
{
	int64_t sum = 0;

	for (int d = v->planes[c].digits - 1; d >= 0; d--)
		sum = sum * 4096 + v->planes[c].digit[d][k];
	return sum;
}

static void check_gathered(const struct light_vector *v, const struct basis *basis)
{
	static __int128 sum[2503];

	for (int c = 0; c < 3; c++) {
		memset(sum, 0, sizeof(sum));
		for (int i = 0; i < v->lights; i++) {
			const struct basis_coarse own = {{(uint16_t)i}, {BASIS_COARSE_ONE}};
			const struct basis_coarse *g = basis->coarse ? &basis->coarse[i] : &own;

			for (int j = 0; j < 3; j++)
				sum[g->index[j]] += (__int128)x_of(v, i, c) * g->weight[j];
		}
		for (int k = 0; k < v->coarse; k++)
			expect_that(y_of(v, c, k) == (int64_t)((sum[k] + 16384) >> 15),
				    "coarse light %d of %d, channel %d", k, v->coarse, c);
	}
}

/* From light that is rounded to nothing up to integers that double cannot hold. Few of them would
 * show a wrong result, so there are many rounds. */
TEST("what is gathered is exact")
{
	struct chance chance = chance_begin("gathering");

	for (int coarse = 0; coarse < 2; coarse++) {
		struct synthetic_options o = many;
		struct light_selection s;
		struct light_terms terms;
		struct synthetic file;
		struct light_vector v;

		o.coarse = coarse ? many.coarse : 0;
		o.width = o.height = 1;
		synthetic_open(&file, &o);
		assert_int_equal(light_selection_create(&s, &file.basis), 0);
		assert_int_equal(light_terms_create(&terms, &file.basis), 0);
		assert_int_equal(light_vector_create(&v, &terms), 0);
		for (int n = 0; n < (coarse && thorough() ? 30 : 1) * 93; n++) {
			const int power = n % 93 * 3 - 149;

			for (int kind = 0; kind < BASIS_KIND_COUNT; kind++) {
				const struct light_order order = {.kind = (enum basis_kind)kind,
								  .ground = 1,
								  .gain = power % 2 ? 1 : 40,
								  .patterns = true};

				test_vector_fill(&s, &chance, ldexp(1, power));
				/* Few lamps among dark lights: long sums. */
				for (int c = 0; c < kind; c++)
					s.radiance[chance_int(&chance, 0, o.lights - 1)][c] =
						ldexp(chance_real(&chance, 1, 900), power);
				light_vector_make(&v, &order, &s);
				check_gathered(&v, &file.basis);
			}
		}
		light_vector_free(&v);
		light_terms_free(&terms);
		light_selection_free(&s);
		synthetic_close(&file);
	}
}

/* The order of README.md, Roundings: four parts, and part 0 takes the rest. */
static double sum_as_written(const double *term, int count)
{
	double part[4] = {0};

	for (int i = 0; i < count; i++)
		part[i < count / 4 * 4 ? i % 4 : 0] += term[i];
	return (part[0] + part[1]) + (part[2] + part[3]);
}

/* The sum of u is the same to the last bit, and so is the light's as far as any result depends on
 * it. */
TEST("sums run in the order that is written down")
{
	struct chance chance = chance_begin("order of sums");
	const struct light_order order = {.kind = BASIS_KIND_V, .ground = 2};
	double term[2503], all[2503];
	struct light_selection s;
	struct light_terms terms;
	struct synthetic file;
	struct light_vector v;

	synthetic_open(&file, &many);
	assert_int_equal(light_selection_create(&s, &file.basis), 0);
	assert_int_equal(light_terms_create(&terms, &file.basis), 0);
	assert_int_equal(light_vector_create(&v, &terms), 0);
	for (int k = 0; k < 50; k++) {
		test_vector_fill(&s, &chance, 1);
		light_vector_make(&v, &order, &s);
		for (int c = 0; c < 3; c++) {
			const double *u = basis_ground(&file.basis, 2, c);
			double there, scaled;

			for (int i = 0; i < many.lights; i++) {
				term[i] = u[i] * s.radiance[i][c];
				all[i] = u[i];
			}
			there = sum_as_written(term, many.lights) +
				0x1p-20 * sum_as_written(all, many.lights);
			expect_equal(terms.ground_sum[2][c], sum_as_written(all, many.lights),
				     "channel %d", c);
			scaled = there / power_of_two(ilogb(there));
			expect_equal(v.factor[c], llrint(0x1p30 * (1 / scaled)),
				     "channel %d, lighting %d", c, k);
			for (int i = 0; i < many.lights; i++) /* X: rounded once */
				expect_that(x_of(&v, i, c) ==
						    llrint(term[i] / power_of_two(ilogb(there)) *
							   0x1p27),
					    "light %d, channel %d, lighting %d", i, c, k);
		}
	}
	light_vector_free(&v);
	light_terms_free(&terms);
	light_selection_free(&s);
	synthetic_close(&file);
}

/* All kinds and three grounds, so that there is work to share. */
TEST("threads share vectors and change nothing")
{
	static const int threads[] = {2, 3, 5, 16};
	struct chance chance = chance_begin("threads");
	struct synthetic file;
	struct random_frame alone;

	synthetic_open(&file, &many);
	random_frame_begin(&alone, &file.basis, NULL, &chance);
	for (int t = 0; t < 4; t++) {
		const struct compositor_settings settings = {.gain = 1, .object = true};
		struct chance same = {1};
		struct random_frame shared;
		struct pool *pool;

		assert_int_equal(pool_create(&pool, threads[t]), 0);
		random_frame_begin(&shared, &file.basis, pool, &same);
		memcpy(shared.background, alone.background, alone.bytes);
		compositor_set(alone.compositor, &settings);
		compositor_set(shared.compositor, &settings);
		for (int k = 0; k < 60; k++) {
			test_vector_fill(&alone.lights, &chance,
					 pow(10, chance_real(&chance, -6, 4)));
			random_frame_run(&alone, 0);
			assert_int_equal(compositor_run(shared.compositor, 0, &alone.lights,
							&shared.backdrop, shared.out,
							shared.stride),
					 0);
			expect_same_picture(shared.out, alone.out, alone.stride, alone.bytes,
					    "frame %d, %d threads", k, threads[t]);
		}
		random_frame_end(&shared);
		pool_destroy(pool);
	}
	random_frame_end(&alone);
	synthetic_close(&file);
}
