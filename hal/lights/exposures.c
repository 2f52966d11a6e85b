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
	float radiance[3]; /* mean of the parts */
	float part[EXPOSURES_PARTS][3], excess[EXPOSURES_PARTS][3], clipped[EXPOSURES_PARTS];
	enum kept kept;
};

struct light_exposures {
	int lights, parts, count;
	float ratio[EXPOSURES_MAX];
	float gain, floor, slope; /* variance of a pixel: floor + slope x, in units of exposure 0 */
	float *alone;		  /* [lights]: number of independent pixels */
	struct look *look;	  /* [lights][EXPOSURES_MAX] */
	float (*known)[3];	  /* [lights]: the last result, mean of the parts */
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
	e->parts = e->count = 1;
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

void light_exposures_parts(struct light_exposures *e, int parts)
{
	e->parts = parts;
	light_exposures_begin(e);
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

/* The mean of a light's parts, which are every stride-th of the values. */
static float parts_mean(const struct light_exposures *e, const float *value, int stride)
{
	float sum = 0;

	for (int n = 0; n < e->parts; n++)
		sum += value[n * stride];
	return sum / (float)e->parts;
}

/* Sum of clamp(radiance * ratio, dark, white) - dark over the lights whose brightness is known:
 * whole in the frame or clipped as a whole, and not clipped in every exposure. sampled NULL: of the
 * last result. */
static double exposure_brightness(const struct light_exposures *e, const float (*sampled)[3],
				  float ratio, const float *clipped)
{
	const float dark = DEVIATIONS * sqrtf(e->floor);
	double sum = LEAST * (double)e->gain * e->lights;

	for (int i = 0; i < e->lights; i++) {
		const size_t first = (size_t)i * (size_t)e->parts;
		const float share = parts_mean(e, clipped + first, 1);

		if (e->left[i] > 0 || (share > 0 && share < ALL))
			continue;
		for (int c = 0; c < 3; c++) {
			const float radiance = sampled ? parts_mean(e, &sampled[first][c], 3)
						       : e->known[i][c];

			sum += (double)fmaxf(fminf(radiance * ratio, e->gain) - dark, 0);
		}
	}
	return sum;
}

bool light_exposures_fit(const struct light_exposures *e, int which, const float (*sampled)[3],
			 const float *clipped)
{
	double is, own;

	if (!e->begun || e->count < 2)
		return true;
	is = exposure_brightness(e, sampled, 1, clipped);
	own = fabs(log(is / exposure_brightness(e, NULL, e->ratio[which], clipped)));
	for (int k = 0; k < e->count; k++) {
		const double other =
			fabs(log(is / exposure_brightness(e, NULL, e->ratio[k], clipped)));

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

static float look_mean(const struct light_exposures *e, const struct look *look, int longest, int c,
		       int part)
{
	const float brightness = look[longest].radiance[c], first = look[longest].part[part][c];
	float sum = 0, weights = 0;

	for (int k = longest; k < e->count; k++) {
		const float r = e->ratio[k];
		const float w = r * r / (DARK_PIXELS * e->floor + e->slope * brightness * r);

		if (look[k].kept != KEPT_WHOLE)
			continue;
		sum += w * (look[k].part[part][c] - first);
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

/* Raises the parts to the longer, clipped exposure whose estimate, a lower bound, is highest. */
static void at_least(const struct light_exposures *e, const struct look *look, int chosen, int c,
		     float (*part)[3])
{
	float radiance = parts_mean(e, &part[0][c], 3);

	for (int k = 0; k < chosen; k++) {
		if (look[k].kept != KEPT_CLIPPED || !(look[k].radiance[c] > radiance))
			continue;
		radiance = look[k].radiance[c];
		for (int n = 0; n < e->parts; n++)
			part[n][c] = look[k].part[n][c];
	}
}

/* Writes the parts of a light, and the share of each that is clipped in every exposure. */
static void look_merge(const struct light_exposures *e, const struct look *look, float (*part)[3],
		       float *left)
{
	const int chosen = look_choose(e, look);
	const bool clipped = look[chosen].kept == KEPT_CLIPPED;
	const bool layered = chosen > 0 && look[chosen - 1].kept == KEPT_CLIPPED;

	for (int n = 0; n < e->parts; n++) {
		left[n] = clipped ? look[chosen].clipped[n] : 0;
		for (int c = 0; c < 3; c++) {
			if (layered)
				part[n][c] = look[chosen - 1].part[n][c] +
					     look[chosen].excess[n][c];
			else if (clipped)
				part[n][c] = look[chosen].part[n][c];
			else
				part[n][c] = look_mean(e, look, chosen, c, n);
		}
	}
	for (int c = 0; c < 3 && !layered; c++)
		at_least(e, look, chosen, c, part);
}

static void look_fill(const struct light_exposures *e, struct look *look, int which,
		      const float (*sampled)[3], const float (*excess)[3], const float *clipped)
{
	for (int n = 0; n < e->parts; n++) {
		look->clipped[n] = clipped[n];
		for (int c = 0; c < 3; c++) {
			look->part[n][c] = sampled[n][c] / e->ratio[which];
			look->excess[n][c] = which ? excess[n][c] / e->ratio[which] : 0;
		}
	}
	for (int c = 0; c < 3; c++)
		look->radiance[c] = parts_mean(e, &look->part[0][c], 3);
	look->kept = parts_mean(e, clipped, 1) > 0 ? KEPT_CLIPPED : KEPT_WHOLE;
}

void light_exposures_take(struct light_exposures *e, int which, const float (*sampled)[3],
			  const float (*excess)[3], const float *clipped, float (*radiance)[3],
			  float *left)
{
	for (int i = 0; i < e->lights; i++) {
		struct look *look = e->look + (size_t)i * EXPOSURES_MAX;
		const size_t first = (size_t)i * (size_t)e->parts;

		look_fill(e, &look[which], which, sampled + first, excess + first, clipped + first);
		forget_overtaken(e, i, which);
		look_merge(e, look, radiance + first, left + first);
		e->left[i] = parts_mean(e, left + first, 1);
		for (int c = 0; c < 3; c++)
			e->known[i][c] = parts_mean(e, &radiance[first][c], 3);
	}
	e->begun = true;
}
