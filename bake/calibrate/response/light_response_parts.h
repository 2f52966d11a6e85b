/* SPDX-License-Identifier: MIT */
/* Private to light_response*.c. */
#ifndef INLAY_BAKE_CALIBRATE_RESPONSE_LIGHT_RESPONSE_PARTS_H
#define INLAY_BAKE_CALIBRATE_RESPONSE_LIGHT_RESPONSE_PARTS_H

#include "bake/calibrate/response/light_response.h"
#include "bake/calibrate/response/light_samples.h"

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

/* Copies the samples; the caller frees copy->sample. -ENOMEM. */
int light_real_copy(struct light_samples *copy, const struct light_samples *from);

/* Raises the variances of the samples of each level of code values to what the fit leaves there. */
void light_real_inflate(struct light_samples *own, const struct light_fit *fit,
			const struct light_fit_task *task);

/* Whether the pictures agree better if the times, in seconds, are those of a shutter in steps of a
 * third of a stop, which cameras name by round numbers: time[exposures] then becomes the task's. */
bool light_real_times(struct light_response *found, const struct light_fit *fit,
		      struct light_fit_task *task, double *time);

/* Fills the spread of the curve, relative to its middle, that leaving out one exposure after the
 * other shows (jackknife). -ENOMEM. */
int light_real_spread(struct light_response *found, const struct light_fit *fit,
		      const struct light_fit_task *task);

/* Fills misfit and disagreement. */
void light_real_misfit(struct light_response *found);

/* Judges the pictures, before anything is fitted; found->from and to are set. */
void light_doubt_pictures(struct light_response *found, const struct light_samples *samples,
			  const double *time);

/* Judges the fit; everything but the verdict is set. */
void light_doubt_fit(struct light_response *found, const struct light_fit_task *task,
		     double misfit);

#endif
