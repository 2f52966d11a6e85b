/* SPDX-License-Identifier: MIT */
/* The parts of the compositor (integer arithmetic, light as integers, choice of columns, division
 * of work) against exact numbers. */
#include <float.h>
#include <math.h>
#include <stdlib.h>

#include "hal/compositor/column_choice.h"
#include "hal/compositor/division.h"
#include "hal/compositor/kernels/digits.h"
#include "hal/compositor/kernels/fixed.h"
#include "hal/compositor/kernels/kernels.h"
#include "hal/compositor/light/light_vector.h"
#include "tests/support/basis/synthetic_basis.h"
#include "tests/support/chance.h"
#include "tests/support/expect.h"
#include "tests/support/test.h"

typedef __int128 wide;

/* ---- arithmetic ---- */

static wide exact_round_shift(wide x, int n)
{
	return (x + ((wide)1 << (n - 1))) >> n;
}

TEST("tints round like exact products")
{
	struct chance chance = chance_begin("tints");
	const int64_t edge[] = {0, 1, -1, 32767, -32768, INT64_C(1) << 60, -(INT64_C(1) << 60)};

	for (int k = 0; k < 1000000; k++) {
		const int64_t x = k % 3 ? (int64_t)chance_bits(&chance) >>
						  chance_int(&chance, 3, 62)
					: edge[chance_int(&chance, 0, 6)];
		const uint16_t m = k % 5 ? (uint16_t)chance_bits(&chance) : UINT16_MAX;

		expect_that(mul_q15(x, m) == exact_round_shift((wide)x * m, 15), "x %lld, m %d",
			    (long long)x, m);
	}
}

TEST("quotients are near exact ones")
{
	struct chance chance = chance_begin("quotients");

	for (int k = 0; k < 1000000; k++) {
		const int64_t n = (int64_t)chance_bits(&chance) >> chance_int(&chance, 0, 62);
		const int64_t d = (int64_t)(chance_bits(&chance) >> chance_int(&chance, 1, 63)) + 1;
		const int exponent = chance_int(&chance, -90, 90);
		const long double exact = ldexpl((long double)n / (long double)d, exponent + 24);
		const long double limit = KERNEL_LIMIT;
		const long double clamped = exact > limit ? limit : exact < -limit ? -limit : exact;
		const int32_t got = quotient_q24(n, d, exponent, KERNEL_LIMIT);

		expect_at_most(fabsl(got - clamped), 0.5L + fabsl(clamped) * 0x1p-29L,
			       "%lld / %lld * 2^%d", (long long)n, (long long)d, exponent);
	}
	assert_int_equal(quotient_q24(0, 5, 600, KERNEL_LIMIT), 0);
	assert_int_equal(quotient_q24(INT64_MIN + 1, 1, 0, KERNEL_LIMIT), -KERNEL_LIMIT);
}

TEST("digits hold what was split")
{
	struct chance chance = chance_begin("digits");

	for (int k = 0; k < 1000000; k++) {
		const int64_t half = (INT64_C(1) << 46) >> chance_int(&chance, 0, 46);
		const int64_t x = k % 4 == 0   ? half
				  : k % 4 == 1 ? -half
					       : (int64_t)chance_bits(&chance) % (half + 1);
		const int digits = digits_of(x < 0 ? -x : x);
		int64_t back = 0;
		int16_t digit;

		for (int d = KERNEL_DIGITS - 1; d >= 0; d--) {
			digits_split(&x, 1, d, &digit);
			assert_in_range(digit + 2048, 0, 4095);
			expect_that(d < digits || digit == 0, "digit %d of %lld", d, (long long)x);
			back = back * 4096 + digit;
		}
		expect_that(back == x, "%lld became %lld", (long long)x, (long long)back);
	}
	assert_int_equal(digits_of(0), 0);
	assert_int_equal(digits_of(2047), 1);
	assert_int_equal(digits_of(2048), 2);
	assert_int_equal(digits_of(2047 * 4097), 2);
	assert_int_equal(digits_of(2047 * 4097 + 1), 3);
}

