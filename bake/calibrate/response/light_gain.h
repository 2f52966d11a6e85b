/* SPDX-License-Identifier: MIT */
/*
 * The gain that turns the fisheye's units into the background camera's, from a patch of known
 * reflectance that lies level in the background picture, under the sky that the fisheye sees. Its
 * radiance is (Lambert)
 *     reflectance / pi * integral of L cos(theta)
 * and the gain is the ratio of the background camera's value to that, one for each pair of
 * pictures.
 */
#ifndef INLAY_BAKE_CALIBRATE_RESPONSE_LIGHT_GAIN_H
#define INLAY_BAKE_CALIBRATE_RESPONSE_LIGHT_GAIN_H

#include "bake/calibrate/estimate/verdict.h"
#include "bake/calibrate/response/light_patch.h"
#include "hal/lights/sampler.h"

#define LIGHT_PAIRS_MAX 32

struct light_pair {
	double predicted[3]; /* from light_gain_predict() */
	struct light_patch patch;
	double clipped_sky; /* clipped share of the sky's solid angle, 0..1 */
};

struct light_gain {
	double gain;
	double deviation;		/* standard deviation of gain */
	double balance[3];		/* R, G, B: gain of that channel over gain */
	double ratio[LIGHT_PAIRS_MAX];	/* gain of each pair */
	double weight[LIGHT_PAIRS_MAX]; /* weight of each pair in the robust fit, 0..1 */
	int pairs;
	struct verdict verdict;
};

/* Predicts the radiance of a level patch of this reflectance (0..1, R G B), in the sampler's
 * units. */
void light_gain_predict(const struct dome *dome, const float (*radiance)[3],
			const double reflectance[3], double predicted[3]);

/* Finds the gain. -EINVAL: no pairs or too many, or one without light; -ENOMEM. */
int light_gain_find(struct light_gain *found, const struct light_pair *pairs, int count,
		    struct fault *fault);

#endif
