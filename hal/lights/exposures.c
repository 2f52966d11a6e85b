/* SPDX-License-Identifier: MIT */
#include "hal/lights/exposures.h"

#include <errno.h>
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "hal/lights/pixel_noise.h"

#define DEVIATIONS 4   /* standard deviations of noise by which estimates of one light may differ */
#define OFF (1 / 8.f)  /* tolerance of exposures, as a share of the light */
#define DARK_PIXELS 64 /* pixels that errors in the dark are counted for (exposures.h) */
#define ALL 0.99f      /* a light of which so many pixels are clipped is clipped as a whole */
#define ALIKE 0.1      /* two exposures explain a frame equally well within this logarithm */
#define LEAST 0.001    /* added to each mean brightness, in white: dark frames tell nothing */

enum kept { KEPT_NONE, KEPT_WHOLE, KEPT_CLIPPED };

/* A light in one exposure. */
struct look {
	float radiance[3], excess[3];
	float clipped;
	enum kept kept;
};

struct light_exposures {
	int lights, count;
	float ratio[EXPOSURES_MAX];
	float gain, floor, slope; /* variance of a pixel: floor + slope x, in units of exposure 0 */
	float *alone;		  /* [lights]: number of independent pixels */
	struct look *look;	  /* [lights][EXPOSURES_MAX] */
	float (*known)[3];	  /* [lights]: the last result */
	float *left;		  /* [lights]: the share of it that is clipped */
	bool begun;
};

int light_exposures_create(struct light_exposures **out, int lights)
{
	struct light_exposures *e = calloc(1, sizeof(*e));

	*out = NULL;
	if (!e)
		return -ENOMEM;
	e->lights = lights;
	e->count = 1;
	e->ratio[0] = e->gain = 1;
	e->alone = calloc((size_t)lights, sizeof(*e->alone));
	e->look = calloc((size_t)lights * EXPOSURES_MAX, sizeof(*e->look));
	e->known = calloc((size_t)lights, sizeof(*e->known));
	e->left = calloc((size_t)lights, sizeof(*e->left));
	if (!e->alone || !e->look || !e->known || !e->left) {
		light_exposures_destroy(e);
		return -ENOMEM;
	}
	for (int i = 0; i < lights; i++)
		e->alone[i] = 1;
	*out = e;
	return 0;
}

void light_exposures_destroy(struct light_exposures *e)
{
	if (!e)
		return;
	free(e->alone);
	free(e->look);
	free(e->known);
	free(e->left);
	free(e);
}

void light_exposures_begin(struct light_exposures *e)
{
	memset(e->look, 0, (size_t)e->lights * EXPOSURES_MAX * sizeof(*e->look));
	e->begun = false;
}

void light_exposures_ratios(struct light_exposures *e, const double *ratio)
{
	for (int k = 0; k < e->count; k++)
		e->ratio[k] = (float)ratio[k];
}

void light_exposures_measured(struct light_exposures *e, const double *ratio, int count,
			      const struct transfer_curve *curve, double gain, const float *pixels)
{
	const struct pixel_noise noise = pixel_noise_of(curve);

	e->count = count;
	light_exposures_ratios(e, ratio);
	e->gain = (float)gain;
	e->floor = fmaxf((float)(noise.floor * gain * gain), FLT_MIN); /* > 0 for a gain of 0 */
	e->slope = (float)(noise.slope * gain);
	for (int i = 0; i < e->lights; i++)
		e->alone[i] = fmaxf(1, pixels[i] / PIXEL_NOISE_ALIKE);
	light_exposures_begin(e);
}

bool light_exposures_shorter(const struct light_exposures *e, int which)
{
	return which >= 0 && which < e->count - 1;
}

double light_exposures_longer(const struct light_exposures *e, int which)
{
	return which > 0 && which < EXPOSURES_MAX
		       ? (double)e->ratio[which] / (double)e->ratio[which - 1]
		       : 1;
}

double light_exposures_white(const struct light_exposures *e)
{
	return (double)e->gain / (double)e->ratio[e->count - 1];
}

/* ---- which exposure a frame has ---- */

/* Sum of clamp(radiance * ratio, dark, white) - dark over the lights whose brightness is known:
 * whole in the frame or clipped as a whole, and not clipped in every exposure. */
static double exposure_brightness(const struct light_exposures *e, const float (*radiance)[3],
				  float ratio, const float *clipped)
{
	const float dark = DEVIATIONS * sqrtf(e->floor);
	double sum = LEAST * (double)e->gain * e->lights;

	for (int i = 0; i < e->lights; i++) {
		if (e->left[i] > 0 || (clipped[i] > 0 && clipped[i] < ALL))
			continue;
		for (int c = 0; c < 3; c++)
			sum += (double)fmaxf(fminf(radiance[i][c] * ratio, e->gain) - dark, 0);
	}
	return sum;
}

bool light_exposures_fit(const struct light_exposures *e, int which, const float (*sampled)[3],
			 const float *clipped)
{
	const float(*known)[3] = (const float(*)[3])e->known;
	double is, own;

	if (!e->begun || e->count < 2)
		return true;
	is = exposure_brightness(e, sampled, 1, clipped);
	own = fabs(log(is / exposure_brightness(e, known, e->ratio[which], clipped)));
	for (int k = 0; k < e->count; k++) {
		const double other =
			fabs(log(is / exposure_brightness(e, known, e->ratio[k], clipped)));

		if (k != which && own > other + ALIKE)
			return false;
	}
	return true;
}

