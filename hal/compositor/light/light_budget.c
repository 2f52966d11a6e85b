/* SPDX-License-Identifier: MIT */
#include "hal/compositor/light/light_budget.h"

#include <math.h>

/* A bound has at most 42 bits: four digits of 11 bits. */
#define DIGIT_BITS 11
#define DIGITS (1 << DIGIT_BITS)
#define HIGHEST (3 * DIGIT_BITS)

#define NIGHT 0x1p-20 /* e / sum of u (compositor.h) */

/* ---- bounds b_i ---- */

struct budget_terms {
	const struct basis *basis;
	const float (*peak)[3];
	const double (*ground_sum)[3];
	double inverse[BASIS_GROUNDS_MAX][3]; /* 1 / (sum u L + e); 0 in the dark */
	double gain;
	double back; /* 1 / (2 pi) if dropped light is returned; 0 in drop mode */
};

static double larger_of(double a, double b)
{
	return a > b ? a : b;
}

void light_budget_grounds(const struct basis *basis, double (*sum)[3])
{
	for (int g = 0; g < (int)basis->info.grounds; g++) {
		for (int c = 0; c < 3; c++) {
			const double *u = basis_ground(basis, g, c);

			sum[g][c] = 0;
			for (uint32_t i = 0; i < basis->info.lights; i++)
				sum[g][c] += u[i];
		}
	}
}

static void light_grounds(struct budget_terms *t, const double (*radiance)[3])
{
	for (int g = 0; g < (int)t->basis->info.grounds; g++) {
		for (int c = 0; c < 3; c++) {
			const double *u = basis_ground(t->basis, g, c);
			double light = t->ground_sum[g][c] * NIGHT;

			for (uint32_t i = 0; i < t->basis->info.lights; i++)
				light += u[i] * radiance[i][c];
			t->inverse[g][c] = light > 0 ? 1 / light : 0;
		}
	}
}

/* Bound of a light per unit of its radiance, in one channel. */
static double weight_of(const struct budget_terms *t, uint32_t i, int c)
{
	const uint32_t count = t->basis->info.lights, grounds = t->basis->info.grounds;
	const double back = t->basis->lights[i].solid_angle_sr * t->back;
	const double object = larger_of((double)t->peak[i][c], back * (double)t->peak[count][c]);
	const double *u = t->basis->ground + (size_t)c * count + i; /* ground 0 */
	double share = 0;

	for (uint32_t g = 0; g < grounds; g++, u += 3 * (size_t)count)
		share = larger_of(share,
				  larger_of(*u, back * t->ground_sum[g][c]) * t->inverse[g][c]);
	return t->gain * object + share;
}

/* Rounds a bound up. A light whose bound is NaN or 2 and more is never dropped. */
static uint64_t bound_whole(double bound)
{
	if (!(bound < 2))
		return 2 * LIGHT_BUDGET_WHITE;
	return bound > 0 ? (uint64_t)(bound * (double)LIGHT_BUDGET_WHITE) + 1 : 0;
}

void light_budget_bounds(const struct basis *basis, int pose, const double (*ground_sum)[3],
			 const double (*radiance)[3], enum threshold_mode mode, double gain,
			 uint64_t *bound)
{
	struct budget_terms t = {
		.basis = basis,
		.peak = basis->poses[pose].peak,
		.ground_sum = ground_sum,
		.gain = gain,
		.back = mode != THRESHOLD_DROP ? 1 / (2 * M_PI) : 0,
	};

	light_grounds(&t, radiance);
	for (uint32_t i = 0; i < basis->info.lights; i++) {
		double most = 0;

		for (int c = 0; c < 3; c++) {
			if (radiance[i][c] > 0)
				most = larger_of(most, radiance[i][c] * weight_of(&t, i, c));
		}
		bound[i] = bound_whole(most);
	}
}

/* ---- how many lights fit ---- */

/* Sums and counts of the lights with given higher digits, by their next digit. */
struct histogram {
	uint64_t sum[DIGITS];
	int count[DIGITS];
};

static void count_digits(struct histogram *h, const uint64_t *bound, int count, uint64_t above,
			 int shift)
{
	*h = (struct histogram){.count = {0}};
	for (int i = 0; i < count; i++) {
		const uint64_t high = bound[i] >> shift;

		if (high >> DIGIT_BITS != above)
			continue;
		h->sum[high % DIGITS] += bound[i];
		h->count[high % DIGITS]++;
	}
}

/* Finds the bound at which the room ends, digit by digit from the highest. */
struct light_cut light_budget_cut(const uint64_t *bound, int count, uint64_t room)
{
	struct light_cut cut = {.bound = 0};
	struct histogram h;

	for (int shift = HIGHEST; shift >= 0; shift -= DIGIT_BITS) {
		int digit = 0;

		count_digits(&h, bound, count, cut.bound, shift);
		for (; digit < DIGITS && h.sum[digit] <= room; digit++) {
			room -= h.sum[digit];
			cut.count += h.count[digit];
		}
		if (digit == DIGITS) /* there is room for all */
			return (struct light_cut){.bound = UINT64_MAX, .count = cut.count};
		cut.bound = cut.bound << DIGIT_BITS | (uint64_t)digit;
	}
	cut.equal = (int)(room / cut.bound);
	cut.count += cut.equal;
	return cut;
}
