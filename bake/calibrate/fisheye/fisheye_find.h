/* SPDX-License-Identifier: MIT */
/*
 * inlay-calibrate fisheye from points: tries every lens model and takes the one with the least
 * Akaike criterion, which weighs residuals against the number of parameters (figures aic_...).
 */
#ifndef INLAY_BAKE_CALIBRATE_FISHEYE_FISHEYE_FIND_H
#define INLAY_BAKE_CALIBRATE_FISHEYE_FISHEYE_FIND_H

#include "bake/calibrate/fisheye/fisheye_knowledge.h"
#include "bake/calibrate/observe/observations.h"
#include "hal/optics/fisheye.h"

#define FISHEYE_MODEL_AUTO FISHEYE_MODEL_COUNT

struct fisheye_wanted {
	int model;	     /* enum fisheye_model or FISHEYE_MODEL_AUTO */
	double field_deg;    /* half of the field of view that is used */
	double tolerance_px; /* largest standard deviation anywhere in the circle */
	/* the view in which the board is level, its rows along world X: face up, or face
	 * down over a lens that looks up; -1: none */
	int world_view;
};

/* Must not be moved in memory: the finding points into it. */
struct fisheye_result {
	struct finding finding;
	struct lens_knowledge knowledge;
	struct fisheye_settings lens; /* as the configuration has it */
	bool oriented;		      /* lens.rotation_deg was found */
};

/*
 * Fills the result, whose finding has a verdict; seen must outlive it. An untrusted result may hold
 * no lens (then finding.estimate.count is 0). -EINVAL: an impossible point (the fault names it);
 * -ENOMEM.
 */
int fisheye_find(struct fisheye_result *result, const struct observations *seen,
		 const struct fisheye_wanted *wanted, struct fault *fault);
/* Fills result->lens from the result's knowledge. */
void fisheye_result_settings(struct fisheye_result *result, double field_deg);

void fisheye_result_free(struct fisheye_result *result); /* idempotent; zeroed is fine */

#endif
