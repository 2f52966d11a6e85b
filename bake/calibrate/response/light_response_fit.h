/* SPDX-License-Identifier: MIT */
/* Private to light_response*.c: one fit of a spline of a given number of pieces. */
#ifndef INLAY_BAKE_CALIBRATE_RESPONSE_LIGHT_RESPONSE_FIT_H
#define INLAY_BAKE_CALIBRATE_RESPONSE_LIGHT_RESPONSE_FIT_H

#include "bake/calibrate/response/light_samples.h"
#include "bake/calibrate/response/light_spline.h"

/* The spline's coefficients, of which the first is 0, then what ln t of each exposure is off by. */
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
	double sigma; /* of one equation, in its standard deviations */
	int equations, freedom;
};

/* 0; -ENODATA: too few equations; -ENOMEM. */
int light_fit_find(struct light_fit *fit, const struct light_fit_task *task,
		   const struct light_spline *spline, struct fault *fault);

/* ln f(u), not normalized, and unless NULL its slope and second derivative by u. */
double light_fit_log(const struct light_fit *fit, double u, double *slope, double *bend);

/*
 * ln(f(u) / t) of a sample in exposure j without what noise adds, which is ln L of the sample, and
 * its variance.
 */
double light_fit_radiance(const struct light_fit *fit, const struct light_fit_task *task,
			  const struct light_sample *sample, int j, double *variance);

/* rms, in standard deviations, by which the samples of the exposure that was held out are not where
 * the others foretell them. Negative: it has none. */
double light_fit_foretell(const struct light_fit *fit, const struct light_fit_task *task);

#endif
