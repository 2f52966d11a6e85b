/* SPDX-License-Identifier: MIT */
/* Model selection: fits every lens model and compares them. */
#ifndef INLAY_BAKE_CALIBRATE_FISHEYE_FISHEYE_MODELS_H
#define INLAY_BAKE_CALIBRATE_FISHEYE_FISHEYE_MODELS_H

#include "bake/calibrate/fisheye/fisheye_solve.h"

/* Every model's solution. */
struct model_trials {
	bool solved[FISHEYE_MODEL_COUNT];
	int err[FISHEYE_MODEL_COUNT]; /* from lens_solve(), where the model was tried */
	struct lens_solution solution[FISHEYE_MODEL_COUNT];
	/* with residuals capped, so that common outliers count less */
	double rms_px[FISHEYE_MODEL_COUNT];
	double aic[FISHEYE_MODEL_COUNT]; /* Akaike's criterion: the least is best */
	enum fisheye_model best;	 /* the best of the solved ones */
	bool mirrored;
	struct fault fault[FISHEYE_MODEL_COUNT]; /* why a model was not solved */
};

/* Fits the models. start: an equidistant lens from lens_start(). wanted: fits that model and, for
 * comparison, the polynomial; FISHEYE_MODEL_COUNT: all. Returns 0, also where no model was solved;
 * -ENOMEM. */
int models_try(struct model_trials *trials, const struct lens_problem *problem,
	       const struct lens_solution *start, int wanted);
void models_free(struct model_trials *trials); /* idempotent; zeroed is fine */

#endif
