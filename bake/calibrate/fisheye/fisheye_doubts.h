/* SPDX-License-Identifier: MIT */
/* When a fisheye lens that was found from points cannot be trusted. Private to fisheye_*.c. */
#ifndef INLAY_BAKE_CALIBRATE_FISHEYE_FISHEYE_DOUBTS_H
#define INLAY_BAKE_CALIBRATE_FISHEYE_FISHEYE_DOUBTS_H

#include "bake/calibrate/fisheye/fisheye_find.h"
#include "bake/calibrate/fisheye/fisheye_models.h"

/* How many points tell a lens: one more than its numbers could all be bent to. */
int fisheye_fewest(const struct lens_problem *problem, const struct fisheye_wanted *wanted);

/* Whether there are too few points to begin with; the verdict then says so. */
bool fisheye_doubt_count(struct fisheye_result *result, const struct lens_problem *problem,
			 const struct fisheye_wanted *wanted);

/* The verdict on the lens of one model, or on there being none. */
void fisheye_doubt(struct fisheye_result *result, const struct lens_problem *problem,
		   const struct model_trials *trials, const struct fisheye_wanted *wanted,
		   enum fisheye_model model);

/* The errors over the circle, whatever the lens was found from. */
void fisheye_doubt_circle(struct fisheye_result *result, double tolerance_px, const char *remedy);

#endif
