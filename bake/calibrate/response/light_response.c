/* SPDX-License-Identifier: MIT */
#include "bake/calibrate/response/light_response.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bake/calibrate/response/light_response_parts.h"

#define LAST (TRANSFER_KNOTS - 1)
#define ABOUT_BEST 1.003
#define REAL_SIGMA                                                                                 \
	2.0 /* rms error, in deviations of noise, beyond which there is more than noise */
#define REAL_ROUNDS 3
#define PIECES_ALONE 3	/* if no exposure can be held out */
#define HELD_OUT_MOST 6 /* exposures held out, in turn */

static const int pieces_to_try[] = {1, 2, 3, 4, 6, 8, 12, 16, 24};

#define TRIALS ((int)(sizeof(pieces_to_try) / sizeof(*pieces_to_try)))

static int check_exposures(const struct light_samples *samples,
			   const struct light_response_settings *s, struct fault *fault)
{
	for (int j = 0; j < samples->exposures; j++)
		if (!(s->time[j] > 0) || !isfinite(s->time[j]))
			return fault_say(fault, -EINVAL,
					 "time %d is %g, expected a positive number", j + 1,
					 s->time[j]);
	if (!(s->time_deviation >= 0 && s->time_deviation < 1))
		return fault_say(fault, -EINVAL,
				 "the times' deviation is %g, expected 0 to 1, relative",
				 s->time_deviation);
	return 0;
}

static void find_range(struct light_response *found, const struct light_samples *samples)
{
	found->from = 1;
	found->to = 0;
	for (int i = 0; i < samples->count; i++) {
		const struct light_sample *s = &samples->sample[i];

		for (int j = 0; j < samples->exposures; j++) {
			if (!s->good[j])
				continue;
			found->from = fmin(found->from, s->mean[j]);
			found->to = fmax(found->to, s->mean[j]);
		}
	}
}

/* ---- fitting ---- */

static struct light_spline spline_of(const struct light_response *found, int pieces)
{
	return (struct light_spline){.pieces = pieces, .from = found->from, .to = found->to};
}

/* Returns the mean squared prediction error over exposures that are held out in turn. Negative:
 * not known. */
static double held_out_score(const struct light_response *found, const struct light_fit_task *task,
			     int pieces)
{
	const struct light_spline spline = spline_of(found, pieces);
	const int exposures = task->samples->exposures;
	const int step = (exposures + HELD_OUT_MOST - 1) / HELD_OUT_MOST;
	double squares = 0;
	int count = 0;

	for (int j = 0; j < exposures; j += step) {
		struct light_fit_task without = *task;
		struct light_fit fit;
		double rms;

		without.held_out = j;
		if (light_fit_find(&fit, &without, &spline, NULL) < 0)
			continue;
		rms = light_fit_foretell(&fit, &without);
		if (rms < 0)
			continue;
		squares += rms * rms;
		count++;
	}
	return count ? squares / count : -1;
}

/* Chooses the fewest pieces that predict about as well as the best: more would follow noise. */
static void choose_pieces(struct light_response *found, const struct light_fit_task *task)
{
	double squares[TRIALS], best = INFINITY;
	int tried = 0, best_at = 0;

	found->spline = spline_of(found, PIECES_ALONE);
	if (task->samples->exposures < 3)
		return;
	for (; tried < TRIALS && tried <= best_at + 2; tried++) {
		squares[tried] = held_out_score(found, task, pieces_to_try[tried]);
		if (squares[tried] > 0 && squares[tried] < best) {
			best = squares[tried];
			best_at = tried;
		}
	}
	for (int k = 0; k < tried; k++) {
		if (!(squares[k] > 0) || squares[k] > best * ABOUT_BEST)
			continue;
		found->spline.pieces = pieces_to_try[k];
		found->held_out = sqrt(squares[k]);
		return;
	}
}

/* Gradient of ln f at a knot, with f scaled to 1 at the upper end. */
static void knot_gradient(const struct light_fit *fit, int knot, double *gradient)
{
	double end[LIGHT_SPLINE_MAX];

	light_spline_at(&fit->spline, (double)knot / LAST, gradient, NULL);
	light_spline_at(&fit->spline, 1, end, NULL);
	for (int k = 0; k < light_spline_count(&fit->spline); k++)
		gradient[k] -= end[k];
}

static double knot_covariance(const struct light_fit *fit, int a, int b)
{
	const int n = light_spline_count(&fit->spline);
	double ga[LIGHT_SPLINE_MAX], gb[LIGHT_SPLINE_MAX], sum = 0;

	knot_gradient(fit, a, ga);
	knot_gradient(fit, b, gb);
	for (int i = 0; i < n; i++)
		for (int j = 0; j < n; j++)
			sum += ga[i] * fit->covariance[i][j] * gb[j];
	return sum;
}

static double knot_value(const struct light_fit *fit, int knot)
{
	const double one = light_fit_log(fit, 1, NULL, NULL);

	return knot ? exp(light_fit_log(fit, (double)knot / LAST, NULL, NULL) - one) : 0;
}

