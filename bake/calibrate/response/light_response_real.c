/* SPDX-License-Identifier: MIT */
#include "bake/calibrate/response/light_response_parts.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define LAST (TRANSFER_KNOTS - 1)
#define BINS 32
#define STEPS 3 /* of a shutter's times, in a factor of two: 1/60 s is 1/64 s, 13 s are 12.7 s */
#define ROUNDING_MOST 0.1 /* largest error of a time that is taken for rounding */
#define BETTER 0.8	  /* residual that refined times leave, of that without */

int light_real_copy(struct light_samples *copy, const struct light_samples *from)
{
	*copy = *from;
	copy->sample = malloc(((size_t)from->count + 1) * sizeof(*copy->sample));
	if (!copy->sample)
		return -ENOMEM;
	memcpy(copy->sample, from->sample, (size_t)from->count * sizeof(*copy->sample));
	copy->room = from->count + 1;
	return 0;
}

/* Bins are narrow near black, where errors change most. */
static int bin_of(double u)
{
	const int bin = (int)(BINS * sqrt(fmax(u, 0)));

	return bin < BINS ? bin : BINS - 1;
}

struct bin {
	double squares, weight;
};

/* Adds what is left of a sample, in code values squared, relative to how much of it the others of
 * the same sample leave: of two alike, the mean takes half. */
static void add_residuals(struct bin *bin, const struct light_fit *fit,
			  const struct light_fit_task *task, const struct light_sample *s)
{
	double log_l[LIGHT_EXPOSURES_MAX], w[LIGHT_EXPOSURES_MAX], sum = 0, total = 0;

	for (int j = 0; j < task->samples->exposures; j++) {
		double variance;

		if (!s->good[j])
			continue;
		log_l[j] = light_fit_radiance(fit, task, s, j, &variance);
		w[j] = 1 / variance;
		sum += w[j] * log_l[j];
		total += w[j];
	}
	for (int j = 0; j < task->samples->exposures; j++) {
		double slope;

		if (!s->good[j] || w[j] > 0.999 * total)
			continue;
		light_fit_log(fit, s->mean[j], &slope, NULL);
		bin[bin_of(s->mean[j])].squares += pow((log_l[j] - sum / total) / slope, 2);
		bin[bin_of(s->mean[j])].weight += 1 - w[j] / total;
	}
}

void light_real_inflate(struct light_samples *own, const struct light_fit *fit,
			const struct light_fit_task *task)
{
	struct bin bin[BINS] = {{0}};

	for (int i = 0; i < own->count; i++)
		add_residuals(bin, fit, task, &own->sample[i]);
	for (int i = 0; i < own->count; i++) {
		struct light_sample *s = &own->sample[i];

		for (int j = 0; j < own->exposures; j++) {
			const struct bin *b = &bin[s->good[j] ? bin_of(s->mean[j]) : 0];

			if (s->good[j] && b->weight > 0)
				s->variance[j] = fmax(s->variance[j], b->squares / b->weight);
		}
	}
}

bool light_real_times(struct light_response *found, const struct light_fit *fit,
		      struct light_fit_task *task, double *time)
{
	struct light_fit_task stepped = *task;
	struct light_fit refined;

	if (task->time_deviation > 0)
		return false;
	for (int j = 0; j < task->samples->exposures; j++) {
		time[j] = exp2(rint(STEPS * log2(task->time[j])) / STEPS);
		if (fabs(log(time[j] / task->time[j])) > ROUNDING_MOST)
			return false;
	}
	stepped.time = time;
	if (light_fit_find(&refined, &stepped, &fit->spline, NULL) < 0 ||
	    refined.sigma > BETTER * fit->sigma)
		return false;
	task->time = time;
	found->refined = true;
	return true;
}

int light_real_spread(struct light_response *found, const struct light_fit *fit,
		      const struct light_fit_task *task)
{
	const int exposures = task->samples->exposures;
	double sum[TRANSFER_KNOTS] = {0}, squares[TRANSFER_KNOTS] = {0};
	int count = 0;

	for (int j = 0; j < exposures; j++) {
		struct light_fit_task without = *task;
		struct light_fit own;
		double one;
		int err;

		without.held_out = j;
		err = light_fit_find(&own, &without, &fit->spline, NULL);
		if (err == -ENOMEM)
			return err;
		if (err)
			continue;
		one = light_fit_log(&own, (double)(LAST / 2) / LAST, NULL, NULL);
		for (int k = 1; k < LAST; k++) {
			const double off = light_fit_log(&own, (double)k / LAST, NULL, NULL) - one;

			sum[k] += off;
			squares[k] += off * off;
		}
		count++;
	}
	for (int k = 1; k < LAST && count > 1; k++) {
		const double variance = (squares[k] - sum[k] * sum[k] / count) * (count - 1) /
					count;

		found->spread[k] = sqrt(fmax(variance, 0));
	}
	found->real = true;
	return 0;
}

void light_real_misfit(struct light_response *found)
{
	double squares = 0;
	int count = 0;

	for (int k = LAST / 10; k <= LAST * 9 / 10; k++)
		found->misfit = fmax(found->misfit,
				     found->real ? found->spread[k]
						 : found->deviation[k] / found->curve.knot[k]);
	for (int k = LIGHT_LEVELS / 10; k < LIGHT_LEVELS * 9 / 10; k++) {
		if (isnan(found->level_offset[k]))
			continue;
		found->misfit = fmax(found->misfit, fabs(found->level_offset[k]));
		squares += found->level_scatter[k] * found->level_scatter[k];
		count++;
	}
	found->disagreement = count ? sqrt(squares / count) : 0;
}
