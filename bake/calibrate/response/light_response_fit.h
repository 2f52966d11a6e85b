/* SPDX-License-Identifier: MIT */
/* Private to light_response*.c: fit of a spline with a given number of pieces. */
#ifndef INLAY_BAKE_CALIBRATE_RESPONSE_LIGHT_RESPONSE_FIT_H
#define INLAY_BAKE_CALIBRATE_RESPONSE_LIGHT_RESPONSE_FIT_H

#include "bake/calibrate/response/light_samples.h"
#include "bake/calibrate/response/light_spline.h"

/* The parameters: the spline's coefficients, the first of which is 0, then the error of ln t of
 * each exposure. */
#define LIGHT_PARAMETERS_MAX (LIGHT_SPLINE_MAX + LIGHT_EXPOSURES_MAX)

struct light_fit_task {
	const struct light_samples *samples;
	const double *time;
	double time_deviation;
	int channel;  /* -1: all */
	int held_out; /* exposure; -1: none */
};

struct light_fit {
	struct light_spline spline;
	double a[LIGHT_PARAMETERS_MAX];
	double covariance[LIGHT_PARAMETERS_MAX][LIGHT_PARAMETERS_MAX];
	double sigma; /* rms of an equation, in its standard deviations */
	int equations, freedom;
};

/* Fits. Returns 0; -ENODATA: too few equations; -ENOMEM. */
int light_fit_find(struct light_fit *fit, const struct light_fit_task *task,
		   const struct light_spline *spline, struct fault *fault);

/* Returns ln f(u), not normalised, and unless NULL its first and second derivative by u. */
double light_fit_log(const struct light_fit *fit, double u, double *slope, double *bend);

/*
 * Returns ln(f(u) / t) of a sample in exposure j, corrected for noise, which estimates ln L, and
 * its variance.
 */
double light_fit_radiance(const struct light_fit *fit, const struct light_fit_task *task,
			  const struct light_sample *sample, int j, double *variance);

/* Returns the rms error, in standard deviations, of predicting the held-out exposure from the
 * others. Negative: it has no samples. */
double light_fit_foretell(const struct light_fit *fit, const struct light_fit_task *task);

#endif
