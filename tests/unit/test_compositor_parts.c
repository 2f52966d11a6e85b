/* What the compositor is made of: its arithmetic and the light as integers, against exact numbers.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <float.h>

#include "hal/compositor/digits.h"
#include "hal/compositor/division.h"
#include "hal/compositor/fixed.h"
#include "hal/compositor/kernels.h"
#include "hal/compositor/light_vector.h"
#include "tests/synthetic_basis.h"

typedef __int128 wide;

/* ---- arithmetic ---- */

static wide exact_round_shift(wide x, int n)
{
	return (x + ((wide)1 << (n - 1))) >> n;
}

static void tints_round_like_exact_products(void **state)
{
	struct chance chance = chance_begin("tints");
	const int64_t edge[] = {0, 1, -1, 32767, -32768, INT64_C(1) << 60, -(INT64_C(1) << 60)};

	(void)state;
	for (int k = 0; k < 1000000; k++) {
		const int64_t x = k % 3 ? (int64_t)chance_bits(&chance) >>
						  chance_int(&chance, 3, 62)
					: edge[chance_int(&chance, 0, 6)];
		const uint16_t m = k % 5 ? (uint16_t)chance_bits(&chance) : UINT16_MAX;

		assert_true(mul_q15(x, m) == exact_round_shift((wide)x * m, 15));
	}
}

static void quotients_are_near_exact_ones(void **state)
{
	struct chance chance = chance_begin("quotients");

	(void)state;
	for (int k = 0; k < 1000000; k++) {
		const int64_t n = (int64_t)chance_bits(&chance) >> chance_int(&chance, 0, 62);
		const int64_t d = (int64_t)(chance_bits(&chance) >> chance_int(&chance, 1, 63)) + 1;
		const int exponent = chance_int(&chance, -90, 90);
		const long double exact = ldexpl((long double)n / (long double)d, exponent + 24);
		const long double limit = KERNEL_LIMIT;
		const long double clamped = exact > limit ? limit : exact < -limit ? -limit : exact;
		const int32_t got = quotient_q24(n, d, exponent, KERNEL_LIMIT);

		assert_true(fabsl(got - clamped) <= 0.5L + fabsl(clamped) * 0x1p-29L);
	}
	assert_int_equal(quotient_q24(0, 5, 600, KERNEL_LIMIT), 0);
	assert_int_equal(quotient_q24(INT64_MIN + 1, 1, 0, KERNEL_LIMIT), -KERNEL_LIMIT);
}

static void digits_hold_what_was_split(void **state)
{
	struct chance chance = chance_begin("digits");

	(void)state;
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
			assert_true(d < digits || digit == 0);
			back = back * 4096 + digit;
		}
		assert_true(back == x);
	}
	assert_int_equal(digits_of(0), 0);
	assert_int_equal(digits_of(2047), 1);
	assert_int_equal(digits_of(2048), 2);
	assert_int_equal(digits_of(2047 * 4097), 2);
	assert_int_equal(digits_of(2047 * 4097 + 1), 3);
}

