/* SPDX-License-Identifier: MIT */

#include <math.h>

#include "bake/encode/encode_parts.h"

/* The next attempt aims below the target by these factors: NARROWER for the limits of a light, as
 * most of its residuals stay as they were, TIGHTER for the errors that ranks are chosen for. Chosen
 * by trial. */
#define NARROWER 0.85
#define TIGHTER 0.97
/* DOMINANT: share of white above which one light dominates a sky. A sky that misses its target by
 * less than LAMPS_OVER (three lamps, each at its limit) is repaired first by narrowing the limits
 * of its dominant lights, after the first LAMPS_TRIED attempts. Tuned (README.md, "Constants"). */
#define DOMINANT 0.2F
#define LAMPS_OVER 3
#define LAMPS_TRIED 2
/* From this attempt on the limits of all lights become FINER each time: a noisy tile may miss its
 * target under a sky that no light dominates. Chosen by trial. */
#define ATTEMPTS_ALIKE 5
#define FINER 0.75F

void allow_target(const struct allowed *a)
{
	for (int k = 0; k < a->count; k++)
		a->allowance[k] = (struct allowance){.asked = a->settings->target};
}

/* Narrows the limits of lights whose error is too large when they shine alone. It mostly is along
 * the object's edge, where the errors of the object and of the shadow behind it add up. */
static void allow_less_alone(const struct allowed *a, const struct measure *m)
{
	for (int i = 0; i < a->settings->lights; i++)
		for (int k = 0; k < a->count && m->cell_most[i] > 1; k++)
			a->part[k].limit.light_share[i] *= (float)NARROWER / m->cell_most[i];
}

/* Returns the share of white that a light gives under a sky, in the channel where it is largest. */
static float light_dominance(const struct part *part, int lights, int sky, int light)
{
	float most = 0;

	for (int c = 0; c < 3; c++) {
		const float x = part->sky.x[(sky * 3 + c) * lights + light];
		const float alone = fabsf(part->cell.slope[c * lights + light]);

		most = larger(most, alone > 0 ? x / alone : 0);
	}
	return most;
}

/* Returns the largest error, as a multiple of the target, of the tried skies that a light
 * dominates; 0 if none of them misses its target. */
static double light_over(const struct allowed *a, const struct measure *m, int part, int light)
{
	double worst = 0;

	for (int t = 0; t < a->shade->skies.tried; t++) {
		const int s = a->shade->tried[t];
		const double over = fmax(m->sky_rms[s], m->sky_most[s]);

		if (over > fmax(worst, 1) &&
		    light_dominance(&a->part[part], a->settings->lights, s, light) > DOMINANT)
			worst = over;
	}
	return worst;
}

/* Narrows the limits of lights that dominate a sky which misses its target, as lamps do. Returns
 * false if there is no such light. */
static bool allow_lamps_less(const struct allowed *a, const struct measure *m)
{
	bool any = false;

	for (int k = 0; k < a->count; k++)
		for (int i = 0; i < a->settings->lights; i++) {
			const double over = light_over(a, m, k, i);

			if (over > 1) {
				a->part[k].limit.light_share[i] *= (float)(NARROWER / over);
				any = true;
			}
		}
	return any;
}

/* Tightens every part's target by TIGHTER / worst, and has its ranks chosen anew. The part with the
 * largest predicted error is tightened so far that its present ranks fail. */
static void allow_ranks_less(const struct allowed *a, double worst)
{
	double most = 0;

	for (int k = 0; k < a->count; k++)
		most = fmax(most, a->fit[k].excess);
	for (int k = 0; k < a->count; k++) {
		struct allowance *own = &a->allowance[k];
		double by = TIGHTER / worst;

		if (a->fit[k].excess == most)
			by *= fmin(most, 1);
		own->asked.rms *= by;
		own->asked.max *= by;
		own->chosen = false;
	}
}

void allow_less(const struct allowed *a, const struct measure *m, int attempt)
{
	const double sky = measure_worst_sky(m);

	allow_less_alone(a, m);
	if (sky > 1 && !(sky < LAMPS_OVER && attempt < LAMPS_TRIED && allow_lamps_less(a, m)))
		allow_ranks_less(a, sky);
	for (int k = 0; k < a->count && attempt >= ATTEMPTS_ALIKE; k++)
		for (int i = 0; i < a->settings->lights; i++)
			a->part[k].limit.light_share[i] *= FINER;
}