static int take_knots(struct light_response *found, const struct light_fit *fit)
{
	struct estimate *e = &found->estimate;
	double *knot = found->curve.knot;

	if (estimate_create(e, LAST - 1) < 0)
		return -ENOMEM;
	for (int k = 0; k <= LAST; k++)
		knot[k] = k == LAST ? 1 : knot_value(fit, k);
	for (int a = 1; a < LAST; a++) {
		struct parameter *p = &e->parameter[a - 1];

		snprintf(p->name, sizeof(p->name), "knot %d", a);
		p->value = knot[a];
		for (int b = 1; b < LAST; b++)
			e->covariance[(a - 1) * e->count + b - 1] = knot[a] * knot[b] *
								    knot_covariance(fit, a, b);
		found->deviation[a] = estimate_deviation(e, a - 1);
	}
	e->residuals = fit->equations;
	e->freedom = fit->freedom;
	e->sigma = fit->sigma;
	return 0;
}

/* Stores the refined times. A common power of all times is equivalent to a power of the response:
 * only the given times determine it. */
static void take_times(struct light_response *found, const struct light_fit *fit,
		       const struct light_fit_task *task)
{
	const int first = light_spline_count(&fit->spline);
	double squares = 0;

	for (int j = 1; j < found->exposures; j++)
		squares += pow(log(task->time[j] / task->time[0]), 2);
	for (int j = 0; j < found->exposures; j++) {
		const double own = fit->covariance[first + j][first + j];
		const double apart = log(task->time[j] / task->time[0]);

		found->time[j] = task->time[j] * exp(fit->a[first + j]);
		found->time_deviation[j] =
			squares > 0 ? sqrt(own + pow(task->time_deviation * apart, 2) / squares)
				    : 0;
	}
}

/* Sums of the samples' differences. */
struct offset_tally {
	double sum, squares;
	int count;
};

static void offsets_add(struct offset_tally *t, double off)
{
	t->sum += off;
	t->squares += off * off;
	t->count++;
}

/* Compares each exposure of a sample with their weighted mean. */
static void compare_sample(const struct light_fit *fit, const struct light_fit_task *task,
			   const struct light_sample *s, struct offset_tally *exposure,
			   struct offset_tally *level)
{
	double log_l[LIGHT_EXPOSURES_MAX], middle = 0, total = 0, variance;

	for (int j = 0; j < task->samples->exposures; j++) {
		if (!s->good[j])
			continue;
		log_l[j] = light_fit_radiance(fit, task, s, j, &variance);
		middle += log_l[j] / variance;
		total += 1 / variance;
	}
	for (int j = 0; j < task->samples->exposures; j++) {
		if (!s->good[j])
			continue;
		/* nearer to black the same errors are many times as large, and matter less */
		if (s->mean[j] > 0.1 && s->mean[j] < 0.9)
			offsets_add(&exposure[j], log_l[j] - middle / total);
		offsets_add(&level[(int)(s->mean[j] * LIGHT_LEVELS)], log_l[j] - middle / total);
	}
}

static void compare_exposures(struct light_response *found, const struct light_fit *fit,
			      const struct light_fit_task *task)
{
	struct offset_tally exposure[LIGHT_EXPOSURES_MAX] = {{0}}, level[LIGHT_LEVELS] = {{0}};

	for (int i = 0; i < task->samples->count; i++)
		compare_sample(fit, task, &task->samples->sample[i], exposure, level);
	for (int j = 0; j < found->exposures; j++) {
		const struct offset_tally *t = &exposure[j];

		found->offset[j] = t->count ? t->sum / t->count : 0;
		found->scatter[j] = t->count ? sqrt(t->squares / t->count) : 0;
	}
	for (int k = 0; k < LIGHT_LEVELS; k++) {
		const struct offset_tally *t = &level[k];

		found->level_offset[k] = t->count ? t->sum / t->count : NAN;
		found->level_scatter[k] = t->count ? sqrt(t->squares / t->count) : NAN;
	}
}

/* Returns ln(f(knot) / f(other)) and, unless NULL, its deviation. */
static double log_ratio(const struct light_fit *fit, int knot, int other, double *deviation)
{
	const int n = light_spline_count(&fit->spline);
	const double u = (double)knot / LAST, v = (double)other / LAST;
	double g[LIGHT_SPLINE_MAX], h[LIGHT_SPLINE_MAX], sum = 0;

	light_spline_at(&fit->spline, u, g, NULL);
	light_spline_at(&fit->spline, v, h, NULL);
	for (int i = 0; i < n; i++)
		for (int j = 0; j < n; j++)
			sum += (g[i] - h[i]) * fit->covariance[i][j] * (g[j] - h[j]);
	if (deviation)
		*deviation = sqrt(fmax(sum, 0));
	return light_fit_log(fit, u, NULL, NULL) - light_fit_log(fit, v, NULL, NULL);
}

