/* SPDX-License-Identifier: MIT */
/*
 * A camera's response from several exposures of a static scene whose relative times are known.
 *
 * Of a place of radiance L seen at time t with code value u (0..1 from the black level), f being
 * the response: ln f(u) = ln L + ln t (Debevec and Malik, SIGGRAPH 1997, equation 2). f is a spline
 * (light_spline.h), so that this is linear in its coefficients, ln L, and what times are off by;
 * each equation counts by what noise and rounding do to ln f(u). The number of the spline's pieces
 * is the one that foretells exposures best that were held out. A pixel's noise, bent by f, moves
 * the mean of a block: by f''/f s^2 / 2 of itself, which is taken out (s^2: variance of a pixel).
 */
#ifndef INLAY_BAKE_CALIBRATE_RESPONSE_LIGHT_RESPONSE_H
#define INLAY_BAKE_CALIBRATE_RESPONSE_LIGHT_RESPONSE_H

#include "bake/calibrate/estimate/estimate.h"
#include "bake/calibrate/estimate/verdict.h"
#include "bake/calibrate/response/light_samples.h"
#include "bake/calibrate/response/light_spline.h"
#include "hal/colour/transfer.h"

#define LIGHT_LEVELS 20

struct light_response_settings {
	double time[LIGHT_EXPOSURES_MAX]; /* relative, > 0 */
	double time_deviation; /* relative standard deviation of each; 0: they are exact */
};

struct light_response {
	struct transfer_curve curve;	  /* measured, with the samples' black level */
	double deviation[TRANSFER_KNOTS]; /* of curve.knot; 0 for the first and the last */
	double from, to;		  /* code values over their range that were seen */
	int exposures, samples;
	double time[LIGHT_EXPOSURES_MAX]; /* as given, or refined; of the first: as given */
	double time_deviation[LIGHT_EXPOSURES_MAX]; /* of it, relative */
	/* Of codes of k / LIGHT_LEVELS and more: what linear light differs by from what all
	 * exposures say of the sample, relative: mean and rms; NaN: there are none. */
	double level_offset[LIGHT_LEVELS], level_scatter[LIGHT_LEVELS];
	/* Relative, of linear light: what the samples of an exposure differ by from all of them. */
	double offset[LIGHT_EXPOSURES_MAX], scatter[LIGHT_EXPOSURES_MAX];
	double channel_off[3]; /* a channel's own curve against the common one, both 1 in the middle
				  of what it covers: the largest relative difference between code
				  values of 10 % and 90 % */
	double channel_deviation[3]; /* of that difference */
	double channel_sigma[3];     /* as sigma, of its own curve */
	double held_out; /* of an exposure that was held out: rms in standard deviations */
	double sigma;	 /* of all: 1 where noise explains everything */
	/* Knots by name ("knot 1" ... "knot 31"), of which the covariance is. */
	struct estimate estimate;
	struct light_spline spline;
	struct verdict verdict;
};

/*
 * 0 whether it can be trusted or not: verdict says so. Where there is nothing to fit the curve is
 * linear, and doubted. -EINVAL: times; -ENOMEM.
 */
int light_response_find(struct light_response *found, const struct light_samples *samples,
			const struct light_response_settings *settings, struct fault *fault);
void light_response_free(struct light_response *found); /* idempotent; zeroed is fine */

#endif
