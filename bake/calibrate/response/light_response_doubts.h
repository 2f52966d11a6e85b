/* SPDX-License-Identifier: MIT */
/* Private to light_response*.c: doubts about a response. */
#ifndef INLAY_BAKE_CALIBRATE_RESPONSE_LIGHT_RESPONSE_DOUBTS_H
#define INLAY_BAKE_CALIBRATE_RESPONSE_LIGHT_RESPONSE_DOUBTS_H

#include "bake/calibrate/response/light_response.h"
#include "bake/calibrate/response/light_response_fit.h"

/* Judges the pictures, before anything is fitted; found->from and to are set. */
void light_doubt_pictures(struct light_response *found, const struct light_samples *samples,
			  const double *time);

/* Judges the fit; everything but the verdict is set. */
void light_doubt_fit(struct light_response *found, const struct light_fit_task *task,
		     double misfit);

#endif
