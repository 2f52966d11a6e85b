/* SPDX-License-Identifier: MIT */
#include "bake/encode/encode_allow.h"

#include <math.h>

#include "bake/encode/encode_limit.h"

/* The share of a residual's limit that short lines may use up, at first, and how it falls. */
#define SHORT_SHARE 0.9F
#define SHORTER 0.6F
/* How far inside what was asked for the next attempt goes: for a light's limits, which leave most
 * values as they were, and for ranks. */
#define NARROWER 0.85
#define TIGHTER 0.97
/* A light dominates a sky if it gives so much of what makes white. Lamps of three colours add up to
 * so many times what one light may be off by; they are tried first, so often. */
#define DOMINANT 0.2F
#define LAMPS_OVER 3
#define LAMPS_TRIED 2
/* From this attempt on everything becomes finer, and by how much: noisy tiles may be off under a sky that no
 * single light is to blame for. */
#define ATTEMPTS_ALIKE 5
#define FINER 0.75F

void allow_all(const struct allowed *a)
{
	for (int k = 0; k < a->count; k++)
		a->allowance[k] = (struct allowance){.asked = a->settings->target,
						     .short_share = SHORT_SHARE};
}

/* Lights alone whose error is too large: mostly along an object's edge, where that of the shadow
 * behind it is added. */
static void allow_less_alone(const struct allowed *a, const struct measure *m)
{
	for (int i = 0; i < a->settings->lights; i++)
		for (int k = 0; k < a->count && m->cell_most[i] > 1; k++)
			a->part[k].light_share[i] *= (float)NARROWER / m->cell_most[i];
}

/* How much of the light that makes white this one gives under a sky, at most 1. */
static float light_dominance(const struct part *part, int lights, int sky, int light)
{
	float most = 0;

	for (int c = 0; c < 3; c++) {
		const float x = part->sky_x[(sky * 3 + c) * lights + light];
		const float alone = fabsf(part->cell_slope[c * lights + light]);

		most = larger(most, alone > 0 ? x / alone : 0);
	}
	return most;
}

/* The error of the worst of the skies that a light dominates, as a multiple of that asked for. */
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

/* Under a sky of lamps the error is that of a few lights alone. False: no light dominates. */
static bool allow_lamps_less(const struct allowed *a, const struct measure *m)
{
	bool any = false;

	for (int k = 0; k < a->count; k++)
		for (int i = 0; i < a->settings->lights; i++) {
			const double over = light_over(a, m, k, i);

			if (over > 1) {
				a->part[k].light_share[i] *= (float)(NARROWER / over);
				any = true;
			}
		}
	return any;
}

/* Short lines use up less, and ranks are chosen again: of the part that was expected to be off by most, so that what it was expected to be
 * off by is too much. */
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
		own->short_share *= SHORTER;
		own->asked.rms *= by;
		own->asked.max *= by;
		own->chosen = false;
	}
}

void allow_less(const struct allowed *a, const struct measure *m, int attempt)
{
	const double sky = measure_worst_sky(m);

	allow_less_alone(a, m);
	if (sky > 1 &&
	    !(sky < LAMPS_OVER && a->allowance->lamps < LAMPS_TRIED && allow_lamps_less(a, m)))
		allow_ranks_less(a, sky);
	a->allowance->lamps++;
	for (int k = 0; k < a->count && attempt >= ATTEMPTS_ALIKE; k++)
		for (int i = 0; i < a->settings->lights; i++)
			a->part[k].light_share[i] *= FINER;
}
