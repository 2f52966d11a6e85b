/* SPDX-License-Identifier: MIT */
/*
 * inlay-calibrate fisheye from points: every model is tried, and the one is taken whose residuals
 * are the least for its number of parameters (Akaike's criterion, as the figures aic_... say).
 */
#ifndef INLAY_BAKE_CALIBRATE_FISHEYE_FISHEYE_FIND_H
#define INLAY_BAKE_CALIBRATE_FISHEYE_FISHEYE_FIND_H

#include "bake/calibrate/fisheye/fisheye_knowledge.h"
#include "bake/calibrate/observe/observations.h"
#include "hal/optics/fisheye.h"

#define FISHEYE_MODEL_AUTO FISHEYE_MODEL_COUNT

struct fisheye_wanted {
	int model;	     /* enum fisheye_model or FISHEYE_MODEL_AUTO */
	double field_deg;    /* half the field of view that is to be used */
	double tolerance_px; /* one standard deviation, anywhere in the circle */
	bool directions;     /* world[] are directions, not places on boards */
	int world_view; /* of boards: in which view the board lies as the world does; -1: none */
};

/* Not to be moved: the finding points into it. */
struct fisheye_result {
	struct finding finding;
	struct lens_knowledge knowledge;
	struct fisheye_settings lens; /* for the configuration */
	bool oriented;		      /* lens.rotation_deg was found, too */
};

/*
 * Fills the result, whose finding has a verdict; seen is borrowed as long. An untrusted result may
 * hold no lens (then finding.estimate.count is 0). -EINVAL: a point that cannot be (the fault names
 * it); -ENOMEM.
 */
int fisheye_find(struct fisheye_result *result, const struct observations *seen,
		 const struct fisheye_wanted *wanted, struct fault *fault);
/* The lens of the result's knowledge as the configuration has it. */
void fisheye_result_settings(struct fisheye_result *result, double field_deg);

void fisheye_result_free(struct fisheye_result *result); /* idempotent; zeroed is fine */

#endif
