/* SPDX-License-Identifier: MIT */
#include "hal/lights/light_filter.h"

#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "hal/base/clock.h"
#include "hal/lights/pixel_noise.h"

#define DEVIATIONS 4 /* standard deviations of noise that a change must exceed */
#define EVEN 0.01    /* flicker of the mains, as a share of a sum of lights */
#define NEAR 64	     /* within 1 / NEAR of a standard deviation y becomes x */

/* Variance of a light: floor + slope * its radiance. */
struct light_noise {
	float floor, slope;
};

struct light_filter {
	int count;
	bool begun;
	int64_t last_ns;
	float (*value)[3];
	struct light_noise *noise;
	int64_t *until_ns; /* time of the last frame for which the light is fast */
};

/* Sums over lights and channels: of changes x - y, of their variances, of y. */
struct changes_together {
	double change, variance, light;
};

int light_filter_create(struct light_filter **out, int lights)
{
	struct light_filter *f = calloc(1, sizeof(*f));

	*out = NULL;
	if (!f)
		return -ENOMEM;
	f->count = lights;
	f->value = calloc((size_t)lights, sizeof(*f->value));
	f->noise = calloc((size_t)lights, sizeof(*f->noise));
	f->until_ns = calloc((size_t)lights, sizeof(*f->until_ns));
	if (!f->value || !f->noise || !f->until_ns) {
		light_filter_destroy(f);
		return -ENOMEM;
	}
	*out = f;
	return 0;
}

void light_filter_destroy(struct light_filter *f)
{
	if (!f)
		return;
	free(f->value);
	free(f->noise);
	free(f->until_ns);
	free(f);
}

void light_filter_begin(struct light_filter *f)
{
	f->begun = false;
}

void light_filter_measured(struct light_filter *f, const struct transfer_curve *curve, double gain,
			   const float *pixels)
{
	const struct pixel_noise pixel = pixel_noise_of(curve);

	for (int i = 0; i < f->count; i++) {
		const double alone = fmax(1, (double)pixels[i] / PIXEL_NOISE_ALIKE);

		f->noise[i].floor = (float)(pixel.floor * gain * gain / alone);
		f->noise[i].slope = (float)(pixel.slope * gain / alone);
	}
	light_filter_begin(f);
}

/* ---- which lights have changed ---- */

/* Whether a channel of light i changed beyond noise. Adds all channels to the sums. */
static bool light_changed(const struct light_filter *f, int i, const float x[3],
			  struct changes_together *all)
{
	const struct light_noise noise = f->noise[i];
	const float *y = f->value[i];
	float change = 0, variance = 0, light = 0;
	bool changed = false;

	for (int c = 0; c < 3; c++) {
		const float d = x[c] - y[c], v = noise.floor + noise.slope * y[c];

		changed |= d * d > (float)(DEVIATIONS * DEVIATIONS) * v;
		change += d;
		variance += v;
		light += y[c];
	}
	all->change += (double)change;
	all->variance += (double)variance;
	all->light += (double)light;
	return changed;
}

static bool together_changed(const struct changes_together *t)
{
	return fabs(t->change) > DEVIATIONS * sqrt(t->variance) + EVEN * t->light;
}

static void filter_hasten(struct light_filter *f, int from, int to, int64_t until_ns)
{
	for (int i = from; i < to; i++)
		f->until_ns[i] = until_ns;
}

static void find_changes(struct light_filter *f, const float (*x)[3], int64_t until_ns)
{
	struct changes_together sky = {0};

	for (int from = 0; from < f->count; from += LIGHT_FILTER_GROUP) {
		const int rest = f->count - from;
		const int to = from + (rest < LIGHT_FILTER_GROUP ? rest : LIGHT_FILTER_GROUP);
		struct changes_together group = {0};

		for (int i = from; i < to; i++) {
			if (light_changed(f, i, x[i], &group))
				f->until_ns[i] = until_ns;
		}
		if (together_changed(&group))
			filter_hasten(f, from, to, until_ns);
		sky.change += group.change;
		sky.variance += group.variance;
		sky.light += group.light;
	}
	if (together_changed(&sky))
		filter_hasten(f, 0, f->count, until_ns);
}

/* ---- following ---- */

/* a = 1 - exp(-dt / tau), rounded to multiples of 2^-20, so that all machines agree whatever their
 * exp(). */
static float change_share(int64_t dt_ns, double follow_ns)
{
	const double share = 1 - exp(-M_LN10 * (double)dt_ns / follow_ns);

	return (float)(nearbyint(share * 0x1p20) * 0x1p-20);
}

static float light_step(float y, float x, float share, struct light_noise noise)
{
	const float d = x - y, next = y + share * d;

	if (d * d * (float)(NEAR * NEAR) <= noise.floor + noise.slope * y)
		return x;
	return d > 0 ? fminf(fmaxf(next, y), x) : fmaxf(fminf(next, y), x);
}

static void filter_follow(struct light_filter *f, float (*radiance)[3], int64_t now_ns, float fast,
			  float slow)
{
	for (int i = 0; i < f->count; i++) {
		const float share = now_ns <= f->until_ns[i] ? fast : slow;

		for (int c = 0; c < 3; c++) {
			f->value[i][c] = light_step(f->value[i][c], radiance[i][c], share,
						    f->noise[i]);
			radiance[i][c] = f->value[i][c];
		}
	}
}

static bool goes_on(const struct light_filter *f, int64_t captured_ns, int64_t follow_ns)
{
	return f->begun && follow_ns > 0 && captured_ns >= f->last_ns &&
	       captured_ns - f->last_ns <= NS_PER_S + follow_ns;
}

void light_filter_run(struct light_filter *f, int64_t captured_ns, int64_t follow_ns,
		      float (*radiance)[3])
{
	const int64_t dt_ns = captured_ns - f->last_ns;

	if (goes_on(f, captured_ns, follow_ns)) {
		find_changes(f, (const float(*)[3])radiance, captured_ns + follow_ns);
		filter_follow(f, radiance, captured_ns, change_share(dt_ns, (double)follow_ns),
			      change_share(dt_ns, (double)follow_ns * LIGHT_FILTER_SLOW));
	} else {
		memcpy(f->value, radiance, sizeof(*f->value) * (size_t)f->count);
		filter_hasten(f, 0, f->count, INT64_MIN);
		f->begun = true;
	}
	f->last_ns = captured_ns;
}
