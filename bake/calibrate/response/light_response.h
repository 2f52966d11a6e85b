/* SPDX-License-Identifier: MIT */
/*
 * A camera's response from several exposures of a static scene with known relative times.
 *
 * For a place of radiance L, exposed for time t, with code value u (0..1 from the black level),
 * the response f satisfies (Debevec and Malik, SIGGRAPH 1997, equation 2)
 *     ln f(u) = ln L + ln t
 * f is a spline (struct light_spline), so this is linear in its coefficients, in ln L and in the
 * errors of ln t. Each equation is weighted by the noise and rounding of ln f(u). The number of
 * the spline's pieces is the one that best predicts held-out exposures. Noise of variance s^2 of
 * a pixel, bent by f, shifts the mean of a block by
 *     f''/f s^2 / 2   (relative)
 * which is corrected.
 */
#ifndef INLAY_BAKE_CALIBRATE_RESPONSE_LIGHT_RESPONSE_H
#define INLAY_BAKE_CALIBRATE_RESPONSE_LIGHT_RESPONSE_H

#include "bake/calibrate/estimate/estimate.h"
#include "bake/calibrate/estimate/verdict.h"
#include "bake/calibrate/response/light_samples.h"
#include "hal/colour/transfer.h"

/*
 * The response as a sum of basis functions, u being the code value over its range, 0..1:
 *     ln f(u) = ln u + sum of b_k(u) a_k
 * The b_k are cubic B-splines in ln((u + e) / (1 - u + e)), e = 0.1: finer towards black, where
 * powers bend, and towards white, where shoulders do. The term ln u makes f proportional to light
 * in the dark.
 */
#define LIGHT_PIECES_MAX 24
#define LIGHT_SPLINE_MAX (LIGHT_PIECES_MAX + 3)

struct light_spline {
	int pieces;	 /* 1..LIGHT_PIECES_MAX, of equal width between from and to */
	double from, to; /* u; continued by a straight line below, by a parabola above */
};

int light_spline_count(const struct light_spline *spline); /* pieces + 3 */

/* Computes b_k(u) and, unless NULL, d b_k / d u. u > 0. */
void light_spline_at(const struct light_spline *spline, double u, double *value, double *slope);

#define LIGHT_LEVELS 20
#define LIGHT_MISFIT 0.05 /* real cameras agree to some per cent */

struct light_response_settings {
	double time[LIGHT_EXPOSURES_MAX]; /* relative, > 0 */
	double time_deviation;		  /* relative standard deviation of each; 0: exact */
	double misfit; /* largest relative error of linear light that is trusted; 0: LIGHT_MISFIT */
};

struct light_response {
	struct transfer_curve curve;	  /* measured, with the samples' black level */
	double deviation[TRANSFER_KNOTS]; /* of curve.knot; 0 for the first and the last */
	double from, to;		  /* code values seen, over their range */
	int exposures, samples;
	double time[LIGHT_EXPOSURES_MAX]; /* as given, or refined; the first one as given */
	double time_deviation[LIGHT_EXPOSURES_MAX]; /* relative standard deviation */
	/* For codes from k / LIGHT_LEVELS: relative difference of linear light from what all
	 * exposures of the sample say, mean and rms; NaN: no samples. */
	double level_offset[LIGHT_LEVELS], level_scatter[LIGHT_LEVELS];
	/* For each exposure: the same difference over its samples from 10 % to 90 % of the codes,
	 * mean and rms. */
	double offset[LIGHT_EXPOSURES_MAX], scatter[LIGHT_EXPOSURES_MAX];
	/* largest relative difference between code values of 10 % and 90 % of a channel's own curve
	 * from the common one, both scaled to 1 in the middle of what it covers */
	double channel_off[3];
	double channel_deviation[3]; /* standard deviation of that difference */
	double channel_sigma[3];     /* sigma of the channel's own curve */
	/* largest relative error of linear light from 10 % to 90 % of the code values: deviation of
	 * the curve, and how far a level is off on average; rms difference between exposures */
	double misfit, disagreement;
	bool real;		       /* noise does not explain the errors: spread is known */
	double spread[TRANSFER_KNOTS]; /* deviation of ln(knot / middle knot), from the exposures */
	bool refined;	 /* times were taken for those of a shutter in steps of a third of a stop */
	double held_out; /* rms of held-out exposures, in standard deviations */
	/* rms of all residuals, in standard deviations: 1 if noise explains everything; of real
	 * cameras it is more */
	double sigma;
	/* The knots by name ("knot 1" ... "knot 31"), with covariance. */
	struct estimate estimate;
	struct light_spline spline;
	struct verdict verdict;
};

/*
 * Finds the response. Returns 0 whether it can be trusted or not (see verdict); if there is nothing
 * to fit the curve is linear, and doubted. -EINVAL: times; -ENOMEM.
 */
int light_response_find(struct light_response *found, const struct light_samples *samples,
			const struct light_response_settings *settings, struct fault *fault);
void light_response_free(struct light_response *found); /* idempotent; zeroed is fine */

#endif
