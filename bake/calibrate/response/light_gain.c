/* SPDX-License-Identifier: MIT */
#include "bake/calibrate/response/light_gain.h"

#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <stdio.h>

#include "bake/calibrate/estimate/least_squares.h"

#define OUTLIER 0.1  /* weight below which a pair may be an outlier */
#define DIFFERS 0.05 /* of the gain: a visible difference */

void light_gain_predict(const struct dome *dome, const float (*radiance)[3],
			const double reflectance[3], double predicted[3])
{
	for (int c = 0; c < 3; c++) {
		predicted[c] = 0;
		for (int i = 0; i < dome->count; i++)
			predicted[c] += (double)radiance[i][c] * dome->projected_sr[i];
		predicted[c] *= reflectance[c] / M_PI;
	}
}

static double sum_of_channels(const double x[3])
{
	return x[0] + x[1] + x[2];
}

/* Relative deviation of one pair, from its patch alone. */
static double pair_deviation(const struct light_pair *pair)
{
	const struct light_patch *p = &pair->patch;
	double squares = 0;

	for (int c = 0; c < 3; c++)
		squares += p->deviation[c] * p->deviation[c];
	return sqrt(squares) / sum_of_channels(p->mean);
}

static bool gain_evaluate(void *context, const double *x, double *residual)
{
	const struct light_gain *found = context;

	for (int k = 0; k < found->pairs; k++)
		residual[k] = log(found->ratio[k]) - x[0];
	return true;
}

/* Fits the mean of the ratios' logarithms. */
static int fit_mean(struct light_gain *found, double loss_scale, double *variance,
		    struct fault *fault)
{
	static const double scale[] = {0.1};
	const struct least_squares problem = {.parameters = 1,
					      .residuals = found->pairs,
					      .evaluate = gain_evaluate,
					      .context = found,
					      .scale = scale,
					      .loss_scale = loss_scale,
					      .group = 1};
	struct least_squares_fit fit = {.covariance = NULL};
	double x[1] = {log(found->ratio[0])};
	const int err = least_squares_solve(&problem, x, &fit, fault);

	if (!err) {
		found->gain = exp(x[0]);
		for (int k = 0; k < found->pairs; k++)
			found->weight[k] = fit.weight[k];
		*variance = fit.covariance[0];
	}
	least_squares_free(&fit);
	return err;
}

/* Whether a pair is an outlier: by weight and by difference, because of three pairs two may be so
 * close that the third has little weight anywhere. */
static bool is_outlier(const struct light_gain *found, int k)
{
	return found->weight[k] < OUTLIER && fabs(log(found->ratio[k] / found->gain)) > DIFFERS;
}

static int count_outliers(const struct light_gain *found, int *last)
{
	int count = 0;

	for (int k = 0; k < found->pairs; k++)
		if (is_outlier(found, k)) {
			count++;
			*last = k;
		}
	return count;
}

/* Finds the gain by a robust fit; without outliers all pairs count alike, and their spread gives
 * the deviation. */
static int find_mean(struct light_gain *found, const struct light_pair *pairs, struct fault *fault)
{
	double variance = 0, own = 0;
	int last, err = fit_mean(found, found->pairs > 2 ? 3 : 0, &variance, fault);

	if (!err && found->pairs > 2 && !count_outliers(found, &last))
		err = fit_mean(found, 0, &variance, fault);
	for (int k = 0; k < found->pairs; k++)
		own += pow(pair_deviation(&pairs[k]) / found->pairs, 2);
	found->deviation = found->gain * sqrt(fmax(variance, own));
	return err;
}

static void find_balance(struct light_gain *found, const struct light_pair *pairs)
{
	for (int c = 0; c < 3; c++) {
		double sum = 0, total = 0;

		for (int k = 0; k < found->pairs; k++) {
			if (!(pairs[k].predicted[c] > 0))
				continue;
			sum += found->weight[k] * pairs[k].patch.mean[c] / pairs[k].predicted[c];
			total += found->weight[k];
		}
		found->balance[c] = total > 0 ? sum / total / found->gain : 1;
	}
}

static void doubt_pair(struct light_gain *found, const struct light_pair *pair, int k)
{
	if (pair->patch.clipped > 0.001)
		verdict_doubt(&found->verdict,
			      "expose the background camera shorter, or choose a darker patch",
			      "the patch of pair %d is clipped", k + 1);
	if (sum_of_channels(pair->patch.mean) < 0.015)
		verdict_doubt(&found->verdict,
			      "expose the background camera longer, or choose a lighter patch",
			      "the patch of pair %d is nearly black", k + 1);
	if (pair->patch.uneven > 0.05)
		verdict_doubt(
			&found->verdict, "choose a smaller one, outside of every shadow's edge",
			"the patch of pair %d is not of one brightness: parts differ by %.0f %%",
			k + 1, 100 * pair->patch.uneven);
	if (pair->clipped_sky > 1e-4)
		verdict_doubt(&found->verdict,
			      "expose the fisheye shorter, or wait until sun and lamps are away",
			      "%.2g %% of the sky of pair %d is clipped: its light is not known",
			      100 * pair->clipped_sky, k + 1);
}

static void doubt_gain(struct light_gain *found, const struct light_pair *pairs)
{
	int which = 0;

	for (int k = 0; k < found->pairs; k++)
		doubt_pair(found, &pairs[k], k);
	if (count_outliers(found, &which))
		verdict_doubt(
			&found->verdict,
			"see whether something casts a shadow on its patch, or its pictures are of different moments",
			"pair %d gives %.3g, the others %.3g", which + 1, found->ratio[which],
			found->gain);
	if (found->deviation > DIFFERS * found->gain)
		verdict_doubt(
			&found->verdict,
			"keep shadows, the object's too, off the patch, and take both pictures at one moment",
			"the pairs differ: gain is known to %.0f %% only",
			100 * found->deviation / found->gain);
}

int light_gain_find(struct light_gain *found, const struct light_pair *pairs, int count,
		    struct fault *fault)
{
	int err;

	*found = (struct light_gain){.pairs = count};
	verdict_begin(&found->verdict);
	if (count < 1 || count > LIGHT_PAIRS_MAX)
		return fault_say(fault, -EINVAL, "there are %d pairs, expected 1 to %d", count,
				 LIGHT_PAIRS_MAX);
	for (int k = 0; k < count; k++) {
		if (!(sum_of_channels(pairs[k].predicted) > 0) ||
		    !(sum_of_channels(pairs[k].patch.mean) > 0))
			return fault_say(fault, -EINVAL, "pair %d: there is no light in its %s",
					 k + 1,
					 sum_of_channels(pairs[k].predicted) > 0 ? "patch" : "sky");
		found->ratio[k] = sum_of_channels(pairs[k].patch.mean) /
				  sum_of_channels(pairs[k].predicted);
	}
	err = find_mean(found, pairs, fault);
	if (err)
		return err;
	find_balance(found, pairs);
	doubt_gain(found, pairs);
	return 0;
}