/* ---- which estimates are of the same light ---- */

/* Whether above exceeds below (exposures.h), two values of light i in exposures j and k. */
static bool look_exceeds(const struct light_exposures *e, int i, int j, int k, float above,
			 float below)
{
	const float a = 1 / e->ratio[j], b = 1 / e->ratio[k];
	const float noise = e->floor * (a * a + b * b) + e->slope * below * (a + b) / e->alone[i];
	const float beyond = above - below - OFF * above;

	return beyond > 0 && beyond * beyond > DEVIATIONS * DEVIATIONS * noise;
}

/* Whether the estimate of exposure k exceeds that of exposure j in any channel. */
static bool is_above(const struct light_exposures *e, int i, int k, int j)
{
	const struct look *look = e->look + (size_t)i * EXPOSURES_MAX;
	bool above = false;

	for (int c = 0; c < 3; c++)
		above |= look_exceeds(e, i, j, k, look[k].radiance[c], look[j].radiance[c]);
	return above;
}

/* Whether the estimate of exposure j cannot be of the light that exposure k has just shown. */
static bool is_overtaken(const struct light_exposures *e, int i, int j, int k)
{
	const struct look *look = e->look + (size_t)i * EXPOSURES_MAX;
	const bool whole = look[k].kept == KEPT_WHOLE;

	if (look[j].kept == KEPT_WHOLE) /* a clipped k is at least as bright */
		return (whole && is_above(e, i, j, k)) || is_above(e, i, k, j) || (!whole && k > j);
	return whole && (k < j || is_above(e, i, j, k));
}

static void forget_overtaken(struct light_exposures *e, int i, int k)
{
	struct look *look = e->look + (size_t)i * EXPOSURES_MAX;

	for (int j = 0; j < e->count; j++) {
		if (j != k && look[j].kept != KEPT_NONE && is_overtaken(e, i, j, k))
			look[j].kept = KEPT_NONE;
	}
}

/* ---- one light ---- */

static float look_mean(const struct light_exposures *e, const struct look *look, int longest, int c)
{
	const float first = look[longest].radiance[c];
	float sum = 0, weights = 0;

	for (int k = longest; k < e->count; k++) {
		const float r = e->ratio[k];
		const float w = r * r / (DARK_PIXELS * e->floor + e->slope * first * r);

		if (look[k].kept != KEPT_WHOLE)
			continue;
		sum += w * (look[k].radiance[c] - first);
		weights += w;
	}
	return fmaxf(first + sum / weights, 0);
}

/* The longest whole exposure, or else the shortest clipped one; -1: there is no estimate. */
static int look_choose(const struct light_exposures *e, const struct look *look)
{
	int chosen = -1;

	for (int k = 0; k < e->count; k++) {
		if (look[k].kept == KEPT_WHOLE)
			return k;
		if (look[k].kept == KEPT_CLIPPED)
			chosen = k;
	}
	return chosen;
}

/* Raises radiance to the estimates of longer, clipped exposures, which are lower bounds. */
static float at_least(const struct look *look, int chosen, int c, float radiance)
{
	for (int k = 0; k < chosen; k++)
		if (look[k].kept == KEPT_CLIPPED)
			radiance = fmaxf(radiance, look[k].radiance[c]);
	return radiance;
}

static float look_merge(const struct light_exposures *e, const struct look *look, float radiance[3])
{
	const int chosen = look_choose(e, look);
	const bool layered = chosen > 0 && look[chosen - 1].kept == KEPT_CLIPPED;

	for (int c = 0; c < 3; c++) {
		if (layered)
			radiance[c] = look[chosen - 1].radiance[c] + look[chosen].excess[c];
		else if (look[chosen].kept == KEPT_CLIPPED)
			radiance[c] = at_least(look, chosen, c, look[chosen].radiance[c]);
		else
			radiance[c] = at_least(look, chosen, c, look_mean(e, look, chosen, c));
	}
	return look[chosen].kept == KEPT_CLIPPED ? look[chosen].clipped : 0;
}

void light_exposures_take(struct light_exposures *e, int which, const float (*sampled)[3],
			  const float (*excess)[3], const float *clipped, float (*radiance)[3],
			  float *left)
{
	for (int i = 0; i < e->lights; i++) {
		struct look *look = e->look + (size_t)i * EXPOSURES_MAX;

		for (int c = 0; c < 3; c++) {
			look[which].radiance[c] = sampled[i][c] / e->ratio[which];
			look[which].excess[c] = which ? excess[i][c] / e->ratio[which] : 0;
		}
		look[which].clipped = clipped[i];
		look[which].kept = clipped[i] > 0 ? KEPT_CLIPPED : KEPT_WHOLE;
		forget_overtaken(e, i, which);
		left[i] = e->left[i] = look_merge(e, look, e->known[i]);
		memcpy(radiance[i], e->known[i], sizeof(e->known[i]));
	}
	e->begun = true;
}