TEST("exponents are the least")
{
	for (int e = -140; e < 140; e++) {
		expect_equal(exponent_above(ldexp(1, e)), e, "2^%d", e);
		expect_equal(exponent_above(ldexp(1.0001, e)), e + 1, "1.0001 * 2^%d", e);
	}
	assert_int_equal(gain_bits(0), 0);
	assert_int_equal(gain_bits(1), 0);
	assert_int_equal(gain_bits(1.5), 1);
	assert_int_equal(gain_bits(64), 6);
}

/* ---- light ---- */

static int64_t y_of(const struct light_vector *v, int c, int k)
{
	int64_t sum = 0;

	for (int d = v->planes[c].digits - 1; d >= 0; d--)
		sum = sum * 4096 + v->planes[c].digit[d][k];
	return sum;
}

/* X is the rounded light, Y what the coarse lights gather of X. Both keep to their ranges in any
 * light. */
TEST("light is rounded once")
{
	static const struct synthetic_options o = {.width = 1,
						   .height = 1,
						   .lights = 500,
						   .coarse = 70,
						   .grounds = 2,
						   .patterns = 1,
						   .ground_share = 1,
						   .seed = 2};
	struct chance chance = chance_begin("light");
	struct light_selection s;
	struct light_terms terms;
	struct light_vector v;
	struct synthetic file;

	synthetic_open(&file, &o);
	assert_int_equal(light_selection_create(&s, &file.basis), 0);
	assert_int_equal(light_terms_create(&terms, &file.basis), 0);
	assert_int_equal(light_vector_create(&v, &terms), 0);
	for (int k = 0; k < 400; k++) {
		const double top = k % 8 == 7 ? (double)FLT_MAX
					      : ldexp(1, chance_int(&chance, -149, 120));
		const int kind = k % 4;

		for (int i = 0; i < o.lights; i++)
			for (int c = 0; c < 3; c++)
				s.radiance[i][c] = k % 3    ? top * chance_real(&chance, 0, 1)
						   : i == k ? top
							    : ldexp(top, -20);
		s.ambient[1] = k % 5 ? 0 : top;
		light_vector_make(&v,
				  &(struct light_order){.kind = kind == 0    ? BASIS_KIND_T
								: kind > 1   ? BASIS_KIND_V
								: k % 8 == 1 ? BASIS_KIND_U
									     : BASIS_KIND_D,
							.ground = kind > 1 ? kind - 2 : 0,
							.gain = k % 3 ? 1 : 64,
							.patterns = true,
							.cut = kind != 1},
				  &s);
		for (int c = 0; c < 3; c++) {
			double sum = 0, gathered = 0, there = 0;

			for (int i = 0; i < o.lights; i++) {
				const double l = s.radiance[i][c] + s.ambient[c];
				const double u = basis_ground(&file.basis, kind > 1 ? kind - 2 : 0,
							      c)[i];
				const double x = v.sent[i].amount[c] / v.unit[c];

				expect_equal(x, floor(x), "light %d, channel %d, lighting %d", i, c,
					     k);
				expect_at_least(x, 0, "light %d, channel %d, lighting %d", i, c, k);
				sum += x;
				there += u * (l + 0x1p-20);
				if (kind == 0)
					expect_at_most(
						fabs(v.sent[i].amount[c] -
						     l * file.basis.lights[i].solid_angle_sr),
						0.5 * v.unit[c],
						"light %d, channel %d, lighting %d", i, c, k);
			}
			expect_below(sum, 0x1p46, "channel %d, lighting %d", c, k);
			for (int n = 0; n < o.coarse; n++) {
				double exact = 0;

				for (int i = 0; i < o.lights; i++)
					for (int j = 0; j < 3; j++)
						if (file.basis.coarse[i].index[j] == n)
							exact += v.sent[i].amount[c] / v.unit[c] *
								 file.basis.coarse[i].weight[j] /
								 BASIS_COARSE_ONE;
				expect_at_most(fabs((double)y_of(&v, c, n) - exact),
					       0.5 + exact * 1e-12,
					       "coarse light %d, channel %d, lighting %d", n, c, k);
				gathered += (double)y_of(&v, c, n);
			}
			expect_below(gathered * v.unit[c], ldexp(1, v.reach),
				     "channel %d, lighting %d", c, k);
			expect_below(sum * v.unit[c], ldexp(1, v.reach), "channel %d, lighting %d",
				     c, k);
			if (kind != 1) {
				const double per_x = kind == 0 ? (k % 3 ? 1 : 64)
							       : ldexp(v.factor[c], -30);

				expect_at_most(fmax(sum, gathered) * v.unit[c] * per_x, v.strongest,
					       "channel %d, lighting %d", c, k);
				expect_that(kind == 0 || v.strongest < 1.0001,
					    "strongest is %g, lighting %d", v.strongest, k);
			}
			for (int n = o.coarse; n < v.stride; n++)
				expect_equal(y_of(&v, c, n), 0,
					     "padding %d, channel %d, lighting %d", n, c, k);
			/* Shares of the ground's light and e add up to 1, however dim the light. */
			if (kind > 1 && there > 1e-30)
				expect_that(v.factor[c] > 1 << 29 && v.factor[c] <= 1 << 30,
					    "factor %d, channel %d, lighting %d", v.factor[c], c,
					    k);
		}
	}
	light_vector_free(&v);
	light_vector_free(&v);
	light_terms_free(&terms);
	light_selection_free(&s);
	synthetic_close(&file);
}

