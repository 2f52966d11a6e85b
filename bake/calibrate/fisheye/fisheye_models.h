/* SPDX-License-Identifier: MIT */
/* Which model of lens the points speak for. */
#ifndef INLAY_BAKE_CALIBRATE_FISHEYE_FISHEYE_MODELS_H
#define INLAY_BAKE_CALIBRATE_FISHEYE_FISHEYE_MODELS_H

#include "bake/calibrate/fisheye/fisheye_solve.h"

/* Every model's solution. */
struct model_trials {
	bool solved[FISHEYE_MODEL_COUNT];
	int err[FISHEYE_MODEL_COUNT]; /* of lens_solve(), where it was tried */
	struct lens_solution solution[FISHEYE_MODEL_COUNT];
	double rms_px[FISHEYE_MODEL_COUNT]; /* what lies too far from all models counts less */
	double aic[FISHEYE_MODEL_COUNT];    /* Akaike's criterion: the least is best */
	enum fisheye_model best;	    /* of those that were solved */
	bool mirrored;
	struct fault fault[FISHEYE_MODEL_COUNT]; /* why not */
};

/* start: an equidistant lens to begin with, made by lens_start(). wanted: that model and, to hold
 * against it, the polynomial; FISHEYE_MODEL_COUNT: all. 0, also where no model was solved; -ENOMEM.
 */
int models_try(struct model_trials *trials, const struct lens_problem *problem,
	       const struct lens_solution *start, int wanted);
void models_free(struct model_trials *trials); /* idempotent; zeroed is fine */

#endif
