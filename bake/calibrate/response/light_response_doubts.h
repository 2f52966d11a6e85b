/* SPDX-License-Identifier: MIT */
/* Private to light_response*.c: why a response is not to be trusted. */
#ifndef INLAY_BAKE_CALIBRATE_RESPONSE_LIGHT_RESPONSE_DOUBTS_H
#define INLAY_BAKE_CALIBRATE_RESPONSE_LIGHT_RESPONSE_DOUBTS_H

#include "bake/calibrate/response/light_response.h"
#include "bake/calibrate/response/light_response_fit.h"

/* What pictures alone tell, before anything is fitted; from and to are known. */
void light_doubt_pictures(struct light_response *found, const struct light_samples *samples,
			  const double *time);

/* What the fit tells; all but the verdict is known. */
void light_doubt_fit(struct light_response *found, const struct light_fit_task *task);

#endif
