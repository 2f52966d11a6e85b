/* SPDX-License-Identifier: MIT */
/*
 * The gain that turns the fisheye's units into the background camera's: a patch of known
 * reflectance that lies level in the background picture, under the sky that the fisheye sees, has
 * the radiance reflectance / pi * integral of L cos(theta) (Lambert). The ratio of what the
 * background camera measures to that is the gain; one for each pair of pictures.
 */
#ifndef INLAY_BAKE_CALIBRATE_RESPONSE_LIGHT_GAIN_H
#define INLAY_BAKE_CALIBRATE_RESPONSE_LIGHT_GAIN_H

#include "bake/calibrate/estimate/verdict.h"
#include "bake/calibrate/response/light_patch.h"
#include "hal/lights/sampler.h"

#define LIGHT_PAIRS_MAX 32

struct light_pair {
	double predicted[3]; /* by light_gain_predict() */
	struct light_patch patch;
	double clipped_sky; /* share of the sky's solid angle, 0..1 */
};

struct light_gain {
	double gain;
	double deviation;		/* of it */
	double balance[3];		/* R, G, B: that channel's own gain over gain */
	double ratio[LIGHT_PAIRS_MAX];	/* each pair's own gain */
	double weight[LIGHT_PAIRS_MAX]; /* 0..1, of the robust loss */
	int pairs;
	struct verdict verdict;
};

/* What a level patch of this reflectance (0..1, R G B) gives off, in the sampler's units. */
void light_gain_predict(const struct dome *dome, const float (*radiance)[3],
			const double reflectance[3], double predicted[3]);

/* -EINVAL: no pairs or too many, light that is none; -ENOMEM. */
int light_gain_find(struct light_gain *found, const struct light_pair *pairs, int count,
		    struct fault *fault);

#endif