/* Range of knots between 10 % and 90 % that the channel's samples cover. */
static void channel_range(const struct light_samples *samples, int channel, int *first, int *last)
{
	double from = 1, to = 0;

	for (int i = 0; i < samples->count; i++) {
		const struct light_sample *s = &samples->sample[i];

		for (int j = 0; j < samples->exposures; j++) {
			if (!s->good[j] || s->channel != channel)
				continue;
			from = fmin(from, s->mean[j]);
			to = fmax(to, s->mean[j]);
		}
	}
	*first = (int)ceil(fmax(from, 0.1) * LAST);
	*last = (int)floor(fmin(to, 0.9) * LAST);
}

/* Compares each channel's own curve with the common one, both scaled to 1 in the middle of what it
 * covers. */
static void compare_channels(struct light_response *found, const struct light_fit *fit,
			     const struct light_fit_task *task, const struct light_samples *samples)
{
	for (int c = 0; c < 3; c++) {
		struct light_fit_task one = *task, by_noise = *task;
		struct light_fit own;
		int first, last;

		one.channel = by_noise.channel = c;
		by_noise.samples = samples;
		if (light_fit_find(&own, &by_noise, &fit->spline, NULL) == 0)
			found->channel_sigma[c] = own.sigma;
		channel_range(task->samples, c, &first, &last);
		if (light_fit_find(&own, &one, &fit->spline, NULL) < 0)
			continue;
		for (int k = first; k <= last; k++) {
			const int middle = (first + last) / 2;
			double deviation;
			const double off = fabs(expm1(log_ratio(&own, k, middle, &deviation) -
						      log_ratio(fit, k, middle, NULL)));

			if (off <= found->channel_off[c])
				continue;
			found->channel_off[c] = off;
			found->channel_deviation[c] = deviation;
		}
	}
}

static void make_straight(struct light_response *found)
{
	for (int k = 0; k <= LAST; k++)
		found->curve.knot[k] = (double)k / LAST;
	verdict_doubt(&found->verdict, "change the times by less from one exposure to the next",
		      "too few places are seen in two exposures");
}

/*
 * Fits a series that noise does not explain, as those of real cameras are: the errors of each level
 * are what they are seen to be, and times may be those of a shutter's steps. The pieces are chosen
 * again, because the first choice followed errors near black.
 */
static int fit_real(struct light_response *found, struct light_fit_task *task,
		    struct light_samples *own, double *time, struct light_fit *fit,
		    struct fault *fault)
{
	int ret = light_real_copy(own, task->samples);

	if (ret == 0 && light_real_times(found, fit, task, time)) {
		choose_pieces(found, task);
		ret = light_fit_find(fit, task, &found->spline, fault);
	}
	found->sigma = fit->sigma;
	if (ret || fit->sigma <= REAL_SIGMA)
		return ret;
	task->samples = own;
	for (int round = 0; ret == 0 && round < REAL_ROUNDS; round++) {
		light_real_inflate(own, fit, task);
		if (round == 0)
			choose_pieces(found, task);
		ret = light_fit_find(fit, task, &found->spline, fault);
	}
	return ret;
}

static void conclude_fit(struct light_response *found, const struct light_fit *fit,
			 const struct light_fit_task *task, const struct light_samples *samples,
			 const struct light_response_settings *settings)
{
	take_times(found, fit, task);
	compare_exposures(found, fit, task);
	compare_channels(found, fit, task, samples);
	light_real_misfit(found);
	light_doubt_fit(found, task, settings->misfit > 0 ? settings->misfit : LIGHT_MISFIT);
}

int light_response_find(struct light_response *found, const struct light_samples *samples,
			const struct light_response_settings *settings, struct fault *fault)
{
	struct light_fit_task task = {.samples = samples,
				      .time = settings->time,
				      .time_deviation = settings->time_deviation,
				      .channel = -1,
				      .held_out = -1};
	struct light_samples own = {.sample = NULL};
	struct light_fit fit = {.sigma = 0};
	double refined[LIGHT_EXPOSURES_MAX];
	int ret = check_exposures(samples, settings, fault);

	*found = (struct light_response){.exposures = samples->exposures,
					 .samples = samples->count,
					 .curve = {.black = samples->black, .measured = true}};
	if (ret < 0)
		return ret;
	verdict_begin(&found->verdict);
	memcpy(found->time, settings->time, sizeof(found->time));
	find_range(found, samples);
	light_doubt_pictures(found, samples, settings->time);
	if (!(found->to > found->from)) {
		make_straight(found);
		return 0;
	}
	choose_pieces(found, &task);
	ret = light_fit_find(&fit, &task, &found->spline, fault);
	found->sigma = fit.sigma;
	if (ret == 0 && fit.sigma > REAL_SIGMA)
		ret = fit_real(found, &task, &own, refined, &fit, fault);
	if (ret == 0)
		ret = take_knots(found, &fit);
	if (ret == 0 && found->sigma > REAL_SIGMA)
		ret = light_real_spread(found, &fit, &task);
	if (ret == 0)
		conclude_fit(found, &fit, &task, samples, settings);
	free(own.sample);
	if (ret == -ENODATA) {
		make_straight(found);
		return 0;
	}
	return ret < 0 ? fault_say(fault, ret, "not enough memory for the response") : 0;
}

void light_response_free(struct light_response *found)
{
	estimate_free(&found->estimate);
}