static void exponents_are_the_least(void **state)
{
	(void)state;
	for (int e = -140; e < 140; e++) {
		assert_int_equal(exponent_above(ldexp(1, e)), e);
		assert_int_equal(exponent_above(ldexp(1.0001, e)), e + 1);
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

/* X is the light rounded, Y what the coarse lights gather of it, and both keep to their ranges,
 * whatever the light. */
static void light_is_rounded_once(void **state)
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
	struct light_vector v;
	struct synthetic file;

	(void)state;
	synthetic_open(&file, &o);
	assert_int_equal(light_selection_create(&s, &file.basis), 0);
	assert_int_equal(light_vector_create(&v, &file.basis), 0);
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
		if (kind == 0)
			light_vector_object(&v, &file.basis, &s, k % 3 ? 1 : 64);
		else if (kind == 1)
			light_vector_receiver(&v, &file.basis, &s, k % 8 == 1);
		else
			light_vector_ground(&v, &file.basis, &s, kind - 2);
		for (int c = 0; c < 3; c++) {
			double sum = 0, gathered = 0, there = 0;

			for (int i = 0; i < o.lights; i++) {
				const double l = s.radiance[i][c] + s.ambient[c];
				const double u = basis_ground(&file.basis, kind > 1 ? kind - 2 : 0,
							      c)[i];
				const double x = v.amount[i][c] / v.unit[c];

				assert_true(x == floor(x));
				assert_true(x >= 0);
				sum += x;
				there += u * (l + 0x1p-20);
				if (kind == 0)
					assert_true(fabs(v.amount[i][c] -
							 l * file.basis.lights[i].solid_angle_sr) <=
						    0.5 * v.unit[c]);
			}
			assert_true(sum < 0x1p46);
			for (int n = 0; n < o.coarse; n++) {
				double exact = 0;

				for (int i = 0; i < o.lights; i++)
					for (int j = 0; j < 3; j++)
						if (file.basis.coarse[i].index[j] == n)
							exact += v.amount[i][c] / v.unit[c] *
								 file.basis.coarse[i].weight[j] /
								 BASIS_COARSE_ONE;
				assert_true(fabs((double)y_of(&v, c, n) - exact) <=
					    0.5 + exact * 1e-12);
				gathered += (double)y_of(&v, c, n);
			}
			assert_true(gathered * v.unit[c] < ldexp(1, v.reach));
			assert_true(sum * v.unit[c] < ldexp(1, v.reach));
			for (int n = o.coarse; n < v.stride; n++)
				assert_int_equal(y_of(&v, c, n), 0);
			/* All shares of the ground's light, however little, and e are 1. */
			if (kind > 1 && there > 1e-30)
				assert_true(v.factor[c] > 1 << 29 && v.factor[c] <= 1 << 30);
		}
	}
	light_vector_free(&v);
	light_vector_free(&v);
	light_selection_free(&s);
	synthetic_close(&file);
}

/* A block that asks only for the lights of its class misses none that it needs. */
static void no_light_that_counts_is_overlooked(void **state)
{
	static const struct synthetic_options o = {.width = 1,
						   .height = 1,
						   .lights = 130,
						   .patterns = 1,
						   .object_share = 1,
						   .column_cut = 0.001,
						   .seed = 2};
	struct chance chance = chance_begin("bright lights");
	struct light_selection s;
	struct light_vector v;
	struct synthetic file;
	int counted = 0, marked = 0;

	(void)state;
	synthetic_open(&file, &o);
	assert_int_equal(light_selection_create(&s, &file.basis), 0);
	assert_int_equal(light_vector_create(&v, &file.basis), 0);
	for (int k = 0; k < 300; k++) {
		for (int i = 0; i < o.lights; i++)
			for (int c = 0; c < 3; c++)
				s.radiance[i][c] = i % 9 == c ? 0
							      : ldexp(chance_real(&chance, 0, 1),
								      chance_int(&chance, -60, 60));
		file.basis.info.column_cut = k % 10 ? 0.001 : 0;
		light_vector_object(&v, &file.basis, &s, 1);
		for (int n = 0; n < 100; n++) {
			const float reach = (float)ldexp(chance_real(&chance, 0.5, 1),
							 chance_int(&chance, -60, 40));
			const uint64_t *bright = light_vector_bright(&v, bright_class(reach));

			for (int i = 0; i < o.lights; i++) {
				const bool counts = v.strength[i] * reach >= 1;
				const bool is_marked = bright[i / 64] >> i % 64 & 1;

				assert_true(is_marked || !counts);
				counted += counts;
				marked += is_marked;
			}
		}
	}
	assert_true(counted > 0 && marked < 1.2 * counted); /* nor many that it does not */
	light_vector_free(&v);
	light_selection_free(&s);
	synthetic_close(&file);
}

/* ---- division ---- */

static void check_division(const struct division *d)
{
	assert_int_equal(d->first[0], 0);
	assert_int_equal(d->first[d->runs], d->tiles);
	for (int r = 0; r < d->runs; r++)
		assert_true(d->first[r] < d->first[r + 1]);
}

/* A quarter of the tiles takes ten times as long, which nobody knew. */
static void runs_are_divided_by_what_they_took(void **state)
{
	enum { TILES = 100, RUNS = 8 };
	double cost[TILES];
	struct division d;
	int64_t worst = 0;

	(void)state;
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

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(tints_round_like_exact_products),
		cmocka_unit_test(quotients_are_near_exact_ones),
		cmocka_unit_test(digits_hold_what_was_split),
		cmocka_unit_test(exponents_are_the_least),
		cmocka_unit_test(light_is_rounded_once),
		cmocka_unit_test(no_light_that_counts_is_overlooked),
		cmocka_unit_test(runs_are_divided_by_what_they_took),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
