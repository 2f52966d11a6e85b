/* SPDX-License-Identifier: MIT */
#include "bake/calibrate/response/light_response_parts.h"

#include <math.h>
#include <stdio.h>

#define LAST (TRANSFER_KNOTS - 1)
#define SAMPLES_MIN 60
#define DISAGREEMENT 0.1 /* largest rms difference between exposures, of linear light */

/* ---- what pictures alone tell ---- */

static double mean_over_exposures(const double *x, int count)
{
	double sum = 0;

	for (int i = 0; i < count; i++)
		sum += x[i] / count;
	return sum;
}

void light_doubt_pictures(struct light_response *found, const struct light_samples *samples,
			  const double *time)
{
	double shortest = INFINITY, longest = 0;

	for (int j = 0; j < samples->exposures; j++) {
		shortest = fmin(shortest, time[j]);
		longest = fmax(longest, time[j]);
	}
	if (samples->exposures < 3)
		verdict_doubt(&found->verdict,
			      "take five, each with half the time of the one before",
			      "fewer than three exposures cannot check each other");
	if (longest < 2 * shortest)
		verdict_doubt(&found->verdict,
			      "take five, each with half the time of the one before",
			      "the exposures are nearly alike");
	if (mean_over_exposures(samples->clipped, samples->exposures) > 0.9)
		verdict_doubt(&found->verdict, "take them with shorter times",
			      "nearly everything is clipped in all exposures");
	if (mean_over_exposures(samples->dark, samples->exposures) > 0.9)
		verdict_doubt(&found->verdict, "take them with longer times",
			      "nearly everything is black in all exposures");
	if (samples->count < SAMPLES_MIN) {
		verdict_doubt(
			&found->verdict,
			"show a scene of many brightnesses, and change the times by less",
			"only %d places are neither clipped nor black in two exposures, %d are needed",
			samples->count, SAMPLES_MIN);
	}
	if (found->from > 0.15 || found->to < 0.85) {
		verdict_doubt(&found->verdict,
			      "show a scene of many brightnesses, dark grey to nearly white",
			      "only %.0f %% to %.0f %% of the code values were seen",
			      100 * found->from, 100 * found->to);
	}
}

/* ---- what the fit tells ---- */

/*
 * Finds the time with the largest error. Errors of ln t are determined only up to a line c + g ln
 * t, because a common power of all times is equivalent to a power of the response: takes the line
 * through two times that leaves the least sum of absolute errors.
 */
static int worst_time(const struct light_fit_task *task, const double *off, double *by)
{
	const int n = task->samples->exposures;
	double least = INFINITY;
	int which = 0;

	*by = 0;
	for (int a = 0; a < n; a++)
		for (int b = a + 1; b < n; b++) {
			const double apart = log(task->time[b] / task->time[a]);
			const double g = apart != 0 ? (off[b] - off[a]) / apart : 0;
			double sum = 0, worst = 0;
			int at = 0;

			for (int j = 0; j < n; j++) {
				const double left = off[j] - off[a] -
						    g * log(task->time[j] / task->time[a]);

				sum += fabs(left);
				if (fabs(left) > fabs(worst)) {
					worst = left;
					at = j;
				}
			}
			if (sum >= least)
				continue;
			least = sum;
			which = at;
			*by = worst;
		}
	return which;
}

/* Whether other times would explain the disagreement. */
static bool blame_times(struct light_response *found, const struct light_fit_task *task)
{
	struct light_fit_task loose = *task;
	struct light_fit fit;
	double by;
	int which;

	loose.time_deviation = 0.5;
	if (task->samples->exposures < 4 ||
	    light_fit_find(&fit, &loose, &found->spline, NULL) < 0 || fit.sigma > found->sigma / 2)
		return false;
	which = worst_time(task, fit.a + light_spline_count(&fit.spline), &by);
	verdict_doubt(
		&found->verdict,
		"check the times, or give --time-deviation so that they are refined",
		"the times do not agree with the pictures: picture %d looks as if it had %.3g times its time",
		which + 1, exp(by));
	return true;
}

/* Doubts channels whose own curves fit well while a common one does not, or differ from it. */
static void doubt_channels(struct light_response *found)
{
	const double *sigma = found->channel_sigma;
	const double worst = fmax(sigma[0], fmax(sigma[1], sigma[2]));
	int which = 0;
	char name;

	if (found->sigma > 4 && worst > found->sigma / 2)
		return;
	for (int c = 1; c < 3; c++)
		which = found->channel_off[c] > found->channel_off[which] ? c : which;
	if (found->channel_off[which] < 0.03 ||
	    found->channel_off[which] < 4 * found->channel_deviation[which])
		return;
	name = "RGB"[which];
	verdict_doubt(&found->verdict, "switch off the camera's own colour and contrast processing",
		      "channel %c has another response than the others, by %.1f %%", name,
		      100 * found->channel_off[which]);
}

void light_doubt_fit(struct light_response *found, const struct light_fit_task *task, double misfit)
{
	const double *knot = found->curve.knot;

	doubt_channels(found);
	if (found->sigma > 4 && (found->misfit > misfit || found->disagreement > DISAGREEMENT) &&
	    !blame_times(found, task))
		verdict_doubt(
			&found->verdict,
			"keep scene, light and camera still, and white balance and gain of the camera fixed, or give --accept-misfit if that is good enough",
			"the exposures do not agree: they differ by %.1f times what noise explains, by %.1f %% of linear light; the curve may be off by %.1f %%",
			found->sigma, 100 * found->disagreement, 100 * found->misfit);
	for (int k = 1; k <= LAST; k++)
		if (!(knot[k] > knot[k - 1]))
			verdict_doubt(&found->verdict,
				      "keep scene and light still, and take more exposures",
				      "the response does not rise everywhere");
	if (found->misfit > misfit)
		verdict_doubt(
			&found->verdict,
			"take more exposures, of a scene with larger even surfaces, or give --accept-misfit if that is good enough",
			"linear light is known to %.1f %% only", 100 * found->misfit);
}
