/* SPDX-License-Identifier: MIT */
/* Doubts about a fisheye lens that was found from points. Private to fisheye/. */
#ifndef INLAY_BAKE_CALIBRATE_FISHEYE_FISHEYE_DOUBTS_H
#define INLAY_BAKE_CALIBRATE_FISHEYE_FISHEYE_DOUBTS_H

#include "bake/calibrate/fisheye/fisheye_find.h"
#include "bake/calibrate/fisheye/fisheye_models.h"

/* Returns the fewest points that determine a lens: one more than the number of unknowns that they
 * could be fitted to. */
int fisheye_fewest(const struct lens_problem *problem, const struct fisheye_wanted *wanted);

/* Whether there are too few points to begin with; the verdict then says so. */
bool fisheye_doubt_count(struct fisheye_result *result, const struct lens_problem *problem,
			 const struct fisheye_wanted *wanted);

/* Judges the lens of one model, or that there is none. */
void fisheye_doubt(struct fisheye_result *result, const struct lens_problem *problem,
		   const struct model_trials *trials, const struct fisheye_wanted *wanted,
		   enum fisheye_model model);

/* Judges the errors over the image circle, whatever the lens was found from. */
void fisheye_doubt_circle(struct fisheye_result *result, double tolerance_px, const char *remedy);

#endif
