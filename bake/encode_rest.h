/*
 * Which lights of a V block share one value for each row, the rest (hal/basis/basis_format.h), and
 * which value. Private to the encoder.
 */
#ifndef INLAY_BAKE_ENCODE_REST_H
#define INLAY_BAKE_ENCODE_REST_H

#include <stdbool.h>

#include "bake/encode.h"

struct rest {
	float (*value)[3]; /* [BASIS_TILE^2]: of each pixel of the samples that is kept */
	bool *shares;	   /* [lights] */
	int listed;	   /* how many do not share */
	double error;	   /* largest |v - value| of those that share */
	/* private */
	int lights;
	float *weight;	 /* [3][lights] */
	float *distance; /* [lights] */
};

int rest_create(struct rest *rest, int lights); /* -ENOMEM */
void rest_free(struct rest *rest);		/* zeroed is fine */

/*
 * No light that shares is anywhere further than cut from the value, which is the mean over these
 * lights by what each gives the ground, so that a uniform sky is exact (unless the rounds of
 * choosing run out: then it is within cut like all else). ground: [3][lights], u of the ground.
 * merged: the three channels have one value, the mean of theirs. Some pixel must be kept.
 */
void rest_choose(struct rest *rest, const struct encode_samples *samples, const bool *keep,
		 const double *ground, double cut, bool merged);

#endif
