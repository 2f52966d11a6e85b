/* SPDX-License-Identifier: MIT */
#include "hal/compositor/light/light_return.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define TERMS LIGHT_RETURN_TERMS
#define NIGHT 0x1p-20 /* e / sum of u (compositor.h) */
#define ALIKE 1e-6    /* relative rest below which a term depends on those before */

/* ---- terms ---- */

static void fill_plain(double term[TERMS], const double d[3])
{
	term[0] = d[0];
	term[1] = d[1];
	term[2] = d[2];
	term[3] = d[0] * d[1];
	term[4] = d[1] * d[2];
	term[5] = 3 * d[2] * d[2] - 1;
	term[6] = d[0] * d[2];
	term[7] = d[0] * d[0] - d[1] * d[1];
}

/* Inner product of two terms over the lights; a = -1: the constant term. */
static double term_product(const struct basis *basis, const double (*term)[TERMS], int a, int b)
{
	double sum = 0;

	for (uint32_t i = 0; i < basis->info.lights; i++)
		sum += basis->lights[i].solid_angle_sr * (a < 0 ? 1 : term[i][a]) * term[i][b];
	return sum;
}

static void term_subtract(const struct basis *basis, double (*term)[TERMS], int a, int b,
			  double share)
{
	for (uint32_t i = 0; i < basis->info.lights; i++)
		term[i][b] -= share * (a < 0 ? 1 : term[i][a]);
}

/* Gram-Schmidt, twice for each term: the second pass removes rounding errors of the first. */
static void make_orthonormal(const struct basis *basis, double (*term)[TERMS])
{
	const double(*fixed)[TERMS] = (const double(*)[TERMS])term;
	double all = 0;

	for (uint32_t i = 0; i < basis->info.lights; i++)
		all += basis->lights[i].solid_angle_sr;
	for (int b = 0; b < TERMS; b++) {
		const double before = term_product(basis, fixed, b, b);
		double after;

		for (int again = 0; again < 2; again++) {
			term_subtract(basis, term, -1, b, term_product(basis, fixed, -1, b) / all);
			for (int a = 0; a < b; a++)
				term_subtract(basis, term, a, b, term_product(basis, fixed, a, b));
		}
		after = term_product(basis, fixed, b, b);
		for (uint32_t i = 0; i < basis->info.lights; i++)
			term[i][b] *= after > ALIKE * before ? 1 / sqrt(after) : 0;
	}
}

double (*light_return_terms(const struct basis *basis))[LIGHT_RETURN_TERMS]
{
	double(*term)[TERMS] = calloc(basis->info.lights, sizeof(*term));

	for (uint32_t i = 0; term && i < basis->info.lights; i++)
		fill_plain(term[i], basis->lights[i].direction);
	if (term)
		make_orthonormal(basis, term);
	return term;
}

/* ---- one choice of lights ---- */

/* The fit in one channel. */
struct return_fit {
	double lost; /* largest radiance that any pixel of the object may lose */
	double mean; /* m: the constant term, a radiance */
	double weight[TERMS];
	double lowest, highest; /* of q over the lights */
	double share;		/* s */
};

static void fit_terms(struct return_fit *fit, const struct light_selection *s,
		      const struct basis *basis, const float (*peak)[3], int c)
{
	*fit = (struct return_fit){.share = 1};
	for (int i = 0; i < s->count; i++) {
		const double power = basis->lights[i].solid_angle_sr * s->radiance[i][c];

		if (s->used[i])
			continue;
		fit->lost += s->radiance[i][c] * (double)peak[i][c];
		fit->mean += power / (2 * M_PI);
		for (int k = 0; k < TERMS; k++)
			fit->weight[k] += power * s->term[i][k];
	}
}

static double return_at(const struct return_fit *fit, const double term[TERMS])
{
	double sum = 0;

	for (int k = 0; k < TERMS; k++)
		sum += fit->weight[k] * term[k];
	return sum;
}

/* Writes q of each light to returned[], and limits s so that no light is negative. */
static void return_evaluate(struct return_fit *fit, struct light_selection *s, int c)
{
	for (int i = 0; i < s->count; i++) {
		const double q = return_at(fit, s->term[i]);

		s->returned[i][c] = q;
		fit->lowest = fmin(fit->lowest, q);
		fit->highest = fmax(fit->highest, q);
	}
	if (fit->mean + fit->lowest < 0)
		fit->share = fit->mean / -fit->lowest;
}

static double return_highest(const struct return_fit *fit, double share)
{
	return fit->mean + share * fit->highest;
}

/* Largest change of any pixel for a given s, where white is 1; selection.h has the proof. */
static double return_change(const struct return_fit *fit, const struct light_selection *s,
			    const struct basis *basis, double peak_total, double gain, int c,
			    double share)
{
	double most = 0;

	for (int g = 0; g < (int)basis->info.grounds; g++) {
		const double *u = basis_ground(basis, g, c);
		double light = s->ground[g][c] * NIGHT, taken = 0, back = 0;

		for (int i = 0; i < s->count; i++) {
			light += u[i] * s->radiance[i][c];
			taken += s->used[i] ? 0 : u[i] * s->radiance[i][c];
			back += u[i] * (fit->mean + share * s->returned[i][c]);
		}
		if (light > 0)
			most = fmax(most, fmax(taken, back) / light);
	}
	return gain * fmax(fit->lost, return_highest(fit, share) * peak_total) + most;
}

/* Reduces s to keep the budget: the change is convex in s, and within the budget for s = 0. */
static void keep_budget(struct return_fit *fit, const struct light_selection *s,
			const struct basis *basis, double peak_total, double gain, int c)
{
	const double budget = fmin(s->budget, 1);
	const double least = return_change(fit, s, basis, peak_total, gain, c, 0);
	const double most = return_change(fit, s, basis, peak_total, gain, c, fit->share);

	if (most > budget)
		fit->share *= fmax(budget - least, 0) / (most - least);
}

/* Writes the radiance to return to returned[]. Returns dropped_error without gain: the smaller of
 * two bounds, one from the totals and one from the differences of single lights. */
static double return_finish(const struct return_fit *fit, struct light_selection *s,
			    const float (*peak)[3], int c)
{
	const double whole = fmax(fit->lost,
				  return_highest(fit, fit->share) * (double)peak[s->count][c]);
	double up = 0, down = 0;

	for (int i = 0; i < s->count; i++) {
		const double back = fmax(fit->mean + fit->share * s->returned[i][c], 0);
		const double more = back - (s->used[i] ? 0 : s->radiance[i][c]);

		s->returned[i][c] = back;
		up += fmax(more, 0) * (double)peak[i][c];
		down += fmax(-more, 0) * (double)peak[i][c];
	}
	return fmin(whole, fmax(up, down));
}

void light_return(struct light_selection *s, const struct basis *basis, const float (*peak)[3],
		  double gain)
{
	for (int c = 0; c < 3; c++) {
		struct return_fit fit;

		fit_terms(&fit, s, basis, peak, c);
		return_evaluate(&fit, s, c);
		if (s->budget > 0)
			keep_budget(&fit, s, basis, (double)peak[s->count][c], gain, c);
		s->dropped_error[c] = gain * return_finish(&fit, s, peak, c);
	}
}