/* ---- columns ---- */

#define CHOICE_LIGHTS 130
#define CHOICE_BLOCKS 40

/* Blocks of two grounds and without ground, with columns for some of the lights. */
struct choosing {
	struct basis_block block[CHOICE_BLOCKS];
	struct block_plan plan[CHOICE_BLOCKS];
	uint16_t light[CHOICE_BLOCKS][CHOICE_LIGHTS];
	float scale[CHOICE_BLOCKS][CHOICE_LIGHTS];
	struct light_sent sent[CHOICE_LIGHTS];
};

/* A random number: zero of either sign, a power of two, or a value close to another one. */
static double any_size(struct chance *chance, int least, int most)
{
	const double power = ldexp(1, chance_int(chance, least, most));
	const int way = chance_int(chance, 0, 9);

	return way == 0	 ? 0.0 * chance_int(chance, -1, 1)
	       : way < 3 ? power
			 : power * chance_real(chance, 0.9, 1.1);
}

static void fill_choosing(struct choosing *c, struct chance *chance)
{
	for (int k = 0; k < CHOICE_BLOCKS; k++) {
		struct basis_block *b = &c->block[k];
		const int share = chance_int(chance, 0, 3);

		*b = (struct basis_block){.kind = k % 5 ? BASIS_KIND_V : BASIS_KIND_T,
					  .ground = k % 5 ? k % 2 : 0,
					  .light = c->light[k],
					  .column_scale = c->scale[k]};
		for (int i = 0; i < CHOICE_LIGHTS; i++) {
			if (chance_int(chance, 1, 3) > share)
				continue;
			c->light[k][b->columns] = (uint16_t)i;
			/* every fourth column has a tiny scale, some below the smallest normal
			 * float */
			c->scale[k][b->columns++] = (float)(i % 4 ? any_size(chance, -20, -10)
								  : any_size(chance, -149, -120));
		}
		c->plan[k] = (struct block_plan){.block = b, .reach = k % 3 ? 127 : 1};
	}
}

