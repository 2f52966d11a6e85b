/* SPDX-License-Identifier: MIT */
/* Private to light_response*.c: series of real cameras, whose compression, shutters and processing
 * make larger errors than noise does. */
#ifndef INLAY_BAKE_CALIBRATE_RESPONSE_LIGHT_RESPONSE_REAL_H
#define INLAY_BAKE_CALIBRATE_RESPONSE_LIGHT_RESPONSE_REAL_H

#include "bake/calibrate/response/light_response.h"
#include "bake/calibrate/response/light_response_fit.h"

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

#endif
