/* SPDX-License-Identifier: MIT */
/* From a guess to the lens that shows lamps where bright spots are, by alternating assignment and
 * fit. */
#ifndef INLAY_BAKE_CALIBRATE_FISHEYE_LAMPS_LAMPS_TRACE_H
#define INLAY_BAKE_CALIBRATE_FISHEYE_LAMPS_LAMPS_TRACE_H

#include "bake/calibrate/fisheye/lamps/lamps_match.h"
#include "bake/calibrate/observe/observations.h"
#include "hal/base/fault.h"

#define SPOT_NONE (-1)
#define SPOT_MERGED (-2) /* several lamps are in one spot */

struct lamp_trace {
	struct lamp_guess lens; /* the lens found so far */
	int *spot;		/* [lamps]: index of its spot; SPOT_NONE, SPOT_MERGED */
	int found;
	double reach_px;     /* largest distance between a spot and its lamp */
	double deviation_px; /* robust standard deviation of a spot */
};

/* Fits a lens to the nearest spots, assigns spots anew, and so on. wanted: enum fisheye_model,
 * FISHEYE_MODEL_COUNT for any. found is below 4 where the guess leads nowhere. -ENOMEM. */
int lamps_trace(struct lamp_trace *trace, const struct lamp_scene *scene,
		const struct lamp_guess *guess, int wanted);
void lamps_trace_free(struct lamp_trace *trace); /* idempotent; zeroed is fine */

/* Adds the spots of the lamps found as one view; names are "lamps.txt:7". -ENOMEM. */
int lamps_observe(struct observations *seen, const struct lamp_scene *scene,
		  const struct lamp_trace *trace, bool mirrored, const char *lamps_name,
		  const char *picture_name);

#endif