static void check_choice(const struct choosing *c, const struct column_choice *choice,
			 enum basis_kind kind, int ground, long counted[2])
{
	for (int k = 0; k < CHOICE_BLOCKS; k++) {
		const struct block_plan *plan = &c->plan[k];
		const struct chosen_column *chosen;
		int count, met = 0;

		if (plan->block->kind != kind || plan->block->ground != ground ||
		    !plan->block->columns) {
			expect_that(plan->choice != choice, "k=%d", k);
			continue;
		}
		assert_ptr_equal(plan->choice, choice);
		chosen = columns_chosen(plan, &count);
		for (int n = 0; n < plan->block->columns; n++) {
			const int i = plan->block->light[n];
			const float reach = plan->block->column_scale[n] * plan->reach;

			counted[0]++;
			if (c->sent[i].strength * (double)reach < 1)
				continue;
			expect_below(met, count, "column %d of block %d", n, k);
			expect_equal(chosen[met].place, n, "column %d of block %d", n, k);
			expect_equal(chosen[met].light, i, "column %d of block %d", n, k);
			expect_equal(chosen[met].scale, plan->block->column_scale[n],
				     "column %d of block %d", n, k);
			met++;
			counted[1]++;
		}
		expect_equal(met, count, "columns of block %d", k);
	}
}

/* A block gets exactly the columns that count by the definition, in their order. */
TEST("columns that count are chosen")
{
	struct chance chance = chance_begin("columns");
	struct choosing *c = calloc(1, sizeof(*c));
	struct column_choice choice[3];
	struct light_vector v = {.lights = CHOICE_LIGHTS, .sent = c->sent};
	const struct light_terms terms = {.lights = CHOICE_LIGHTS,
					  .groups = {.lights = CHOICE_LIGHTS}};
	long counted[2] = {0};

	for (int file = 0; file < 10; file++) {
		fill_choosing(c, &chance);
		for (int k = 0; k < 3; k++)
			assert_int_equal(column_choice_create(&choice[k], c->plan, CHOICE_BLOCKS,
							      k ? BASIS_KIND_V : BASIS_KIND_T,
							      k == 2, &terms),
					 0);
		for (int frame = 0; frame < 60; frame++) {
			for (int i = 0; i < CHOICE_LIGHTS; i++)
				c->sent[i].strength =
					frame % 10 == 9 &&
							i % 4 ==
								/* in some frames no column may be
								 * left out */
								0
						? 0x1p900
						: fabs(any_size(&chance, 0, 20));
			for (int k = 0; k < 3; k++) {
				column_choice_make(&choice[k], &v);
				check_choice(c, &choice[k], k ? BASIS_KIND_V : BASIS_KIND_T, k == 2,
					     counted);
			}
		}
		for (int k = 0; k < 3; k++)
			column_choice_free(&choice[k]);
	}
	assert_true(counted[1] > counted[0] / 20 && counted[1] < counted[0] / 2);
	free(c);
}

/* ---- division ---- */

static void check_division(const struct division *d)
{
	assert_int_equal(d->first[0], 0);
	assert_int_equal(d->first[d->runs], d->tiles);
	for (int r = 0; r < d->runs; r++)
		expect_below(d->first[r], d->first[r + 1], "run %d of %d", r, d->runs);
}

/* A quarter of the tiles takes ten times as long, and the division must adapt. */
TEST("runs are divided by what they took")
{
	enum { TILES = 100, RUNS = 8 };
	double cost[TILES];
	struct division d;
	int64_t worst = 0;

	for (int t = 0; t < TILES; t++)
		cost[t] = 1;
	for (int runs = 1; runs <= TILES; runs++) {
		assert_int_equal(division_create(&d, runs, TILES, cost), 0);
		check_division(&d);
		division_free(&d);
	}
	assert_int_equal(division_create(&d, RUNS, TILES, cost), 0);
	for (int frame = 0; frame < 2000; frame++) {
		worst = 0;
		for (int r = 0; r < RUNS; r++) {
			int64_t took = 0;

			for (int t = d.first[r]; t < d.first[r + 1]; t++)
				took += t < 25 ? 1000 : 100;
			worst = took > worst ? took : worst;
			division_took(&d, r, took);
		}
		division_settle(&d);
		check_division(&d);
	}
	assert_true(worst <= 32500 / RUNS + 1000);
	division_free(&d);
	division_free(&d);
}
